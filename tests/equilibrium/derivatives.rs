//! Energy, forces and stiffness belong together: each is held against central differences of the
//! one before it.

use std::sync::OnceLock;

use graintwin::Vec3;
use graintwin::contact::hertz;
use graintwin::contact::neighbours::Neighbours;
use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::relax::balance::Balance;
use graintwin::scene::{Solver, Walls};
use graintwin::wall::Bounds;
use proptest::prelude::*;

use crate::packs::{bead, close, made};
use crate::slopes::{along, balance, hessian_times, vectors};

/// A pack in equilibrium; the tests push its grains about.
fn pack() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made(50, 1e7, 11))
}

fn model(pack: &Pack) -> Model {
    // Weight takes part: a tenth of a contact force.
    let gravity = [1e5, -2e5, -3e5];
    Model::with(pack, &Walls::default(), gravity, Solver::default(), None)
}

/// The balance between walls that stand.
fn between(model: &Model, position: &[Vec3], carries: &[bool]) -> (Balance, Neighbours) {
    balance(model, (position, carries), &[0.0; 6])
}

/// The grains of `model` pushed about by up to `push` \[m\].
fn pushed(model: &Model, seed: u64, push: f64) -> Vec<Vec3> {
    let start: Vec<Vec3> = model.grains.iter().map(|g| Vec3::from(g.position)).collect();
    along(&start, &vectors(seed, start.len()), push)
}

/// Mean overlap of the pack [m] and its mean contact force [N].
fn scales(model: &Model) -> (f64, f64) {
    let (balance, _) = between(model, &pushed(model, 1, 0.0), &vec![true; model.len()]);
    (balance.sums.mean_overlap(), balance.sums.mean_force())
}

#[test]
fn hertz_energy_force_and_stiffness_are_derivatives_of_each_other() {
    // Two glass beads of 0.1 mm: R* = 0.05 mm, E* = 36.458 GPa; by hand at h = 1 µm:
    // P = 4/3 36.4583e9 sqrt(5e-5) 1e-9 = 0.343732 N.
    let modulus =
        hertz::modulus(hertz::effective_radius(1e-4, 1e-4), 2.0 * hertz::compliance(70e9, 0.2));
    close("P", hertz::force(modulus, 1e-6), 0.343_732_463_077, 1e-10);
    let force = |h: f64| hertz::force(modulus, h);
    let energy = |h: f64| hertz::energy(force(h), h);
    for h in [1e-9, 1e-8, 1e-7, 1e-6, 1e-5] {
        let step = 1e-4 * h;
        let slope = |f: &dyn Fn(f64) -> f64| (f(h + step) - f(h - step)) / (2.0 * step);
        close("dU/dh", slope(&energy), force(h), 1e-8);
        close("dP/dh", slope(&force), hertz::stiffness(modulus, h), 1e-8);
    }
    assert_eq!((force(0.0), energy(0.0), hertz::stiffness(modulus, 0.0)), (0.0, 0.0, 0.0));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn gradient_is_the_slope_of_the_energy(seed: u64, push in 0.0..1.0f64) {
        let model = model(pack());
        let (overlap, force) = scales(&model);
        let all = vec![true; model.len()];
        let position = pushed(&model, seed, push * overlap);
        let (here, _) = between(&model, &position, &all);
        let step = 1e-5 * overlap;
        for i in 0..model.len() {
            for axis in 0..3 {
                let energy = |sign: f64| {
                    let mut moved = position.clone();
                    moved[i][axis] += sign * step;
                    between(&model, &moved, &all).0.sums.energy
                };
                let slope = (energy(1.0) - energy(-1.0)) / (2.0 * step);
                // P ~ h^1.5 has a bounded second difference: a contact that opens costs 1e-5^1.5.
                prop_assert!((here.gradient[i][axis] - slope).abs() < 1e-7 * force);
            }
        }
    }

    #[test]
    fn linearisation_is_the_slope_of_the_gradient(seed: u64, push in 0.0..1.0f64) {
        let model = model(pack());
        let (overlap, force) = scales(&model);
        let all = vec![true; model.len()];
        let position = pushed(&model, seed, push * overlap);
        let (here, neighbours) = between(&model, &position, &all);
        let d = vectors(seed ^ 0xABCD, model.len());
        let step = 1e-5 * overlap;
        let (after, _) = between(&model, &along(&position, &d, step), &all);
        let (before, _) = between(&model, &along(&position, &d, -step), &all);
        // Single precision: 6e-8 of each of some ten terms. A contact within a step of opening
        // would be off by 1e-5^0.5; 150 of them and 6 cases do not meet it every time.
        let stiffness = 1.5 * force / overlap;
        for (i, want) in hessian_times(&here, &neighbours, &d).iter().enumerate() {
            let slope = (after.gradient[i] - before.gradient[i]) / (2.0 * step);
            prop_assert!((want - slope).amax() < 1e-2 * stiffness, "{i} {want} {slope}");
        }
        let off: f64 = hessian_times(&here, &neighbours, &d)
            .iter()
            .enumerate()
            .map(|(i, want)| {
                let slope = (after.gradient[i] - before.gradient[i]) / (2.0 * step);
                (want - slope).norm()
            })
            .sum();
        prop_assert!(off < 1e-4 * stiffness * model.len() as f64, "{off} {stiffness}");
    }

    #[test]
    fn grains_that_do_not_carry_neither_push_nor_are_pushed(seed: u64) {
        let model = model(pack());
        let (overlap, _) = scales(&model);
        let position = pushed(&model, seed, 0.3 * overlap);
        let mut carries = vec![true; model.len()];
        let left_out = (seed % model.len() as u64) as usize;
        carries[left_out] = false;
        let (without, neighbours) = between(&model, &position, &carries);
        prop_assert_eq!(without.gradient[left_out], Vec3::zeros());
        // Wherever it goes, the others feel nothing.
        let mut moved = position.clone();
        moved[left_out] += Vec3::new(overlap, -overlap, overlap);
        let (after, _) = between(&model, &moved, &carries);
        prop_assert_eq!(&without.gradient, &after.gradient);
        prop_assert_eq!(without.sums.energy, after.sums.energy);
        let mut d = vec![Vec3::zeros(); model.len()];
        d[left_out] = Vec3::repeat(1.0);
        let product = hessian_times(&without, &neighbours, &d);
        prop_assert!(product.iter().all(|p| *p == Vec3::zeros()));
    }
}

/// Two beads whose surfaces are `gap` apart, and the second `gap` off the wall x_max.
fn approaching(gap: f64) -> (Model, Vec<Vec3>) {
    let radius = 1e-4;
    let at = [-radius, radius + gap];
    let high = radius + gap + radius + gap;
    let bounds = Bounds { min: [-1e-3; 3], max: [high, 1e-3, 1e-3] };
    let grains = at.map(|x| bead([x, 0.0, 0.0], radius)).to_vec();
    let pack = Pack { bounds, grains, history: None };
    let model = Model::with(&pack, &Walls::default(), [0.0; 3], Solver::default(), None);
    let position = model.grains.iter().map(|g| Vec3::from(g.position)).collect();
    (model, position)
}

#[test]
fn derivatives_hold_across_a_contact_that_opens_and_closes() {
    // Scales of an overlap of 1 µm: P = 0.34 N and dP/dh = 0.5 N/µm between beads.
    for gap in [1e-6, 1e-8, 1e-12, 0.0, -1e-12, -1e-10, -1e-8, -1e-7, -1e-6] {
        let (model, position) = approaching(gap);
        let all = [true; 2];
        let (here, neighbours) = between(&model, &position, &all);
        // The difference reaches over the opening when the gap is smaller than the step.
        let step = 1e-9;
        for i in 0..2 {
            let moved = |sign: f64| {
                let mut moved = position.clone();
                moved[i].x += sign * step;
                between(&model, &moved, &all).0
            };
            let (after, before) = (moved(1.0), moved(-1.0));
            let slope = (after.sums.energy - before.sums.energy) / (2.0 * step);
            // The law's own bound: two contacts, M step^1.5 with M = 0.97e9 against the wall.
            let bound = 2.0 * 9.7e8 * step.powf(1.5) + 1e-7;
            assert!((here.gradient[i].x - slope).abs() < bound, "{gap} {i}");

            let mut d = vec![Vec3::zeros(); 2];
            d[i].x = 1.0;
            let product = hessian_times(&here, &neighbours, &d);
            let bound = 2.0 * 1.5 * 9.7e8 * step.sqrt();
            for (k, want) in product.iter().enumerate() {
                let slope = (after.gradient[k].x - before.gradient[k].x) / (2.0 * step);
                let scale = if gap.abs() > 2.0 * step { 1e-2 * bound } else { bound };
                assert!((want.x - slope).abs() < scale, "{gap} {i} {k}");
            }
        }
        let closed = gap < 0.0;
        assert_eq!(here.sums.contacts, if closed { 2 } else { 0 }, "{gap}");
        assert_eq!(here.sums.energy > 0.0, closed);
    }
}
