//! Moduli of the current state rather than of an interval.

use serde::Serialize;

use crate::wall;

/// Tangent moduli of an equilibrium, with sliding contacts as they stand and with all sticking.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Tangent {
    /// Bulk density that the wave speeds are of \[kg/m³\].
    pub density: f64,
    /// Products of the linear system that solving for the balance took.
    pub products: u64,
    /// With contacts that slide as they stand: the next strain of this kind.
    pub stands: TangentModuli,
    /// With contacts that all stick: what a sound wave sees. The same without friction.
    pub sticks: TangentModuli,
}

/// Tangent moduli with the contacts in one of two states; NaN where they are not known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TangentModuli {
    /// Whether they are known: not where the state is no minimum, or the balance was not solved for.
    pub valid: bool,
    /// Estimate of the relative error that solving for the balance leaves, of the largest entry.
    pub error: f64,
    /// dσ_l/dε_m over xx, yy, zz, row major \[Pa\], the grains in balance; of discs over xx, yy and the shear
    /// γ = 2 εxy of the box. What is along z is NaN for discs in all that follows, the stiffness of walls 0.
    pub relaxed: [f64; 9],
    /// The same with the grains moving affinely with the walls, without turning \[Pa\].
    pub affine: [f64; 9],
    /// Change of the normal force on wall v with the inward motion of wall w \[N/m\].
    pub wall_stiffness: [[f64; wall::COUNT]; wall::COUNT],
    /// Bulk modulus K \[Pa\].
    pub bulk: f64,
    /// Shear modulus G \[Pa\].
    pub shear: f64,
    /// Young's modulus E \[Pa\].
    pub young: f64,
    /// Poisson's ratio ν \[1\].
    pub poisson: f64,
    /// Lamé's first parameter λ \[Pa\].
    pub lame: f64,
    /// P-wave modulus K + 4/3 G \[Pa\].
    pub p_wave: f64,
    /// Shear modulus by the pairs of directions xy, yz, zx \[Pa\].
    pub shear_pairs: [f64; 3],
    /// Compressional wave speed along x, y, z \[m/s\].
    pub p_speed: [f64; 3],
    /// Shear wave speed by the pairs of directions xy, yz, zx \[m/s\].
    pub s_speed: [f64; 3],
    /// Share of the relaxed moduli that an isotropic body has: 1 where the pack is one.
    pub isotropy_index: f64,
}
