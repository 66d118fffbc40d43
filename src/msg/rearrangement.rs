//! The messages of `graintwin_msgs` that tell of an event in full.

use serde::{Deserialize, Serialize};

use super::convert::pack_header;
use super::schema::describe;
use super::standard::Header;
use crate::report::{self, Measures};
use crate::wall;

/// Most grains, and most contacts lost and made, in one live [`Rearrangement`]: together 45 KB,
/// what one sample can carry without losses over a stock receive buffer.
pub const LIVE_GRAINS: usize = 400;
/// See [`LIVE_GRAINS`].
pub const LIVE_CONTACTS: usize = 1500;

/// What an event did: all of it, or a chunk.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rearrangement {
    /// Stamp of the command served.
    pub header: Header,
    /// The increment in which it happened.
    pub increment: u64,
    /// Number of the event in its increment, from 0.
    pub event: u32,
    /// Number of this chunk, from 0.
    pub chunk: u32,
    /// Chunks of this event, at least 1.
    pub chunk_count: u32,
    /// 0 stress drop, 1 broken contact.
    pub kind: u8,
    /// Confining stress where stability was lost \[Pa\].
    pub stress_before: f64,
    /// Confining stress at the equilibrium that followed \[Pa\].
    pub stress_after: f64,
    /// Stored energy and slip where stability was lost \[J\].
    pub energy_before: f64,
    /// The same at the equilibrium that followed \[J\].
    pub energy_after: f64,
    /// Grains that jumped.
    pub grains: Vec<u32>,
    /// Way of each of them, three numbers a grain \[m\].
    pub displacement: Vec<f64>,
    /// Rotation of each of them, three numbers a grain \[rad\]; empty without friction.
    pub rotation: Vec<f64>,
    /// First bodies of the contacts lost.
    pub lost_first: Vec<u32>,
    /// Second bodies of the contacts lost, `u32::MAX - w` for wall w.
    pub lost_second: Vec<u32>,
    /// First bodies of the contacts made.
    pub made_first: Vec<u32>,
    /// Second bodies of the contacts made.
    pub made_second: Vec<u32>,
}

/// Where all grains were before or after an event.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Stamp of the command served.
    pub header: Header,
    /// The increment in which the event happened.
    pub increment: u64,
    /// Number of the event in its increment, from 0.
    pub event: u32,
    /// An [`EventEnd`](report::EventEnd) as a number.
    pub when: u8,
    /// Position of each wall along its own axis \[m\].
    pub wall_position: [f64; wall::COUNT],
    /// Centres of all grains, three numbers a grain \[m\].
    pub position: Vec<f64>,
    /// Rotations of all grains, three numbers a grain \[rad\]; empty without friction.
    pub rotation: Vec<f64>,
}

describe!(
    Rearrangement,
    "graintwin_msgs",
    include_str!("../../msgs/graintwin_msgs/msg/Rearrangement.msg"),
    &[Header::TYPE],
    "4c32eaaad6a12a54a05683d2699fa26e6cb8f13ecd10b22a01d9f4a278a23ffb"
);
describe!(
    Snapshot,
    "graintwin_msgs",
    include_str!("../../msgs/graintwin_msgs/msg/Snapshot.msg"),
    &[Header::TYPE],
    "28c23ff7f507b842c87cdd948cbf72aeb2e71418fec94b17b020b2a813f586b2"
);

/// The events of this increment in one message each, as recordings hold them.
pub fn whole(measures: &Measures) -> impl Iterator<Item = Rearrangement> + '_ {
    chunks(measures, usize::MAX, usize::MAX)
}

/// The events of this increment in messages of at most so many grains, contacts lost and contacts
/// made.
pub fn chunks(
    measures: &Measures,
    most_grains: usize,
    most_contacts: usize,
) -> impl Iterator<Item = Rearrangement> + '_ {
    (measures.rearrangements.iter().zip(0..)).flat_map(move |(event, number)| {
        let report::Rearrangement { grains, displacement, rotation, lost, made, .. } = event;
        let parts = |length: usize, most: usize| length.div_ceil(most.max(1));
        let count = parts(grains.len(), most_grains)
            .max(parts(lost.len().max(made.len()), most_contacts))
            .max(1);
        (0..count).map(move |chunk| {
            let [lost_first, lost_second] = bodies(part(lost, chunk, most_contacts));
            let [made_first, made_second] = bodies(part(made, chunk, most_contacts));
            Rearrangement {
                header: pack_header(measures.stamp),
                increment: measures.increment,
                event: number,
                chunk: chunk as u32,
                chunk_count: count as u32,
                kind: event.kind as u8,
                stress_before: event.stress_before,
                stress_after: event.stress_after,
                energy_before: event.energy_before,
                energy_after: event.energy_after,
                grains: part(grains, chunk, most_grains).to_vec(),
                displacement: part(displacement, chunk, most_grains).as_flattened().to_vec(),
                rotation: part(rotation, chunk, most_grains).as_flattened().to_vec(),
                lost_first,
                lost_second,
                made_first,
                made_second,
            }
        })
    })
}

/// Entries of `list` in its part number `chunk`, of `most` entries each; the last ones are empty.
fn part<T>(list: &[T], chunk: usize, most: usize) -> &[T] {
    let start = chunk.saturating_mul(most).min(list.len());
    &list[start..start.saturating_add(most).min(list.len())]
}

fn bodies(pairs: &[[u32; 2]]) -> [Vec<u32>; 2] {
    [0, 1].map(|body| pairs.iter().map(|pair| pair[body]).collect())
}

/// Where all grains were before and after each event of this increment.
pub fn snapshots(measures: &Measures) -> impl Iterator<Item = Snapshot> + '_ {
    measures.snapshots.iter().map(|snapshot| Snapshot {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        event: snapshot.event,
        when: snapshot.end as u8,
        wall_position: snapshot.wall_position,
        position: snapshot.position.as_flattened().to_vec(),
        rotation: snapshot.rotation.as_flattened().to_vec(),
    })
}
