//! Local deformation after M. L. Falk and J. S. Langer, Phys. Rev. E 57, 7192 (1998), eqs. 2.11 to
//! 2.14: the deformation gradient F that takes the neighbours of a grain most nearly from where they
//! were to where they are, seen from the grain, and D²min, what it leaves.
//!
//! Written with displacements instead of positions, F = 1 + G: positions that differ by 1e-6 of a
//! grain leave ten digits of their squares to rounding.

use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::Vec3;
use crate::contact::cells::Cells;

/// Surfaces of neighbours are closer than this many mean radii, so that centres of equal grains are
/// closer than 1.5 diameters: the first shell of neighbours, and the gap behind it.
pub const GAP: f64 = 1.0;

/// Largest tr Y tr Y⁻¹ of neighbours that span the space: 9 when they lie around the grain evenly (4 in
/// the plane), this when they are within a hundredth of their distance from a plane (a line).
const FLAT: f64 = 1e4;

/// Fewer neighbours, if they span the space or the plane, fix the gradient and leave nothing whatever they
/// do.
const LEAST: usize = 4;
const LEAST_IN_PLANE: usize = 3;

/// Grains that a task takes.
const CHUNK: usize = 256;

/// What the deformation is computed from, arrays of the same grains.
#[derive(Clone, Copy, Debug)]
pub struct Grains<'a> {
    /// Centres before \[m\].
    pub position: &'a [Vec3],
    /// Ways of the centres \[m\].
    pub displacement: &'a [Vec3],
    /// Radii \[m\].
    pub radius: &'a [f64],
    /// Whether the grain counts as a neighbour. Where grains float that carry no load is not
    /// mechanics.
    pub carries: &'a [bool],
    /// Whether they are discs, all with z = 0.
    pub plane: bool,
}

/// Deformation of the neighbourhood of a grain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deformation {
    /// D²min over the number of neighbours \[m²\].
    pub d2min: f64,
    /// √(½ e:e), e the deviator of the Green-Lagrange strain.
    pub shear_strain: f64,
    /// 1 - det F: loss of volume, of discs of area, over what it was.
    pub volumetric_strain: f64,
}

impl Deformation {
    /// Of a grain whose neighbours do not span the space or the plane, or are too few.
    pub const UNKNOWN: Self =
        Self { d2min: f64::NAN, shear_strain: f64::NAN, volumetric_strain: f64::NAN };
}

/// The deformation of the neighbourhood of each grain.
#[must_use]
pub fn deformations(grains: &Grains<'_>) -> Vec<Deformation> {
    let count = grains.radius.len();
    let largest = grains.radius.iter().copied().fold(0.0, f64::max);
    let mean = grains.radius.iter().sum::<f64>() / count.max(1) as f64;
    let gap = GAP * mean;
    let mut cells = Cells::default();
    cells.sort(grains.position, 2.0 * largest + gap);
    let mut deformations = vec![Deformation::UNKNOWN; count];
    deformations.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, deformations)| {
        let mut near = Vec::new();
        for (k, deformation) in deformations.iter_mut().enumerate() {
            let i = chunk * CHUNK + k;
            grains.neighbours(&cells, i, gap, &mut near);
            *deformation = deformation_of(&near, grains.plane);
        }
    });
    deformations
}

/// A neighbour as the grain sees it.
#[derive(Clone, Copy)]
struct Neighbour {
    /// Where it was \[m\].
    from: Vec3,
    /// How it moved \[m\].
    moved: Vec3,
}

impl Grains<'_> {
    /// Lists in `near` the neighbours of grain `i`, whose surfaces are closer than `gap` \[m\].
    fn neighbours(&self, cells: &Cells, i: usize, gap: f64, near: &mut Vec<Neighbour>) {
        let (at, moved, reach) = (self.position[i], self.displacement[i], self.radius[i] + gap);
        near.clear();
        cells.for_each_near(&at, |j| {
            let j = j as usize;
            let from = self.position[j] - at;
            let reach = reach + self.radius[j];
            if from.norm_squared() < reach * reach && self.carries[j] && j != i {
                near.push(Neighbour { from, moved: self.displacement[j] - moved });
            }
        });
    }
}

fn deformation_of(near: &[Neighbour], plane: bool) -> Deformation {
    if near.len() < if plane { LEAST_IN_PLANE } else { LEAST } {
        return Deformation::UNKNOWN;
    }
    let (mut moved, mut shape) = (Matrix3::zeros(), Matrix3::zeros());
    for neighbour in near {
        let from = neighbour.from.transpose();
        moved += neighbour.moved * from;
        shape += neighbour.from * from;
    }
    let Some((inverse, evenness)) = inverse(shape, plane) else { return Deformation::UNKNOWN };
    if !(0.0..FLAT).contains(&evenness) {
        return Deformation::UNKNOWN;
    }
    // Eqs. 2.12 to 2.14: X is `shape` + `moved`, Y is `shape`, and ε = X Y⁻¹ - 1.
    let gradient = moved * inverse;
    let left = |n: &Neighbour| (n.moved - gradient * n.from).norm_squared();
    let strain = 0.5 * (gradient + gradient.transpose() + gradient.transpose() * gradient);
    let deviator = match plane {
        false => strain - Matrix3::identity() * (strain.trace() / 3.0),
        true => strain - IN_PLANE * (strain.trace() / 2.0),
    };
    // det(1 + G) - 1, expanded, since 1 would take the digits of small strains.
    let trace = gradient.trace();
    let second = 0.5 * (trace * trace - (gradient * gradient).trace());
    Deformation {
        d2min: near.iter().map(left).sum::<f64>() / near.len() as f64,
        shear_strain: (0.5 * deviator.norm_squared()).sqrt(),
        volumetric_strain: -(trace + second + gradient.determinant()),
    }
}

/// What is isotropic in the plane.
const IN_PLANE: Matrix3<f64> = Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0);

/// Y⁻¹ of Y = `shape`, that over x and y in the `plane`, and tr Y tr Y⁻¹.
fn inverse(mut shape: Matrix3<f64>, plane: bool) -> Option<(Matrix3<f64>, f64)> {
    let trace = shape.trace();
    if plane {
        // Nothing is at other z, nor moves there: any spread does.
        shape[(2, 2)] = trace;
    }
    let mut inverse = shape.try_inverse()?;
    if plane {
        inverse[(2, 2)] = 0.0;
    }
    Some((inverse, trace * inverse.trace()))
}
