//! Contacts: who is near whom, and the laws between them.

pub mod hertz;
pub mod neighbours;
