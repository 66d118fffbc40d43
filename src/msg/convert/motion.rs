//! The motion of the grains, in one message or in chunks.

use super::pack_header;
use crate::msg::GrainMotion;
use crate::report::{self, Localisation, Measures};

/// Most grains in one live [`GrainMotion`]: 55 KB, for the reason of
/// [`LIVE_CHUNK`](super::LIVE_CHUNK).
pub const LIVE_GRAINS: usize = 450;

/// The motion of all grains in one message, as recordings hold it; `None` when it was not asked for.
#[must_use]
pub fn whole_motion(measures: &Measures) -> Option<GrainMotion> {
    let motion = measures.motion.as_ref()?;
    motion_chunks(measures, motion.displacement.len()).next()
}

/// The motion of the grains in messages of at most `most` grains each; none when it was not asked
/// for.
pub fn motion_chunks(measures: &Measures, most: usize) -> impl Iterator<Item = GrainMotion> + '_ {
    measures.motion.iter().flat_map(move |motion| {
        let grains = motion.displacement.len();
        let most = most.max(1);
        let chunks = grains.div_ceil(most).max(1);
        (0..chunks).map(move |chunk| {
            let range = chunk * most..((chunk + 1) * most).min(grains);
            GrainMotion {
                chunk: chunk as u32,
                chunk_count: chunks as u32,
                first_grain: range.start as u32,
                displacement: flat(&motion.displacement[range.clone()]),
                non_affine: flat(&motion.non_affine[range.clone()]),
                // Empty without friction.
                rotation: flat(motion.rotation.get(range.clone()).unwrap_or_default()),
                total_rotation: flat(motion.total_rotation.get(range.clone()).unwrap_or_default()),
                d2min: motion.d2min[range.clone()].to_vec(),
                shear_strain: motion.shear_strain[range.clone()].to_vec(),
                volumetric_strain: motion.volumetric_strain[range.clone()].to_vec(),
                carries: motion.carries[range].to_vec(),
                ..whole_pack(measures, motion)
            }
        })
    })
}

/// What all chunks say.
fn whole_pack(measures: &Measures, motion: &report::GrainMotion) -> GrainMotion {
    let Localisation { band, .. } = motion.localisation;
    let Localisation { affine_rms, non_affine_rms, non_affine_ratio, rotation_rms, .. } =
        motion.localisation;
    let Localisation { participation, rotation_participation, d2min_top_1, d2min_top_10, .. } =
        motion.localisation;
    GrainMotion {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        affine_rms,
        non_affine_rms,
        non_affine_ratio,
        rotation_rms,
        participation,
        rotation_participation,
        d2min_top_1,
        d2min_top_10,
        band_center: band.center,
        band_normal: band.normal,
        band_spread: band.spread,
        band_thickness: band.thickness,
        ..GrainMotion::default()
    }
}

fn flat(vectors: &[[f64; 3]]) -> Vec<f64> {
    vectors.as_flattened().to_vec()
}
