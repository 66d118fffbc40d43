//! The loads of the sides: which sides a load moves, and what they carry now.

use super::cell::Side;
use super::work::Workspace;
use crate::model::Model;
use crate::relax::servo::Drive as Load;
use crate::state::State;
use crate::wall::{self, Control, Setpoint};

/// The loads of `setpoint`. The two sides of a pair in a box share one; those of an annulus and
/// membranes have their own.
pub(super) fn of(model: &Model, setpoint: &Setpoint) -> Vec<Load> {
    let Some(setup) = &model.plane else { return Vec::new() };
    let mut loads = Vec::new();
    for axis in 0..2 {
        let pair = [2 * axis, 2 * axis + 1];
        let apart = !setup.cell.is_paired(axis) || pair.iter().any(|&w| setup.cell.is_membrane(w));
        match apart {
            true => loads.extend(pair.into_iter().filter_map(|w| {
                let mut alone = *setpoint;
                alone[w ^ 1] = Control::Displacement(0.0);
                Load::of(model, &alone).into_iter().find(|load| load.axis == axis)
            })),
            false => {
                loads
                    .extend(Load::of(model, setpoint).into_iter().filter(|load| load.axis == axis));
            }
        }
    }
    loads
}

/// The first side that `load` moves.
pub(super) fn side(load: &Load) -> usize {
    2 * load.axis + usize::from(load.shares[0] == 0.0)
}

/// `goal` with what the sides of `state` carry now, `forces` \[N\].
pub(super) fn present(
    model: &Model,
    goal: &[Load],
    forces: &[f64; wall::COUNT],
    state: &State,
) -> Vec<Load> {
    let now = |load: &Load| {
        let force = load.force(forces);
        let area = model.wall_area(side(load), &state.displacement);
        let now = match load.load {
            wall::Load::Force(_) => wall::Load::Force(force),
            wall::Load::Stress(_) => wall::Load::Stress(force / area),
        };
        Load { load: now, ..*load }
    };
    goal.iter().map(now).collect()
}

/// Largest strain that is left to `target` \[m\].
pub(super) fn remaining_strain(model: &Model, state: &State, target: &[f64; wall::COUNT]) -> f64 {
    model
        .plane
        .as_ref()
        .map_or(0.0, |setup| setup.cell.remaining_strain(&state.displacement, target))
}

/// The membranes press as the scene has it, before anything else does.
pub(super) fn wrap(model: &Model, state: &mut State) {
    let Some(setup) = &model.plane else { return };
    for (pressure, side) in state.pressure.iter_mut().zip(&setup.cell.sides) {
        if let Side::Membrane(at_first) = side {
            *pressure = *at_first;
        }
    }
}

/// The membranes press with their part of `loads`.
pub(super) fn press(model: &Model, state: &mut State, work: &mut Workspace, loads: &[Load]) {
    let Some(setup) = &model.plane else { return };
    for load in loads.iter().filter(|load| setup.cell.is_membrane(side(load))) {
        state.pressure[side(load)] = load.stress().unwrap_or(0.0);
    }
    for membrane in &mut work.membranes {
        membrane.pressure = state.pressure[membrane.side];
    }
}

/// Work of the membranes' pressure on the grains since `last` \[J\].
pub(super) fn membrane_work(last: &State, work: &Workspace) -> f64 {
    work.membranes.iter().map(|m| m.work(&work.pose.at, last.pressure[m.side])).sum()
}
