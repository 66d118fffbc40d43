//! What the program says and draws, at the boundary of its process.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[cfg(feature = "mcap")]
#[path = "../common/answers.rs"]
mod answers;
mod bench;
mod bench_limit;
mod charts;
mod charts_png;
mod cli;
#[path = "../common/packs.rs"]
mod packs;
mod pictures;
mod pictures_round;
mod plot;
mod plot_values;
#[cfg(feature = "mcap")]
#[path = "../common/plotted.rs"]
mod plotted;
#[cfg(feature = "mcap")]
#[path = "../common/python.rs"]
mod python;
mod stiffness;
