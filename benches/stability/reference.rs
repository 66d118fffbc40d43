//! The gradient flow dx/dt = -∇Π/k integrated explicitly: what the solver's own descent is compared
//! with. It shares the contact forces with the solver and nothing else.
//!
//! A Runge-Kutta-Chebyshev method of second order (Sommeijer, Shampine and Verwer, J. Comput. Appl.
//! Math. 88, 315, 1998): explicit, but stable over steps that grow with the square of its stages.

use graintwin::Vec3;
use graintwin::model::Model;
use graintwin::relax::Workspace;
use graintwin::state::State;

/// Error of a step over the mean overlap.
const ERROR: f64 = 1e-4;
/// Unbalanced force over the mean contact force at the end.
const RESIDUAL: f64 = 1e-7;
/// Stages of a step at most.
const MOST_STAGES: usize = 250;
/// Evaluations of the forces at most.
const MOST_EVALUATIONS: u64 = 1_000_000;

/// The unbalanced force that passed a dip has grown to this many times its least.
const GROWTH: f64 = 1.5;

/// Where the unbalanced force of all grains was least before it grew again.
#[derive(Default)]
struct Dip {
    least: f64,
    positions: Option<Vec<Vec3>>,
    passed: bool,
}

impl Dip {
    fn see(&mut self, positions: &[Vec3], force: &[Vec3]) {
        let now = force.iter().map(Vec3::norm_squared).sum::<f64>().sqrt();
        if self.passed {
        } else if self.positions.is_none() || now < self.least {
            (self.least, self.positions) = (now, Some(positions.to_vec()));
        } else {
            self.passed = now > GROWTH * self.least;
        }
    }
}

/// Follows the flow from `state` to its end, all grains taking part; `None` where it takes too long.
/// Returns where the grains were in the first dip of the unbalanced force, if it had any.
#[expect(clippy::option_option, reason = "no end, or an end without a dip")]
pub(crate) fn follow(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
) -> Option<Option<Vec<Vec3>>> {
    let mut dip = Dip::default();
    state.carries.fill(true);
    let n = model.len();
    let begin = work.effort().gradients;
    let mut y = gather(model, state);
    let mut f = force(model, state, work, &y);
    let mut h = 0.1;
    while work.effort().gradients - begin < MOST_EVALUATIONS {
        let sums = work.balance.sums;
        dip.see(&y[..n], &f);
        let largest = f.iter().map(Vec3::norm).fold(0.0, f64::max) * work.reference_stiffness;
        if largest <= RESIDUAL * sums.mean_force() || sums.mean_force() < model.negligible_force() {
            scatter(model, state, &y);
            return Some(dip.positions.filter(|_| dip.passed));
        }
        let overlap = sums.mean_overlap();
        let radius = spectral_radius(work, n);
        let stages = ((1.54 * h * radius + 1.0).sqrt().ceil() as usize).max(2);
        if stages > MOST_STAGES {
            h = ((MOST_STAGES * MOST_STAGES - 1) as f64) / 1.54 / radius * 0.98;
            continue;
        }
        let next = chebyshev(model, state, work, &y, &f, h, stages);
        let g = force(model, state, work, &next);
        let mut error = 0.0_f64;
        for k in 0..y.len() {
            let estimate = (y[k] - next[k]) * 0.8 + (f[k] + g[k]) * (0.4 * h);
            error = error.max(estimate.norm());
        }
        error /= ERROR * overlap;
        if error <= 1.0 {
            (y, f) = (next, g);
        } else {
            // The balance is that of the refused step.
            f = force(model, state, work, &y);
        }
        h *= (0.8 / error.max(1e-6).cbrt()).clamp(0.1, 3.0);
    }
    None
}

fn gather(model: &Model, state: &State) -> Vec<Vec3> {
    let turns = state.rotation.iter().zip(&model.radius).map(|(turn, radius)| turn * *radius);
    state.position.iter().copied().chain(turns).collect()
}

fn scatter(model: &Model, state: &mut State, y: &[Vec3]) {
    let (moves, turns) = y.split_at(model.len());
    state.position.copy_from_slice(moves);
    for ((to, turn), radius) in state.rotation.iter_mut().zip(turns).zip(&model.radius) {
        *to = turn / *radius;
    }
}

fn force(model: &Model, state: &mut State, work: &mut Workspace, y: &[Vec3]) -> Vec<Vec3> {
    scatter(model, state, y);
    let bounds = state.bounds(model);
    work.evaluate(model, state, &bounds);
    let scale = -1.0 / work.reference_stiffness;
    work.balance.gradient.iter().chain(&work.balance.moment).map(|g| g * scale).collect()
}

/// A bound of the largest eigenvalue of the Hessian over the reference stiffness.
fn spectral_radius(work: &Workspace, n: usize) -> f64 {
    let mut rows = vec![0.0; n];
    for i in 0..n {
        rows[i] += work.balance.wall_stiffness[i].iter().map(|k| f64::from(*k)).sum::<f64>();
        let first = work.neighbours.row(i).start;
        for link in &work.balance.links[first..first + work.balance.links_in_row[i] as usize] {
            let stiffness = f64::from(link.m.iter().map(|m| m * m).sum::<f32>());
            rows[i] += stiffness;
            rows[link.second as usize] += stiffness;
        }
    }
    let shear = if work.reference.active { 3.0 } else { 1.0 };
    2.2 * shear * rows.iter().fold(0.01, |most: f64, row| most.max(*row))
}

fn chebyshev(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    y: &[Vec3],
    f: &[Vec3],
    h: f64,
    stages: usize,
) -> Vec<Vec3> {
    let w0 = 1.0 + 2.0 / 13.0 / (stages * stages) as f64;
    // T, T' and T'' at w0 by their recurrences.
    let mut t = vec![[1.0, 0.0, 0.0], [w0, 1.0, 0.0]];
    for j in 2..=stages {
        let (a, b) = (t[j - 1], t[j - 2]);
        t.push([
            2.0 * w0 * a[0] - b[0],
            2.0 * a[0] + 2.0 * w0 * a[1] - b[1],
            4.0 * a[1] + 2.0 * w0 * a[2] - b[2],
        ]);
    }
    let w1 = t[stages][1] / t[stages][2];
    let b = |j: usize| t[j.max(2)][2] / t[j.max(2)][1].powi(2);
    let mut before = y.to_vec();
    let mut now: Vec<Vec3> = y.iter().zip(f).map(|(y, f)| y + f * (b(1) * w1 * h)).collect();
    for j in 2..=stages {
        let mu = 2.0 * b(j) * w0 / b(j - 1);
        let nu = -b(j) / b(j - 2);
        let slope = 2.0 * b(j) * w1 / b(j - 1);
        let first = -(1.0 - b(j - 1) * t[j - 1][0]) * slope;
        let g = force(model, state, work, &now);
        let next = (0..y.len())
            .map(|k| {
                y[k] * (1.0 - mu - nu)
                    + now[k] * mu
                    + before[k] * nu
                    + g[k] * (slope * h)
                    + f[k] * (first * h)
            })
            .collect();
        before = std::mem::replace(&mut now, next);
    }
    now
}
