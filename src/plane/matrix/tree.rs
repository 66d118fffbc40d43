//! Nested dissection: the order in which grains are eliminated, and what each elimination couples.

use crate::heap;

/// A piece of at most this many grains is not cut further.
const LEAF: usize = 6;
/// How far from the middle a piece may be cut, over its grains.
const ASKEW: f64 = 0.2;
/// Place of a grain that is not of the piece.
const ELSEWHERE: u32 = u32::MAX;

/// A cut of a piece in two, between grains sorted along an axis.
#[derive(Clone, Copy, Debug)]
struct Cut {
    /// First grain behind it.
    at: usize,
    /// Whether those behind it part the halves, or those before it.
    from_far: bool,
    /// How many part them, and more where the halves differ.
    cost: f64,
}

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
        let mut place = vec![ELSEWHERE; n];
        self.dissect((0..n as u32).collect(), position, &mut place, &mut pieces);
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

    /// Grains of `node`: those that it eliminates, then those that it couples.
    pub(super) fn grains_of(&self, node: &Node) -> &[u32] {
        let first = node.first as usize;
        &self.grains[first..first + (node.pivots + node.coupled) as usize]
    }

    /// The pairs of a grain: the other one, and the entry of the list.
    pub(super) fn links_of(&self, grain: u32) -> &[(u32, u32)] {
        let i = grain as usize;
        &self.links[self.start[i] as usize..self.start[i + 1] as usize]
    }

    /// Cuts `piece` in two, leaves a line of grains between the halves, and adds the pieces to `pieces`,
    /// each with the number of its children. Says how many it added at the top.
    fn dissect(
        &self,
        mut piece: Vec<u32>,
        position: &[[f64; 2]],
        place: &mut [u32],
        pieces: &mut Vec<(Vec<u32>, u32)>,
    ) -> u32 {
        if piece.len() <= LEAF {
            if piece.is_empty() {
                return 0;
            }
            pieces.push((piece, 0));
            return 1;
        }
        let along = self.best_cut(&mut piece, 1, position, place);
        let mut cut = self.best_cut(&mut piece, 0, position, place);
        if along.cost < cut.cost {
            cut = self.best_cut(&mut piece, 1, position, place);
        }
        let far = piece.split_off(cut.at);
        // Grains of one half that touch the other part the two.
        let (near, other) = if cut.from_far { (far, piece) } else { (piece, far) };
        let (between, near): (Vec<u32>, Vec<u32>) = near.into_iter().partition(|&grain| {
            let mut places = self.links_of(grain).iter().map(|&(other, _)| place[other as usize]);
            places.any(|at| at != ELSEWHERE && (at as usize >= cut.at) != cut.from_far)
        });
        for &grain in between.iter().chain(&near).chain(&other) {
            place[grain as usize] = ELSEWHERE;
        }
        let children = self.dissect(near, position, place, pieces)
            + self.dissect(other, position, place, pieces);
        if between.is_empty() {
            return children;
        }
        pieces.push((between, children));
        1
    }

    /// The best cut of `piece` across `axis`, which sorts it along that and writes down the places.
    fn best_cut(
        &self,
        piece: &mut [u32],
        axis: usize,
        position: &[[f64; 2]],
        place: &mut [u32],
    ) -> Cut {
        piece.sort_unstable_by(|&a, &b| {
            position[a as usize][axis].total_cmp(&position[b as usize][axis]).then(a.cmp(&b))
        });
        let count = piece.len();
        for (k, &grain) in piece.iter().enumerate() {
            place[grain as usize] = k as u32;
        }
        // By how much the grains before and behind a cut that touch across it are more than at the last.
        let mut more = vec![[0_i32; 2]; count + 1];
        for (k, &grain) in piece.iter().enumerate() {
            let places = self.links_of(grain).iter().map(|&(other, _)| place[other as usize]);
            let (first, last) = places
                .filter(|at| *at != ELSEWHERE)
                .fold((k, k), |(low, high), at| (low.min(at as usize), high.max(at as usize)));
            more[k + 1][0] += 1;
            more[last + 1][0] -= 1;
            more[first + 1][1] += 1;
            more[k + 1][1] -= 1;
        }
        let mut best = Cut { at: count / 2, from_far: false, cost: f64::INFINITY };
        let mut touching = [0; 2];
        for (at, more) in more.iter().enumerate() {
            touching = [touching[0] + more[0], touching[1] + more[1]];
            let askew = (at as f64 / count as f64 - 0.5).abs();
            if askew > ASKEW || at == 0 || at == count {
                continue;
            }
            for (from_far, touching) in [false, true].into_iter().zip(touching) {
                let cost = f64::from(touching) * (1.0 + (2.0 * askew).powi(2));
                if cost < best.cost {
                    best = Cut { at, from_far, cost };
                }
            }
        }
        best
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
