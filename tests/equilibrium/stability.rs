//! Hard scenes: every increment converges, or is sub-stepped until it does, or is an event that was
//! followed downhill. The suite with its table is `cargo bench --bench stability`.

use graintwin::command::Disposition;

use crate::agreement;
use crate::detection;
use crate::hard::{self, Hard, Seen, apart, nudged, scaled};
use crate::packs::{self, Rig, state};

/// Drives `hard`; every increment must be applied.
#[track_caller]
fn all_applied(hard: &Hard) -> Seen {
    let seen = hard.drive(|| ());
    assert!(seen.refused.is_empty(), "{}: {:?}", hard.name, seen.refused);
    assert_eq!(seen.applied, hard.path.len() as u32);
    seen
}

fn with_and_without_friction(make: impl Fn(f64) -> Hard) {
    for friction in [0.0, 0.3] {
        all_applied(&make(friction));
    }
}

#[test]
fn increments_end_where_the_gradient_flow_ends() {
    for friction in [0.0, 0.3] {
        for tally in agreement::tally(3, friction) {
            let agreement::Tally { share, quiet, loud, failed, followed } = tally;
            let seen = quiet[0] + loud[0];
            assert!(seen >= 5, "{share}: only {seen} increments, {followed} followed");
            assert_eq!(failed, 0, "friction {friction}, share {share}");
            assert_eq!(loud[1], loud[0], "with an event, friction {friction}, share {share}");
            // At four times the largest step that the program takes, friction leaves a choice.
            let allowed = if friction > 0.0 && share > 0.05 { 1 } else { 0 };
            assert!(
                quiet[0] - quiet[1] <= allowed,
                "friction {friction}, share {share}: {quiet:?}"
            );
        }
    }
}

#[test]
fn events_are_those_of_the_gradient_flow() {
    let seen = detection::detect(3, 100, 0.0);
    assert_eq!((seen.failed, seen.increments), (0, 600));
    assert!(seen.both >= 10, "{seen:?}");
    // At the thresholds the two may differ (docs/events.md).
    let alone = seen.program_alone + seen.flow_alone;
    assert!(5 * alone <= seen.both && seen.elsewhere <= 1, "{seen:?}");
}

/// Single grains are balanced with the contacts that appear where cement broke: the lists of one
/// equilibrium are not those of the next.
#[test]
fn cement_breaks_bond_by_bond_with_an_equilibrium_after_each() {
    let seen = all_applied(&hard::cemented(40, 0.0, 3e7, 50));
    assert!(seen.bonds[1] > 50 && seen.bonds[0] > 50, "{:?}", seen.bonds);
}

#[test]
fn an_instability_is_reported_with_the_grains_that_jumped() {
    let hard = hard::near_jamming(300, 0.0, 2e5, 1e-4, 10);
    let (mut rig, _) = Rig::start(&hard.scene, &hard.pack);
    let mut events = 0;
    for target in &hard.path {
        let report = rig.send(*target);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        let measures = report.measures.unwrap();
        assert_eq!(measures.events.is_empty(), !report.text.contains("jumped"), "{}", report.text);
        let Some(event) = measures.events.last() else { continue };
        events += measures.events.len();
        assert_eq!(event.grains.len(), event.displacement.len());
        assert!(event.grains.is_sorted() && event.grains.iter().all(|&grain| grain < 300));
        let network = measures.network.as_ref().unwrap();
        let overlap = network.overlap.iter().sum::<f64>() / network.overlap.len() as f64;
        // Where sub-steps followed the event the overlap is no longer what it was then.
        assert!(event.displacement.iter().all(|&moved| moved > 0.5 * overlap));
        if report.substeps == 1 {
            let stress = state(&measures).stress_contacts;
            packs::close(
                "stress after",
                event.stress_after,
                (stress[0] + stress[4] + stress[8]) / 3.0,
                1e-6,
            );
        }
    }
    assert!(events > 0, "the path had no event");
}

#[test]
fn grains_a_thousand_times_softer_than_others_converge() {
    with_and_without_friction(|friction| hard::contrast(80, friction));
}

#[test]
fn grains_twenty_times_larger_than_others_converge() {
    with_and_without_friction(|friction| hard::radii(100, friction));
}

#[test]
fn walls_ten_thousand_times_stiffer_converge() {
    with_and_without_friction(|friction| hard::stiff_walls(80, friction));
}

#[test]
fn packs_near_jamming_are_sub_stepped_until_they_follow() {
    for friction in [0.0, 0.3] {
        for stress in [2e5, 2e4] {
            for increment in [1e-6, 1e-4] {
                all_applied(&hard::near_jamming(60, friction, stress, increment, 4));
            }
        }
    }
}

#[test]
fn a_pack_is_let_go_and_pressed_again() {
    with_and_without_friction(|friction| hard::decompression(60, friction));
}

#[test]
fn a_cycle_goes_on() {
    with_and_without_friction(|friction| hard::cycles(25, friction, 200));
}

#[test]
fn a_few_grains_are_a_pack() {
    for count in [1, 2, 5] {
        with_and_without_friction(|friction| hard::few(count, friction));
    }
}

#[test]
fn crystals_are_pressed() {
    for face_centred in [false, true] {
        with_and_without_friction(|friction| hard::crystal(face_centred, friction, 4));
    }
}

#[test]
fn a_grain_passes_a_constriction() {
    let seen = all_applied(&hard::constriction(0.0, 60));
    assert!(seen.events > 0, "it snapped through without an event");
}

#[test]
fn units_do_not_matter() {
    let base = hard::plain(60, 0.0);
    let here = all_applied(&base);
    assert_eq!(here.events, 0);
    for (length, modulus) in [(1e-6, 1.0), (1e6, 1.0), (1.0, 1e-6), (1.0, 1e6)] {
        let there = all_applied(&scaled(&base, length, modulus));
        let off = apart(&here, &there, 1.0 / (length * length * modulus));
        // Both are within the residual of the equilibrium, which soft modes amplify.
        assert!(off <= 1e-6, "{length:e} {modulus:e}: {off:e}");
    }
}

#[test]
fn the_last_digit_does_not_matter() {
    for friction in [0.0, 0.3] {
        let base = hard::plain(60, friction);
        let off = apart(&all_applied(&base), &all_applied(&nudged(&base)), 1.0);
        assert!(off <= 1e-6, "friction {friction}: {off:e}");
    }
}
