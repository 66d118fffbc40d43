//! Contacts of spheres with round walls: energy, forces and their slopes, and the ellipse that they are.

use std::f64::consts::PI;

use graintwin::Vec3;
use graintwin::contact::hertz;
use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::scene::Solver;
use graintwin::wall::Bounds;

use crate::cylinder::{HOLE, hollow, solid, walls_with};
use crate::packs::{E_WALL, bead, close};
use crate::slopes::{along, balance, hessian_times, vectors};

#[test]
fn forces_and_their_slope_are_derivatives_of_the_energy() {
    for (pack, inner) in [(solid(), None), (hollow(), Some(HOLE))] {
        let model = Model::with(pack, &walls_with(inner), [0.0; 3], Solver::default(), None);
        let n = model.len();
        let start: Vec<Vec3> = model.grains.iter().map(|g| Vec3::from(g.position)).collect();
        let carries = vec![true; n];
        let zero = [0.0; 6];
        let balance = |at: &[Vec3], to: &[f64; 6]| balance(&model, (at, &carries), to);
        let sums = balance(&start, &zero).0.sums;
        let (overlap, force) = (sums.mean_overlap(), sums.mean_force());
        let pushed = along(&start, &vectors(5, n), 0.3 * overlap);
        let (here, near) = balance(&pushed, &zero);
        let step = 1e-5 * overlap;
        for k in 0..3 {
            let d = vectors(11 + k, n);
            let moved = |sign: f64| along(&pushed, &d, sign * step);
            let [after, before] = [1.0, -1.0].map(|sign| balance(&moved(sign), &zero).0);
            let slope = (after.sums.energy - before.sums.energy) / (2.0 * step);
            let want: f64 = here.gradient.iter().zip(&d).map(|(g, d)| g.dot(d)).sum();
            assert!((slope - want).abs() < 1e-7 * force * n as f64, "{slope} {want}");
            let stiffness = 1.5 * force / overlap;
            let off: f64 = (hessian_times(&here, &near, &d).iter().enumerate())
                .map(|(i, want)| {
                    let slope = (after.gradient[i] - before.gradient[i]) / (2.0 * step);
                    (want - slope).norm()
                })
                .sum();
            assert!(off < 1e-5 * stiffness * n as f64, "{off} {stiffness}");
        }
        // The force on a wall is what it does over its way.
        let on_walls =
            walls::normal_forces_in(&model, &near, (&pushed, &carries), &model.bounds(&zero));
        for w in (0..6).filter(|w| ![2, 3].contains(w) && (*w > 0 || inner.is_some())) {
            let energy = |sign: f64| {
                let mut to = zero;
                to[w] = sign * step;
                balance(&pushed, &to).0.sums.energy
            };
            let slope = (energy(1.0) - energy(-1.0)) / (2.0 * step);
            assert!((slope / on_walls[w] - 1.0).abs() < 1e-7, "{w}: {slope} {}", on_walls[w]);
            assert!(slope > force);
        }
    }
}

/// Complete elliptic integrals K and E of the modulus e, by the arithmetic-geometric mean.
fn elliptic(e: f64) -> [f64; 2] {
    let (mut a, mut b, mut c) = (1.0, (1.0 - e * e).sqrt(), e);
    let (mut sum, mut power) = (0.5 * c * c, 0.5);
    while c.abs() > 1e-16 {
        (a, b, c) = (0.5 * (a + b), (a * b).sqrt(), 0.5 * (a - b));
        power *= 2.0;
        sum += power * c * c;
    }
    let k = PI / (2.0 * a);
    [k, k * (1.0 - sum)]
}

/// What the force at a given approach is over 4/3 E* √√(R'R'') h^1.5, for the relative radii R' >= R''
/// (Johnson, Contact Mechanics, 4.28 and 4.26c).
fn elliptical(ratio: f64) -> f64 {
    let of = |e: f64| {
        let [k, big_e] = elliptic(e);
        let slender = 1.0 / (1.0 - e * e);
        (slender * big_e - k, k - big_e)
    };
    let (mut low, mut high) = (1e-6, 1.0 - 1e-9);
    for _ in 0..100 {
        let e = 0.5 * (low + high);
        let (x, y) = of(e);
        if x / y < ratio { low = e } else { high = e }
    }
    let e = 0.5 * (low + high);
    let [k, _] = elliptic(e);
    let (x, y) = of(e);
    let across = (1.0 - e * e).sqrt();
    let f1 = (4.0 / (PI * e * e) * across.powf(1.5) * (x * y).sqrt()).cbrt();
    let f2 = 2.0 / PI * across.sqrt() / f1 * k;
    f2.powf(-1.5)
}

#[test]
fn the_effective_radius_is_that_of_the_elliptical_contact() {
    let pack = Pack {
        bounds: Bounds { min: [-1e-3; 3], max: [1e-3; 3] },
        grains: vec![bead([6e-4, 0.0, 0.0], 1e-4), bead([-6e-4, 0.0, 0.0], 2e-4)],
        history: None,
    };
    let model = Model::with(&pack, &walls_with(Some(4e-4)), [0.0; 3], Solver::default(), None);
    for i in 0..2 {
        let r = model.radius[i];
        for (w, curvature) in [(0, 1.0 / 4e-4), (1, -1.0 / 1e-3)] {
            let around = r / (1.0 + r * curvature);
            let ratio = (around / r).max(r / around);
            let exact = (around * r).powf(0.25) * elliptical(ratio);
            let off = model.wall_radius(i, w).sqrt() / exact - 1.0;
            // Second order in the logarithm of the ratio, where a plane is off to the first.
            let log = ratio.ln();
            assert!(off.abs() < 0.025 * log * log, "{w} {r}: {off:e} {log}");
            let plane = r.sqrt() / exact - 1.0;
            assert!(off.abs() < 0.05 * plane.abs(), "{off:e} {plane:e}");
        }
        for w in 2..6 {
            assert_eq!(model.wall_radius(i, w), r);
        }
    }
}

/// A sphere on a rough wall that bends around it: what sticks rolls.
#[test]
fn a_sphere_that_sticks_to_the_outer_wall_resists_around_and_along() {
    const R: f64 = 1e-4;
    let outer = 1e-3;
    let modulus = 4.0 / 3.0 * E_WALL * (R / (1.0 - R / outer).sqrt()).sqrt();
    let wanted = hertz::stiffness(modulus, 1e-7) / 1.5;
    let pack = Pack {
        bounds: Bounds { min: [-outer; 3], max: [outer; 3] },
        grains: vec![bead([outer - R + 1e-7, 0.0, 0.0], R), bead([0.0, 0.0, 0.0], 1.2e-4)],
        history: None,
    };
    let model = Model::with(&pack, &walls_with(None), [0.0; 3], Solver::default(), None);
    let at: Vec<Vec3> = model.grains.iter().map(|g| Vec3::from(g.position)).collect();
    let (balance, _) = balance(&model, (&at, &[true; 2]), &[0.0; 6]);
    let force = balance.gradient.iter().map(Vec3::norm).fold(0.0, f64::max);
    close("P", force, wanted * 1e-7, 1e-9);
}
