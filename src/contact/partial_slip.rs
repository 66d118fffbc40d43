//! The law `mindlin_deresiewicz`: shear of a Hertz contact that slips from its rim inwards, under
//! any history of overlap and displacement (Mindlin and Deresiewicz 1953; T figure 3.2).
//!
//! # The law
//!
//! The contact is a stack of rigid punches, one for each overlap x from 0 to the present h
//! (Jäger 1998, Ciavarella 1998; the memory diagrams of Aleshin, Bou Matar and Van Den Abeele
//! 2015). The punch at x covers the circle that was in contact at overlap x. Moving it by dδ takes
//! the force η P'(x) dδ, where P = M x^1.5 is Hertz' force and η = k_s/k_n; friction limits dδ to
//! (μ/η) dx. With D(x), |D| <= 1, the punch's share of that limit,
//!
//! ```text
//! δ = -μ/η ∫ D dx        displacement of i relative to j
//! Q =  μ   ∫ D P' dx     force on i
//! U = μ/η  ∫ Q(x)·D dx   stored energy, Q(x) the force of the punches up to x
//! ```
//!
//! over x from 0 to h. A step to a new overlap with the displacement u first moves what came into
//! contact: if that is enough (η|u|/μ <= the rise of the overlap) nothing slips and the new ring
//! takes u in equal shares. Otherwise all punches outside some c slip and share one unit vector
//! D = e, the others keep their place. What c must be follows from δ, which the punches outside c
//! have to make up: |v(c)| = h - c, with v(c) = -(η/μ) u + the integral of the old D from c to the
//! old overlap, and e = v/|v|. |v| - (h - c) rises with c, so c is found ring by ring from outside;
//! within a ring D is constant and c solves a quadratic. Without such a c >= 0 all punches slip and
//! the contact slides: Q = μP.
//!
//! D is constant in each [`Layer`]. The law of one contact knows no turning of the contact plane:
//! the layers and displacements of a call lie in one plane. Its layers ascend in `reach`.
//!
//! # Where it differs from the stick-or-slide law
//!
//! At constant P a first shear gives Q = μP [1 - (1 - δ/B)^1.5] and slides from δ = B = μh/η on.
//! The stick-or-slide law with k_s = ηP' slides at 2/3 B. There it overshoots this law by most,
//! 3^-1.5 μP = 0.192 μP. Below gross slip it loses no energy, while here a full loop between ±qμP
//! loses 24/5 μP B {1 - (1-q)^(5/3) - (5q/6) [1 + (1-q)^(2/3)]}. Between equal spheres that factor
//! is (9/5) (2-ν) (μP)²/(Ga) when δ is the displacement of one sphere relative to the other.
//!
//! # Limits
//!
//! - A history in one line follows the theory exactly, whatever the size of the steps, unless the
//!   overlap falls so far in one that slip changes its sign on the way. In the plane it is a
//!   generalisation: traction and slip need not be parallel, and where the direction changes the
//!   result depends on the size of the step.
//! - More than [`MOST_LAYERS`] layers are not kept: the two neighbours whose union changes δ least
//!   become one ring with the same force. Rings swallowed by a larger one vanish, so random steps
//!   left 8 layers on the mean and never more than 35. A load that turns while the overlap grows
//!   adds one a step: after 1000 such steps and three turns the forces of later steps differed by
//!   less than 5e-4 μP from those of 1000 layers, and the stored energy by 3 %.
//! - From μ = 10⁶ on nothing slips, since η|u|/μ would drown in the rounding of h; `ratio` then
//!   holds displacement in another way. Below μ = 10⁻¹² there is no force at all.

mod bonded;
mod energy;
mod merge;
mod rings;
mod settle;

use crate::Vec3;
use crate::contact::hertz;
use crate::pack::Layer;
use rings::secant;
use settle::{Regime, settle};

pub use merge::MOST_LAYERS;

/// Coefficients of friction below this are none.
const FRICTIONLESS: f64 = 1e-12;
/// Coefficients of friction from here on never let a contact slip.
const BONDED: f64 = 1e6;

/// η = k_s/k_n of two bodies, from the sums over both of [`hertz::compliance`] and
/// [`crate::contact::mindlin::shear_compliance`].
#[must_use]
pub fn stiffness_ratio(compliance_sum: f64, shear_compliance_sum: f64) -> f64 {
    4.0 * compliance_sum / shear_compliance_sum
}

/// D of the ring at `overlap` \[m\] in `layers` that end at `before`: the inner one where two meet.
#[must_use]
pub(crate) fn ratio_at(layers: &[Layer], before: f64, overlap: f64) -> Vec3 {
    rings::of(layers, before)
        .find(|ring| overlap <= ring.outer)
        .map_or_else(Vec3::zeros, |ring| ring.ratio)
}

/// What does not change while two bodies touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Hertz' M \[N/m^1.5\], positive.
    pub modulus: f64,
    /// η of [`stiffness_ratio`], positive.
    pub ratio: f64,
    /// μ, 0 to infinite.
    pub friction: f64,
}

/// A step on which overlap and displacement change in proportion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Overlap before \[m\], where the layers end; 0 for a new contact.
    pub before: f64,
    /// Overlap after \[m\]; no contact at 0 and below.
    pub overlap: f64,
    /// Tangential displacement of body i relative to j during the step \[m\].
    pub displacement: Vec3,
}

impl Step {
    /// The part of the step before the contact opens.
    fn in_contact(self) -> Self {
        if self.overlap >= 0.0 {
            return self;
        }
        let share = self.before.max(0.0) / (self.before.max(0.0) - self.overlap);
        Self { overlap: 0.0, displacement: self.displacement * share, ..self }
    }
}

/// The shear of a contact at the end of a step, and how it would change with the displacement u.
///
/// -dQ/du is `across` (T - e eᵀ) + `along` e eᵀ with T the projection on the contact plane and e
/// the `direction`, plus a term left to the caller because it is not symmetric: where the D of the
/// ring at the core is oblique to e, (`across` - `along`)/(1 - e·D) (D - (e·D) e) eᵀ.
/// At a corner of Q(u), as where a load is about to turn, it is the stiffer side's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Q: tangential force on body i \[N\].
    pub shear: Vec3,
    /// Stiffness along `direction` \[N/m\], 0 in gross slip.
    pub along: f64,
    /// Stiffness across `direction` in the contact plane \[N/m\].
    pub across: f64,
    /// e: direction of the traction that the step put on the slipping rim; zero if nothing slips.
    pub direction: Vec3,
    /// Overlap at which the contact circle covers what did not slip in this step \[m\].
    pub core: f64,
    /// Whether the whole contact slides.
    pub sliding: bool,
}

impl Response {
    /// That of a contact without force.
    const NONE: Self = Self {
        shear: Vec3::new(0.0, 0.0, 0.0),
        along: 0.0,
        across: 0.0,
        direction: Vec3::new(0.0, 0.0, 0.0),
        core: 0.0,
        sliding: false,
    };
}

/// Which of the three forms of the law holds.
enum Form {
    Free,
    Slipping,
    Bonded,
}

impl Contact {
    /// The shear after `step` of a contact with these `layers`.
    #[must_use]
    pub fn respond(&self, layers: &[Layer], step: &Step) -> Response {
        match self.form(step.overlap) {
            Form::Free => Response::NONE,
            Form::Slipping => self.respond_slipping(layers, step),
            Form::Bonded => bonded::respond(self, layers, step),
        }
    }

    /// Makes `layers` those after `step`, at most [`MOST_LAYERS`].
    pub fn commit(&self, layers: &mut Vec<Layer>, step: &Step) {
        match self.form(step.overlap) {
            Form::Free => layers.clear(),
            Form::Slipping => {
                let settled = settle(self, layers, step);
                rings::cut(layers, settled.core);
                layers.push(Layer { reach: step.overlap, ratio: settled.ratio.into() });
                merge::unite(layers);
            }
            Form::Bonded => bonded::commit(self, layers, step),
        }
    }

    /// U \[J\] stored by the shear of a contact with these `layers` at `overlap`, the overlap of
    /// the last step.
    #[must_use]
    pub fn stored(&self, layers: &[Layer], overlap: f64) -> f64 {
        match self.form(overlap) {
            Form::Free => 0.0,
            Form::Slipping => energy::stored(self, rings::of(layers, overlap)),
            Form::Bonded => bonded::stored(self, layers),
        }
    }

    /// Energy \[J\] that `step` turns into heat, never negative: the work -∫Q·du less the change of
    /// [`stored`](Self::stored).
    ///
    /// At constant overlap in closed form, otherwise by quadrature over each ring: to 5e-4 of
    /// ½ k_s (μh/η)² even if the contact opens in one step. In the plane the slip is taken to have
    /// its last direction all along.
    #[must_use]
    pub fn dissipated(&self, layers: &[Layer], step: &Step) -> f64 {
        let step = step.in_contact();
        match self.form(step.before.max(step.overlap)) {
            Form::Free => 0.0,
            Form::Slipping => energy::dissipated(self, layers, &step),
            Form::Bonded => bonded::dissipated(self, layers, &step),
        }
    }

    /// A potential \[J\] of the displacement u at fixed overlaps: Q = -dΦ/du for a history in one
    /// line. In the plane Q has none, and this is a measure of progress only.
    ///
    /// Φ is the energy stored after the step and what slip at the overlap after it turns into heat.
    #[must_use]
    pub fn potential(&self, layers: &[Layer], step: &Step) -> f64 {
        match self.form(step.overlap) {
            Form::Free => 0.0,
            Form::Slipping => energy::potential(self, layers, step),
            Form::Bonded => bonded::potential(self, layers, step),
        }
    }

    fn form(&self, overlap: f64) -> Form {
        if overlap > 0.0 && self.friction >= FRICTIONLESS {
            if self.friction < BONDED { Form::Slipping } else { Form::Bonded }
        } else {
            Form::Free
        }
    }

    fn respond_slipping(&self, layers: &[Layer], step: &Step) -> Response {
        let settled = settle(self, layers, step);
        let (core, overlap) = (settled.core, step.overlap);
        let chord = secant(self.modulus, core, overlap);
        let below = rings::force(self, rings::within(layers, step.before, core));
        let shear = below + settled.ratio * (self.friction * (overlap - core) * chord);
        let (along, across, direction, sliding) = match settled.regime {
            Regime::Stuck => (self.ratio * chord, self.ratio * chord, Vec3::zeros(), false),
            Regime::Partial => (
                self.ratio * hertz::stiffness(self.modulus, core),
                self.ratio * chord,
                settled.ratio,
                false,
            ),
            Regime::Gross { distance } => {
                let across = self.ratio * hertz::force(self.modulus, overlap) / distance;
                (0.0, across, settled.ratio, true)
            }
        };
        Response { shear, along, across, direction, core, sliding }
    }
}
