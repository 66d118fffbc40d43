//! The thesis' results again: moduli of packs of glass beads with and without friction, for
//! several seeds. `cargo bench --bench validation --no-default-features`
//!
//! Writes the figures of `docs/validation.md` into `docs/images` and prints its tables. Seeds as
//! arguments take the place of the default ones: `-- 4 5`; with the argument `events` it does those
//! of the events alone. One thread; takes minutes.
#![allow(clippy::print_stdout, clippy::expect_used)] // A bench prints, and ends when a step fails.

mod curve;
mod events;
mod figures;
mod intervals;
mod runs;
mod specimen;
mod tables;
mod theory;

use std::path::Path;

use runs::Sample;

/// Seeds of the packs.
const SEEDS: [u64; 3] = [1, 2, 3];

fn main() {
    let given: Vec<u64> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    let seeds = if given.is_empty() { SEEDS.to_vec() } else { given };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/images");
    pool.install(|| events::run(&seeds, &folder));
    if std::env::args().any(|argument| argument == "events") {
        return;
    }
    let samples: Vec<Sample> =
        pool.install(|| seeds.iter().map(|&seed| Sample::run(seed)).collect());
    tables::print(&samples);
    println!();
    for (name, sheet) in figures::sheets(&samples) {
        let file = folder.join(name).with_extension("svg");
        std::fs::write(&file, sheet.to_svg()).expect("docs/images is part of the repository");
        println!("docs/images/{name}.svg");
    }
}
