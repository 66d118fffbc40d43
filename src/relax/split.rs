//! The rows of the linear system cut into parts that do not touch each other, and a separator.
//!
//! The order of the grains is cut into as many parts of equal length as [`model::parts`] says.
//! Where grains of two parts touch, one of them goes to the separator. What a part does to the
//! separator it keeps in rows of its own behind those of its grains, to be added up part by part:
//! so the parts can be worked on at the same time, and the bits do not depend on who did it.

use rayon::prelude::*;

use crate::heap;
use crate::model;

/// Where a grain stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Place {
    /// Its part; the separator comes last.
    pub(super) part: u32,
    /// Its row there.
    pub(super) row: u32,
}

/// Where a contact stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Meeting {
    /// Its part.
    pub(super) part: usize,
    /// The row that comes first.
    pub(super) row: usize,
    /// The other row of the part; behind those of its grains come those of the separator.
    pub(super) second: u32,
    /// Whether the first row is that of the second grain.
    pub(super) swapped: bool,
}

/// The parts of one linearisation.
#[derive(Clone, Debug, Default)]
pub(super) struct Split {
    place: Vec<Place>,
    /// Rows of each part and of the separator.
    rows: Vec<u32>,
    late: Vec<bool>,
}

impl Split {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.place) + heap::bytes(&self.rows) + heap::bytes(&self.late)
    }

    /// Splits `n` grains that touch in `pairs`.
    pub(super) fn arrange(&mut self, n: usize, pairs: impl Iterator<Item = (u32, u32)>) {
        let parts = model::parts(n);
        let length = n.div_ceil(parts).max(1) as u32;
        self.late.clear();
        self.late.resize(n, false);
        if parts > 1 {
            for (i, j) in pairs {
                if i / length != j / length && !self.late[i as usize] {
                    self.late[j as usize] = true;
                }
            }
        }
        self.rows.clear();
        self.rows.resize(parts + 1, 0);
        self.place.clear();
        self.place.extend(self.late.iter().enumerate().map(|(i, &late)| {
            let part = if late { parts as u32 } else { i as u32 / length };
            let row = self.rows[part as usize];
            self.rows[part as usize] += 1;
            Place { part, row }
        }));
    }

    /// Number of parts, without the separator.
    pub(super) fn parts(&self) -> usize {
        self.rows.len() - 1
    }

    /// Grains of part `part`.
    pub(super) fn rows(&self, part: usize) -> usize {
        self.rows[part] as usize
    }

    /// Rows that part `part` needs for its grains and for the separator.
    pub(super) fn rows_with_separator(&self, part: usize) -> usize {
        let separator = self.parts();
        self.rows(part) + if part == separator { 0 } else { self.rows(separator) }
    }

    /// Where each grain stands.
    pub(super) fn places(&self) -> &[Place] {
        &self.place
    }

    /// Where the contact of the grains `i` < `j` stands.
    #[inline(always)]
    pub(super) fn meet(&self, i: usize, j: u32) -> Meeting {
        let (a, b) = (self.place[i], self.place[j as usize]);
        let part = a.part.min(b.part) as usize;
        if a.part == b.part {
            return Meeting { part, row: a.row as usize, second: b.row, swapped: false };
        }
        let (row, late) = if a.part < b.part { (a.row, b.row) } else { (b.row, a.row) };
        let second = self.rows[part] + late;
        Meeting { part, row: row as usize, second, swapped: a.part > b.part }
    }
}

/// The pattern of a part's matrix: its contacts by their first row.
#[derive(Clone, Debug, Default)]
pub(super) struct Pattern {
    /// First contact of each row, shape (rows + 1).
    pub(super) start: Vec<u32>,
    /// The other row of each contact.
    pub(super) second: Vec<u32>,
}

impl Pattern {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.start) + heap::bytes(&self.second)
    }

    /// Begins with `rows` rows without contacts.
    pub(super) fn begin(&mut self, rows: usize) {
        self.start.clear();
        self.start.resize(rows + 1, 0);
        self.second.clear();
    }

    /// Announces a contact of `row`.
    #[inline(always)]
    pub(super) fn count(&mut self, row: usize) {
        self.start[row] += 1;
    }

    /// Makes room for the contacts announced, and says for how many: `start` becomes the end of
    /// each row.
    pub(super) fn make_room(&mut self) -> usize {
        let mut end = 0;
        for start in &mut self.start {
            end += *start;
            *start = end;
        }
        self.second.resize(end as usize, 0);
        end as usize
    }

    /// Takes one contact announced and says where it stands; after all of them `start` is where
    /// each row begins.
    #[inline(always)]
    pub(super) fn insert(&mut self, row: usize, second: u32) -> usize {
        self.start[row] -= 1;
        let at = self.start[row] as usize;
        self.second[at] = second;
        at
    }

    /// The contacts of row `i`.
    #[inline(always)]
    pub(super) fn row(&self, i: usize) -> std::ops::Range<usize> {
        self.start[i] as usize..self.start[i + 1] as usize
    }
}

/// Part `k`, of which the separator is the last.
pub(super) fn part_of<'a, P>(parts: &'a mut [P], separator: &'a mut P, k: usize) -> &'a mut P {
    parts.get_mut(k).unwrap_or(separator)
}

/// Calls `work` with every part, in parallel where there are several.
pub(super) fn for_each<P: Send>(parts: &mut [P], work: impl Fn(&mut P) + Sync + Send) {
    match parts {
        [only] => work(only),
        several => several.par_iter_mut().for_each(work),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_contact_joins_two_parts_but_through_the_separator() {
        let n = 20_000u32;
        // Rings of different reach: many contacts cross the cuts.
        let pairs =
            |reach: u32| (0..n).flat_map(move |i| [i + 1, i + 7, i + reach].map(|j| (i, j)));
        let inside = |&(_, j): &(u32, u32)| j < n;
        let mut split = Split::default();
        for reach in [31, 4000, 9000] {
            split.arrange(n as usize, pairs(reach).filter(inside));
            assert_eq!(split.parts(), 4);
            let total: usize = (0..=4).map(|part| split.rows(part)).sum();
            assert_eq!(total, n as usize);
            for (i, j) in pairs(reach).filter(inside) {
                let meeting = split.meet(i as usize, j);
                let (a, b) = (split.places()[i as usize], split.places()[j as usize]);
                let first = if meeting.swapped { b } else { a };
                let other = if meeting.swapped { a } else { b };
                assert_eq!((first.part as usize, first.row as usize), (meeting.part, meeting.row));
                let behind = meeting.second as usize >= split.rows(meeting.part);
                assert_eq!(behind, other.part as usize == 4 && meeting.part != 4);
                let row =
                    meeting.second as usize - if behind { split.rows(meeting.part) } else { 0 };
                assert_eq!(row, other.row as usize);
                assert!(behind || other.part == first.part);
                assert!((meeting.second as usize) < split.rows_with_separator(meeting.part));
            }
        }
    }

    #[test]
    fn small_packs_are_one_part_in_their_own_order() {
        let mut split = Split::default();
        split.arrange(2740, (0..2739).map(|i| (i, i + 1)));
        assert_eq!((split.parts(), split.rows(0), split.rows(1)), (1, 2740, 0));
        assert_eq!(split.places()[17], Place { part: 0, row: 17 });
    }
}
