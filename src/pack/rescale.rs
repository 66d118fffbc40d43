//! Multiplying the lengths of a pack, or its forces (B table 5, VB-39).
//!
//! With lengths times l and forces times f stresses and moduli go with f/l², couples and energies
//! with f l, and, so that weights go with the forces, densities with f/l³. Strains, rotations and
//! directions stay: what was in balance is in balance.

use std::borrow::Cow;

use super::{Grain, History, Pack};
use crate::scene::prepare::{Rescale, Step};
use crate::scene::{CementLaw, CementStrength, Linear, Normal, Parallel, Scene, Targets};
use crate::wall::{Bounds, WallTarget};

/// What lengths and forces are multiplied by.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Scale {
    length: f64,
    force: f64,
}

impl Scale {
    const ONE: Self = Self { length: 1.0, force: 1.0 };

    fn of(step: Rescale) -> Self {
        match step {
            Rescale::Lengths(length) => Self { length, ..Self::ONE },
            Rescale::Forces(force) => Self { force, ..Self::ONE },
        }
    }

    /// This after `other`.
    fn after(self, other: Self) -> Self {
        Self { length: self.length * other.length, force: self.force * other.force }
    }

    fn inverse(self) -> Self {
        Self { length: 1.0 / self.length, force: 1.0 / self.force }
    }

    fn stress(self) -> f64 {
        self.force / (self.length * self.length)
    }

    fn stiffness(self) -> f64 {
        self.force / self.length
    }

    fn couple(self) -> f64 {
        self.force * self.length
    }

    fn density(self) -> f64 {
        self.force / self.length.powi(3)
    }
}

/// `pack` multiplied as `step` says, with what its contacts and bonds remember.
#[must_use]
pub fn rescale(pack: &Pack, step: Rescale) -> Pack {
    let scale = Scale::of(step);
    let lengths = |at: [f64; 3]| at.map(|x| x * scale.length);
    let grain = |grain: &Grain| Grain {
        position: lengths(grain.position),
        radius: grain.radius * scale.length,
        young: grain.young * scale.stress(),
        density: grain.density * scale.density(),
        ..*grain
    };
    Pack {
        bounds: Bounds { min: lengths(pack.bounds.min), max: lengths(pack.bounds.max) },
        grains: pack.grains.iter().map(grain).collect(),
        history: pack.history.clone().map(|history| remembered(history, scale)),
    }
}

fn remembered(mut history: History, scale: Scale) -> History {
    for contact in &mut history.contacts {
        contact.shear = contact.shear.map(|force| force * scale.force);
        contact.torsion *= scale.couple();
        contact.layers.iter_mut().for_each(|layer| layer.reach *= scale.length);
    }
    for bond in &mut history.bonds {
        bond.distance *= scale.length;
        bond.overlap *= scale.length;
        bond.radius *= scale.length;
        bond.work *= scale.couple();
        bond.normal_force = bond.normal_force.map(|force| force * scale.force);
    }
    history
}

/// `scene` with what it says of walls and cement taken back by the factors of `later` steps: it
/// says what they are in the run, and a pack that is rescaled lay between softer or stiffer ones
/// before.
pub(super) fn before<'scene>(scene: &'scene Scene, later: &[Step]) -> Cow<'scene, Scene> {
    let scale = later.iter().fold(Scale::ONE, |scale, step| match step {
        Step::Rescale(step) => Scale::of(*step).after(scale),
        Step::Isotropic(_) | Step::Uniaxial(_) => scale,
    });
    match scale == Scale::ONE {
        true => Cow::Borrowed(scene),
        false => Cow::Owned(scaled(scene.clone(), scale.inverse())),
    }
}

fn scaled(mut scene: Scene, scale: Scale) -> Scene {
    scene.walls.young *= scale.stress();
    scene.walls.cell.scale(scale.length);
    scene.walls.points.scale(scale.length);
    scene.walls.targets =
        Targets::from(scene.walls.targets.in_order().map(|target| match target {
            WallTarget::Displacement(way) => WallTarget::Displacement(way * scale.length),
            WallTarget::Force(force) => WallTarget::Force(force * scale.force),
            WallTarget::Stress(stress) => WallTarget::Stress(stress * scale.stress()),
            other @ (WallTarget::Keep | WallTarget::Unknown(..)) => other,
        }));
    match &mut scene.contact.normal {
        Normal::Hertz => {}
        Normal::Cement(cement) => {
            if let CementLaw::Parallel(Parallel { young, shear, .. }) = &mut cement.law {
                *young *= scale.stress();
                *shear *= scale.stress();
            }
            if let Some(CementStrength { tension, shear }) = &mut cement.strength {
                *tension *= scale.stress();
                *shear *= scale.stress();
            }
        }
        Normal::Linear(Linear { stiffness, bond, .. }) => {
            *stiffness *= scale.stiffness();
            bond.iter_mut().for_each(|bond| bond.cohesion *= scale.stress());
        }
    }
    scene
}
