//! The law of one bond, from the constants of its bodies and of the cement.

use crate::Vec3;
use crate::contact::cement::effective::{Effective, Evolution, Normal};
use crate::contact::cement::parallel::Cylinder;
use crate::contact::{Other, hertz};
use crate::model::Model;
use crate::scene::{Cement, CementLaw, Solution};
use crate::state::{Bond, State};
use crate::wall::Room;

/// How the cement of a bond answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BondLaw {
    /// One stiffness for grains and cement (T 4.4).
    Effective(Effective),
    /// A cylinder beside the contact of the grains (T 4.7).
    Parallel(Cylinder),
}

impl BondLaw {
    /// Answer of the cement to a distance \[m\] of the bodies.
    #[must_use]
    pub fn answer(&self, distance: f64) -> Normal {
        match self {
            Self::Effective(law) => law.answer(distance),
            Self::Parallel(cylinder) => cylinder.answer(distance),
        }
    }
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
            Other::Wall(w) => {
                let radius = self.wall_radius(i, usize::from(w));
                (radius, self.compliance[i] + self.wall_compliance)
            }
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
                let size = [bond.radius, law.length_ratio * effective_radius];
                let moduli = [law.young, law.shear];
                return BondLaw::Parallel(Cylinder::new(size, moduli, bond.distance, bond.share));
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

impl Model {
    /// Whether grains press on each other besides the cement that holds them together.
    #[must_use]
    pub fn presses_beside_cement(&self) -> bool {
        self.cement.is_some_and(|cement| matches!(cement.law, CementLaw::Parallel(_)))
    }

    /// Takes away what has dissolved of the cement of `state` since `lost` of the saturation was lost:
    /// it is that much softer and weaker, and carries that much less at the same deformation
    /// (T 6.2). The balance is to be found anew.
    pub fn weaken(&self, state: &mut State, lost: f64) {
        let Some(cement) = self.cement.filter(|cement| cement.saturation > 0.0) else { return };
        let ratio = self.hydrate.left(state.dissociated.lost) / self.hydrate.left(lost);
        let bounds = state.bounds(self);
        let mut memory = state.memory.contacts.iter_mut().peekable();
        for bond in state.bonds.iter_mut().filter(|bond| bond.holds()) {
            let before = self.law_of(&cement, bond);
            bond.share *= ratio;
            // In shear and torsion grains and cement are one: what they carry falls as their radius.
            let carried = match (before, self.law_of(&cement, bond)) {
                (BondLaw::Effective(before), BondLaw::Effective(after)) => {
                    let distance = bond.branch(&state.position, &bounds).norm();
                    let [before, after] = [before, after].map(|law| law.contact_radius(distance));
                    if before > 0.0 { after / before } else { ratio }
                }
                _ => ratio,
            };
            bond.work *= carried;
            bond.normal_force = bond.normal_force.map(|force| force * carried);
            while memory.next_if(|contact| contact.key() < bond.key()).is_some() {}
            if let Some(contact) = memory.next_if(|contact| contact.key() == bond.key()) {
                contact.shear *= carried;
                contact.torsion *= carried;
            }
        }
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
    pub fn branch(&self, position: &[Vec3], bounds: &Room) -> Vec3 {
        let at = position[self.first as usize];
        match self.second {
            Other::Grain(j) => at - position[j as usize],
            Other::Wall(w) => {
                let facing = bounds.facing(&at, usize::from(w));
                facing.normal * facing.gap
            }
        }
    }

    /// Force of its cement on grain i along the normal at an equilibrium \[N\], negative in tension:
    /// the one that it remembers, or that by the law `law`.
    #[must_use]
    pub fn force(&self, law: &BondLaw, position: &[Vec3], bounds: &Room) -> f64 {
        self.normal_force.unwrap_or_else(|| self.force_by_law(law, position, bounds))
    }

    /// The normal force that it goes on from \[N\]; `None` where the law gives it.
    #[must_use]
    pub fn recalled(&self, model: &Model, position: &[Vec3], bounds: &Room) -> Option<f64> {
        let cement = model.cement.as_ref().filter(|_| model.is_two_step())?;
        Some(self.force(&model.law_of(cement, self), position, bounds))
    }

    /// Force of its cement on grain i along the normal by the law `law` \[N\].
    #[must_use]
    pub fn force_by_law(&self, law: &BondLaw, position: &[Vec3], bounds: &Room) -> f64 {
        law.answer(self.branch(position, bounds).norm()).force
    }
}
