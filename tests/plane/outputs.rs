//! What is told of discs: stress of the interior, strain of the network, directions, rings.

use std::f64::consts::TAU;

use graintwin::Vec3;
use graintwin::contact::Other;
use graintwin::measure::contacts::Contact;
use graintwin::measure::plane::Network;
use graintwin::measure::plane::region::Region;
use graintwin::measure::plane::strain::strain;
use graintwin::report::Measures;
use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::discs::*;

type Vec2 = Vector2<f64>;

/// The contact of `first` with `second` that carries `force` along its normal and `shear`, the F_s of
/// A.42.
fn contact(at: &[Vec2], first: u32, second: u32, force: f64, shear: f64) -> Contact {
    let branch = at[first as usize] - at[second as usize];
    let distance = branch.norm();
    let (c, s) = (branch.x / distance, branch.y / distance);
    Contact {
        first,
        second: Other::Grain(second),
        normal: Vec3::new(c, s, 0.0),
        force,
        overlap: 0.0,
        shear: Vec3::new(s, -c, 0.0) * shear,
        torsion: 0.0,
        slides: false,
        slipped: false,
        distance,
        cement: None,
    }
}

/// A lattice of `side` by `side` grains out of shape, and the contacts along its triangles, of which one
/// in seven is missing.
fn uneven(side: u32) -> (Vec<Vec2>, Vec<Contact>) {
    let mut rng = Pcg64::seed_from_u64(3);
    let mut at = Vec::new();
    for row in 0..side {
        for column in 0..side {
            let mut off = || 0.3 * (rng.random::<f64>() - 0.5);
            at.push(Vec2::new(f64::from(column) + off(), f64::from(row) + off()));
        }
    }
    let mut contacts = Vec::new();
    for row in 0..side {
        for column in 0..side {
            let here = row * side + column;
            let near = [(1, 0), (0, 1), (1, 1)];
            for (right, up) in near.into_iter().filter(|(x, y)| column + x < side && row + y < side)
            {
                let inside =
                    row > 0 && row + up + 1 < side && column > 0 && column + right + 1 < side;
                if !inside || rng.random::<f64>() > 1.0 / 7.0 {
                    contacts.push(contact(&at, here, here + up * side + right, 1.0, 0.0));
                }
            }
        }
    }
    (at, contacts)
}

#[test]
fn an_even_motion_has_its_strain_and_the_printed_sums_tell_half_of_it() {
    let (at, contacts) = uneven(9);
    // u = -G x shrinks and shears.
    let [xx, xy, yx, yy] = [0.02, 0.03, -0.01, -0.005];
    let way = |at: &Vec2| -Vec2::new(xx * at.x + xy * at.y, yx * at.x + yy * at.y);
    let ways: Vec<Vec2> = at.iter().map(way).collect();
    let found = strain(&at, &ways, &contacts);
    for (got, want) in found.network.into_iter().zip([xx, yy, 0.5 * (xy + yx)]) {
        assert!((got - want).abs() < 1e-14, "{got} {want}");
    }
    // The area within the border, by the shoelace formula.
    let side = 9;
    let border = (0..8).chain((0..8).map(|k| k * side + 8));
    let border: Vec<usize> = border
        .chain((0..8).map(|k| 8 * side + 8 - k))
        .chain((0..8).map(|k| (8 - k) * side))
        .collect();
    let next = border.iter().cycle().skip(1);
    let area: f64 = border.iter().zip(next).map(|(&a, &b)| 0.5 * at[a].perp(&at[b])).sum();
    assert!((found.area / area - 1.0).abs() < 1e-13, "{} {area}", found.area);

    // Isotropic compression: the error of 100 % (A.53, A.54).
    let ways: Vec<Vec2> = at.iter().map(|at| -0.01 * at).collect();
    let found = strain(&at, &ways, &contacts);
    assert!((found.network[0] + found.network[1] - 0.02).abs() < 1e-14);
    assert!((found.printed[0] + found.printed[1] - 0.01).abs() < 1e-14);
}

#[test]
fn spokes_carry_a_radial_stress_that_falls_with_the_radius() {
    // N spokes of branches with the force F: σ_rr = N F/(2 π r depth), and nothing across.
    let (spokes, steps, force, depth, centre) = (24, 30, 3.0, 0.5, Vec2::new(7.0, -2.0));
    let mut at = Vec::new();
    let mut contacts = Vec::new();
    for spoke in 0..spokes {
        let (s, c) = (TAU * f64::from(spoke) / f64::from(spokes)).sin_cos();
        for step in 0..=steps {
            at.push(centre + Vec2::new(c, s) * (0.35 + 0.4 * f64::from(step)));
            if step > 0 {
                let last = at.len() as u32 - 1;
                contacts.push(contact(&at, last - 1, last, force, 0.0));
            }
        }
    }
    let network = Network { at: &at, contacts: &contacts, depth, diameter: 0.4 };
    let rings = network.rings(&Region::Ring { centre, inner: 1.0, outer: 11.0 });
    assert_eq!(rings.radius.len(), 25);
    for (place, radius) in rings.radius.iter().enumerate() {
        let want = f64::from(spokes) * force / (TAU * radius * depth);
        assert!((rings.radial_stress[place] / want - 1.0).abs() < 1e-12, "{radius}");
        assert!(rings.hoop_stress[place].abs() < 1e-12 * want, "{radius}");
        // One contact a spoke every 0.4 of the radius.
        let density = f64::from(spokes) / (0.4 * TAU * radius * depth) * 0.4_f64.powi(3);
        assert!((rings.contact_density[place] / density - 1.0).abs() < 1e-12, "{radius}");
    }
}

#[test]
fn contacts_count_in_both_of_their_directions_with_the_forces_of_a_42() {
    let at = [Vec2::zeros(), Vec2::new(1.0, 0.1), Vec2::new(0.2, -1.0)];
    let contacts = [contact(&at, 0, 1, 2.0, 0.5), contact(&at, 2, 0, 3.0, -0.25)];
    let whole =
        Region::Box { min: Vec2::repeat(-5.0), max: Vec2::repeat(5.0), tilt: 0.0, middle: 0.0 };
    let polar = Network { at: &at, contacts: &contacts, depth: 1.0, diameter: 1.0 }.polar(&whole);
    // Normals at 185.7° and 281.3°.
    for (bin, normal, shear) in [(18, 2.0, 0.5), (0, 2.0, 0.5), (28, 3.0, -0.25), (10, 3.0, -0.25)]
    {
        assert_eq!(polar.contacts[bin], 1, "{bin}");
        assert!((polar.normal[bin] - normal).abs() < 1e-15, "{bin}");
        assert!((polar.shear[bin] - shear).abs() < 1e-15, "{bin}");
    }
    assert_eq!(polar.contacts.iter().sum::<u32>(), 4);
}

/// The stress in the interior from the published network, by cutting every branch into many pieces.
fn cut_up(measures: &Measures, margin: f64) -> [f64; 3] {
    let (network, walls) = (measures.network.as_ref().unwrap(), &measures.walls);
    let grains = measures.grains.as_ref().unwrap();
    let limits =
        |axis: usize| [walls.position[2 * axis] + margin, walls.position[2 * axis + 1] - margin];
    let ([left, right], [low, high]) = (limits(0), limits(1));
    let mut sum = [0.0; 3];
    let pieces = 2000;
    for (contact, &first) in network.first.iter().enumerate() {
        let Some(second) = grains.position.get(network.second[contact] as usize) else { continue };
        let at = grains.position[first as usize];
        let branch = [0, 1].map(|axis| at[axis] - second[axis]);
        let inside = (0..pieces).filter(|&k| {
            let share = (f64::from(k) + 0.5) / f64::from(pieces);
            let [x, y] = [0, 1].map(|axis| second[axis] + share * branch[axis]);
            left < x && x < right && low < y && y < high
        });
        let share = inside.count() as f64 / f64::from(pieces);
        let force = [0, 1].map(|axis| {
            network.normal_force[contact] * network.normal[3 * contact + axis]
                + network.tangential_force[3 * contact + axis]
        });
        sum[0] += share * branch[0] * force[0];
        sum[1] += share * branch[1] * force[1];
        sum[2] += 0.5 * share * (branch[0] * force[1] + branch[1] * force[0]);
    }
    let volume = (right - left) * (high - low) * (walls.position[5] - walls.position[4]);
    sum.map(|part| part / volume)
}

#[test]
fn a_biaxial_test_tells_the_same_as_its_network_and_its_box() {
    let pack = dense(10, 20, 5, 1e5, 0.5);
    let (mut rig, report) = Rig::new(&sand("0.5"), &pack);
    let start = report.measures.unwrap().plane.unwrap();
    assert_eq!((start.network_strain, start.mean_rotation), ([0.0; 3], 0.0));
    let height = pack.bounds.sides()[1];
    let mut last = None;
    for k in 1..=20 {
        last = Some(rig.biaxial(1e5, 0.5 * 2e-4 * f64::from(k) * height));
    }
    let measures = last.unwrap();
    let plane = measures.plane.as_ref().unwrap();
    let grains = measures.grains.as_ref().unwrap();
    let largest = grains.radius.iter().copied().fold(0.0, f64::max);
    assert!((plane.margin - 2.0 * largest).abs() < 1e-18);
    let stress = cut_up(&measures, plane.margin);
    for (got, want) in plane.stress.into_iter().zip(stress) {
        assert!((got - want).abs() < 1e-3 * stress[1], "{got} {want}");
    }
    // About that of the box: the walls are smooth, but the interior is a few grains wide.
    let state = measures.state.as_ref().unwrap();
    let walls = [state.stress_walls[0], state.stress_walls[4]];
    for (got, want) in [plane.stress[0], plane.stress[1]].into_iter().zip(walls) {
        assert!((got / want - 1.0).abs() < 0.25, "{got} {want}");
    }
    let mean = grains.turn.iter().sum::<f64>();
    assert!(mean.is_finite() && plane.mean_rotation.abs() < 0.1);
    assert!((plane.principal_direction.abs() - TAU / 4.0).abs() < 0.2);
    assert!(plane.contacts_per_grain > 3.0 && plane.contacts_per_grain < 5.0);
    assert!(plane.rings.radius.is_empty() && measures.motion.is_none());
    let axial = plane.network_strain[1];
    assert!((axial / 2e-4 - 1.0).abs() < 0.3, "{axial}");
    let printed = plane.contact_strain[0] + plane.contact_strain[1];
    let exact = plane.network_strain[0] + plane.network_strain[1];
    assert!((2.0 * printed - exact).abs() < 1e-15, "{printed} {exact}");
}
