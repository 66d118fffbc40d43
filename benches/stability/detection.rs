//! How often an event is reported where the gradient flow has one: small packs on a long isotropic
//! path in increments of the largest size that the program takes, each followed by the solver and by
//! `reference`, which looks for a dip of the force by itself.

use crate::agreement::Case;

/// Strain of an increment over the mean overlap strain: `solver.max_overlap_share`.
const SHARE: f64 = 0.05;
/// Confining stresses of the packs \[Pa\].
const STRESSES: [f64; 2] = [1e6, 1e7];

/// Increments by who saw an event.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Detected {
    pub(crate) increments: u32,
    pub(crate) both: u32,
    pub(crate) program_alone: u32,
    pub(crate) flow_alone: u32,
    /// Increments that ended elsewhere than the flow, and those without an equilibrium.
    pub(crate) elsewhere: u32,
    pub(crate) failed: u32,
}

/// Compresses `packs` packs at each stress in at most `increments` increments.
pub(crate) fn detect(packs: u64, increments: u32, friction: f64) -> Detected {
    let mut all = Detected::default();
    for seed in 1..=packs {
        for (k, stress) in STRESSES.into_iter().enumerate() {
            let Some(mut case) = Case::new(seed, k as u64, stress, friction) else { continue };
            for _ in 0..increments {
                let Some(seen) = case.strain(SHARE, [1.0; 3]) else { break };
                let Some(same) = seen.same else {
                    all.failed += 1;
                    break;
                };
                all.increments += 1;
                all.elsewhere += u32::from(!same);
                let count = match (seen.event, seen.dipped) {
                    (true, true) => &mut all.both,
                    (true, false) => &mut all.program_alone,
                    (false, true) => &mut all.flow_alone,
                    (false, false) => continue,
                };
                *count += 1;
            }
        }
    }
    all
}
