//! The plane that the most sheared grains lie closest to: thickness and direction of a shear band.
//!
//! The second moments M of their positions are compared with those of all grains, M₀. In a direction
//! n they spread over nᵀMn, the pack over nᵀM₀n. The n with the least ratio is the normal: with M₀
//! in the denominator neither a flat box nor one that is not a cube has a band for that alone.

use nalgebra::{Matrix3, SymmetricEigen};

use crate::Vec3;
use crate::report::{Band, GrainMotion};

/// Share of the grains that are taken for the most sheared.
const MOST_SHEARED: f64 = 0.1;

/// Fewer grains lie in a plane whatever they do.
const LEAST: usize = 4;

/// Where the most sheared grains of `motion` were, which began at `position` \[m\].
#[must_use]
pub fn of(motion: &GrainMotion, position: &[[f64; 3]]) -> Band {
    let strains = motion.shear_strain.iter().zip(&motion.carries).zip(position);
    let mut grains: Vec<(f64, Vec3)> = strains
        .filter(|((strain, carries), _)| **carries && strain.is_finite())
        .map(|((&strain, _), &at)| (strain, at.into()))
        .collect();
    // Stable: among equals the order of the pack file decides.
    grains.sort_by(|(one, _), (other, _)| other.total_cmp(one));
    let most = (MOST_SHEARED * grains.len() as f64).ceil() as usize;
    if most < LEAST || grains[0].0 == 0.0 {
        return Band::UNKNOWN;
    }
    let [sheared, all] = [&grains[..most], &grains[..]].map(Moments::of);
    compare(&sheared, &all).unwrap_or(Band::UNKNOWN)
}

/// Centre and second central moments of points.
struct Moments {
    center: Vec3,
    second: Matrix3<f64>,
}

impl Moments {
    fn of(points: &[(f64, Vec3)]) -> Self {
        let share = 1.0 / points.len() as f64;
        let center = points.iter().map(|(_, at)| at * share).sum::<Vec3>();
        let second = points.iter().map(|(_, at)| {
            let from = at - center;
            from * from.transpose() * share
        });
        Self { center, second: second.sum() }
    }
}

/// Solves M n = λ M₀ n; nothing when one of them is flat.
fn compare(sheared: &Moments, all: &Moments) -> Option<Band> {
    let factor = all.second.cholesky()?.l();
    let inverse = factor.try_inverse()?;
    let ratio = inverse * sheared.second * inverse.transpose();
    if !ratio.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(ratio);
    let mut by_size = [0, 1, 2];
    by_size.sort_by(|&one, &other| eigenvalues[one].total_cmp(&eigenvalues[other]));
    let normal = (inverse.transpose() * eigenvectors.column(by_size[0])).normalize();
    let normal = normal * normal[normal.iamax()].signum();
    let variance = normal.dot(&(sheared.second * normal));
    Some(Band {
        center: sheared.center.into(),
        normal: normal.into(),
        spread: by_size.map(|k| eigenvalues[k].max(0.0).sqrt()),
        thickness: (12.0 * variance).sqrt(),
    })
}
