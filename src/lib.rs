//! A digital twin of a granular specimen in a lab loading rig.
//!
//! # The problem
//!
//! n elastic spheres with centres r_i and radii R_i lie in a box between six elastic planar walls.
//! Contacts carry Hertz' normal force P of their overlap h. For given positions of the walls the
//! twin finds r_i at a minimum of the potential energy Π (T 2.7), where the forces on every grain
//! balance (T 2.5). The walls then move by an increment, and so on: a sequence of equilibria
//! without time. T is R. Holtzman's thesis (see README), numbers in brackets its equations.
//!
//! | symbol | meaning | unit |
//! | --- | --- | --- |
//! | r_ij = r_i - r_j, n̂ | branch vector from j to i, and its direction | m |
//! | h | overlap R_i + R_j - \|r_ij\|, at a wall R_i - (r_i - x_w)·n̂_w | m |
//! | P, kn | normal force, its derivative dP/dh | N, N/m |
//! | E, ν, E\*, R\* | Young's modulus, Poisson's ratio, effective modulus and radius (2.3) | Pa, 1, Pa, m |
//! | σ, ε | stress and engineering strain, compression positive | Pa, 1 |
//! | K, G, λ | bulk and shear modulus, Lamé's first parameter | Pa |
//!
//! Units are SI, axes right-handed with z up, walls in the order of [`wall::NAMES`], their
//! displacements along their inward normals. Float arrays over grains are in the solver's own order
//! inside ([`model::Model::order`]) and in the order of the pack file outside.
//!
//! # A grain between walls
//!
//! ```
//! use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
//! use graintwin::pack::{Grain, Pack};
//! use graintwin::report::Demand;
//! use graintwin::twin::Twin;
//! use graintwin::wall::Bounds;
//!
//! let scene = graintwin::scene::parse("pack: {file: none.csv}", "example.yaml".as_ref())?;
//! let grain = Grain { position: [0.0; 3], radius: 1e-3, young: 70e9, poisson: 0.2, density: 2.5e3, friction: 0.0, hydrate: false };
//! let bounds = Bounds { min: [-1e-3; 3], max: [1e-3; 3] };
//! let mut twin = Twin::new(&scene, &Pack { bounds, grains: vec![grain], history: None }, 1)?;
//! twin.start(Demand::ALL);
//! let session = String::from("example");
//! let ask = Ask::Displacement([0.0, 0.0, 0.0, 0.0, 1e-6, 1e-6]); // z_min and z_max, inwards [m]
//! let command = Command { stamp: Stamp::default(), session, sequence: 1, mode: Mode::Absolute, ask, age: None };
//! let report = twin.apply(&command, Demand::ALL);
//! assert_eq!(report.disposition, Disposition::Applied);
//! let force = report.measures.ok_or("served")?.walls.normal_force[5];
//! let hertz = 4.0 / 3.0 / ((1.0 - 0.04) / 70e9 + (1.0 - 0.495f64.powi(2)) / 7e12) * (1e-3f64).sqrt() * 1e-9;
//! assert!((force / hertz - 1.0).abs() < 1e-12); // P = 4/3 E* √R h^1.5 with h = 1e-6 m
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![cfg_attr(test, allow(clippy::unwrap_used))]

pub mod analytic;
pub mod bench;
pub mod command;
pub mod contact;
mod heap;
pub mod measure;
pub mod model;
pub mod msg;
#[cfg(feature = "ros")]
pub mod node;
pub mod pack;
pub mod path;
pub mod plane;
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
