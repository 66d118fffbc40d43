//! graintwin: a digital twin of a granular specimen in a lab loading rig.
#![cfg_attr(test, allow(clippy::unwrap_used))]

pub mod command;
pub mod msg;
#[cfg(feature = "ros")]
pub mod node;
pub mod pack;
#[cfg(feature = "mcap")]
pub mod record;
pub mod report;
pub mod scene;
pub mod sink;
pub mod twin;
pub mod wall;
