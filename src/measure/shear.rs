//! How a box of discs is sheared, and how the grains in its middle take it (B 3.3.4).

use nalgebra::Matrix2;

use crate::analytic::tensor::Tensor;
use crate::contact::Other;
use crate::measure::contacts::Contact;
use crate::model::Model;
use crate::plane::glue;
use crate::report::Shear;
use crate::state::State;
use crate::wall::Bounds;

/// The inner grains are those in this share of the width and of the height.
const INNER: f64 = 0.5;

/// The shear of a pack of discs whose contacts are `contacts`; `None` for spheres.
#[must_use]
pub fn shear(model: &Model, state: &State, contacts: &[Contact]) -> Option<Shear> {
    let plane = model.plane.as_ref()?;
    let bounds = state.bounds(model);
    let inner: Vec<bool> = (0..model.len()).map(|i| is_inner(model, state, &bounds, i)).collect();
    let grains = inner.iter().filter(|inner| **inner).count();
    let strain = strain(model, &bounds, state.tilt);
    let stress = inner_stress(model, contacts, &inner) * solid_share(model, &bounds)
        / (0..model.len())
            .filter(|&i| inner[i])
            .map(|i| plane.volume(model.radius[i]))
            .sum::<f64>()
            .max(f64::MIN_POSITIVE);
    let free = |i: usize| state.carries[i] && glue::side(&state.glued, i).is_none();
    let turned: Vec<f64> = (state.rotation.iter().enumerate())
        .filter(|(i, _)| free(*i))
        .map(|(_, turn)| turn.z)
        .collect();
    Some(Shear {
        tilt: state.tilt,
        strain: row_major(&strain),
        inner_stress: row_major(&stress),
        inner_grains: grains as u32,
        stress_direction: direction(&stress),
        strain_direction: direction(&strain),
        mean_rotation: turned.iter().sum::<f64>() / turned.len().max(1) as f64,
    })
}

fn is_inner(model: &Model, state: &State, bounds: &Bounds, i: usize) -> bool {
    let (at, center, sides) = (state.position[i], bounds.center(), bounds.sides());
    let above = at.y - model.start.center()[1];
    let across = at.x - state.tilt * above - center[0];
    across.abs() < 0.5 * INNER * sides[0] && (at.y - center[1]).abs() < 0.5 * INNER * sides[1]
}

/// Of the map from the reference to the box as it leans, [[W/W₀, γ H/H₀], [0, H/H₀]].
fn strain(model: &Model, bounds: &Bounds, tilt: f64) -> Matrix2<f64> {
    let (now, before) = (bounds.sides(), model.reference.sides());
    let [x, y] = [0, 1].map(|axis| 1.0 - now[axis] / before[axis]);
    let shear = -0.5 * tilt * now[1] / before[1];
    Matrix2::new(x, shear, shear, y)
}

/// Sum over the inner grains of what their contacts do, f ⊗ branch \[N m\], the branch from the contact
/// to the centre.
fn inner_stress(model: &Model, contacts: &[Contact], inner: &[bool]) -> Matrix2<f64> {
    let mut sum = Matrix2::zeros();
    for contact in contacts {
        let i = contact.first as usize;
        let force = (contact.normal * contact.force + contact.shear).xy();
        let along = contact.normal.xy();
        let d = contact.distance;
        let mut add = |arm: f64| sum += force * (along * arm).transpose();
        match contact.second {
            Other::Wall(_) if inner[i] => add(d),
            Other::Wall(_) => {}
            Other::Grain(j) => {
                let j = j as usize;
                let [ri, rj] = [model.radius[i], model.radius[j]];
                let arm = 0.5 * (d + (ri - rj) * (ri + rj) / d);
                if inner[i] {
                    add(arm);
                }
                if inner[j] {
                    add(d - arm);
                }
            }
        }
    }
    sum
}

/// Volume of all grains over that of the box.
fn solid_share(model: &Model, bounds: &Bounds) -> f64 {
    model.radius.iter().map(|&radius| model.grain_volume(radius)).sum::<f64>() / bounds.volume()
}

fn direction(of: &Matrix2<f64>) -> f64 {
    let xy = 0.5 * (of[(0, 1)] + of[(1, 0)]);
    Tensor { xx: of[(0, 0)], yy: of[(1, 1)], xy }.direction().unwrap_or(f64::NAN)
}

fn row_major(of: &Matrix2<f64>) -> [f64; 4] {
    [of[(0, 0)], of[(0, 1)], of[(1, 0)], of[(1, 1)]]
}
