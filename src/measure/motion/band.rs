//! The plane that the most sheared grains lie closest to: thickness and direction of a shear band.
//!
//! The second moments M of their positions are compared with those of all grains, M₀. In a direction
//! n they spread over nᵀMn, the pack over nᵀM₀n. The n with the least ratio is the normal: with M₀
//! in the denominator neither a flat box nor one that is not a cube has a band for that alone. Of discs it
//! is a line.

use nalgebra::{Matrix2, Matrix3, SMatrix, SVector, SymmetricEigen};

use crate::report::{Band, GrainMotion};

/// Share of the grains that are taken for the most sheared.
const MOST_SHEARED: f64 = 0.1;

/// Where the most sheared grains of `motion` were, which began at `position` \[m\], in space or in the
/// `plane`.
#[must_use]
pub fn of(motion: &GrainMotion, position: &[[f64; 3]], plane: bool) -> Band {
    match plane {
        false => within(motion, position, |ratio: Matrix3<f64>| {
            let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(ratio);
            (eigenvalues.into(), eigenvectors)
        }),
        true => within(motion, position, |ratio: Matrix2<f64>| {
            let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(ratio);
            (eigenvalues.into(), eigenvectors)
        }),
    }
}

/// Eigenvalues of a symmetric matrix, and its eigenvectors as columns.
type Eigen<const D: usize> = fn(SMatrix<f64, D, D>) -> ([f64; D], SMatrix<f64, D, D>);

fn within<const D: usize>(motion: &GrainMotion, position: &[[f64; 3]], eigen: Eigen<D>) -> Band {
    let strains = motion.shear_strain.iter().zip(&motion.carries).zip(position);
    let mut grains: Vec<(f64, SVector<f64, D>)> = strains
        .filter(|((strain, carries), _)| **carries && strain.is_finite())
        .map(|((&strain, _), &at)| (strain, SVector::<f64, D>::from_fn(|axis, _| at[axis])))
        .collect();
    // Stable: among equals the order of the pack file decides.
    grains.sort_by(|(one, _), (other, _)| other.total_cmp(one));
    let most = (MOST_SHEARED * grains.len() as f64).ceil() as usize;
    // As many lie in a plane, or on a line, whatever they do.
    if most <= D || grains[0].0 == 0.0 {
        return Band::UNKNOWN;
    }
    let [sheared, all] = [&grains[..most], &grains[..]].map(Moments::of);
    compare(&sheared, &all, eigen).unwrap_or(Band::UNKNOWN)
}

/// Centre and second central moments of points.
struct Moments<const D: usize> {
    center: SVector<f64, D>,
    second: SMatrix<f64, D, D>,
}

impl<const D: usize> Moments<D> {
    fn of(points: &[(f64, SVector<f64, D>)]) -> Self {
        let share = 1.0 / points.len() as f64;
        let center = points.iter().map(|(_, at)| at * share).sum::<SVector<f64, D>>();
        let second = points.iter().map(|(_, at)| {
            let from = at - center;
            from * from.transpose() * share
        });
        Self { center, second: second.sum() }
    }
}

/// Solves M n = λ M₀ n; nothing when one of them is flat.
fn compare<const D: usize>(
    sheared: &Moments<D>,
    all: &Moments<D>,
    eigen: Eigen<D>,
) -> Option<Band> {
    let factor = all.second.cholesky()?.l();
    let inverse = factor.try_inverse()?;
    let ratio = inverse * sheared.second * inverse.transpose();
    if !ratio.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let (eigenvalues, eigenvectors) = eigen(ratio);
    let mut by_size: [usize; D] = std::array::from_fn(|k| k);
    by_size.sort_by(|&one, &other| eigenvalues[one].total_cmp(&eigenvalues[other]));
    let normal = (inverse.transpose() * eigenvectors.column(by_size[0])).normalize();
    let normal = normal * normal[normal.iamax()].signum();
    let variance = normal.dot(&(sheared.second * normal));
    let spread = by_size.map(|k| eigenvalues[k].max(0.0).sqrt());
    let in_space =
        |of: &SVector<f64, D>| [0, 1, 2].map(|axis| of.get(axis).copied().unwrap_or(0.0));
    Some(Band {
        center: in_space(&sheared.center),
        normal: in_space(&normal),
        spread: [0, 1, 2].map(|k| spread.get(k).copied().unwrap_or(f64::NAN)),
        thickness: (12.0 * variance).sqrt(),
    })
}
