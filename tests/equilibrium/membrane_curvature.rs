//! The curvature of what a membrane presses with, and what Newton's method makes of it.

use graintwin::Vec3;
use graintwin::model::Model;
use graintwin::relax::curvature::{Block3, Curvature};
use graintwin::relax::{Status, Workspace, relax};
use graintwin::state::State;

use crate::membranes::{R, ROUGH, flat, flat_scene, lattice, ring, round, round_scene};
use crate::packs::made;
use crate::slopes::{along, vectors};

/// C d of the curvature \[N\] for d \[m\], where blocks count in `stiffness` \[N/m\].
fn product(curvature: &Curvature, stiffness: f64, d: &[Vec3]) -> Vec<Vec3> {
    let mut product = vec![Vec3::zeros(); d.len()];
    let mut add = |i: usize, j: usize, entry: &dyn Fn(usize, usize) -> f32| {
        let row = |r: usize| (0..3).map(|c| f64::from(entry(r, c)) * d[j][c]).sum::<f64>();
        product[i] += Vec3::new(row(0), row(1), row(2)) * stiffness;
    };
    for (grain, block) in &curvature.own {
        add(*grain as usize, *grain as usize, &|r, c| block[r][c]);
    }
    for ([i, j], block) in &curvature.pairs {
        let [i, j] = [*i as usize, *j as usize];
        add(i, j, &|r, c| block[r][c]);
        add(j, i, &|r, c| block[c][r]);
    }
    product
}

#[test]
fn the_curvature_of_a_membrane_is_the_slope_of_its_pull() {
    let flat_pack = made(150, 2e6, 7);
    for (scene, pack) in [(round_scene(2e6, ROUGH), round()), (flat(2e6), &flat_pack)] {
        let model = Model::new(pack, &scene);
        let mut state = State::new(&model);
        let mut work = Workspace::new(&model);
        work.wrap(&model, &mut state);
        work.start(&model, &state);
        let bounds = state.bounds(&model);
        work.evaluate(&model, &state, &bounds);
        let (curvature, stiffness) = (work.balance.curvature.clone(), work.reference_stiffness);
        let entries = |block: &Block3| block.iter().flatten().fold(0.0_f32, |m, e| m.max(e.abs()));
        let most = curvature.own.iter().map(|(_, block)| entries(block)).fold(0.0, f32::max);
        for (_, block) in &curvature.own {
            for (r, c) in [(0, 1), (0, 2), (1, 2)] {
                assert!((block[r][c] - block[c][r]).abs() < 1e-6 * most);
            }
        }
        let n = model.len();
        // The pull is what twice the pressure on the same surface adds.
        let mut pull = |d: &[Vec3], step: f64| -> Vec<Vec3> {
            let mut moved = state.clone();
            moved.position = along(&state.position, d, step);
            let mut gradients = [1.0, 2.0].map(|times| {
                let mut under = state.clone();
                under.pressure = under.pressure.map(|pressure| times * pressure);
                work.start(&model, &under);
                work.evaluate(&model, &moved, &bounds);
                work.balance.gradient.clone()
            });
            let [one, two] = &mut gradients;
            two.iter().zip(one).map(|(two, one)| two - *one).collect()
        };
        let step = 1e-6;
        for seed in 1..4 {
            let d = vectors(seed, n);
            // The pull is a polynomial of the second degree: one difference is exact.
            let (after, before) = (pull(&d, step), pull(&d, -step));
            let want = product(&curvature, stiffness, &d);
            let scale = want.iter().map(Vec3::norm).fold(0.0, f64::max);
            assert!(scale > 2e6 * 1e-4, "{scale}");
            for i in 0..n {
                let slope = (after[i] - before[i]) / (2.0 * step);
                assert!((slope - want[i]).norm() < 1e-5 * scale, "{i}: {slope} {}", want[i]);
            }
        }
    }
}

/// Step and turn times radius of each grain that the linearised balance with `shift` on its diagonal asks for
/// \[m\].
fn solved(model: &Model, work: &mut Workspace, shift: f32) -> [Vec<Vec3>; 2] {
    let largest = work.balance.largest();
    work.assemble(model);
    let Workspace { balance, coupled, linear, reference, reference_stiffness, .. } = work;
    let (shift, unit) = (vec![shift; model.len()], largest / *reference_stiffness);
    match reference.active {
        true => {
            coupled.factorise(&shift);
            coupled.solve(&balance.gradient, &balance.moment, largest, 1e-6, 4000);
            [0, 1].map(|k| (0..model.len()).map(|i| coupled.step(i, unit)[k]).collect())
        }
        false => {
            linear.factorise(&shift);
            linear.solve(&balance.gradient, largest, 1e-6, 4000);
            let steps = (0..model.len()).map(|i| linear.step(i, unit)).collect();
            [steps, vec![Vec3::zeros(); model.len()]]
        }
    }
}

/// Moves the grains of `state` by `share` of the step and the turn.
fn go(model: &Model, state: &mut State, [step, turn]: &[Vec<Vec3>; 2], share: f64) {
    state.position = along(&state.position, step, share);
    for (i, rotation) in state.rotation.iter_mut().enumerate() {
        *rotation += turn[i] * (share / model.radius[i]);
    }
}

/// Largest unbalanced force before and after one Newton step of grains that are off their balance by `push`.
fn step(
    model: &Model,
    at_rest: &State,
    work: &mut Workspace,
    push: &[Vec3],
    curved: bool,
) -> [f64; 2] {
    let mut state = at_rest.clone();
    state.position = along(&at_rest.position, push, 1.0);
    work.evaluate(model, &state, &state.bounds(model));
    if !curved {
        work.balance.curvature = Curvature::default();
    }
    let before = work.balance.largest();
    let way = solved(model, work, 0.0);
    go(model, &mut state, &way, 1.0);
    work.evaluate(model, &state, &state.bounds(model));
    [before, work.balance.largest()]
}

/// A ring in balance with its membrane, with what `rest` of a scene says taking part from there on.
fn at_rest(rest: &str) -> (Model, State, Workspace) {
    let (pack, scene) = ring("");
    let model = Model::new(&pack, &scene);
    let mut smooth = State::new(&model);
    let mut work = Workspace::new(&model);
    work.wrap(&model, &mut smooth);
    assert_eq!(relax(&model, &mut smooth, &mut work).status, Status::Converged);
    let (mut pack, scene) = ring(rest);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.4);
    let model = Model::new(&pack, &scene);
    let mut state = State::new(&model);
    (state.position, state.pressure) = (smooth.position, smooth.pressure);
    let mut work = Workspace::new(&model);
    work.start(&model, &state);
    (model, state, work)
}

#[test]
fn a_newton_step_leaves_the_square_of_what_is_off() {
    for rest in ["", ROUGH] {
        let (model, state, mut work) = at_rest(rest);
        assert_eq!(work.reference.active, !rest.is_empty());
        work.evaluate(&model, &state, &state.bounds(&model));
        let overlap = work.balance.sums.mean_overlap();
        let mut left = |share: f64, curved: bool| {
            let push: Vec<Vec3> =
                vectors(3, model.len()).iter().map(|d| d * (share * overlap)).collect();
            let [before, after] = step(&model, &state, &mut work, &push, curved);
            after / before
        };
        let [coarse, middle, fine] = [3e-3, 1e-3, 3e-4].map(|share| left(share, true));
        assert!((coarse / middle / 3.0 - 1.0).abs() < 0.2, "{coarse:e} {middle:e} {fine:e}");
        assert!((middle / fine / (10.0 / 3.0) - 1.0).abs() < 0.2, "{coarse:e} {middle:e} {fine:e}");
        // Without it a step leaves the same share, however near.
        let without = left(3e-4, false);
        assert!(without > 5.0 * fine, "{without:e} {fine:e}");
    }
}

#[test]
fn the_parts_of_a_large_pack_share_the_curvature() {
    const SHIFT: f32 = 0.05;
    for friction in [0.0, 0.4] {
        let mut pack = lattice([10, 32, 32]);
        pack.grains.iter_mut().for_each(|grain| grain.friction = friction);
        let mut scene = flat_scene(true, 1e8);
        if friction > 0.0 {
            scene.contact.friction = flat(1e8).contact.friction;
        }
        let model = Model::new(&pack, &scene);
        assert!(graintwin::model::parts(model.len()) > 1);
        let mut state = State::new(&model);
        (state.pressure[0], state.pressure[1]) = (1e8, 1e8);
        let overlap = 5e-4 * R;
        state.position = along(&state.position, &vectors(2, model.len()), 0.05 * overlap);
        let mut work = Workspace::new(&model);
        work.start(&model, &state);
        assert_eq!(work.reference.active, friction > 0.0);
        let bounds = state.bounds(&model);
        // What the balance a little along the way says of the whole way.
        let mut left = |curved: bool| {
            work.evaluate(&model, &state, &bounds);
            let here = (work.balance.gradient.clone(), work.balance.moment.clone());
            let largest = work.balance.largest();
            if !curved {
                work.balance.curvature = Curvature::default();
            }
            let way = solved(&model, &mut work, SHIFT);
            let longest = way.iter().flatten().map(Vec3::norm).fold(0.0, f64::max);
            let share = 1e-5 * overlap / longest;
            let mut there = state.clone();
            go(&model, &mut there, &way, share);
            work.evaluate(&model, &there, &bounds);
            let shift = f64::from(SHIFT) * work.reference_stiffness;
            let off = |from: &[Vec3], to: &[Vec3], way: &[Vec3]| {
                let each = from.iter().zip(to).zip(way);
                each.map(|((from, to), way)| (from + (to - from) / share + way * shift).norm())
                    .fold(0.0, f64::max)
            };
            off(&here.0, &work.balance.gradient, &way[0]).max(off(
                &here.1,
                &work.balance.moment,
                &way[1],
            )) / largest
        };
        let [with, without] = [true, false].map(&mut left);
        assert!(with < 1e-4 && without > 10.0 * with, "{friction} {with:e} {without:e}");
    }
}
