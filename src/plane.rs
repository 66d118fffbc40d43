//! Discs in the plane: the core of a scene with `dimension: 2` (van Baars' Grain; B is his thesis).
//!
//! A grain has three freedoms, x, y and its turn φ about z, and nothing of the third dimension is in
//! its memory or loop. State, reports and recordings are those of spheres with z = 0: a disc is as deep
//! as the box, whose depth is the mean diameter (B 3.1.3), so that areas, volumes and stresses are those
//! of the box.
//!
//! [`advance`](advance::advance) moves the walls in sub-increments. Each begins where the contacts are
//! ([`mod@reference`]): their shear counts from there, with the stiffness and the limit of that normal force
//! ([`law`]), and so has a potential. `newton` finds its minimum over the grains and the walls that
//! carry loads, with the balance of forces ([`balance`]) of all contacts ([`act`]) and its exact derivative
//! ([`slope`]), factorised directly ([`matrix`]). `gauss_seidel`, grain by grain, and `dynamic`, motion with
//! damping, come to the same minimum without that.

pub mod act;
pub mod advance;
pub mod balance;
pub mod boundary;
pub mod cell;
mod commit;
pub mod contacts;
pub mod crack;
mod dynamic;
mod floating;
mod gauss_seidel;
pub mod glue;
pub mod law;
pub mod lean;
mod line;
mod loads;
pub mod matrix;
pub mod membrane;
mod newton;
mod outline;
pub mod pose;
pub mod pressed;
pub mod reference;
pub mod setup;
pub mod slope;
pub mod tangent;
mod work;

pub use cell::Cell;
pub use setup::{Law, Setup, Strength};
pub use work::Workspace;

/// A vector in the plane.
pub(crate) type Vec2 = nalgebra::Vector2<f64>;

/// Most boundary drives: one a side.
pub(crate) const DRIVES: usize = 4;

/// `v` turned by a right angle to the left.
pub(crate) fn left_of(v: Vec2) -> Vec2 {
    Vec2::new(-v.y, v.x)
}
