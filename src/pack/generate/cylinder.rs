//! Random points in a cylinder in which the grains will be jammed, or between two.

use std::f64::consts::{PI, TAU};

use rand::RngExt;
use rand_pcg::Pcg64;

use crate::pack::{Grain, Pack};
use crate::wall::Bounds;

/// Halvings in search of the outer radius.
const HALVINGS: u32 = 100;

/// Radius and height of a cylinder around an inner one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cylinder {
    /// Radius of the inner cylinder \[m\], 0 without one.
    inner: f64,
    /// Radius of the outer one \[m\].
    outer: f64,
    /// Height \[m\].
    height: f64,
}

impl Cylinder {
    /// With the volume `volume` \[m³\] and the height `slender` times the diameter.
    pub(super) fn of(volume: f64, slender: f64, inner: f64) -> Self {
        let of = |outer: f64| PI * (outer - inner) * (outer + inner) * 2.0 * slender * outer;
        let (mut low, mut high) = (inner, inner + (volume / slender).cbrt());
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if of(middle) < volume { low = middle } else { high = middle }
        }
        Self { inner, outer: high, height: 2.0 * slender * high }
    }

    /// Area of all walls over the volume \[1/m\].
    pub(super) fn walls_over_volume(&self) -> f64 {
        2.0 / (self.outer - self.inner) + 2.0 / self.height
    }

    /// `grains` at random points in it.
    pub(super) fn scatter(&self, mut grains: Vec<Grain>, rng: &mut Pcg64) -> Pack {
        let Self { inner, outer, height } = *self;
        for grain in &mut grains {
            let room = |radius: f64, way: f64| (radius + way * grain.radius).max(0.0).powi(2);
            let hole = if inner > 0.0 { room(inner, 1.0) } else { 0.0 };
            let [a, b, c] = [rng.random::<f64>(), rng.random::<f64>(), rng.random::<f64>()];
            let far = (hole + a * (room(outer, -1.0) - hole).max(0.0)).sqrt();
            let (sin, cos) = (TAU * b).sin_cos();
            let z = (2.0 * c - 1.0) * (0.5 * height - grain.radius).max(0.0);
            grain.position = [far * cos, far * sin, z];
        }
        let max = [outer, outer, 0.5 * height];
        Pack { bounds: Bounds { min: max.map(|side| -side), max }, grains, history: None }
    }
}
