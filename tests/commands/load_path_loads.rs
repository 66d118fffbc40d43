//! Load paths on which walls carry loads: steps begin from where the twin is.

use std::path::Path as FilePath;
use std::sync::Arc;

use graintwin::command::{Ask, Command, Disposition};
use graintwin::pack::Pack;
use graintwin::path::{self, Path};
use graintwin::report::{Demand, Measures};
use graintwin::scene::{self, Scene};
use graintwin::sink::{Served, Sink};
use graintwin::twin::Twin;
use graintwin::wall::{Bounds, WallTarget};

use crate::packs::{bits, close, made, state};

fn with(load_path: &str) -> Scene {
    let text = format!(
        "pack: {{file: none.csv}}\nwalls: {{friction: 0.0}}\n\
         contact: {{friction: {{coefficient: 0.3}}}}\nload_path:\n{load_path}"
    );
    scene::parse(&text, "loads.yaml".as_ref()).unwrap()
}

fn pack() -> Pack {
    let mut pack = made(150, 4e6, 11);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    pack
}

/// What came of each command of the path, and the box then.
fn walk(scene: &Scene, folder: &FilePath) -> Vec<(Command, Measures, Bounds)> {
    let pack = pack();
    let mut twin = Twin::new(scene, &pack, 1).unwrap();
    let path = Path::new(scene, folder, &pack.bounds).unwrap();
    let length = path.length();
    let mut here = path.whereabouts();
    let report = twin.start(Demand::ALL);
    here.served(&Arc::new(Served { command: None, report }));
    let mut walked = Vec::new();
    for command in path {
        let command = command.unwrap();
        let report = twin.apply(&command, Demand::ALL);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        let measures = report.measures.clone().unwrap();
        here.served(&Arc::new(Served { command: Some(command.clone()), report }));
        walked.push((command, measures, twin.pack().bounds));
    }
    assert_eq!(walked.len(), length);
    walked
}

fn stress(measures: &Measures, axis: usize) -> f64 {
    state(measures).stress_walls[4 * axis]
}

#[test]
fn a_strain_step_after_a_consolidation_is_of_the_box_that_the_loads_left() {
    let scene = with(
        "  - isotropic: {stress: 5.0e+6, increments: 4}\n  \
         - triaxial: {axis: y, axial_strain: 2.0e-3, lateral_stress: 5.0e+6, increments: 5}\n  \
         - uniaxial: {axis: x, strain: 1.0e-3, moving: max, increments: 2}",
    );
    let walked = walk(&scene, "".as_ref());
    // Equal parts of the way from the 4 MPa of the pack, which was made to a thousandth.
    for (k, (_, measures, _)) in walked[..4].iter().enumerate() {
        let expected = 4e6 + 1e6 * (k + 1) as f64 / 4.0;
        (0..3).for_each(|axis| close("part", stress(measures, axis), expected, 1e-3));
    }
    (0..3).for_each(|axis| close("stress", stress(&walked[3].1, axis), 5e6, 1e-8));
    let (consolidated, sheared) = (walked[3].2.sides(), walked[8].2.sides());
    close("axial strain", 1.0 - sheared[1] / consolidated[1], 2e-3, 1e-9);
    for (_, measures, _) in &walked[4..9] {
        close("x", stress(measures, 0), 5e6, 1e-8);
        close("z", stress(measures, 2), 5e6, 1e-8);
    }
    // The walls that carried a load stand from now on.
    let (before, after) = (walked[8].2, walked[10].2);
    close("last strain", 1.0 - after.sides()[0] / sheared[0], 1e-3, 1e-9);
    assert_eq!(after.min, before.min);
    assert_eq!(after.max[1..], before.max[1..]);
    assert!(stress(&walked[10].1, 2) > 5e6);
}

#[test]
fn an_oedometer_goes_down_and_up_again_between_its_stresses() {
    let scene = with(
        "  - uniaxial: {axis: z, stress: 6.0e+6, moving: max, increments: 3}\n  \
         - repeat:\n      times: 2\n      steps:\n        \
         - uniaxial: {axis: z, stress: 3.0e+6, moving: max, increments: 2}\n        \
         - uniaxial: {axis: z, stress: 6.0e+6, moving: max, increments: 2}",
    );
    let walked = walk(&scene, "".as_ref());
    let stresses: Vec<f64> = walked.iter().map(|(_, measures, _)| stress(measures, 2)).collect();
    for (got, wanted) in stresses[2..].iter().zip([6e6, 4.5e6, 3e6, 4.5e6, 6e6, 4.5e6, 3e6]) {
        close("stress", *got, wanted, 1e-8);
    }
    let start = pack().bounds;
    for (_, _, bounds) in &walked {
        assert_eq!((bounds.min, &bounds.max[..2]), (start.min, &start.max[..2]));
    }
}

#[test]
fn a_drained_rig_log_keeps_the_lateral_stress_that_it_begins_with() {
    let folder = tempfile::tempdir().unwrap();
    let log = "t,e\n0,0\n1,0.0005\n2,0.001\n3,0.0008\n";
    std::fs::write(folder.path().join("log.csv"), log).unwrap();
    let scene = with(
        "  - uniaxial: {axis: x, strain: 5.0e-4, increments: 1}\n  \
         - rig_log: {file: log.csv, time: t, axial_strain: e, lateral: free}",
    );
    let walked = walk(&scene, folder.path());
    let held = [0, 1].map(|axis| stress(&walked[0].1, axis));
    assert!(held[0] > 1.05 * held[1], "{held:?}");
    for (_, measures, _) in &walked[1..] {
        (0..2).for_each(|axis| close("lateral", stress(measures, axis), held[axis], 1e-8));
    }
    let height = |k: usize| walked[k].2.sides()[2];
    close("axial", 1.0 - height(3) / height(0), 1e-3, 1e-9);
}

#[test]
fn a_command_file_may_hold_loads() {
    let folder = tempfile::tempdir().unwrap();
    let csv = "stamp,x_min:stress,x_max:stress,z_max:force,y_min\n\
               1,4.1e6,4.1e6,11.0,0\n2,4.2e6,4.2e6,11.5,1e-7\n";
    let file = folder.path().join("loads.csv");
    std::fs::write(&file, csv).unwrap();
    let commands = path::read_csv(&file).unwrap();
    let Ask::Targets(targets) = commands[1].ask else { panic!("{commands:?}") };
    assert_eq!(
        targets[..3],
        [WallTarget::Stress(4.2e6), WallTarget::Stress(4.2e6), WallTarget::Displacement(1e-7),]
    );
    let walked = walk(&with("  - commands: loads.csv"), folder.path());
    let (_, measures, bounds) = &walked[1];
    close("x", measures.walls.normal_force[0], 4.2e6 * bounds.area(0), 1e-8);
    close("z", measures.walls.normal_force[5], 11.5, 1e-8);
    assert_eq!(measures.walls.displacement[2], 1e-7);
    // What a twin is asked for is what another one needs to come to the same bits.
    let mut twin = Twin::new(&with("  []"), &pack(), 1).unwrap();
    twin.start(Demand::ALL);
    for (command, _, _) in &walked {
        twin.apply(command, Demand::default());
    }
    assert_eq!(twin.pack().bounds, *bounds);
    assert!(bits(&twin.pack()) != bits(&pack()));
}

#[test]
fn steps_ask_for_one_of_strain_and_stress() {
    let refused = |step: &str| {
        let text = format!("pack: {{file: none.csv}}\nload_path:\n  - {step}");
        scene::parse(&text, "loads.yaml".as_ref()).unwrap_err().to_string()
    };
    for (step, told) in [
        ("isotropic: {increments: 1}", "needs strain or stress; allowed: one of the two"),
        ("isotropic: {strain: 0.1, stress: 1.0, increments: 1}", "needs strain or stress"),
        ("uniaxial: {stress: 0.0, increments: 1}", "stress > 0 Pa"),
        ("uniaxial: {stress: -1.0, increments: 1}", "stress > 0 Pa"),
        ("triaxial: {axial_strain: 0.1, increments: 1}", "needs lateral_strain or lateral_stress"),
        ("triaxial: {lateral_stress: 1.0, increments: 1}", "needs axial_strain or axial_stress"),
        ("polyaxial: {stress: [1.0, .nan, 1.0], increments: 1}", "stress[1]"),
        ("walls: {targets: {z_max: {force: 0.0}}, increments: 1}", "targets.z_max"),
        ("walls: {targets: {z_max: {weight: 1.0}}, increments: 1}", "weight"),
        (
            "walls: {targets: {z_min: {force: 1.0}, z_max: {force: 2.0}}, increments: 1}",
            "another load than z_min",
        ),
    ] {
        let message = refused(step);
        assert!(message.contains(told) && message.contains("load_path"), "{step}\n{message}");
    }
}
