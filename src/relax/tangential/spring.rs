//! Contacts as springs: directions, stiffnesses and network as they are at the reference
//! (T 4.1-4.9, A.2.2).

use crate::Vec3;
use crate::contact::Other;
use crate::model::cement::BondLaw;
use crate::model::{Friction, Model};
use crate::relax::tangential::held::{Held, Midway, Motion, Pair, Pose};
use crate::relax::tangential::{Changes, Reference};
use crate::scene::Law;
use crate::state::{Memory, Remembered, State};

/// One contact at the reference: what it carries there, turned into the present directions, and
/// what it resists with.
#[derive(Clone, Copy, Debug)]
pub(in crate::relax) struct Spring {
    /// Grain i.
    pub(in crate::relax) first: u32,
    /// The other body.
    pub(in crate::relax) second: Other,
    /// n̂, towards grain i.
    pub(in crate::relax) normal: Vec3,
    /// Distance of the contact from the centres of grain i and of the other \[m\].
    pub(in crate::relax) arm: [f64; 2],
    /// P⁰ \[N\], negative in tension.
    pub(in crate::relax) force: f64,
    /// Q⁰ᵖ on grain i \[N\].
    pub(in crate::relax) shear: Vec3,
    /// M⁰ on grain i about n̂ \[N m\].
    pub(in crate::relax) couple: f64,
    /// k_n \[N/m\].
    pub(in crate::relax) normal_stiffness: f64,
    /// k_s \[N/m\].
    pub(in crate::relax) shear_stiffness: f64,
    /// k_t \[N m\].
    pub(in crate::relax) torsion_stiffness: f64,
}

/// How a spring was deformed.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::relax) struct Deformation {
    /// -u_n: approach of the bodies \[m\] (4.2).
    pub(in crate::relax) approach: f64,
    /// u_s \[m\] (T 3.2).
    pub(in crate::relax) slid: Vec3,
    /// Ω_t \[rad\] (T 3.7).
    pub(in crate::relax) twist: f64,
}

impl Spring {
    /// Of a contact that only presses, with the force `force` \[N\] and the stiffness `stiffness`
    /// \[N/m\].
    pub(in crate::relax) fn pressing(
        (first, second): (u32, Other),
        normal: Vec3,
        force: f64,
        stiffness: f64,
    ) -> Self {
        Self {
            first,
            second,
            normal,
            arm: [0.0; 2],
            force,
            shear: Vec3::zeros(),
            couple: 0.0,
            normal_stiffness: stiffness,
            shear_stiffness: 0.0,
            torsion_stiffness: 0.0,
        }
    }

    /// P \[N\] after `deformation` (4.1).
    pub(in crate::relax) fn force_after(&self, deformation: &Deformation) -> f64 {
        self.force + self.normal_stiffness * deformation.approach
    }
}

impl Reference {
    /// The contacts that answer to more than pressure.
    fn answering(&self) -> &[Held] {
        if self.active { &self.contacts } else { &[] }
    }

    /// Puts a spring for each contact at the reference into `springs`, in their order; `state` is
    /// the reference. One whose bodies take no part has neither load nor stiffness.
    pub(in crate::relax) fn springs(
        &self,
        model: &Model,
        state: &State,
        springs: &mut Vec<Spring>,
    ) {
        let bounds = state.bounds(model);
        let State { position, rotation, .. } = state;
        let pose = Pose { model, position, rotation, bounds: &bounds };
        let spring = |held: &Held| {
            let motion = held.motion(&pose, &self.rotation);
            let Motion { normal, arm, .. } = motion;
            let key = (held.first, held.second);
            let mut spring = Spring { arm, ..Spring::pressing(key, normal, 0.0, 0.0) };
            if !held.live(&state.carries) {
                return spring;
            }
            let answer = held.answer(&motion, Law::ReturnMap, &[]);
            (spring.shear, spring.couple) = (answer.shear.force, answer.torsion.couple);
            (spring.shear_stiffness, spring.torsion_stiffness) = match held.is_bonded() {
                true if held.limit == 0.0 => (0.0, held.torsion_stiffness),
                true => (held.stiffness, held.torsion_stiffness),
                // What slides must resist: a grain that hardly anything else holds has no
                // linear balance without it.
                false if held.is_open() => (0.0, 0.0),
                false => (held.stiffness, held.torsion_stiffness),
            };
            if let Some(bonded) = self.bond_of(held)
                && let BondLaw::Effective(law) = &bonded.law
            {
                let answer = law.answer(arm[0] + arm[1]);
                let remembered = state.bonds[bonded.place()].normal_force;
                spring.force = remembered.unwrap_or(answer.force);
                spring.normal_stiffness = answer.stiffness; // (4.3)
            }
            spring
        };
        springs.extend(self.answering().iter().map(spring));
    }

    /// Writes what the contacts carry after the `deformations` of their `springs` into the memory
    /// and the bonds of `state`, which was moved there from the reference.
    pub(in crate::relax) fn load(
        &self,
        model: &Model,
        state: &mut State,
        springs: &[Spring],
        deformations: impl Iterator<Item = Deformation>,
        memory: &mut Memory,
    ) -> Changes {
        let Some(friction) = &model.friction else { return Changes::default() };
        memory.clear();
        let mut changes = Changes::default();
        state.friction.stored = 0.0;
        for ((held, spring), deformation) in self.answering().iter().zip(springs).zip(deformations)
        {
            let Spring { normal, arm, .. } = *spring;
            let Deformation { approach, slid, twist } = deformation;
            let motion = Motion { normal, arm, slid, twist };
            let answer = held.answer(&motion, Law::ReturnMap, &[]);
            let (shear, torsion) = (answer.shear.force, answer.torsion.couple); // (4.5, 4.7)
            let Some(bonded) = self.bond_of(held) else {
                let slides = answer.shear.slides;
                let load = held.press_on(model, friction, state, (&shear, torsion), &mut changes);
                if load {
                    state.friction.slip += answer.shear.dissipated + answer.torsion.dissipated;
                    let nothing = Remembered { layers: 0, ..held.carried };
                    memory.contacts.push(Remembered { shear, torsion, slides, ..nothing });
                }
                continue;
            };
            let force = spring.force_after(&deformation);
            let bond = &mut state.bonds[bonded.place()];
            // (4.17): the forces are linear in the displacements.
            bond.work += 0.5 * (spring.force + force) * approach
                - 0.5 * (spring.shear + shear).dot(&slid)
                - 0.5 * (spring.couple + torsion) * twist;
            bond.normal_force = Some(force);
            state.friction.stored += bond.work;
            let nothing = Remembered { slides: false, layers: 0, ..held.carried };
            memory.contacts.push(Remembered { shear, torsion, ..nothing });
        }
        std::mem::swap(&mut state.memory, memory);
        changes
    }
}

impl Held {
    /// Ends a step of a contact without cement that carries `shear` and `torsion`; says whether it
    /// still presses.
    fn press_on(
        &self,
        model: &Model,
        friction: &Friction,
        state: &mut State,
        (shear, torsion): (&Vec3, f64),
        changes: &mut Changes,
    ) -> bool {
        let overlap = self.present_overlap(model, state);
        if !self.live(&state.carries) || self.is_open() || overlap <= 0.0 {
            changes.opened += 1;
            changes.excess = changes.excess.max(shear.norm());
            state.friction.renewal += self.carried_energy;
            return false;
        }
        let mut now = *self;
        let pair = Pair::of(model, friction, self.first, self.second);
        now.freeze(&pair, overlap, Midway::No, friction.torsion);
        changes.excess = changes.excess.max(shear.norm() - now.limit);
        let change = self.stick_or_slide(&now, shear, torsion);
        state.friction.slip += change.slip;
        state.friction.renewal += change.renewal;
        state.friction.stored += change.stored;
        true
    }
}
