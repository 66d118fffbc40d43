//! Strain of a network of contacts from the ways of the grains (B appendix 5, 6.2).
//!
//! The contacts divide the plane into cells. h of a contact goes from the middle of the cell on its
//! right to that on its left, and turned by a right angle is dual to the branch d: over all contacts
//! ½ d h_n adds up to the area O of the cells (A.47), and d_i h_j to O δ_ij. So the strain of an even
//! motion is told exactly by A.51. A.49 and A.50 have a factor of ½ that A.51 has not, and give half
//! of it: that, and not that h does not stay, is the error of 100 % in A.54.

use crate::contact::Other;
use crate::measure::contacts::Contact;
use crate::plane::{Vec2, left_of};

/// Strains, shrinking positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Strain {
    /// O: area of the cells \[m²\].
    pub area: f64,
    /// xx, yy and xy by A.51.
    pub network: [f64; 3],
    /// xx and yy by A.49 and A.50.
    pub printed: [f64; 2],
}

/// An edge from one grain to another; its twin goes back.
#[derive(Clone, Copy)]
struct Edge {
    from: u32,
    to: u32,
    angle: f64,
}

/// The strain of the grains that are at `at` and went by `way` \[m\], from their `contacts`.
#[must_use]
pub fn strain(at: &[Vec2], way: &[Vec2], contacts: &[Contact]) -> Strain {
    let mut edges = Vec::with_capacity(2 * contacts.len());
    for contact in contacts {
        let Other::Grain(second) = contact.second else { continue };
        for [from, to] in [[contact.first, second], [second, contact.first]] {
            let branch = at[to as usize] - at[from as usize];
            edges.push(Edge { from, to, angle: branch.y.atan2(branch.x) });
        }
    }
    edges.sort_unstable_by(|one, other| {
        (one.from.cmp(&other.from))
            .then(one.angle.total_cmp(&other.angle))
            .then(one.to.cmp(&other.to))
    });
    let middles = middles(at, &edges);
    let mut sum = Strain::default();
    for (place, edge) in edges.iter().enumerate().filter(|(_, edge)| edge.from < edge.to) {
        let [from, to] = [edge.from as usize, edge.to as usize];
        let branch = at[to] - at[from];
        let half = at[from] + 0.5 * branch;
        let right = middles[twin(&edges, place)].unwrap_or(half);
        let left = middles[place].unwrap_or(half);
        // Turned to the right it is along the branch, where the cells lie on both sides of it.
        let h = -left_of(left - right);
        let gone = way[to] - way[from];
        sum.area += 0.5 * branch.dot(&h);
        sum.network[0] -= gone.x * h.x;
        sum.network[1] -= gone.y * h.y;
        sum.network[2] -= 0.5 * (gone.x * h.y + gone.y * h.x);
        let normal = branch / branch.norm();
        let (c, s) = (normal.x, normal.y);
        let across = Vec2::new(s, -c);
        let (along, aside) = (gone.dot(&normal), gone.dot(&across));
        let (h_n, h_s) = (h.dot(&normal), h.dot(&across));
        sum.printed[0] -= 0.5 * (along * h_n * c * c + aside * (s * c * h_n + s * s * h_s));
        sum.printed[1] -= 0.5 * (along * h_n * s * s + aside * (-s * c * h_n + c * c * h_s));
    }
    if sum.area > 0.0 {
        sum.network = sum.network.map(|part| part / sum.area);
        sum.printed = sum.printed.map(|part| part / sum.area);
    }
    sum
}

/// The middle of the cell to the left of each edge; nothing where that is the outside.
fn middles(at: &[Vec2], edges: &[Edge]) -> Vec<Option<Vec2>> {
    let mut middles = vec![None; edges.len()];
    let mut seen = vec![false; edges.len()];
    let mut cell = Vec::new();
    for begin in 0..edges.len() {
        if seen[begin] {
            continue;
        }
        cell.clear();
        let mut place = begin;
        while !seen[place] {
            seen[place] = true;
            cell.push(place);
            place = before(edges, twin(edges, place));
        }
        let corner = |place: &usize| at[edges[*place].from as usize];
        let origin = corner(&begin);
        let area: f64 = (cell.iter())
            .map(|place| {
                let from = corner(place) - origin;
                let to = at[edges[*place].to as usize] - origin;
                from.perp(&to)
            })
            .sum();
        if area > 0.0 {
            let sum: Vec2 = cell.iter().map(corner).sum();
            let middle = sum / cell.len() as f64;
            cell.iter().for_each(|&place| middles[place] = Some(middle));
        }
    }
    middles
}

/// The edge back.
fn twin(edges: &[Edge], place: usize) -> usize {
    let Edge { from, to, .. } = edges[place];
    let begin = edges.partition_point(|edge| edge.from < to);
    let back = edges[begin..].iter().position(|edge| edge.to == from);
    // Edges come in pairs.
    begin + back.unwrap_or(0)
}

/// The next edge to the right about the grain that the edge begins at.
fn before(edges: &[Edge], place: usize) -> usize {
    let from = edges[place].from;
    match place.checked_sub(1).filter(|&before| edges[before].from == from) {
        Some(before) => before,
        None => edges.partition_point(|edge| edge.from <= from) - 1,
    }
}
