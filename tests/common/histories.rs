//! Contact histories that no solver made.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use graintwin::pack::{ContactMemory, History, Layer};
use proptest::prelude::*;

/// Numbers of every size and sign that a double can be.
pub(crate) fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        (-1.0..1.0_f64, -300.0..300.0_f64).prop_map(|(share, power)| share * 10_f64.powf(power)),
        Just(0.0),
        Just(-0.0),
        Just(f64::MIN_POSITIVE / 8.0),
        Just(-f64::MAX),
    ]
}

fn layers() -> impl Strategy<Value = Vec<Layer>> {
    let direction = prop::array::uniform3(-0.57..0.57_f64);
    let layer = (1e-12..1e-6_f64, prop_oneof![direction, Just([0.0, -0.0, 1.0])]);
    prop::collection::vec(layer, 0..5).prop_map(|layers| {
        let mut reach = 0.0;
        let layer = |(depth, ratio)| {
            reach += depth;
            Layer { reach, ratio }
        };
        layers.into_iter().map(layer).collect()
    })
}

/// Histories that fit a pack of `grains` grains.
pub(crate) fn history(grains: u32) -> impl Strategy<Value = History> {
    let rotation = prop::collection::vec(prop::array::uniform3(number()), grains as usize);
    let pair = (0..grains, 0..grains + 6).prop_filter_map("one body", move |(a, b)| match b {
        wall if wall >= grains => Some((a, u32::MAX - (wall - grains))),
        grain if grain == a => None,
        grain => Some((a.min(grain), a.max(grain))),
    });
    let load = (prop::array::uniform3(number()), number(), any::<bool>(), layers());
    let contacts = prop::collection::btree_map(pair, load, 0..40);
    (rotation, contacts).prop_map(|(rotation, contacts)| {
        let contact = |((first, second), (shear, torsion, sliding, layers))| ContactMemory {
            first,
            second,
            shear,
            torsion,
            sliding,
            layers,
        };
        History {
            rotation,
            contacts: contacts.into_iter().map(contact).collect(),
            bonds: Vec::new(),
        }
    })
}

/// All that a history holds, to the bit.
pub(crate) fn bits(history: &History) -> Vec<u64> {
    let vector = |v: &[f64; 3]| v.map(f64::to_bits);
    let mut bits: Vec<u64> = history.rotation.iter().flat_map(vector).collect();
    for contact in &history.contacts {
        bits.extend([contact.first, contact.second, u32::from(contact.sliding)].map(u64::from));
        bits.extend(vector(&contact.shear));
        bits.push(contact.torsion.to_bits());
        bits.push(contact.layers.len() as u64);
        for layer in &contact.layers {
            bits.push(layer.reach.to_bits());
            bits.extend(vector(&layer.ratio));
        }
    }
    bits
}
