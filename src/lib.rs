//! graintwin: a digital twin of a granular specimen in a lab loading rig.
#![cfg_attr(test, allow(clippy::unwrap_used))]

pub mod command;
pub mod contact;
pub mod measure;
pub mod model;
pub mod msg;
#[cfg(feature = "ros")]
pub mod node;
pub mod pack;
pub mod path;
#[cfg(feature = "mcap")]
pub mod record;
pub mod relax;
pub mod report;
pub mod scene;
pub mod sink;
pub mod state;
pub mod table;
pub mod twin;
pub mod view;
pub mod wall;

/// A vector in space.
pub type Vec3 = nalgebra::Vector3<f64>;
