//! How far slip goes inwards in a step.

use super::rings::{self, Ring};
use super::{Contact, Step};
use crate::Vec3;
use crate::pack::Layer;

/// The rings after a step: the old ones up to `core`, then one with D = `ratio`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settled {
    pub(super) core: f64,
    pub(super) ratio: Vec3,
    pub(super) regime: Regime,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Regime {
    /// What came into contact took the displacement.
    Stuck,
    /// The punches outside the core slipped.
    Partial,
    /// All punches slipped, the largest by |v(0)| = `distance` in units of μ/η \[m\].
    Gross { distance: f64 },
}

/// -(η/μ) u: the displacement of a step \[m\] in the units of overlap and along the force.
pub(super) fn pull(contact: &Contact, step: &Step) -> Vec3 {
    -step.displacement * (contact.ratio / contact.friction)
}

/// Finds the rings after `step` to a positive overlap.
pub(super) fn settle(contact: &Contact, layers: &[Layer], step: &Step) -> Settled {
    let end = rings::end(layers, step.before);
    let mut v = pull(contact, step);
    let rise = step.overlap - end;
    if rise > 0.0 && length(v) <= rise {
        return Settled { core: end, ratio: v / rise, regime: Regime::Stuck };
    }
    for ring in rings::of(layers, step.before).rev() {
        let outer = ring.outer.min(step.overlap);
        // Rings that lost contact hand on what they took.
        v += ring.ratio * (ring.outer - outer.max(ring.inner));
        if outer < ring.inner {
            continue;
        }
        let ring = Ring { outer, ..ring };
        let depth = depth(v, step.overlap - outer, &ring.ratio);
        if depth <= ring.width() {
            let e = direction(v + ring.ratio * depth);
            return Settled { core: outer - depth, ratio: e, regime: Regime::Partial };
        }
        v += ring.ratio * ring.width();
    }
    // Rounding may leave |v| a little short of what brought the search here.
    let distance = length(v).max(step.overlap);
    Settled { core: 0.0, ratio: direction(v), regime: Regime::Gross { distance } }
}

/// The x >= 0 with |v + D x| = gap + x, where |v| >= gap >= 0 and |D| <= 1; none is infinite or
/// NaN.
fn depth(v: Vec3, gap: f64, ratio: &Vec3) -> f64 {
    // a x² + 2 b x - c = 0 with a, c >= 0; what is negative here is rounding.
    let size = length(v);
    let c = (size - gap) * (size + gap);
    if c <= 0.0 {
        return 0.0;
    }
    let a = (1.0 - ratio.norm_squared()).max(0.0);
    let b = gap - v.dot(ratio);
    let root = (b * b + a * c).sqrt();
    if b < 0.0 { (root - b) / a } else { c / (b + root) }
}

/// |v|, also where its square is out of range.
fn length(v: Vec3) -> f64 {
    let largest = v.amax();
    if largest > 0.0 { largest * (v / largest).norm() } else { 0.0 }
}

fn direction(v: Vec3) -> Vec3 {
    let largest = v.amax();
    if largest > 0.0 { (v / largest).normalize() } else { Vec3::zeros() }
}
