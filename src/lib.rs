//! graintwin: a digital twin of a granular specimen in a lab loading rig.
#![cfg_attr(test, allow(clippy::unwrap_used))]

pub mod command;
pub mod msg;
#[cfg(feature = "ros")]
pub mod node;
pub mod pack;
pub mod report;
pub mod scene;
pub mod sink;
pub mod twin;
pub mod wall;
