//! Contacts that cement holds together (T chapter 4): they carry tension and do not slide.
//!
//! [`deposit`] says where it is. [`effective`] gives grains and cement one stiffness that evolves with the deformation of the
//! contact (T 4.4), [`parallel`] puts an elastic cylinder beside the contact of the grains (T 4.7)
//! and [`strength`] says when either breaks.

pub mod deposit;
pub mod effective;
pub mod parallel;
pub mod strength;
