//! What the program starts from: scenes, packs, and how they are made.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod generate;
#[path = "../common/histories.rs"]
mod histories;
mod no_panic;
mod pack_csv;
mod pack_history;
#[path = "../common/packs.rs"]
mod packs;
mod prepare;
mod scene;
mod scene_echo;
