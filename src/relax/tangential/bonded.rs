//! Cemented contacts at the reference configuration, and their answers in another (T 4.4, 4.7).
//!
//! A cemented contact is one that sticks (T 4.5, 4.7, 4.20) and whose normal force follows the
//! distance alone; beside a parallel bond the grains press on each other as ever.

use crate::Vec3;
use crate::contact::cement::effective::Effective;
use crate::contact::{Other, mindlin};
use crate::heap;
use crate::model::Model;
use crate::model::cement::BondLaw;
use crate::relax::balance::Sums;
use crate::relax::tangential::held::{Held, Pair, Pose};
use crate::relax::tangential::{Pull, Reference, Traction};
use crate::scene::{Cement, Law};
use crate::state::{Bond, Remembered};
use crate::wall::{self, Facing, Room};

/// Least effective radius in shear and torsion over that at the deposition.
const FAINT_RADIUS: f64 = 1e-6;

/// Cement of one contact at the reference configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bonded {
    /// Place among the bonds of the state.
    place: u32,
    pub(super) law: BondLaw,
    /// r at the reference \[m\].
    distance: f64,
    /// Energy of the normal force at the reference \[J\].
    pub(super) carried_energy: f64,
    /// Overlap of a Hertz contact of the same radius \[m\]: the measure of how far a step may go.
    overlap: f64,
}

impl Held {
    /// The contact of `bond`, the one at `place` of the state, and its cement.
    pub(super) fn bonded(
        model: &Model,
        cement: &Cement,
        (place, bond): (usize, &Bond),
        carried: Remembered,
        position: &[Vec3],
        bounds: &Room,
    ) -> Option<(Self, Bonded)> {
        let friction = model.friction.as_ref()?;
        let pair = Pair::of(model, friction, bond.first, bond.second);
        let branch = bond.branch(position, bounds);
        let distance = branch.norm();
        let normal = branch / distance;
        let reach = match bond.second {
            Other::Grain(j) => model.radius[bond.first as usize] + model.radius[j as usize],
            Other::Wall(_) => model.radius[bond.first as usize],
        };
        let branch = match bond.second {
            Other::Grain(_) => branch,
            Other::Wall(_) => position[bond.first as usize],
        };
        let overlap = reach - distance;
        let mut held = Self::new(&pair, carried, [branch, normal], [overlap, 0.0], false);
        let law = model.law_of(cement, bond);
        let carried_energy = match bond.normal_force {
            // The work of its bond holds that too.
            Some(_) => 0.0,
            None => law.answer(distance).energy,
        };
        let bonded = Bonded {
            place: place as u32,
            law,
            distance,
            carried_energy,
            overlap: bond.radius * bond.radius / pair.effective_radius,
        };
        held.freeze_bond(&bonded, &pair, cement, friction.torsion, distance);
        held.carried_energy = bond.work;
        Some((held, bonded))
    }

    /// Freezes the stiffnesses in shear and torsion (4.6, 4.8, 4.21) at the distance `distance`.
    pub(super) fn freeze_bond(
        &mut self,
        bonded: &Bonded,
        pair: &Pair,
        cement: &Cement,
        torsion: bool,
        distance: f64,
    ) {
        (self.limit, self.torsion_limit) = (f64::INFINITY, f64::INFINITY);
        match &bonded.law {
            BondLaw::Effective(law) => {
                // Nothing changes what cement carries in shear whose radius has vanished.
                let least = FAINT_RADIUS * law.contact_radius(law.distance);
                let radius = law.contact_radius(distance).max(least);
                self.stiffness =
                    cement.partial_slip * mindlin::shear_stiffness(radius, pair.shear_compliance);
                // Cement that is gone leaves less of the section, not a smaller one.
                let whole = Effective { share: 1.0, ..*law }.contact_radius(distance).max(least);
                self.torsion_stiffness =
                    radius / whole * mindlin::torsion_stiffness(whole, pair.torsion_compliance);
            }
            BondLaw::Parallel(cylinder) => {
                (self.stiffness, self.torsion_stiffness) =
                    (cylinder.stiffness, cylinder.torsion_stiffness);
            }
        }
        if self.stiffness == 0.0 {
            // Slips completely: a limit of 0 has no answer, whatever the stiffness.
            (self.stiffness, self.limit) = (1.0, 0.0);
        }
        if !torsion {
            self.torsion_stiffness = 0.0;
        }
    }
}

impl Bonded {
    /// Place of the bond among those of the state.
    pub(super) fn place(&self) -> usize {
        self.place as usize
    }
}

impl Reference {
    /// The cement of `held`.
    #[inline(always)]
    pub(super) fn bond_of(&self, held: &Held) -> Option<&Bonded> {
        self.bonds.get(held.bond as usize)
    }

    /// Counts the bond of `held` at `pose` in `sums` and its force on a wall in `walls`.
    pub(super) fn count(
        &self,
        held: &Held,
        pull: &Pull,
        pose: &Pose<'_>,
        sums: &mut Sums,
        walls: &mut [f64; wall::COUNT],
    ) {
        let Some(bonded) = self.bond_of(held) else { return };
        let at = pose.position[held.first as usize];
        match held.second {
            Other::Grain(j) => {
                let branch = at - pose.position[j as usize];
                for axis in 0..3 {
                    sums.virial[axis] += pull.force[axis] * branch[axis];
                }
            }
            Other::Wall(w) => {
                let w = usize::from(w);
                let Facing { gap, normal, .. } = pose.bounds.facing(&at, w);
                let force = pull.force.dot(&normal);
                walls[w] += force;
                for axis in 0..3 {
                    sums.virial[axis] += force * gap * normal[axis] * normal[axis];
                }
            }
        }
        sums.force += pull.cement;
        // Where the grains press besides, that is the same contact.
        let alone = matches!(bonded.law, BondLaw::Effective(_));
        if alone || held.overlap_at(pose) <= 0.0 {
            sums.overlap += bonded.overlap;
            sums.contacts += 1;
        }
    }

    /// The answer of `held` at `pose` with that of its cement, where `parts` is that of a contact
    /// that sticks.
    #[inline(always)]
    pub(super) fn with_cement(
        &self,
        held: &Held,
        parts: (Traction, Pull),
        pose: &Pose<'_>,
    ) -> (Traction, Pull) {
        match self.bond_of(held) {
            None => parts,
            Some(bonded) => self.cemented(held, bonded, parts, pose),
        }
    }

    fn cemented(
        &self,
        held: &Held,
        bonded: &Bonded,
        (mut traction, mut pull): (Traction, Pull),
        pose: &Pose<'_>,
    ) -> (Traction, Pull) {
        let distance = pull.arm[0] + pull.arm[1];
        let normal = held.ends(pose, &self.rotation).branch / distance;
        let answer = bonded.law.answer(distance);
        let bending = match held.second {
            Other::Grain(_) => answer.force / distance,
            Other::Wall(_) => 0.0,
        };
        pull.force += normal * answer.force;
        pull.potential += answer.energy;
        pull.cement = answer.force.abs();
        traction.axial = (answer.stiffness + bending) as f32;
        traction.bending = bending as f32;
        traction.slides = false;
        (traction, pull)
    }

    /// Renews the stiffnesses of the bond of `held` with the mean of the distance at the reference
    /// and the one that `present`, its overlap now, tells.
    pub(super) fn renew_bond(
        bonds: &[Bonded],
        held: &mut Held,
        model: &Model,
        cement: &Cement,
        present: f64,
    ) {
        let Some(friction) = &model.friction else { return };
        let Some(bonded) = bonds.get(held.bond as usize) else { return };
        let pair = Pair::of(model, friction, held.first, held.second);
        let distance = bonded.distance + 0.5 * (held.reference_overlap - present);
        held.freeze_bond(bonded, &pair, cement, friction.torsion, distance);
    }

    /// The tangential force and the couple of the bond of `held` at `pose`.
    pub(super) fn bond_load(&self, held: &Held, pose: &Pose<'_>) -> (Vec3, f64) {
        let motion = held.motion(pose, &self.rotation);
        let answer = held.answer(&motion, Law::ReturnMap, &[]);
        (answer.shear.force, answer.torsion.couple)
    }

    /// Ends an increment of the bond of `held`, which carries `shear` and `torsion` at `pose`: puts
    /// its work into `bonds` and returns the energy that it stores \[J\].
    pub(super) fn commit_bond(
        &self,
        held: &Held,
        bonded: &Bonded,
        (shear, torsion): (&Vec3, f64),
        pose: &Pose<'_>,
        bonds: &mut [Bond],
    ) -> f64 {
        let bond = &mut bonds[bonded.place as usize];
        // (4.17b, c), of a stiffness that is constant over the increment.
        bond.work +=
            held.energy(shear, torsion) - held.energy(&held.carried.shear, held.carried.torsion);
        let distance = held.ends(pose, &self.rotation).branch.norm();
        bonded.law.answer(distance).energy + bond.work
    }

    /// Memory that its lists hold \[bytes\].
    pub(super) fn bond_bytes(&self) -> usize {
        heap::bytes(&self.bonds)
    }
}
