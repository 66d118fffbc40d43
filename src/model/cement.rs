//! The law of one bond, from the constants of its bodies and of the cement.

use crate::Vec3;
use crate::contact::cement::effective::{Effective, Evolution};
use crate::contact::cement::parallel::Cylinder;
use crate::contact::neighbours::wall_gap;
use crate::contact::{Other, hertz};
use crate::model::Model;
use crate::scene::{Cement, CementLaw, Solution};
use crate::state::Bond;
use crate::wall::{self, Bounds};

/// How the cement of a bond answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BondLaw {
    /// One stiffness for grains and cement (T 4.4).
    Effective(Effective),
    /// A cylinder beside the contact of the grains (T 4.7).
    Parallel(Cylinder),
}

impl Model {
    /// Whether increments are solved in two linear steps (T A.2.2).
    #[must_use]
    pub fn is_two_step(&self) -> bool {
        self.cement.is_some_and(|cement| cement.solution == Solution::TwoStep)
    }

    /// R* \[m\] and 1/E* \[1/Pa\] of a pair of bodies (T 2.3).
    #[must_use]
    pub fn pair(&self, first: u32, second: Other) -> (f64, f64) {
        let i = first as usize;
        match second {
            Other::Grain(j) => {
                let j = j as usize;
                let radius = hertz::effective_radius(self.radius[i], self.radius[j]);
                (radius, self.compliance[i] + self.compliance[j])
            }
            Other::Wall(_) => (self.radius[i], self.compliance[i] + self.wall_compliance),
        }
    }

    /// How `bond`, made of `cement`, answers.
    #[must_use]
    pub fn law_of(&self, cement: &Cement, bond: &Bond) -> BondLaw {
        let (effective_radius, compliance) = self.pair(bond.first, bond.second);
        let evolution = match cement.law {
            CementLaw::Fixed => Evolution::Fixed,
            CementLaw::LinearElastic => Evolution::LinearElastic,
            CementLaw::Exponential(law) => Evolution::Exponential { gamma: law.gamma },
            CementLaw::Power(law) => Evolution::Power { eta: law.eta, omega: law.omega },
            CementLaw::Parallel(law) => {
                let length = law.length_ratio * effective_radius;
                let cylinder = Cylinder::new(bond.radius, length, law.young, law.shear);
                return BondLaw::Parallel(cylinder.times(bond.share));
            }
        };
        // a^CEM = κ a⁽ᶜ⁾ of a*⁽ᶜ⁾ = (1 + κ) a⁽ᶜ⁾ (4.4).
        let part = match evolution {
            Evolution::LinearElastic => cement.kappa / (1.0 + cement.kappa),
            _ => 1.0,
        };
        BondLaw::Effective(Effective {
            evolution,
            modulus: 1.0 / compliance,
            effective_radius,
            distance: bond.distance,
            overlap: bond.overlap,
            radius: part * bond.radius,
            share: bond.share,
        })
    }
}

impl Bond {
    /// Mutual approach at which the bodies begin to press on each other besides the cement \[m\].
    /// An effective law stands for both, so that never; where its cement is gone they are free of
    /// stress as they were at the deposition (T 4.5).
    #[must_use]
    pub fn unstressed(&self, cement: &Cement) -> f64 {
        match cement.law {
            CementLaw::Parallel(_) => 0.0,
            _ if self.holds() => f64::INFINITY,
            _ => self.overlap.max(0.0),
        }
    }

    /// Way from the other body to the centre of grain i \[m\]: from the other centre, or from the
    /// wall along its normal.
    #[must_use]
    pub fn branch(&self, position: &[Vec3], bounds: &Bounds) -> Vec3 {
        let at = position[self.first as usize];
        match self.second {
            Other::Grain(j) => at - position[j as usize],
            Other::Wall(w) => {
                let w = usize::from(w);
                let mut branch = Vec3::zeros();
                branch[wall::axis(w)] = wall::inward(w) * wall_gap(&at, w, bounds);
                branch
            }
        }
    }

    /// Way from the second cementing point to the first \[m\]: the deformation of a parallel bond.
    #[must_use]
    pub fn stretch(&self, position: &[Vec3], bounds: &Bounds) -> Vec3 {
        let one = position[self.first as usize] + self.arm[0];
        one - match self.second {
            Other::Grain(j) => position[j as usize] + self.arm[1],
            Other::Wall(w) => wall_point(&self.arm[1], w, bounds),
        }
    }

    /// Force of its cement on grain i along `normal` at an equilibrium \[N\], negative in tension: the
    /// one that it remembers, or that by the law `law`.
    #[must_use]
    pub fn force(&self, law: &BondLaw, normal: &Vec3, position: &[Vec3], bounds: &Bounds) -> f64 {
        match self.normal_force {
            Some(force) => force,
            None => self.force_by_law(law, normal, position, bounds),
        }
    }

    /// The normal force that it goes on from \[N\]; `None` where the law gives it.
    #[must_use]
    pub fn recalled(&self, model: &Model, position: &[Vec3], bounds: &Bounds) -> Option<f64> {
        let cement = model.cement.as_ref().filter(|_| model.is_two_step())?;
        let normal = self.branch(position, bounds).normalize();
        Some(self.force(&model.law_of(cement, self), &normal, position, bounds))
    }

    /// Force of its cement on grain i along `normal` by the law `law` \[N\].
    #[must_use]
    pub fn force_by_law(
        &self,
        law: &BondLaw,
        normal: &Vec3,
        position: &[Vec3],
        bounds: &Bounds,
    ) -> f64 {
        match law {
            BondLaw::Effective(law) => law.answer(self.branch(position, bounds).norm()).force,
            // (4.20)
            BondLaw::Parallel(cylinder) => {
                -cylinder.stiffness * self.stretch(position, bounds).dot(normal)
            }
        }
    }
}

/// Where the cementing point `arm` of wall `w` is: it counts along the normal from the wall.
#[must_use]
pub fn wall_point(arm: &Vec3, w: u8, bounds: &Bounds) -> Vec3 {
    let w = usize::from(w);
    let mut at = *arm;
    at[wall::axis(w)] += bounds.position(w);
    at
}
