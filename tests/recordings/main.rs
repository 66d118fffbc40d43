//! Recordings: written, damaged, recovered, read, replayed.
#![cfg(feature = "mcap")]
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "../common/answers.rs"]
mod answers;
mod bag;
mod bags;
#[path = "../common/bead.rs"]
mod bead;
mod damage;
mod events;
mod failure;
mod hostile;
mod killed;
#[path = "../common/mcap_bytes.rs"]
mod mcap_bytes;
mod of_others;
#[path = "../common/packs.rs"]
mod packs;
#[path = "../common/python.rs"]
mod python;
mod recover;
mod replay;
mod split;
