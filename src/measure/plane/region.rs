//! Parts of the plane, and how much of a branch lies in them.

use crate::plane::Vec2;

/// A part of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Region {
    /// A box that leans by `tilt` about the height `middle`.
    Box {
        /// Least x and y where it does not lean \[m\].
        min: Vec2,
        /// Greatest x and y there \[m\].
        max: Vec2,
        /// Way along x over the height above the middle.
        tilt: f64,
        /// The height that stays \[m\].
        middle: f64,
    },
    /// Between two circles.
    Ring {
        /// Their centre \[m\].
        centre: Vec2,
        /// Radius of the inner one \[m\].
        inner: f64,
        /// Radius of the outer one \[m\].
        outer: f64,
    },
}

/// From where to where a segment lies in a region, as shares of its length.
pub type Piece = [f64; 2];

const NOTHING: Piece = [0.0, 0.0];

impl Region {
    /// Its area \[m²\]; 0 when there is nothing of it.
    #[must_use]
    pub fn area(&self) -> f64 {
        match *self {
            Self::Box { min, max, .. } => (max - min).map(|side| side.max(0.0)).product(),
            Self::Ring { inner, outer, .. } => {
                std::f64::consts::PI * (outer * outer - inner * inner).max(0.0)
            }
        }
    }

    /// Whether `at` is in it.
    #[must_use]
    pub fn holds(&self, at: Vec2) -> bool {
        match *self {
            Self::Box { min, max, tilt, middle } => {
                let at = upright(at, tilt, middle);
                min.x <= at.x && at.x <= max.x && min.y <= at.y && at.y <= max.y
            }
            Self::Ring { centre, inner, outer } => (inner..=outer).contains(&(at - centre).norm()),
        }
    }

    /// The pieces of the segment from `from` to `to` that lie in it, at most two.
    #[must_use]
    pub fn pieces(&self, from: Vec2, to: Vec2) -> [Piece; 2] {
        match *self {
            Self::Box { min, max, tilt, middle } => {
                let [from, to] = [from, to].map(|at| upright(at, tilt, middle));
                [between(from, to, min, max), NOTHING]
            }
            Self::Ring { centre, inner, outer } => {
                let [from, to] = [from - centre, to - centre];
                let [begin, end] = within(from, to, outer);
                match within(from, to, inner) {
                    [left, right] if left < right => [[begin, left], [right, end]],
                    _ => [[begin, end], NOTHING],
                }
            }
        }
    }
}

/// Where `at` is in the box that does not lean; a segment keeps its shares.
fn upright(at: Vec2, tilt: f64, middle: f64) -> Vec2 {
    Vec2::new(at.x - tilt * (at.y - middle), at.y)
}

fn between(from: Vec2, to: Vec2, min: Vec2, max: Vec2) -> Piece {
    let mut piece = [0.0_f64, 1.0_f64];
    for axis in 0..2 {
        let (at, way) = (from[axis], to[axis] - from[axis]);
        if way == 0.0 {
            if at < min[axis] || at > max[axis] {
                return NOTHING;
            }
            continue;
        }
        let (one, other) = ((min[axis] - at) / way, (max[axis] - at) / way);
        piece = [piece[0].max(one.min(other)), piece[1].min(one.max(other))];
    }
    if piece[0] < piece[1] { piece } else { NOTHING }
}

/// The piece within a circle about the origin.
fn within(from: Vec2, to: Vec2, radius: f64) -> Piece {
    let way = to - from;
    let (a, b) = (way.norm_squared(), from.dot(&way));
    let under = b * b - a * (from.norm_squared() - radius * radius);
    if a == 0.0 || under <= 0.0 {
        return NOTHING;
    }
    let root = under.sqrt();
    let piece = [((-b - root) / a).max(0.0), ((-b + root) / a).min(1.0)];
    if piece[0] < piece[1] { piece } else { NOTHING }
}
