//! What a recording tells of discs: their states, and pictures of the first and the last equilibrium
//! of which it holds both the grains and the contacts.

pub(in crate::view) mod grains;

use std::collections::HashMap;

use crate::msg::picture::PointField;
use crate::msg::{ContactNetwork, PlaneState, PointCloud2};
use grains::Contacts;

/// The discs of one run.
#[derive(Debug, Default)]
pub struct Plane {
    /// Increment by increment; empty for spheres.
    pub states: Vec<PlaneState>,
    /// What their contacts are made of, when the recording tells it.
    pub contacts: Option<Contacts>,
    /// The first and the last picture, which may be the same.
    pub pictures: Option<[Picture; 2]>,
    /// The last network, whole.
    network: ContactNetwork,
}

/// Grains and contacts of one equilibrium, in the order of the pack file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Every contact.
    pub network: ContactNetwork,
    /// The grains.
    pub grains: Vec<Disc>,
}

/// A grain, in the lengths of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disc {
    /// Its centre.
    pub at: [f64; 2],
    /// Its radius.
    pub radius: f64,
    /// Its turn to the left \[rad\]; NaN where the recording does not tell.
    pub turn: f64,
}

impl Plane {
    pub(in crate::view) fn add_network(&mut self, network: &ContactNetwork) {
        if network.chunk == 0 || network.increment != self.network.increment {
            self.network = network.clone();
            return;
        }
        let whole = &mut self.network;
        whole.first.extend(&network.first);
        whole.second.extend(&network.second);
        whole.normal.extend(&network.normal);
        whole.normal_force.extend(&network.normal_force);
        whole.tangential_force.extend(&network.tangential_force);
        whole.overlap.extend(&network.overlap);
        whole.state.extend(&network.state);
    }

    /// Takes the grains of the equilibrium whose network came before; of spheres nothing is kept.
    pub(in crate::view) fn add_cloud(&mut self, cloud: &PointCloud2) {
        let stamp = &self.network.header.stamp;
        if self.states.is_empty() || cloud.header.stamp != *stamp {
            return;
        }
        let picture = Picture { network: self.network.clone(), grains: discs(cloud) };
        match &mut self.pictures {
            Some([_, last]) => *last = picture,
            None => self.pictures = Some([picture.clone(), picture]),
        }
    }
}

/// The points of `cloud`; none when it is not one of the twin's.
fn discs(cloud: &PointCloud2) -> Vec<Disc> {
    let floats = cloud.fields.iter().filter(|field| field.datatype == PointField::FLOAT32);
    let places: HashMap<&str, usize> =
        floats.map(|field| (field.name.as_str(), field.offset as usize)).collect();
    let step = (cloud.point_step as usize).max(1);
    let disc = |point: &[u8]| {
        let number = |name: &str| {
            let place = *places.get(name)?;
            let bytes = point.get(place..place + 4)?;
            Some(f64::from(f32::from_le_bytes(bytes.try_into().ok()?)))
        };
        let at = [number("x")?, number("y")?];
        Some(Disc { at, radius: number("radius")?, turn: number("turn").unwrap_or(f64::NAN) })
    };
    cloud.data.chunks_exact(step).map(disc).collect::<Option<_>>().unwrap_or_default()
}
