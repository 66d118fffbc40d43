//! A contact of two equal spheres and its shear along a line.
#![allow(dead_code, reason = "each test uses its part")]

use graintwin::Vec3;
use graintwin::contact::partial_slip::{self, Contact, Response, Step};
use graintwin::contact::{hertz, mindlin};
use graintwin::pack::Layer;

pub(crate) const E: f64 = 70e9;
pub(crate) const NU: f64 = 0.2;
pub(crate) const G: f64 = E / 2.4;
pub(crate) const MU: f64 = 0.3;
/// Radius of both spheres \[m\].
pub(crate) const R: f64 = 1e-4;
/// Overlap of the tests that keep it \[m\].
pub(crate) const H: f64 = 2e-7;

pub(crate) fn contact(friction: f64) -> Contact {
    let compliance = 2.0 * hertz::compliance(E, NU);
    Contact {
        modulus: hertz::modulus(0.5 * R, compliance),
        ratio: partial_slip::stiffness_ratio(compliance, 2.0 * mindlin::shear_compliance(E, NU)),
        friction,
    }
}

/// A contact with its history along x; `pull` is positive along the force on i.
pub(crate) struct Line {
    pub(crate) contact: Contact,
    pub(crate) layers: Vec<Layer>,
    pub(crate) overlap: f64,
}

impl Line {
    pub(crate) fn pressed(contact: Contact, overlap: f64) -> Self {
        Self { contact, layers: Vec::new(), overlap }
    }

    pub(crate) fn step(&self, overlap: f64, pull: f64) -> Step {
        Step { before: self.overlap, overlap, displacement: Vec3::new(-pull, 0.0, 0.0) }
    }

    pub(crate) fn force(&self, overlap: f64, pull: f64) -> f64 {
        self.respond(overlap, pull).shear.x
    }

    pub(crate) fn respond(&self, overlap: f64, pull: f64) -> Response {
        self.contact.respond(&self.layers, &self.step(overlap, pull))
    }

    pub(crate) fn dissipated(&self, overlap: f64, pull: f64) -> f64 {
        self.contact.dissipated(&self.layers, &self.step(overlap, pull))
    }

    pub(crate) fn stored(&self) -> f64 {
        self.contact.stored(&self.layers, self.overlap)
    }

    pub(crate) fn go(&mut self, overlap: f64, pull: f64) -> f64 {
        let step = self.step(overlap, pull);
        let force = self.force(overlap, pull);
        self.contact.commit(&mut self.layers, &step);
        self.overlap = overlap;
        force
    }

    /// Work of the straight step by Simpson's rule on many parts.
    pub(crate) fn work(&self, overlap: f64, pull: f64) -> f64 {
        let parts = 4000;
        let at = |k: usize| {
            let share = k as f64 / f64::from(parts);
            self.force(self.overlap + share * (overlap - self.overlap), share * pull)
        };
        let sum: f64 = (0..=parts as usize)
            .map(|k| if k == 0 || k == parts as usize { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 } * at(k))
            .sum();
        sum * pull / (3.0 * f64::from(parts))
    }
}

#[track_caller]
pub(crate) fn close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value:e} is not {expected:e} ± {tolerance:e}");
}
