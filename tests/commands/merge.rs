//! Commands that are late and become one increment.

use std::sync::OnceLock;

use graintwin::command::merge::mergeable;
use graintwin::command::request::{Asked, Intake, Request};
use graintwin::command::{Ask, Command, Disposition, Mode};
use graintwin::pack::Pack;
use graintwin::report::{Demand, Report};
use graintwin::scene::Limits;
use graintwin::twin::Merged;
use graintwin::wall::{self, Control, Load, Setpoint, WallTarget, standing};
use proptest::prelude::*;

use crate::packs::{Rig, absolute, bits, by_strain, made, off, scene};

/// A pack at 1 MPa.
fn pack() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made(60, 1e6, 21))
}

fn by(strain: f64) -> [f64; wall::COUNT] {
    by_strain(&pack().bounds, [0.0, 0.0, strain])
}

/// Absolute commands that strain z.
fn ramp(strains: &[f64]) -> Vec<Command> {
    (1..).zip(strains).map(|(sequence, &strain)| absolute(sequence, by(strain))).collect()
}

fn together(rig: &mut Rig, commands: &[Command]) -> Vec<Report> {
    match rig.twin.apply_merged(commands, Demand::ALL) {
        Merged::Together(reports) => reports,
        Merged::Apart(count) => panic!("{count} apart"),
    }
}

fn apart(rig: &mut Rig, commands: &[Command]) -> usize {
    let before = bits(&rig.twin.pack());
    match rig.twin.apply_merged(commands, Demand::ALL) {
        Merged::Apart(count) => {
            assert!(bits(&rig.twin.pack()) == before);
            count
        }
        Merged::Together(reports) => panic!("{reports:?}"),
    }
}

#[test]
fn merged_commands_are_one_increment_to_the_last_and_each_has_its_report() {
    let commands = ramp(&[1e-5, 2e-5, 5e-5]);
    let mut rig = Rig::start(&scene(), pack()).0;
    let reports = together(&mut rig, &commands);
    let all: Vec<_> = reports.iter().map(|one| (one.sequence, one.increment)).collect();
    assert_eq!(all, [(1, 1), (2, 1), (3, 1)]);
    assert!(reports.iter().all(|one| one.disposition == Disposition::Applied));
    assert_eq!(reports[0].text, "merged into sequence 3");
    assert!(reports[2].text.contains("3 commands merged, from sequence 1 on"));
    assert!(reports[..2].iter().all(|one| one.measures.is_none() && one.substeps == 0));
    let found = reports[2].measures.as_ref().unwrap().walls;
    let mut other = Rig::start(&scene(), pack()).0;
    let expected = other.go(by(5e-5)).walls;
    assert_eq!(found, expected);
    // The last is the one that a duplicate repeats, and the next follows upon it.
    let again = rig.twin.apply(&commands[2], Demand::ALL);
    assert_eq!((again.disposition, again.increment), (Disposition::Duplicate, 1));
    let next = Command { mode: Mode::Increment, ..absolute(4, by(1e-5)) };
    let report = rig.twin.apply(&next, Demand::ALL);
    assert_eq!((report.disposition, report.increment), (Disposition::Applied, 2));
    for w in [4, 5] {
        let displacement = report.measures.as_ref().unwrap().walls.displacement[w];
        assert!(off(displacement, by(6e-5)[w]) < 1e-12);
    }
}

#[test]
fn commands_behind_one_that_would_be_refused_are_left_out() {
    let mut scene = scene();
    scene.node.limits = Limits { travel: by(3e-5)[5], ..Limits::default() };
    let mut rig = Rig::start(&scene, pack()).0;
    let commands = ramp(&[1e-5, 2e-5, 5e-5, 6e-5]);
    assert_eq!(together(&mut rig, &commands).len(), 2);
    assert_eq!(apart(&mut rig, &commands[2..]), 1);
    assert_eq!(rig.twin.apply(&commands[2], Demand::ALL).disposition, Disposition::Limit);
    // A first that is too old, held or served already is served alone too.
    rig.twin.hold(true).unwrap();
    assert_eq!(apart(&mut rig, &ramp(&[1e-5, 2e-5])), 1);
    rig.twin.hold(false).unwrap();
    assert_eq!(apart(&mut rig, &ramp(&[1e-5, 2e-5])), 1);
    assert_eq!(apart(&mut rig, &[]), 1);
}

#[test]
fn a_missing_command_before_the_first_is_reported_with_it() {
    let mut rig = Rig::start(&scene(), pack()).0;
    rig.go([0.0; 6]);
    let commands = [absolute(4, by(1e-5)), absolute(5, by(2e-5))];
    let reports = together(&mut rig, &commands);
    assert_eq!(reports[0].text, "2 commands missing before it; merged into sequence 5");
}

#[test]
fn a_way_that_ends_beyond_the_force_limit_is_to_be_served_one_by_one() {
    let mut free = Rig::start(&scene(), pack()).0;
    let commands = ramp(&[1e-4, 2e-4, 1e-3]);
    let most = |measures: &graintwin::report::Measures| {
        measures.walls.normal_force.into_iter().fold(0.0, f64::max)
    };
    let second = most(&free.go(by(2e-4)));
    let third = most(&free.go(by(1e-3)));
    assert!(third > second);
    let mut scene = scene();
    scene.node.limits = Limits { force: 0.5 * (second + third), ..Limits::default() };
    for clamp in [false, true] {
        scene.node.limits.clamp = clamp;
        let mut rig = Rig::start(&scene, pack()).0;
        assert_eq!(apart(&mut rig, &commands), 3);
        let mut alone = |command| rig.twin.apply(command, Demand::ALL).disposition;
        let found: Vec<_> = commands.iter().map(&mut alone).collect();
        let end = if clamp { Disposition::Clamped } else { Disposition::Limit };
        assert_eq!(found, [Disposition::Applied, Disposition::Applied, end]);
    }
}

fn count(now: &Setpoint, commands: &[Command]) -> usize {
    let waiting: Vec<Intake> = commands.iter().cloned().map(Intake::Command).collect();
    mergeable(now, &waiting)
}

#[test]
fn a_reversal_an_increment_a_load_another_session_a_gap_and_a_request_end_a_merge() {
    let now = standing(&[0.0; 6]);
    assert_eq!(count(&now, &ramp(&[1e-5, 2e-5, 2e-5, 3e-5])), 4);
    assert_eq!(count(&now, &ramp(&[1e-5, 2e-5, 1.9e-5])), 2);
    // From where the walls are, the first of these turns round already.
    assert_eq!(count(&standing(&by(3e-5)), &ramp(&[2e-5, 2.5e-5])), 1);
    let third = |change: fn(&mut Command)| {
        let mut commands = ramp(&[1e-5, 2e-5, 3e-5, 4e-5]);
        change(&mut commands[2]);
        count(&now, &commands)
    };
    assert_eq!(third(|command| command.mode = Mode::Increment), 2);
    assert_eq!(third(|command| command.session = "another".into()), 2);
    assert_eq!(third(|command| command.sequence = 4), 2);
    assert_eq!(third(|command| command.ask = Ask::Displacement([f64::NAN; 6])), 2);
    let targets = |target| {
        let mut targets = [WallTarget::Keep; 6];
        targets[5] = target;
        Ask::Targets(targets)
    };
    for (target, expected) in [
        (WallTarget::Displacement(1.0), 3),
        (WallTarget::Keep, 3),
        (WallTarget::Force(1.0), 2),
        (WallTarget::Stress(1.0), 2),
        (WallTarget::Unknown(9, 1.0), 2),
    ] {
        let mut commands = ramp(&[1e-5, 2e-5, 3e-5]);
        commands[2].ask = targets(target);
        assert_eq!(count(&now, &commands), expected, "{target:?}");
    }
    let [one, two, three] = ramp(&[1e-5, 2e-5, 3e-5]).try_into().unwrap();
    let request = Intake::Request(Asked::new(Request::Hold(true), |_| {}));
    assert_eq!(mergeable(&now, &[one.clone().into(), two.into(), request, three.into()]), 2);
    assert_eq!(mergeable(&now, &[Intake::Malformed(one, String::new())]), 0);
    // A wall under a load keeps it whatever a boundary command says, and cannot be sent elsewhere.
    let mut loaded = now;
    loaded[5] = Control::Load(Load::Stress(1e6));
    assert_eq!(count(&loaded, &ramp(&[1e-5, 2e-5])), 2);
    let mut commands = ramp(&[1e-5, 2e-5]);
    commands[1].ask = targets(WallTarget::Displacement(1e-6));
    assert_eq!(count(&loaded, &commands), 1);
}

prop_compose! {
    /// Few values, so that runs in one direction happen.
    fn command()(
        skip in prop_oneof![6 => Just(0u64), 1 => 1u64..3],
        another in prop::bool::weighted(0.1),
        increment in prop::bool::weighted(0.1),
        to in prop::array::uniform6(prop_oneof![
            8 => (-1i32..3).prop_map(f64::from), 1 => Just(f64::NAN)
        ]),
    ) -> (u64, Command) {
        let session = if another { "another" } else { "test" };
        let mode = if increment { Mode::Increment } else { Mode::Absolute };
        (skip, Command { session: session.into(), mode, ..absolute(0, to) })
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn as_many_are_merged_as_lead_every_wall_on_in_one_direction(
        commands in prop::collection::vec(command(), 0..8),
        start in prop::array::uniform6((-1i32..3).prop_map(f64::from)),
    ) {
        let mut sequence = 0;
        let commands: Vec<Command> = commands.into_iter().map(|(skip, command)| {
            sequence += 1 + skip;
            Command { sequence, ..command }
        }).collect();
        let leads_on = |n: usize| {
            let first = &commands[..n];
            let column = |w: usize| {
                let mut column = vec![start[w]];
                column.extend(first.iter().map(|command| command.ask.numbers()[w]));
                column
            };
            first.iter().all(|command| command.mode == Mode::Absolute)
                && first.windows(2).all(|two| two[0].session == two[1].session
                    && two[0].sequence + 1 == two[1].sequence)
                && (0..wall::COUNT).all(|w| column(w).is_sorted()
                    || column(w).is_sorted_by(|a, b| a >= b))
        };
        let merged = count(&standing(&start), &commands);
        prop_assert!(leads_on(merged));
        prop_assert!(merged == commands.len() || !leads_on(merged + 1));
    }
}
