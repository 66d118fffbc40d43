//! FIRE, the inertial descent of Bitzek et al., PRL 97, 170201 (2006): for packs far from
//! equilibrium, where Newton's method has nothing to hold on to.

use crate::Vec3;
use crate::model::Model;
use crate::relax::{Status, Workspace};
use crate::state::State;

/// Positive-power steps before the time step may grow (Bitzek's N_min).
const PATIENCE: u32 = 5;

/// Descends until the residual is below `residual`, at most `steps` steps. Returns `Converged`,
/// `Unjammed`, `MaxIterations` or `NonFinite`, and the steps taken.
pub fn descend(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    residual: f64,
    steps: u32,
) -> (Status, u32) {
    let bounds = state.bounds(model);
    let mut velocity = vec![Vec3::zeros(); model.len()];
    // Masses equal to the reference stiffness make the time step a pure number.
    let mass = work.reference_stiffness * 4.0;
    let longest = 0.1 * model.mean_radius;
    let (mut dt, mut alpha, mut positive) = (0.1, 0.1, 0);
    for taken in 0..steps {
        work.evaluate(model, &state.position, &state.carries, &bounds);
        let mean = work.balance.sums.mean_force();
        let largest = work.balance.largest();
        if !largest.is_finite() {
            return (Status::NonFinite, taken);
        }
        if mean < work.negligible_force {
            return (Status::Unjammed, taken);
        }
        if largest <= residual * mean {
            return (Status::Converged, taken);
        }
        let gradient = &work.balance.gradient;
        let power: f64 = -velocity.iter().zip(gradient).map(|(v, g)| v.dot(g)).sum::<f64>();
        if power > 0.0 {
            let speed2: f64 = velocity.iter().map(Vec3::norm_squared).sum();
            let force2: f64 = gradient.iter().map(Vec3::norm_squared).sum();
            let mix = alpha * (speed2 / force2).sqrt();
            for (v, g) in velocity.iter_mut().zip(gradient) {
                *v = *v * (1.0 - alpha) - g * mix;
            }
            positive += 1;
            if positive > PATIENCE {
                dt = f64::min(dt * 1.1, 1.0);
                alpha *= 0.99;
            }
        } else {
            velocity.fill(Vec3::zeros());
            (dt, alpha, positive) = (dt * 0.5, 0.1, 0);
        }
        for ((at, v), g) in state.position.iter_mut().zip(&mut velocity).zip(gradient) {
            *v -= g * (dt / mass);
            let step = *v * dt;
            let length = step.norm();
            if length > longest {
                *v *= longest / length;
            }
            *at += *v * dt;
        }
    }
    (Status::MaxIterations, steps)
}
