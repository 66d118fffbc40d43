//! What becomes of commands, limits and load paths.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod any;
mod commands;
mod limits;
mod load_path;
mod load_path_loads;
mod loads;
mod map;
mod merge;
#[path = "../common/packs.rs"]
mod packs;
mod requests;
