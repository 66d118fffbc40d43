//! The unbalanced force of one grain and the stiffness that its contacts hold it with.

use crate::Vec3;
use crate::contact::hertz;
use crate::relax::site::{Grip, Press, Site};
use crate::relax::sticking;
use crate::relax::sym6::Sym6;

/// Pivots below this share of a block's mean diagonal are lifted to it.
const SMALL_PIVOT: f32 = 0.01;

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

impl Local {
    /// Sums over the contacts of grain `i`; `scale` is one over the reference stiffness \[m/N\].
    pub(super) fn of(site: &Site<'_>, i: usize, scale: f64) -> Self {
        let mut local = Self { turns: site.others.reference.active, ..Self::default() };
        let model = site.others.model;
        if let Some(weight) = model.weight.get(i) {
            local.gradient -= weight;
        }
        let radius = model.radius[i];
        site.presses(i, |press| local.push(&press, scale));
        site.grips(i, |grip| {
            let [force, moment] = grip.gradient(radius);
            local.gradient += force;
            local.moment += moment;
            let Grip { held, traction, second, .. } = &grip;
            local.block.add(&sticking::block(held, traction, *second, radius, scale));
        });
        local
    }

    /// Adds the normal part of one contact.
    fn push(&mut self, press: &Press, scale: f64) {
        let Press { modulus, overlap, normal, .. } = *press;
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
