//! Motion of the grains between two equilibria: displacement, its affine and non-affine parts,
//! rotation, local strain, and how unevenly all that is spread.
//!
//! The affine part is the motion of the box: a grain that went with it kept its place relative to
//! the walls. What a neighbourhood does is told by the affine motion that fits it best, by [Falk and
//! Langer](local).

pub mod band;
pub mod local;
pub mod localisation;

use crate::Vec3;
use crate::model::Model;
use crate::plane::lean::Lean;
use crate::relax::jump::Pose;
use crate::report::GrainMotion;
use crate::state::State;
use local::{Grains, deformations};

/// How the grains of `state` moved from `before`, in the order of the pack file.
#[must_use]
pub fn motion(model: &Model, before: &Pose, state: &State) -> GrainMotion {
    let displacement: Vec<Vec3> =
        state.position.iter().zip(&before.position).map(|(now, then)| now - then).collect();
    let non_affine: Vec<Vec3> = before.moved(model, state).collect();
    let rotation: Vec<Vec3> =
        state.rotation.iter().zip(&before.rotation).map(|(now, then)| now - then).collect();
    let local = deformations(&Grains {
        position: &before.position,
        displacement: &displacement,
        radius: &model.radius,
        carries: &state.carries,
        plane: model.plane.is_some(),
    });
    let order = &model.order;
    let motion = GrainMotion {
        displacement: filed(order, displacement.iter().map(|&u| u.into())),
        non_affine: filed(order, non_affine.iter().map(|&u| u.into())),
        rotation: filed(order, rotation.iter().map(|&turned| turned.into())),
        total_rotation: filed(order, state.rotation.iter().map(|&turned| turned.into())),
        d2min: filed(order, local.iter().map(|local| local.d2min)),
        shear_strain: filed(order, local.iter().map(|local| local.shear_strain)),
        volumetric_strain: filed(order, local.iter().map(|local| local.volumetric_strain)),
        carries: filed(order, state.carries.iter().copied()),
        localisation: localisation::UNKNOWN,
    };
    let position: Vec<[f64; 3]> = filed(order, before.position.iter().map(|&at| at.into()));
    let plane = model.plane.is_some();
    let localisation = match plane {
        false => {
            let bounds = [*before.bounds(model), *state.bounds(model)];
            localisation::of(&motion, &position, &localisation::stretch(&bounds), plane)
        }
        true => localisation::of(&motion, &position, &with_box(model, before, state), plane),
    };
    GrainMotion { localisation, ..motion }
}

/// How the box takes discs along, seen from its middle.
fn with_box(model: &Model, before: &Pose, state: &State) -> impl Fn(&[f64; 3]) -> [f64; 3] {
    let middle = Lean::new(model, &before.bounds(model), before.tilt).middle;
    let middle = Vec3::new(middle.x, middle.y, 0.0);
    let carry = before.carry(model, state);
    let shift = carry(&middle) - middle;
    move |at| {
        let at = Vec3::from(*at);
        (carry(&at) - at - shift).into()
    }
}

/// `values` in the solver's order as the pack file counts the grains; nothing of nothing.
fn filed<T: Copy + Default>(order: &[u32], values: impl ExactSizeIterator<Item = T>) -> Vec<T> {
    let mut filed = vec![T::default(); values.len()];
    for (&grain, value) in order.iter().zip(values) {
        filed[grain as usize] = value;
    }
    filed
}
