//! How the grains moved in an increment.

use serde::Serialize;

/// How every grain moved since the equilibrium before, in the order of the pack file; at increment 0
/// since the pack as it was given. Formulas are in `docs/motion.md`.
#[derive(Clone, Debug, PartialEq)]
pub struct GrainMotion {
    /// Way of the centre u \[m\].
    pub displacement: Vec<[f64; 3]>,
    /// Its part that the affine motion of the box does not explain \[m\].
    pub non_affine: Vec<[f64; 3]>,
    /// Rotation \[rad\], about the axes by the right hand; empty without friction.
    pub rotation: Vec<[f64; 3]>,
    /// Sum of the rotations since the start, and of the history of the pack \[rad\]; empty without
    /// friction.
    pub total_rotation: Vec<[f64; 3]>,
    /// D²min, what the best affine motion of the neighbourhood leaves, over the number of
    /// neighbours \[m²\]. NaN where there are fewer than four or they do not span the space, of discs
    /// fewer than three or they do not span the plane.
    pub d2min: Vec<f64>,
    /// Local shear strain √(½ e:e) of the deviator e of the Green-Lagrange strain, half the
    /// engineering shear; NaN as above.
    pub shear_strain: Vec<f64>,
    /// Local loss of volume over volume, of discs of area over area, compression positive; NaN as above.
    pub volumetric_strain: Vec<f64>,
    /// Whether the grain carries load at the end; the others float.
    pub carries: Vec<bool>,
    /// How unevenly that is spread.
    pub localisation: Localisation,
}

/// How unevenly motion is spread over the grains that carry load. What cannot be told is NaN:
/// quotients where nothing moved, all when no grain carries load, rotations without friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Localisation {
    /// Root mean square of the affine displacement against the centre of the box \[m\].
    pub affine_rms: f64,
    /// Root mean square of the non-affine displacement \[m\].
    pub non_affine_rms: f64,
    /// The latter over the former.
    pub non_affine_ratio: f64,
    /// Root mean square of the rotation \[rad\].
    pub rotation_rms: f64,
    /// Participation ratio of the non-affine displacements: 1 when all are equal, 1/n when one
    /// grain moves.
    pub participation: f64,
    /// Participation ratio of the rotations.
    pub rotation_participation: f64,
    /// Share of the sum of D²min that the hundredth of the grains with the most of it have.
    pub d2min_top_1: f64,
    /// Share that the tenth of them has.
    pub d2min_top_10: f64,
    /// Where the most sheared grains lie.
    pub band: Band,
}

/// Where the tenth of the grains with the largest local shear strain lies, against all that carry
/// load. NaN when it is fewer than four grains, nothing was sheared, or all grains lie in a plane. Of discs
/// the plane is a line, three grains are enough, z is 0 and the third spread NaN.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Their centre \[m\].
    pub center: [f64; 3],
    /// Normal of the plane that they lie closest to, its largest component positive.
    pub normal: [f64; 3],
    /// Their root mean square distance from the plane over that of all grains from theirs, and the
    /// same for the two directions that follow, ascending: 1, 1, 1 without localisation; small, 1,
    /// 1 for a band; small, small, 1 for a pipe; three small ones for a cluster.
    pub spread: [f64; 3],
    /// Thickness of the uniform slab with their spread along the normal, √12 times it \[m\].
    pub thickness: f64,
}

impl Band {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self {
        center: [f64::NAN; 3],
        normal: [f64::NAN; 3],
        spread: [f64::NAN; 3],
        thickness: f64::NAN,
    };
}
