//! The stability suite: how the program answers to hard scenes, and whether an increment ends where
//! the gradient flow ends. `cargo bench --bench stability --no-default-features`
//!
//! Writes the tables of `docs/stability.md` and, from `detection`, of `docs/events.md`. With an
//! argument, `agreement`, `detection` or the name of a scene, it runs that alone.
#![allow(clippy::print_stdout, clippy::print_stderr, clippy::expect_used)] // A bench prints, and ends when its input is not there.
#![allow(clippy::unwrap_used)] // In what it shares with the tests.

mod agreement;
mod detection;
#[path = "../../tests/common/hard.rs"]
mod hard;
#[path = "../../tests/common/packs.rs"]
mod packs;
mod reference;
mod scenes;

use agreement::Tally;

fn main() {
    let only = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| {
        if only.as_deref().is_none_or(|only| only == "detection") {
            detect();
        }
        if !matches!(only.as_deref(), Some("agreement" | "detection")) {
            scenes::run(only.as_deref());
        }
        if only.as_deref().is_none_or(|only| only == "agreement") {
            agree();
        }
    });
}

/// Packs for each stress in the table of agreement.
const PACKS: u64 = 40;

fn agree() {
    println!(
        "| friction | strain / overlap strain | increments | followed | events | same, no event | same, event | failed |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for friction in [0.0, 0.3] {
        for tally in agreement::tally(PACKS, friction) {
            let Tally { share, quiet, loud, followed, failed } = tally;
            let all = quiet[0] + loud[0];
            println!(
                "| {friction} | {share} | {all} | {followed} | {} | {}/{} | {}/{} | {failed} |",
                loud[0], quiet[1], quiet[0], loud[1], loud[0],
            );
        }
    }
}

/// Friction, packs for each stress and increments of each in the table of detection.
const DETECTED: [(f64, u64, u32); 2] = [(0.0, 20, 100), (0.3, 5, 40)];

fn detect() {
    println!(
        "| friction | increments | event in both | program alone | flow alone | ended elsewhere | failed |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (friction, packs, increments) in DETECTED {
        let seen = detection::detect(packs, increments, friction);
        println!(
            "| {friction} | {} | {} | {} | {} | {} | {} |",
            seen.increments,
            seen.both,
            seen.program_alone,
            seen.flow_alone,
            seen.elsewhere,
            seen.failed
        );
    }
}
