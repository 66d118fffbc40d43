//! Nested dissection: the order in which grains are eliminated, and what each elimination couples.

use crate::heap;

/// A piece of at most this many grains is not cut further.
const LEAF: usize = 6;

/// Grains that are eliminated together, and the later ones that this couples.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    /// The supernodes in the order of elimination, each after its children.
    pub(super) nodes: Vec<Node>,
    /// Grains of all nodes: the eliminated ones of a node, then those that it couples.
    pub(super) grains: Vec<u32>,
    /// Where each grain stands in the order of elimination, shape (n).
    pub(super) rank: Vec<u32>,
    /// Pairs of each grain with the others: (other grain, entry of the list), in rows.
    pub(super) start: Vec<u32>,
    pub(super) links: Vec<(u32, u32)>,
}

/// One supernode.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// First of its grains in `Tree::grains`.
    pub(super) first: u32,
    /// How many it eliminates.
    pub(super) pivots: u32,
    /// How many it couples besides.
    pub(super) coupled: u32,
    /// How many children it has; they stand just before it, each with its own before itself.
    pub(super) children: u32,
}

impl Tree {
    /// For grains at `position` with those of the pairs `start`, `second` that `couples`, and `more` pairs.
    pub(super) fn build(
        &mut self,
        position: &[[f64; 2]],
        start: &[u32],
        second: &[u32],
        couples: impl Fn(usize) -> bool,
        more: &[(u32, u32)],
    ) {
        let n = position.len();
        self.link(n, start, second, couples, more);
        self.nodes.clear();
        self.grains.clear();
        self.rank.clear();
        self.rank.resize(n, 0);
        let mut pieces: Vec<(Vec<u32>, u32)> = Vec::new();
        let mut side = vec![0; n];
        self.dissect((0..n as u32).collect(), position, &mut side, &mut 0, &mut pieces);
        let mut rank = 0;
        for (pivots, _) in &pieces {
            for &grain in pivots {
                self.rank[grain as usize] = rank;
                rank += 1;
            }
        }
        self.couple(pieces);
    }

    fn link(
        &mut self,
        n: usize,
        start: &[u32],
        second: &[u32],
        couples: impl Fn(usize) -> bool,
        more: &[(u32, u32)],
    ) {
        self.start.clear();
        self.start.resize(n + 1, 0);
        let rows = |i: usize| start[i] as usize..start[i + 1] as usize;
        for i in 0..n {
            for k in rows(i).filter(|&k| couples(k)) {
                self.start[i + 1] += 1;
                self.start[second[k] as usize + 1] += 1;
            }
        }
        for &(i, j) in more {
            self.start[i as usize + 1] += 1;
            self.start[j as usize + 1] += 1;
        }
        for i in 0..n {
            self.start[i + 1] += self.start[i];
        }
        let mut next = self.start.clone();
        self.links.clear();
        self.links.resize(next[n] as usize, (0, 0));
        let mut put = |one: u32, other: u32, entry: usize| {
            for (one, other) in [(one, other), (other, one)] {
                let place = &mut next[one as usize];
                self.links[*place as usize] = (other, entry as u32);
                *place += 1;
            }
        };
        for i in 0..n {
            rows(i).filter(|&k| couples(k)).for_each(|k| put(i as u32, second[k], k));
        }
        more.iter().zip(second.len()..).for_each(|(&(i, j), entry)| put(i, j, entry));
    }

    /// The pairs of a grain: the other one, and the entry of the list.
    pub(super) fn links_of(&self, grain: u32) -> &[(u32, u32)] {
        let i = grain as usize;
        &self.links[self.start[i] as usize..self.start[i + 1] as usize]
    }

    /// Cuts `piece` in two along its longer side, leaves a line of grains between the halves, and adds
    /// the pieces to `pieces`, each with the number of its children. Says how many it added at the top.
    fn dissect(
        &self,
        mut piece: Vec<u32>,
        position: &[[f64; 2]],
        side: &mut [u32],
        mark: &mut u32,
        pieces: &mut Vec<(Vec<u32>, u32)>,
    ) -> u32 {
        if piece.len() <= LEAF {
            if piece.is_empty() {
                return 0;
            }
            pieces.push((piece, 0));
            return 1;
        }
        let extent = |axis: usize| {
            let along = piece.iter().map(|&i| position[i as usize][axis]);
            let (low, high) = along.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        };
        let axis = usize::from(extent(1) > extent(0));
        piece.sort_unstable_by(|&a, &b| {
            position[a as usize][axis].total_cmp(&position[b as usize][axis]).then(a.cmp(&b))
        });
        let high = piece.split_off(piece.len() / 2);
        *mark += 1;
        let upper = *mark;
        high.iter().for_each(|&grain| side[grain as usize] = upper);
        // Grains of the lower half that touch the upper one part the two.
        let (between, low): (Vec<u32>, Vec<u32>) = piece.into_iter().partition(|&grain| {
            self.links_of(grain).iter().any(|&(other, _)| side[other as usize] == upper)
        });
        let below = self.dissect(low, position, side, mark, pieces);
        let above = self.dissect(high, position, side, mark, pieces);
        if between.is_empty() {
            return below + above;
        }
        pieces.push((between, below + above));
        1
    }

    /// Finds what each elimination couples: the later ones among the neighbours of its grains, and those
    /// that its children coupled.
    fn couple(&mut self, pieces: Vec<(Vec<u32>, u32)>) {
        let mut open: Vec<usize> = Vec::new();
        let mut seen = vec![u32::MAX; self.rank.len()];
        for (pivots, children) in pieces {
            let own = self.nodes.len();
            let first = self.grains.len();
            let last = pivots.iter().map(|&g| self.rank[g as usize]).max().unwrap_or(0);
            pivots.iter().for_each(|&g| seen[g as usize] = own as u32);
            let mut coupled: Vec<u32> = Vec::new();
            let mut see = |grain: u32, rank: &[u32]| {
                if rank[grain as usize] > last && seen[grain as usize] != own as u32 {
                    seen[grain as usize] = own as u32;
                    coupled.push(grain);
                }
            };
            for &pivot in &pivots {
                self.links_of(pivot).iter().for_each(|&(other, _)| see(other, &self.rank));
            }
            for &child in &open[open.len() - children as usize..] {
                let Node { first, pivots, coupled, .. } = self.nodes[child];
                let from = (first + pivots) as usize;
                let theirs = &self.grains[from..from + coupled as usize];
                theirs.iter().for_each(|&grain| see(grain, &self.rank));
            }
            open.truncate(open.len() - children as usize);
            open.push(own);
            coupled.sort_unstable_by_key(|&grain| self.rank[grain as usize]);
            self.nodes.push(Node {
                first: first as u32,
                pivots: pivots.len() as u32,
                coupled: coupled.len() as u32,
                children,
            });
            self.grains.extend(pivots);
            self.grains.extend(coupled);
        }
    }

    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.nodes)
            + heap::bytes(&self.grains)
            + heap::bytes(&self.rank)
            + heap::bytes(&self.start)
            + heap::bytes(&self.links)
    }
}
