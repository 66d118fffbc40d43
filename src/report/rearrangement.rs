//! What an event did to the pack, grain by grain and contact by contact.

use super::EventKind;
use crate::wall;

/// A sudden change inside the pack, in full: which grains went where, which contacts were lost and
/// made, what energy was set free. Grains and walls are numbered as in
/// [`ContactNetwork`](super::ContactNetwork), lists are sorted.
#[derive(Clone, Debug, PartialEq)]
pub struct Rearrangement {
    /// What happened.
    pub kind: EventKind,
    /// Confining stress of the contacts where stability was lost \[Pa\], at the walls of
    /// `stress_after`.
    pub stress_before: f64,
    /// The same at the equilibrium that followed \[Pa\].
    pub stress_after: f64,
    /// Elastic and gravitational energy where stability was lost, with what slip took since the
    /// last equilibrium \[J\].
    pub energy_before: f64,
    /// The same at the equilibrium that followed \[J\].
    pub energy_after: f64,
    /// Grains that carry load and went further than the mean overlap; of a crack its two bodies.
    pub grains: Vec<u32>,
    /// Way of each of them from where stability was lost \[m\].
    pub displacement: Vec<[f64; 3]>,
    /// Rotation of each of them from there \[rad\]; empty without friction.
    pub rotation: Vec<[f64; 3]>,
    /// Contacts that were there where stability was lost and are no more, (first, second).
    pub lost: Vec<[u32; 2]>,
    /// Contacts of the equilibrium that followed that were not there where stability was lost.
    pub made: Vec<[u32; 2]>,
}

/// Which end of an event a snapshot shows, as `graintwin_msgs/Snapshot` numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum EventEnd {
    /// Where stability was lost.
    Before = 0,
    /// The equilibrium that followed.
    After = 1,
}

/// Where all grains were at one end of an event.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Number of the event in its increment, from 0.
    pub event: u32,
    /// Which end.
    pub end: EventEnd,
    /// Position of each wall along its own axis \[m\].
    pub wall_position: [f64; wall::COUNT],
    /// Centres of all grains \[m\], in the order of the pack file.
    pub position: Vec<[f64; 3]>,
    /// Their rotations since the pack was made, as `history` of a stored pack \[rad\]; empty without
    /// friction.
    pub rotation: Vec<[f64; 3]>,
}
