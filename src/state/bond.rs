//! What cement between two bodies remembers.

use crate::contact::Other;
use crate::contact::cement::strength::Mode;

/// A pair of bodies that was close when the cement was deposited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bond {
    /// Grain i.
    pub first: u32,
    /// The other body.
    pub second: Other,
    /// r⁽ᶜ⁾: distance of the centres, or of the centre from the wall, at the deposition \[m\].
    pub distance: f64,
    /// h⁽ᶜ⁾: mutual approach at the deposition \[m\], negative across a gap.
    pub overlap: f64,
    /// Radius of the cross-section at the deposition \[m\]: a*⁽ᶜ⁾ of the effective laws (T 4.4), R̄
    /// of the parallel bond (T 4.7.1).
    pub radius: f64,
    /// Share of the cement that is left, 0 to 1.
    pub share: f64,
    /// Work against the tangential force and the couple since the deposition (T 4.17b, c) \[J\]. With
    /// [`normal_force`](Self::normal_force) that against the normal force too (T 4.17a).
    pub work: f64,
    /// Normal force on both bodies that the linear increments (4.1) add up to \[N\], negative in
    /// tension; `None` where the law gives it for the distance.
    pub normal_force: Option<f64>,
    /// What became of it.
    pub condition: Condition,
}

/// What became of a bond.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// It holds.
    Intact,
    /// There never was any cement: a wall that grains are not cemented to.
    Bare,
    /// It broke.
    Broken(Mode),
}

impl Bond {
    /// What lists of bonds are sorted by.
    #[must_use]
    pub fn key(&self) -> (u32, Other) {
        (self.first, self.second)
    }

    /// Whether the cement holds.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.condition == Condition::Intact
    }

    pub(super) fn put(&self, take: &mut dyn FnMut(&[u8])) {
        let Self { first, second, distance, overlap, radius, share, work, condition, .. } = self;
        let normal_force = self.normal_force;
        super::put_bodies(*first, *second, take);
        super::numbers(&[*distance, *overlap, *radius, *share, *work], take);
        if let Some(force) = normal_force {
            super::numbers(&[force], take);
        }
        take(&[match condition {
            Condition::Intact => 0,
            Condition::Bare => 1,
            Condition::Broken(Mode::Tension) => 2,
            Condition::Broken(Mode::Shear) => 3,
        }]);
    }
}
