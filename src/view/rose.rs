//! Polar charts of contacts and their mean forces against direction (B figures 14 and 38), with what
//! the stress predicts (A.73).

use std::f64::consts::TAU;

use super::{Axis, Chart, Pattern, Series, Stroke, Unit};
use crate::analytic::forces;
use crate::analytic::tensor::Tensor;

/// Places of a curve around.
const STEPS: u32 = 360;

/// Contacts in bins of their direction, four series of one length.
#[derive(Clone, Copy, Debug)]
pub struct ByDirection<'a> {
    /// Middle of the bin \[rad\] from the x-axis.
    pub angle: &'a [f64],
    /// Contacts in it.
    pub count: &'a [f64],
    /// Mean normal force \[N\].
    pub normal: &'a [f64],
    /// Mean shear force \[N\], of either sign.
    pub shear: &'a [f64],
}

/// What A.73 takes to predict the forces.
#[derive(Clone, Copy, Debug)]
pub struct Predicted {
    /// Mean stress of the pack \[Pa\].
    pub stress: Tensor,
    /// d̄ \[m\].
    pub diameter: f64,
    /// n_c/v.
    pub contact_density: f64,
}

/// The roses of contacts, normal forces and shear forces: the distance from the middle is the value,
/// of the shear force without its sign.
#[must_use]
pub fn charts(measured: &ByDirection, predicted: Option<&Predicted>) -> [Chart; 3] {
    let bins = measured.count.len().max(1) as f64;
    let even = measured.count.iter().sum::<f64>() / bins;
    let force = |which: usize| {
        predicted.map(|given| {
            let Predicted { stress, diameter, contact_density } = *given;
            around(move |angle| forces::mean(&stress, diameter, contact_density, angle)[which])
        })
    };
    let rose = |number: usize, title: &str, values: &[f64], unit: Unit, curve: Option<_>| {
        let mut dots = Series::new(number, "measured", places(measured.angle, values));
        dots.stroke.pattern = Pattern::Dots;
        let mut series = vec![dots];
        series.extend(curve.map(|(name, points): (&str, Vec<[f64; 2]>)| {
            let stroke = Stroke { pattern: Pattern::Dashed, width: 1.4, ..Stroke::of(number) };
            Series { stroke, ..Series::new(number, name, points) }
        }));
        let [x, y] = ["x", "y"].map(|axis| Axis::plane(&format!("along {axis}"), unit));
        Chart { title: title.into(), x, y, series, notes: Vec::new() }
    };
    let named = |curve: Option<_>| curve.map(|points| ("by A.73", points));
    let alike = Some(("all directions alike", around(|_| even)));
    let newton = Unit::Si("N");
    [
        rose(0, "Contacts against direction", measured.count, Unit::None, alike),
        rose(0, "Mean normal force against direction", measured.normal, newton, named(force(0))),
        rose(1, "Mean shear force against direction", measured.shear, newton, named(force(1))),
    ]
}

fn places(angles: &[f64], values: &[f64]) -> Vec<[f64; 2]> {
    angles.iter().zip(values).map(|(&angle, &value)| place(angle, value)).collect()
}

fn around(value: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
    let angle = |step: u32| TAU * f64::from(step) / f64::from(STEPS);
    (0..=STEPS).map(angle).map(|angle| place(angle, value(angle))).collect()
}

fn place(angle: f64, value: f64) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [value.abs() * cosine, value.abs() * sine]
}
