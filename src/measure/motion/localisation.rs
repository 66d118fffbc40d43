//! Few numbers for how unevenly motion is spread.

use super::band;
use crate::report::{Band, GrainMotion, Localisation};
use crate::wall::Bounds;

/// Nothing is known.
pub(super) const UNKNOWN: Localisation = Localisation {
    affine_rms: f64::NAN,
    non_affine_rms: f64::NAN,
    non_affine_ratio: f64::NAN,
    rotation_rms: f64::NAN,
    participation: f64::NAN,
    rotation_participation: f64::NAN,
    d2min_top_1: f64::NAN,
    d2min_top_10: f64::NAN,
    band: Band::UNKNOWN,
};

/// Of `motion` from `position` \[m\], of spheres or in the `plane`; `affine` tells how the box takes a
/// place along, seen from its middle.
#[must_use]
pub fn of(
    motion: &GrainMotion,
    position: &[[f64; 3]],
    affine: &dyn Fn(&[f64; 3]) -> [f64; 3],
    plane: bool,
) -> Localisation {
    let carries = &motion.carries;
    let of_carriers = |vectors: &[[f64; 3]]| -> Vec<f64> {
        carriers(carries, vectors.iter().map(squared)).collect()
    };
    let affine: Vec<f64> =
        carriers(carries, position.iter().map(|at| squared(&affine(at)))).collect();
    let non_affine = of_carriers(&motion.non_affine);
    let rotation = of_carriers(&motion.rotation);
    let d2min: Vec<f64> =
        carriers(carries, motion.d2min.iter().copied()).filter(|d2min| d2min.is_finite()).collect();
    let [affine_rms, non_affine_rms, rotation_rms] =
        [&affine, &non_affine, &rotation].map(|squares| root_mean(squares));
    Localisation {
        affine_rms,
        non_affine_rms,
        non_affine_ratio: if affine_rms > 0.0 { non_affine_rms / affine_rms } else { f64::NAN },
        rotation_rms,
        participation: participation(&non_affine),
        rotation_participation: participation(&rotation),
        d2min_top_1: share_of_largest(&d2min, 0.01),
        d2min_top_10: share_of_largest(&d2min, 0.1),
        band: band::of(motion, position, plane),
    }
}

/// Those of `values`, one a grain, whose grain carries load.
fn carriers<'a, T: 'a>(
    carries: &'a [bool],
    values: impl Iterator<Item = T> + 'a,
) -> impl Iterator<Item = T> + 'a {
    values.zip(carries).filter_map(|(value, &carries)| carries.then_some(value))
}

fn squared(vector: &[f64; 3]) -> f64 {
    vector.iter().map(|component| component * component).sum()
}

/// Where a box that goes from the first of these to the second takes what was at a place, seen from its
/// centre: its stretch alone, whichever of two opposite walls moved.
pub(super) fn stretch([before, after]: &[Bounds; 2]) -> impl Fn(&[f64; 3]) -> [f64; 3] {
    let (from, to, before) = (before.sides(), after.sides(), *before);
    move |at| {
        std::array::from_fn(|axis| {
            let centre = 0.5 * (before.min[axis] + before.max[axis]);
            (to[axis] - from[axis]) / from[axis] * (at[axis] - centre)
        })
    }
}

/// Root of the mean of `squares`; NaN of none.
fn root_mean(squares: &[f64]) -> f64 {
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// (Σ u²)² / (n Σ u⁴) of the `squares` u²; NaN when all are zero.
#[must_use]
pub fn participation(squares: &[f64]) -> f64 {
    // Over the largest, since fourth powers of small rotations leave the range of numbers.
    let largest = squares.iter().copied().fold(0.0, f64::max);
    let (sum, fourth) = squares
        .iter()
        .map(|square| square / largest)
        .fold((0.0, 0.0), |(sum, fourth), square| (sum + square, fourth + square * square));
    sum * sum / (squares.len() as f64 * fourth)
}

/// Share of the sum of `values`, none below zero, that the largest have: `part` of them, rounded
/// up. NaN when all are zero.
#[must_use]
pub fn share_of_largest(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(|one, other| other.total_cmp(one));
    let most = (part * values.len() as f64).ceil() as usize;
    sorted.iter().take(most).sum::<f64>() / sorted.iter().sum::<f64>()
}
