use super::*;
use crate::command::{Ask, Command, Mode, Stamp};
use crate::report::{Measures, PackState, Report, WallForces};

fn served(disposition: Disposition, iterations: Option<u32>) -> Served {
    let command = Command {
        stamp: Stamp::default(),
        session: String::new(),
        sequence: 1,
        mode: Mode::Absolute,
        ask: Ask::Displacement([0.0; 6]),
        age: None,
    };
    let measures = iterations.map(|iterations| Measures {
        stamp: Stamp::default(),
        increment: 1,
        events: Vec::new(),
        walls: WallForces::default(),
        wall_force_error: 0.0,
        state: Some(PackState { iterations, residual: 1e-9, ..PackState::default() }),
        moduli: None,
        tangent: None,
        network: None,
        grains: None,
        motion: None,
        fabric: None,
        hydrate: None,
        shear: None,
        plane: None,
        bonds: None,
        cracks: None,
        rearrangements: Vec::new(),
        snapshots: Vec::new(),
        surfaces: Vec::new(),
    });
    let report = Report {
        stamp: Stamp::default(),
        session: String::new(),
        sequence: 1,
        increment: 1,
        disposition,
        substeps: 1,
        text: String::new(),
        measures,
    };
    Served { command: Some(command), report }
}

#[test]
fn what_moved_the_walls_is_accepted_and_all_else_refused_for_its_reason() {
    let health = Health::default();
    health.served(&served(Disposition::Applied, Some(4)));
    health.served(&served(Disposition::Gap, Some(5)));
    health.served(&served(Disposition::Gap, None));
    health.served(&served(Disposition::Duplicate, None));
    health.served(&served(Disposition::Stale, None));
    let vitals = health.vitals();
    assert_eq!((vitals.accepted, vitals.repeated, vitals.refused.iter().sum()), (2, 1, 2_u64));
    assert_eq!(vitals.refused[Disposition::Gap as usize], 1);
    assert_eq!(vitals.refused[Disposition::Stale as usize], 1);
    assert_eq!((vitals.iterations, vitals.residual, vitals.increment), (5, 1e-9, 1));
}

#[test]
fn commands_without_an_equilibrium_count_until_one_finds_it_or_the_faults_are_reset() {
    let health = Health::default();
    let failing = |health: &Health| health.vitals().failing;
    health.served(&served(Disposition::NotConverged, None));
    health.served(&served(Disposition::NotConverged, None));
    assert_eq!(failing(&health), 2);
    health.served(&served(Disposition::Applied, Some(1)));
    assert_eq!(failing(&health), 0);
    health.served(&served(Disposition::NotConverged, None));
    health.done(&Request::ResetFaults);
    assert_eq!(failing(&health), 0);
}

#[test]
fn a_hold_lasts_until_it_is_let_go() {
    let health = Health::default();
    let held = |health: &Health| health.vitals().on_hold;
    health.done(&Request::Hold(true));
    health.served(&served(Disposition::Held, None));
    health.done(&Request::SavePack("a.csv".into()));
    assert!(held(&health));
    health.done(&Request::Hold(false));
    assert!(!held(&health));
    // A fault holds without being asked.
    health.served(&served(Disposition::Held, None));
    health.done(&Request::Reset);
    assert!(held(&health));
    health.done(&Request::ResetFaults);
    assert!(!held(&health));
}

#[test]
fn silence_is_counted_from_the_first_command_on() {
    let health = Health::default();
    assert_eq!(health.vitals().silence, None);
    health.arrived();
    assert!(health.vitals().silence.unwrap() < Duration::from_secs(3600));
}
