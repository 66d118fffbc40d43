//! Mohr circles of failures under the line of Mohr and Coulomb (B figure 36).

use std::f64::consts::PI;

use super::beside::{Beside, lines};
use super::{Axis, Chart, Unit};
use crate::analytic::strength::MohrCoulomb;

/// Places of a half circle.
const STEPS: u32 = 90;

/// Failures of one material.
#[derive(Clone, Debug)]
pub struct Failures<'a> {
    /// Its name in the legend.
    pub name: &'a str,
    /// `[σ3, σ1]` \[Pa\] of every test.
    pub states: &'a [[f64; 2]],
    /// The strength whose line is drawn dashed, if any.
    pub strength: Option<MohrCoulomb>,
}

/// The upper halves of the circles, and the lines.
#[must_use]
pub fn chart(materials: &[Failures]) -> Chart {
    let quantity = |material: &Failures| Beside {
        name: material.name.into(),
        measured: material.states.iter().flat_map(circle).collect(),
        predicted: material.strength.map_or_else(Vec::new, |one| line(&one, material.states)),
    };
    Chart {
        title: "Mohr circles at failure".into(),
        x: Axis::plane("normal stress", Unit::Si("Pa")),
        y: Axis::plane("shear stress", Unit::Si("Pa")),
        series: lines(&materials.iter().map(quantity).collect::<Vec<_>>()),
        notes: Vec::new(),
    }
}

/// A half circle, and a gap after it.
fn circle(&[minor, major]: &[f64; 2]) -> Vec<[f64; 2]> {
    let (mean, radius) = (0.5 * (major + minor), 0.5 * (major - minor));
    let place = |step: u32| {
        let (sine, cosine) = (PI * f64::from(step) / f64::from(STEPS)).sin_cos();
        [mean - radius * cosine, radius * sine]
    };
    (0..=STEPS).map(place).chain([[f64::NAN; 2]]).collect()
}

/// τ = c' + σ tan φ' from no shear stress to beyond the greatest circle.
fn line(strength: &MohrCoulomb, states: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let slope = strength.friction.tan();
    let most = states.iter().map(|[minor, major]| 0.5 * (major + minor)).fold(0.0, f64::max);
    let begin = if slope > 0.0 { -strength.cohesion / slope } else { 0.0 };
    [begin.max(-most), most].map(|at| [at, strength.cohesion + slope * at]).to_vec()
}
