//! The contacts of a stretch of grains, in order: those that touch, those that hold shear, and
//! those that do both.

use std::ops::Range;

use super::joint::Joint;
use crate::contact::Other;
use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::relax::balance::{Balance, Link};
use crate::relax::split::{Contacts, Pattern, Source};
use crate::relax::tangential::{Reference, Traction};

/// What contacts are made of.
#[derive(Clone, Copy)]
pub(super) struct Sources<'a> {
    pub(super) balance: &'a Balance,
    pub(super) near: &'a Neighbours,
    pub(super) reference: &'a Reference,
    /// 1/R of each grain \[1/m\].
    pub(super) over_radius: &'a [f32],
    /// One over the reference stiffness \[m/N\].
    pub(super) scale: f32,
}

/// Contacts by their first grain, or by their first row.
#[derive(Clone, Debug, Default)]
pub(super) struct List {
    /// First grain.
    first: usize,
    /// Number of the first contact.
    pub(super) number: u32,
    pub(super) pattern: Pattern,
    /// Contacts between grains.
    pub(super) joints: Vec<Joint>,
    /// Contacts of a grain with walls.
    pub(super) walls: Vec<(u32, Joint)>,
}

impl List {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        self.pattern.heap_bytes() + heap::bytes(&self.joints) + heap::bytes(&self.walls)
    }

    /// Forgets all contacts.
    pub(super) fn clear(&mut self) {
        self.pattern.begin();
        self.joints.clear();
        self.walls.clear();
    }

    /// Lists the contacts of `grains` with later ones and with walls.
    pub(super) fn join(&mut self, grains: Range<usize>, sources: Sources<'_>) {
        let Sources { balance, near, reference, over_radius, scale } = sources;
        self.clear();
        self.first = grains.start;
        let skipped = reference.contacts.partition_point(|h| (h.first as usize) < grains.start);
        let tractions = &balance.tractions[skipped..];
        let mut held = reference.contacts[skipped..].iter().zip(tractions).peekable();
        for (row, i) in grains.enumerate() {
            let first = near.row(i).start;
            let links = &balance.links[first..][..balance.links_in_row[i] as usize];
            let sheared = |link: Option<&Link>, second: usize, traction: &Traction| {
                let over = [over_radius[i], over_radius[second]];
                Joint::sheared(link, traction, over, scale)
            };
            // Both lists are in the order of the second grain; walls come last.
            for link in links {
                let mut live = None;
                let upto = (i as u32, Other::Grain(link.second));
                while let Some((h, t)) = held.next_if(|(h, _)| (h.first, h.second) <= upto) {
                    match h.second {
                        Other::Grain(j) if j < link.second => {
                            if t.live {
                                self.push(j, sheared(None, j as usize, t));
                            }
                        }
                        _ => live = t.live.then_some(t),
                    }
                }
                let joint = match live {
                    Some(t) => sheared(Some(link), link.second as usize, t),
                    None => Joint::pressed(link),
                };
                self.push(link.second, joint);
            }
            while let Some((h, t)) = held.next_if(|(h, _)| h.first as usize == i) {
                match h.second {
                    _ if !t.live => {}
                    Other::Grain(j) => self.push(j, sheared(None, j as usize, t)),
                    Other::Wall(_) => self.walls.push((i as u32, sheared(None, i, t))),
                }
            }
            self.pattern.end(row + 1);
            let cross = balance.cross_stiffness(i);
            let mut along = balance.wall_stiffness[i];
            if cross != 0.0 {
                let [x, y, _] = along;
                let joints = Joint::round_wall([x, y, cross]);
                self.walls.extend(joints.map(|joint| (i as u32, joint)));
                along = [0.0, 0.0, along[2]];
            }
            for (axis, k) in along.into_iter().enumerate().filter(|(_, k)| *k != 0.0) {
                self.walls.push((i as u32, Joint::wall(axis, k)));
            }
        }
    }

    #[inline(always)]
    fn push(&mut self, second: u32, joint: Joint) {
        self.pattern.second.push(second);
        self.joints.push(joint);
    }
}

/// The lists of successive stretches of the same length.
pub(super) struct Lists<'a> {
    pub(super) lists: &'a [List],
    pub(super) length: usize,
}

impl Contacts for Lists<'_> {
    #[inline(always)]
    fn row(&self, i: usize) -> impl DoubleEndedIterator<Item = (u32, u32)> {
        let list = &self.lists[i / self.length];
        let range = list.pattern.row(i - list.first);
        let number = list.number + range.start as u32;
        let row = list.pattern.second[range].iter().enumerate();
        row.map(move |(k, second)| (*second, number + k as u32))
    }
}

impl Lists<'_> {
    /// Copies contacts to `joints`.
    pub(super) fn copy(&self, contacts: &[Source], joints: &mut Vec<Joint>) {
        joints.clear();
        joints.extend(contacts.iter().map(|source| {
            let joint = self.joint(source.contact);
            if source.swapped { joint.swapped() } else { *joint }
        }));
    }

    /// The contact of that number.
    fn joint(&self, number: u32) -> &Joint {
        let after = self.lists.iter().position(|list| list.number > number);
        let list = &self.lists[after.unwrap_or(self.lists.len()) - 1];
        &list.joints[(number - list.number) as usize]
    }
}
