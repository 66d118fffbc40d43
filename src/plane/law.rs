//! Force laws of one contact: energy, force and stiffness of the overlap, and of the shear displacement.

use super::setup::Law;
use crate::contact::hertz;

/// Energy \[J\], its derivative \[N\] and the derivative of that \[N/m\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Answer {
    /// Potential \[J\].
    pub energy: f64,
    /// Force \[N\].
    pub force: f64,
    /// Stiffness \[N/m\].
    pub stiffness: f64,
}

/// Normal contact at the overlap `overlap` \[m\]: Hertz (1) of modulus `modulus` \[N/m^1.5\], or (8).
/// `bonded` ones pull where the overlap is negative.
#[must_use]
#[inline]
pub fn normal(law: Law, modulus: f64, overlap: f64, bonded: bool) -> Answer {
    match law {
        _ if overlap <= 0.0 && !bonded => Answer::default(),
        Law::Hertz => {
            let force = hertz::force(modulus, overlap);
            let energy = hertz::energy(force, overlap);
            Answer { energy, force, stiffness: hertz::stiffness(modulus, overlap) }
        }
        Law::Linear { normal, .. } => {
            let force = normal * overlap;
            Answer { energy: 0.5 * force * overlap, force, stiffness: normal }
        }
    }
}

/// Shear since the reference: elastic up to a limit that is that of the reference, so that the force
/// has a potential (7, 11).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shear {
    /// F_s at the reference \[N\].
    pub carried: f64,
    /// k_s \[N/m\].
    pub stiffness: f64,
    /// Largest |F_s| \[N\], infinite where a bond holds.
    pub limit: f64,
}

impl Shear {
    /// F_s at the shear displacement `slid` \[m\] since the reference, and whether the contact slides.
    #[must_use]
    #[inline]
    pub fn answer(&self, slid: f64) -> (Answer, bool) {
        let Self { carried, stiffness, limit } = *self;
        let elastic = carried + stiffness * slid;
        if elastic.abs() <= limit || stiffness == 0.0 {
            let energy = (carried + 0.5 * stiffness * slid) * slid;
            return (Answer { energy, force: elastic, stiffness }, false);
        }
        let force = limit.copysign(elastic);
        // Where it began to slide.
        let at = (force - carried) / stiffness;
        let energy = (carried + 0.5 * stiffness * at) * at + force * (slid - at);
        (Answer { energy, force, stiffness: 0.0 }, true)
    }

    /// F_s where the contact goes on as before: it slides on at the force it has, or sticks whatever the
    /// limit; and whether it slides.
    #[must_use]
    #[inline]
    pub fn as_before(&self, slid: f64, slides: bool) -> (Answer, bool) {
        let stiffness = if slides { 0.0 } else { self.stiffness };
        let force = self.carried + stiffness * slid;
        let energy = 0.5 * (self.carried + force) * slid;
        (Answer { energy, force, stiffness }, slides)
    }

    /// Energy that slip takes on the way to `slid` \[J\].
    #[must_use]
    pub fn lost(&self, slid: f64) -> f64 {
        match self.answer(slid) {
            (answer, true) => {
                let stored = |force: f64| 0.5 * force * force / self.stiffness;
                answer.energy - (stored(answer.force) - stored(self.carried))
            }
            (_, false) => 0.0,
        }
    }

    /// Energy that the shear `force` \[N\] stores \[J\].
    #[must_use]
    pub fn stored(&self, force: f64) -> f64 {
        if self.stiffness > 0.0 { 0.5 * force * force / self.stiffness } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const LINEAR: Law = Law::Linear { normal: 1e6, shear: 1.3e6 };

    /// Central differences of the energy and the force.
    fn agrees(of: impl Fn(f64) -> Answer, at: f64, step: f64, scale: f64) {
        let (low, high) = (of(at - step), of(at + step));
        let here = of(at);
        let force = (high.energy - low.energy) / (2.0 * step);
        assert!((force - here.force).abs() < 1e-6 * scale, "{force} {}", here.force);
        let stiffness = (high.force - low.force) / (2.0 * step);
        assert!((stiffness - here.stiffness).abs() < 1e-5 * scale / at.abs().max(step));
    }

    #[test]
    fn normal_force_and_stiffness_are_derivatives() {
        for overlap in [1e-8, 3e-7, 2e-6] {
            let scale = normal(Law::Hertz, 1e8, overlap, false).force;
            agrees(|h| normal(Law::Hertz, 1e8, h, false), overlap, 1e-4 * overlap, scale);
            for (h, bonded) in [(overlap, false), (-overlap, true)] {
                agrees(|h| normal(LINEAR, 0.0, h, bonded), h, 1e-4 * overlap, 1e6 * overlap);
            }
        }
        assert_eq!(normal(LINEAR, 0.0, -1e-7, false), Answer::default());
    }

    proptest! {
        #[test]
        fn shear_force_is_the_derivative_of_its_energy(
            carried in -1.0..1.0f64,
            slid in -3.0..3.0f64,
            limit in 0.1..2.0f64,
        ) {
            let shear = Shear { carried, stiffness: 1.7, limit };
            let step = 1e-5;
            let [low, here, high] = [-step, 0.0, step].map(|d| shear.answer(slid + d).0);
            // Across the corner of the force differences of the energy are exact to the step.
            prop_assert!(((high.energy - low.energy) / (2.0 * step) - here.force).abs() < 2e-5);
            prop_assert!(here.force.abs() <= limit.max(carried.abs()));
            prop_assert!(shear.lost(slid) >= -1e-12);
        }
    }
}
