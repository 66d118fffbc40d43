//! T 2.7.4.1, figures 2.10 to 2.12: instabilities of packs without friction, what they do to the
//! grains and force chains, and the hysteresis that they leave.

mod cluster;
mod course;
mod figures;
mod tables;

use std::path::Path;

use graintwin::report::Demand;
use graintwin::wall;

pub(crate) use course::{Course, Point};

/// Increments of strain on every axis (T fig. 2.11), and how many.
const STEP: f64 = 5e-5;
const ISOTROPIC: u32 = 200;
/// Strains of the three axes over the largest in the polyaxial cycle, and its increments up.
const POLYAXIAL: [f64; 3] = [0.6, 0.8, 1.0];
const CYCLE: u32 = 100;
const CYCLE_STEP: f64 = 1e-4;

/// The runs of one seed.
pub(crate) struct Seed {
    pub(crate) seed: u64,
    /// Isotropic loading of 306 grains.
    pub(crate) loading: Course,
    /// Polyaxial loading and unloading of 2740 grains.
    pub(crate) cycle: Course,
}

impl Seed {
    fn run(seed: u64) -> Self {
        let up = (1..=ISOTROPIC).map(|k| [STEP * f64::from(k); wall::COUNT / 2]);
        let loading = Course::run((306, seed), 1e6, &up.collect::<Vec<_>>(), Demand::ALL);
        let there_and_back = (1..=CYCLE).chain((0..CYCLE).rev());
        let cycle = there_and_back.map(|k| POLYAXIAL.map(|axis| axis * CYCLE_STEP * f64::from(k)));
        let state = Demand { state: true, ..Demand::NONE };
        let cycle = Course::run((2740, seed), 4e6, &cycle.collect::<Vec<_>>(), state);
        Self { seed, loading, cycle }
    }
}

/// Runs the seeds, prints the tables and writes the figures into `folder`.
pub(crate) fn run(seeds: &[u64], folder: &Path) {
    let seeds: Vec<Seed> = seeds.iter().map(|&seed| Seed::run(seed)).collect();
    tables::print(&seeds);
    let first = &seeds[0];
    let drawn = [
        ("validation_events", figures::loading(&seeds).to_svg()),
        ("validation_jump", cluster::svg(&first.loading)),
        ("validation_hysteresis", figures::hysteresis(first).to_svg()),
    ];
    for (name, svg) in drawn {
        let file = folder.join(name).with_extension("svg");
        std::fs::write(&file, svg).expect("docs/images is part of the repository");
        println!("docs/images/{name}.svg");
    }
}
