//! What cement carries, and where it broke. Bodies are numbered as in
//! [`ContactNetwork`](super::ContactNetwork).

/// What became of a bond, as `graintwin_msgs/Bonds` numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum BondCondition {
    /// It holds.
    Intact = 0,
    /// It broke by the tensile stress.
    Tension = 1,
    /// It broke by the shear stress.
    Shear = 2,
}

/// Every pair of bodies that was cemented, sorted by (first, second).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bonds {
    /// Tensile stress at which whole cement breaks \[Pa\], infinite where none does.
    pub tensile_strength: f64,
    /// Shear stress at which whole cement breaks \[Pa\], infinite where none does.
    pub shear_strength: f64,
    /// Grain index in the order of the pack file.
    pub first: Vec<u32>,
    /// Grain index, or `u32::MAX - w` for wall w.
    pub second: Vec<u32>,
    /// [`BondCondition`] as a number.
    pub condition: Vec<u8>,
    /// Share of the cement that is left, 0 to 1.
    pub share: Vec<f64>,
    /// Radius of the cross-section at the deposition \[m\].
    pub radius: Vec<f64>,
    /// Centre of the contact \[m\], three numbers a bond.
    pub position: Vec<f64>,
    /// Unit normal from second to first, three numbers a bond.
    pub normal: Vec<f64>,
    /// Normal force of the cement \[N\], negative in tension; 0 where it broke, as all below.
    pub normal_force: Vec<f64>,
    /// Tangential force of the cement on first \[N\], three numbers a bond.
    pub tangential_force: Vec<f64>,
    /// Couple of the cement on first along the normal \[N m\].
    pub torsion: Vec<f64>,
    /// The larger of the stresses over their strengths: the bond breaks at 1.
    pub strength_use: Vec<f64>,
}

/// A bond that broke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crack {
    /// Grain index in the order of the pack file.
    pub first: u32,
    /// Grain index, or `u32::MAX - w` for wall w.
    pub second: u32,
    /// How it broke.
    pub mode: BondCondition,
    /// Equilibria of the increment before it.
    pub substep: u32,
    /// Centre of the contact where it broke \[m\].
    pub position: [f64; 3],
    /// Unit normal from second to first.
    pub normal: [f64; 3],
    /// Normal force of the cement \[N\], negative in tension.
    pub normal_force: f64,
    /// Magnitude of its tangential force \[N\].
    pub tangential_force: f64,
    /// Magnitude of its couple about the normal \[N m\].
    pub torsion: f64,
    /// The stress over the strength, at least 1.
    pub overload: f64,
    /// Confining stress of the contacts before it broke \[Pa\].
    pub stress_before: f64,
    /// The same at the equilibrium that followed \[Pa\].
    pub stress_after: f64,
    /// Energy that was lost with it \[J\].
    pub energy_released: f64,
}

/// The cracks of an increment, and how many bonds there are at its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cracks {
    /// Bonds that hold.
    pub intact: u32,
    /// Bonds that broke by the tensile stress so far.
    pub tension: u32,
    /// Bonds that broke by the shear stress so far.
    pub shear: u32,
    /// Those of the increment, in the order in which they broke.
    pub list: Vec<Crack>,
}

impl Cracks {
    /// Pairs that were cemented.
    #[must_use]
    pub fn bonds(&self) -> u32 {
        self.intact + self.tension + self.shear
    }
}
