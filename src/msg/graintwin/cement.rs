//! The messages that tell of cement.

use serde::{Deserialize, Serialize};

use crate::msg::schema::describe;
use crate::msg::standard::Header;

/// Every pair that was cemented: all of an equilibrium, or a chunk of them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Bonds {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Number of this chunk, from 0.
    pub chunk: u32,
    /// Chunks of this equilibrium, at least 1.
    pub chunk_count: u32,
    /// Tensile strength of whole cement \[Pa\].
    pub tensile_strength: f64,
    /// Shear strength of whole cement \[Pa\].
    pub shear_strength: f64,
    /// Grain index in the order of the pack file.
    pub first: Vec<u32>,
    /// Grain index, or `u32::MAX - w` for wall w.
    pub second: Vec<u32>,
    /// A [`BondCondition`](crate::report::BondCondition) as a number.
    pub condition: Vec<u8>,
    /// Share of the cement that is left.
    pub share: Vec<f64>,
    /// Radius of the cross-section \[m\].
    pub radius: Vec<f64>,
    /// Centre of the contact, three numbers a bond \[m\].
    pub position: Vec<f64>,
    /// Unit normal from second to first, three numbers a bond.
    pub normal: Vec<f64>,
    /// Normal force, negative in tension \[N\].
    pub normal_force: Vec<f64>,
    /// Tangential force on first, three numbers a bond \[N\].
    pub tangential_force: Vec<f64>,
    /// Couple on first along the normal \[N m\].
    pub torsion: Vec<f64>,
    /// Largest stress over its strength.
    pub strength_use: Vec<f64>,
}

/// The bonds that broke in one increment: all of them, or a chunk.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cracks {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Number of this chunk, from 0.
    pub chunk: u32,
    /// Chunks of this increment, at least 1.
    pub chunk_count: u32,
    /// Bonds that hold.
    pub intact: u32,
    /// Bonds that broke by the tensile stress so far.
    pub broken_by_tension: u32,
    /// Bonds that broke by the shear stress so far.
    pub broken_by_shear: u32,
    /// Grain index in the order of the pack file.
    pub first: Vec<u32>,
    /// Grain index, or `u32::MAX - w` for wall w.
    pub second: Vec<u32>,
    /// A [`BondCondition`](crate::report::BondCondition) as a number, never intact.
    pub mode: Vec<u8>,
    /// Equilibria of the increment before each.
    pub substep: Vec<u32>,
    /// Centre of the contact, three numbers a crack \[m\].
    pub position: Vec<f64>,
    /// Unit normal from second to first, three numbers a crack.
    pub normal: Vec<f64>,
    /// Normal force that the cement carried, negative in tension \[N\].
    pub normal_force: Vec<f64>,
    /// Magnitude of its tangential force \[N\].
    pub tangential_force: Vec<f64>,
    /// Magnitude of its couple about the normal \[N m\].
    pub torsion: Vec<f64>,
    /// Stress over strength.
    pub overload: Vec<f64>,
    /// Confining stress before \[Pa\].
    pub stress_before: Vec<f64>,
    /// Confining stress after \[Pa\].
    pub stress_after: Vec<f64>,
    /// Energy lost with it \[J\].
    pub energy_released: Vec<f64>,
}

impl Cracks {
    /// The [`mode`](Self::mode) of a bond that the tensile stress broke.
    pub const TENSION: u8 = 1;
}

describe!(
    Bonds,
    "graintwin_msgs",
    include_str!("../../../msgs/graintwin_msgs/msg/Bonds.msg"),
    &[Header::TYPE],
    "56caff0c9b16d694ac7db17f36d30699e8add72727a766b0b73ae7f176a0572e"
);
describe!(
    Cracks,
    "graintwin_msgs",
    include_str!("../../../msgs/graintwin_msgs/msg/Cracks.msg"),
    &[Header::TYPE],
    "92ba19501b0792ebdafd37d116817b3d63d34578b75dfbf8cad47808c3540ff9"
);
