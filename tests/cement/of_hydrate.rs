//! Cement that is hydrate weakens as it dissociates.

use graintwin::command::{Ask, Disposition, Dissociation};
use graintwin::pack::{BondMemory, Kept};
use graintwin::report::{Demand, Report};
use graintwin::scene::{Cement, CementLaw, Scene};
use graintwin::wall::WallTarget;

use crate::cemented::{EXPONENTIAL, breakable, cement, scene};
use crate::packs::{Rig, absolute, by_strain, close, made};

/// Cement of hydrate that fills a fifth of the pores.
fn hydrate(cement: Cement) -> Scene {
    scene(Cement { saturation: 0.2, ..cement }, 1e-11)
}

fn ask(rig: &mut Rig, ask: Ask) -> Report {
    rig.sequence += 1;
    let command = graintwin::command::Command { ask, ..absolute(rig.sequence, [0.0; 6]) };
    rig.twin.apply(&command, Demand::ALL)
}

fn lose(rig: &mut Rig, saturation_loss: f64) -> Report {
    ask(rig, Ask::Dissociation(Dissociation { saturation_loss, pore_pressure: 0.0, biot: 0.8 }))
}

fn forces(report: &Report) -> [f64; 6] {
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    report.measures.as_ref().unwrap().walls.normal_force
}

#[test]
fn what_cement_carries_falls_as_its_saturation() {
    let pack = made(120, 1e7, 21);
    for law in [CementLaw::Fixed, EXPONENTIAL] {
        let mut rig = Rig::start(&hydrate(cement(law)), &pack).0;
        let before = rig.go(by_strain(&pack.bounds, [-2e-5, -2e-5, 1e-4])).walls.normal_force;
        // All bonds soften alike, so that the grains stay where they are.
        for (lost, left) in [(0.05, 0.75), (0.1, 0.5), (0.18, 0.1)] {
            let after = forces(&lose(&mut rig, lost));
            for (after, before) in after.into_iter().zip(before) {
                close(&format!("{law:?} at {lost}"), after, left * before, 1e-8);
            }
        }
        // From there on the pack is that much softer.
        let stiffness = |rig: &mut Rig, from: f64| {
            let at = |rig: &mut Rig, strain: f64| {
                let way = by_strain(&pack.bounds, [-2e-5, -2e-5, strain]);
                forces(&ask(rig, Ask::Targets(way.map(WallTarget::Displacement))))[5]
            };
            at(rig, from + 1e-6) - at(rig, from)
        };
        let soft = stiffness(&mut rig, 1e-4);
        let mut whole = Rig::start(&hydrate(cement(law)), &pack).0;
        whole.go(by_strain(&pack.bounds, [-2e-5, -2e-5, 1e-4]));
        close("stiffness", soft, 0.1 * stiffness(&mut whole, 1e-4), 1e-5);
    }
}

#[test]
fn strength_falls_with_the_load_and_more_than_there_is_cannot_be_lost() {
    let pack = made(120, 1e7, 21);
    let mut rig = Rig::start(&hydrate(breakable(EXPONENTIAL, 3e8, 3e8)), &pack).0;
    rig.go(by_strain(&pack.bounds, [-2e-5, -2e-5, 1e-4]));
    let broken = |rig: &Rig| {
        let bonds = rig.twin.pack().history.unwrap().bonds;
        bonds.iter().filter(|bond| bond.condition != Kept::Intact).count()
    };
    let before = broken(&rig);
    forces(&lose(&mut rig, 0.15));
    // The stresses fall as the strengths do.
    assert_eq!(broken(&rig), before);
    let history = rig.twin.pack().history.unwrap();
    let intact = |bond: &&BondMemory| bond.condition == Kept::Intact;
    assert!(history.bonds.iter().filter(intact).all(|bond| (bond.share - 0.25).abs() < 1e-12));
    let refused = lose(&mut rig, 0.25);
    assert_eq!(refused.disposition, Disposition::Invalid, "{}", refused.text);
    assert!(rig.twin.pack().history.unwrap() == history);
}
