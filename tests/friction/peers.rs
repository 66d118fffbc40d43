//! The benchmark job with friction against four runs of codes that integrate Newton's equations in
//! time with damping: LAMMPS with `mindlin` and with `mindlin/force`, LIGGGHTS and YADE, each to a
//! residual of 1e-4. They take the limit of friction at every time step, so that those runs lie up
//! to 1e-3 apart.

use std::path::Path;

use graintwin::command::Disposition;
use graintwin::report::Demand;
use graintwin::twin::Twin;
use graintwin::{pack, path, scene, wall};

/// Wall forces \[N\] after ten increments: lowest and highest of the four runs.
const PEERS: [[f64; 2]; wall::COUNT] = [
    [77.7556, 77.7670],
    [77.0584, 77.0769],
    [77.3914, 77.4074],
    [77.5978, 77.6155],
    [105.0882, 105.2047],
    [104.9923, 105.1070],
];

#[test]
fn ten_increments_with_friction_end_at_the_wall_forces_of_four_other_codes() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/g2740_friction.yaml");
    let loaded = scene::load(&file).unwrap();
    let pack = pack::build(&loaded).unwrap();
    let mut twin = Twin::new(&loaded.scene, &pack, 1).unwrap();
    let mut report = twin.start(Demand::default());
    for command in path::commands(&loaded.scene.load_path, loaded.folder(), &pack.bounds).unwrap() {
        report = twin.apply(&command, Demand::default());
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    }
    let walls = report.measures.unwrap().walls;
    for (w, [least, most]) in PEERS.into_iter().enumerate() {
        let force = walls.normal_force[w];
        let within = least * (1.0 - 2e-3)..=most * (1.0 + 2e-3);
        assert!(within.contains(&force), "{}: {force} N, {within:?}", wall::NAMES[w]);
    }
}
