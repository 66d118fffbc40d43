//! Depositing cement between bodies that are close (T 4.5).
//!
//! The configuration at the deposition is free of stress where the effective laws hold: all
//! deformations count from there. A parallel bond begins without load beside grains that are loaded
//! as they were.

use crate::contact::Other;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::model::Model;
use crate::scene::{Cement, CementLaw, Solution};
use crate::state::{Bond, Condition, Ledger, State};

/// A pair of bodies that is close.
struct Close {
    first: u32,
    second: Other,
    distance: f64,
    /// Ri + Rj, or Ri at a wall \[m\].
    reach: f64,
}

impl Close {
    fn overlap(&self) -> f64 {
        self.reach - self.distance
    }
}

/// Deposits `cement` between the bodies of `state`. What the contacts carried in shear is forgotten.
pub fn deposit(model: &Model, cement: &Cement, state: &mut State) {
    let pairs = close(model, cement, state);
    let nearest = nearest(model, &pairs);
    state.bonds.clear();
    state.memory.clear();
    state.friction = Ledger { stored: 0.0, ..state.friction };
    for pair in &pairs {
        let Close { first, second, distance, .. } = *pair;
        let overlap = pair.overlap();
        let is_wall = matches!(second, Other::Wall(_));
        let (effective_radius, _) = model.pair(first, second);
        let deposited = match cement.law {
            CementLaw::Parallel(law) => law.radius_ratio * effective_radius,
            _ => {
                // (4.4); across a gap as deep as the shallowest contact nearby.
                let depth = match second {
                    _ if overlap > 0.0 => overlap,
                    Other::Grain(j) => nearest[first as usize].min(nearest[j as usize]),
                    Other::Wall(_) => nearest[first as usize],
                };
                (1.0 + cement.kappa) * (effective_radius * depth).sqrt()
            }
        };
        let bond = Bond {
            first,
            second,
            distance,
            overlap,
            radius: deposited,
            share: 1.0,
            work: 0.0,
            normal_force: (cement.solution == Solution::TwoStep).then_some(0.0),
            condition: if is_wall && !cement.walls { Condition::Bare } else { Condition::Intact },
        };
        let bare = bond.condition == Condition::Bare;
        let idle = match cement.law {
            CementLaw::Parallel(_) => bare,
            // What is bare or has no stiffness across a gap matters where the bodies touch.
            _ => overlap <= 0.0 && (bare || bridges_nothing(cement)),
        };
        if idle {
            continue;
        }
        state.bonds.push(bond);
    }
    // Grains that touch nothing are held by what bridges the gaps around them.
    state.carries.fill(true);
}

/// Cement that has no stiffness where the grains do not touch (T 4.5): a^CEM is a share of their
/// contact radius.
fn bridges_nothing(cement: &Cement) -> bool {
    matches!(cement.law, CementLaw::LinearElastic)
}

/// The pairs no further apart than the cement bridges, sorted by their bodies.
fn close(model: &Model, cement: &Cement, state: &State) -> Vec<Close> {
    let bounds = state.bounds(model);
    let mut near = Neighbours::default();
    let widest = 2.0 * cement.bridge * model.max_radius;
    near.make(model, &state.position, &bounds, widest.max(1e-3 * model.mean_radius));
    let mut pairs = Vec::new();
    for (i, at) in state.position.iter().enumerate() {
        let mut add = |second: Other, distance: f64, reach: f64| {
            if distance <= (1.0 + cement.bridge) * reach {
                pairs.push(Close { first: i as u32, second, distance, reach });
            }
        };
        for &j in &near.second[near.row(i)] {
            let distance = (at - state.position[j as usize]).norm();
            add(Other::Grain(j), distance, model.radius[i] + model.radius[j as usize]);
        }
        for (w, radius) in near.walls_near(model, i) {
            add(Other::Wall(w), wall_gap(at, usize::from(w), &bounds), radius);
        }
    }
    pairs
}

/// h_i^min: the smallest overlap of each grain with what it touches \[m\]; for one that touches
/// nothing the smallest of all.
fn nearest(model: &Model, pairs: &[Close]) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; model.len()];
    for pair in pairs.iter().filter(|pair| pair.overlap() > 0.0) {
        let mut take = |i: u32| least[i as usize] = least[i as usize].min(pair.overlap());
        take(pair.first);
        if let Other::Grain(j) = pair.second {
            take(j);
        }
    }
    let all = least.iter().copied().fold(f64::INFINITY, f64::min);
    // Grains that hardly meet anywhere: as deep as glass at a few kPa.
    let all = if all.is_finite() { all } else { 1e-5 * model.mean_radius };
    for least in least.iter_mut().filter(|least| least.is_infinite()) {
        *least = all;
    }
    least
}
