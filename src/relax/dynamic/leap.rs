//! A leap-frog step of one grain's motion with local damping (B 13-14; Cundall and Strack 1979), in the
//! time without unit of masses that are stiffnesses.

use std::f64::consts::SQRT_2;

use nalgebra::SVector;

/// Share of the largest stable time step.
const SAFE: f64 = 0.9;
/// Longest step over the mean overlap: two grains that meet come no deeper than contacts are. The
/// masses suit those; deeper ones would throw grains back with more energy than they had.
pub(crate) const DEEPEST: f64 = 0.5;
/// Steps between two looks for masses that may be smaller and for grains that nothing holds.
pub(crate) const PATIENCE: u32 = 50;
/// Least mass of a grain over the mean: one that hardly touches anything may do so soon.
const LEAST: f64 = 0.2;

/// What a step takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leap {
    /// Time step, a pure number.
    pub(crate) dt: f64,
    /// Share of the force.
    pub(crate) damping: f64,
}

impl Leap {
    /// Of motion whose frequencies are below √2: 2/ω, for forces that damping makes larger.
    pub(crate) fn new(damping: f64) -> Self {
        Self { dt: SAFE * SQRT_2 / (1.0 + damping).sqrt(), damping }
    }

    /// Changes the velocity `v` by the force -`gradient` and says what way that is, at most `longest`.
    /// Damping takes a share from each component of a force that drives the motion, and adds it to one
    /// that brakes.
    pub(crate) fn advance<const N: usize>(
        &self,
        v: &mut SVector<f64, N>,
        gradient: &SVector<f64, N>,
        mass: f64,
        longest: f64,
    ) -> SVector<f64, N> {
        let Self { dt, damping } = *self;
        let force = v.zip_map(gradient, |v, g| match () {
            () if v * g < 0.0 => -g * (1.0 - damping),
            () if v * g > 0.0 => -g * (1.0 + damping),
            () => -g,
        });
        *v += force * (dt / mass);
        let length = v.norm() * dt;
        if length > longest {
            *v *= longest / length;
        }
        *v * dt
    }
}

/// Raises masses, of the displacement and of the rotation, that are small beside the mean of those that
/// anything holds; where nothing does any mass will do, and it is `unit`. Says what the least ones are.
pub(crate) fn raise(masses: &mut [[f64; 2]], unit: f64) -> [f64; 2] {
    [0, 1].map(|kind| {
        let held = masses.iter().filter(|mass| mass[kind] > 0.0).count().max(1);
        let mean = masses.iter().map(|mass| mass[kind]).sum::<f64>() / held as f64;
        let least = if mean > 0.0 { LEAST * mean } else { unit };
        for mass in &mut *masses {
            mass[kind] = mass[kind].max(least);
        }
        least
    })
}
