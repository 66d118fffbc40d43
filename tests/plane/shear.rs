//! Simple shear of a box of discs, with and without glue (B 3.3.4).

use graintwin::command::{Ask, Disposition, Shear};
use graintwin::contact::neighbours::Neighbours;
use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::path;
use graintwin::plane::act::Scenery;
use graintwin::plane::balance::Balance;
use graintwin::plane::pose::Pose;
use graintwin::plane::{Workspace, boundary};
use graintwin::report::{Measures, PackState};
use graintwin::scene::Scene;
use graintwin::state::State;
use graintwin::wall::WallTarget;
use nalgebra::{Rotation2, Vector2};

use crate::discs::*;

/// Grains with the contacts `contact` between walls that `walls` describes.
fn scene(walls: &str, contact: &str, rest: &str) -> Scene {
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\nwalls: {{{walls}}}\ncontact: {{{contact}}}\n{rest}"
    );
    graintwin::scene::parse(&text, "shear.yaml".as_ref()).unwrap()
}

const SAND: &str = "friction: {coefficient: 0.6}";
const GLUED: &str = "friction: .inf, glue: true";
const ROUGH: &str = "friction: .inf";
const STRESS: f64 = 1e5;
const LOADED: [WallTarget; 2] = [WallTarget::Stress(STRESS); 2];
const STANDING: [WallTarget; 2] = [WallTarget::Displacement(0.0); 2];

fn shear(tilt: f64, [x, y]: [WallTarget; 2]) -> Ask {
    Ask::Shear(Shear { tilt, targets: [x, x, y, y, WallTarget::Keep, WallTarget::Keep] })
}

/// The same discs seen from behind.
fn mirrored(pack: &Pack) -> Pack {
    let mut mirrored = pack.clone();
    mirrored.bounds.min[0] = -pack.bounds.max[0];
    mirrored.bounds.max[0] = -pack.bounds.min[0];
    mirrored.grains.iter_mut().for_each(|grain| grain.position[0] *= -1.0);
    mirrored
}

/// Stress of walls xx, xy, yx, yy over the load.
fn on_walls(measures: &Measures) -> [f64; 4] {
    let stress = measures.state.unwrap().stress_walls;
    [0, 1, 3, 4].map(|k| stress[k] / STRESS)
}

/// `pose` of the grains at `tilt`, moved to `tilt + more` where walls take glued grains along.
fn moved(model: &Model, state: &State, pose: &Pose, tilt: f64, more: f64) -> Pose {
    let mut to = pose.clone();
    let [_, y, _] = model.start.center();
    for (i, side) in state.glued.iter().enumerate() {
        match side {
            Some(side @ (0 | 1)) => {
                let turn = tilt.atan() - (tilt + more).atan();
                let hinge = Vector2::new(model.start.position(usize::from(*side)), y);
                to.at[i] = hinge + Rotation2::new(turn) * (pose.at[i] - hinge);
                to.turn[i] += turn;
            }
            Some(side) => {
                to.at[i].x += more * (model.start.position(usize::from(*side)) - y);
            }
            None => {}
        }
    }
    to
}

#[test]
fn the_moment_on_the_box_is_the_derivative_of_its_energy_over_the_tilt() {
    let pack = dense(7, 7, 3, STRESS, 0.6);
    for glue in [false, true] {
        let model = Model::new(&pack, &scene(ROUGH, SAND, ""));
        let mut state = State::new(&model);
        if glue {
            state.glued = (0..model.len())
                .map(|i| {
                    let at = state.position[i];
                    let gap = |side: usize| {
                        let inward = if side.is_multiple_of(2) { 1.0 } else { -1.0 };
                        inward * (at[side / 2] - model.start.position(side)) - model.radius[i]
                    };
                    (0..4).find(|&side| gap(side) < 0.0).map(|side| side as u8)
                })
                .collect();
            assert!(state.glued.iter().flatten().count() > 12);
        }
        let (mut work, mut near) = (Workspace::default(), Neighbours::default());
        work.begin(&model, &mut state, &mut near, true);
        // Away from the reference, so that contacts carry shear and walls lean.
        let tilt = 3e-3;
        let mut pose = moved(&model, &state, &work.pose, 0.0, tilt);
        for i in (0..model.len()).filter(|&i| state.glued.get(i).is_none_or(Option::is_none)) {
            let wave = (i as f64).sin();
            let sheared = 0.8 * tilt * (pose.at[i].y - 1e-3);
            pose.at[i] += Vector2::new(sheared, 2e-8 * wave);
            pose.turn[i] += 1e-3 * wave;
        }
        let setup = model.plane.as_ref().unwrap();
        let evaluate = |tilt: f64, pose: &Pose| {
            let mut bodies = Vec::new();
            boundary::bodies(&model, &state.displacement, tilt, &mut bodies);
            let mut balance = Balance::default();
            let scenery = Scenery {
                model: &model,
                setup,
                reference: &work.reference,
                bodies: &bodies,
                membranes: &[],
                carries: &state.carries,
                glued: &state.glued,
                goes_on: false,
            };
            balance.evaluate(&scenery, pose);
            balance
        };
        let here = evaluate(tilt, &pose);
        let step = 1e-7;
        let [low, high] = [-step, step].map(|more| {
            evaluate(tilt + more, &moved(&model, &state, &pose, tilt, more)).potential()
        });
        let found = (high - low) / (2.0 * step);
        assert!((found / here.tilt - 1.0).abs() < 1e-6, "{glue}: {found} {}", here.tilt);
    }
}

#[test]
fn glued_grains_go_and_turn_with_their_walls() {
    let pack = dense(8, 8, 2, STRESS, 0.6);
    let (mut rig, _) = Rig::new(&scene(GLUED, SAND, ""), &pack);
    let tilt = 4e-3;
    let way = 1e-6;
    let ask = shear(tilt, [WallTarget::Displacement(way), WallTarget::Displacement(0.0)]);
    let measures = rig.go(ask);
    let grains = measures.grains.unwrap();
    let bounds = &pack.bounds;
    let middle = bounds.center()[1];
    let (mut sides, mut platens) = (0, 0);
    for (grain, displacement) in pack.grains.iter().zip(&grains.displacement) {
        let [x, y, _] = grain.position;
        let touches = [x - bounds.min[0], bounds.max[0] - x, y - bounds.min[1], bounds.max[1] - y]
            .map(|gap| gap < grain.radius);
        let count = touches.iter().filter(|touches| **touches).count();
        if count != 1 {
            continue;
        }
        if touches[2] || touches[3] {
            let wall = if touches[2] { bounds.min[1] } else { bounds.max[1] };
            assert!((displacement[0] - tilt * (wall - middle)).abs() < 1e-16);
            assert!(displacement[1].abs() < 1e-18);
            platens += 1;
        } else {
            let (wall, way) = if touches[0] { (bounds.min[0], way) } else { (bounds.max[0], -way) };
            let from = Vector2::new(x - wall, y - middle);
            let to = Vector2::new(x + displacement[0] - wall - way, y + displacement[1] - middle);
            // Turned by the angle of the wall about its middle.
            let turned = Rotation2::new(-tilt.atan()) * from;
            assert!((to - turned).norm() < 1e-16, "{to} {turned}");
            sides += 1;
        }
    }
    assert!(sides > 4 && platens > 4);
}

#[test]
fn walls_keep_their_loads_and_moments_balance() {
    let pack = dense(10, 10, 1, STRESS, 0.6);
    for walls in [GLUED, ROUGH] {
        let (mut rig, _) = Rig::new(&scene(walls, SAND, ""), &pack);
        rig.stress([STRESS; 2]);
        for k in 1..=8 {
            let measures = rig.go(shear(1e-3 * f64::from(k), LOADED));
            let [xx, xy, _, yy] = on_walls(&measures);
            assert!((xx - 1.0).abs() < 1e-7 && (yy - 1.0).abs() < 1e-7, "{xx} {yy}");
            assert!(xy < 0.0);
            let inner = measures.shear.unwrap().inner_stress.map(|stress| stress / STRESS);
            // Every grain in the middle is free, and its moments balance.
            assert!((inner[1] - inner[2]).abs() < 1e-6, "{inner:?}");
            if walls == ROUGH {
                let contacts = measures.state.unwrap().stress_contacts;
                // Levers at the walls are those of the reference, before grains moved on to them.
                assert!((contacts[1] - contacts[3]).abs() < 1e-5 * STRESS, "{contacts:?}");
            }
        }
    }
}

#[test]
fn the_same_shear_the_other_way_round_mirrors_everything() {
    let pack = Pack { history: None, ..dense(9, 9, 4, STRESS, 0.6) };
    let run = |pack: &Pack, sign: f64| {
        let (mut rig, _) = Rig::new(&scene(GLUED, SAND, ""), pack);
        rig.stress([STRESS; 2]);
        (1..=5).map(|k| rig.go(shear(5e-4 * sign * f64::from(k), LOADED))).last().unwrap()
    };
    let (one, other) = (run(&pack, 1.0), run(&mirrored(&pack), -1.0));
    let [of_one, of_other] = [&one, &other].map(on_walls);
    for (k, sign) in [1.0, -1.0, -1.0, 1.0].into_iter().enumerate() {
        assert!((of_one[k] - sign * of_other[k]).abs() < 1e-6, "{of_one:?} {of_other:?}");
    }
    let (one, other) = (one.shear.unwrap(), other.shear.unwrap());
    assert!((one.mean_rotation + other.mean_rotation).abs() < 1e-6 * one.tilt);
    assert!((one.stress_direction + other.stress_direction).abs() < 1e-5);
    assert!((one.strain_direction + other.strain_direction).abs() < 1e-5);
}

#[test]
fn the_work_of_the_walls_is_stored_or_lost() {
    let pack = dense(9, 9, 5, STRESS, 0.6);
    for walls in [GLUED, ROUGH] {
        let (mut rig, _) = Rig::new(&scene(walls, SAND, ""), &pack);
        let before = rig.stress([STRESS; 2]).state.unwrap();
        let (mut after, mut passed) = (before, 0.0);
        for k in 1..=20 {
            let next = rig.go(shear(1e-5 * f64::from(k), LOADED)).state.unwrap();
            passed += (next.wall_work - after.wall_work).abs();
            after = next;
        }
        let told = |state: &PackState| {
            state.stored_energy + state.slip_energy + state.renewal_energy + state.event_energy
        };
        let work = after.wall_work - before.wall_work;
        // The work is that of straight lines between equilibria.
        let left = work - (told(&after) - told(&before));
        assert!(left.abs() < 1e-3 * passed, "{walls}: {left:e} of {passed:e}");
    }
}

#[test]
fn an_elastic_pack_returns() {
    let pack = dense(9, 9, 6, STRESS, 0.0);
    let (mut rig, _) = Rig::new(&scene("glue: true", "normal: hertz", ""), &pack);
    let start = on_walls(&rig.go(shear(0.0, STANDING)));
    let there = on_walls(&rig.go(shear(2e-5, STANDING)));
    let back = on_walls(&rig.go(shear(0.0, STANDING)));
    let change = (0..4).map(|k| (there[k] - start[k]).abs()).fold(0.0, f64::max);
    assert!(change > 1e-5, "{start:?} {there:?}");
    for k in 0..4 {
        assert!((back[k] - start[k]).abs() < 1e-3 * change + 1e-7, "{start:?} {back:?}");
    }
}

#[test]
fn what_cannot_be_tilted_is_refused() {
    let pack = dense(5, 5, 7, STRESS, 0.6);
    let (mut rig, _) = Rig::new(&scene(GLUED, SAND, "node: {limits: {strain: 0.01}}"), &pack);
    for tilt in [f64::NAN, f64::INFINITY, 1.0, -1.5] {
        assert_eq!(rig.ask(shear(tilt, STANDING)).disposition, Disposition::Invalid);
    }
    assert_eq!(rig.ask(shear(0.02, STANDING)).disposition, Disposition::Limit);
    let tilt = |measures: Measures| measures.shear.unwrap().tilt;
    assert_eq!(tilt(rig.go(shear(1e-4, STANDING))), 1e-4);
    // Other commands leave it as it is.
    assert_eq!(tilt(rig.go(Ask::Displacement([1e-9, 0.0, 0.0, 0.0, 0.0, 0.0]))), 1e-4);
}

#[test]
fn grains_turn_half_as_far_as_the_walls_and_stress_and_strain_are_coaxial() {
    let pack = dense(16, 16, 8, STRESS, 0.6);
    let (mut rig, _) = Rig::new(&scene(GLUED, SAND, ""), &pack);
    rig.stress([STRESS; 2]);
    let before = rig.go(shear(0.0, LOADED)).shear.unwrap();
    let after = (1..=10).map(|k| rig.go(shear(1e-4 * f64::from(k), LOADED))).last().unwrap();
    let after = after.shear.unwrap();
    // The spin of a continuum, and (30).
    let ratio = (before.mean_rotation - after.mean_rotation) / after.tilt;
    assert!((0.4..0.6).contains(&ratio), "{ratio}");
    // What is added to stress and strain has its major direction at 45° against the tilt.
    let direction = |one: &[f64; 4], other: &[f64; 4]| {
        let [xx, xy, yx, yy] = std::array::from_fn(|k| other[k] - one[k]);
        0.5 * (xy + yx).atan2(xx - yy).to_degrees()
    };
    let stress = direction(&before.inner_stress, &after.inner_stress);
    let strain = direction(&before.strain, &after.strain);
    assert!((strain + 45.0).abs() < 6.0, "{strain}");
    assert!((stress - strain).abs() < 10.0, "{stress} {strain}");
}

#[test]
fn a_load_path_tilts_in_equal_parts() {
    let path = "load_path:\n  - shear: {tilt: 0.01, increments: 4}\n  - shear: {tilt: -0.02, \
                targets: {x_min: {stress: 1.0e5}, x_max: {stress: 1.0e5}}, increments: 2}\n";
    let scene = scene(GLUED, SAND, path);
    let bounds = boxed([0.0; 2], [1e-3, 1e-3]);
    let commands = path::commands_of(&scene, "".as_ref(), &bounds).unwrap();
    let tilts: Vec<f64> = commands
        .iter()
        .map(|command| match command.ask {
            Ask::Shear(Shear { tilt, .. }) => tilt,
            _ => panic!("{command:?}"),
        })
        .collect();
    assert_eq!(tilts.len(), 6);
    for (tilt, want) in tilts.iter().zip([0.0025, 0.005, 0.0075, 0.01, 0.0, -0.01]) {
        assert!((tilt - want).abs() < 1e-17, "{tilts:?}");
    }
    assert_eq!(commands[5].ask.targets()[1], WallTarget::Stress(1e5));
    assert_eq!(commands[5].ask.targets()[2], WallTarget::Keep);
}
