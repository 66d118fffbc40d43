//! Stick or slide: elastic shear and torsion up to a Coulomb limit (T 3.3.2-3.3.3).
//!
//! Within an increment the stiffness k and the limit Q_max are frozen at the reference
//! configuration. There a contact carried the force Q⁰ᵖ, turned into the current plane; u is the
//! displacement of grain i against the other body since then. All vectors lie in the contact
//! plane, forces act on grain i.
//!
//! Against the full law of Mindlin and Deresiewicz these laws know no partial slip: below gross
//! sliding they lose no energy and are too stiff.

use crate::Vec3;

/// Answer of a contact to a tangential displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shear {
    /// Q \[N\].
    pub force: Vec3,
    /// Stored energy beyond the slip, and what slip took, since the reference \[J\].
    ///
    /// For the return map it is the potential of the force: Q = -d(potential)/du.
    pub potential: f64,
    /// Part of `potential` that slip took \[J\].
    pub dissipated: f64,
    /// -dQ/du across `direction` \[N/m\].
    pub across: f64,
    /// -dQ/du along `direction` \[N/m\].
    pub along: f64,
    /// Unit vector, or zero where `across` and `along` are the same.
    pub direction: Vec3,
    /// Whether the contact slides.
    pub slides: bool,
}

impl Shear {
    fn stick(force: Vec3, stiffness: f64) -> Self {
        let potential = 0.5 * force.norm_squared() / stiffness;
        Self { force, potential, across: stiffness, along: stiffness, ..Self::default() }
    }
}

/// Radial return to the Coulomb disc: Q = Q* = Q⁰ᵖ - k u inside, Q_max Q*/|Q*| outside.
/// Its potential is quadratic inside and linear outside, convex and C¹.
///
/// `limit` is Q_max, 0 to infinite.
#[must_use]
#[inline]
pub fn return_map(carried: &Vec3, u: &Vec3, stiffness: f64, limit: f64) -> Shear {
    let trial = carried - u * stiffness;
    let size2 = trial.norm_squared();
    // Without branches: many contacts are answered for at a time.
    let slides = size2 > limit * limit;
    let size = size2.sqrt();
    let share = if slides { limit / size } else { 1.0 };
    let dissipated = if slides { limit * (size - limit) / stiffness } else { 0.0 };
    let elastic = if slides { limit * limit } else { size2 };
    Shear {
        force: trial * share,
        potential: dissipated + 0.5 * elastic / stiffness,
        dissipated,
        across: stiffness * share,
        along: if slides { 0.0 } else { stiffness },
        direction: trial * if slides { 1.0 / size } else { 0.0 },
        slides,
    }
}

/// The rule of the thesis: a secant stiffness that brings the force to the limit (T 3.4-3.5).
///
/// A carried force beyond the limit is shortened to it first: the bracket of (3.5b) would reverse
/// it. `potential` is that of the force where the contact sticks, and the stored energy with the
/// work on the secant where it slides; it is not the integral of the force there.
#[must_use]
#[inline]
pub fn secant(carried: &Vec3, u: &Vec3, stiffness: f64, limit: f64) -> Shear {
    let size2 = carried.norm_squared();
    let (carried, cut) = match size2 > limit * limit {
        true => {
            let size = size2.sqrt();
            (carried * (limit / size), limit * (size - limit) / stiffness)
        }
        false => (*carried, 0.0),
    };
    let trial = carried - u * stiffness;
    if trial.norm_squared() <= limit * limit {
        let stick = Shear::stick(trial, stiffness);
        return Shear { potential: stick.potential + cut, dissipated: cut, ..stick };
    }
    // |Q⁰ᵖ - k'u| = Q_max; the root is real because the carried force is within the limit.
    let (u2, along_u) = (u.norm_squared(), carried.dot(u));
    let rest = (limit * limit - carried.norm_squared()).max(0.0);
    let root = (along_u * along_u + rest * u2).sqrt();
    // The two terms cancel where the force was at the limit and grows.
    let secant = match along_u > 0.0 {
        true => (along_u + root) / u2,
        false => rest / (root - along_u).max(f64::MIN_POSITIVE),
    };
    let force = carried - u * secant;
    let work = 0.5 * (carried + force).dot(u);
    let stored = 0.5 * force.norm_squared() / stiffness;
    let dissipated = cut + 0.5 * carried.norm_squared() / stiffness - work - stored;
    Shear {
        force,
        potential: stored + dissipated,
        dissipated,
        across: secant,
        along: 0.0,
        direction: force / limit.max(f64::MIN_POSITIVE),
        slides: true,
    }
}

/// Answer of a contact to a twist about its normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Torsion {
    /// M_t \[N m\] on grain i, about the normal towards it.
    pub couple: f64,
    /// Its potential since the reference \[J\]: M_t = -d(potential)/dΩ_t.
    pub potential: f64,
    /// Part of `potential` that slip took \[J\].
    pub dissipated: f64,
    /// -dM_t/dΩ_t \[N m\].
    pub stiffness: f64,
    /// Whether the contact twists freely.
    pub slides: bool,
}

/// The couple of a contact twisted by `angle` \[rad\] since it carried the couple `carried`
/// (T 3.6-3.9; on a line the secant rule and the radial return are the same).
#[must_use]
#[inline]
pub fn torsion(carried: f64, angle: f64, stiffness: f64, limit: f64) -> Torsion {
    let trial = carried - angle * stiffness;
    let size = trial.abs();
    let slides = size > limit;
    let dissipated = if slides { limit * (size - limit) / stiffness } else { 0.0 };
    let kept = size.min(limit);
    let answers = stiffness > 0.0;
    let where_it_answers = |x: f64| if answers { x } else { 0.0 };
    Torsion {
        couple: where_it_answers(kept.copysign(trial)),
        potential: where_it_answers(dissipated + 0.5 * kept * kept / stiffness),
        dissipated: where_it_answers(dissipated),
        stiffness: if slides { 0.0 } else { stiffness },
        slides: slides && answers,
    }
}
