//! The contact network as it is published: in the order of the pack file.

use crate::contact::Other;
use crate::measure::contacts::Contact;
use crate::model::Model;
use crate::report::{ContactNetwork, ContactState};
use crate::state::Condition;

/// Lists `counted` contacts by grain index of the pack file, the smaller one first.
#[must_use]
pub fn network<'a>(model: &Model, counted: impl Iterator<Item = &'a Contact>) -> ContactNetwork {
    let rows: Vec<Row<'_>> = counted.map(|contact| Row::of(contact, &model.order)).collect();
    let rows = sorted(rows, model.order.len());
    let count = rows.len();
    let mut network = ContactNetwork {
        first: Vec::with_capacity(count),
        second: Vec::with_capacity(count),
        normal: Vec::with_capacity(3 * count),
        normal_force: Vec::with_capacity(count),
        tangential_force: Vec::with_capacity(3 * count),
        overlap: Vec::with_capacity(count),
        state: Vec::with_capacity(count),
    };
    for Row { first, second, sign, contact } in rows {
        network.first.push(first);
        network.second.push(second);
        network.normal.extend_from_slice((contact.normal * sign).as_slice());
        network.normal_force.push(contact.force);
        network.tangential_force.extend_from_slice((contact.shear * sign).as_slice());
        network.overlap.push(contact.overlap);
        network.state.push(state(contact) as u8);
    }
    network
}

/// A contact as the pack file counts its bodies.
#[derive(Clone, Copy)]
struct Row<'a> {
    first: u32,
    second: u32,
    /// -1 where the solver's order is the other way round.
    sign: f64,
    contact: &'a Contact,
}

impl<'a> Row<'a> {
    fn of(contact: &'a Contact, order: &[u32]) -> Self {
        let first = order[contact.first as usize];
        let (second, sign) = match contact.second {
            Other::Wall(w) => (u32::MAX - u32::from(w), 1.0),
            Other::Grain(j) => {
                let second = order[j as usize];
                (second, if first < second { 1.0 } else { -1.0 })
            }
        };
        Self { first: first.min(second), second: first.max(second), sign, contact }
    }
}

/// The rows by first and second body: counted out to the first ones, which few share, then sorted.
fn sorted(rows: Vec<Row<'_>>, grains: usize) -> Vec<Row<'_>> {
    let mut end = vec![0_usize; grains + 1];
    for row in &rows {
        end[row.first as usize + 1] += 1;
    }
    for k in 0..grains {
        end[k + 1] += end[k];
    }
    let mut next = end.clone();
    let mut placed = rows.clone();
    for row in rows {
        let place = &mut next[row.first as usize];
        placed[*place] = row;
        *place += 1;
    }
    for bounds in end.windows(2) {
        placed[bounds[0]..bounds[1]].sort_unstable_by_key(|row| row.second);
    }
    placed
}

fn state(contact: &Contact) -> ContactState {
    match contact.cement {
        Some(Condition::Intact) => ContactState::Bonded,
        Some(Condition::Broken(_)) => ContactState::Broken,
        _ if contact.slides => ContactState::Slide,
        _ => ContactState::Stick,
    }
}
