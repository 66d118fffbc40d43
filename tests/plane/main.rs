//! Discs, their samples and their tests (van Baars' model).
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "../common/cemented.rs"]
mod cemented;
#[path = "../common/packs.rs"]
mod packs;

mod crystal;
mod gradings;
mod rescale;
