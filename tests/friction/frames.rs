//! Frictional packs seen from elsewhere: moved, mirrored, counted otherwise; and the forces and
//! moments that their six walls take.

use graintwin::Vec3;
use graintwin::pack::{ContactMemory, Grain, History, Pack, wall_index, wall_of};
use graintwin::report::WallForces;
use graintwin::scene::{Coulomb, Friction, Law, Scene, Update};
use graintwin::wall::{self, Bounds};

use crate::packs::{Rig, by_strain, made, scene_to, state};

fn scene(law: Law) -> Scene {
    let mut scene = scene_to(1e-11);
    let coulomb = Coulomb { coefficient: 0.3, law, update: Update::Frozen };
    scene.contact.friction = Friction::Coulomb(coulomb);
    scene
}

fn rough(grains: usize, seed: u64) -> Pack {
    let mut pack = made(grains, 1e7, seed);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    pack
}

/// Strains of the x and z axis in turn.
fn strain(k: u32) -> [f64; 3] {
    [-0.5e-4, 0.0, 2e-4].map(|strain| strain * f64::from(k))
}

/// Another way to see a pack.
struct Frame {
    /// Grain of the pack that stands at each place here.
    order: Vec<usize>,
    /// Axis that is turned round.
    mirror: Option<usize>,
    /// \[m\].
    shift: [f64; 3],
}

impl Frame {
    fn polar(&self, v: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| if Some(axis) == self.mirror { -v[axis] } else { v[axis] })
    }

    /// A rotation vector: a mirror turns the components round that a polar one keeps.
    fn axial(&self, v: [f64; 3]) -> [f64; 3] {
        let sign = if self.mirror.is_some() { -1.0 } else { 1.0 };
        self.polar(v).map(|component| sign * component)
    }

    fn point(&self, v: [f64; 3]) -> [f64; 3] {
        let v = self.polar(v);
        std::array::from_fn(|axis| v[axis] + self.shift[axis])
    }

    fn wall(&self, w: usize) -> usize {
        if Some(wall::axis(w)) == self.mirror { w ^ 1 } else { w }
    }

    fn bounds(&self, bounds: &Bounds) -> Bounds {
        let (a, b) = (self.point(bounds.min), self.point(bounds.max));
        Bounds {
            min: std::array::from_fn(|axis| a[axis].min(b[axis])),
            max: std::array::from_fn(|axis| a[axis].max(b[axis])),
        }
    }

    fn pack(&self, pack: &Pack) -> Pack {
        let grain = |&k: &usize| {
            let grain = pack.grains[k];
            Grain { position: self.point(grain.position), ..grain }
        };
        Pack {
            bounds: self.bounds(&pack.bounds),
            grains: self.order.iter().map(grain).collect(),
            history: pack.history.as_ref().map(|history| self.history(history)),
        }
    }

    fn history(&self, history: &History) -> History {
        let place =
            |grain: u32| self.order.iter().position(|&k| k == grain as usize).unwrap() as u32;
        let contact = |contact: &ContactMemory| {
            let first = place(contact.first);
            let second = match wall_of(contact.second) {
                Some(w) => wall_index(self.wall(usize::from(w)) as u8),
                None => place(contact.second),
            };
            let sign = if first < second { 1.0 } else { -1.0 };
            let turned = |v: [f64; 3]| self.polar(v).map(|component| sign * component);
            ContactMemory {
                first: first.min(second),
                second: first.max(second),
                shear: turned(contact.shear),
                torsion: if self.mirror.is_some() { -contact.torsion } else { contact.torsion },
                sliding: contact.sliding,
                layers: (contact.layers.iter())
                    .map(|layer| graintwin::pack::Layer { ratio: turned(layer.ratio), ..*layer })
                    .collect(),
            }
        };
        let mut contacts: Vec<_> = history.contacts.iter().map(contact).collect();
        contacts.sort_by_key(|contact| (contact.first, contact.second));
        let rotation = self.order.iter().map(|&k| self.axial(history.rotation[k])).collect();
        History { rotation, contacts, bonds: Vec::new() }
    }

    /// The walls' forces as seen from here.
    fn walls(&self, walls: &WallForces) -> [[f64; 3]; wall::COUNT] {
        std::array::from_fn(|w| self.polar(walls.force[self.wall(w)]))
    }
}

fn frames(grains: usize) -> [(&'static str, Frame); 4] {
    let order: Vec<usize> = (0..grains).collect();
    // 7 and the number of grains have no common divisor.
    assert_ne!(grains % 7, 0);
    let dealt: Vec<usize> = order.iter().map(|k| (7 * k + 3) % grains).collect();
    let none = [0.0; 3];
    [
        ("moved", Frame { order: order.clone(), mirror: None, shift: [1e-3, -2e-3, 3e-3] }),
        ("mirrored across x", Frame { order: order.clone(), mirror: Some(0), shift: none }),
        ("mirrored across z", Frame { order, mirror: Some(2), shift: none }),
        ("counted otherwise", Frame { order: dealt, mirror: None, shift: none }),
    ]
}

fn largest(forces: &[[f64; 3]; wall::COUNT]) -> f64 {
    forces.iter().map(|force| Vec3::from(*force).norm()).fold(0.0, f64::max)
}

#[test]
fn a_loaded_pack_answers_the_same_wherever_and_however_it_is_seen() {
    const GRAINS: usize = 40;
    for law in [Law::ReturnMap, Law::Secant, Law::MindlinDeresiewicz] {
        let (mut rig, _) = Rig::start(&scene(law), &rough(GRAINS, 8));
        let start = rig.twin.pack().bounds;
        for k in 1..=3 {
            rig.go_quietly(by_strain(&start, strain(k)));
        }
        let loaded = rig.twin.pack();
        let (mut rig, _) = Rig::start(&scene(law), &loaded);
        let mut seen: Vec<_> = frames(GRAINS)
            .into_iter()
            .map(|(name, frame)| {
                let (rig, report) = Rig::start(&scene(law), &frame.pack(&loaded));
                assert_eq!(state(&report.measures.unwrap()).iterations, 0, "{name}");
                (name, frame, rig)
            })
            .collect();
        for k in 1..=4 {
            let to = by_strain(&loaded.bounds, strain(k));
            let measures = rig.go_quietly(to);
            for (name, frame, other) in &mut seen {
                let found = other.go_quietly(to);
                let want = frame.walls(&measures.walls);
                let mut off = 0.0f64;
                for (found, want) in found.walls.force.iter().zip(want) {
                    off = off.max((Vec3::from(*found) - Vec3::from(want)).norm());
                }
                let off = off / largest(&want);
                // The solver counts by place, so that the bits do not depend on the file's order.
                // Elsewhere a centre is resolved to 4e-19 m, an overlap to 4e-13 of itself, and
                // the grains are off balance by 1e-11 of the mean force at most.
                let allowed = if *name == "counted otherwise" { 0.0 } else { 1e-10 };
                assert!(off <= allowed, "{law:?} {name} at {k}: {off:e}");
            }
        }
    }
}

#[test]
fn the_walls_of_a_frictional_pack_take_no_force_and_no_moment_together() {
    const GRAINS: usize = 100;
    for law in [Law::ReturnMap, Law::MindlinDeresiewicz] {
        let (mut rig, _) = Rig::start(&scene(law), &rough(GRAINS, 4));
        let start = rig.twin.pack().bounds;
        for k in 1..=5 {
            let measures = rig.go_quietly(by_strain(&start, strain(k)));
            let sum =
                |of: &[[f64; 3]; wall::COUNT]| of.iter().map(|v| Vec3::from(*v)).sum::<Vec3>();
            let (force, moment) = (sum(&measures.walls.force), sum(&measures.walls.moment));
            // Each grain is off balance by the residual at most, a force times its distance from
            // the centre and a moment times its radius.
            let state = state(&measures);
            let one = state.residual.max(1e-15) * state.mean_normal_force;
            let reach = Vec3::from(start.sides()).norm();
            let rounding = 1e-14 * largest(&measures.walls.force);
            let allowed = GRAINS as f64 * one + rounding;
            assert!(force.norm() <= allowed, "{law:?} {k}: {force}");
            assert!(moment.norm() <= allowed * reach, "{law:?} {k}: {moment}");
            // There is something to cancel: shear on the walls, and its couples.
            let shear = |w: usize| {
                let mut force = Vec3::from(measures.walls.force[w]);
                force[wall::axis(w)] = 0.0;
                force.norm()
            };
            let most = (0..wall::COUNT).map(shear).fold(0.0, f64::max);
            assert!(most > 1e-3 * largest(&measures.walls.force), "{most:e}");
            let couple = Vec3::from(measures.walls.moment[0]).norm();
            assert!(couple > 1e3 * allowed * reach, "{couple:e}");
        }
    }
}
