//! Force chains against a search of the graph, on networks of all kinds.

use std::collections::BTreeSet;

use graintwin::Vec3;
use graintwin::contact::Other;
use graintwin::measure::contacts::Contact;
use graintwin::measure::fabric::chains::chains;
use proptest::prelude::*;

const GRAINS: u32 = 16;

fn contact(first: u32, second: Other, force: f64) -> Contact {
    Contact {
        first,
        second,
        normal: Vec3::x(),
        force,
        overlap: 0.0,
        shear: Vec3::zeros(),
        torsion: 0.0,
        slides: false,
        slipped: false,
        distance: 1.0,
        cement: None,
    }
}

/// Contacts of few forces, so that many are equal.
fn network() -> impl Strategy<Value = Vec<Contact>> {
    let second = prop_oneof![
        4 => (1..GRAINS).prop_map(Other::Grain),
        1 => (0..6_u8).prop_map(Other::Wall),
    ];
    let one = (0..GRAINS, second, 1..20_u32).prop_map(|(first, second, force)| {
        let second = match second {
            // Another grain than the first.
            Other::Grain(step) => Other::Grain((first + step) % GRAINS),
            wall => wall,
        };
        contact(first, second, f64::from(force))
    });
    prop::collection::vec(one, 0..40)
}

/// Grains that `contacts` reach from `start`, which is among them.
fn reached(start: u32, contacts: &[&Contact]) -> BTreeSet<u32> {
    let mut reached = BTreeSet::from([start]);
    loop {
        let before = reached.len();
        for contact in contacts {
            if let Other::Grain(second) = contact.second
                && (reached.contains(&contact.first) || reached.contains(&second))
            {
                reached.extend([contact.first, second]);
            }
        }
        if reached.len() == before {
            return reached;
        }
    }
}

/// The grains of each part of the network.
fn parts(contacts: &[&Contact]) -> BTreeSet<BTreeSet<u32>> {
    let ends = contacts.iter().flat_map(|contact| match contact.second {
        Other::Grain(second) => vec![contact.first, second],
        Other::Wall(_) => vec![contact.first],
    });
    ends.map(|grain| reached(grain, contacts)).collect()
}

/// Whether grains connect the walls across an axis.
fn connects(contacts: &[&Contact], axis: u8) -> bool {
    let touches = |part: &BTreeSet<u32>, wall: u8| {
        contacts.iter().any(|one| one.second == Other::Wall(wall) && part.contains(&one.first))
    };
    parts(contacts).iter().any(|part| touches(part, 2 * axis) && touches(part, 2 * axis + 1))
}

proptest! {
    #[test]
    fn chains_are_what_a_search_of_the_graph_finds(
        contacts in network(),
        share in prop_oneof![0.01..1.0, Just(1.0)],
    ) {
        let all: Vec<&Contact> = contacts.iter().collect();
        let found = chains(GRAINS as usize, &all, share);
        if all.is_empty() {
            prop_assert_eq!((found.contacts, found.count, found.threshold), (0, 0, 0.0));
            return Ok(());
        }
        // The threshold leaves fewer than the share above it, and at least the share from it on.
        let wanted = ((share * all.len() as f64).round() as usize).max(1);
        let members: Vec<&Contact> =
            all.iter().copied().filter(|one| one.force >= found.threshold).collect();
        let above = all.iter().filter(|one| one.force > found.threshold).count();
        prop_assert!(above < wanted && wanted <= members.len());
        prop_assert_eq!(found.contacts as usize, members.len());

        let parts = parts(&members);
        prop_assert_eq!(found.count as usize, parts.len());
        prop_assert_eq!(found.grains as usize, parts.iter().map(BTreeSet::len).sum::<usize>());
        prop_assert_eq!(found.largest as usize, parts.iter().map(BTreeSet::len).max().unwrap());
        for axis in 0..3 {
            let at = usize::from(axis);
            prop_assert_eq!(found.spans[at], connects(&members, axis));
            let strongest = all.iter().map(|one| one.force).filter(|least| {
                let left: Vec<&Contact> =
                    all.iter().copied().filter(|one| one.force >= *least).collect();
                connects(&left, axis)
            });
            prop_assert_eq!(found.strongest_path[at], strongest.fold(0.0, f64::max));
        }
    }

    #[test]
    fn the_order_of_the_contacts_does_not_matter(
        (contacts, shuffled) in network().prop_flat_map(|all| (Just(all.clone()), Just(all).prop_shuffle())),
    ) {
        let of = |contacts: &[Contact]| {
            chains(GRAINS as usize, &contacts.iter().collect::<Vec<_>>(), 0.3)
        };
        // Without a contact the load is NaN; its bits are compared as well.
        prop_assert_eq!(format!("{:?}", of(&contacts)), format!("{:?}", of(&shuffled)));
    }
}
