//! What the pack does to the sides of the rig at an equilibrium.

use super::boundary::{self, Body, SIDES};
use super::{Vec2, contacts, glue, left_of};
use crate::contact::Other;
use crate::contact::neighbours::Neighbours;
use crate::measure::contacts::Contact;
use crate::model::Model;
use crate::state::State;
use crate::wall;

/// Forces on the sides, and what does work as they move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pressed {
    /// Normal force on each wall \[N\]; 0 on the z walls, which discs do not have.
    pub normal: [f64; wall::COUNT],
    /// Derivative of the potential over the inward displacement of each side \[N\].
    pub sides: [f64; SIDES],
    /// Its derivative over the tilt γ \[N m\].
    pub tilt: f64,
    /// Force of the low and the high y side on the grains along x, times the side's inward sign \[N\].
    pub drag: [f64; 2],
}

impl Pressed {
    /// At the equilibrium `state`; the neighbour list must hold its contacts.
    #[must_use]
    pub fn of(model: &Model, state: &State, near: &Neighbours) -> Self {
        let (contacts, bodies) = contacts::with_bodies(model, state, near);
        let moments = moments(model, state, &contacts.list);
        let mut pressed = Self::default();
        for contact in &contacts.list {
            let Other::Wall(b) = contact.second else { continue };
            let body = &bodies[usize::from(b)];
            let i = contact.first as usize;
            let force = contact.normal * contact.force + contact.shear;
            let force = Vec2::new(force.x, force.y);
            let side = usize::from(body.side);
            pressed.normal[side] += boundary::pressed(model, contact, side);
            pressed.sides[side] += contact.force * body.growth + force.dot(&body.slide);
            if wall::axis(side) == 1 {
                pressed.drag[side % 2] += wall::inward(side) * force.x;
            }
            let at = Vec2::new(state.position[i].x, state.position[i].y) - body.at;
            pressed.tilt += force.dot(&body.swing.way)
                + body.swing.rate
                    * match glue::side(&state.glued, i) {
                        // The wall takes the grain along, and turns it.
                        Some(_) => force.dot(&left_of(at)) - moments[i],
                        // It turns beneath the grain: shear does no work where they touch.
                        None => -contact.force * at.dot(&tangent(body)),
                    };
        }
        let Some(setup) = &model.plane else { return pressed };
        for side in (0..SIDES).filter(|&side| setup.cell.is_membrane(side)) {
            let area = setup.cell.area(side, &state.displacement);
            pressed.normal[side] = state.pressure[side] * area;
        }
        pressed
    }

    /// Work of the sides from `before` to `after`, whose states are those, trapezoidal \[J\].
    #[must_use]
    pub fn work(before: (&State, &Self), after: (&State, &Self)) -> f64 {
        let ((from, had), (to, has)) = (before, after);
        let along = |side: usize| {
            let way = to.displacement[side] - from.displacement[side];
            0.5 * (had.sides[side] + has.sides[side]) * way
        };
        let tilted = 0.5 * (had.tilt + has.tilt) * (to.tilt - from.tilt);
        (0..SIDES).map(along).sum::<f64>() + tilted
    }
}

/// Left of the normal of a plane; of no meaning for other bodies, which do not turn.
fn tangent(body: &Body) -> Vec2 {
    match body.shape {
        boundary::Shape::Plane(normal) => left_of(normal),
        boundary::Shape::Disc(_) | boundary::Shape::Ring(_) | boundary::Shape::Nothing => {
            Vec2::zeros()
        }
    }
}

/// Moment of the other grains on each glued one about its centre \[N m\], shape (n); empty where
/// nothing is glued.
fn moments(model: &Model, state: &State, list: &[Contact]) -> Vec<f64> {
    if state.glued.is_empty() {
        return Vec::new();
    }
    let mut moments = vec![0.0; model.len()];
    for contact in list {
        let Other::Grain(j) = contact.second else { continue };
        let (i, j) = (contact.first as usize, j as usize);
        let [ri, rj] = [model.radius[i], model.radius[j]];
        let d = contact.distance;
        let arm = 0.5 * (d + (ri - rj) * (ri + rj) / d);
        let turning = contact.normal.cross(&contact.shear).z;
        moments[i] -= arm * turning;
        moments[j] -= (d - arm) * turning;
    }
    moments
}
