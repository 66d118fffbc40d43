//! Force chains: the largest normal forces and what they connect (T 2.7.4.1).

use crate::contact::Other;
use crate::measure::contacts::Contact;
use crate::report::Chains;
use crate::wall;

/// The network of the `share` of `contacts` with the largest normal forces, in a pack of `grains`
/// grains.
#[must_use]
pub fn chains(grains: usize, contacts: &[&Contact], share: f64) -> Chains {
    let wanted = ((share * contacts.len() as f64).round() as usize).max(1);
    let mut order = Descending::new(contacts, wanted);
    let mut sets = Sets::new(grains);
    let (mut threshold, mut load) = (0.0, 0.0);
    let mut strongest_path = [0.0; 3];
    let mut network = None;
    for place in 0..contacts.len() {
        let contact = order.at(place);
        if network.is_none() {
            if place >= wanted && contact.force < threshold {
                network = Some((Network::of(&sets), place));
            } else {
                load += contact.force;
            }
        }
        if network.is_some() && strongest_path.iter().all(|path| *path > 0.0) {
            // The smaller forces tell nothing more.
            break;
        }
        let walls = sets.add(contact);
        for (axis, path) in strongest_path.iter_mut().enumerate() {
            if *path == 0.0 && joins(walls, axis) {
                *path = contact.force;
            }
        }
        if place + 1 == wanted {
            threshold = contact.force;
        }
    }
    let (network, members) = network.unwrap_or_else(|| (Network::of(&sets), contacts.len()));
    let all: f64 = contacts.iter().map(|contact| contact.force).sum();
    Chains {
        share,
        threshold,
        contacts: members as u32,
        grains: network.grains,
        count: network.chains,
        largest: network.largest,
        load: if members > 0 { load / all } else { f64::NAN },
        spans: strongest_path.map(|path| members > 0 && path >= threshold),
        strongest_path,
    }
}

/// Contacts from the largest force down, sorted no further than is asked: walls are connected long
/// before the smallest forces. The order of equal forces bears on nothing here.
struct Descending<'a> {
    contacts: &'a [&'a Contact],
    /// Force and place among `contacts`.
    forces: Vec<(f64, u32)>,
    /// How many of them are in order, and how many shall be at first.
    sorted: usize,
    first: usize,
}

impl<'a> Descending<'a> {
    fn new(contacts: &'a [&'a Contact], wanted: usize) -> Self {
        let forces = contacts.iter().zip(0..).map(|(contact, place)| (contact.force, place));
        let first = wanted.max(contacts.len() / 4) + 1;
        Self { contacts, forces: forces.collect(), sorted: 0, first }
    }

    /// The contact at `place`; places are asked for one after the other.
    fn at(&mut self, place: usize) -> &'a Contact {
        if place == self.sorted {
            let descending = |a: &(f64, u32), b: &(f64, u32)| b.0.total_cmp(&a.0);
            let count = self.first.max(self.sorted);
            let rest = &mut self.forces[self.sorted..];
            if count < rest.len() {
                rest.select_nth_unstable_by(count, descending);
            }
            let count = count.min(rest.len());
            rest[..count].sort_unstable_by(descending);
            self.sorted += count;
        }
        self.contacts[self.forces[place].1 as usize]
    }
}

/// Whether a set of walls, a bit each, has both across `axis`.
fn joins(walls: u8, axis: usize) -> bool {
    let both = 0b11 << (2 * axis);
    walls & both == both
}

/// Grains that contacts have joined so far: disjoint sets with path halving, joined by size.
struct Sets {
    parent: Vec<u32>,
    /// Grains in the set, at its root; 0 as long as the grain has no contact.
    size: Vec<u32>,
    /// Walls that the set touches, a bit each, at its root.
    walls: Vec<u8>,
}

impl Sets {
    fn new(grains: usize) -> Self {
        Self { parent: (0..grains as u32).collect(), size: vec![0; grains], walls: vec![0; grains] }
    }

    /// Adds a contact; the walls that its chain touches now.
    fn add(&mut self, contact: &Contact) -> u8 {
        let root = self.root_of_member(contact.first);
        let root = match contact.second {
            Other::Wall(wall) => {
                debug_assert!(usize::from(wall) < wall::COUNT);
                self.walls[root] |= 1 << wall;
                root
            }
            Other::Grain(second) => {
                let other = self.root_of_member(second);
                self.join(root, other)
            }
        };
        self.walls[root]
    }

    /// The root of a grain that has a contact now.
    fn root_of_member(&mut self, grain: u32) -> usize {
        let mut at = grain as usize;
        while self.parent[at] as usize != at {
            self.parent[at] = self.parent[self.parent[at] as usize];
            at = self.parent[at] as usize;
        }
        self.size[at] = self.size[at].max(1);
        at
    }

    fn join(&mut self, a: usize, b: usize) -> usize {
        if a == b {
            return a;
        }
        let (large, small) = if self.size[a] >= self.size[b] { (a, b) } else { (b, a) };
        self.parent[small] = large as u32;
        self.size[large] += self.size[small];
        self.walls[large] |= self.walls[small];
        large
    }
}

/// How many grains and chains there are.
#[derive(Default)]
struct Network {
    grains: u32,
    chains: u32,
    largest: u32,
}

impl Network {
    fn of(sets: &Sets) -> Self {
        let mut network = Self::default();
        for (grain, (&parent, &size)) in sets.parent.iter().zip(&sets.size).enumerate() {
            if parent as usize == grain && size > 0 {
                network.grains += size;
                network.chains += 1;
                network.largest = network.largest.max(size);
            }
        }
        network
    }
}
