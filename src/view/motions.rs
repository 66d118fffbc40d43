//! How the grains moved in the increments of a run.

use crate::msg::GrainMotion;

/// Motions in the order of the bag.
#[derive(Debug, Default)]
pub struct Motions {
    /// The numbers of the whole pack at each increment; of the grains nothing is kept.
    pub whole: Vec<GrainMotion>,
    /// Lengths of the non-affine displacements in the last increment, of the grains that carry
    /// load \[m\].
    pub last: Vec<f64>,
}

impl Motions {
    /// Takes a motion, or the next chunk of one.
    pub(super) fn add(&mut self, motion: GrainMotion) {
        let GrainMotion { chunk, non_affine, carries, .. } = &motion;
        let length = |vector: &[f64]| vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        let carriers = non_affine.chunks_exact(3).zip(carries).filter(|(_, carries)| **carries);
        let lengths = carriers.map(|(vector, _)| length(vector));
        if *chunk > 0 && self.increment() == Some(motion.increment) {
            self.last.extend(lengths);
            return;
        }
        self.last = lengths.collect();
        let nothing = Vec::new;
        self.whole.push(GrainMotion {
            displacement: nothing(),
            non_affine: nothing(),
            rotation: nothing(),
            total_rotation: nothing(),
            d2min: nothing(),
            shear_strain: nothing(),
            volumetric_strain: nothing(),
            carries: Vec::new(),
            ..motion
        });
    }

    /// The last increment that is known.
    pub(super) fn increment(&self) -> Option<u64> {
        self.whole.last().map(|motion| motion.increment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_one_motion_and_grains_that_float_are_left_out() {
        let chunk = |increment, chunk, length: f64| GrainMotion {
            increment,
            chunk,
            non_affine: vec![0.0, 3.0 * length, 4.0 * length, 9.0, 9.0, 9.0],
            carries: vec![true, false],
            participation: 0.5,
            ..GrainMotion::default()
        };
        let mut motions = Motions::default();
        for motion in [chunk(0, 0, 7.0), chunk(1, 0, 1.0), chunk(1, 1, 2.0), chunk(2, 0, 3.0)] {
            motions.add(motion);
        }
        assert_eq!(motions.last, [15.0]);
        motions.add(chunk(2, 1, 4.0));
        assert_eq!(motions.last, [15.0, 20.0]);
        let known: Vec<_> = motions.whole.iter().map(|m| (m.increment, m.participation)).collect();
        assert_eq!(known, [(0, 0.5), (1, 0.5), (2, 0.5)]);
    }
}
