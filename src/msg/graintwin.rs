//! The messages of the package `graintwin_msgs`; units, signs and meanings are in its texts.

mod cement;

mod grain_motion;

mod fabric;

mod hydrate;
mod shear;

mod plane;

mod tangent;

use serde::{Deserialize, Serialize};

pub use cement::{Bonds, Cracks};
pub use grain_motion::GrainMotion;

use super::schema::describe;
use super::standard::{Header, Vector3};
use crate::wall;
pub use tangent::{Tangent, TangentModuli};

pub use fabric::Fabric;

pub use hydrate::{Dissociation, Hydrate};

pub use shear::{ShearCommand, ShearState};

pub use plane::PlaneState;

/// Where the walls shall be.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BoundaryCommand {
    /// When the rig measured or issued it.
    pub header: Header,
    /// A new session restarts the sequence.
    pub session: String,
    /// Increases by one within a session.
    pub sequence: u64,
    /// A [`Mode`](crate::command::Mode) as a number.
    pub mode: u8,
    /// Inward displacement of each wall \[m\].
    pub displacement: [f64; wall::COUNT],
}

/// What each wall shall do: stand somewhere, or carry a load.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WallTargets {
    /// When the rig measured or issued it.
    pub header: Header,
    /// A new session restarts the sequence.
    pub session: String,
    /// Increases by one within a session, boundary commands counted too.
    pub sequence: u64,
    /// A [`Mode`](crate::command::Mode) as a number.
    pub mode: u8,
    /// The kind of each wall's [`WallTarget`](crate::wall::WallTarget) as a number.
    pub control: [u8; wall::COUNT],
    /// Its value \[m, N or Pa\].
    pub value: [f64; wall::COUNT],
}

/// Forces on the six walls.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WallForces {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Normal force, never negative \[N\].
    pub normal_force: [f64; wall::COUNT],
    /// Inward displacement since the start of the run \[m\].
    pub displacement: [f64; wall::COUNT],
    /// Force that the pack exerts on each wall \[N\].
    pub force: [Vector3; wall::COUNT],
    /// Moment of that force about the pack's centre \[N m\].
    pub moment: [Vector3; wall::COUNT],
}

/// The pack as a whole.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PackState {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Engineering strain along x, y, z.
    pub strain: [f64; 3],
    /// Stress from the wall forces, row major \[Pa\].
    pub stress_walls: [f64; 9],
    /// Stress from the contacts, row major \[Pa\].
    pub stress_contacts: [f64; 9],
    /// A third of the trace of the wall stress \[Pa\].
    pub confining_stress: f64,
    /// Axial wall stress minus the mean of the other two \[Pa\].
    pub deviatoric_stress: f64,
    /// Pore volume over total volume.
    pub porosity: f64,
    /// (2 grain-grain + grain-wall contacts) / grains.
    pub coordination_number: f64,
    /// Sliding contacts over all contacts.
    pub sliding_ratio: f64,
    /// Elastic and gravitational energy \[J\].
    pub stored_energy: f64,
    /// Energy lost since the start \[J\].
    pub dissipated_energy: f64,
    /// Contacts that carry load.
    pub contacts: u32,
    /// Grains that carry none.
    pub rattlers: u32,
    /// Iterations of the solver.
    pub iterations: u32,
    /// Relative residual of the equilibrium.
    pub residual: f64,
    /// Wall-clock time of the increment \[s\].
    pub solve_seconds: f64,
    /// Whether the residual is below the tolerance.
    pub converged: bool,
}

/// Elastic moduli of the last interval; NaN where the path cannot tell one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moduli {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Whether at least one modulus is known.
    pub valid: bool,
    /// Bulk modulus K \[Pa\].
    pub bulk: f64,
    /// Shear modulus G \[Pa\].
    pub shear: f64,
    /// Young's modulus E \[Pa\].
    pub young: f64,
    /// Poisson's ratio ν.
    pub poisson: f64,
    /// Lamé's first parameter λ \[Pa\].
    pub lame: f64,
    /// P-wave modulus \[Pa\].
    pub p_wave: f64,
    /// dσ_l/dε_m over xx, yy, zz, row major \[Pa\].
    pub tangent: [f64; 9],
}

/// Load-carrying contacts: all of an equilibrium, or a chunk of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactNetwork {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Number of this chunk, from 0.
    pub chunk: u32,
    /// Chunks of this equilibrium, at least 1.
    pub chunk_count: u32,
    /// Grain index in the order of the pack file.
    pub first: Vec<u32>,
    /// Grain index, or `u32::MAX - w` for wall w.
    pub second: Vec<u32>,
    /// Unit normal from second to first, three numbers a contact.
    pub normal: Vec<f64>,
    /// Normal force \[N\].
    pub normal_force: Vec<f64>,
    /// Tangential force on first, three numbers a contact \[N\].
    pub tangential_force: Vec<f64>,
    /// Overlap \[m\].
    pub overlap: Vec<f64>,
    /// A [`ContactState`](crate::report::ContactState) as a number.
    pub state: Vec<u8>,
}

/// What became of one command.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Report {
    /// Stamp of the command.
    pub header: Header,
    /// Session of the command.
    pub session: String,
    /// Sequence of the command.
    pub sequence: u64,
    /// The increment after the command.
    pub increment: u64,
    /// A [`Disposition`](crate::command::Disposition) as a number.
    pub disposition: u8,
    /// Equilibria that were found on the way.
    pub substeps: u32,
    /// One sentence for a person, or nothing.
    pub text: String,
}

/// A sudden change inside the pack.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Stamp of the command served.
    pub header: Header,
    /// The increment in which it happened.
    pub increment: u64,
    /// 0 stress drop, 1 broken contact.
    pub kind: u8,
    /// Confining stress before \[Pa\].
    pub stress_before: f64,
    /// Confining stress after \[Pa\].
    pub stress_after: f64,
    /// Grains that jumped.
    pub grains: Vec<u32>,
    /// How far each of them moved \[m\].
    pub displacement: Vec<f64>,
}

/// Normal forces of the twin against those of the real rig; NaN where a wall was not measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Discrepancy {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Whether the wall has a measurement close enough in time.
    pub valid: [bool; wall::COUNT],
    /// Normal force in the twin \[N\].
    pub twin_force: [f64; wall::COUNT],
    /// Normal force at the rig \[N\].
    pub rig_force: [f64; wall::COUNT],
    /// The former minus the latter \[N\].
    pub difference: [f64; wall::COUNT],
    /// Stamp of the measurement minus stamp of the command \[s\].
    pub delay: [f64; wall::COUNT],
}

/// What besides commands bears on the twin's answers, in its order among the commands.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Circumstance {
    /// When it happened, by the clock of the machine; no frame.
    pub header: Header,
    /// The increment at which it happened.
    pub increment: u64,
    /// What happened, as the message numbers it.
    pub kind: u8,
    /// Whether what was asked was done.
    pub success: bool,
    /// What was answered, or what is wrong with the message.
    pub text: String,
    /// Keys of the scene, or `age`.
    pub name: Vec<String>,
    /// Their values.
    pub value: Vec<f64>,
}

/// Ties a struct to the text of its message under `msgs/`.
macro_rules! message {
    ($message:ident, $uses:expr, $hash:literal) => {
        describe!(
            $message,
            "graintwin_msgs",
            include_str!(concat!("../../msgs/graintwin_msgs/msg/", stringify!($message), ".msg")),
            $uses,
            $hash
        );
    };
}

message!(
    BoundaryCommand,
    &[Header::TYPE],
    "c111f0dffddf988806420ff4569bcfaf07c7976e48d53e5f1c3651bc57951f32"
);
message!(
    WallTargets,
    &[Header::TYPE],
    "3b2053161b0e565e63222cf7562102a4c724f5137ce28963446e2475fdfb72fb"
);
message!(
    Dissociation,
    &[Header::TYPE],
    "0ff1686f2a4432051f58531579a1719a100d2b16b1ed2cec5e1eddc1fddc1087"
);
message!(
    ShearCommand,
    &[Header::TYPE],
    "4d861b2f3c9c5b1b7367e6ca0c265c868021577f1dc42569308e19175c370153"
);
message!(
    ShearState,
    &[Header::TYPE],
    "463cbc2629e43d0a396005bddcafeb19481a3dda0234a6d5ef5b9d744e615187"
);
message!(
    Hydrate,
    &[Header::TYPE],
    "18043ae68674771914dccccdcab5a2df4bb5216df1d8d485da3d4110a9b59e06"
);
message!(
    PlaneState,
    &[Header::TYPE],
    "f0324477ee45d2a6934a8acedefc60043e63a18ae785479fa28b231d934e8359"
);
message!(
    WallForces,
    &[Vector3::TYPE, Header::TYPE],
    "8c850c3f73d4159398e4a93ad4f5133da43f0ed6cb8336c9859ee01ee9f14824"
);
message!(
    PackState,
    &[Header::TYPE],
    "8304348e17098fc0f4d7809907c79f87918a6b9bc4b63d3440dbe069e8cd35f8"
);
message!(
    Moduli,
    &[Header::TYPE],
    "a79c01631556b553a1cf290a00117e3388f7526b57ee4ff209d45d3dc46d1c62"
);
message!(
    ContactNetwork,
    &[Header::TYPE],
    "6201473849da61008401285a322d2ad2bef828f205bb7c71d65ea59571d374c6"
);
message!(
    Report,
    &[Header::TYPE],
    "6057c983fa7a854327ec7fbcc6d4117988922e402b57b8de6cb29dcb0f013fec"
);
message!(
    Event,
    &[Header::TYPE],
    "9f1b0c43f9cff3211287b84a8ec76e58fca0007b277f937673b1ab5bf87cee0a"
);
message!(
    Fabric,
    &[Header::TYPE],
    "4bee00b59ab2a18a5e459924fe03f394439e74f2c1bf31cc2e40722fbcfdf5f9"
);
message!(
    Discrepancy,
    &[Header::TYPE],
    "92acd9e409d13a1d8a9a8bb9d44d8602dbe937eea4b8329c754038b7d1f385fe"
);
message!(
    Circumstance,
    &[Header::TYPE],
    "89843d5ebd2635c46484a0db92aca5eaf05c61c852c97edec138329307887986"
);
