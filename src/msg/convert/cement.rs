//! Bonds and cracks as messages.

use super::pack_header;
use crate::msg::{Bonds, Cracks};
use crate::report::{Crack, Measures};

/// Most bonds in one live [`Bonds`], and most cracks in one live [`Cracks`]: 53 KB, what one sample
/// can carry without losses over a stock receive buffer.
pub const LIVE_BONDS: usize = 440;

/// The bonds in one message, as recordings hold them; `None` when they were not asked for.
#[must_use]
pub fn whole_bonds(measures: &Measures) -> Option<Bonds> {
    bond_chunks(measures, usize::MAX).next()
}

/// The bonds in messages of at most `most` each; one empty message when there is no bond, none when
/// they were not asked for.
pub fn bond_chunks(measures: &Measures, most: usize) -> impl Iterator<Item = Bonds> + '_ {
    measures.bonds.iter().flat_map(move |bonds| {
        chunks(bonds.first.len(), most).map(move |(chunk, chunk_count, range)| {
            let triples = 3 * range.start..3 * range.end;
            Bonds {
                header: pack_header(measures.stamp),
                increment: measures.increment,
                chunk,
                chunk_count,
                tensile_strength: bonds.tensile_strength,
                shear_strength: bonds.shear_strength,
                first: bonds.first[range.clone()].to_vec(),
                second: bonds.second[range.clone()].to_vec(),
                condition: bonds.condition[range.clone()].to_vec(),
                share: bonds.share[range.clone()].to_vec(),
                radius: bonds.radius[range.clone()].to_vec(),
                position: bonds.position[triples.clone()].to_vec(),
                normal: bonds.normal[triples.clone()].to_vec(),
                normal_force: bonds.normal_force[range.clone()].to_vec(),
                tangential_force: bonds.tangential_force[triples].to_vec(),
                torsion: bonds.torsion[range.clone()].to_vec(),
                strength_use: bonds.strength_use[range].to_vec(),
            }
        })
    })
}

/// The cracks in one message, as recordings hold them; `None` when they were not asked for.
#[must_use]
pub fn whole_cracks(measures: &Measures) -> Option<Cracks> {
    crack_chunks(measures, usize::MAX).next()
}

/// The cracks in messages of at most `most` each; one message when there is none, and none when they
/// were not asked for.
pub fn crack_chunks(measures: &Measures, most: usize) -> impl Iterator<Item = Cracks> + '_ {
    measures.cracks.iter().flat_map(move |cracks| {
        chunks(cracks.list.len(), most).map(move |(chunk, chunk_count, range)| {
            let list = &cracks.list[range];
            let triples = |of: fn(&Crack) -> [f64; 3]| list.iter().flat_map(of).collect();
            let numbers = |of: fn(&Crack) -> f64| list.iter().map(of).collect();
            Cracks {
                header: pack_header(measures.stamp),
                increment: measures.increment,
                chunk,
                chunk_count,
                intact: cracks.intact,
                broken_by_tension: cracks.tension,
                broken_by_shear: cracks.shear,
                first: list.iter().map(|crack| crack.first).collect(),
                second: list.iter().map(|crack| crack.second).collect(),
                mode: list.iter().map(|crack| crack.mode as u8).collect(),
                substep: list.iter().map(|crack| crack.substep).collect(),
                position: triples(|crack| crack.position),
                normal: triples(|crack| crack.normal),
                normal_force: numbers(|crack| crack.normal_force),
                tangential_force: numbers(|crack| crack.tangential_force),
                torsion: numbers(|crack| crack.torsion),
                overload: numbers(|crack| crack.overload),
                stress_before: numbers(|crack| crack.stress_before),
                stress_after: numbers(|crack| crack.stress_after),
                energy_released: numbers(|crack| crack.energy_released),
            }
        })
    })
}

/// The number of each chunk, how many there are, and which entries of `length` it has.
fn chunks(length: usize, most: usize) -> impl Iterator<Item = (u32, u32, std::ops::Range<usize>)> {
    let most = most.clamp(1, length.max(1));
    let count = length.div_ceil(most).max(1);
    (0..count).map(move |chunk| {
        let range = chunk * most..((chunk + 1) * most).min(length);
        (chunk as u32, count as u32, range)
    })
}
