//! Force chains: the contacts that carry more than the mean, as lines between centres.

use super::Canvas;
use crate::msg::picture::{ColorRGBA, Marker, Point};
use crate::pack::wall_of;
use crate::report::{ContactNetwork, Grains};

/// Least normal force of each width of line over the mean: the strong network of Radjai et al.
/// (Phys. Rev. Lett. 80, 61, 1998) begins at the mean. Forces fall off exponentially, so these
/// bins hold about 39, 28, 19 and 14 of 100 strong contacts.
const FROM: [f64; 4] = [1.0, 1.5, 2.25, 3.5];

/// Width of the line over the mean radius: the area grows as the force does.
const WIDTH: [f64; 4] = [0.10, 0.125, 0.155, 0.20];

/// Vermillion of the palette of M. Okabe and K. Ito for all kinds of colour vision.
const COLOR: ColorRGBA = ColorRGBA { r: 0.835, g: 0.369, b: 0.0, a: 1.0 };

/// One marker a width, from the thinnest to the thickest; those without a line are deleted. Lines
/// go from centre to centre, or from the wall to the centre.
pub(super) fn chains(
    canvas: &Canvas,
    grains: &Grains,
    network: Option<&ContactNetwork>,
) -> Vec<Marker> {
    let mut lines: [Vec<Point>; FROM.len()] = Default::default();
    if let Some(network) = network {
        let forces = &network.normal_force;
        // Cement pulls too, and where it broke there may be no force.
        let carrying = forces.iter().filter(|force| **force != 0.0).count();
        let mean = forces.iter().map(|force| force.abs()).sum::<f64>() / carrying.max(1) as f64;
        for (contact, &force) in forces.iter().enumerate() {
            // Exactly the mean is not above it: a single contact is no chain.
            let bin = FROM.iter().rposition(|&from| force > from * mean);
            if let (Some(bin), Some(ends)) = (bin, ends(grains, network, contact)) {
                lines[bin].extend(ends.map(|end| canvas.point(end)));
            }
        }
    }
    let radius = grains.radius.iter().sum::<f64>() / grains.radius.len().max(1) as f64;
    let marker = |(bin, points): (usize, Vec<Point>)| {
        let mut marker = canvas.marker("chains", bin, Marker::LINE_LIST);
        marker.scale = [WIDTH[bin] * radius * canvas.scale, 0.0, 0.0].into();
        marker.color = COLOR;
        marker.action = if points.is_empty() { Marker::DELETE } else { Marker::ADD };
        marker.points = points;
        marker
    };
    lines.into_iter().enumerate().map(marker).collect()
}

/// Both ends of a contact \[m\]; `None` when it is between bodies that are not there.
fn ends(grains: &Grains, network: &ContactNetwork, contact: usize) -> Option<[[f64; 3]; 2]> {
    let first = network.first[contact] as usize;
    let centre = *grains.position.get(first)?;
    let reach = grains.radius[first] - network.overlap[contact];
    let normal = &network.normal[3 * contact..3 * contact + 3];
    let at_wall = std::array::from_fn(|axis| centre[axis] - reach * normal[axis]);
    ends_of(grains, network.first[contact], network.second[contact], at_wall)
}

/// The centre of `first` and that of `second`, or the place `at_wall` where that is a wall \[m\];
/// `None` when they are not there.
pub(super) fn ends_of(
    grains: &Grains,
    first: u32,
    second: u32,
    at_wall: [f64; 3],
) -> Option<[[f64; 3]; 2]> {
    let centre = *grains.position.get(first as usize)?;
    let other = match wall_of(second) {
        Some(_) => at_wall,
        None => *grains.position.get(second as usize)?,
    };
    Some([centre, other])
}
