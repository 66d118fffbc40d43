//! Limits of travel, rate, strain and force, with and without clamping, through `Twin::apply`.

use std::sync::OnceLock;

use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::pack::Pack;
use graintwin::report::{Demand, Report};
use graintwin::scene::Limits;
use graintwin::twin::Settings;
use graintwin::wall::{self, WallTarget};

use crate::packs::{Rig, absolute, bits, by_strain, made, off, scene};

const NONE: Limits = Limits { travel: 0.0, rate: 0.0, strain: 0.0, force: 0.0, clamp: false };

/// A pack at 1 MPa.
fn pack() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made(60, 1e6, 21))
}

fn rig(limits: Limits) -> Rig {
    let mut scene = scene();
    scene.node.limits = limits;
    Rig::start(&scene, pack()).0
}

/// Moves z_max alone.
fn top(displacement: f64) -> [f64; wall::COUNT] {
    [0.0, 0.0, 0.0, 0.0, 0.0, displacement]
}

fn at(seconds: f64, command: Command) -> Command {
    Command { stamp: Stamp::from_seconds(seconds), ..command }
}

/// Sends a command that must be refused at a limit, which the text names.
fn refused(rig: &mut Rig, displacement: [f64; wall::COUNT], key: &str) -> Report {
    let before = bits(&rig.twin.pack());
    let report = rig.send(displacement);
    assert_eq!(report.disposition, Disposition::Limit, "{}", report.text);
    assert!(report.text.contains(key), "{}", report.text);
    assert!(report.measures.is_none());
    assert!(bits(&rig.twin.pack()) == before, "the specimen moved");
    report
}

/// Sends a command that must be clamped at a limit, which the text names; returns where the walls
/// went and their forces.
fn clamped(
    rig: &mut Rig,
    displacement: [f64; wall::COUNT],
    key: &str,
) -> ([f64; wall::COUNT], [f64; wall::COUNT]) {
    let report = rig.send(displacement);
    assert_eq!(report.disposition, Disposition::Clamped, "{}", report.text);
    assert!(report.text.contains(key), "{}", report.text);
    let walls = report.measures.unwrap().walls;
    (walls.displacement, walls.normal_force)
}

#[test]
fn a_wall_may_travel_up_to_the_limit_either_way_and_not_beyond() {
    let mut rig = rig(Limits { travel: 1e-8, ..NONE });
    rig.go(top(1e-8));
    rig.go(top(-1e-8));
    let report = refused(&mut rig, top(1.001e-8), "node.limits.travel");
    assert!(report.text.contains("z_max would be 1.001e-8 m"), "{}", report.text);
    refused(&mut rig, top(-1.001e-8), "1e-8 m are allowed");
    // Increments add up to the same limit, and a refused one does not count.
    rig.go(top(0.9e-8));
    let step = |sequence, by| Command { mode: Mode::Increment, ..absolute(sequence, top(by)) };
    let sequence = rig.sequence;
    let report = rig.twin.apply(&step(sequence + 1, 0.2e-8), Demand::ALL);
    assert_eq!(report.disposition, Disposition::Limit);
    let report = rig.twin.apply(&step(sequence + 2, 0.05e-8), Demand::ALL);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
}

#[test]
fn clamped_walls_go_straight_on_until_one_of_them_meets_its_limit() {
    let mut rig = rig(Limits { travel: 1e-8, clamp: true, ..NONE });
    let mut target = top(4e-8);
    target[0] = 2e-8;
    let (displacement, _) = clamped(&mut rig, target, "node.limits.travel");
    // A quarter of the way for both.
    assert!(off(displacement[5], 1e-8) < 1e-12, "{displacement:?}");
    assert!(off(displacement[0], 0.5e-8) < 1e-12, "{displacement:?}");
    // The rest of the walls did not move, and holding the position is no offence.
    assert_eq!(displacement[1..5], [0.0; 4]);
    assert_eq!(rig.go(displacement).walls.displacement, displacement);
}

#[test]
fn a_wall_beyond_a_limit_that_was_tightened_may_come_back_only() {
    let mut rig = rig(NONE);
    rig.go(top(1e-8));
    let limits = Limits { travel: 2e-9, ..NONE };
    rig.twin.set(&Settings { limits, ..Settings::of(&scene()) });
    refused(&mut rig, top(1.1e-8), "node.limits.travel");
    refused(&mut rig, top(-1.1e-8), "node.limits.travel");
    rig.go(top(0.5e-8));
    refused(&mut rig, top(0.6e-8), "node.limits.travel");
    rig.go(top(0.0));
}

#[test]
fn strain_is_limited_by_axis_for_both_walls_together() {
    let mut rig = rig(Limits { strain: 1e-4, ..NONE });
    let bounds = pack().bounds;
    rig.go(by_strain(&bounds, [0.9e-4, -0.9e-4, 0.0]));
    let report = refused(&mut rig, by_strain(&bounds, [0.0, 1.1e-4, 0.0]), "node.limits.strain");
    assert!(report.text.contains("along y"), "{}", report.text);
    refused(&mut rig, by_strain(&bounds, [0.0, 0.0, -1.1e-4]), "along z");
    // Both walls of a pair in the same direction strain nothing.
    let shift = 0.5e-3 * bounds.sides()[2];
    rig.go([0.0, 0.0, 0.0, 0.0, shift, -shift]);
    let mut rig = self::rig(Limits { strain: 1e-4, clamp: true, ..NONE });
    let target = by_strain(&bounds, [2e-4, 0.0, 0.0]);
    let (displacement, _) = clamped(&mut rig, target, "node.limits.strain");
    assert!(off(displacement[0] + displacement[1], 1e-4 * bounds.sides()[0]) < 1e-9);
}

#[test]
fn the_rate_is_the_change_of_the_target_over_the_time_between_the_stamps() {
    let mut rig = rig(Limits { rate: 1e-8, ..NONE });
    let mut send = |sequence: u64, seconds: f64, to: f64| {
        rig.twin.apply(&at(seconds, absolute(sequence, top(to))), Demand::ALL)
    };
    let is = |report: Report, disposition: Disposition| {
        assert_eq!(report.disposition, disposition, "{}", report.text);
        report.text
    };
    // Nothing tells how long the walls had for the first.
    is(send(1, 10.0, 3e-8), Disposition::Applied);
    is(send(2, 12.0, 4.9e-8), Disposition::Applied);
    let text = is(send(3, 13.0, 6.0e-8), Disposition::Limit);
    assert!(
        text.contains("z_max would move at 1.09") && text.contains("node.limits.rate"),
        "{text}"
    );
    // What was refused does not set the clock: 2 s are for this one.
    is(send(4, 14.0, 6.0e-8), Disposition::Applied);
    // No time, or time that goes back, allows no way.
    let text = is(send(5, 14.0, 6.1e-8), Disposition::Limit);
    assert!(text.contains("in no time"), "{text}");
    is(send(6, 9.0, 6.1e-8), Disposition::Limit);
    is(send(7, 9.0, 6.0e-8), Disposition::Applied);
    // Another session whose clock is behind: nothing tells the time. One that is ahead is held.
    let other = |session: &str, seconds, to| {
        at(seconds, Command { session: session.into(), ..absolute(1, top(to)) })
    };
    is(rig.twin.apply(&other("b", 1.0, 0.0), Demand::ALL), Disposition::Applied);
    is(rig.twin.apply(&other("c", 2.0, 5e-8), Demand::ALL), Disposition::Limit);
}

#[test]
fn a_clamped_rate_takes_as_much_of_the_way_as_the_time_allows() {
    let mut rig = rig(Limits { rate: 1e-8, clamp: true, ..NONE });
    rig.twin.apply(&at(1.0, absolute(1, top(0.0))), Demand::ALL);
    let report = rig.twin.apply(&at(1.5, absolute(2, top(2e-8))), Demand::ALL);
    assert_eq!(report.disposition, Disposition::Clamped);
    let first = report.measures.unwrap().walls.displacement[5];
    assert!(off(first, 0.5e-8) < 1e-12, "{first}");
    // In no time it stays, bit for bit.
    let report = rig.twin.apply(&at(1.5, absolute(3, top(2e-8))), Demand::ALL);
    assert_eq!(report.disposition, Disposition::Clamped);
    assert_eq!(report.measures.unwrap().walls.displacement[5], first);
}

/// Largest force on a wall at a displacement of z_max, without any limit.
fn force_at(displacement: f64) -> f64 {
    rig(NONE).go(top(displacement)).walls.normal_force.into_iter().fold(0.0, f64::max)
}

#[test]
fn an_increment_beyond_the_force_limit_is_undone() {
    let far = 2e-6;
    let (before, after) = (force_at(0.0), force_at(far));
    assert!(after > 1.5 * before, "{before} {after}");
    let force = 0.5 * (before + after);
    let mut rig = rig(Limits { force, ..NONE });
    let report = refused(&mut rig, top(far), "node.limits.force");
    assert!(report.text.contains("N are allowed"), "{}", report.text);
    // The twin goes on from where it was, as one that never tried.
    let mut other = self::rig(NONE);
    let found = rig.go(top(1e-9)).walls.normal_force;
    let expected = other.go(top(1e-9)).walls.normal_force;
    for w in 0..wall::COUNT {
        assert!(off(found[w], expected[w]) < 1e-9, "{found:?} {expected:?}");
    }
}

#[test]
fn a_clamped_force_stops_at_the_last_64th_of_the_way_within_the_limit() {
    let far = 2e-6;
    let force = 0.5 * (force_at(0.0) + force_at(far));
    let mut rig = rig(Limits { force, clamp: true, ..NONE });
    let (displacement, forces) = clamped(&mut rig, top(far), "node.limits.force");
    assert!(forces.iter().all(|&found| found <= force * (1.0 + 1e-6)), "{forces:?} {force}");
    let part = displacement[5] / far;
    assert!((part * 64.0 - (part * 64.0).round()).abs() < 1e-9 && part > 0.0, "{part}");
    assert!(force_at(displacement[5] + far / 64.0) > force);
    // What the walls do since is what they were let: an increment of nothing keeps them there.
    rig.sequence += 1;
    let nothing = Command { mode: Mode::Increment, ..absolute(rig.sequence, [0.0; 6]) };
    let report = rig.twin.apply(&nothing, Demand::ALL);
    assert_eq!(report.measures.unwrap().walls.displacement, displacement);
}

#[test]
fn a_pack_beyond_the_force_limit_may_be_unloaded_only() {
    let mut rig = rig(Limits { force: 1e-6 * force_at(0.0), ..NONE });
    refused(&mut rig, top(1e-8), "node.limits.force");
    rig.go([-1e-9; 6]);
}

#[test]
fn a_load_beyond_the_force_limit_is_refused_before_anything_moves() {
    let area = pack().bounds.area(5);
    let now = force_at(0.0);
    let mut rig = rig(Limits { force: 2.0 * now, ..NONE });
    for target in [WallTarget::Force(2.1 * now), WallTarget::Stress(2.1 * now / area)] {
        let mut targets = [WallTarget::Keep; wall::COUNT];
        targets[5] = target;
        rig.sequence += 1;
        let command = Command { ask: Ask::Targets(targets), ..absolute(rig.sequence, [0.0; 6]) };
        let report = rig.twin.apply(&command, Demand::ALL);
        assert_eq!(report.disposition, Disposition::Limit, "{}", report.text);
        assert!(report.text.contains("node.limits.force"), "{}", report.text);
        assert!(report.measures.is_none());
    }
}

/// A command that puts a wall under `force` N.
fn under(wall: usize, force: f64) -> Command {
    let sequence = 1;
    let mut targets = [WallTarget::Keep; wall::COUNT];
    targets[wall] = WallTarget::Force(force);
    Command { ask: Ask::Targets(targets), ..absolute(sequence, [0.0; 6]) }
}

#[test]
fn a_load_that_takes_its_wall_beyond_the_travel_or_strain_is_undone() {
    let now = rig(NONE).go(top(0.0)).walls.normal_force[5];
    let loaded = rig(NONE).twin.apply(&under(5, 2.0 * now), Demand::ALL).measures.unwrap();
    let way = loaded.walls.displacement[5];
    assert!(way > 0.0 && off(loaded.walls.normal_force[5], 2.0 * now) < 1e-6);
    let strain = 0.5 * way / pack().bounds.sides()[2];
    for (limits, key) in [
        (Limits { travel: 0.5 * way, ..NONE }, "node.limits.travel"),
        (Limits { strain, ..NONE }, "node.limits.strain"),
    ] {
        let mut rig = rig(limits);
        let before = bits(&rig.twin.pack());
        let report = rig.twin.apply(&under(5, 2.0 * now), Demand::ALL);
        assert_eq!(report.disposition, Disposition::Limit, "{}", report.text);
        assert!(report.text.contains(key) && report.measures.is_none(), "{}", report.text);
        assert!(bits(&rig.twin.pack()) == before);
        // It is not under the load now: a boundary command moves it.
        rig.sequence = 1;
        let report = rig.send(top(1e-9));
        assert_eq!(report.measures.unwrap().walls.displacement, top(1e-9));

        // Clamped, it carries the part of the load that leads to the limit, and goes on carrying it.
        let mut rig = self::rig(Limits { clamp: true, ..limits });
        let report = rig.twin.apply(&under(5, 2.0 * now), Demand::ALL);
        assert_eq!(report.disposition, Disposition::Clamped, "{}", report.text);
        let walls = report.measures.unwrap().walls;
        let (force, found) = (walls.normal_force[5], walls.displacement[5]);
        assert!(force > 1.1 * now && force < 1.9 * now, "{force} {now}");
        assert!(found <= 0.5 * way * (1.0 + 1e-9) && found > 0.4 * way, "{found} {way}");
        rig.sequence = 1;
        let again = rig.send([0.0; 6]).measures.unwrap().walls.normal_force[5];
        assert!(off(again, force) < 1e-6, "{again} {force}");
    }
}

#[test]
fn a_clamped_load_is_as_large_as_the_force_limit() {
    // The pair along x carries most already.
    let now = force_at(0.0);
    let force = 1.5 * now;
    let mut rig = rig(Limits { force, clamp: true, ..NONE });
    let report = rig.twin.apply(&under(1, 10.0 * now), Demand::ALL);
    assert_eq!(report.disposition, Disposition::Clamped, "{}", report.text);
    let found = report.measures.unwrap().walls.normal_force;
    assert!(found.iter().all(|&found| found <= force * (1.0 + 1e-6)), "{found:?} {force}");
    assert!(off(found[1], force) < 1e-6, "{found:?} {force}");
    // Without clamping a load of just the limit is no offence either.
    let mut rig = self::rig(Limits { force, ..NONE });
    let report = rig.twin.apply(&under(1, force), Demand::ALL);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
}

#[test]
fn the_box_keeps_its_hard_limits_with_clamping_too() {
    let mut rig = rig(Limits { travel: 1e-8, clamp: true, ..NONE });
    let sides = pack().bounds.sides();
    refused(&mut rig, top(0.6 * sides[2]), "m apart");
}

#[test]
fn a_repeated_command_that_was_beyond_a_limit_says_so_again() {
    let mut rig = rig(Limits { travel: 1e-8, ..NONE });
    let first = refused(&mut rig, top(2e-8), "node.limits.travel");
    let again = rig.twin.apply(&absolute(1, top(2e-8)), Demand::ALL);
    assert_eq!(again.disposition, Disposition::Duplicate);
    assert!(again.text.contains("Limit") && again.text.contains(&first.text), "{}", again.text);
}
