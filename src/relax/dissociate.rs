//! Dissociation in steps that the pack can follow.
//!
//! Grains that shrink are to the pack what walls are that move: the radii go to their ends in parts
//! no larger than the strain between two equilibria that the solver's settings allow, and the walls
//! go with them.

use crate::Vec3;
use crate::contact::Other;
use crate::measure::contacts::Contacts;
use crate::measure::walls;
use crate::model::Model;
use crate::relax::advance::{Advance, HALVINGS, ROUNDING, advance, remaining_strain, strain_limit};
use crate::relax::{Outcome, Status, Workspace};
use crate::state::{Condition, Dissociated, State};
use crate::wall::{self, Control, Setpoint};

/// Takes the grains of `state`, an equilibrium, to where `to` has happened to them, and the walls to
/// where `setpoint` has them; the energy in `to` is of no meaning.
///
/// When no equilibrium is found `state` and the radii are what they were before. `here` is the
/// outcome that led to `state`.
pub fn dissociate(
    model: &mut Model,
    state: &mut State,
    work: &mut Workspace,
    to: &Dissociated,
    setpoint: &Setpoint,
    here: Outcome,
) -> Advance {
    let start = state.clone();
    let mut last = state.clone();
    let mut so_far = Advance::at(here);
    loop {
        last.copy_from(state);
        let ends = standing(setpoint, &last);
        let way = largest_change(model, &last.dissociated, to) / (2.0 * model.mean_radius);
        let way = way.max(remaining_strain(model, &last, &ends));
        let limit = match so_far.outcome.status {
            // The overlaps of grains that float say nothing.
            Status::Unjammed => model.solver.max_strain_increment,
            _ => strain_limit(model, &so_far.outcome),
        };
        let mut share = 1.0 / (way / limit * (1.0 - ROUNDING)).ceil().max(1.0);
        let before = Loads::of(model, &last, work);
        for attempt in 0.. {
            state.dissociated = last.dissociated.towards(to, share);
            model.weaken(state, last.dissociated.lost);
            fit(model, state, work);
            let part = part(setpoint, &last.displacement, share);
            let reached = advance(model, state, work, &part, so_far.outcome);
            let found = reached.outcome.status.is_equilibrium();
            so_far.add(reached);
            if found {
                break;
            }
            state.copy_from(&last);
            fit(model, state, work);
            if attempt == HALVINGS {
                state.copy_from(&start);
                fit(model, state, work);
                so_far.jumps.clear();
                return so_far;
            }
            share *= 0.5;
        }
        let after = Loads::of(model, state, work);
        state.wall_work = last.wall_work + after.wall_work(&before, &last, state);
        state.dissociated.work = last.dissociated.work + after.growth_work(&before);
        if share >= 1.0 {
            return so_far;
        }
    }
}

/// The radii and what is derived from them follow the state.
fn fit(model: &mut Model, state: &State, work: &mut Workspace) {
    if model.dissociate(&state.dissociated) {
        work.neighbours.forget();
    }
}

impl Dissociated {
    /// After `share` of the way to `end`; the energy stays.
    fn towards(&self, end: &Self, share: f64) -> Self {
        let part = |from: f64, to: f64| if share >= 1.0 { to } else { from + share * (to - from) };
        Self {
            lost: part(self.lost, end.lost),
            pressure: part(self.pressure, end.pressure),
            borne: part(self.borne, end.borne),
            work: self.work,
        }
    }
}

/// Largest change of a radius \[m\].
fn largest_change(model: &Model, from: &Dissociated, to: &Dissociated) -> f64 {
    let change = |k| (model.radius_at(k, to) - model.radius_at(k, from)).abs();
    (0..model.len()).map(change).fold(0.0, f64::max)
}

/// Where the walls that stand shall go \[m\].
fn standing(setpoint: &Setpoint, state: &State) -> [f64; wall::COUNT] {
    std::array::from_fn(|w| match setpoint[w] {
        Control::Displacement(displacement) => displacement,
        Control::Load(_) => state.displacement[w],
    })
}

/// Walls that stand after `share` of their way; the others keep their loads.
fn part(setpoint: &Setpoint, from: &[f64; wall::COUNT], share: f64) -> Setpoint {
    std::array::from_fn(|w| match setpoint[w] {
        Control::Displacement(to) if share < 1.0 => {
            Control::Displacement(from[w] + share * (to - from[w]))
        }
        control => control,
    })
}

/// What an equilibrium exerts on what changes.
struct Loads {
    /// Normal forces on the walls \[N\].
    walls: [f64; wall::COUNT],
    /// Derivative of the contacts' energy by the radius of each grain that carries \[N\], shape (n).
    pressing: Vec<f64>,
    /// Radius of each grain \[m\], shape (n).
    radius: Vec<f64>,
    /// Weight of each grain \[N\] and its place from the box's centre \[m\]; empty without gravity.
    weight: Vec<(Vec3, Vec3)>,
}

impl Loads {
    fn of(model: &Model, state: &State, work: &mut Workspace) -> Self {
        let bounds = state.bounds(model);
        work.neighbours.refresh(model, &state.position, &bounds);
        let mut pressing = vec![0.0; model.len()];
        for contact in Contacts::of(model, state, &work.neighbours).list {
            // U = 2/5 M h^(5/2) with M ~ √R*: by its own radius a grain changes the overlap, and R*.
            let i = contact.first as usize;
            if contact.cement == Some(Condition::Intact) && !model.presses_beside_cement() {
                // An effective law knows the distance of the centres, whatever the radii.
                continue;
            }
            let own = 0.2 * contact.overlap / model.radius[i];
            match contact.second {
                Other::Grain(j) => {
                    let j = j as usize;
                    let (ri, rj) = (model.radius[i], model.radius[j]);
                    let other = 0.2 * contact.overlap / rj;
                    pressing[i] += contact.force * (1.0 + own * rj / (ri + rj));
                    pressing[j] += contact.force * (1.0 + other * ri / (ri + rj));
                }
                Other::Wall(_) => pressing[i] += contact.force * (1.0 + own),
            }
        }
        let centre = Vec3::from(bounds.center());
        let carried = |k: usize| if state.carries[k] { model.weight[k] } else { Vec3::zeros() };
        let weigh = |k: usize| (carried(k), state.position[k] - centre);
        Self {
            walls: walls::normal_forces(model, state, &work.neighbours),
            pressing,
            radius: model.radius.clone(),
            weight: (0..model.weight.len()).map(weigh).collect(),
        }
    }

    /// Work of the walls between two equilibria \[J\], trapezoidal.
    fn wall_work(&self, before: &Self, last: &State, now: &State) -> f64 {
        let of = |w: usize| {
            let path = now.displacement[w] - last.displacement[w];
            0.5 * (before.walls[w] + self.walls[w]) * path
        };
        (0..wall::COUNT).map(of).sum()
    }

    /// Energy that grains which grow bring into the pack \[J\], trapezoidal: with the overlaps of
    /// their contacts, and with their weight.
    fn growth_work(&self, before: &Self) -> f64 {
        let pressed = |k: usize| {
            let growth = self.radius[k] - before.radius[k];
            0.5 * (before.pressing[k] + self.pressing[k]) * growth
        };
        let lifted = |((now, at), (then, from)): (&(Vec3, Vec3), &(Vec3, Vec3))| {
            -0.5 * (now - then).dot(&(at + from))
        };
        (0..self.radius.len()).map(pressed).sum::<f64>()
            + self.weight.iter().zip(&before.weight).map(lifted).sum::<f64>()
    }
}
