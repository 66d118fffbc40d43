//! Tangent moduli.

use serde::{Deserialize, Serialize};

use crate::msg::schema::describe;
use crate::msg::standard::Header;

/// Tangent moduli of an equilibrium.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tangent {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Bulk density \[kg/m³\].
    pub density: f64,
    /// Products of the linear system that it took.
    pub products: u64,
    /// With contacts that slide as they stand.
    pub stands: TangentModuli,
    /// With contacts that all stick.
    pub sticks: TangentModuli,
}

/// Tangent moduli with the contacts in one state; NaN where they are not known.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TangentModuli {
    /// Whether they are known.
    pub valid: bool,
    /// Estimate of the relative error of the largest entry.
    pub error: f64,
    /// dσ_l/dε_m over xx, yy, zz, row major \[Pa\], the grains in balance.
    pub relaxed: [f64; 9],
    /// The same with the grains moving affinely \[Pa\].
    pub affine: [f64; 9],
    /// Normal force on a wall by the inward motion of a wall, row major 6x6 \[N/m\].
    pub wall_stiffness: Vec<f64>,
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
    /// Shear modulus by the pairs xy, yz, zx \[Pa\].
    pub shear_pairs: [f64; 3],
    /// Compressional wave speed along x, y, z \[m/s\].
    pub p_speed: [f64; 3],
    /// Shear wave speed by the pairs xy, yz, zx \[m/s\].
    pub s_speed: [f64; 3],
    /// Share of the relaxed moduli that an isotropic body has.
    pub isotropy_index: f64,
}

describe!(
    Tangent,
    "graintwin_msgs",
    include_str!("../../../msgs/graintwin_msgs/msg/Tangent.msg"),
    &[TangentModuli::TYPE, Header::TYPE],
    "a7980768343c201e59c182b5231e6c7d1db6f52aa8b3b699af5497404ceef03f"
);
describe!(
    TangentModuli,
    "graintwin_msgs",
    include_str!("../../../msgs/graintwin_msgs/msg/TangentModuli.msg"),
    &[],
    "f94c4510bfc99cdce9a6803e08eafd19c70bf11ebc1777f2c968b26d1d7a758b"
);
