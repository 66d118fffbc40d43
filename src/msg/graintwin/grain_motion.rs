//! How the grains moved in an increment.

use serde::{Deserialize, Serialize};

use crate::msg::schema::describe;
use crate::msg::standard::Header;

/// Motion of the grains in an increment: of all of them, or of a chunk.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GrainMotion {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Number of this chunk, from 0.
    pub chunk: u32,
    /// Chunks of this increment, at least 1.
    pub chunk_count: u32,
    /// Index of the first grain of this message in the order of the pack file.
    pub first_grain: u32,
    /// Way of the centre, three numbers a grain \[m\].
    pub displacement: Vec<f64>,
    /// Its non-affine part, three numbers a grain \[m\].
    pub non_affine: Vec<f64>,
    /// Rotation, three numbers a grain \[rad\]; empty without friction.
    pub rotation: Vec<f64>,
    /// Rotation since the start, three numbers a grain \[rad\]; empty without friction.
    pub total_rotation: Vec<f64>,
    /// D²min over the number of neighbours \[m²\].
    pub d2min: Vec<f64>,
    /// Local shear strain.
    pub shear_strain: Vec<f64>,
    /// Local volumetric strain, compression positive.
    pub volumetric_strain: Vec<f64>,
    /// Whether the grain carries load.
    pub carries: Vec<bool>,
    /// Root mean square of the affine displacement \[m\].
    pub affine_rms: f64,
    /// Root mean square of the non-affine displacement \[m\].
    pub non_affine_rms: f64,
    /// The latter over the former.
    pub non_affine_ratio: f64,
    /// Root mean square of the rotation \[rad\].
    pub rotation_rms: f64,
    /// Participation ratio of the non-affine displacements.
    pub participation: f64,
    /// Participation ratio of the rotations.
    pub rotation_participation: f64,
    /// Share of the top hundredth of the grains in D²min.
    pub d2min_top_1: f64,
    /// Share of the top tenth.
    pub d2min_top_10: f64,
    /// Centre of the most sheared grains \[m\].
    pub band_center: [f64; 3],
    /// Normal of the plane that they lie closest to.
    pub band_normal: [f64; 3],
    /// How far they spread over how far all do, ascending.
    pub band_spread: [f64; 3],
    /// Thickness of the slab that spreads as far \[m\].
    pub band_thickness: f64,
}

describe!(
    GrainMotion,
    "graintwin_msgs",
    include_str!("../../../msgs/graintwin_msgs/msg/GrainMotion.msg"),
    &[Header::TYPE],
    "98ee0c43b604d0a4ee3e4f94b8808ce53b229676bb5c5151b1351d6039dcb37a"
);
