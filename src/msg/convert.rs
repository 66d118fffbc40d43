//! From the twin's commands and reports to messages, and back for commands.

mod cement;
mod motion;

pub use cement::{LIVE_BONDS, bond_chunks, crack_chunks, whole_bonds, whole_cracks};
pub use motion::{LIVE_GRAINS, motion_chunks, whole_motion};

mod fabric;

pub use fabric::fabric;

mod tangent;

mod hydrate;
mod plane;
mod shear;

pub use hydrate::hydrate;
pub use plane::plane_state;
pub use shear::shear;

use super::topics::{PACK_FRAME, VIEW_FRAME, WORLD_FRAME, wall_frame};
use super::{
    BoundaryCommand, ContactNetwork, Discrepancy, Dissociation, Event, Header, JointState, Moduli,
    PackState, Report, ShearCommand, TFMessage, Time, Transform, TransformStamped, WallForces,
    WallTargets, Wrench, WrenchStamped,
};
use crate::command::{Ask, Command, Stamp};
use crate::measure::discrepancy;
use crate::report::{self, Measures};
use crate::wall::{self, WallTarget};
pub use tangent::tangent;

/// Most contacts in one live [`ContactNetwork`]: 56 KB, what one sample can carry without
/// losses over a stock receive buffer.
pub const LIVE_CHUNK: usize = 700;

impl From<Stamp> for Time {
    fn from(stamp: Stamp) -> Self {
        Self { sec: stamp.sec, nanosec: stamp.nanosec }
    }
}

impl From<Time> for Stamp {
    fn from(time: Time) -> Self {
        Self { sec: time.sec, nanosec: time.nanosec }
    }
}

/// A command as the message that it came as.
#[derive(Clone, Debug, PartialEq)]
pub enum CommandMessage {
    /// With a displacement of every wall.
    Boundary(BoundaryCommand),
    /// With a target of each wall.
    Targets(WallTargets),
    /// With the dissociation of hydrate.
    Dissociation(Dissociation),
    /// With the tilt of a box of discs.
    Shear(ShearCommand),
}

impl From<&Command> for CommandMessage {
    fn from(command: &Command) -> Self {
        let header = pack_header(command.stamp);
        let Command { session, sequence, mode, .. } = command.clone();
        let mode = mode.into();
        match command.ask {
            Ask::Displacement(displacement) => {
                Self::Boundary(BoundaryCommand { header, session, sequence, mode, displacement })
            }
            Ask::Targets(targets) => Self::Targets(WallTargets {
                header,
                session,
                sequence,
                mode,
                control: targets.map(|target| target.numbers().0),
                value: targets.map(|target| target.numbers().1),
            }),
            Ask::Shear(asked) => Self::Shear(shear::command(command, &asked)),
            Ask::Dissociation(asked) => {
                let crate::command::Dissociation { saturation_loss, pore_pressure, biot } = asked;
                Self::Dissociation(Dissociation {
                    header,
                    session,
                    sequence,
                    mode,
                    saturation_loss,
                    pore_pressure,
                    biot,
                })
            }
        }
    }
}

/// A command whose age nobody has measured yet.
impl From<BoundaryCommand> for Command {
    fn from(message: BoundaryCommand) -> Self {
        Self {
            stamp: message.header.stamp.into(),
            session: message.session,
            sequence: message.sequence,
            mode: message.mode.into(),
            ask: Ask::Displacement(message.displacement),
            age: None,
        }
    }
}

/// A command whose age nobody has measured yet.
impl From<WallTargets> for Command {
    fn from(message: WallTargets) -> Self {
        let target = |wall| WallTarget::from_numbers(message.control[wall], message.value[wall]);
        Self {
            stamp: message.header.stamp.into(),
            ask: Ask::Targets(std::array::from_fn(target)),
            session: message.session,
            sequence: message.sequence,
            mode: message.mode.into(),
            age: None,
        }
    }
}

impl From<&report::Report> for Report {
    fn from(report: &report::Report) -> Self {
        Self {
            header: pack_header(report.stamp),
            session: report.session.clone(),
            sequence: report.sequence,
            increment: report.increment,
            disposition: report.disposition as u8,
            substeps: report.substeps,
            text: text(report),
        }
    }
}

/// What there is to say, and how exact the wall forces are.
fn text(report: &report::Report) -> String {
    let Some(measures) = &report.measures else { return report.text.clone() };
    let error = measures.wall_force_error;
    let exact = format!("wall forces within {error:.1e} N of the exact equilibrium");
    match report.text.as_str() {
        "" => exact,
        said => format!("{said}; {exact}"),
    }
}

/// The forces on all walls.
#[must_use]
pub fn wall_forces(measures: &Measures) -> WallForces {
    let walls = &measures.walls;
    WallForces {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        normal_force: walls.normal_force,
        displacement: walls.displacement,
        force: walls.force.map(Into::into),
        moment: walls.moment.map(Into::into),
    }
}

/// The force on wall `wall` and its moment about the wall's centre, as a load cell in the frame
/// of the wall would show them.
#[must_use]
pub fn wall_wrench(measures: &Measures, wall: usize) -> WrenchStamped {
    let walls = &measures.walls;
    let force = walls.force[wall];
    let axis = wall::axis(wall);
    let middle = 0.5 * (walls.position[2 * axis] + walls.position[2 * axis + 1]);
    let mut lever = [0.0; 3];
    lever[axis] = walls.position[wall] - middle;
    let shift = cross(lever, force);
    let torque = std::array::from_fn::<_, 3, _>(|i| walls.moment[wall][i] - shift[i]);
    WrenchStamped {
        header: Header { stamp: measures.stamp.into(), frame_id: wall_frame(wall) },
        wrench: Wrench { force: force.into(), torque: torque.into() },
    }
}

/// The walls as the joints of a machine: position is the inward displacement, effort the normal
/// force.
#[must_use]
pub fn wall_states(measures: &Measures) -> JointState {
    JointState {
        header: pack_header(measures.stamp),
        name: wall::NAMES.map(str::to_owned).to_vec(),
        position: measures.walls.displacement.to_vec(),
        velocity: Vec::new(),
        effort: measures.walls.normal_force.to_vec(),
    }
}

/// The pack as a whole, when it was asked for.
#[must_use]
pub fn pack_state(measures: &Measures) -> Option<PackState> {
    measures.state.as_ref().map(|state| PackState {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        strain: state.strain,
        stress_walls: state.stress_walls,
        stress_contacts: state.stress_contacts,
        confining_stress: state.confining_stress,
        deviatoric_stress: state.deviatoric_stress,
        porosity: state.porosity,
        coordination_number: state.coordination_number,
        sliding_ratio: state.sliding_ratio,
        stored_energy: state.stored_energy,
        dissipated_energy: state.dissipated_energy,
        contacts: state.contacts,
        rattlers: state.rattlers,
        iterations: state.iterations,
        residual: state.residual,
        solve_seconds: state.solve_seconds,
        converged: state.converged,
    })
}

/// The moduli, when they were asked for.
#[must_use]
pub fn moduli(measures: &Measures) -> Option<Moduli> {
    measures.moduli.as_ref().map(|moduli| Moduli {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        valid: moduli.valid,
        bulk: moduli.bulk,
        shear: moduli.shear,
        young: moduli.young,
        poisson: moduli.poisson,
        lame: moduli.lame,
        p_wave: moduli.p_wave,
        tangent: moduli.tangent,
    })
}

/// How an increment compares with the real rig.
#[must_use]
pub fn discrepancy(found: &discrepancy::Discrepancy) -> Discrepancy {
    Discrepancy {
        header: pack_header(found.stamp),
        increment: found.increment,
        valid: std::array::from_fn(|wall| found.is_valid(wall)),
        twin_force: found.twin,
        rig_force: found.rig,
        difference: std::array::from_fn(|wall| found.twin[wall] - found.rig[wall]),
        delay: found.delay,
    }
}

/// The frame of the pack and that of its pictures in the root, both of which are where the root is,
/// and those of the walls in that of the pack: their origins at the centres of the walls, their
/// axes as the pack's.
#[must_use]
pub fn wall_frames(measures: &Measures) -> TFMessage {
    let position = &measures.walls.position;
    let centre = |axis: usize| 0.5 * (position[2 * axis] + position[2 * axis + 1]);
    let transforms = (0..wall::COUNT).map(|wall| {
        let mut origin = std::array::from_fn(centre);
        origin[wall::axis(wall)] = position[wall];
        let transform = Transform { translation: origin.into(), ..Transform::default() };
        let header = pack_header(measures.stamp);
        TransformStamped { header, child_frame_id: wall_frame(wall), transform }
    });
    let roots = [PACK_FRAME, VIEW_FRAME].map(|frame| TransformStamped {
        header: Header { frame_id: WORLD_FRAME.into(), ..pack_header(measures.stamp) },
        child_frame_id: frame.into(),
        transform: Transform::default(),
    });
    TFMessage { transforms: roots.into_iter().chain(transforms).collect() }
}

/// The events on the way to this equilibrium, in order.
pub fn events(measures: &Measures) -> impl Iterator<Item = Event> + '_ {
    measures.events.iter().map(|event| Event {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        kind: event.kind as u8,
        stress_before: event.stress_before,
        stress_after: event.stress_after,
        grains: event.grains.clone(),
        displacement: event.displacement.clone(),
    })
}

/// The contact network in one message, as recordings hold it; `None` when it was not asked for.
#[must_use]
pub fn whole_network(measures: &Measures) -> Option<ContactNetwork> {
    let network = measures.network.as_ref()?;
    network_chunks(measures, network.first.len()).next()
}

/// The contact network in messages of at most `most` contacts each; one empty message when there
/// is no contact, none when the network was not asked for.
pub fn network_chunks(
    measures: &Measures,
    most: usize,
) -> impl Iterator<Item = ContactNetwork> + '_ {
    measures.network.iter().flat_map(move |network| {
        let contacts = network.first.len();
        let most = most.max(1);
        let chunks = contacts.div_ceil(most).max(1);
        (0..chunks).map(move |chunk| {
            let range = chunk * most..((chunk + 1) * most).min(contacts);
            let triples = 3 * range.start..3 * range.end;
            ContactNetwork {
                header: pack_header(measures.stamp),
                increment: measures.increment,
                chunk: chunk as u32,
                chunk_count: chunks as u32,
                first: network.first[range.clone()].to_vec(),
                second: network.second[range.clone()].to_vec(),
                normal: network.normal[triples.clone()].to_vec(),
                normal_force: network.normal_force[range.clone()].to_vec(),
                tangential_force: network.tangential_force[triples].to_vec(),
                overlap: network.overlap[range.clone()].to_vec(),
                state: network.state[range].to_vec(),
            }
        })
    })
}

pub(super) fn pack_header(stamp: Stamp) -> Header {
    Header { stamp: stamp.into(), frame_id: PACK_FRAME.to_owned() }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
