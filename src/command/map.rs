//! Commands from messages that are not this package's: joints of a rig that move walls.
//!
//! Sequences are counted here, one a command. Walls that no joint moves keep doing what they do. A
//! message that makes no command becomes [`Intake::Malformed`](super::request::Intake), so that it
//! is reported as INVALID like everything else that came in: the command in its place asks for NaN
//! where a joint would move a wall.

mod joints;
mod states;
mod trajectory;

pub use states::JointStateMap;
pub use trajectory::TrajectoryMap;
