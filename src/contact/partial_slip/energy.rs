//! Energy of the rings: what they store, and what slip turns into heat.

use super::rings::{self, Ring};
use super::settle::{Regime, Settled, pull, settle};
use super::{Contact, Step};
use crate::Vec3;
use crate::contact::hertz;
use crate::pack::Layer;

/// U = μ/η ∫ Q(x)·D dx of `rings` from inside outwards \[J\].
pub(super) fn stored(contact: &Contact, rings: impl Iterator<Item = Ring>) -> f64 {
    let mut force = Vec3::zeros();
    let mut energy = 0.0;
    for ring in rings {
        let own = contact.friction * ring.ratio.norm_squared() * rise(contact.modulus, &ring);
        energy += force.dot(&ring.ratio) * ring.width() + own;
        force += rings::share(contact, &ring);
    }
    contact.friction / contact.ratio * energy
}

/// ∫ (P(x) - P(inner)) dx over a ring \[N m\]: a polynomial in √x with no difference in it.
fn rise(modulus: f64, ring: &Ring) -> f64 {
    if ring.outer <= 0.0 {
        return 0.0;
    }
    let (low, high) = (ring.inner.sqrt(), ring.outer.sqrt());
    let z = ring.width() / (low + high);
    modulus * z * z * (3.0 * low.powi(3) + z * (4.0 * low * low + z * (2.0 * low + 0.4 * z)))
}

/// See [`Contact::dissipated`]; the step may end at overlap 0.
pub(super) fn dissipated(contact: &Contact, layers: &[Layer], step: &Step) -> f64 {
    let settled = settle(contact, layers, step);
    let end = rings::end(layers, step.before);
    let rise = step.overlap - end;
    // Slip reaches x when the share s of the step is done: s·pull + taken = end + s·rise - x.
    let pace = pull(contact, step).dot(&settled.ratio) - rise;
    lost(contact, layers, step, &settled, end, |x, taken| {
        let share = if pace > 0.0 { ((end - x - taken) / pace).clamp(0.0, 1.0) } else { 1.0 };
        end + share * rise
    })
}

/// See [`Contact::potential`].
///
/// At fixed overlaps what came into contact answers as one spring, with the mean of the stiffness
/// that it gathers on the way; the energy of that spring replaces what the way stores.
pub(super) fn potential(contact: &Contact, layers: &[Layer], step: &Step) -> f64 {
    let settled = settle(contact, layers, step);
    let end = rings::end(layers, step.before);
    let new = Ring { inner: settled.core, outer: step.overlap, ratio: settled.ratio };
    let after = rings::within(layers, step.before, settled.core).chain([new]);
    let heat = lost(contact, layers, step, &settled, end.min(step.overlap), |_, _| step.overlap);
    let touched = Ring { inner: end, outer: step.overlap.max(end), ratio: settled.ratio };
    let spring = 0.5 * rings::share(contact, &touched).dot(&touched.ratio) * touched.width();
    let way = contact.friction * touched.ratio.norm_squared() * rise(contact.modulus, &touched);
    stored(contact, after) + heat + contact.friction / contact.ratio * (spring - way)
}

/// Heat \[J\] of the slip from `rim` to the core: μ²/η times the integral of (1 - e·D) times
///
/// ```text
/// P(h) - P(x) - (h - x) P'(x) = M (√h - √x)² (√h + √x/2)
/// ```
///
/// plus μP times the distance of gross slip. `overlap_at` tells the overlap h at which slip reaches
/// an edge, from its x and from what the rings between rim and x had taken along e; between two
/// edges h is linear in x.
fn lost(
    contact: &Contact,
    layers: &[Layer],
    step: &Step,
    settled: &Settled,
    rim: f64,
    overlap_at: impl Fn(f64, f64) -> f64,
) -> f64 {
    if let Regime::Stuck = settled.regime {
        return 0.0;
    }
    let scale = contact.friction * contact.friction / contact.ratio;
    let mut taken = 0.0;
    let mut heat = 0.0;
    let mut gap_outer = (overlap_at(rim, taken) - rim).max(0.0);
    for ring in rings::of(layers, step.before).rev() {
        let (inner, outer) = (ring.inner.max(settled.core), ring.outer.min(rim));
        if outer <= inner {
            continue;
        }
        let share = ring.ratio.dot(&settled.ratio);
        taken += share * (outer - inner);
        let reached = if inner > ring.inner { step.overlap } else { overlap_at(inner, taken) };
        let gap_inner = (reached - inner).max(0.0);
        heat += (1.0 - share).max(0.0) * Slipping { inner, outer, gap_inner, gap_outer }.heat();
        gap_outer = gap_inner;
    }
    heat *= scale * contact.modulus;
    if let Regime::Gross { distance } = settled.regime {
        let limit =
            mean(|s| hertz::force(contact.modulus, gap_outer + s * (step.overlap - gap_outer)));
        heat += scale * (distance - step.overlap) * limit;
    }
    heat
}

/// A ring that slips; `gap`: overlap less the edge's own when slip reached it \[m\].
struct Slipping {
    inner: f64,
    outer: f64,
    gap_inner: f64,
    gap_outer: f64,
}

impl Slipping {
    /// ∫ (√h - √x)² (√h + √x/2) dx over the ring, in y = √x; exact at constant h.
    fn heat(&self) -> f64 {
        let width = self.outer - self.inner;
        let low = self.inner.sqrt();
        let span = width / (low + self.outer.sqrt());
        span * mean(|s| {
            let y = low + s * span;
            let along = s * span * (low + y) / width;
            let gap = self.gap_inner + along * (self.gap_outer - self.gap_inner);
            let root = (y * y + gap).sqrt();
            (gap / (root + y)).powi(2) * (root + 0.5 * y) * 2.0 * y
        })
    }
}

/// Mean of `f` over 0..1 by three points of Gauss, exact for polynomials of degree five.
pub(super) fn mean(f: impl Fn(f64) -> f64) -> f64 {
    let offset = 0.5 * 0.6f64.sqrt();
    (5.0 * (f(0.5 - offset) + f(0.5 + offset)) + 8.0 * f(0.5)) / 18.0
}
