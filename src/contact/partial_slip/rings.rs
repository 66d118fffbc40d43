//! The rings of a contact and the force they carry.

use super::Contact;
use crate::Vec3;
use crate::pack::Layer;

/// Overlaps at which the contact circle reaches both edges of a ring \[m\], and its D.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ring {
    pub(super) inner: f64,
    pub(super) outer: f64,
    pub(super) ratio: Vec3,
}

impl Ring {
    pub(super) fn width(&self) -> f64 {
        self.outer - self.inner
    }
}

/// The rings up to `overlap` from inside outwards; what no layer covers has not been sheared.
pub(super) fn of(layers: &[Layer], overlap: f64) -> impl DoubleEndedIterator<Item = Ring> {
    (0..=layers.len()).map(move |k| {
        let inner = if k == 0 { 0.0 } else { layers[k - 1].reach };
        match layers.get(k) {
            Some(layer) => Ring { inner, outer: layer.reach, ratio: Vec3::from(layer.ratio) },
            None => Ring { inner, outer: overlap.max(inner), ratio: Vec3::zeros() },
        }
    })
}

/// The same, up to `core` only.
pub(super) fn within(layers: &[Layer], overlap: f64, core: f64) -> impl Iterator<Item = Ring> {
    of(layers, overlap)
        .take_while(move |ring| ring.inner < core)
        .map(move |ring| Ring { outer: ring.outer.min(core), ..ring })
}

/// Where the rings before a step end \[m\].
pub(super) fn end(layers: &[Layer], before: f64) -> f64 {
    layers.last().map_or(0.0, |layer| layer.reach).max(before)
}

/// Makes `layers` end at `core`.
pub(super) fn cut(layers: &mut Vec<Layer>, core: f64) {
    let whole = layers.partition_point(|layer| layer.reach < core);
    if let Some(layer) = layers.get_mut(whole)
        && core > 0.0
    {
        layer.reach = core;
        layers.truncate(whole + 1);
    } else {
        layers.truncate(whole);
        if core > 0.0 {
            layers.push(Layer { reach: core, ratio: [0.0; 3] });
        }
    }
}

/// Force of `rings` \[N\]: μ ∫ D P' dx.
pub(super) fn force(contact: &Contact, rings: impl Iterator<Item = Ring>) -> Vec3 {
    rings.fold(Vec3::zeros(), |sum, ring| sum + share(contact, &ring))
}

/// Force of one ring \[N\].
pub(super) fn share(contact: &Contact, ring: &Ring) -> Vec3 {
    ring.ratio * (contact.friction * ring.width() * secant(contact.modulus, ring.inner, ring.outer))
}

/// (P(b) - P(a))/(b - a) of Hertz' force \[N/m\], without a difference; dP/dh where both are equal.
/// One of them is positive.
pub(super) fn secant(modulus: f64, a: f64, b: f64) -> f64 {
    let (root_a, root_b) = (a.sqrt(), b.sqrt());
    modulus * (a + root_a * root_b + b) / (root_a + root_b)
}
