//! The thesis' results again: moduli of packs of glass beads with and without friction, for
//! several seeds. `cargo bench --bench validation --no-default-features`
//!
//! Writes the figures of `docs/validation.md` into `docs/images` and prints its tables. Seeds as
//! arguments take the place of the default ones: `-- 4 5`, and names of parts select them:
//! `-- network` (the force network), `-- events`, `-- cement`, `-- two_step`, `-- hydrates`,
//! `-- moduli`, `-- samples` (packs of discs), `-- sand`, `-- unconfined`, `-- sandstone`, `-- cylinder`, `-- bend`,
//! `-- crystal`, `-- simple_shear`.
//! One thread; takes minutes.
#![allow(clippy::print_stdout, clippy::expect_used)] // A bench prints, and ends when a step fails.

mod cement;
mod curve;
mod events;
mod figures;
mod hydrates;
mod intervals;
mod network;
mod plane;
mod runs;
mod samples;
mod simple_shear;
mod specimen;
mod tables;
mod theory;
mod two_step;

use std::path::{Path, PathBuf};

use graintwin::view::Sheet;
use hydrates::Dissociations;
use network::Networks;
use runs::Sample;

/// Seeds of the packs.
const SEEDS: [u64; 3] = [1, 2, 3];

/// Parts that can be selected.
const PARTS: [&str; 14] = [
    "moduli",
    "network",
    "events",
    "cement",
    "two_step",
    "hydrates",
    "samples",
    "sand",
    "unconfined",
    "sandstone",
    "cylinder",
    "bend",
    "crystal",
    "simple_shear",
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let given: Vec<u64> = arguments.iter().filter_map(|argument| argument.parse().ok()).collect();
    let seeds = if given.is_empty() { SEEDS.to_vec() } else { given };
    let named = |part: &str| arguments.iter().any(|argument| argument == part);
    let selected = |part: &str| named(part) || !PARTS.into_iter().any(named);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    if selected("moduli") {
        let samples: Vec<Sample> =
            pool.install(|| seeds.iter().map(|&seed| Sample::run(seed)).collect());
        tables::print(&samples);
        draw(figures::sheets(&samples));
    }
    if selected("network") {
        let networks: Vec<Networks> =
            pool.install(|| seeds.iter().map(|&seed| Networks::run(seed)).collect());
        network::print(&networks);
        draw(network::sheets(&networks));
    }
    if selected("hydrates") {
        let runs = seeds.iter().flat_map(|&seed| hydrates::CHOICES.map(|choice| (seed, choice)));
        let all: Vec<Dissociations> =
            pool.install(|| runs.map(|(seed, choice)| Dissociations::run(seed, choice)).collect());
        hydrates::print(&all);
        draw(vec![hydrates::sheet(&all)]);
    }
    if selected("events") {
        pool.install(|| events::run(&seeds, &images()));
    }
    if selected("cement") {
        let samples = pool.install(|| cement::run(&seeds));
        cement::print(&samples);
        draw(cement::sheets(&samples));
    }
    if selected("simple_shear") {
        let tests: Vec<_> =
            pool.install(|| seeds.iter().map(|&seed| simple_shear::run(seed)).collect());
        simple_shear::print(&tests);
    }
    if selected("samples") {
        samples::print(&pool.install(samples::run));
    }
    if selected("sand") {
        pool.install(|| plane::sand(&seeds));
    }
    if selected("unconfined") {
        pool.install(|| plane::unconfined(&seeds));
    }
    if selected("sandstone") {
        pool.install(|| plane::sandstone(&seeds));
    }
    if selected("cylinder") {
        pool.install(|| plane::cylinder(&seeds));
    }
    if selected("bend") {
        pool.install(|| plane::bend(&seeds));
    }
    if selected("crystal") {
        pool.install(plane::crystal);
    }
    if selected("two_step") {
        pool.install(|| two_step::run(&seeds));
    }
}

/// Where the figures of the documentation are.
fn images() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/images")
}

fn draw(sheets: Vec<(&str, Sheet)>) {
    println!();
    for (name, sheet) in sheets {
        let file = images().join(name).with_extension("svg");
        std::fs::write(&file, sheet.to_svg()).expect("docs/images is part of the repository");
        println!("docs/images/{name}.svg");
    }
}
