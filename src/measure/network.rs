//! The contact network as it is published: in the order of the pack file.

use crate::contact::Other;
use crate::measure::contacts::Contact;
use crate::model::Model;
use crate::report::{ContactNetwork, ContactState};

/// Lists `counted` contacts by grain index of the pack file, the smaller one first.
#[must_use]
pub fn network<'a>(model: &Model, counted: impl Iterator<Item = &'a Contact>) -> ContactNetwork {
    let mut rows: Vec<(u32, u32, f64, &Contact)> = counted
        .map(|contact| {
            let first = model.order[contact.first as usize];
            match contact.second {
                Other::Wall(w) => (first, u32::MAX - u32::from(w), 1.0, contact),
                Other::Grain(j) => {
                    let second = model.order[j as usize];
                    if first < second {
                        (first, second, 1.0, contact)
                    } else {
                        (second, first, -1.0, contact)
                    }
                }
            }
        })
        .collect();
    rows.sort_unstable_by_key(|&(first, second, ..)| (first, second));
    ContactNetwork {
        first: rows.iter().map(|row| row.0).collect(),
        second: rows.iter().map(|row| row.1).collect(),
        normal: rows.iter().flat_map(|row| <[f64; 3]>::from(row.3.normal * row.2)).collect(),
        normal_force: rows.iter().map(|row| row.3.force).collect(),
        tangential_force: rows
            .iter()
            .flat_map(|row| <[f64; 3]>::from(row.3.shear * row.2))
            .collect(),
        overlap: rows.iter().map(|row| row.3.overlap).collect(),
        state: rows.iter().map(|row| state(row.3) as u8).collect(),
    }
}

fn state(contact: &Contact) -> ContactState {
    if contact.slides { ContactState::Slide } else { ContactState::Stick }
}
