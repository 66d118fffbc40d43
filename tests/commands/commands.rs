//! What becomes of a command, through `Twin::apply`: every row of interfaces.md, "What becomes of
//! a command". Whatever is refused leaves the specimen as it was, bit for bit.
#![allow(clippy::needless_range_loop, reason = "walls and axes index several arrays alike")]

use std::sync::OnceLock;

use graintwin::command::{Ask, Command, Disposition, Mode};
use graintwin::pack::Pack;
use graintwin::report::{Demand, Report};
use graintwin::scene::Scene;
use graintwin::wall::{self, Bounds};
use proptest::prelude::*;

use crate::packs::{
    Rig, absolute, bead, bits, by_strain, centered, close, made, off, scene, state,
};

/// A pack at 1 MPa.
fn pack() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made(60, 1e6, 21))
}

fn rig() -> Rig {
    Rig::start(&scene(), pack()).0
}

/// An absolute target within reach: a strain of 5e-5 along z.
fn small() -> [f64; wall::COUNT] {
    by_strain(&pack().bounds, [0.0, 0.0, 5e-5])
}

fn apply(rig: &mut Rig, command: &Command) -> Report {
    rig.twin.apply(command, Demand::ALL)
}

/// Applies a command that must be refused as `disposition`; nothing may change.
fn refused(rig: &mut Rig, command: &Command, disposition: Disposition) -> Report {
    let before = bits(&rig.twin.pack());
    let report = apply(rig, command);
    assert_eq!(report.disposition, disposition, "{}", report.text);
    assert!(!report.text.is_empty());
    assert!(report.measures.is_none());
    assert_eq!((report.session.as_str(), report.sequence), (&*command.session, command.sequence));
    assert_eq!(report.stamp, command.stamp);
    assert!(bits(&rig.twin.pack()) == before, "the specimen moved");
    report
}

fn increment(sequence: u64, displacement: [f64; wall::COUNT]) -> Command {
    Command { mode: Mode::Increment, ..absolute(sequence, displacement) }
}

/// Where the walls are \[m\], inward since the start.
fn displacement(rig: &Rig) -> [f64; wall::COUNT] {
    let (now, start) = (rig.twin.pack().bounds, pack().bounds);
    std::array::from_fn(|w| (now.position(w) - start.position(w)) * wall::inward(w))
}

/// Whether the walls are at `target`, up to the rounding of their positions.
fn sent_to(rig: &Rig, target: [f64; wall::COUNT]) -> bool {
    displacement(rig).iter().zip(target).all(|(now, want)| (now - want).abs() < 1e-18)
}

#[test]
fn a_command_is_applied_and_counted() {
    let mut rig = rig();
    let report = rig.send(small());
    assert_eq!((report.disposition, report.increment), (Disposition::Applied, 1));
    assert!(report.substeps >= 1);
    let measures = report.measures.unwrap();
    assert_eq!((measures.increment, measures.walls.displacement), (1, small()));
    assert_eq!((measures.stamp, report.stamp), (report.stamp, absolute(1, small()).stamp));
    assert!(sent_to(&rig, small()));
}

#[test]
fn numbers_that_are_none_are_invalid_in_each_of_the_six_fields() {
    let mut rig = rig();
    rig.go(small());
    for mode in [Mode::Absolute, Mode::Increment] {
        for w in 0..wall::COUNT {
            for value in [f64::NAN, -f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                let mut command = Command { mode, ..absolute(2, small()) };
                let mut displacement = small();
                displacement[w] = value;
                command.ask = Ask::Displacement(displacement);
                let report = refused(&mut rig, &command, Disposition::Invalid);
                assert!(report.text.contains(wall::NAMES[w]), "{}", report.text);
                assert_eq!(report.increment, 1);
            }
        }
    }
    // They took no place in the sequence.
    assert_eq!(apply(&mut rig, &increment(2, [0.0; 6])).disposition, Disposition::Applied);
}

#[test]
fn an_unknown_mode_is_invalid() {
    let mut rig = rig();
    for mode in [2, 3, 255] {
        let command = Command { mode: Mode::from(mode), ..absolute(1, small()) };
        let report = refused(&mut rig, &command, Disposition::Invalid);
        assert!(report.text.contains(&mode.to_string()), "{}", report.text);
    }
}

#[test]
fn a_duplicate_repeats_the_report_and_moves_nothing() {
    let mut rig = rig();
    let first = rig.send(small());
    // The same number again, even with another target: it was served.
    for target in [small(), small().map(|d| 2.0 * d)] {
        let report = refused(&mut rig, &absolute(1, target), Disposition::Duplicate);
        assert_eq!((report.increment, report.substeps), (first.increment, first.substeps));
        assert!(report.text.contains("Applied"), "{}", report.text);
    }
    let report = refused(&mut rig, &increment(1, small()), Disposition::Duplicate);
    assert_eq!(report.increment, 1);
    assert!(sent_to(&rig, small()));
}

#[test]
fn a_lower_sequence_is_out_of_order_until_a_new_session() {
    let mut rig = rig();
    rig.sequence = 10;
    rig.go(small());
    for sequence in [0, 1, 10] {
        refused(&mut rig, &absolute(sequence, [0.0; 6]), Disposition::OutOfOrder);
    }
    let command = Command { session: "another".into(), ..absolute(1, [0.0; 6]) };
    let report = apply(&mut rig, &command);
    assert_eq!((report.disposition, report.increment), (Disposition::Applied, 2));
    assert!(sent_to(&rig, [0.0; 6]));
}

#[test]
fn two_sessions_in_turn_have_a_sequence_each() {
    let mut rig = rig();
    let step = small().map(|d| 0.25 * d);
    let of = |session: &str, command: Command| Command { session: session.into(), ..command };
    let first = apply(&mut rig, &of("a", increment(1, step)));
    assert_eq!((first.disposition, first.increment), (Disposition::Applied, 1));
    apply(&mut rig, &of("b", increment(7, step)));
    // Each is sent again, and moves nothing again; the answer is its own.
    let again = refused(&mut rig, &of("a", increment(1, step)), Disposition::Duplicate);
    assert_eq!(again.increment, 1);
    let again = refused(&mut rig, &of("b", increment(7, step)), Disposition::Duplicate);
    assert_eq!(again.increment, 2);
    refused(&mut rig, &of("b", increment(6, step)), Disposition::OutOfOrder);
    refused(&mut rig, &of("a", increment(3, step)), Disposition::Gap);
    assert_eq!(apply(&mut rig, &of("a", increment(2, step))).disposition, Disposition::Applied);
    assert!(sent_to(&rig, step.map(|d| 3.0 * d)));
    // After many others a session is forgotten, and begins anew.
    for k in 0..16 {
        apply(&mut rig, &of(&format!("other {k}"), increment(1, [0.0; 6])));
    }
    assert_eq!(apply(&mut rig, &of("a", increment(1, step))).disposition, Disposition::Applied);
}

#[test]
fn an_absolute_command_after_a_gap_is_served_and_the_gap_reported() {
    let mut rig = rig();
    rig.go([0.0; 6]);
    let report = apply(&mut rig, &absolute(5, small()));
    assert_eq!(report.disposition, Disposition::Applied);
    assert!(report.text.contains("3 commands missing"), "{}", report.text);
    assert!(sent_to(&rig, small()));
}

#[test]
fn an_increment_after_a_gap_is_refused_until_an_absolute_command_or_a_new_session() {
    let step = small().map(|d| 0.5 * d);
    let mut rig = rig();
    apply(&mut rig, &increment(1, step));
    assert!(sent_to(&rig, step));
    refused(&mut rig, &increment(3, step), Disposition::Gap);
    refused(&mut rig, &increment(4, step), Disposition::Gap);
    // The one that was missing may still come.
    assert_eq!(apply(&mut rig, &increment(2, step)).disposition, Disposition::Applied);
    assert!(sent_to(&rig, small()));
    refused(&mut rig, &increment(9, step), Disposition::Gap);
    assert_eq!(apply(&mut rig, &absolute(10, step)).disposition, Disposition::Applied);
    assert_eq!(apply(&mut rig, &increment(11, step)).disposition, Disposition::Applied);
    assert!(sent_to(&rig, small()));
    refused(&mut rig, &increment(20, step), Disposition::Gap);
    let command = Command { session: "another".into(), ..increment(20, step.map(|d| -d)) };
    assert_eq!(apply(&mut rig, &command).disposition, Disposition::Applied);
    assert!(sent_to(&rig, step));
}

#[test]
fn a_command_older_than_allowed_is_stale() {
    let mut scene = scene();
    scene.node.stale_after = 0.5;
    let mut rig = Rig::start(&scene, pack()).0;
    let aged = |sequence, age| Command { age: Some(age), ..absolute(sequence, small()) };
    let report = refused(&mut rig, &aged(1, 0.6), Disposition::Stale);
    assert!(report.text.contains("0.5"), "{}", report.text);
    assert_eq!(apply(&mut rig, &aged(1, 0.4)).disposition, Disposition::Applied);
    // From a file nothing says how old it is; with 0 nothing is too old.
    assert_eq!(
        rig.twin.apply(&absolute(2, small()), Demand::ALL).disposition,
        Disposition::Applied
    );
    let mut rig = self::rig();
    assert_eq!(apply(&mut rig, &aged(1, 1e9)).disposition, Disposition::Applied);
}

#[test]
fn walls_that_would_cross_or_leave_are_beyond_the_limit() {
    let sides = pack().bounds.sides();
    let mut rig = rig();
    let mut sequence = 0;
    for axis in 0..3 {
        let [low, high] = [2 * axis, 2 * axis + 1];
        let targets = [
            // One wall through its opposite, both through each other, just together, far out.
            [(low, 1.5), (high, 0.0)],
            [(low, 0.0), (high, 1.5)],
            [(low, 0.8), (high, 0.8)],
            [(low, 0.5), (high, 0.5)],
            [(low, -1e6), (high, 0.0)],
            [(low, 1e300), (high, -1e300)],
            [(low, f64::MAX), (high, f64::MAX)],
        ];
        for target in targets {
            let mut displacement = [0.0; wall::COUNT];
            target.iter().for_each(|&(w, share)| displacement[w] = share * sides[axis]);
            sequence += 1;
            let report = refused(&mut rig, &absolute(sequence, displacement), Disposition::Limit);
            assert!(report.text.contains(wall::NAMES[low]), "{}", report.text);
        }
    }
    // The target was not advanced: an increment starts from where the walls are.
    assert_eq!(
        apply(&mut rig, &increment(sequence + 1, small())).disposition,
        Disposition::Applied
    );
    assert!(sent_to(&rig, small()));
}

#[test]
fn ten_per_cent_strain_in_one_command_is_sub_stepped() {
    // Neighbouring equilibria differ by a strain of 1e-4 at most, so there are a thousand or more.
    let mut rig = Rig::start(&scene(), &made(20, 1e7, 4)).0;
    let start = rig.twin.pack();
    let report = rig.send(by_strain(&start.bounds, [0.0, 0.0, 0.1]));
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    assert!(report.substeps >= 1000, "{}", report.substeps);
    let measures = report.measures.unwrap();
    close("strain", state(&measures).strain[2], 0.1, 1e-12);
    assert!(state(&measures).residual <= 1e-8);
}

#[test]
fn what_does_not_converge_leaves_the_state_and_the_target() {
    let mut scene = scene();
    scene.solver.max_iterations = Some(1);
    let (mut rig, report) = Rig::start(&scene, pack());
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let far = by_strain(&pack().bounds, [1e-3, 0.0, 5e-3]);
    let report = refused(&mut rig, &absolute(1, far), Disposition::NotConverged);
    assert_eq!(report.increment, 0);
    assert!(report.text.contains("residual"), "{}", report.text);
    // It was served: its number is taken, and asking again repeats the answer.
    let again = refused(&mut rig, &absolute(1, far), Disposition::Duplicate);
    assert!(again.text.contains(&report.text), "{}", again.text);
    // An increment of nothing leads to where the walls still are.
    let report = apply(&mut rig, &increment(2, [0.0; 6]));
    assert_eq!((report.disposition, report.increment), (Disposition::Applied, 1));
    assert_eq!(report.measures.unwrap().walls.displacement, [0.0; 6]);
    assert!(sent_to(&rig, [0.0; 6]));
}

#[test]
fn after_a_failure_the_answers_are_those_of_a_twin_that_never_failed() {
    let far = by_strain(&pack().bounds, [0.45, 0.45, 0.45]);
    let mut scene = scene();
    scene.solver.max_iterations = Some(12);
    let mut tried = Rig::start(&scene, pack()).0;
    let report = tried.send(far);
    assert_eq!(report.disposition, Disposition::NotConverged, "{}", report.text);
    let mut other = Rig::start(&scene, pack()).0;
    other.sequence = 1;
    let forces = |rig: &mut Rig| rig.go(small()).walls.normal_force;
    let (a, b) = (forces(&mut tried), forces(&mut other));
    // The neighbour list was made elsewhere; its order of summation is the same.
    for w in 0..wall::COUNT {
        assert!(off(a[w], b[w]) < 1e-9, "{a:?} {b:?}");
    }
}

#[test]
fn one_grain_takes_commands() {
    let bounds = centered([2e-4 * 0.999; 3]);
    let pack = Pack { bounds, grains: vec![bead([0.0; 3], 1e-4)], history: None };
    let mut rig = Rig::start(&scene(), &pack).0;
    let measures = rig.go(by_strain(&bounds, [1e-3, 0.0, 0.0]));
    let found = measures.walls.normal_force;
    assert!(found[0] > 2.0 * found[2] && found[2] > 0.0, "{found:?}");
    assert_eq!(state(&measures).contacts, 6);
}

#[test]
fn a_pack_of_rattlers_is_unjammed_and_says_so() {
    let grains = [[-3e-4, 0.0, 0.0], [0.0; 3], [3e-4, 0.0, 0.0]].map(|at| bead(at, 1e-4));
    let pack = Pack { bounds: centered([1e-3; 3]), grains: grains.to_vec(), history: None };
    let (mut rig, report) = Rig::start(&scene(), &pack);
    assert_eq!(report.disposition, Disposition::Applied);
    assert!(report.text.contains("no grain carries load"), "{}", report.text);
    let report = rig.send([1e-6; 6]);
    assert_eq!(report.disposition, Disposition::Applied);
    assert!(report.text.contains("no grain carries load"), "{}", report.text);
    let measures = report.measures.unwrap();
    let found = state(&measures);
    assert_eq!(measures.walls.normal_force, [0.0; 6]);
    assert_eq!((found.contacts, found.rattlers), (0, 3));
    assert_eq!((found.coordination_number, found.stored_energy), (0.0, 0.0));
    assert!(found.stress_walls.iter().all(|&stress| stress == 0.0));
    assert!((0.0..1.0).contains(&found.porosity));
    // Nothing carried before and after: the path tells K = 0.
    assert_eq!(measures.moduli.unwrap().bulk, 0.0);
}

#[test]
fn decompression_to_zero_and_back_finds_a_jammed_pack_again() {
    let mut rig = rig();
    let report = rig.send(by_strain(&pack().bounds, [-0.02; 3]));
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    assert!(report.text.contains("no grain carries load"), "{}", report.text);
    assert_eq!(report.measures.unwrap().walls.normal_force, [0.0; 6]);
    let measures = rig.go([0.0; 6]);
    let found = state(&measures);
    // The grains settled anew: the stress is of the old one's order, the state an equilibrium.
    assert!((1e4..1e8).contains(&found.confining_stress), "{}", found.confining_stress);
    assert!(found.residual <= 1e-8);
}

#[test]
fn moduli_are_nan_where_the_path_cannot_tell_them() {
    let mut rig = rig();
    let bounds = pack().bounds;
    let mut moduli = |strain| rig.go(by_strain(&bounds, strain)).moduli.unwrap();
    let isotropic = moduli([1e-5; 3]);
    assert!(isotropic.valid && isotropic.bulk > 0.0);
    assert!(isotropic.shear.is_nan() && isotropic.young.is_nan() && isotropic.poisson.is_nan());
    assert!(isotropic.lame.is_nan() && isotropic.p_wave.is_nan() && isotropic.s_speed.is_nan());
    let still = moduli([1e-5; 3]);
    assert!(!still.valid && still.bulk.is_nan() && still.shear.is_nan());
    let uniaxial = moduli([1e-5, 1e-5, 3e-5]);
    assert!(uniaxial.valid && uniaxial.bulk > 0.0 && uniaxial.shear.is_finite());
    assert!(uniaxial.tangent.iter().all(|value| value.is_nan()));
    let (_, report) = Rig::start(&scene(), pack());
    assert!(!report.measures.unwrap().moduli.unwrap().valid);
}

/// Numbers as a broken rig may send them.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -2e-8..2e-8f64,
        1 => any::<f64>(),
        1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(-0.0), Just(1e300), Just(-1.0)],
        4 => Just(0.0),
    ]
}

prop_compose! {
    fn command()(
        sequence in 0u64..12,
        another in prop::bool::weighted(0.2),
        mode in prop_oneof![4 => Just(0u8), 4 => Just(1u8), 1 => any::<u8>()],
        displacement in prop::array::uniform6(number()),
        age in prop::option::of(number()),
    ) -> Command {
        let session = if another { "another" } else { "test" };
        Command {
            session: session.into(), mode: Mode::from(mode), age, ..absolute(sequence, displacement)
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_command_moves_a_wall_but_one_that_was_applied(
        commands in prop::collection::vec(command(), 1..12),
    ) {
        let mut scene: Scene = scene();
        scene.node.stale_after = 1e-8;
        let mut rig = Rig::start(&scene, pack()).0;
        let mut where_it_is = [0.0; wall::COUNT];
        for command in &commands {
            let before = bits(&rig.twin.pack());
            let report = apply(&mut rig, command);
            if report.disposition == Disposition::Applied {
                let Ask::Displacement(asked) = command.ask else { unreachable!() };
                where_it_is = match command.mode {
                    Mode::Increment => std::array::from_fn(|w| where_it_is[w] + asked[w]),
                    _ => asked,
                };
                let measures = report.measures.unwrap();
                prop_assert_eq!(measures.walls.displacement, where_it_is);
                prop_assert!(measures.walls.normal_force.iter().all(|f| f.is_finite()));
            } else {
                prop_assert!(bits(&rig.twin.pack()) == before);
                prop_assert!(report.measures.is_none());
            }
            let bounds: Bounds = pack().bounds.displaced(&where_it_is);
            prop_assert_eq!(rig.twin.pack().bounds, bounds);
        }
    }
}
