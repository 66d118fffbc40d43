//! How the answer of a contact changes with the motion of its bodies: the exact derivative of what
//! [`held`](super::held) computes, with stick and slip as they stand.
//!
//! The tangential force Q follows the normal n̂ and the sliding displacement u_s (T 3.2),
//!
//! ```text
//! dQ = T dn̂ - B du_s
//! ```
//!
//! where T turns what the contact carried with the contact plane and B is the stiffness of the law.
//! The arms, the lever n̂ × Q and the couple follow the geometry.

use nalgebra::Matrix3;

use crate::Vec3;
use crate::contact::neighbours::Neighbours;
use crate::contact::{Other, coulomb, partial_slip};
use crate::model::Model;
use crate::pack::Layer;
use crate::relax::tangential::Reference;
use crate::relax::tangential::held::{Held, Motion, Pose};
use crate::relax::tangential::turn::{Turn, turned_into_plane};
use crate::scene::Law;
use crate::state::State;

/// One contact linearised.
#[derive(Clone, Copy, Debug)]
pub(in crate::relax) struct Slope {
    /// Grain i.
    pub(in crate::relax) first: u32,
    /// The other body.
    pub(in crate::relax) second: Other,
    normal: Vec3,
    /// 1/r \[1/m\]; 0 at a wall, whose normal does not turn.
    over_distance: f64,
    arm: [f64; 2],
    /// Change of the arms with the distance.
    arm_slope: [f64; 2],
    moved: Vec3,
    turned: [Vec3; 2],
    force: Vec3,
    couple: f64,
    /// T \[N\].
    turning: Matrix3<f64>,
    /// B \[N/m\].
    stiffness: Matrix3<f64>,
    /// -dM_t/dΩ_t \[N m\].
    torsion: f64,
}

/// Change of what a contact does to its bodies.
pub(in crate::relax) struct Changed {
    /// Of Q on grain i \[N\].
    pub(in crate::relax) force: Vec3,
    /// Of the gradient with respect to the rotations of both bodies \[N m\].
    pub(in crate::relax) moment: [Vec3; 2],
}

impl Slope {
    /// The change when grain i moves by `moved` \[m\] against the other body and a wall by `inward`
    /// \[m\] along its normal, and both turn by `turned` \[rad\].
    pub(in crate::relax) fn changed(
        &self,
        moved: &Vec3,
        inward: f64,
        turned: [Vec3; 2],
    ) -> Changed {
        let Self { normal, arm, force, .. } = self;
        let along = normal.dot(moved);
        let distance = along - inward;
        let turning = (moved - normal * along) * self.over_distance; // dn̂
        let arm_change = self.arm_slope.map(|slope| slope * distance);
        let sweep = self.turned[0] * arm[0] + self.turned[1] * arm[1];
        let sweeping = turned[0] * arm[0]
            + turned[1] * arm[1]
            + self.turned[0] * arm_change[0]
            + self.turned[1] * arm_change[1];
        let slid =
            moved - turning * normal.dot(&self.moved) - normal * (turning.dot(&self.moved) + along)
                + turning.cross(&sweep)
                + normal.cross(&sweeping);
        let twist =
            (turned[0] - turned[1]).dot(normal) + (self.turned[0] - self.turned[1]).dot(&turning);
        let change = self.turning * turning - self.stiffness * slid;
        let lever = normal.cross(force);
        let levering = turning.cross(force) + normal.cross(&change);
        let couple = turning * self.couple - normal * (self.torsion * twist);
        Changed {
            force: change,
            moment: [
                levering * arm[0] + lever * arm_change[0] - couple,
                levering * arm[1] + lever * arm_change[1] + couple,
            ],
        }
    }
}

impl Reference {
    /// All contacts that answer in the configuration `at`, between grains that take part.
    pub(in crate::relax) fn slopes(&self, at: &Pose<'_>, carries: &[bool]) -> Vec<Slope> {
        let Some(friction) = &at.model.friction else { return Vec::new() };
        let live = self.contacts.iter().filter(|held| held.live(carries) && !held.is_open());
        live.map(|held| self.slope(held, friction.law, at)).collect()
    }

    /// The normal parts of cement in the configuration `at`, between grains that take part.
    pub(in crate::relax) fn cement_normals(&self, at: &Pose<'_>, carries: &[bool]) -> Vec<Along> {
        let live = self.contacts.iter().filter(|held| held.live(carries));
        live.filter_map(|held| {
            let law = self.bond_of(held)?.law;
            let branch = held.ends(at, &self.rotation).branch;
            let distance = branch.norm();
            let answer = law.answer(distance);
            Some(Along {
                first: held.first,
                second: held.second,
                normal: branch / distance,
                stiffness: answer.stiffness,
                bending: answer.force / distance,
            })
        })
        .collect()
    }

    /// Takes `state` as the reference, where every contact sticks whatever it carries.
    pub(in crate::relax) fn begin_sticking(
        &mut self,
        model: &Model,
        state: &State,
        near: &Neighbours,
    ) {
        self.begin(model, state, near, true);
        self.contacts.iter_mut().for_each(|held| held.carried.slides = false);
        self.sticks = true;
    }

    fn slope(&self, held: &Held, law: Law, at: &Pose<'_>) -> Slope {
        let ends = held.ends(at, &self.rotation);
        let motion = ends.motion();
        let law = if held.is_bonded() { Law::ReturnMap } else { law };
        let sticks = self.sticks && !held.carried.slides;
        let law = if sticks { Law::ReturnMap } else { law };
        let limit = if sticks { f64::INFINITY } else { held.limit };
        let torsion_limit = if sticks { f64::INFINITY } else { held.torsion_limit };
        // At the reference itself a contact that slid last goes on to.
        let slides = motion.slid == Vec3::zeros() && held.carried.slides;
        let Derivative { force, turning, stiffness } = match law {
            Law::ReturnMap => held.return_map(&motion, limit, slides),
            Law::Secant => held.secant(&motion, limit, slides),
            Law::MindlinDeresiewicz => held.partial_slip(&motion, held.layers(&self.layers)),
        };
        let answer = coulomb::torsion(
            held.carried.torsion,
            motion.twist,
            held.torsion_stiffness,
            torsion_limit,
        );
        let twists_on =
            slides && motion.twist == 0.0 && held.carried.torsion.abs() >= torsion_limit;
        let distance = ends.branch.norm();
        let (over_distance, arm_slope) = match held.second {
            Other::Grain(_) => {
                let slope = 0.5 * (1.0 - ends.offset / (distance * distance));
                (1.0 / distance, [slope, 1.0 - slope])
            }
            Other::Wall(_) => (0.0, [1.0, 0.0]),
        };
        Slope {
            first: held.first,
            second: held.second,
            normal: motion.normal,
            over_distance,
            arm: motion.arm,
            arm_slope,
            moved: ends.moved,
            turned: ends.turned,
            force,
            couple: answer.couple,
            turning,
            stiffness,
            torsion: if twists_on { 0.0 } else { answer.stiffness },
        }
    }
}

/// The normal part of cement.
pub(in crate::relax) struct Along {
    /// Grain i.
    pub(in crate::relax) first: u32,
    /// The other body.
    pub(in crate::relax) second: Other,
    /// Unit normal towards grain i.
    pub(in crate::relax) normal: Vec3,
    /// dP/du \[N/m\].
    pub(in crate::relax) stiffness: f64,
    /// P/r \[N/m\].
    pub(in crate::relax) bending: f64,
}

/// Q \[N\], T \[N\] and B \[N/m\].
struct Derivative {
    force: Vec3,
    turning: Matrix3<f64>,
    stiffness: Matrix3<f64>,
}

impl Held {
    /// Of Q = Q* inside the limit and Q_max e, e = Q*/|Q*|, outside, where Q* = Q⁰ᵖ - k u.
    fn return_map(&self, motion: &Motion, limit: f64, slides: bool) -> Derivative {
        let carried = turned_into_plane(&self.carried.shear, &motion.normal);
        let trial = carried - motion.slid * self.stiffness;
        let size = trial.norm();
        let share = match (size > limit || slides) && size > 0.0 {
            true => (limit.min(size) / size) * across(&(trial / size)),
            false => Matrix3::identity(),
        };
        Derivative {
            force: coulomb::return_map(&carried, &motion.slid, self.stiffness, limit).force,
            turning: share * turning_of_carried(&self.carried.shear, &motion.normal),
            stiffness: share * self.stiffness,
        }
    }

    /// Of Q = Q⁰ᵖ - κ u, where κ keeps |Q| at the limit: Q·dQ = 0.
    fn secant(&self, motion: &Motion, limit: f64, slides: bool) -> Derivative {
        let whole = turned_into_plane(&self.carried.shear, &motion.normal);
        let size = whole.norm();
        let cut = if size > limit { limit / size } else { 1.0 };
        let carried = whole * cut;
        let answer = coulomb::secant(&whole, &motion.slid, self.stiffness, limit);
        let turning = turning_of_carried(&self.carried.shear, &motion.normal) * cut;
        let along = answer.force.dot(&motion.slid);
        if answer.slides && along != 0.0 {
            let secant = (carried - answer.force).dot(&motion.slid) / motion.slid.norm_squared();
            let keeping = Matrix3::identity() - motion.slid * answer.force.transpose() / along;
            return Derivative {
                force: answer.force,
                turning: keeping * turning,
                stiffness: keeping * secant,
            };
        }
        let stiffness = if slides { 0.0 } else { self.stiffness };
        Derivative { force: answer.force, turning, stiffness: Matrix3::identity() * stiffness }
    }

    /// Of partial slip, whose history turns with the contact plane as R: Q = R f(Rᵀ u).
    fn partial_slip(&self, motion: &Motion, layers: &[Layer]) -> Derivative {
        let turn = Turn::between(&self.normal, &motion.normal);
        let step = self.step(&motion.slid, &turn);
        let answer = self.partial.respond(layers, &step);
        let local = answer_stiffness(&answer, layers, step.before);
        let turns = |k: usize| {
            let change = turn.changed(&self.normal, &Vec3::ith(k, 1.0));
            change.forth(&answer.shear) - turn.forth(&(local * change.back(&motion.slid)))
        };
        let rotation = turn.matrix();
        Derivative {
            force: turn.forth(&answer.shear),
            turning: Matrix3::from_columns(&[turns(0), turns(1), turns(2)]),
            stiffness: rotation * local * rotation.transpose(),
        }
    }
}

/// -df/du of partial slip, with the part that is not symmetric ([`partial_slip::Response`]).
fn answer_stiffness(
    answer: &partial_slip::Response,
    layers: &[Layer],
    before: f64,
) -> Matrix3<f64> {
    let e = answer.direction;
    let mut stiffness = across(&e) * answer.across + e * e.transpose() * answer.along;
    if !answer.sliding && e != Vec3::zeros() {
        let ratio = partial_slip::ratio_at(layers, before, answer.core);
        let oblique = ratio - e * e.dot(&ratio);
        let share = (answer.across - answer.along) / (1.0 - e.dot(&ratio));
        if share.is_finite() {
            stiffness += oblique * e.transpose() * share;
        }
    }
    stiffness
}

/// 1 - e eᵀ.
fn across(e: &Vec3) -> Matrix3<f64> {
    Matrix3::identity() - e * e.transpose()
}

/// dQ⁰ᵖ/dn̂: of what a contact carried, turned into the plane with its magnitude.
fn turning_of_carried(carried: &Vec3, normal: &Vec3) -> Matrix3<f64> {
    let along = normal.dot(carried);
    let projected = carried - normal * along;
    let flat2 = projected.norm_squared();
    if flat2 == 0.0 {
        return Matrix3::zeros();
    }
    let share = (carried.norm_squared() / flat2).sqrt();
    let projecting = -Matrix3::identity() * along - normal * carried.transpose();
    (Matrix3::identity() - projected * projected.transpose() / flat2) * projecting * share
}
