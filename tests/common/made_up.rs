//! A twin without physics: every number it answers is made up, distinct and reproducible.

#[path = "made_up_cement.rs"]
mod made_up_cement;
#[path = "made_up_fabric.rs"]
mod made_up_fabric;

use std::array::from_fn;
use std::sync::Arc;

use graintwin::command::{Command, Disposition, Mode, Stamp};
use graintwin::report::{
    Band, ContactNetwork, Demand, Event, EventKind, GrainMotion, Localisation, Measures, Moduli,
    PackState, Report, Tangent, TangentModuli, WallForces,
};
use graintwin::sink::Served;

/// Answers commands as a twin does, at once.
pub(crate) struct MadeUpTwin {
    contacts: usize,
    increment: u64,
    numbers: Numbers,
}

impl MadeUpTwin {
    /// A twin whose contact networks have `contacts` contacts.
    pub(crate) fn new(contacts: usize) -> Self {
        Self { contacts, increment: 0, numbers: Numbers(1) }
    }

    /// The initial equilibrium.
    pub(crate) fn start(&mut self, demand: Demand) -> Arc<Served> {
        let report = Report {
            stamp: Stamp::default(),
            session: String::new(),
            sequence: 0,
            increment: 0,
            disposition: Disposition::Applied,
            substeps: 0,
            text: "relaxed".into(),
            measures: Some(self.measures(Stamp::default(), demand)),
        };
        Arc::new(Served { command: None, report })
    }

    /// Serves `command`, or refuses what is no command.
    pub(crate) fn apply(&mut self, command: &Command, demand: Demand) -> Arc<Served> {
        let known = matches!(command.mode, Mode::Absolute | Mode::Increment);
        let valid = known && command.ask.numbers().iter().all(|value| value.is_finite());
        self.increment += u64::from(valid);
        let (disposition, text) = match valid {
            true => (Disposition::Applied, ""),
            false => (Disposition::Invalid, "not a command: ü"),
        };
        let report = Report {
            stamp: command.stamp,
            session: command.session.clone(),
            sequence: command.sequence,
            increment: self.increment,
            disposition,
            substeps: 3,
            text: text.into(),
            measures: valid.then(|| self.measures(command.stamp, demand)),
        };
        Arc::new(Served { command: Some(command.clone()), report })
    }

    fn measures(&mut self, stamp: Stamp, demand: Demand) -> Measures {
        let contacts = self.contacts;
        let n = &mut self.numbers;
        Measures {
            stamp,
            increment: self.increment,
            // Only some increments have events.
            events: (0..self.increment % 3).map(|_| n.event()).collect(),
            rearrangements: Vec::new(),
            surfaces: Vec::new(),
            snapshots: Vec::new(),
            walls: WallForces {
                normal_force: from_fn(|_| n.next()),
                displacement: from_fn(|_| n.next()),
                position: from_fn(|_| n.next()),
                force: from_fn(|_| from_fn(|_| n.next())),
                moment: from_fn(|_| from_fn(|_| n.next())),
            },
            wall_force_error: 1e-9,
            state: demand.state.then(|| PackState {
                strain: from_fn(|_| n.next()),
                natural_strain: from_fn(|_| n.next()),
                stress_walls: from_fn(|_| n.next()),
                stress_contacts: from_fn(|_| n.next()),
                confining_stress: n.next(),
                deviatoric_stress: n.next(),
                porosity: n.next(),
                coordination_number: n.next(),
                sliding_ratio: n.next(),
                stored_energy: n.next(),
                wall_work: n.next(),
                dissipated_energy: n.next(),
                contacts: n.index(),
                rattlers: n.index(),
                iterations: n.index(),
                residual: n.next(),
                solve_seconds: n.next(),
                converged: n.index().is_multiple_of(2),
                ..PackState::default()
            }),
            moduli: demand.moduli.then(|| Moduli {
                valid: n.index().is_multiple_of(2),
                bulk: n.next(),
                shear: f64::NAN,
                young: n.next(),
                poisson: n.next(),
                lame: n.next(),
                p_wave: n.next(),
                tangent: from_fn(|i| if i == 4 { f64::NAN } else { n.next() }),
                p_speed: n.next(),
                s_speed: n.next(),
            }),
            tangent: demand.tangent.then(|| {
                let mut part = || TangentModuli {
                    valid: n.index().is_multiple_of(2),
                    error: n.next(),
                    relaxed: from_fn(|_| n.next()),
                    affine: from_fn(|_| n.next()),
                    wall_stiffness: from_fn(|_| from_fn(|_| n.next())),
                    bulk: n.next(),
                    shear: n.next(),
                    young: f64::NAN,
                    poisson: n.next(),
                    lame: n.next(),
                    p_wave: n.next(),
                    shear_pairs: from_fn(|_| n.next()),
                    p_speed: from_fn(|_| n.next()),
                    s_speed: from_fn(|_| n.next()),
                    isotropy_index: n.next(),
                };
                let (stands, sticks) = (part(), part());
                Tangent { density: n.next(), products: n.index().into(), stands, sticks }
            }),
            network: demand.contact_network.then(|| ContactNetwork {
                first: (0..contacts).map(|_| n.index()).collect(),
                second: (0..contacts).map(|_| u32::MAX - n.index() % 6).collect(),
                normal: (0..3 * contacts).map(|_| n.next()).collect(),
                normal_force: (0..contacts).map(|_| n.next()).collect(),
                tangential_force: (0..3 * contacts).map(|_| n.next()).collect(),
                overlap: (0..contacts).map(|_| n.next()).collect(),
                state: (0..contacts).map(|_| (n.index() % 2) as u8).collect(),
            }),
            grains: None,
            motion: demand.grain_motion.then(|| n.motion(contacts)),
            fabric: demand.fabric.then(|| made_up_fabric::fabric(&mut || n.next())),
            hydrate: None,
            shear: None,
            plane: None,
            bonds: (demand.bonds).then(|| made_up_cement::bonds(contacts as u32, &mut || n.next())),
            cracks: demand.cracks.then(|| made_up_cement::cracks(n.index() % 4, &mut || n.next())),
        }
    }
}

/// Numbers with full mantissas, many orders of magnitude and both signs (splitmix64).
struct Numbers(u64);

impl Numbers {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn next(&mut self) -> f64 {
        let bits = self.bits();
        let magnitude = f64::from((bits % 41) as i32 - 20);
        (bits as f64 / u64::MAX as f64 - 0.5) * 10f64.powf(magnitude)
    }

    fn event(&mut self) -> Event {
        Event {
            kind: EventKind::StressDrop,
            stress_before: self.next(),
            stress_after: self.next(),
            energy_released: self.next(),
            grains: (0..5).map(|_| self.index()).collect(),
            displacement: (0..5).map(|_| self.next()).collect(),
        }
    }

    fn motion(&mut self, grains: usize) -> GrainMotion {
        let mut vectors = || (0..grains).map(|_| from_fn(|_| self.next())).collect();
        let [displacement, non_affine, rotation, total_rotation] = from_fn(|_| vectors());
        let mut scalars = || (0..grains).map(|_| self.next()).collect();
        let [d2min, shear_strain, volumetric_strain] = from_fn(|_| scalars());
        GrainMotion {
            displacement,
            non_affine,
            rotation,
            total_rotation,
            d2min,
            shear_strain,
            volumetric_strain,
            carries: (0..grains).map(|_| self.index().is_multiple_of(2)).collect(),
            localisation: Localisation {
                affine_rms: self.next(),
                non_affine_rms: self.next(),
                non_affine_ratio: self.next(),
                rotation_rms: self.next(),
                participation: self.next(),
                rotation_participation: self.next(),
                d2min_top_1: self.next(),
                d2min_top_10: self.next(),
                band: Band {
                    center: from_fn(|_| self.next()),
                    normal: from_fn(|_| self.next()),
                    spread: from_fn(|_| self.next()),
                    thickness: self.next(),
                },
            },
        }
    }

    fn index(&mut self) -> u32 {
        (self.bits() >> 32) as u32
    }
}
