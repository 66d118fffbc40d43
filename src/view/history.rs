//! What a bag tells of a run.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::msg::cdr;
use crate::msg::{ContactNetwork, Described, Moduli, PackState, WallForces};
use crate::record::reader::{Bag, Message, ReadError};

/// The measures in a bag, in its order.
#[derive(Debug, Default)]
pub struct History {
    /// Name of the scene, when the bag says it.
    pub scene: Option<String>,
    /// The pack as a whole.
    pub states: Vec<PackState>,
    /// The walls.
    pub walls: Vec<WallForces>,
    /// The moduli.
    pub moduli: Vec<Moduli>,
    /// The forces of the first and of the last contact network, which may be the same.
    pub networks: Option<[Forces; 2]>,
    /// What the contacts of each network carry together.
    pub loads: Vec<Load>,
    /// Topics that were passed over, and why.
    pub passed_over: BTreeSet<String>,
    /// Messages that are not what their topic says.
    pub unreadable: u64,
    /// Where the bag stops making sense; all the rest is what was read before that.
    pub damage: Option<ReadError>,
    sources: BTreeMap<&'static str, Source>,
}

/// Where the messages of a type come from.
#[derive(Debug)]
struct Source {
    topic: String,
    /// Whether they can be understood.
    fits: bool,
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
    /// Sum of the normal forces \[N\].
    pub normal: f64,
    /// Sum of the magnitudes of the tangential forces \[N\].
    pub tangential: f64,
}

impl Forces {
    fn extend(&mut self, more: &Self) {
        self.normal.extend(&more.normal);
        self.tangential.extend(&more.tangential);
    }
}

/// What is read of a scene; it may be of another version.
#[derive(Deserialize)]
struct Named {
    name: String,
}

impl History {
    /// Reads all of `bag`, up to the damage if there is any.
    ///
    /// # Errors
    /// When the system cannot read it.
    pub fn read(bag: &Bag) -> Result<Self, ReadError> {
        let mut history = Self { scene: scene_name(bag), ..Self::default() };
        for message in bag.messages() {
            match message {
                Ok(message) => history.add(&message),
                Err(damage @ ReadError::Damaged { .. }) => history.damage = Some(damage),
                Err(error) => return Err(error),
            }
        }
        Ok(history)
    }

    /// Whether there is nothing to look at.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
            && self.walls.is_empty()
            && self.moduli.is_empty()
            && self.networks.is_none()
    }

    /// The first and the last increment that anything is known of.
    #[must_use]
    pub fn increments(&self) -> Option<(u64, u64)> {
        let states = self.states.iter().map(|state| state.increment);
        let walls = self.walls.iter().map(|walls| walls.increment);
        let moduli = self.moduli.iter().map(|moduli| moduli.increment);
        let networks = self.networks.iter().flatten().map(|forces| forces.increment);
        let all = states.chain(walls).chain(moduli).chain(networks);
        all.fold(None, |range, at| {
            let (first, last) = range.unwrap_or((at, at));
            Some((first.min(at), last.max(at)))
        })
    }

    fn add(&mut self, message: &Message) {
        if let Some(state) = self.decode::<PackState>(message) {
            self.states.push(state);
        } else if let Some(walls) = self.decode::<WallForces>(message) {
            self.walls.push(walls);
        } else if let Some(moduli) = self.decode::<Moduli>(message) {
            self.moduli.push(moduli);
        } else if let Some(network) = self.decode::<ContactNetwork>(message) {
            self.add_network(network);
        }
    }

    /// A live network comes in chunks, which follow upon each other.
    fn add_network(&mut self, network: ContactNetwork) {
        let size = |force: &[f64]| force.iter().map(|part| part * part).sum::<f64>().sqrt();
        let tangential = network.tangential_force.chunks_exact(3).map(size).collect();
        let ContactNetwork { increment, chunk, normal_force: normal, .. } = network;
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

    fn add_load(&mut self, forces: &Forces, chunk: u32) {
        let increment = forces.increment;
        let (normal, tangential) = (forces.normal.iter().sum(), forces.tangential.iter().sum());
        match self.loads.last_mut() {
            Some(last) if chunk > 0 && last.increment == increment => {
                last.normal += normal;
                last.tangential += tangential;
            }
            _ => self.loads.push(Load { increment, normal, tangential }),
        }
    }

    /// The message as a `T`, if it comes on the topic of that type.
    fn decode<T: Described + DeserializeOwned>(&mut self, message: &Message) -> Option<T> {
        let channel = &message.channel;
        if !channel.has_type(T::TYPE) {
            return None;
        }
        let topic = &channel.topic;
        let fits = || channel.encoding == "cdr" && channel.has_fields(T::TYPE);
        let source = self.sources.entry(T::TYPE.name);
        let source = source.or_insert_with(|| Source { topic: topic.clone(), fits: fits() });
        if source.topic != *topic {
            let first = &source.topic;
            self.passed_over.insert(format!("{topic}: {first} has the same type and came first"));
            return None;
        }
        if !source.fits {
            let kind = T::TYPE.full_name();
            self.passed_over.insert(format!("{topic}: it has another definition of {kind}"));
            return None;
        }
        let decoded = cdr::decode(&message.data);
        self.unreadable += u64::from(decoded.is_err());
        decoded.ok()
    }
}

/// Nothing when the bag is not one of this program's, or is damaged before it.
fn scene_name(bag: &Bag) -> Option<String> {
    let text = bag.attachment("scene.yaml").ok()??;
    let scene: Named = serde_saphyr::from_str(std::str::from_utf8(&text).ok()?).ok()?;
    Some(scene.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_of_one_equilibrium_make_one_load() {
        let network = |increment: u64, chunk: u32, tangential: [f64; 3]| ContactNetwork {
            increment,
            chunk,
            chunk_count: 2,
            normal_force: vec![7.0],
            tangential_force: tangential.to_vec(),
            ..ContactNetwork::default()
        };
        let mut history = History::default();
        history.add_network(network(4, 0, [3.0, 0.0, 4.0]));
        history.add_network(network(4, 1, [0.0, -2.0, 0.0]));
        history.add_network(network(5, 0, [0.0; 3]));
        assert_eq!(
            history.loads,
            [
                Load { increment: 4, normal: 14.0, tangential: 7.0 },
                Load { increment: 5, normal: 7.0, tangential: 0.0 },
            ]
        );
    }
}
