//! Three-point bending of a beam of cemented grains (B 4.5): table 13.

use graintwin::analytic::bend::Beam;
use graintwin::analytic::fit::record;
use graintwin::analytic::strength::MohrCoulomb;
use graintwin::command::Disposition;
use graintwin::report::{Crack, Demand};
use graintwin::wall::WallTarget::{Displacement, Keep};

use super::rig::{Rig, made, surrounded};
use super::spread;

/// The beam of 4.5: 398 by 1025 mm of grains of 20 mm.
const ASPECT: f64 = 1025.0 / 398.0;
const RADIUS: f64 = 1e-2;
/// Supports from the middle, and the radius of supports and load \[m\]: small ones would sit deep between the
/// grains of the surface. They are smooth, as B's walls are; rough ones take up a thrust, and what is left
/// of the beam is an arch.
const SUPPORT: f64 = 0.48;
const POINT: f64 = 0.1;
/// k_n \[N/m\]: that of B table 8 for grains a hundred times as large, at which E is the same; c_μ \[Pa\].
const STIFFNESS: f64 = 1e8;
const COHESION: f64 = 1e8;
/// Stress of the beam while it was made \[Pa\].
const MADE: f64 = 1e6;
/// Way of the load in an increment and at the end \[m\].
const STEP: f64 = 2.5e-5;
const WAY: f64 = 1.5e-2;
/// A test ends when the load has fallen to this share of its peak.
const FALLEN: f64 = 0.5;
/// φ' \[°\] and c' \[Pa\] of sandstone of grading B (B table 11).
const FRICTION: f64 = 22.0;
const STRENGTH: f64 = 9.6e6;

/// What a test tells.
struct Test {
    beam: Beam,
    /// Load at the first crack and at most \[N\].
    first: f64,
    peak: f64,
    /// Way of the load at the peak, from where it presses \[m\].
    way: f64,
    /// Load over way up to half of the first crack \[N/m\].
    stiffness: f64,
    /// Share of the first ten cracks in the lower half, and of all that broke while pulled.
    below: f64,
    pulled: f64,
    cracks: usize,
}

/// Runs and prints the tests.
pub(crate) fn run(seeds: &[u64]) {
    println!("\nThree-point bending (B table 13):\n");
    println!(
        "| grading | load by Bernoulli [kN] | first crack [kN] | peak [kN] | way there [mm] | load over way [MN/m] | first ten cracks below | pulled | cracks |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for grading in ["A", "B"] {
        let tests: Vec<Test> = seeds.iter().map(|&seed| test(seed, grading)).collect();
        let all = |of: &dyn Fn(&Test) -> f64, digits| spread(tests.iter().map(of), digits);
        let material = MohrCoulomb { friction: FRICTION.to_radians(), cohesion: STRENGTH };
        println!(
            "| {grading} | {} | {} | {} | {} | {} | {} | {} | {} |",
            all(&|t| t.beam.strength(&material) / 1e3, 1),
            all(&|t| t.first / 1e3, 1),
            all(&|t| t.peak / 1e3, 1),
            all(&|t| t.way * 1e3, 2),
            all(&|t| t.stiffness / 1e6, 2),
            all(&|t| t.below, 2),
            all(&|t| t.pulled, 2),
            all(&|t| t.cracks as f64, 0),
        );
    }
    println!("\nB: 27 kN predicted, 43 kN measured.");
}

fn test(seed: u64, grading: &str) -> Test {
    let generate = format!(
        "  generate: {{grains: 1000, radius: {{grading_{}: {{mean: {RADIUS:e}, ratio: 4.0}}}}, \
         material: sand, seed: {seed}, confining_stress: {MADE:e}, aspect: [{ASPECT}, 1, 1]}}",
        grading.to_lowercase()
    );
    let walls = format!(
        "friction: 0.0, open: [x_min, x_max], points: {{\
         y_min: {{at: [-{SUPPORT}, {SUPPORT}], radius: {POINT}}}, \
         y_max: {{at: [0.0], radius: {POINT}}}}}"
    );
    let contact = format!(
        "{{normal: {{linear: {{stiffness: {STIFFNESS:e}, bond: {{cohesion: {COHESION:e}}}}}}}, \
         friction: {{coefficient: 0.6}}}}"
    );
    let loaded = surrounded(&generate, &walls, &contact, "max_overlap_share: 100.0");
    let pack = made(&loaded);
    let [_, height, depth] = pack.bounds.sides();
    let middle = pack.bounds.center()[1];
    let mut test = Test {
        beam: Beam { span: 2.0 * SUPPORT, height, depth },
        first: f64::NAN,
        peak: 0.0,
        way: f64::NAN,
        stiffness: f64::NAN,
        below: f64::NAN,
        pulled: f64::NAN,
        cracks: 0,
    };
    let mut rig = Rig::new(&loaded.scene, &pack);
    let mut cracks: Vec<Crack> = Vec::new();
    // Way and load since the beam is pressed, up to the first crack.
    let mut elastic: Vec<[f64; 2]> = Vec::new();
    let demand = Demand { state: true, cracks: true, ..Demand::NONE };
    for step in 1..=(WAY / STEP) as u32 {
        let way = STEP * f64::from(step);
        let report = rig.go([Keep, Keep, Keep, Displacement(way), Keep, Keep], demand);
        if report.disposition != Disposition::Applied {
            println!("    {:?}: {}", report.disposition, report.text);
            continue;
        }
        let measures = report.measures.expect("it was served");
        let load = measures.walls.normal_force[3];
        cracks.extend(measures.cracks.into_iter().flat_map(|cracks| cracks.list));
        if load > 0.0 && cracks.is_empty() {
            elastic.push([way, load]);
        }
        if test.first.is_nan() && !cracks.is_empty() {
            test.first = load;
        }
        if load > test.peak {
            (test.peak, test.way) = (load, way - elastic.first().map_or(0.0, |first| first[0]));
        }
        if load < FALLEN * test.peak && cracks.len() > 10 {
            break;
        }
    }
    let half: Vec<[f64; 2]> = elastic
        .into_iter()
        .filter(|at| at[1] > 0.1 * test.first && at[1] < 0.5 * test.first)
        .collect();
    let [way, load] = [0, 1].map(|part| half.iter().map(|at| at[part]).collect::<Vec<f64>>());
    test.stiffness = record::slope(&way, &load, 0..way.len()).unwrap_or(f64::NAN);
    let early = &cracks[..cracks.len().min(10)];
    let share = |cracks: &[Crack], of: &dyn Fn(&Crack) -> bool| {
        cracks.iter().filter(|crack| of(crack)).count() as f64 / cracks.len() as f64
    };
    test.below = share(early, &|crack| crack.position[1] < middle);
    test.pulled = share(&cracks, &|crack| crack.normal_force < 0.0);
    test.cracks = cracks.len();
    test
}
