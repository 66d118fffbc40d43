//! Making a pack of discs as B does (2.2, 3.2.1): scattered at a hundredth of their size, blown up, and
//! compacted with a friction of its own, which sets the density.
//!
//! The box that they are blown up in is wide enough that nothing jams. The box then shrinks, slowly
//! against the time in which grains come to rest, and brings them to the stress asked for with the
//! friction f_gg^I; 0 gives the densest packs, the friction of the test the loosest. The walls are
//! smooth. The equilibrium is that of the core, with walls that carry the stress; the grains take up the
//! friction of the test after it, and keep the shear forces that they have.

mod contacts;
mod frame;
mod motion;
mod rest;
#[cfg(test)]
mod tests;

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::generate::{CompactError, draw};
use super::{ContactMemory, Grain, History, Pack};
use crate::contact::{hertz, mindlin};
use crate::plane::setup::shear_ratio;
use crate::scene::{Generate, Linear, Material, Normal, Scene};
use crate::wall::Bounds;
use contacts::Law;
use frame::Frame;
use motion::{Discs, Goal};

/// Area fraction to which the discs are blown up.
const LOOSE_FRACTION: f64 = 0.7;

/// Makes the pack of `spec` under the walls, laws and solver of `scene`.
///
/// # Errors
/// When no equilibrium at the stress asked for is found.
pub fn make(scene: &Scene, spec: &Generate, material: &Material) -> Result<Pack, CompactError> {
    let mut rng = Pcg64::seed_from_u64(spec.seed);
    let grains = draw(spec, material, scene.contact.friction.coefficient(), &mut rng);
    let scattered = scatter(grains, spec.aspect, inner(scene), &mut rng);
    let mut discs = Discs::of(&scattered, scene);
    let (stress, friction) = (spec.confining_stress, spec.compaction_friction);
    discs.grow(&Goal { stress, friction });
    rest::compact(scene, &scattered, discs, Goal { stress, friction })
}

/// Brings `pack` to equilibrium with `stress` \[Pa\] on all sides, without friction and gravity; it comes
/// back without history.
///
/// # Errors
/// When no equilibrium at the stress asked for is found.
pub fn compact(scene: &Scene, pack: &Pack, stress: f64) -> Result<Pack, CompactError> {
    rest::compact(scene, pack, Discs::of(pack, scene), Goal { stress, friction: 0.0 })
}

/// `grains` at random points around the origin, where they have room: in a box with the proportions
/// `aspect`, or around a circle of the radius `inner` \[m\]. It is as deep as their mean diameter
/// (B 3.1.3).
fn scatter(mut grains: Vec<Grain>, aspect: [f64; 3], inner: Option<f64>, rng: &mut Pcg64) -> Pack {
    let solid: f64 = grains.iter().map(|grain| PI * grain.radius * grain.radius).sum();
    let area = solid / LOOSE_FRACTION;
    let [x, y] = match inner {
        None => [0, 1].map(|axis| 0.5 * aspect[axis] * (area / (aspect[0] * aspect[1])).sqrt()),
        Some(inner) => [(area / PI + inner * inner).sqrt(); 2],
    };
    for grain in &mut grains {
        let [a, b] = [rng.random::<f64>(), rng.random::<f64>()];
        grain.position = match inner {
            None => [(2.0 * a - 1.0) * x, (2.0 * b - 1.0) * y, 0.0],
            Some(inner) => {
                let far = (inner * inner + a * area / PI).sqrt();
                let (sin, cos) = (TAU * b).sin_cos();
                [far * cos, far * sin, 0.0]
            }
        };
    }
    let depth = grains.iter().map(|grain| grain.radius).sum::<f64>() / grains.len() as f64;
    let max = [x, y, depth];
    Pack { bounds: Bounds { min: max.map(|side| -side), max }, grains, history: None }
}

/// Radius of the inner wall \[m\], when the walls are two circles.
fn inner(scene: &Scene) -> Option<f64> {
    scene.walls.cell.inner()
}

/// The law of the scene, without bonds: grains do not stick together while a pack is made.
fn law(grains: &[Grain], scene: &Scene) -> Law {
    let Normal::Linear(Linear { stiffness, shear_ratio: ratio, .. }) = scene.contact.normal else {
        return Law::Hertz;
    };
    let poisson = grains.iter().map(|grain| grain.poisson).sum::<f64>() / grains.len() as f64;
    let ratio = ratio.unwrap_or_else(|| shear_ratio(poisson));
    Law::Linear { normal: stiffness, shear: ratio * stiffness }
}

impl Discs {
    /// The grains of `pack` at rest, between the walls and with the law of `scene`, around the origin.
    fn of(pack: &Pack, scene: &Scene) -> Self {
        let Pack { bounds, grains, .. } = pack;
        let [x, y, _] = bounds.center();
        let sides = bounds.sides();
        let wall = hertz::compliance(scene.walls.young, scene.walls.poisson);
        let compliance = |grain: &Grain| hertz::compliance(grain.young, grain.poisson);
        let in_shear = |grain: &Grain| mindlin::shear_compliance(grain.young, grain.poisson);
        let at_wall = |grain: &Grain| hertz::modulus(grain.radius, compliance(grain) + wall);
        let at = |grain: &Grain| Vector2::new(grain.position[0] - x, grain.position[1] - y);
        let still = vec![[0.0; 3]; grains.len()];
        Self {
            at: grains.iter().map(at).collect(),
            speed: still.clone(),
            force: still,
            radius: grains.iter().map(|grain| grain.radius).collect(),
            compliance: grains.iter().map(compliance).collect(),
            shear_compliance: grains.iter().map(in_shear).collect(),
            at_wall: grains.iter().map(at_wall).collect(),
            law: law(grains, scene),
            grown: 1.0,
            frame: match inner(scene) {
                None => Frame::Box { half: [0.5 * sides[0], 0.5 * sides[1]] },
                Some(inner) => Frame::Annulus { inner, outer: 0.5 * sides[0] },
            },
            depth: sides[2],
            pairs: Vec::new(),
        }
    }

    /// `pack` where its grains and walls have gone, with the shear forces of a friction above 0.
    fn pack(&self, pack: &Pack, friction: f64) -> Pack {
        let [x, y, _] = pack.bounds.center();
        let mut now = Pack { history: None, ..pack.clone() };
        for (grain, at) in now.grains.iter_mut().zip(&self.at) {
            grain.position = [x + at.x, y + at.y, 0.0];
        }
        for (axis, center) in [x, y].into_iter().enumerate() {
            now.bounds.min[axis] = center - self.frame.half()[axis];
            now.bounds.max[axis] = center + self.frame.half()[axis];
        }
        now.history = (friction > 0.0).then(|| History {
            rotation: vec![[0.0; 3]; self.at.len()],
            contacts: self.sheared(friction),
            bonds: Vec::new(),
        });
        now
    }

    /// What contacts with shear remember.
    fn sheared(&self, friction: f64) -> Vec<ContactMemory> {
        let memory = |pair: &contacts::Pair| {
            let touch = pair.touch(self).filter(|_| pair.shear != 0.0)?;
            let across = contacts::left_of(touch.along) * pair.shear;
            Some(ContactMemory {
                first: pair.first,
                second: pair.second,
                shear: [across.x, across.y, 0.0],
                torsion: 0.0,
                sliding: pair.shear.abs() >= friction * touch.normal,
                layers: Vec::new(),
            })
        };
        self.pairs.iter().filter_map(memory).collect()
    }
}
