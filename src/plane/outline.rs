//! The outline of a pack: the grains that a disc touches which rolls around it.
//!
//! The rolling disc has the pack on its left and goes round each grain to the left, until it touches
//! another one. Holes that it does not fit into are inside.

use super::Vec2;
use crate::Vec3;
use crate::contact::cells::Cells;

/// Radius of the rolling disc over the mean radius of the grains: about a mean diameter, but no simple
/// multiple of the distances in a crystal.
const ROLLER: f64 = 1.9;
/// A disc that touches three grains at once may seem to have passed the third by this angle \[rad\].
const ROUNDING: f64 = 1e-9;

/// Where the disc rolls.
#[derive(Clone, Copy, Debug)]
pub(super) enum Course {
    /// Along an axis (1) from a side at one place to a side at another \[m\].
    Between([f64; 2]),
    /// Around all grains; the place is that of their middle along the second axis \[m\].
    Around(f64),
    /// Around the hole with this middle \[m\].
    Within(Vec2),
}

/// A pack seen along two axes, the first of which points out of it.
pub(super) struct Pack<'a> {
    pub(super) at: &'a [Vec2],
    pub(super) radius: &'a [f64],
    pub(super) mean_radius: f64,
    pub(super) axes: [Vec2; 2],
}

/// Scratch.
#[derive(Clone, Debug, Default)]
pub(super) struct Finder {
    cells: Cells,
    positions: Vec<Vec3>,
}

impl Finder {
    pub(super) fn heap_bytes(&self) -> usize {
        self.cells.heap_bytes() + crate::heap::bytes(&self.positions)
    }
}

/// Where the disc is: the grain that it touches, and the direction from there \[rad\].
#[derive(Clone, Copy)]
struct Place {
    grain: u32,
    angle: f64,
}

impl Pack<'_> {
    fn local(&self, grain: u32) -> Vec2 {
        let at = self.at[grain as usize];
        Vec2::new(at.dot(&self.axes[0]), at.dot(&self.axes[1]))
    }

    fn roller(&self) -> f64 {
        ROLLER * self.mean_radius
    }

    /// Distance of the centres of a grain and the disc that touches it.
    fn reach(&self, grain: u32) -> f64 {
        self.radius[grain as usize] + self.roller()
    }

    /// Where the disc first touches a grain that comes straight along the first axis at the place `along`
    /// on the second, inwards from beyond all grains or from `from`; the first of equals.
    fn land(&self, along: f64, from: f64) -> Option<Place> {
        self.strike(
            along,
            |centre, half| Some(centre + half).filter(|&stop| stop < from),
            |a, b| a > b,
        )
    }

    /// The same for a disc that comes outwards from `from`.
    fn land_outwards(&self, along: f64, from: f64) -> Option<Place> {
        self.strike(
            along,
            |centre, half| Some(centre - half).filter(|&stop| stop > from),
            |a, b| a < b,
        )
    }

    fn strike(
        &self,
        along: f64,
        stop: impl Fn(f64, f64) -> Option<f64>,
        nearer: impl Fn(f64, f64) -> bool,
    ) -> Option<Place> {
        let mut first: Option<(f64, Place)> = None;
        for grain in 0..self.at.len() as u32 {
            let (at, reach) = (self.local(grain), self.reach(grain));
            let aside = along - at.y;
            if aside.abs() >= reach {
                continue;
            }
            let half = (reach * reach - aside * aside).sqrt();
            let Some(stop) = stop(at.x, half) else { continue };
            if first.is_none_or(|(best, _)| nearer(stop, best)) {
                first = Some((stop, Place { grain, angle: aside.atan2(stop - at.x) }));
            }
        }
        first.map(|(_, place)| place)
    }
}

/// How far to turn from the angle `from` to the left to be at `to` \[rad\], 0 to 2π.
fn turn(from: f64, to: f64) -> f64 {
    let turn = (to - from).rem_euclid(std::f64::consts::TAU);
    if turn > std::f64::consts::TAU - ROUNDING { 0.0 } else { turn }
}

impl Finder {
    /// Finds the grains along `course` in their order into `chain`; none where the disc finds no way.
    pub(super) fn find(&mut self, pack: &Pack<'_>, course: Course, chain: &mut Vec<u32>) {
        chain.clear();
        let roller = pack.roller();
        let start = match course {
            Course::Between([low, _]) => pack.land(low + roller, f64::INFINITY),
            Course::Around(middle) => pack.land(middle, f64::INFINITY),
            Course::Within(middle) => pack.land_outwards(middle.y, middle.x),
        };
        let Some(start) = start else { return };
        let largest = pack.radius.iter().fold(0.0_f64, |most, r| most.max(*r));
        self.positions.clear();
        self.positions.extend(pack.at.iter().map(|at| Vec3::new(at.x, at.y, 0.0)));
        self.cells.sort(&self.positions, 2.0 * (largest + roller));
        let mut place = start;
        chain.push(place.grain);
        for _ in 0..4 * pack.at.len() {
            let next = self.next(pack, place);
            let most = next.map_or(f64::INFINITY, |(turn, _)| turn);
            match course {
                Course::Between([low, high]) => {
                    // On its way up it ends at the other side; on its way down it is between a grain
                    // that stands alone and the rest.
                    let (at, reach) = (pack.local(place.grain), pack.reach(place.grain));
                    let up = ((high - roller - at.y) / reach).asin();
                    let down = std::f64::consts::PI - ((low + roller - at.y) / reach).asin();
                    // What it does not come to is infinitely far.
                    let [up, down] = [up, down].map(|to| match to.is_nan() {
                        true => f64::INFINITY,
                        false => turn(place.angle, to),
                    });
                    if up <= most && up <= down && up.is_finite() {
                        return;
                    }
                    if down > 0.0 && down < most {
                        let from = at.x + reach * (place.angle + down).cos();
                        let Some(after) = pack.land(low + roller, from) else { break };
                        place = after;
                        chain.clear();
                        chain.push(place.grain);
                        continue;
                    }
                }
                Course::Around(_) | Course::Within(_) => {
                    let back = place.grain == start.grain && chain.len() > 1;
                    // Where it began it may have touched two grains at once.
                    if back && turn(place.angle, start.angle) <= most + ROUNDING {
                        // The first grain stands at the end too.
                        chain.pop();
                        return;
                    }
                }
            }
            let Some((_, next)) = next else { break };
            place = next;
            chain.push(place.grain);
        }
        chain.clear();
    }

    /// How far the disc turns about its grain until it touches the next one, and where it is then.
    fn next(&self, pack: &Pack<'_>, place: Place) -> Option<(f64, Place)> {
        let Place { grain, angle } = place;
        let (at, reach) = (pack.local(grain), pack.reach(grain));
        let mut best: Option<(f64, Place)> = None;
        self.cells.for_each_near(&self.positions[grain as usize], |other| {
            if other == grain {
                return;
            }
            let (to, its) = (pack.local(other) - at, pack.reach(other));
            let distance = to.norm();
            let cosine =
                (reach * reach + distance * distance - its * its) / (2.0 * reach * distance);
            if cosine.abs() >= 1.0 {
                return;
            }
            // It comes to the circle around the other grain from the right.
            let meets = to.y.atan2(to.x) - cosine.acos();
            let turn = turn(angle, meets);
            let nearer = best
                .is_none_or(|(least, place)| turn < least || turn == least && other < place.grain);
            if nearer {
                let centre = at + Vec2::new(meets.cos(), meets.sin()) * reach;
                let branch = centre - pack.local(other);
                let angle = branch.y.atan2(branch.x);
                best = Some((turn, Place { grain: other, angle }));
            }
        });
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXES: [Vec2; 2] = [Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0)];

    fn find(at: &[Vec2], course: Course) -> Vec<u32> {
        let radius = vec![1.0; at.len()];
        let pack = Pack { at, radius: &radius, mean_radius: 1.0, axes: AXES };
        let mut chain = Vec::new();
        Finder::default().find(&pack, course, &mut chain);
        chain
    }

    /// Rows of a square lattice from the bottom up.
    fn lattice(columns: usize, rows: usize) -> Vec<Vec2> {
        let place =
            |k: usize| Vec2::new(2.0 * (k % columns) as f64, 2.0 * (k / columns) as f64 + 1.0);
        (0..columns * rows).map(place).collect()
    }

    #[test]
    fn the_side_of_a_lattice_is_its_last_column() {
        let at = lattice(4, 6);
        assert_eq!(find(&at, Course::Between([0.0, 12.0])), [3, 7, 11, 15, 19, 23]);
        let mut around = find(&at, Course::Around(6.0));
        let least = around.iter().position(|&grain| grain == 0).unwrap();
        around.rotate_left(least);
        let want = [0, 1, 2, 3, 7, 11, 15, 19, 23, 22, 21, 20, 16, 12, 8, 4];
        assert_eq!(around, want);
    }

    #[test]
    fn a_hole_is_walked_around_the_other_way() {
        let mut at = lattice(5, 5);
        let hole = at[12];
        at.retain(|&place| (place - hole).norm() > 3.0);
        let chain = find(&at, Course::Within(hole));
        // The ring of eight is gone with the middle: the sixteen grains around them are left.
        let angle = |grain: u32| {
            let to = at[grain as usize] - hole;
            to.y.atan2(to.x)
        };
        let steps = chain.iter().zip(chain.iter().cycle().skip(1));
        assert!(chain.len() >= 8);
        assert!(steps.map(|(a, b)| turn(angle(*b), angle(*a))).all(|turn| turn < 2.0));
    }

    #[test]
    fn a_grain_that_stands_alone_is_left_outside() {
        let mut at = lattice(2, 6);
        at.push(Vec2::new(12.0, 1.0));
        assert_eq!(find(&at, Course::Between([0.0, 12.0])), [1, 3, 5, 7, 9, 11]);
        // A gap that the disc does not fit into is no part of the outline.
        let mut at = lattice(3, 6);
        at.remove(8);
        let chain = find(&at, Course::Between([0.0, 12.0]));
        assert_eq!(chain, [2, 5, 10, 13, 16]);
    }
}
