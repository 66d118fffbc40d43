//! What discs are compacted in.

use std::f64::consts::PI;

use nalgebra::Vector2;

/// Smooth walls around the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Frame {
    /// A rectangle with half of its sides \[m\]. All four walls move.
    Box { half: [f64; 2] },
    /// The space between two circles \[m\]. The outer wall moves, the inner one stands.
    Annulus { inner: f64, outer: f64 },
}

/// A disc at a wall.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    /// Direction in which the wall pushes.
    pub(super) inward: Vector2<f64>,
    /// Mutual approach \[m\].
    pub(super) overlap: f64,
    /// What a force of the wall adds to the stress along x and y, times the volume \[m\].
    pub(super) lever: [f64; 2],
}

impl Frame {
    /// Half of the sides of the rectangle around it \[m\].
    pub(super) fn half(&self) -> [f64; 2] {
        match *self {
            Self::Box { half } => half,
            Self::Annulus { outer, .. } => [outer; 2],
        }
    }

    /// Area \[m²\].
    pub(super) fn area(&self) -> f64 {
        match *self {
            Self::Box { half: [x, y] } => 4.0 * x * y,
            Self::Annulus { inner, outer } => PI * (outer * outer - inner * inner),
        }
    }

    /// What contacts of two discs add to the stress: in a box it is the mean of the pack, in an annulus
    /// that of the outer wall.
    pub(super) fn counts_pairs(&self) -> bool {
        matches!(self, Self::Box { .. })
    }

    /// Tells of every wall that a disc at `at` touches.
    pub(super) fn each_wall(&self, at: Vector2<f64>, radius: f64, mut tell: impl FnMut(Wall)) {
        let mut touch = |wall: Wall| {
            if wall.overlap > 0.0 {
                tell(wall);
            }
        };
        match *self {
            Self::Box { half } => {
                for (axis, sign) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)] {
                    let overlap = sign * at[axis] + radius - half[axis];
                    let (mut inward, mut lever) = (Vector2::zeros(), [0.0; 2]);
                    (inward[axis], lever[axis]) = (-sign, radius - overlap);
                    touch(Wall { inward, overlap, lever });
                }
            }
            Self::Annulus { inner, outer } => {
                let far = at.norm();
                // The centre of an annulus has no direction; it is deep inside the inner wall.
                let outward = if far > 0.0 { at / far } else { Vector2::x() };
                let lever = [self.area() / (2.0 * PI * outer); 2];
                touch(Wall { inward: -outward, overlap: far + radius - outer, lever });
                touch(Wall { inward: outward, overlap: inner + radius - far, lever: [0.0; 2] });
            }
        }
    }

    /// Way of a point that goes with the walls at a strain of the sides, of an annulus that of its outer
    /// radius, which is the first one. The area between changes alike everywhere.
    pub(super) fn carried(&self, at: Vector2<f64>, strain: [f64; 2]) -> Vector2<f64> {
        match *self {
            Self::Box { .. } => Vector2::new(at.x * strain[0], at.y * strain[1]),
            Self::Annulus { inner, outer } => {
                let shrunk = |r2: f64| 1.0 - inner * inner / r2;
                at * (strain[0] * shrunk(at.norm_squared()) / shrunk(outer * outer))
            }
        }
    }

    /// Largest shortening of a line at a strain.
    pub(super) fn shortening(&self, strain: [f64; 2]) -> f64 {
        let closer = |strain: f64| (-strain).max(0.0);
        match *self {
            Self::Box { .. } => closer(strain[0]).max(closer(strain[1])),
            // Along the radius at the inner wall.
            Self::Annulus { inner, outer } => {
                2.0 * closer(strain[0]) / (1.0 - (inner / outer).powi(2))
            }
        }
    }

    /// Moves the walls.
    pub(super) fn strain(&mut self, strain: [f64; 2]) {
        match self {
            Self::Box { half } => {
                half.iter_mut().zip(strain).for_each(|(side, e)| *side *= 1.0 + e);
            }
            Self::Annulus { outer, .. } => *outer *= 1.0 + strain[0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RING: Frame = Frame::Annulus { inner: 0.4, outer: 1.2 };

    /// By finite differences: the area between changes alike everywhere, and neither wall is left.
    #[test]
    fn what_goes_with_the_walls_of_an_annulus_fills_it_evenly() {
        let strain = [-1e-2, 0.0];
        let way = |x: f64, y: f64| RING.carried(Vector2::new(x, y), strain);
        let step = 1e-5;
        let change = |x: f64, y: f64| {
            let along_x = (way(x + step, y) - way(x - step, y)).x;
            let along_y = (way(x, y + step) - way(x, y - step)).y;
            (along_x + along_y) / (2.0 * step)
        };
        let mut after = RING;
        after.strain(strain);
        for (x, y) in [(0.4, 0.0), (0.3, 0.6), (-0.8, 0.2), (0.0, -1.2)] {
            // A first derivative of the area over the outer radius.
            let whole = 2.0 * 1.2 * 1.2 * strain[0] / (1.2 * 1.2 - 0.4 * 0.4);
            assert!((change(x, y) / whole - 1.0).abs() < 1e-8, "{x} {y}");
            let shortest = [0.0, 0.3, 1.1, 2.0].map(|turn: f64| {
                let (c, s) = (turn.cos() * step, turn.sin() * step);
                (way(x + c, y + s) - way(x, y)).dot(&Vector2::new(c, s)) / (step * step)
            });
            assert!(shortest.iter().all(|e| -e <= RING.shortening(strain) * (1.0 + 1e-4)));
        }
        let outer = way(1.2, 0.0).x + 1.2;
        assert!((after.half()[0] - outer).abs() < 1e-15);
        assert!(way(0.0, 0.4).norm() < 1e-17);
    }

    #[test]
    fn walls_push_inwards_where_they_are_touched() {
        let at = |x: f64, y: f64, frame: Frame| {
            let mut found = Vec::new();
            frame.each_wall(Vector2::new(x, y), 0.1, |wall| {
                found.push(([wall.inward.x, wall.inward.y], wall.overlap));
            });
            found
        };
        let close = |found: &[([f64; 2], f64)], inward: [f64; 2], overlap: f64| {
            let [(push, depth)] = found else { panic!("{found:?}") };
            assert!((depth - overlap).abs() < 1e-12, "{found:?}");
            assert!((push[0] - inward[0]).hypot(push[1] - inward[1]) < 1e-12, "{found:?}");
        };
        close(&at(0.0, 1.15, RING), [0.0, -1.0], 0.05);
        close(&at(-0.27, 0.36, RING), [-0.6, 0.8], 0.05);
        assert!(at(0.6, 0.6, RING).is_empty());
        let rectangle = Frame::Box { half: [1.0, 2.0] };
        close(&at(-0.93, 1.0, rectangle), [1.0, 0.0], 0.03);
        close(&at(0.5, 1.96, rectangle), [0.0, -1.0], 0.06);
        assert_eq!(at(0.95, -1.95, rectangle).len(), 2);
    }
}
