//! Packs of discs: contacts a grain of loose and of dense sand (B table 2).

use std::f64::consts::PI;
use std::path::Path;

use graintwin::command::Disposition;
use graintwin::pack;
use graintwin::report::{Demand, PackState};
use graintwin::scene::{self, Loaded, Scene};
use graintwin::twin::Twin;

/// Seeds of the four samples.
const SAMPLES: [u64; 4] = [1, 2, 3, 4];
/// Friction while compacting: that of the test for loose packs, none for dense ones.
const DENSITIES: [(&str, f64); 2] = [("low", 0.6), ("high", 0.0)];
/// B table 2: contacts a grain of samples I to IV.
const BOOK: [[f64; 4]; 2] = [[3.1, 3.0, 3.0, 3.1], [4.1, 3.9, 3.9, 4.0]];

/// A sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    state: PackState,
    /// Area of the discs over that of the box.
    solid: f64,
}

/// Sand of B table 1: a thousand grains of grading A at 1 bar, in a box of 2.5 to 1.
fn scene(seed: u64, friction: f64) -> Scene {
    let text = format!(
        "dimension: 2\nmaterials: {{sand: {{young: 2.32e9, poisson: 0.16, density: 2650.0}}}}\n\
         pack:\n  generate: {{grains: 1000, radius: {{grading_a: {{mean: 0.1e-3, ratio: 4.0}}}}, \
         material: sand, seed: {seed}, confining_stress: 1.0e5, aspect: [1, 2.5, 1], \
         compaction_friction: {friction}}}\n\
         walls: {{friction: 0.0}}\ncontact: {{friction: {{coefficient: 0.6}}}}"
    );
    scene::parse(&text, Path::new("validation.yaml")).expect("the scene is right")
}

fn made(seed: u64, friction: f64) -> Sample {
    let scene = scene(seed, friction);
    let loaded = Loaded { scene: scene.clone(), file: "validation.yaml".into() };
    let pack = pack::build(&loaded).expect("the pack is found");
    let [x, y, _] = pack.bounds.sides();
    let area: f64 = pack.grains.iter().map(|grain| PI * grain.radius * grain.radius).sum();
    let mut twin = Twin::new(&scene, &pack, 1).expect("a twin");
    let report = twin.start(Demand { state: true, ..Demand::NONE });
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let state = report.measures.and_then(|measures| measures.state).expect("it was asked for");
    Sample { state, solid: area / (x * y) }
}

/// The samples of each density.
pub(crate) fn run() -> [[Sample; 4]; 2] {
    DENSITIES.map(|(_, friction)| SAMPLES.map(|seed| made(seed, friction)))
}

/// Prints the table of the documentation.
pub(crate) fn print(all: &[[Sample; 4]; 2]) {
    println!("\nContacts a grain of discs (B table 2):\n");
    println!(
        "| density | friction while compacting | I | II | III | IV | B | floating | solid area |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (((density, friction), samples), book) in DENSITIES.iter().zip(all).zip(BOOK) {
        let contacts = samples.map(|sample| format!("{:.2}", sample.state.coordination_number));
        let floating = samples.map(|sample| f64::from(sample.state.rattlers) / 1000.0);
        let spread = |values: [f64; 4]| {
            let (low, high) = (values.iter().copied())
                .fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
            format!("{:.3} [{low:.3}, {high:.3}]", values.iter().sum::<f64>() / 4.0)
        };
        println!(
            "| {density} | {friction} | {} | {} | {} | {} |",
            contacts.join(" | "),
            book.map(|number| format!("{number:.1}")).join(", "),
            spread(floating),
            spread(samples.map(|sample| sample.solid)),
        );
    }
}
