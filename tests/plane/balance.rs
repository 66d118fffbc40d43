//! The balance of discs against energies, closed forms and other methods.

use graintwin::plane::act::Scenery;
use graintwin::plane::balance::Balance;
use graintwin::plane::boundary::{self, SIDES};
use graintwin::plane::pose::Pose;
use graintwin::plane::reference::Reference;
use graintwin::plane::slope::Slope;
use graintwin::{
    contact::neighbours::Neighbours, model::Model, pack::Pack, scene::Scene, state::State,
};
use nalgebra::Vector2;
use proptest::prelude::*;

use crate::discs::*;

/// Potential and gradient of a pack moved from its reference.
struct Probe {
    model: Model,
    state: State,
    near: Neighbours,
    reference: Reference,
    pose: Pose,
}

impl Probe {
    fn new(scene: &Scene, pack: &Pack) -> Self {
        let model = Model::new(pack, scene);
        let mut state = State::new(&model);
        if let Some(history) = &pack.history {
            state.recall(&model, history);
        }
        let mut near = Neighbours::default();
        near.refresh(&model, &state.position, &state.bounds(&model));
        let mut bodies = Vec::new();
        boundary::bodies(&model, &state.displacement, state.tilt, &mut bodies);
        let mut reference = Reference::default();
        reference.begin(&model, &state, &near, &bodies, false);
        let at = state.position.iter().map(|at| Vector2::new(at.x, at.y)).collect();
        let turn = vec![0.0; model.len()];
        Self { model, state, near, reference, pose: Pose { at, turn } }
    }

    fn with<T>(
        &self,
        pose: &Pose,
        displacement: [f64; SIDES],
        of: impl Fn(&Scenery<'_>, &Pose) -> T,
    ) -> T {
        let mut bodies = Vec::new();
        let mut walls = self.state.displacement;
        walls[..SIDES].copy_from_slice(&displacement);
        boundary::bodies(&self.model, &walls, self.state.tilt, &mut bodies);
        let scenery = Scenery {
            model: &self.model,
            setup: self.model.plane.as_ref().unwrap(),
            reference: &self.reference,
            bodies: &bodies,
            membranes: &[],
            glued: &self.state.glued,
            carries: &self.state.carries,
            goes_on: false,
        };
        of(&scenery, pose)
    }

    fn balance(&self, pose: &Pose, displacement: [f64; SIDES]) -> Balance {
        self.with(pose, displacement, |scenery, pose| {
            let mut balance = Balance::default();
            balance.evaluate(scenery, pose);
            balance
        })
    }

    /// The pose with `by` \[m\] along one freedom: x, y, or turn times radius.
    fn moved(&self, grain: usize, freedom: usize, by: f64) -> Pose {
        let mut pose = self.pose.clone();
        match freedom {
            2 => pose.turn[grain] += by / self.model.radius[grain],
            axis => pose.at[grain][axis] += by,
        }
        pose
    }
}

/// A rough pack of 40 discs that was sheared and shaken a little, so that contacts slide, stick, open and
/// form on the way from its reference.
fn shaken() -> Probe {
    let pack = dense(5, 8, 3, 1e5, 0.4);
    let (mut rig, _) = Rig::new(&sand("0.4"), &pack);
    rig.biaxial(1e5, 2e-4 * pack.bounds.sides()[1]);
    let mut probe = Probe::new(&sand("0.4"), &rig.twin.pack());
    for (i, at) in probe.pose.at.iter_mut().enumerate() {
        let angle = 2.4 * i as f64;
        *at += Vector2::new(angle.cos(), angle.sin()) * 2e-4 * RADIUS;
        probe.pose.turn[i] = 1e-3 * (1.7 * i as f64).sin();
    }
    probe
}

#[test]
fn forces_are_derivatives_of_the_energy() {
    let probe = shaken();
    let still = [0.0; SIDES];
    let here = probe.balance(&probe.pose, still);
    let scale = here.gradient.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
    let step = 1e-6 * RADIUS;
    for grain in 0..probe.model.len() {
        for freedom in 0..3 {
            let energy = |by| probe.balance(&probe.moved(grain, freedom, by), still).potential();
            let slope = (energy(step) - energy(-step)) / (2.0 * step);
            let got = here.gradient[3 * grain + freedom];
            assert!((slope - got).abs() < 1e-4 * scale, "{grain} {freedom}: {slope} {got}");
        }
    }
    for side in 0..SIDES {
        let energy = |by: f64| {
            let mut walls = still;
            walls[side] = by;
            probe.balance(&probe.pose, walls).potential()
        };
        let slope = (energy(step) - energy(-step)) / (2.0 * step);
        assert!((slope - here.sides[side]).abs() < 1e-4 * scale, "{side}");
    }
}

#[test]
fn stiffnesses_are_derivatives_of_the_forces() {
    let probe = shaken();
    let still = [0.0; SIDES];
    let mut slope = Slope::default();
    let near = &probe.near;
    let positions: Vec<[f64; 2]> = probe.pose.at.iter().map(|at| [at.x, at.y]).collect();
    slope.matrix.arrange(&positions, &near.start, &near.second, |_| true, &[]);
    probe.with(&probe.pose, still, |scenery, pose| {
        let mut slope = slope.clone();
        slope.assemble(scenery, pose, false);
        let n = 3 * probe.model.len();
        let step = 1e-7 * RADIUS;
        let largest = slope.matrix.diagonal.iter().map(|b| b[0][0]).fold(0.0, f64::max);
        let mut kinks = 0;
        for grain in 0..probe.model.len() {
            for freedom in 0..3 {
                let balance = |by| probe.balance(&probe.moved(grain, freedom, by), still).gradient;
                let (low, high) = (balance(-step), balance(step));
                let mut unit = vec![0.0; n];
                unit[3 * grain + freedom] = 1.0;
                let mut column = vec![0.0; n];
                slope.multiply(&unit, (scenery.reference, &[]), &mut column);
                let off = (0..n)
                    .map(|k| ((high[k] - low[k]) / (2.0 * step) - column[k]).abs())
                    .fold(0.0, f64::max);
                // A contact that begins to slide or touch within the step has no derivative there.
                kinks += usize::from(off > 1e-4 * largest);
            }
        }
        assert!(kinks <= 2, "{kinks}");
        for side in 0..SIDES {
            let gradient = |by: f64| {
                let mut walls = still;
                walls[side] = by;
                probe.balance(&probe.pose, walls)
            };
            let (low, high) = (gradient(-step), gradient(step));
            let off = (0..n)
                .map(|k| {
                    let slope_k = (high.gradient[k] - low.gradient[k]) / (2.0 * step);
                    (slope_k - slope.columns[side][k]).abs()
                })
                .fold(0.0, f64::max);
            assert!(off < 1e-4 * largest, "{side}: {off:e} of {largest:e}");
            let corner = (high.sides[side] - low.sides[side]) / (2.0 * step);
            assert!((corner - slope.corner[side]).abs() < 1e-4 * largest);
        }
    });
}

#[test]
fn a_pack_that_is_turned_as_a_whole_feels_nothing() {
    // Shear displacements are those of rolling: none when all turns as one.
    let probe = shaken();
    let inside: Vec<usize> = (0..probe.model.len()).collect();
    let turned = |angle: f64| {
        let mut pose = probe.pose.clone();
        let (s, c) = angle.sin_cos();
        for &i in &inside {
            let at = pose.at[i];
            pose.at[i] = Vector2::new(c * at.x - s * at.y, s * at.x + c * at.y);
            pose.turn[i] += angle;
        }
        probe.with(&pose, [0.0; SIDES], |scenery, pose| {
            let acts = scenery.reference.pairs.iter().filter_map(|joint| scenery.pair(joint, pose));
            acts.map(|act| act.normal.energy + act.shear.energy).sum::<f64>()
        })
    };
    let energy = turned(0.0);
    assert!(energy > 0.0);
    assert!((turned(0.3) / energy - 1.0).abs() < 1e-9);
}

#[test]
fn a_disc_between_walls_is_hertz() {
    let mut pack = loose(1, 1, 1, 0.0);
    let grain = disc(0.0, 0.0, RADIUS, 0.0);
    pack.grains = vec![grain];
    pack.bounds = boxed([-RADIUS; 2], [RADIUS; 2]);
    let (mut rig, _) = Rig::new(&sand("none"), &pack);
    let way = 1e-3 * RADIUS;
    let measures = rig.go(graintwin::command::Ask::Displacement([way, way, 0.0, 0.0, 0.0, 0.0]));
    let compliance = (1.0 - POISSON.powi(2)) / YOUNG + (1.0 - 0.495_f64.powi(2)) / 7e12;
    let want = 4.0 / 3.0 / compliance * RADIUS.sqrt() * way.powf(1.5);
    for side in 0..2 {
        assert!((measures.walls.normal_force[side] / want - 1.0).abs() < 1e-9);
    }
    assert_eq!(measures.walls.normal_force[4], 0.0);
    // Twice as deep as its radius is the box.
    let stress = measures.state.unwrap().stress_walls[0];
    assert!((stress / (want / (2.0 * RADIUS * 2.0 * RADIUS)) - 1.0).abs() < 1e-9);
}

#[test]
fn smooth_discs_under_loads_balance_with_the_contacts() {
    let (mut rig, _) = Rig::new(&sand("none"), &loose(6, 10, 2, 0.0));
    let state = rig.stress([1.1e5, 1e5]).state.unwrap();
    for (at, want) in [(0, 1.1e5), (4, 1e5)] {
        assert!((state.stress_walls[at] / want - 1.0).abs() < 1e-7, "{:?}", state.stress_walls);
        assert!((state.stress_contacts[at] / want - 1.0).abs() < 1e-6);
    }
    assert!(state.residual < 1e-8);
}

#[test]
fn grain_by_grain_finds_the_same_equilibrium() {
    let pack = dense(5, 8, 4, 1e5, 0.5);
    let forces = |method: &str| {
        let mut scene = scene(
            "{friction: {coefficient: 0.5}}",
            &format!("solver: {{method: {method}, tolerance: 1.0e-9}}"),
        );
        scene.solver.max_strain_increment = 1e-5;
        let (mut rig, _) = Rig::new(&scene, &pack);
        rig.biaxial(1e5, 1e-5 * pack.bounds.sides()[1]).walls.normal_force
    };
    let (newton, sweeps) = (forces("newton"), forces("gauss_seidel"));
    for side in 0..4 {
        assert!((newton[side] / sweeps[side] - 1.0).abs() < 1e-6, "{newton:?} {sweeps:?}");
    }
}

#[test]
fn locked_discs_keep_their_turn_and_do_not_fail() {
    // B 3.2.3 and fig. 18: without rotation a pack does not bulge much and carries far more.
    let pack = dense(6, 10, 5, 1e5, 0.6);
    let end = |rotation: &str| {
        let contact = format!("{{friction: {{coefficient: 0.6}}, rotation: {rotation}}}");
        let (mut rig, _) = Rig::new(&scene(&contact, ""), &pack);
        let height = pack.bounds.sides()[1];
        for k in 1..=100 {
            rig.biaxial(1e5, 0.5e-4 * f64::from(k) * height);
        }
        let twin = rig.twin.pack();
        let turned = twin.history.unwrap().rotation.iter().map(|r| r[2].abs()).fold(0.0, f64::max);
        (rig.biaxial(1e5, 0.5e-2 * height).state.unwrap().stress_walls[4], turned)
    };
    let ((free, rolled), (locked, still)) = (end("free"), end("locked"));
    assert!(rolled > 1e-3 && still == 0.0);
    assert!(locked > 1.5 * free, "{locked} {free}");
}

#[test]
fn energy_is_stored_or_dissipated() {
    let pack = dense(6, 10, 6, 1e5, 0.6);
    let (mut rig, _) = Rig::new(&sand("0.6"), &pack);
    let height = pack.bounds.sides()[1];
    let mut last = None;
    for k in 1..=200 {
        last = rig.biaxial(1e5, 0.5e-5 * f64::from(k) * height).state;
    }
    let state = last.unwrap();
    let told = state.slip_energy + state.renewal_energy + state.event_energy;
    assert!(state.slip_energy > 0.0);
    // Walls' work is a trapezoid over increments: the rest falls with their size.
    let off = (state.dissipated_energy - told).abs();
    assert!(off < 2e-3 * state.wall_work.abs(), "{off:e} of {:e}", state.wall_work);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn mirrored_packs_answer_mirrored(seed in 0_u64..1000) {
        let pack = dense(4, 5, seed, 1e5, 0.5);
        let width = pack.bounds.min[0] + pack.bounds.max[0];
        let mut mirrored = pack.clone();
        mirrored.history = None;
        let mut plain = pack.clone();
        plain.history = None;
        mirrored.grains.iter_mut().for_each(|g| g.position[0] = width - g.position[0]);
        let run = |pack: &Pack| {
            let (mut rig, _) = Rig::new(&sand("0.5"), pack);
            rig.biaxial(1e5, 2e-5 * pack.bounds.sides()[1]).walls.normal_force
        };
        let (one, other) = (run(&plain), run(&mirrored));
        for side in 0..4 {
            let twin = if side < 2 { side ^ 1 } else { side };
            prop_assert!((one[side] / other[twin] - 1.0).abs() < 1e-6, "{one:?} {other:?}");
        }
    }
}
