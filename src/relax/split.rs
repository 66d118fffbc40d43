//! The rows of the linear system cut into parts that do not touch each other, and a separator.
//!
//! The order of the grains is cut into as many parts of equal length as [`model::parts`] says.
//! Where grains of two parts touch, one of them goes to the separator. What a part does to the
//! separator it keeps in rows of its own behind those of its grains, to be added up part by part:
//! so the parts can be worked on at the same time, and the bits do not depend on who did it.

use rayon::prelude::*;

use crate::heap;
use crate::model;

/// Grains with at least so many contacts with other parts go to the separator first.
const LEAST_DEGREES: [u32; 4] = [5, 3, 2, 1];

/// Where a grain stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Place {
    /// Its part; the separator comes last.
    pub(super) part: u32,
    /// Its row there.
    pub(super) row: u32,
}

/// The contacts to be dealt out.
pub(super) trait Contacts: Sync {
    /// The later grains that grain `i` touches, each with the number of the contact.
    fn row(&self, i: usize) -> impl Iterator<Item = (u32, u32)>;
}

/// A contact in a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Dealt {
    /// The row that comes first.
    pub(super) row: u32,
    /// The other row of the part; behind those of its grains come those of the separator.
    pub(super) second: u32,
    /// Its number.
    pub(super) contact: u32,
    /// Whether the first row is that of the second grain.
    pub(super) swapped: bool,
}

/// A contact of grains of two parts.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    grains: [u32; 2],
    contact: u32,
}

/// The parts of one linearisation.
#[derive(Clone, Debug, Default)]
pub(super) struct Split {
    place: Vec<Place>,
    /// Rows of each part and of the separator.
    rows: Vec<u32>,
    /// Grains of a part before some of them went to the separator.
    length: usize,
    late: Vec<bool>,
    /// The contacts of each part with later ones.
    crossing: Vec<Vec<Crossing>>,
    /// Contacts of each grain with other parts.
    degree: Vec<u32>,
}

impl Split {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.place)
            + heap::bytes(&self.rows)
            + heap::bytes(&self.late)
            + heap::bytes(&self.crossing)
            + self.crossing.iter().map(heap::bytes).sum::<usize>()
            + heap::bytes(&self.degree)
    }

    /// Splits `n` grains that touch in `contacts`.
    pub(super) fn arrange(&mut self, n: usize, contacts: &impl Contacts) {
        let parts = model::parts(n);
        self.length = n.div_ceil(parts).max(1);
        self.rows.clear();
        self.place.clear();
        if parts == 1 {
            self.rows.extend([n as u32, 0]);
            self.place.extend((0..n as u32).map(|row| Place { part: 0, row }));
            return;
        }
        let length = self.length;
        self.crossing.resize_with(parts, Vec::new);
        self.crossing.par_iter_mut().enumerate().for_each(|(part, crossing)| {
            crossing.clear();
            let end = ((part + 1) * length).min(n);
            for i in part * length..end {
                let beyond = contacts.row(i).filter(|(j, _)| *j as usize >= end);
                crossing
                    .extend(beyond.map(|(j, contact)| Crossing { grains: [i as u32, j], contact }));
            }
        });
        self.choose_separator(n);
        self.rows.resize(parts + 1, 0);
        self.place.extend(self.late.iter().enumerate().map(|(i, &late)| {
            let part = if late { parts } else { i / length };
            let row = self.rows[part];
            self.rows[part] += 1;
            Place { part: part as u32, row }
        }));
    }

    /// Chooses one grain of each crossing contact, those first that have many.
    fn choose_separator(&mut self, n: usize) {
        self.late.clear();
        self.late.resize(n, false);
        self.degree.clear();
        self.degree.resize(n, 0);
        for grain in self.crossing.iter().flatten().flat_map(|crossing| crossing.grains) {
            self.degree[grain as usize] += 1;
        }
        for least in LEAST_DEGREES {
            for [i, j] in self.crossing.iter().flatten().map(|crossing| crossing.grains) {
                let [i, j] = [i as usize, j as usize];
                let best = if self.degree[i] > self.degree[j] { i } else { j };
                if !(self.late[i] || self.late[j]) && self.degree[best] >= least {
                    self.late[best] = true;
                }
            }
        }
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

    /// The grains of part `part` before some of them went to the separator, with their places.
    pub(super) fn range(&self, part: usize) -> impl Iterator<Item = (usize, Place)> {
        let first = part * self.length;
        let end = (first + self.length).min(self.place.len());
        (first..end).map(|i| (i, self.place[i]))
    }

    /// The separator's grains, with their places.
    pub(super) fn separator(&self) -> impl Iterator<Item = (usize, Place)> {
        let late = self.late.iter().enumerate().filter(|(_, late)| **late);
        let late = (self.parts() > 1).then_some(late).into_iter().flatten();
        late.map(|(i, _)| (i, self.place[i]))
    }

    /// Deals the contacts of part `part` to `take`, row after row, and notes them in `pattern`.
    #[inline(always)]
    pub(super) fn deal(
        &self,
        part: usize,
        contacts: &impl Contacts,
        pattern: &mut Pattern,
        mut take: impl FnMut(Dealt),
    ) {
        pattern.begin();
        let mut give = |pattern: &mut Pattern, dealt: Dealt| {
            pattern.push(dealt.row, dealt.second);
            take(dealt);
        };
        if self.parts() == 1 {
            for row in 0..self.rows[0] {
                for (second, contact) in contacts.row(row as usize) {
                    give(pattern, Dealt { row, second, contact, swapped: false });
                }
            }
            pattern.end(self.rows(part));
            return;
        }
        let mut swapped = self.swapped(part, contacts, &mut pattern.between).into_iter().peekable();
        let separator = self.parts() as u32;
        for (i, at) in self.range(part).filter(|(_, at)| at.part != separator) {
            while let Some(dealt) = swapped.next_if(|dealt| dealt.row < at.row) {
                give(pattern, dealt);
            }
            for (j, contact) in contacts.row(i) {
                let to = self.place[j as usize];
                let second = to.row + if to.part == separator { self.rows[part] } else { 0 };
                give(pattern, Dealt { row: at.row, second, contact, swapped: false });
            }
        }
        for dealt in swapped {
            give(pattern, dealt);
        }
        pattern.end(self.rows(part));
    }

    /// The contacts of part `part` whose first grain went to the separator, sorted; those whose
    /// second grain did too go to `between`.
    fn swapped(
        &self,
        part: usize,
        contacts: &impl Contacts,
        between: &mut Vec<Dealt>,
    ) -> Vec<Dealt> {
        let separator = self.parts() as u32;
        let mut swapped = Vec::new();
        let mut sort = |late: Place, to: Place, contact: u32| {
            if to.part as usize == part {
                let second = self.rows[part] + late.row;
                swapped.push(Dealt { row: to.row, second, contact, swapped: true });
            }
        };
        between.clear();
        for (i, at) in self.range(part).filter(|(_, at)| at.part == separator) {
            for (j, contact) in contacts.row(i) {
                let to = self.place[j as usize];
                if to.part == separator {
                    between.push(Dealt { row: at.row, second: to.row, contact, swapped: false });
                } else {
                    sort(at, to, contact);
                }
            }
        }
        for &Crossing { grains: [i, j], contact } in self.crossing[..part].iter().flatten() {
            let at = self.place[i as usize];
            if at.part == separator {
                sort(at, self.place[j as usize], contact);
            }
        }
        swapped.sort_unstable();
        swapped
    }
}

/// The pattern of a part's matrix: its contacts by their first row.
#[derive(Clone, Debug, Default)]
pub(super) struct Pattern {
    /// First contact of each row, shape (rows + 1).
    start: Vec<u32>,
    /// The other row of each contact.
    pub(super) second: Vec<u32>,
    /// Contacts between grains of the separator, of which the first was in this part.
    pub(super) between: Vec<Dealt>,
}

impl Pattern {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.start) + heap::bytes(&self.second) + heap::bytes(&self.between)
    }

    /// Begins without contacts.
    pub(super) fn begin(&mut self) {
        self.start.clear();
        self.start.push(0);
        self.second.clear();
    }

    /// Adds a contact of `row`, in the order of the rows.
    #[inline(always)]
    pub(super) fn push(&mut self, row: u32, second: u32) {
        self.end(row as usize);
        self.second.push(second);
    }

    /// Ends `rows` rows.
    #[inline(always)]
    pub(super) fn end(&mut self, rows: usize) {
        while self.start.len() <= rows {
            self.start.push(self.second.len() as u32);
        }
    }

    /// The contacts of row `i`.
    #[inline(always)]
    pub(super) fn row(&self, i: usize) -> std::ops::Range<usize> {
        self.start[i] as usize..self.start[i + 1] as usize
    }
}

/// Calls `work` with every part and its number, in parallel where there are several.
pub(super) fn for_each<P: Send>(parts: &mut [P], work: impl Fn(usize, &mut P) + Sync + Send) {
    match parts {
        [only] => work(0, only),
        several => several.par_iter_mut().enumerate().for_each(|(k, part)| work(k, part)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of grains with contacts of these reaches.
    struct Ring {
        n: u32,
        reaches: [u32; 3],
    }

    impl Contacts for Ring {
        fn row(&self, i: usize) -> impl Iterator<Item = (u32, u32)> {
            let reaches = self.reaches.into_iter().zip(3 * i as u32..);
            reaches.map(move |(reach, k)| (i as u32 + reach, k)).filter(|(j, _)| *j < self.n)
        }
    }

    #[test]
    fn every_contact_is_dealt_once_and_joins_two_parts_through_the_separator_alone() {
        let n = 20_000;
        for reach in [31, 4000, 9000] {
            let ring = Ring { n, reaches: [1, 7, reach] };
            let mut split = Split::default();
            split.arrange(n as usize, &ring);
            assert_eq!(split.parts(), 4);
            let total: usize = (0..=4).map(|part| split.rows(part)).sum();
            assert_eq!(total, n as usize);
            let grain_of = |part: usize, row: u32| {
                let behind = row.checked_sub(split.rows[part]).filter(|_| part != 4);
                let place = match behind {
                    None => Place { part: part as u32, row },
                    Some(row) => Place { part: 4, row },
                };
                split.places().iter().position(|at| *at == place).expect("a grain stands there")
            };
            let mut dealt = Vec::new();
            for part in 0..4 {
                let mut pattern = Pattern::default();
                let mut list = Vec::new();
                split.deal(part, &ring, &mut pattern, |one| list.push(one));
                assert!(list.is_sorted_by_key(|one| one.row));
                for row in 0..split.rows(part) {
                    for k in pattern.row(row) {
                        assert_eq!(list[k].row as usize, row);
                        assert_eq!(list[k].second, pattern.second[k]);
                    }
                }
                dealt.extend(list.into_iter().map(|one| (part, one)));
                dealt.extend(pattern.between.iter().map(|one| (4, *one)));
            }
            dealt.sort_by_key(|(_, one)| one.contact);
            let want = (0..n as usize).flat_map(|i| ring.row(i).map(move |(j, k)| (i, j, k)));
            let mut count = 0;
            // Every tenth contact is looked at closely: to find who stands in a row takes long.
            for ((i, j, k), (part, one)) in want.zip(&dealt) {
                count += 1;
                assert_eq!(one.contact, k);
                if k % 10 == 0 {
                    let pair = [grain_of(*part, one.row), grain_of(*part, one.second)];
                    let pair = if one.swapped { [pair[1], pair[0]] } else { pair };
                    assert_eq!(pair, [i, j as usize]);
                }
            }
            assert_eq!(count, dealt.len());
        }
    }

    #[test]
    fn small_packs_are_one_part_in_their_own_order() {
        let mut split = Split::default();
        split.arrange(2740, &Ring { n: 2740, reaches: [1, 2, 3] });
        assert_eq!((split.parts(), split.rows(0), split.rows(1)), (1, 2740, 0));
        assert_eq!(split.places()[17], Place { part: 0, row: 17 });
        assert_eq!(split.separator().count(), 0);
    }
}
