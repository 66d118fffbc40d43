//! Biaxial tests of dense sand between walls and between membranes (B 3.3.2, figure 25).

use graintwin::analytic::fit::record::secant_50;
use graintwin::pack::Pack;
use graintwin::scene::Loaded;

use super::rig::{Course, Rig, made, scene, surrounded};
use super::spread;

/// σ3 \[Pa\].
const PRESSURE: f64 = 1e5;
/// Strains at which the stress ratio is told, the last at the end.
const STRAINS: [f64; 4] = [2e-3, 5e-3, 1e-2, 2e-2];
const CONTACT: &str = "{friction: {coefficient: 0.6}}";

fn walled(grains: u32, seed: u64) -> Loaded {
    let text = format!(
        "  generate: {{grains: {grains}, radius: {{grading_a: {{mean: 0.1e-3, ratio: 4.0}}}}, \
         material: sand, seed: {seed}, confining_stress: {PRESSURE:e}, aspect: [1, 2.5, 1]}}"
    );
    scene(&text, CONTACT, "")
}

fn wrapped() -> Loaded {
    let walls = format!(
        "friction: 0.0, membranes: [x_min, x_max], \
         targets: {{x_min: {{stress: {PRESSURE:e}}}, x_max: {{stress: {PRESSURE:e}}}}}"
    );
    surrounded("  file: none.csv", &walls, CONTACT, "")
}

/// Runs and prints the tests: ten times as many seeds of the smaller samples.
pub(crate) fn run(seeds: &[u64]) {
    println!("\nConfined and unconfined biaxial tests of sand, σ3 = 1 bar (B figure 25):\n");
    println!(
        "| grains | sides | σ1/σ3 at 0.2 % | 0.5 % | 1 % | 2 % | peak | E50 [MPa] | tests | not to the end |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (grains, samples) in [(250, 10 * seeds.len()), (1000, seeds.len())] {
        let seeds = (0..samples as u64).map(|k| k + seeds[0]);
        let packs: Vec<Pack> = seeds.map(|seed| made(&walled(grains, seed))).collect();
        let both = [("walls", walled(grains, 1)), ("membranes", wrapped())];
        let tests = both.map(|(name, loaded)| {
            (name, packs.iter().map(|pack| press(&loaded, pack)).collect::<Vec<Course>>())
        });
        for (name, tests) in &tests {
            let [a, b, c, d] = STRAINS.map(|strain| mean(tests.iter().map(|t| ratio(t, strain))));
            println!(
                "| {grains} | {name} | {a} | {b} | {c} | {d} | {} | {} | {} | {} |",
                mean(tests.iter().map(|t| t.major[t.peak()] / t.minor[t.peak()])),
                spread(
                    tests
                        .iter()
                        .map(|t| { secant_50(&t.axial, &t.deviator()).unwrap_or(f64::NAN) / 1e6 }),
                    1
                ),
                tests.len(),
                tests.iter().filter(|test| !test.whole).count(),
            );
        }
    }
}

fn press(loaded: &Loaded, pack: &Pack) -> Course {
    let end = STRAINS[STRAINS.len() - 1];
    let mut rig = Rig::new(&loaded.scene, pack);
    rig.press(Some(PRESSURE), |course| course.strain() >= end * (1.0 - 1e-9))
}

/// σ1/σ3 where the strain is first `strain`; NaN where the test did not come so far.
fn ratio(test: &Course, strain: f64) -> f64 {
    let place = test.axial.iter().position(|&at| at >= strain * (1.0 - 1e-9));
    place.map_or(f64::NAN, |at| test.major[at] / test.minor[at])
}

/// Mean and standard error of the tests that tell.
fn mean(values: impl Iterator<Item = f64>) -> String {
    let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    format!("{mean:.2} ± {:.2}", (squares / (count - 1.0) / count).sqrt())
}
