//! The measures of one run.

pub(super) mod cement;
pub(super) mod plane;

use super::motions::Motions;
use crate::msg::{
    ContactNetwork, Cracks, Event, Fabric, GrainMotion, Hydrate, Moduli, PackState, PlaneState,
    PointCloud2, Rearrangement, ShearState, Tangent, WallForces,
};
use crate::report::EventKind;

/// The measures between two resets of the twin, in the order of the bag. A reset takes the pack
/// back to the start and counts the increments from 0 again.
#[derive(Debug, Default)]
pub struct Run {
    /// The pack as a whole.
    pub states: Vec<PackState>,
    /// The walls.
    pub walls: Vec<WallForces>,
    /// The moduli.
    pub moduli: Vec<Moduli>,
    /// Statistics of the force network.
    pub fabrics: Vec<Fabric>,
    /// Hydrate and pore pressures.
    pub hydrates: Vec<Hydrate>,
    /// How a box of discs is sheared.
    pub shears: Vec<ShearState>,
    /// Discs.
    pub plane: plane::Plane,
    /// The moduli of the states themselves.
    pub tangents: Vec<Tangent>,
    /// The forces of the first and of the last contact network, which may be the same.
    pub networks: Option<[Forces; 2]>,
    /// What the contacts of each network carry together.
    pub loads: Vec<Load>,
    /// How the grains moved.
    pub motions: Motions,
    /// Bonds and cracks.
    pub cement: cement::Cement,
    /// Increments with stress drops, each once.
    pub eventful: Vec<u64>,
    /// Energy that events released in these increments \[J\].
    pub released: Vec<(u64, f64)>,
}

/// The contact forces of one equilibrium.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forces {
    /// The increment.
    pub increment: u64,
    /// Normal forces \[N\].
    pub normal: Vec<f64>,
    /// Magnitudes of the tangential forces \[N\].
    pub tangential: Vec<f64>,
}

/// What all contacts of one equilibrium carry together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// The increment.
    pub increment: u64,
    /// Sum of the magnitudes of the normal forces \[N\].
    pub normal: f64,
    /// Sum of the magnitudes of the tangential forces \[N\].
    pub tangential: f64,
}

/// A measure of one type, to be put into the run that it belongs to.
pub(super) enum Measure {
    State(PackState),
    Walls(WallForces),
    Moduli(Moduli),
    Tangent(Box<Tangent>),
    Network(ContactNetwork),
    Motion(Box<GrainMotion>),
    Fabric(Box<Fabric>),
    Hydrate(Hydrate),
    Shear(ShearState),
    Plane(Box<PlaneState>),
    Cloud(Box<PointCloud2>),
    Cracks(Box<Cracks>),
    Event(Event),
    Rearrangement(Rearrangement),
}

impl Run {
    /// Whether there is nothing to look at.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether it is of discs.
    #[must_use]
    pub fn is_plane(&self) -> bool {
        !self.plane.states.is_empty()
    }

    /// The first and the last increment that anything is known of.
    #[must_use]
    pub fn increments(&self) -> Option<(u64, u64)> {
        let states = self.states.iter().map(|state| state.increment);
        let walls = self.walls.iter().map(|walls| walls.increment);
        let moduli = self.moduli.iter().map(|moduli| moduli.increment);
        let tangents = self.tangents.iter().map(|tangent| tangent.increment);
        let networks = self.loads.iter().map(|load| load.increment);
        let motions = self.motions.whole.iter().map(|motion| motion.increment);
        let fabrics = self.fabrics.iter().map(|fabric| fabric.increment);
        let all = states
            .chain(walls)
            .chain(moduli)
            .chain(tangents)
            .chain(networks)
            .chain(motions)
            .chain(fabrics)
            .chain(self.plane.states.iter().map(|state| state.increment))
            .chain(self.hydrates.iter().map(|hydrate| hydrate.increment))
            .chain(self.shears.iter().map(|shear| shear.increment));
        all.fold(None, |range, at| {
            let (first, last) = range.unwrap_or((at, at));
            Some((first.min(at), last.max(at)))
        })
    }

    /// The equilibria that most is known of.
    pub(super) fn len(&self) -> usize {
        let measured = self.states.len().max(self.walls.len());
        measured
            .max(self.moduli.len())
            .max(self.tangents.len())
            .max(self.loads.len())
            .max(self.motions.whole.len())
            .max(self.fabrics.len())
            .max(self.plane.states.len())
            .max(self.hydrates.len())
            .max(self.shears.len())
    }

    /// Whether `measure` tells of a later run than the measures of its type so far.
    pub(super) fn ends_before(&self, measure: &Measure) -> bool {
        let (last, next, goes_on) = match measure {
            Measure::State(next) => {
                (self.states.last().map(|m| m.increment), next.increment, false)
            }
            Measure::Walls(next) => (self.walls.last().map(|m| m.increment), next.increment, false),
            Measure::Moduli(next) => {
                (self.moduli.last().map(|m| m.increment), next.increment, false)
            }
            Measure::Fabric(next) => {
                (self.fabrics.last().map(|m| m.increment), next.increment, false)
            }
            Measure::Hydrate(next) => {
                (self.hydrates.last().map(|m| m.increment), next.increment, false)
            }
            Measure::Shear(next) => {
                (self.shears.last().map(|m| m.increment), next.increment, false)
            }
            Measure::Plane(next) => {
                (self.plane.states.last().map(|m| m.increment), next.increment, false)
            }
            Measure::Tangent(next) => {
                (self.tangents.last().map(|m| m.increment), next.increment, false)
            }
            Measure::Network(next) => {
                (self.loads.last().map(|m| m.increment), next.increment, next.chunk > 0)
            }
            Measure::Motion(next) => (self.motions.increment(), next.increment, next.chunk > 0),
            Measure::Cracks(next) => (
                self.cement.standing.last().map(|now| now.increment),
                next.increment,
                next.chunk > 0,
            ),
            // They come after the measures of their increment.
            Measure::Event(_) | Measure::Rearrangement(_) | Measure::Cloud(_) => return false,
        };
        last.is_some_and(|last| next < last || (next == 0 && last == 0 && !goes_on))
    }

    pub(super) fn add(&mut self, measure: Measure) {
        match measure {
            Measure::State(state) => self.states.push(state),
            Measure::Walls(walls) => self.walls.push(walls),
            Measure::Moduli(moduli) => self.moduli.push(moduli),
            Measure::Tangent(tangent) => self.tangents.push(*tangent),
            Measure::Network(network) => {
                self.add_network(&network);
                self.plane.add_network(&network);
            }
            Measure::Motion(motion) => self.motions.add(*motion),
            Measure::Fabric(fabric) => self.fabrics.push(*fabric),
            Measure::Hydrate(hydrate) => self.hydrates.push(hydrate),
            Measure::Shear(shear) => self.shears.push(shear),
            Measure::Plane(state) => self.plane.states.push(*state),
            Measure::Cloud(cloud) => self.plane.add_cloud(&cloud),
            Measure::Cracks(cracks) => self.cement.add(&cracks),
            // What broke is drawn by itself.
            Measure::Event(event) if event.kind == EventKind::StressDrop as u8 => {
                self.add_event(event.increment);
            }
            Measure::Event(_) => {}
            Measure::Rearrangement(event) => self.add_rearrangement(&event),
        }
    }

    /// A live network comes in chunks, which follow upon each other.
    fn add_network(&mut self, network: &ContactNetwork) {
        let size = |force: &[f64]| force.iter().map(|part| part * part).sum::<f64>().sqrt();
        let tangential = network.tangential_force.chunks_exact(3).map(size);
        let ContactNetwork { increment, chunk, normal_force, .. } = network;
        let (increment, chunk) = (*increment, *chunk);
        // Where cement broke there may be no contact.
        let carries = normal_force.iter().copied().zip(tangential).filter(|of| *of != (0.0, 0.0));
        let (normal, tangential) = carries.unzip();
        let forces = Forces { increment, normal, tangential };
        self.add_load(&forces, chunk);
        let Some([first, last]) = &mut self.networks else {
            self.networks = Some([forces.clone(), forces]);
            return;
        };
        if chunk == 0 || last.increment != increment {
            *last = forces;
        } else {
            if first == last {
                first.extend(&forces);
            }
            last.extend(&forces);
        }
    }

    fn add_event(&mut self, increment: u64) {
        if self.eventful.last() != Some(&increment) {
            self.eventful.push(increment);
        }
    }

    /// Every chunk tells the energies.
    fn add_rearrangement(&mut self, event: &Rearrangement) {
        if event.chunk > 0 {
            return;
        }
        let energy = event.energy_before - event.energy_after;
        match self.released.last_mut() {
            Some((last, released)) if *last == event.increment => *released += energy,
            _ => self.released.push((event.increment, energy)),
        }
    }

    fn add_load(&mut self, forces: &Forces, chunk: u32) {
        let increment = forces.increment;
        let normal = forces.normal.iter().map(|force| force.abs()).sum();
        let tangential = forces.tangential.iter().sum();
        match self.loads.last_mut() {
            Some(last) if chunk > 0 && last.increment == increment => {
                last.normal += normal;
                last.tangential += tangential;
            }
            _ => self.loads.push(Load { increment, normal, tangential }),
        }
    }
}

impl Forces {
    fn extend(&mut self, more: &Self) {
        self.normal.extend(&more.normal);
        self.tangential.extend(&more.tangential);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn network(increment: u64, chunk: u32, tangential: [f64; 3]) -> ContactNetwork {
        ContactNetwork {
            increment,
            chunk,
            chunk_count: 2,
            normal_force: vec![7.0],
            tangential_force: tangential.to_vec(),
            ..ContactNetwork::default()
        }
    }

    #[test]
    fn chunks_of_one_equilibrium_make_one_load_and_one_network() {
        let mut run = Run::default();
        run.add_network(&network(4, 0, [3.0, 0.0, 4.0]));
        run.add_network(&network(4, 1, [0.0, -2.0, 0.0]));
        run.add_network(&network(5, 0, [0.0; 3]));
        assert_eq!(
            run.loads,
            [
                Load { increment: 4, normal: 14.0, tangential: 7.0 },
                Load { increment: 5, normal: 7.0, tangential: 0.0 },
            ]
        );
        let [first, last] = run.networks.unwrap_or_default();
        assert_eq!((first.normal, first.tangential), (vec![7.0; 2], vec![5.0, 2.0]));
        assert_eq!((last.normal, last.tangential), (vec![7.0], vec![0.0]));
    }

    #[test]
    fn events_of_one_increment_are_marked_once_and_their_energies_added() {
        let mut run = Run::default();
        let event = |increment| Measure::Event(Event { increment, ..Event::default() });
        let moved = |increment, chunk, energy_before| {
            let event = Rearrangement { increment, chunk, energy_before, ..Default::default() };
            Measure::Rearrangement(event)
        };
        for measure in [event(2), event(2), moved(2, 0, 3.0), moved(2, 1, 3.0), moved(2, 0, 0.5)] {
            assert!(!run.ends_before(&measure));
            run.add(measure);
        }
        run.add(event(7));
        run.add(moved(7, 0, 2.0));
        assert_eq!(run.eventful, [2, 7]);
        assert_eq!(run.released, [(2, 3.5), (7, 2.0)]);
    }

    #[test]
    fn a_second_start_is_another_run_and_a_second_chunk_is_not() {
        let mut run = Run::default();
        let start = || Measure::State(PackState::default());
        assert!(!run.ends_before(&start()));
        run.add(start());
        assert!(run.ends_before(&start()));
        run.add(Measure::Network(network(0, 0, [0.0; 3])));
        assert!(!run.ends_before(&Measure::Network(network(0, 1, [0.0; 3]))));
        assert!(run.ends_before(&Measure::Network(network(0, 0, [0.0; 3]))));
        run.add(Measure::State(PackState { increment: 3, ..PackState::default() }));
        assert!(
            run.ends_before(&Measure::State(PackState { increment: 2, ..PackState::default() }))
        );
        assert!(
            !run.ends_before(&Measure::State(PackState { increment: 7, ..PackState::default() }))
        );
    }
}
