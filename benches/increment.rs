//! Time, work and error of the relaxation: the ten-increment job on the benchmark pack, making a
//! pack, and the measured rig log. `cargo bench --bench increment --no-default-features`
//!
//! Wall-clock times of one thread; on a machine that does other things too, compare ratios and
//! work counts. The error is that of the axial wall force against the converged reference in
//! `tests/data`.
#![allow(clippy::print_stdout, clippy::expect_used)] // A bench prints, and ends when its input is not there.

use std::path::Path;
use std::time::Instant;

use graintwin::measure::contacts::Contacts;
use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::{self, Pack};
use graintwin::relax::Workspace;
use graintwin::relax::advance::{Advance, advance};
use graintwin::relax::relax;
use graintwin::report::Demand;
use graintwin::scene::{self, Coulomb, Friction, Law, Loaded, Scene, Solver, Update, Walls};
use graintwin::state::State;
use graintwin::twin::Twin;
use graintwin::wall::standing;

/// Rounds of the ten-increment job; the shortest time of each increment counts.
const ROUNDS: usize = 5;

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| {
        let job = scene::load(&root.join("tests/data/g2740.yaml")).expect("it is shipped");
        let pack = pack::build(&job).expect("the benchmark pack is in tests/data");
        ten_increments(&pack, &reference(root));
        with_friction(&job.scene, &pack);
        let log = scene::load(&root.join("launch_configs/rig_log.yaml")).expect("it is shipped");
        main_job(&log);
    });
}

/// Wall forces of z_max in the reference, one for each increment \[N\].
fn reference(root: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(root.join("tests/data/g2740_10MPa_reference.json"))
        .expect("the reference is in tests/data");
    let json: serde_json::Value = serde_json::from_str(&text).expect("it is JSON");
    let increments = json["increments"].as_array().expect("it lists increments");
    increments.iter().filter_map(|increment| increment["wall_forces"][5].as_f64()).collect()
}

fn ten_increments(pack: &Pack, reference: &[f64]) {
    println!("ten uniaxial increments of 1e-4, 2740 grains at 10 MPa, one thread");
    println!("tolerance  median ms   mean ms  Newton steps  products  worst error of F_z");
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
        let solver = Solver { tolerance, ..Solver::default() };
        let model = Model::with(pack, &Walls::default(), [0.0; 3], solver, None);
        let mut times = vec![f64::INFINITY; reference.len()];
        let (mut steps, mut products, mut error) = (Vec::new(), Vec::new(), 0.0_f64);
        for _ in 0..ROUNDS {
            let mut state = State::new(&model);
            let mut work = Workspace::new(&model);
            let mut outcome = relax(&model, &mut state, &mut work);
            (steps, products, error) = (Vec::new(), Vec::new(), 0.0);
            for (k, wanted) in reference.iter().enumerate() {
                let travel = 0.5e-4 * (k + 1) as f64 * model.start.sides()[2];
                let target = [0.0, 0.0, 0.0, 0.0, travel, travel];
                let before = work.effort().products;
                let start = Instant::now();
                let done: Advance =
                    advance(&model, &mut state, &mut work, &standing(&target), outcome);
                times[k] = times[k].min(start.elapsed().as_secs_f64() * 1e3);
                outcome = done.outcome;
                steps.push(f64::from(done.iterations));
                products.push((work.effort().products - before) as f64);
                let contacts = Contacts::of(&model, &state, &work.neighbours);
                let force = walls::forces(&model, &state, &contacts.list).normal_force[5];
                error = error.max((force / wanted - 1.0).abs());
            }
        }
        println!(
            "{tolerance:<9.0e}  {:9.1} {:9.1}  {:12.0}  {:8.0}  {error:.1e}",
            median(&times),
            times.iter().sum::<f64>() / times.len() as f64,
            median(&steps),
            median(&products),
        );
    }
}

/// The ten increments for each law of friction, from no shear.
fn with_friction(scene: &Scene, pack: &Pack) {
    println!("\nthe same with friction, tolerance 1e-8");
    println!("law                   median ms   mean ms  Newton steps  products      F_z [N]");
    for (name, friction) in [
        ("none", Friction::None),
        ("return_map, mu 0.3", coulomb(0.3, Law::ReturnMap, Update::Frozen)),
        ("  update: current", coulomb(0.3, Law::ReturnMap, Update::Current)),
        ("secant, mu 0.3", coulomb(0.3, Law::Secant, Update::Frozen)),
    ] {
        let mut scene = scene.clone();
        scene.contact.friction = friction;
        let mut pack = pack.clone();
        for grain in &mut pack.grains {
            grain.friction = friction.coefficient();
        }
        let model = Model::new(&pack, &scene);
        let mut times = vec![f64::INFINITY; 10];
        let (mut steps, mut products, mut force) = (Vec::new(), Vec::new(), 0.0);
        for _ in 0..ROUNDS {
            let mut state = State::new(&model);
            let mut work = Workspace::new(&model);
            work.start(&model, &state);
            let mut outcome = relax(&model, &mut state, &mut work);
            work.commit(&model, &mut state);
            (steps, products) = (Vec::new(), Vec::new());
            for (k, time) in times.iter_mut().enumerate() {
                let travel = 0.5e-4 * (k + 1) as f64 * model.start.sides()[2];
                let target = [0.0, 0.0, 0.0, 0.0, travel, travel];
                let before = work.effort().products;
                let start = Instant::now();
                let done = advance(&model, &mut state, &mut work, &standing(&target), outcome);
                *time = time.min(start.elapsed().as_secs_f64() * 1e3);
                outcome = done.outcome;
                steps.push(f64::from(done.iterations));
                products.push((work.effort().products - before) as f64);
            }
            let contacts = Contacts::of(&model, &state, &work.neighbours);
            force = walls::forces(&model, &state, &contacts.list).normal_force[5];
        }
        println!(
            "{name:<20}  {:9.1} {:9.1}  {:12.0}  {:8.0}  {force:9.4}",
            median(&times),
            times.iter().sum::<f64>() / times.len() as f64,
            median(&steps),
            median(&products),
        );
    }
}

fn coulomb(coefficient: f64, law: Law, update: Update) -> Friction {
    Friction::Coulomb(Coulomb { coefficient, law, update })
}

fn main_job(log: &Loaded) {
    let start = Instant::now();
    let pack = pack::build(log).expect("the shipped scene makes its pack");
    println!("\n2740 grains made at 10 MPa in {:.2} s", start.elapsed().as_secs_f64());
    let commands = graintwin::path::commands(&log.scene.load_path, log.folder(), &pack.bounds)
        .expect("a path");
    let mut twin = Twin::new(&log.scene, &pack, 1).expect("one thread");
    let start = Instant::now();
    twin.start(Demand::ALL);
    let mut steps = 0;
    for command in &commands {
        let report = twin.apply(command, Demand::ALL);
        steps += report.measures.and_then(|m| m.state).map_or(0, |state| state.iterations);
    }
    println!(
        "{} samples of the rig log in {:.1} s, {steps} Newton steps, every measure taken",
        commands.len(),
        start.elapsed().as_secs_f64()
    );
}

fn median(of: &[f64]) -> f64 {
    let mut sorted = of.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
