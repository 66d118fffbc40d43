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
    /// The later grains that grain `i` touches, in order, each with the number of the contact.
    fn row(&self, i: usize) -> impl DoubleEndedIterator<Item = (u32, u32)>;
}

/// Where the content of a contact in a part comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Source {
    /// The number of the contact.
    pub(super) contact: u32,
    /// Whether the first row is that of the second grain.
    pub(super) swapped: bool,
}

/// A contact that stands in the row that comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Dealt {
    row: u32,
    /// The other row of the part; behind those of its grains come those of the separator.
    second: u32,
    source: Source,
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
    /// Other pairs of grains of two parts.
    apart: Vec<[u32; 2]>,
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
            + heap::bytes(&self.apart)
            + heap::bytes(&self.degree)
    }

    /// Splits `n` grains that touch in `contacts` and are otherwise coupled in `pairs`.
    pub(super) fn arrange(
        &mut self,
        n: usize,
        contacts: &impl Contacts,
        pairs: impl Iterator<Item = [u32; 2]>,
    ) {
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
                let beyond = contacts.row(i).rev().take_while(|(j, _)| *j as usize >= end);
                crossing
                    .extend(beyond.map(|(j, contact)| Crossing { grains: [i as u32, j], contact }));
            }
        });
        self.apart.clear();
        self.apart.extend(pairs.filter(|[i, j]| *i as usize / length != *j as usize / length));
        self.choose_separator(n);
        self.place.resize(n, Place::default());
        let mut late_row = 0;
        let grains = self.place.chunks_mut(length).zip(self.late.chunks(length));
        for (part, (place, late)) in grains.enumerate() {
            let mut row = 0;
            for (place, &late) in place.iter_mut().zip(late) {
                let next = if late { &mut late_row } else { &mut row };
                let part = if late { parts } else { part } as u32;
                *place = Place { part, row: *next };
                *next += 1;
            }
            self.rows.push(row);
        }
        self.rows.push(late_row);
    }

    /// Chooses one grain of each crossing contact or pair, those first that have many.
    fn choose_separator(&mut self, n: usize) {
        self.late.clear();
        self.late.resize(n, false);
        self.degree.clear();
        self.degree.resize(n, 0);
        let touching = self.crossing.iter().flatten().map(|crossing| crossing.grains);
        let all = touching.chain(self.apart.iter().copied());
        for grain in all.clone().flatten() {
            self.degree[grain as usize] += 1;
        }
        for least in LEAST_DEGREES {
            for [i, j] in all.clone() {
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

    /// The part that `grains`, which are coupled, are worked on in, and their rows there.
    pub(super) fn pair(&self, grains: [u32; 2]) -> (u32, [u32; 2]) {
        let [a, b] = grains.map(|grain| self.place[grain as usize]);
        let behind = |part: u32| self.rows[part as usize];
        match self.parts() as u32 {
            _ if a.part == b.part => (a.part, [a.row, b.row]),
            separator if b.part == separator => (a.part, [a.row, behind(a.part) + b.row]),
            _ => (b.part, [behind(b.part) + a.row, b.row]),
        }
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

    /// Deals the contacts of part `part` to its `pattern`.
    pub(super) fn deal(&self, part: usize, contacts: &impl Contacts, pattern: &mut Pattern) {
        pattern.begin();
        let rows = self.rows[part];
        if self.parts() == 1 {
            for row in 0..rows {
                for (second, contact) in contacts.row(row as usize) {
                    pattern.second.push(second);
                    pattern.source.push(Source { contact, swapped: false });
                }
                pattern.end(row as usize + 1);
            }
            return;
        }
        let separator = self.parts() as u32;
        let swapped = self.swapped(part, contacts, &mut pattern.between);
        let mut swapped = swapped.into_iter().peekable();
        for (i, at) in self.range(part).filter(|(_, at)| at.part != separator) {
            for (j, contact) in contacts.row(i) {
                let to = self.place[j as usize];
                pattern.second.push(to.row + if to.part == separator { rows } else { 0 });
                pattern.source.push(Source { contact, swapped: false });
            }
            while let Some(dealt) = swapped.next_if(|dealt| dealt.row == at.row) {
                pattern.second.push(dealt.second);
                pattern.source.push(dealt.source);
            }
            pattern.end(at.row as usize + 1);
        }
    }

    /// Deals what the parts left for the separator to its `pattern`.
    pub(super) fn deal_between<'a>(
        &self,
        parts: impl Iterator<Item = &'a Pattern>,
        pattern: &mut Pattern,
    ) {
        pattern.begin();
        for dealt in parts.flat_map(|part| &part.between) {
            pattern.end(dealt.row as usize);
            pattern.second.push(dealt.second);
            pattern.source.push(dealt.source);
        }
        pattern.end(self.rows(self.parts()));
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
                let source = Source { contact, swapped: true };
                swapped.push(Dealt { row: to.row, second, source });
            }
        };
        between.clear();
        for (i, at) in self.range(part).filter(|(_, at)| at.part == separator) {
            for (j, contact) in contacts.row(i) {
                let to = self.place[j as usize];
                if to.part == separator {
                    let source = Source { contact, swapped: false };
                    between.push(Dealt { row: at.row, second: to.row, source });
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
    /// What each contact is.
    pub(super) source: Vec<Source>,
    /// Contacts between grains of the separator, of which the first was in this part.
    between: Vec<Dealt>,
}

impl Pattern {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.start)
            + heap::bytes(&self.second)
            + heap::bytes(&self.source)
            + heap::bytes(&self.between)
    }

    /// Begins without contacts.
    pub(super) fn begin(&mut self) {
        self.start.clear();
        self.start.push(0);
        self.second.clear();
        self.source.clear();
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
        fn row(&self, i: usize) -> impl DoubleEndedIterator<Item = (u32, u32)> {
            let reaches = self.reaches.into_iter().enumerate();
            let row = reaches.map(move |(k, reach)| (i as u32 + reach, (3 * i + k) as u32));
            row.filter(|(j, _)| *j < self.n)
        }
    }

    #[test]
    fn every_contact_is_dealt_once_and_joins_two_parts_through_the_separator_alone() {
        let n = 20_000;
        for reach in [31, 4000, 9000] {
            let ring = Ring { n, reaches: [1, 7, reach] };
            let mut split = Split::default();
            let coupled = |i: u32| [[i, (i + 13) % n], [i, (i + 7001) % n]];
            let pairs = (0..n).step_by(9).flat_map(coupled);
            split.arrange(n as usize, &ring, pairs.clone());
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
            for pair in pairs.step_by(11) {
                let (part, rows) = split.pair(pair);
                assert_eq!(rows.map(|row| grain_of(part as usize, row) as u32), pair);
            }
            let mut patterns = vec![Pattern::default(); 5];
            for (part, pattern) in patterns[..4].iter_mut().enumerate() {
                split.deal(part, &ring, pattern);
            }
            let (parts, late) = patterns.split_at_mut(4);
            split.deal_between(parts.iter(), &mut late[0]);
            let mut dealt = Vec::new();
            for (part, pattern) in patterns.iter().enumerate() {
                for row in 0..split.rows(part) {
                    let of_row = |k| (part, row as u32, pattern.second[k], pattern.source[k]);
                    dealt.extend(pattern.row(row).map(of_row));
                }
            }
            dealt.sort_by_key(|(_, _, _, source)| source.contact);
            let want = (0..n as usize).flat_map(|i| ring.row(i).map(move |(j, k)| (i, j, k)));
            let mut count = 0;
            // Every tenth contact is looked at closely: to find who stands in a row takes long.
            for ((i, j, k), &(part, row, second, source)) in want.zip(&dealt) {
                count += 1;
                assert_eq!(source.contact, k);
                if k % 10 == 0 {
                    let pair = [grain_of(part, row), grain_of(part, second)];
                    let pair = if source.swapped { [pair[1], pair[0]] } else { pair };
                    assert_eq!(pair, [i, j as usize]);
                }
            }
            assert_eq!(count, dealt.len());
        }
    }

    #[test]
    fn small_packs_are_one_part_in_their_own_order() {
        let mut split = Split::default();
        split.arrange(2740, &Ring { n: 2740, reaches: [1, 2, 3] }, std::iter::empty());
        assert_eq!((split.parts(), split.rows(0), split.rows(1)), (1, 2740, 0));
        assert_eq!(split.places()[17], Place { part: 0, row: 17 });
        assert_eq!(split.separator().count(), 0);
    }
}
