//! Numbers of a loading test: peak, secant moduli, lateral coefficients, dilatancy (A.19-A.22).

use std::ops::Range;

use super::line::line;
use crate::analytic::flow;

/// Share of the peak up to which a test counts as having just begun.
const BEGIN: f64 = 0.25;

/// Where `stress` is greatest, first; nothing when none is a number.
#[must_use]
pub fn peak(stress: &[f64]) -> Option<usize> {
    let numbers = (0..stress.len()).filter(|&place| stress[place].is_finite());
    numbers.reduce(|best, place| if stress[place] > stress[best] { place } else { best })
}

/// First place where `stress` comes to `share` of its way from the first to the peak, as a place
/// between two: the number of the one before and the part of the way on.
fn crossing(stress: &[f64], share: f64) -> Option<(usize, f64)> {
    let [first, top] = [*stress.first()?, stress[peak(stress)?]];
    let level = first + share * (top - first);
    let after = stress.iter().position(|&value| value >= level).filter(|&after| after > 0)?;
    let [low, high] = [stress[after - 1], stress[after]];
    Some((after - 1, (level - low) / (high - low)))
}

/// Slope \[Pa\] of the secant from the first place to half of the peak: E50 of deviator and axial
/// strain at constant σ3 (A.19), G of shear stress and γ (A.24). Nothing without a rise.
#[must_use]
pub fn secant_50(strain: &[f64], stress: &[f64]) -> Option<f64> {
    let (before, part) = crossing(stress, 0.5)?;
    let at = |values: &[f64]| values[before] + part * (values[before + 1] - values[before]);
    let slope = (at(stress) - stress[0]) / (at(strain) - strain[0]);
    (strain.len() == stress.len() && slope.is_finite()).then_some(slope)
}

/// The places from the first to a quarter of the peak of `stress`: where the moduli of a beginning
/// test are taken. At least two.
#[must_use]
pub fn begin(stress: &[f64]) -> Option<Range<usize>> {
    crossing(stress, BEGIN).map(|(before, _)| 0..before + 2)
}

/// dy/dx by least squares over `places`: σ̇3/σ̇1 of a compression test, E of axial strain and σ1.
#[must_use]
pub fn slope(x: &[f64], y: &[f64], places: Range<usize>) -> Option<f64> {
    let (x, y) = (x.get(places.clone())?, y.get(places)?);
    let points: Vec<[f64; 2]> = x.iter().zip(y).map(|(&x, &y)| [x, y]).collect();
    line(&points).map(|line| line.slope)
}

/// ν = 1 - ε̇tot/ε̇1 at constant σ3 (A.19) over `places`.
#[must_use]
pub fn poisson(axial_strain: &[f64], area_strain: &[f64], places: Range<usize>) -> Option<f64> {
    slope(axial_strain, area_strain, places).map(|slope| 1.0 - slope)
}

/// ψ \[rad\] over `places` (A.21), positive when the area grows; nothing where both sides close in.
#[must_use]
pub fn dilatancy(axial_strain: &[f64], area_strain: &[f64], places: Range<usize>) -> Option<f64> {
    // Per ε̇1, with ε̇3 the rest of the change of the area.
    let slope = slope(axial_strain, area_strain, places)?;
    flow::dilatancy(1.0, slope - 1.0)
}

/// The places of the plastic branch (figure A.5): from where the straight line with E50 would be as high as
/// the peak of `stress`, to the end. At least two.
#[must_use]
pub fn plastic(strain: &[f64], stress: &[f64]) -> Option<Range<usize>> {
    let young = secant_50(strain, stress)?;
    let yields = strain[0] + (stress[peak(stress)?] - stress[0]) / young;
    let first = strain.iter().position(|&strain| strain >= yields)?;
    (first + 2 <= strain.len()).then_some(first..strain.len())
}
