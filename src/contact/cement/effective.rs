//! One effective stiffness for grains and cement, and how it evolves (T 4.4).
//!
//! The normal stiffness is k_n* = 2 E* a* (4.3), where the effective contact radius a* follows the
//! distance r of the centres, or of a centre from a wall. The increments (4.1) then add up to a
//! force of r alone, free of stress at the distance r⁽ᶜ⁾ of the deposition (T 4.5): with the
//! approach u = r⁽ᶜ⁾ - r
//!
//! ```text
//! P = ∫ 2 E* a* du,  U = ∫ P du
//! ```

use super::super::hertz;

/// Argument below which powers cancel and the energy is taken by quadrature, and its nodes on
/// (0, 1) with their weights (Gauss and Legendre).
const SMALL: f64 = 1e-2;
const NODES: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// How the effective contact radius a* follows the deformation of the contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Evolution {
    /// Not at all: a* = a*⁽ᶜ⁾.
    Fixed,
    /// That of the grains follows Hertz, that of the cement is constant (4.10).
    LinearElastic,
    /// a* = a*⁽ᶜ⁾ exp(γ ε), ε = u/r⁽ᶜ⁾ (4.11-4.12).
    Exponential {
        /// γ, at least 0.
        gamma: f64,
    },
    /// a* = a*⁽ᶜ⁾ (1 + η ε)^ω (4.13); 0 beyond the tensile strain 1/η.
    Power {
        /// η, at least 0.
        eta: f64,
        /// ω, at least 0.
        omega: f64,
    },
}

/// A cemented contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effective {
    /// How a* evolves.
    pub evolution: Evolution,
    /// E* \[Pa\] (T 2.3b).
    pub modulus: f64,
    /// R* \[m\] (T 2.3a).
    pub effective_radius: f64,
    /// r⁽ᶜ⁾ \[m\].
    pub distance: f64,
    /// h⁽ᶜ⁾ \[m\], negative where the cement bridges a gap.
    pub overlap: f64,
    /// a*⁽ᶜ⁾ \[m\]; with [`Evolution::LinearElastic`] the part of the cement, a^CEM.
    pub radius: f64,
    /// Share of the stiffness that is left, 0 to 1: cement can dissolve. With
    /// [`Evolution::LinearElastic`] it is the share of the cement's part.
    pub share: f64,
}

/// Answer of a cemented contact to a distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Normal {
    /// P \[N\], negative in tension.
    pub force: f64,
    /// -dP/dr \[N/m\].
    pub stiffness: f64,
    /// U \[J\] since the deposition.
    pub energy: f64,
}

impl Effective {
    /// a* \[m\] at the distance `distance` \[m\] (4.4, 4.10, 4.12, 4.13).
    #[must_use]
    pub fn contact_radius(&self, distance: f64) -> f64 {
        let approach = self.distance - distance;
        let strain = approach / self.distance; // (4.11)
        match self.evolution {
            Evolution::Fixed => self.share * self.radius,
            Evolution::LinearElastic => {
                let overlap = (self.overlap + approach).max(0.0);
                (self.effective_radius * overlap).sqrt() + self.share * self.radius
            }
            Evolution::Exponential { gamma } => self.share * self.radius * (gamma * strain).exp(),
            Evolution::Power { eta, omega } => {
                self.share * self.radius * (1.0 + eta * strain).max(0.0).powf(omega)
            }
        }
    }

    /// Force, stiffness and energy at the distance `distance` \[m\].
    #[must_use]
    pub fn answer(&self, distance: f64) -> Normal {
        let approach = self.distance - distance;
        let stiffness = 2.0 * self.modulus * self.contact_radius(distance); // (4.3)
        // At the deposition.
        let first = 2.0 * self.modulus * self.share * self.radius;
        let linear = |share_of_force: f64, share_of_energy: f64| Normal {
            force: first * approach * share_of_force,
            stiffness,
            energy: first * approach * approach * share_of_energy,
        };
        match self.evolution {
            Evolution::Fixed => linear(1.0, 0.5),
            Evolution::LinearElastic => {
                let grains = self.beyond_deposition(approach);
                let cement = linear(1.0, 0.5);
                Normal {
                    force: cement.force + grains.0,
                    stiffness,
                    energy: cement.energy + grains.1,
                }
            }
            Evolution::Exponential { gamma } => {
                let x = gamma * approach / self.distance;
                match x == 0.0 {
                    true => linear(1.0, 0.5),
                    false => linear(
                        x.exp_m1() / x,
                        second_integral(x, f64::exp, |x| (x.exp_m1() - x) / (x * x)),
                    ),
                }
            }
            Evolution::Power { eta, omega } => {
                let x = eta * approach / self.distance;
                let by = omega + 1.0;
                let once = |x: f64| (by * x.ln_1p()).exp_m1() / (by * x);
                let twice = |x: f64| {
                    let whole = ((by + 1.0) * x.ln_1p()).exp_m1() / (by + 1.0);
                    (whole - x) / (by * x * x)
                };
                match x {
                    0.0 => linear(1.0, 0.5),
                    // Nothing is added beyond the strain where a* vanishes.
                    _ if x < -1.0 => {
                        let (least, beyond) = (1.0 / by, x + 1.0);
                        linear(-least / x, (twice(-1.0) - least * beyond) / (x * x))
                    }
                    _ => linear(once(x), second_integral(x, |s| (1.0 + s).powf(omega), twice)),
                }
            }
        }
    }

    /// Hertz' force beyond that at the deposition \[N\], and its integral over `approach` \[J\].
    fn beyond_deposition(&self, approach: f64) -> (f64, f64) {
        let modulus = hertz::modulus(self.effective_radius, 1.0 / self.modulus);
        let (before, now) = (self.overlap, self.overlap + approach);
        if before <= 0.0 || now <= 0.0 {
            let [carried, force] = [before, now].map(|h| hertz::force(modulus, h.max(0.0)));
            let energy = hertz::energy(force, now) - hertz::energy(carried, before);
            return (force - carried, energy - carried * approach);
        }
        // Without the difference of two nearly equal forces.
        let [a, b] = [before, now].map(|h| h * h.sqrt());
        let cubes = approach * (before * before + before * now + now * now);
        let x = approach / before;
        let closed = |x: f64| {
            let now = 1.0 + x;
            (0.4 * (now * now * now.sqrt() - 1.0) - x) / (1.5 * x * x)
        };
        let share = second_integral(x, |s| (1.0 + s).sqrt(), closed);
        let stiffness = hertz::stiffness(modulus, before);
        (modulus * cubes / (a + b), stiffness * approach * approach * share)
    }
}

/// ∫₀¹ (1-t) a(x t) dt, the energy over that of a linear contact; `closed` is its closed form, which
/// cancels for small x.
fn second_integral(x: f64, a: impl Fn(f64) -> f64, closed: impl Fn(f64) -> f64) -> f64 {
    match x.abs() < SMALL {
        true => NODES.iter().map(|(t, weight)| weight * (1.0 - t) * a(x * t)).sum(),
        false => closed(x),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(evolution: Evolution) -> Effective {
        Effective {
            evolution,
            modulus: 3.6e10,
            effective_radius: 5e-5,
            distance: 1.99e-4,
            overlap: 1e-6,
            radius: 7e-6,
            share: 1.0,
        }
    }

    const LAWS: [Evolution; 6] = [
        Evolution::Fixed,
        Evolution::LinearElastic,
        Evolution::Exponential { gamma: 3000.0 },
        Evolution::Exponential { gamma: 0.0 },
        Evolution::Power { eta: 1111.0, omega: 1.0 },
        Evolution::Power { eta: 1428.0, omega: 2.3 },
    ];

    /// The fifth-order rule for ∫ f over [a, b] in many panels: independent of the closed forms.
    fn integral(f: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
        let panels = 4000;
        let h = (b - a) / f64::from(panels);
        (0..panels)
            .map(|k| {
                let x = a + h * f64::from(k);
                h / 90.0
                    * (7.0 * f(x)
                        + 32.0 * f(x + 0.25 * h)
                        + 12.0 * f(x + 0.5 * h)
                        + 32.0 * f(x + 0.75 * h)
                        + 7.0 * f(x + h))
            })
            .sum()
    }

    #[test]
    fn force_and_energy_are_the_integrals_of_the_radius() {
        for law in LAWS {
            let contact = contact(law);
            for strain in [-1.5e-3, -8e-4, -1e-4, -3e-7, 1e-9, 2e-6, 1e-3, 2e-3] {
                let approach = strain * contact.distance;
                let at = |u: f64| contact.distance - u;
                let force = integral(
                    |u| 2.0 * contact.modulus * contact.contact_radius(at(u)),
                    0.0,
                    approach,
                );
                let energy = integral(|u| contact.answer(at(u)).force, 0.0, approach);
                let answer = contact.answer(at(approach));
                // The panels meet the kinks of a* (contact lost, cement gone) only by chance.
                let kink = strain < -9e-4 || matches!(law, Evolution::LinearElastic);
                let close = if kink { 1e-6 } else { 1e-9 };
                // The distance, of which the approach is a difference, is rounded.
                let rounding = 1e-16 / strain.abs();
                let relative = |a: f64, b: f64| (a - b).abs() / b.abs();
                assert!(relative(answer.force, force) < close + rounding, "{law:?} {strain}");
                assert!(
                    relative(answer.energy, energy) < close + 4.0 * rounding,
                    "{law:?} {strain}"
                );
            }
        }
    }

    #[test]
    fn without_cement_the_linear_elastic_law_is_hertz() {
        let touching = Effective { overlap: 0.0, radius: 0.0, ..contact(Evolution::LinearElastic) };
        for overlap in [1e-9, 1e-7, 2e-6] {
            let answer = touching.answer(touching.distance - overlap);
            // T (2.2): P = 4/3 E* √R* h^1.5.
            let hertz = 4.0 / 3.0 * 3.6e10 * (5e-5_f64 * overlap.powi(3)).sqrt();
            assert!((answer.force / hertz - 1.0).abs() < 1e-6, "{overlap}");
            assert!((answer.energy / (0.4 * hertz * overlap) - 1.0).abs() < 1e-6);
        }
        assert_eq!(touching.answer(touching.distance + 1e-7), Normal::default());
    }

    #[test]
    fn laws_meet_where_their_parameters_make_them_the_same() {
        let fixed = contact(Evolution::Fixed);
        for law in [
            Evolution::Exponential { gamma: 0.0 },
            Evolution::Power { eta: 0.0, omega: 2.0 },
            Evolution::Power { eta: 1000.0, omega: 0.0 },
        ] {
            let r = 0.999 * fixed.distance;
            let (a, b) = (fixed.answer(r), contact(law).answer(r));
            assert!((a.force / b.force - 1.0).abs() < 1e-13, "{law:?}");
            assert!((a.energy / b.energy - 1.0).abs() < 1e-13, "{law:?}");
        }
        // (1 + γε/n)^n -> exp(γε).
        let n = 1e7;
        let power = contact(Evolution::Power { eta: 1000.0 / n, omega: n });
        let exponential = contact(Evolution::Exponential { gamma: 1000.0 });
        let r = 0.9985 * fixed.distance;
        assert!((power.answer(r).force / exponential.answer(r).force - 1.0).abs() < 1e-6);
    }

    #[test]
    fn cement_whose_radius_has_vanished_pulls_with_a_constant_force() {
        let contact = contact(Evolution::Power { eta: 1000.0, omega: 1.5 });
        let [a, b] = [2e-3, 3e-3].map(|strain| contact.answer(contact.distance * (1.0 + strain)));
        assert!(a.force < 0.0 && a.force == b.force && a.stiffness == 0.0);
        let work = -a.force * 1e-3 * contact.distance;
        assert!(((b.energy - a.energy) / work - 1.0).abs() < 1e-9);
    }
}
