//! Fewer rings with the same force.

use super::rings;
use crate::Vec3;
use crate::pack::Layer;

/// The most layers a contact keeps.
pub const MOST_LAYERS: usize = 32;

/// A change of ∫ D dx by less than this share of the overlap is like rounding.
const NEGLIGIBLE: f64 = 1e-13;

/// Unites neighbours with equal D, and then those that matter least until few enough remain.
pub(super) fn unite(layers: &mut Vec<Layer>) {
    let negligible = NEGLIGIBLE * layers.last().map_or(0.0, |rim| rim.reach);
    for k in (1..layers.len()).rev() {
        if cost(layers, k) <= negligible {
            join(layers, k);
        }
    }
    while layers.len() > MOST_LAYERS {
        let least = (1..layers.len()).min_by(|&a, &b| cost(layers, a).total_cmp(&cost(layers, b)));
        if let Some(k) = least {
            join(layers, k);
        }
    }
}

fn difference(inner: &Layer, outer: &Layer) -> f64 {
    (Vec3::from(outer.ratio) - Vec3::from(inner.ratio)).norm()
}

/// Widths \[m\] and shares of the force, both without common factors, of the rings k-1 and k.
fn measure(layers: &[Layer], k: usize) -> [(f64, f64); 2] {
    let start = if k > 1 { layers[k - 2].reach } else { 0.0 };
    let ring = |inner: f64, outer: f64| {
        let width = outer - inner;
        let force = if outer > 0.0 { width * rings::secant(1.0, inner, outer) } else { 0.0 };
        (width, force)
    };
    [ring(start, layers[k - 1].reach), ring(layers[k - 1].reach, layers[k].reach)]
}

/// Change of ∫ D dx when k-1 and k become one with the same force \[m\].
fn cost(layers: &[Layer], k: usize) -> f64 {
    let [(width_a, force_a), (width_b, force_b)] = measure(layers, k);
    let force = force_a + force_b;
    if force > 0.0 {
        let moved = (force_b * width_a - force_a * width_b).abs() / force;
        difference(&layers[k - 1], &layers[k]) * moved
    } else {
        0.0
    }
}

/// Makes one ring of k-1 and k; its D is a mean, so no longer than theirs.
fn join(layers: &mut Vec<Layer>, k: usize) {
    let [(_, force_a), (_, force_b)] = measure(layers, k);
    let outer = layers.remove(k);
    let ring = &mut layers[k - 1];
    ring.reach = outer.reach;
    let share = if force_a + force_b > 0.0 { force_b / (force_a + force_b) } else { 1.0 };
    for (own, other) in ring.ratio.iter_mut().zip(outer.ratio) {
        *own += share * (other - *own);
    }
}
