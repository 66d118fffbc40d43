//! What the twin measures of an equilibrium: what is wanted, and nothing else.

use nalgebra::Matrix3;

use super::Twin;
use super::past::Past;
use crate::command::Stamp;
use crate::measure::contacts::Contacts;
use crate::measure::coordination::{self, Histograms};
use crate::measure::{
    self, cement, fabric, grains, hydrate, moduli, motion, network, porosity, row_major, shear,
    stress, sudden, walls,
};
use crate::model::Model;
use crate::plane;
use crate::relax::advance::Advance;
use crate::relax::tangent;
use crate::report::{
    Cracks, Demand, Fabric, GrainMotion, Measures, Moduli, PackState, PlaneState, Tangent,
    WallForces,
};
use crate::scene::ModuliKind;
use crate::state::State;
use crate::wall::Room;

/// What stress and strain of the box are derived from.
struct Loaded {
    bounds: Room,
    walls: WallForces,
    /// From the walls \[Pa\].
    stress: Matrix3<f64>,
    /// Engineering strain.
    strain: [f64; 3],
}

impl Loaded {
    fn normal_stress(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.stress[(axis, axis)])
    }
}

impl Twin {
    /// What is wanted of the state that `reached` led to.
    pub(super) fn measure(&mut self, stamp: Stamp, reached: &Advance, demand: Demand) -> Measures {
        let shown = demand.grain_motion || demand.grains && self.shows_motion;
        let motion = if shown { self.motion() } else { None };
        let contacts = self.contacts();
        let tangent = self.tangent(reached, demand);
        let plane = if demand.plane { self.plane_state(&contacts) } else { None };
        let loaded = self.loaded(&contacts);
        let before =
            std::mem::replace(&mut self.stress_strain, (loaded.normal_stress(), loaded.strain));
        let Self { model, state, work, .. } = &*self;
        let sudden = sudden::in_order(reached);
        Measures {
            stamp,
            increment: self.increment,
            events: sudden.iter().map(|what| what.event(model)).collect(),
            rearrangements: (sudden.iter().filter(|_| demand.rearrangements))
                .map(|what| what.rearrangement(model))
                .collect(),
            snapshots: (sudden.iter().zip(0..).filter(|_| demand.snapshots))
                .flat_map(|(what, event)| what.snapshots(model, event))
                .collect(),
            wall_force_error: reached.wall_force_error,
            state: demand.state.then(|| self.pack_state(reached, &contacts, &loaded)),
            moduli: demand.moduli.then(|| self.moduli(&loaded, &before, tangent.as_ref())),
            tangent: tangent.filter(|_| demand.tangent),
            network: demand
                .contact_network
                .then(|| network::network(model, contacts.counted().chain(&contacts.cracks))),
            grains: demand.grains.then(|| grains::grains(model, state, &contacts.list)),
            surfaces: match demand.grains {
                true => work.surfaces(model, state),
                false => Vec::new(),
            },
            motion,
            fabric: demand
                .fabric
                .then(|| fabric::fabric(model, state, &contacts, self.chain_share)),
            hydrate: match demand.hydrate {
                true => hydrate::hydrate(model, state, &contacts.list, loaded.stress.trace() / 3.0),
                false => None,
            },
            shear: match demand.shear {
                true => shear::shear(model, state, &contacts.list),
                false => None,
            },
            plane,
            bonds: if demand.bonds { cement::bonds(model, state, &contacts) } else { None },
            cracks: match demand.cracks {
                true => cement::cracks(model, state, &reached.cracks),
                false => None,
            },
            walls: loaded.walls,
        }
    }

    fn contacts(&mut self) -> Contacts {
        let Self { model, state, work, .. } = self;
        work.neighbours.refresh(model, &state.position, &state.bounds(model));
        match &model.plane {
            None => Contacts::of(model, state, &work.neighbours),
            Some(_) => plane::contacts::of(model, state, &work.neighbours),
        }
    }

    fn loaded(&self, contacts: &Contacts) -> Loaded {
        let bounds = self.state.bounds(&self.model);
        let walls = walls::forces(&self.model, &self.state, &contacts.list);
        let plane = self.model.plane.as_ref().map(|setup| &setup.cell);
        let cell = plane.or(self.model.cell.as_ref());
        let pressure = cell.and_then(|cell| cell.pressure(&walls));
        Loaded {
            stress: match pressure {
                None => stress::from_leaning_walls(&walls, &bounds, self.state.tilt),
                Some(pressure) => Matrix3::from_diagonal(&pressure.into()),
            },
            strain: stress::engineering_strain(&bounds, &self.model.reference),
            walls,
            bounds,
        }
    }

    fn pack_state(&self, reached: &Advance, contacts: &Contacts, loaded: &Loaded) -> PackState {
        let Self { model, state, .. } = self;
        let Loaded { bounds, walls, stress, strain } = loaded;
        let numbers = coordination::numbers(model, contacts.counted());
        let normal = loaded.normal_stress();
        let friction = &state.friction;
        let stored_energy = reached.outcome.sums.energy + friction.stored;
        let changes = &reached.changes;
        PackState {
            strain: *strain,
            natural_strain: stress::natural_strain(bounds, &model.reference),
            stress_walls: row_major(stress),
            stress_contacts: row_major(&stress::in_volume(&contacts.list, state.volume(model))),
            confining_stress: stress.trace() / f64::from(model.dimensions()),
            deviatoric_stress: match &model.plane {
                None => normal[2] - 0.5 * (normal[0] + normal[1]),
                Some(_) => normal[1] - normal[0],
            },
            porosity: porosity::porosity(model, &contacts.list, solid_in(model, state)),
            coordination_number: f64::from(numbers.iter().sum::<u32>()) / model.len() as f64,
            sliding_ratio: contacts.sliding_ratio(),
            slipped: contacts.counted().filter(|c| c.slipped).count() as u32,
            mean_normal_force: contacts.mean_force,
            mean_tangential_force: contacts.mean_shear,
            wall_couple: walls::couple(walls, bounds),
            friction_defect: match changes.excess > 0.0 {
                true => changes.excess / contacts.mean_force,
                false => 0.0,
            },
            opened: changes.opened,
            formed: changes.formed,
            stored_energy,
            shear_energy: friction.stored,
            slip_energy: friction.slip,
            renewal_energy: friction.renewal,
            event_energy: self.event_energy,
            broken_energy: friction.broken,
            wall_work: state.wall_work,
            dissipated_energy: state.wall_work + state.dissociated.work
                - (stored_energy - state.initial_energy),
            contacts: contacts.counted().count() as u32,
            rattlers: numbers.iter().filter(|&&number| number == 0).count() as u32,
            iterations: reached.iterations,
            residual: reached.outcome.residual,
            solve_seconds: 0.0,
            converged: true,
        }
    }

    /// Moduli of the kind that the scene wants; `before` is the normal stress \[Pa\] and the strain
    /// at the start of the interval.
    fn moduli(
        &self,
        loaded: &Loaded,
        before: &([f64; 3], [f64; 3]),
        tangent: Option<&Tangent>,
    ) -> Moduli {
        let relaxed = tangent.map_or([f64::NAN; 9], |tangent| tangent.stands.relaxed);
        match tangent {
            Some(tangent) if self.moduli == ModuliKind::Tangent => Moduli::of_tangent(tangent),
            _ if self.increment == 0 => Moduli { tangent: relaxed, ..Moduli::UNKNOWN },
            _ => {
                let change =
                    |now: [f64; 3], then: [f64; 3]| std::array::from_fn(|k| now[k] - then[k]);
                let stress = change(loaded.normal_stress(), before.0);
                let strain = change(loaded.strain, before.1);
                let density = density(&self.model, self.state.volume(&self.model));
                let secant = match &self.model.plane {
                    None => moduli::secant(stress, strain, density),
                    Some(_) => moduli::secant_in_plane(stress, strain, density),
                };
                Moduli { tangent: relaxed, ..secant }
            }
        }
    }

    /// The tangent moduli, when they or the moduli that hold them are wanted.
    fn tangent(&mut self, reached: &Advance, demand: Demand) -> Option<Tangent> {
        if !self.moduli.takes_tangent() || !(demand.moduli || demand.tangent) {
            return None;
        }
        let Self { model, state, work, pool, .. } = self;
        let found = pool.install(|| match &model.plane {
            None => tangent::tangent(model, state, work, &reached.outcome),
            Some(_) => {
                plane::tangent::tangent(model, state, &work.plane, &work.neighbours, reached)
            }
        });
        self.spent.products += found.products;
        let density = density(model, state.volume(model));
        Some(measure::tangent::report(&found, density, model.plane.is_some()))
    }

    /// How the grains moved in the present increment; `None` when the scene says that nobody will
    /// ask.
    #[must_use]
    pub fn motion(&self) -> Option<GrainMotion> {
        let Self { model, state, past, pool, .. } = self;
        let before = past.as_ref().filter(|_| self.tells_motion)?.before();
        Some(pool.install(|| motion::motion(model, before, state)))
    }

    fn plane_state(&self, contacts: &Contacts) -> Option<PlaneState> {
        let Self { model, state, past, .. } = self;
        model.plane.as_ref()?;
        // No increment ends at the start.
        let before = past.as_ref().filter(|_| self.increment > 0).map(Past::before);
        Some(measure::plane::state(model, state, contacts, before))
    }

    /// Histograms of the coordination number now (T fig. 2.6).
    pub fn coordination(&mut self) -> Histograms {
        let contacts = self.contacts();
        let numbers = coordination::numbers(&self.model, contacts.counted());
        coordination::histograms(&self.model, &self.state, &numbers)
    }

    /// How many bonds hold and how many broke so far, without the cracks of any increment; `None` in a
    /// scene without cement.
    #[must_use]
    pub fn cracks(&self) -> Option<Cracks> {
        cement::cracks(&self.model, &self.state, &[])
    }

    /// Statistics of the force network now.
    pub fn fabric(&mut self) -> Fabric {
        let contacts = self.contacts();
        fabric::fabric(&self.model, &self.state, &contacts, self.chain_share)
    }
}

/// Volume that the grains are in as a whole \[m³\].
fn solid_in(model: &Model, state: &State) -> f64 {
    match &model.cell {
        None => state.volume(model),
        Some(_) => state.hull(model).volume(),
    }
}

/// Mass over the volume `volume` \[m³\] of the pack \[kg/m³\].
fn density(model: &Model, volume: f64) -> f64 {
    let mass: f64 = (0..model.len()).map(|k| model.mass(k)).sum();
    mass / volume
}
