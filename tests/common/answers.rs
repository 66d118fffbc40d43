//! Answers of a twin that was never there, every field another number.

#[path = "made_up_cement.rs"]
mod made_up_cement;
#[path = "made_up_fabric.rs"]
mod made_up_fabric;

use std::sync::Arc;

use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::record::Provenance;
use graintwin::report::{
    Band, ContactNetwork, Event, EventEnd, EventKind, GrainMotion, Localisation, Measures, Moduli,
    PackState, Rearrangement, Report, Snapshot, Tangent, TangentModuli, WallForces,
};
use graintwin::sink::Served;

/// What the test recordings say of their making.
pub(crate) fn provenance() -> Provenance {
    Provenance {
        scene: "name: \"Probe 7 µm\"\npack: {file: pack.csv}\n".into(),
        pack_csv: b"x,y,z,radius\n0.0,0.0,0.0,1e-3\n".to_vec(),
        pack_json:
            br#"{"box": {"min": [0, 0, 0], "max": [1, 1, 1]}, "history": "pack.history.json"}"#
                .to_vec(),
        pack_history: Some(br#"{"rotations": [[0, 0, 0]], "contacts": []}"#.to_vec()),
        threads: 2,
        painter: None,
        seed: 1,
    }
}

/// The initial equilibrium and `commands` commands, every fifth of them refused, with networks
/// of `contacts` contacts.
pub(crate) fn answers(commands: u64, contacts: u32) -> Vec<Arc<Served>> {
    let mut increment = 0;
    let mut answers = vec![Arc::new(Served {
        command: None,
        report: report(None, Some(measures(Stamp::default(), 0, contacts)), 0),
    })];
    for sequence in 1..=commands {
        let command = command(sequence);
        let refused = sequence.is_multiple_of(5);
        if !refused {
            increment += 1;
        }
        let measures = (!refused).then(|| measures(command.stamp, increment, contacts));
        let report = report(Some(&command), measures, increment);
        answers.push(Arc::new(Served { command: Some(command), report }));
    }
    answers
}

fn command(sequence: u64) -> Command {
    Command {
        // From before 1970 to after it, and once back.
        stamp: Stamp { sec: sequence as i32 % 7 - 2, nanosec: 1_000 * sequence as u32 },
        session: if sequence < 4 { "erste Sitzung, Öl".into() } else { String::new() },
        sequence,
        mode: if sequence.is_multiple_of(2) { Mode::Absolute } else { Mode::Increment },
        ask: Ask::Displacement(std::array::from_fn(|wall| {
            1e-7 * sequence as f64 / (wall as f64 + 3.0)
        })),
        age: None,
    }
}

fn report(command: Option<&Command>, measures: Option<Measures>, increment: u64) -> Report {
    Report {
        stamp: command.map_or_else(Stamp::default, |command| command.stamp),
        session: command.map_or_else(String::new, |command| command.session.clone()),
        sequence: command.map_or(0, |command| command.sequence),
        increment,
        disposition: if measures.is_some() { Disposition::Applied } else { Disposition::Limit },
        substeps: 3,
        text: if measures.is_some() { String::new() } else { "zu weit: 2 µm > 1 µm".into() },
        measures,
    }
}

fn jump(increment: u64) -> Event {
    Event {
        kind: EventKind::StressDrop,
        stress_before: 1.25e6,
        stress_after: 1.0e6 + increment as f64,
        energy_released: 3.0e-9,
        grains: vec![3, 4_000_000_000],
        displacement: vec![1.5e-7, 2.5e-6],
    }
}

fn rearrangement(increment: u64) -> Rearrangement {
    Rearrangement {
        kind: EventKind::StressDrop,
        stress_before: 1.25e6,
        stress_after: 1.0e6 + increment as f64,
        energy_before: 5.0e-8,
        energy_after: 4.7e-8,
        grains: vec![3, 4_000_000_000],
        displacement: vec![[1.5e-7, 0.0, 0.0], [0.0, -2.5e-6, 1.0 / 3.0]],
        rotation: vec![[0.1, 0.2, -0.3], [1e-9, 0.0, -0.0]],
        lost: vec![[3, 17], [5, u32::MAX - 5]],
        made: vec![[3, 4_000_000_000]],
    }
}

fn snapshot(end: EventEnd) -> Snapshot {
    Snapshot {
        event: 0,
        end,
        wall_position: [-1.0, 1.0, -1.0, 1.0, -1.0, 1.0 + f64::EPSILON],
        position: vec![[0.1, 0.2, 0.3], [1.0 / 3.0, -7e-5, 1e300]],
        rotation: vec![[0.0, -0.0, 1e-3], [5e-324, 2.0, 3.0]],
    }
}

fn measures(stamp: Stamp, increment: u64, contacts: u32) -> Measures {
    let mut seed = 0x2545_f491_4f6c_dd1d_u64.wrapping_mul(increment + 1);
    // Digits as of a computation; the sequence is Marsaglia's xorshift.
    let mut next = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        seed as f64 / u64::MAX as f64
    };
    let walls = WallForces {
        normal_force: std::array::from_fn(|_| next()),
        displacement: std::array::from_fn(|_| next()),
        // The box is 2 m wide, its walls carry no shear: the torque about a wall's centre is
        // the moment about the box's.
        position: [-1.0, 1.0, -1.0, 1.0, -1.0, 1.0],
        force: std::array::from_fn(|wall| {
            std::array::from_fn(|axis| if axis == wall / 2 { next() } else { 0.0 })
        }),
        moment: std::array::from_fn(|_| std::array::from_fn(|_| next())),
    };
    let state = PackState {
        strain: std::array::from_fn(|_| next()),
        natural_strain: std::array::from_fn(|_| next()),
        stress_walls: std::array::from_fn(|_| next()),
        stress_contacts: std::array::from_fn(|_| next()),
        confining_stress: next(),
        deviatoric_stress: -next(),
        porosity: next(),
        coordination_number: next(),
        sliding_ratio: next(),
        slipped: 12,
        mean_normal_force: next(),
        mean_tangential_force: next(),
        wall_couple: next(),
        friction_defect: next(),
        opened: 2,
        formed: 3,
        shear_energy: next(),
        slip_energy: next(),
        renewal_energy: next(),
        event_energy: next(),
        broken_energy: next(),
        stored_energy: next(),
        wall_work: next(),
        dissipated_energy: next(),
        contacts,
        rattlers: 61,
        iterations: 17,
        residual: next(),
        solve_seconds: next(),
        converged: increment.is_multiple_of(2),
    };
    let moduli = Moduli {
        valid: increment > 0,
        bulk: next(),
        shear: f64::NAN,
        young: next(),
        poisson: next(),
        lame: f64::INFINITY,
        p_wave: next(),
        tangent: std::array::from_fn(|entry| if entry == 4 { next() } else { f64::NAN }),
        p_speed: next(),
        s_speed: next(),
    };
    let fabric = made_up_fabric::fabric(&mut next);
    let mut tangent_moduli = |valid| TangentModuli {
        valid,
        error: next(),
        relaxed: std::array::from_fn(|_| next()),
        affine: std::array::from_fn(|_| next()),
        wall_stiffness: std::array::from_fn(|_| std::array::from_fn(|_| next())),
        bulk: next(),
        shear: -next(),
        young: next(),
        poisson: f64::NAN,
        lame: next(),
        p_wave: next(),
        shear_pairs: std::array::from_fn(|_| next()),
        p_speed: std::array::from_fn(|_| next()),
        s_speed: [f64::NAN; 3],
        isotropy_index: next(),
    };
    let (stands, sticks) = (tangent_moduli(true), tangent_moduli(false));
    let tangent = Tangent { density: next(), products: 321, stands, sticks };
    let mut values = |count: u32| (0..count).map(|_| next()).collect::<Vec<f64>>();
    let network = ContactNetwork {
        first: (0..contacts).collect(),
        second: (0..contacts).map(|contact| u32::MAX - contact % 6).collect(),
        normal: values(3 * contacts),
        normal_force: values(contacts),
        tangential_force: values(3 * contacts),
        overlap: values(contacts),
        state: (0..contacts).map(|contact| (contact % 2) as u8).collect(),
    };
    let mut vectors = |count| values(3 * count).as_chunks().0.to_vec();
    let [displacement, non_affine] = std::array::from_fn(|_| vectors(contacts / 3));
    let mut scalars = || values(contacts / 3);
    let motion = GrainMotion {
        displacement,
        non_affine,
        rotation: Vec::new(),
        total_rotation: Vec::new(),
        d2min: scalars(),
        shear_strain: scalars(),
        volumetric_strain: scalars(),
        carries: (0..contacts / 3).map(|grain| grain.is_multiple_of(2)).collect(),
        localisation: Localisation {
            affine_rms: next(),
            non_affine_rms: next(),
            non_affine_ratio: next(),
            rotation_rms: f64::NAN,
            participation: next(),
            rotation_participation: f64::NAN,
            d2min_top_1: next(),
            d2min_top_10: next(),
            band: Band {
                center: std::array::from_fn(|_| next()),
                normal: std::array::from_fn(|_| next()),
                spread: std::array::from_fn(|_| next()),
                thickness: next(),
            },
        },
    };
    let bonds = made_up_cement::bonds(contacts / 2, &mut next);
    let cracks = made_up_cement::cracks(3, &mut next);
    Measures {
        stamp,
        increment,
        events: vec![jump(increment)],
        rearrangements: vec![rearrangement(increment)],
        surfaces: Vec::new(),
        snapshots: [EventEnd::Before, EventEnd::After].map(snapshot).to_vec(),
        walls,
        wall_force_error: 2.5e-9,
        state: Some(state),
        moduli: Some(moduli),
        tangent: Some(tangent),
        network: Some(network),
        grains: None,
        motion: Some(motion),
        fabric: Some(fabric),
        hydrate: None,
        shear: None,
        plane: None,
        bonds: Some(bonds),
        cracks: Some(cracks),
    }
}
