//! The steps of `pack.prepare`: a pack is confined without friction, then strained with friction
//! until the frictional loads have built up (T 3.6.2, HZ-17).
//!
//! Every step begins with a pack and ends with one, so that what follows a step does not depend on
//! whether the pack was stored and read in between.

use super::Pack;
use super::discs;
use super::generate::{CompactError, compact};
use super::rescale::{self, rescale};
use crate::command::{Ask, Command, Disposition, Mode, Stamp};
use crate::report::{Demand, PackState, Report};
use crate::scene::Scene;
use crate::scene::prepare::{End, Isotropic, Steady, Step, Uniaxial};
use crate::twin::{Twin, TwinError};
use crate::wall;

/// What a preparation asks of the twin.
const STATE: Demand = Demand { state: true, ..Demand::NONE };

/// What a preparation has reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// Index of the step in `pack.prepare`.
    pub step: usize,
    /// Strain of the step so far, of the box at its start; `None` for an isotropic step.
    pub strain: Option<f64>,
    /// Mean normal stress \[Pa\]; that asked for of an isotropic step.
    pub confining_stress: f64,
    /// Sliding contacts over all contacts.
    pub sliding_ratio: f64,
}

/// Why a pack could not be prepared.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// An isotropic step found no equilibrium.
    #[error(
        "pack.prepare[{step}].isotropic: {source}; try another confining_stress, or a step \
             between"
    )]
    Isotropic {
        /// Index of the step.
        step: usize,
        /// What was found.
        source: CompactError,
    },
    /// A uniaxial step could not begin.
    #[error("pack.prepare[{step}].uniaxial: {source}")]
    Twin {
        /// Index of the step.
        step: usize,
        /// Why.
        source: TwinError,
    },
    /// A uniaxial step found no equilibrium.
    #[error(
        "pack.prepare[{step}].uniaxial: at a strain of {strain:.4e}: {text}; try another \
             strain_increment"
    )]
    Uniaxial {
        /// Index of the step.
        step: usize,
        /// Strain asked for.
        strain: f64,
        /// What the twin said.
        text: String,
    },
    /// The ratio of sliding contacts did not settle.
    #[error("pack.prepare[{step}].uniaxial: not steady at max_strain = {:?}: the sliding ratio is \
             {ratio:.4} and changed by {change:.4} over the last {} increments; allowed: above 0 \
             and less than steady = {:?}, so take a larger max_strain or steady",
             end.max_strain, end.window, end.steady)]
    Unsteady {
        /// Index of the step.
        step: usize,
        /// Ratio at the end.
        ratio: f64,
        /// Its range over the last increments.
        change: f64,
        /// What was asked for.
        end: Steady,
    },
}

/// Takes `pack` through the steps of `scene`; `watch` hears of every equilibrium.
///
/// # Errors
/// When a step finds no equilibrium, or the ratio of sliding contacts does not settle.
pub fn prepare(
    scene: &Scene,
    pack: Pack,
    watch: &mut dyn FnMut(&Reached),
) -> Result<Pack, PrepareError> {
    let steps = &scene.pack.prepare;
    steps.iter().enumerate().try_fold(pack, |pack, (index, step)| {
        let scene = &*rescale::before(scene, &steps[index + 1..]);
        match step {
            Step::Isotropic(step) => isotropic(scene, &pack, index, step, watch),
            Step::Uniaxial(step) => uniaxial(scene, &pack, index, step, watch),
            Step::Rescale(step) => Ok(rescale(&pack, *step)),
        }
    })
}

fn isotropic(
    scene: &Scene,
    pack: &Pack,
    index: usize,
    step: &Isotropic,
    watch: &mut dyn FnMut(&Reached),
) -> Result<Pack, PrepareError> {
    let confining_stress = step.confining_stress;
    let compacted = match scene.dimension {
        2 => discs::compact(scene, pack, confining_stress),
        _ => compact(pack, confining_stress, &scene.walls, scene.solver),
    };
    let pack = compacted.map_err(|source| PrepareError::Isotropic { step: index, source })?;
    watch(&Reached { step: index, strain: None, confining_stress, sliding_ratio: 0.0 });
    Ok(pack)
}

fn uniaxial(
    scene: &Scene,
    pack: &Pack,
    index: usize,
    step: &Uniaxial,
    watch: &mut dyn FnMut(&Reached),
) -> Result<Pack, PrepareError> {
    let mut rig = Rig::new(scene, pack, index, step, watch)?;
    match step.end {
        End::Strain(strain) => {
            // A quotient that rounding put above a whole number means that number.
            let parts = (strain.abs() / step.strain_increment - 1e-6).ceil().max(1.0);
            for part in 1..=parts as u32 {
                rig.go(strain * f64::from(part) / parts)?;
            }
        }
        End::Steady(end) => {
            let mut ratios = vec![rig.ratio];
            let most = (end.max_strain / step.strain_increment).round() as u32;
            for increment in 1..=most {
                ratios.push(rig.go(f64::from(increment) * step.strain_increment)?);
                if is_steady(&ratios, &end) {
                    return Ok(rig.twin.pack());
                }
            }
            let (ratio, change) = (rig.ratio, change(&ratios, end.window));
            return Err(PrepareError::Unsteady { step: index, ratio, change, end });
        }
    }
    Ok(rig.twin.pack())
}

/// Whether the last of `ratios`, one an equilibrium, is above 0 and the last of them are close.
fn is_steady(ratios: &[f64], end: &Steady) -> bool {
    ratios.len() > end.window as usize
        && ratios.last().is_some_and(|&ratio| ratio > 0.0)
        && change(ratios, end.window) < end.steady
}

/// Largest less smallest of `ratios` over the last `window` increments.
fn change(ratios: &[f64], window: u32) -> f64 {
    let last = ratios.iter().rev().take(window as usize + 1);
    let (least, most) = last.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), &ratio| {
        (least.min(ratio), most.max(ratio))
    });
    most - least
}

/// Moves the walls of one step.
struct Rig<'a> {
    twin: Twin,
    /// Displacement of each wall at a strain of one \[m\].
    travel: [f64; wall::COUNT],
    sequence: u64,
    step: usize,
    /// Sliding contacts over all contacts now.
    ratio: f64,
    watch: &'a mut dyn FnMut(&Reached),
}

impl<'a> Rig<'a> {
    /// A rig at the initial equilibrium of `pack`.
    fn new(
        scene: &Scene,
        pack: &Pack,
        index: usize,
        step: &Uniaxial,
        watch: &'a mut dyn FnMut(&Reached),
    ) -> Result<Self, PrepareError> {
        let twin = Twin::new(scene, pack, rayon::current_num_threads())
            .map_err(|source| PrepareError::Twin { step: index, source })?;
        let axis = step.axis.index();
        let mut travel = [0.0; wall::COUNT];
        for (wall, share) in step.moving.shares().into_iter().enumerate() {
            travel[2 * axis + wall] = share * pack.bounds.sides()[axis];
        }
        let mut rig = Self { twin, travel, sequence: 0, step: index, ratio: 0.0, watch };
        let report = rig.twin.start(STATE);
        rig.take(0.0, report)?;
        Ok(rig)
    }

    /// Goes to `strain` of the box at the start; the ratio of sliding contacts there.
    fn go(&mut self, strain: f64) -> Result<f64, PrepareError> {
        self.sequence += 1;
        let command = Command {
            stamp: Stamp::default(),
            session: "prepare".into(),
            sequence: self.sequence,
            mode: Mode::Absolute,
            ask: Ask::Displacement(self.travel.map(|travel| strain * travel)),
            age: None,
        };
        let report = self.twin.apply(&command, STATE);
        self.take(strain, report)
    }

    fn take(&mut self, strain: f64, report: Report) -> Result<f64, PrepareError> {
        let step = self.step;
        let measured = report.measures.and_then(|measures| measures.state);
        let (Disposition::Applied, Some(state)) = (report.disposition, measured) else {
            return Err(PrepareError::Uniaxial { step, strain, text: report.text });
        };
        let PackState { confining_stress, sliding_ratio, .. } = state;
        self.ratio = sliding_ratio;
        (self.watch)(&Reached { step, strain: Some(strain), confining_stress, sliding_ratio });
        Ok(sliding_ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const END: Steady = Steady { steady: 0.01, window: 3, max_strain: 0.1 };

    #[test]
    fn a_ratio_is_steady_when_it_stayed_within_the_limit_over_the_window() {
        assert!(is_steady(&[0.0, 0.100, 0.104, 0.096, 0.105], &END));
        // The range counts, not the difference of first and last.
        assert!(!is_steady(&[0.0, 0.100, 0.104, 0.093, 0.100], &END));
        // The jump is one increment too near.
        assert!(!is_steady(&[0.0, 0.0, 0.100, 0.104, 0.096], &END));
    }

    #[test]
    fn a_ratio_is_not_steady_before_the_window_is_full() {
        assert!(!is_steady(&[0.1, 0.1, 0.1], &END));
        assert!(is_steady(&[0.1, 0.1, 0.1, 0.1], &END));
    }

    #[test]
    fn contacts_that_never_slid_are_not_steady() {
        assert!(!is_steady(&[0.0; 20], &END));
    }
}
