//! The triangles between the outermost grains.
//!
//! A grain is outermost where a probing sphere that comes straight at it from outside touches no other
//! one before. Grains that carry no load are not seen. The triangles are those of Delaunay between such grains, unrolled: over the way around and
//! the height of a cylinder, or over a face. At the walls beside, the outermost grains there have a
//! second corner on the wall, where the surface ends.

use std::f64::consts::TAU;

use spade::{DelaunayTriangulation, Point2, Triangulation};

use super::Corner;
use crate::Vec3;
use crate::model::Model;
use crate::state::State;
use crate::wall::{self, Room};

/// Radius of the probing sphere over the mean radius of the grains, as that of discs.
const PROBE: f64 = 1.9;
/// Corners are put off by up to this share of the mean radius before they are joined: four on a circle
/// could be joined either way.
const ASIDE: f64 = 1e-6;

/// A pack as the probing sphere meets it.
struct Sight<'a> {
    model: &'a Model,
    at: &'a [Vec3],
    room: &'a Room,
    side: usize,
    /// The grains by how far out the sphere can touch them at most, from outside.
    order: Vec<(f64, u32)>,
}

/// Where the sphere comes from: along the unit vector `out`, towards `to`.
struct Line {
    to: Vec3,
    out: Vec3,
}

/// Corners of the surface of side `side` and its triangles; none where it has no surface.
pub(super) fn find(
    model: &Model,
    state: &State,
    room: &Room,
    side: usize,
) -> (Vec<Corner>, Vec<[u32; 3]>) {
    let at = &*state.position;
    let mut sight = Sight { model, at, room, side, order: Vec::new() };
    let carrying = (0..at.len()).filter(|&i| state.carries[i]);
    sight.order = carrying.map(|i| (sight.out_of(&at[i]) + sight.reach(i), i as u32)).collect();
    sight.order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let seen: Vec<u32> =
        (0..at.len() as u32).filter(|&i| state.carries[i as usize] && sight.sees(i)).collect();
    let mut corners: Vec<Corner> =
        seen.iter().map(|&grain| Corner { grain, on: [None; 3] }).collect();
    for on in sight.edges() {
        corners.extend(
            seen.iter()
                .filter(|&&i| sight.first_at(i, on).is_none_or(|first| first == i))
                .map(|&grain| Corner { grain, on }),
        );
    }
    for on in sight.ends() {
        let nearest = seen.iter().min_by(|a, b| {
            let far = |i: u32| (sight.moved(i, on) - at[i as usize]).norm_squared();
            far(**a).total_cmp(&far(**b)).then(a.cmp(b))
        });
        corners.extend(nearest.map(|&grain| Corner { grain, on }));
    }
    let triangles = sight.join(&corners);
    (corners, triangles)
}

impl Sight<'_> {
    fn reach(&self, i: usize) -> f64 {
        self.model.radius[i] + PROBE * self.model.mean_radius
    }

    /// The axes along the unrolled surface; the first one goes around a cylinder.
    fn across(&self) -> [usize; 2] {
        let axis = wall::axis(self.side);
        match self.side % 2 {
            _ if self.room.is_round() => [1, 2],
            0 => [(axis + 2) % 3, (axis + 1) % 3],
            _ => [(axis + 1) % 3, (axis + 2) % 3],
        }
    }

    /// How far out `at` is \[m\].
    fn out_of(&self, at: &Vec3) -> f64 {
        match self.room.is_round() {
            true => self.room.from_axis(at).norm(),
            false => -wall::inward(self.side) * at[wall::axis(self.side)],
        }
    }

    /// The centre of grain `i` with its coordinates on the walls `on`.
    fn moved(&self, i: u32, on: [Option<u8>; 3]) -> Vec3 {
        let mut at = self.at[i as usize];
        for (axis, wall) in on.into_iter().enumerate() {
            if let Some(wall) = wall {
                at[axis] = self.room.position(usize::from(wall));
            }
        }
        at
    }

    /// The line on which the sphere comes at grain `i`, or at what is beside it `on` walls.
    fn line(&self, i: u32, on: [Option<u8>; 3]) -> Line {
        let at = self.moved(i, on);
        if self.room.is_round() {
            let branch = self.room.from_axis(&at);
            return Line { to: at - branch, out: branch / branch.norm().max(f64::MIN_POSITIVE) };
        }
        let (mut to, mut out) = (at, Vec3::zeros());
        let axis = wall::axis(self.side);
        to[axis] = 0.0;
        out[axis] = -wall::inward(self.side);
        Line { to, out }
    }

    /// Where the sphere stops on `line` at grain `j`, out along it \[m\]; `None` where it passes.
    fn stop(&self, line: &Line, j: u32) -> Option<f64> {
        let branch = self.at[j as usize] - line.to;
        let along = branch.dot(&line.out);
        let reach = self.reach(j as usize);
        let room = reach * reach - (branch - line.out * along).norm_squared();
        (room > 0.0).then(|| along + room.sqrt())
    }

    /// The grain that the sphere touches first on its way to grain `i`, or to what is beside it `on`
    /// walls; `None` where it comes to none.
    fn first_at(&self, i: u32, on: [Option<u8>; 3]) -> Option<u32> {
        let line = self.line(i, on);
        let mut first: Option<(f64, u32)> = None;
        for &(furthest, j) in &self.order {
            if first.is_some_and(|(stop, _)| furthest < stop) {
                break;
            }
            let Some(stop) = self.stop(&line, j) else { continue };
            if first.is_none_or(|(best, other)| stop > best || stop == best && j < other) {
                first = Some((stop, j));
            }
        }
        first.map(|(_, j)| j)
    }

    /// Whether the sphere that comes at grain `i` touches it first.
    fn sees(&self, i: u32) -> bool {
        let line = self.line(i, [None; 3]);
        let Some(own) = self.stop(&line, i) else { return false };
        let further = self.order.iter().take_while(|(furthest, _)| *furthest >= own);
        further
            .map(|&(_, j)| j)
            .filter(|&j| j != i)
            .all(|j| self.stop(&line, j).is_none_or(|stop| stop < own || stop == own && i < j))
    }

    /// The walls at the edges: one coordinate on one of them.
    fn edges(&self) -> Vec<[Option<u8>; 3]> {
        let [s, t] = self.across();
        let mut edges = Vec::new();
        for axis in [s, t] {
            for low_high in 0..2 {
                if self.room.is_round() && axis != 2 {
                    continue;
                }
                let mut on = [None; 3];
                on[axis] = Some((2 * axis + low_high) as u8);
                edges.push(on);
            }
        }
        edges
    }

    /// The four ends of a face: two coordinates on walls. A cylinder has none.
    fn ends(&self) -> Vec<[Option<u8>; 3]> {
        if self.room.is_round() {
            return Vec::new();
        }
        let [s, t] = self.across();
        let end = |k: usize| {
            let mut on = [None; 3];
            on[s] = Some((2 * s + k % 2) as u8);
            on[t] = Some((2 * t + k / 2) as u8);
            on
        };
        (0..4).map(end).collect()
    }

    /// A corner on the unrolled surface \[m\].
    fn unrolled(&self, corner: &Corner) -> [f64; 2] {
        let at = self.moved(corner.grain, corner.on);
        let [s, t] = self.across();
        let aside = |k: u32| {
            // Any numbers that differ from grain to grain.
            let mixed = (2 * corner.grain + k).wrapping_mul(0x9E37_79B9);
            ASIDE * self.model.mean_radius * (f64::from(mixed) / f64::from(u32::MAX) - 0.5)
        };
        let put = |axis: usize, place: f64, k: u32| match corner.on[axis] {
            Some(_) => place,
            None => place + aside(k),
        };
        if self.room.is_round() {
            let branch = self.room.from_axis(&at);
            let angle = branch.y.atan2(branch.x).rem_euclid(TAU);
            return [self.radius() * angle + aside(0), put(2, at.z, 1)];
        }
        [put(s, at[s], 0), put(t, at[t], 1)]
    }

    /// Radius that a cylinder is unrolled with \[m\].
    fn radius(&self) -> f64 {
        0.5 * self.room.sides()[0]
    }

    /// Joins `corners` by triangles. Around a cylinder they are laid out three times, and of the copies of
    /// a triangle the one counts whose corner that comes first is in the middle.
    fn join(&self, corners: &[Corner]) -> Vec<[u32; 3]> {
        let turns: &[f64] = if self.room.is_round() { &[0.0, -1.0, 1.0] } else { &[0.0] };
        let around = TAU * self.radius();
        let mut points = Vec::with_capacity(turns.len() * corners.len());
        for turn in turns {
            points.extend(corners.iter().map(|corner| {
                let [s, t] = self.unrolled(corner);
                Point2::new(s + turn * around, t)
            }));
        }
        let count = points.len();
        let joined = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(points);
        let Some(joined) = joined.ok().filter(|joined| joined.num_vertices() == count) else {
            return Vec::new();
        };
        let mut triangles: Vec<[u32; 3]> = joined
            .inner_faces()
            .filter_map(|face| {
                let copies = face.vertices().map(|vertex| vertex.index());
                let [a, b, c] = copies.map(|copy| copy % corners.len());
                let first = copies.into_iter().min_by_key(|copy| copy % corners.len())?;
                let least = first / corners.len() == 0;
                (least && a != b && b != c && c != a).then_some([a, b, c].map(|k| k as u32))
            })
            .collect();
        triangles.sort_unstable();
        triangles
    }
}
