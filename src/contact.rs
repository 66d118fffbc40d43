//! Contacts: who is near whom, and the laws between them.

pub mod hertz;
pub mod mindlin;
pub mod neighbours;
pub mod partial_slip;
