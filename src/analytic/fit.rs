//! What is read off a test: strength, stiffness, directions, shear bands.

pub mod band;
pub mod biaxial;
pub mod directions;
pub mod line;
pub mod record;
pub mod strength;
