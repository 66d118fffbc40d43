//! Contacts: who is near whom, and the laws between them.

pub(crate) mod cells;
pub mod cement;
pub mod coulomb;
pub mod hertz;
pub mod mindlin;
pub mod neighbours;
pub mod partial_slip;

/// What a grain touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Other {
    /// A grain, in the solver's order.
    Grain(u32),
    /// A wall.
    Wall(u8),
}
