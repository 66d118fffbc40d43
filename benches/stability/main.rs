//! The stability suite: how the program answers to hard scenes, and whether an increment ends where
//! the gradient flow ends. `cargo bench --bench stability --no-default-features`
//!
//! Writes the tables of `docs/stability.md`. With an argument, `agreement` or the name of a scene, it
//! runs that alone.
#![allow(clippy::print_stdout, clippy::print_stderr, clippy::expect_used)] // A bench prints, and ends when its input is not there.
#![allow(clippy::unwrap_used)] // In what it shares with the tests.

mod agreement;
#[path = "../../tests/common/hard.rs"]
mod hard;
#[path = "../../tests/common/packs.rs"]
mod packs;
mod reference;
mod scenes;

fn main() {
    let only = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| {
        if only.as_deref() != Some("agreement") {
            scenes::run(only.as_deref());
        }
        if only.as_deref().is_none_or(|only| only == "agreement") {
            agreement::run();
        }
    });
}
