//! What a rig asks of the twin, and what became of it.

pub mod circumstance;
mod dissociation;
pub mod gate;
pub mod map;
pub mod merge;
pub mod request;
mod shear;

use serde::{Deserialize, Serialize};

use crate::wall::{self, WallTarget};
pub use dissociation::Dissociation;
pub use shear::Shear;

/// A point in time as ROS 2 writes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Stamp {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds within the second.
    pub nanosec: u32,
}

impl Stamp {
    /// The stamp `seconds` after zero, rounded to a nanosecond and clamped to the range of the type.
    #[must_use]
    pub fn from_seconds(seconds: f64) -> Self {
        let nanos = (seconds * 1e9).round() as i64;
        let sec = nanos.div_euclid(1_000_000_000).clamp(i64::from(i32::MIN), i64::from(i32::MAX));
        Self { sec: sec as i32, nanosec: nanos.rem_euclid(1_000_000_000) as u32 }
    }

    /// The stamp `nanoseconds` later, unless the type does not reach that far.
    #[must_use]
    pub fn later(self, nanoseconds: i64) -> Option<Self> {
        let nanoseconds = self.nanoseconds().checked_add(nanoseconds)?;
        let sec = i32::try_from(nanoseconds.div_euclid(1_000_000_000)).ok()?;
        Some(Self { sec, nanosec: nanoseconds.rem_euclid(1_000_000_000) as u32 })
    }

    /// Seconds since zero.
    #[must_use]
    pub fn seconds(self) -> f64 {
        f64::from(self.sec) + f64::from(self.nanosec) * 1e-9
    }

    /// Nanoseconds since zero.
    #[must_use]
    pub fn nanoseconds(self) -> i64 {
        i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)
    }
}

/// How a command's displacement is meant; the numbers are those of `graintwin_msgs/BoundaryCommand`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "u8", into = "u8")]
pub enum Mode {
    /// Since the start of the run.
    Absolute,
    /// On top of the last accepted target.
    Increment,
    /// A number without a meaning: such a command is refused as [`Disposition::Invalid`].
    Unknown(u8),
}

impl From<u8> for Mode {
    fn from(number: u8) -> Self {
        match number {
            0 => Self::Absolute,
            1 => Self::Increment,
            other => Self::Unknown(other),
        }
    }
}

impl From<Mode> for u8 {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Absolute => 0,
            Mode::Increment => 1,
            Mode::Unknown(number) => number,
        }
    }
}

/// What a command asks of the walls, or of the hydrate between the grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ask {
    /// An inward displacement of every wall \[m\]; walls under a load keep it. This is
    /// `graintwin_msgs/BoundaryCommand`.
    Displacement([f64; wall::COUNT]),
    /// A target of each wall. This is `graintwin_msgs/WallTargets`.
    Targets([WallTarget; wall::COUNT]),
    /// Hydrate dissociates. This is `graintwin_msgs/Dissociation`.
    Dissociation(Dissociation),
    /// A box of discs is tilted. This is `graintwin_msgs/ShearCommand`.
    Shear(Shear),
}

impl Ask {
    /// Its six numbers \[m, N or Pa\], 0 for a wall that does what it did.
    #[must_use]
    pub fn numbers(&self) -> [f64; wall::COUNT] {
        self.targets().map(|target| target.numbers().1)
    }

    /// The targets of the walls that it moves.
    #[must_use]
    pub fn targets(&self) -> [WallTarget; wall::COUNT] {
        match self {
            Self::Displacement(displacement) => displacement.map(WallTarget::Displacement),
            Self::Targets(targets) => *targets,
            Self::Shear(shear) => shear.targets,
            Self::Dissociation(_) => [WallTarget::Keep; wall::COUNT],
        }
    }
}

/// One command.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// When the rig measured or issued it.
    pub stamp: Stamp,
    /// A new session restarts the sequence.
    pub session: String,
    /// Increases by one within a session.
    pub sequence: u64,
    /// Absolute or incremental.
    pub mode: Mode,
    /// What it asks for.
    pub ask: Ask,
    /// How old it was when it arrived, by the wall clock against its stamp \[s\]; `None` when
    /// nothing says so, as for a command from a file. It is no part of what the rig asked: a
    /// recording does not hold it.
    pub age: Option<f64>,
}

/// What became of a command; the numbers are those of `graintwin_msgs/Report`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "SCREAMING_SNAKE_CASE")]
#[repr(u8)]
pub enum Disposition {
    /// The walls moved as asked.
    Applied = 0,
    /// The walls moved up to a limit.
    Clamped = 1,
    /// The command was served before; its report is repeated.
    Duplicate = 2,
    /// Too old.
    Stale = 3,
    /// Commands before it are missing.
    Gap = 4,
    /// Older than one already served.
    OutOfOrder = 5,
    /// Beyond a limit of travel, rate, strain or force.
    Limit = 6,
    /// Not a command: NaN, infinite, unknown mode.
    Invalid = 7,
    /// No equilibrium was found; the twin is back at the last one.
    NotConverged = 8,
    /// The twin is on hold.
    Held = 9,
}
