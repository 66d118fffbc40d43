//! One grain among the others, which stay where they are: its unbalanced force and the stiffness
//! that its contacts hold it with.

use crate::Vec3;
use crate::contact::hertz;
use crate::contact::neighbours::wall_gap;
use crate::model::Model;
use crate::relax::sym6::Sym6;
use crate::relax::tangential::Pose;
use crate::relax::{Workspace, sticking};
use crate::state::State;
use crate::wall::{self, Bounds};

/// Pivots below this share of a block's mean diagonal are lifted to it.
const SMALL_PIVOT: f32 = 0.01;

/// One grain at its turn.
pub(super) struct Site<'a> {
    pub(super) model: &'a Model,
    pub(super) state: &'a State,
    pub(super) work: &'a Workspace,
    pub(super) bounds: &'a Bounds,
    pub(super) grain: usize,
    /// One over the reference stiffness \[m/N\].
    pub(super) scale: f64,
}

/// Gradient and stiffness of one grain's energy.
#[derive(Default)]
pub(super) struct Local {
    gradient: Vec3,
    /// With respect to w = ΩR.
    moment: Vec3,
    /// In units of the reference stiffness, without the negative terms P/r, as in (19).
    block: Sym6,
    /// Whether the grain can turn.
    turns: bool,
}

impl Site<'_> {
    /// Sums over the neighbours `near`, the walls and the contacts `held` at the reference.
    pub(super) fn local(&self, near: &[(u32, f64)], held: &[u32]) -> Local {
        let Self { model, state, work, bounds, grain: i, scale } = *self;
        let mut local = Local { turns: work.reference.active, ..Local::default() };
        if let Some(weight) = model.weight.get(i) {
            local.gradient -= weight;
        }
        let (xi, ri) = (state.position[i], model.radius[i]);
        for &(j, modulus) in near {
            let branch = xi - state.position[j as usize];
            let reach = ri + model.radius[j as usize];
            let distance2 = branch.norm_squared();
            if distance2 < reach * reach {
                let distance = distance2.sqrt();
                local.push(modulus, reach - distance, branch / distance, scale);
            }
        }
        for &wall in work.neighbours.walls_near(i) {
            let wall = usize::from(wall);
            let overlap = ri - wall_gap(&xi, wall, bounds);
            if overlap > 0.0 {
                let mut normal = Vec3::zeros();
                normal[wall::axis(wall)] = wall::inward(wall);
                local.push(work.neighbours.wall_modulus[i], overlap, normal, scale);
            }
        }
        if let Some(friction) = &model.friction {
            let State { position, rotation, .. } = state;
            let pose = Pose { model, position, rotation, bounds };
            for &k in held {
                let contact = &work.reference.contacts[k as usize];
                let (traction, pull) =
                    work.reference.answer(contact, friction.law, &pose, &state.carries);
                if !traction.live {
                    continue;
                }
                let second = contact.first as usize != i;
                let sign = if second { -1.0 } else { 1.0 };
                local.gradient -= pull.force * sign;
                local.moment +=
                    (pull.lever * pull.arm[usize::from(second)] - pull.couple * sign) / ri;
                local.block.add(&sticking::block(contact, &traction, second, ri, scale));
            }
        }
        local
    }
}

impl Local {
    /// Adds the normal part of one contact, with its normal towards the grain.
    fn push(&mut self, modulus: f64, overlap: f64, normal: Vec3, scale: f64) {
        self.gradient -= normal * hertz::force(modulus, overlap);
        let stiffness = hertz::stiffness(modulus, overlap) * scale;
        let n = <[f64; 3]>::from(normal).map(|n| n as f32);
        self.block.u.add(&sticking::isotropic_across(n, 0.0, stiffness as f32));
    }

    /// Unbalanced force, or moment over radius \[N\].
    pub(super) fn unbalanced(&self) -> f64 {
        self.gradient.norm().max(self.moment.norm())
    }

    /// The displacement and the rotation times radius \[m\] that balance the grain (19), cut where
    /// one of them is longer than `longest`.
    pub(super) fn step(&self, longest: f64, scale: f64) -> [Vec3; 2] {
        let unit = self.unbalanced();
        if unit == 0.0 {
            return [Vec3::zeros(); 2];
        }
        let single = |v: &Vec3| <[f64; 3]>::from(v * (-1.0 / unit)).map(|x| x as f32);
        let right = [single(&self.gradient), single(&self.moment)];
        let [u, w] = match self.turns {
            true => self.block.inverse(0.0, SMALL_PIVOT).times(right),
            false => {
                let u = &self.block.u;
                let least = SMALL_PIVOT * (u.trace() / 3.0).max(f32::MIN_POSITIVE);
                let (_, inverse) = u.inverse_lifted(least);
                let [[x, y, z], _] = right;
                let [x, y, z, _] = inverse.times(&[x, y, z, 0.0]);
                [[x, y, z], [0.0; 3]]
            }
        };
        let [u, w] = [u, w].map(|v| Vec3::from(v.map(|x| f64::from(x) * unit * scale)));
        let length = u.norm().max(w.norm());
        let cut = if length > longest { longest / length } else { 1.0 };
        [u * cut, w * cut]
    }
}
