//! Cement: bonds as lines between centres, those in tension apart from those in compression, and
//! cracks as flat discs across the contact, by how it broke.

use super::Canvas;
use super::chains::ends_of;
use crate::Vec3;
use crate::msg::picture::{ColorRGBA, Marker, Point};
use crate::report::{BondCondition, Bonds, Grains};

/// Width of the line of a bond over the mean radius: thinner than any force chain.
const WIDTH: f64 = 0.06;

/// Radius of a disc over the mean radius: larger than the cement, to be seen between the spheres.
const DISC: f64 = 0.5;

/// Triangles of a disc.
const SIDES: u32 = 8;

/// Of the palette of M. Okabe and K. Ito: blue for compression, reddish purple for tension.
const BONDS: [ColorRGBA; 2] = [
    ColorRGBA { r: 0.0, g: 0.447, b: 0.698, a: 1.0 },
    ColorRGBA { r: 0.8, g: 0.475, b: 0.655, a: 1.0 },
];

/// Of the same palette: black where the tensile stress broke it, yellow where the shear stress did.
const CRACKS: [ColorRGBA; 2] = [
    ColorRGBA { r: 0.0, g: 0.0, b: 0.0, a: 1.0 },
    ColorRGBA { r: 0.941, g: 0.894, b: 0.259, a: 1.0 },
];

/// Four markers, those without anything to draw as deleted: bonds in compression, bonds in tension,
/// cracks by tension, cracks by shear.
pub(super) fn cement(canvas: &Canvas, grains: &Grains, bonds: Option<&Bonds>) -> Vec<Marker> {
    let mut lines: [Vec<Point>; 2] = Default::default();
    let mut discs: [Vec<Point>; 2] = Default::default();
    let radius = grains.radius.iter().sum::<f64>() / grains.radius.len().max(1) as f64;
    let places =
        bonds.into_iter().flat_map(|bonds| (0..bonds.first.len()).map(move |k| (bonds, k)));
    for (bonds, k) in places {
        let vector = |of: &[f64]| Vec3::new(of[3 * k], of[3 * k + 1], of[3 * k + 2]);
        let (at, normal) = (vector(&bonds.position), vector(&bonds.normal));
        let condition = bonds.condition[k];
        if condition == BondCondition::Intact as u8 {
            let ends = ends_of(grains, bonds.first[k], bonds.second[k], at.into());
            let tension = usize::from(bonds.normal_force[k] < 0.0);
            lines[tension].extend(ends.into_iter().flatten().map(|end| canvas.point(end)));
        } else {
            let shear = usize::from(condition == BondCondition::Shear as u8);
            let corners = disc(&at, &normal, DISC * radius);
            discs[shear].extend(corners.map(|corner| canvas.point(corner.into())));
        }
    }
    let marker = |namespace, number, kind, color: ColorRGBA, points: Vec<Point>| {
        let mut marker = canvas.marker(namespace, number, kind);
        // The width of lines; triangles have the size that their corners tell.
        let width = WIDTH * radius * canvas.scale;
        marker.scale = if kind == Marker::LINE_LIST { [width, 0.0, 0.0] } else { [1.0; 3] }.into();
        marker.color = color;
        marker.action = if points.is_empty() { Marker::DELETE } else { Marker::ADD };
        marker.points = points;
        marker
    };
    let bonds = lines.into_iter().zip(BONDS).enumerate();
    let bonds =
        bonds.map(|(k, (points, color))| marker("bonds", k, Marker::LINE_LIST, color, points));
    let cracks = discs.into_iter().zip(CRACKS).enumerate();
    let cracks = cracks
        .map(|(k, (points, color))| marker("cracks", k, Marker::TRIANGLE_LIST, color, points));
    bonds.chain(cracks).collect()
}

/// The corners of the triangles of a disc about `centre` across `normal`, three a triangle.
fn disc(centre: &Vec3, normal: &Vec3, radius: f64) -> impl Iterator<Item = Vec3> + use<> {
    let least = normal.iamin();
    let mut other = Vec3::zeros();
    other[least] = 1.0;
    let u = normal.cross(&other).normalize();
    let v = normal.cross(&u);
    let (centre, step) = (*centre, std::f64::consts::TAU / f64::from(SIDES));
    (0..SIDES).flat_map(move |k| {
        let corner = |k: u32| {
            let (sine, cosine) = (step * f64::from(k)).sin_cos();
            centre + (u * cosine + v * sine) * radius
        };
        [centre, corner(k), corner(k + 1)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_lies_across_the_normal_and_has_nearly_the_area_of_a_circle() {
        let (centre, normal) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.6, 0.0, 0.8));
        let corners: Vec<Vec3> = disc(&centre, &normal, 2.0).collect();
        let area: f64 =
            corners.chunks(3).map(|t| 0.5 * (t[1] - t[0]).cross(&(t[2] - t[0])).norm()).sum();
        // A regular octagon: 2 √2 r².
        assert!((area / (8.0 * 2.0_f64.sqrt()) - 1.0).abs() < 1e-12, "{area}");
        assert!(corners.iter().all(|at| (at - centre).dot(&normal).abs() < 1e-12));
    }
}
