//! One contact at the reference configuration, and its answer in another.

use crate::Vec3;
use crate::contact::coulomb::{self, Shear, Torsion};
use crate::contact::neighbours::wall_gap;
use crate::contact::partial_slip::{self, Step};
use crate::contact::{Other, hertz, mindlin};
use crate::model::{Friction, Model};
use crate::pack::Layer;
use crate::relax::tangential::turn::{Turn, turned_into_plane};
use crate::relax::tangential::{Pull, Traction};
use crate::scene::Law;
use crate::state::{Remembered, State};
use crate::wall::{Facing, Room};

/// A contact at the reference configuration. What every evaluation needs comes first.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Held {
    /// Grain i.
    pub first: u32,
    /// The other body.
    pub second: Other,
    /// r_ij⁰ \[m\]; at a wall the centre of the grain.
    pub(super) branch: Vec3,
    /// k_s \[N/m\] (T 3.5a).
    pub stiffness: f64,
    /// Q_max = μP \[N\].
    pub(super) limit: f64,
    /// k_t \[N m\] (T 3.9a); zero without torsion.
    pub(in crate::relax) torsion_stiffness: f64,
    /// Largest couple \[N m\] (T 3.3.3).
    pub(super) torsion_limit: f64,
    /// h⁰ \[m\], or the later overlap that stiffness and limit were renewed with.
    pub overlap: f64,
    /// What the contact carried.
    pub(super) carried: Remembered,
    /// n̂⁰.
    pub(super) normal: Vec3,
    /// h⁰ \[m\].
    pub reference_overlap: f64,
    /// Approach at which the bodies begin to press \[m\]: overlaps count from there.
    unstressed: f64,
    /// Number of the cement that holds the bodies together, or [`NO_BOND`].
    pub(super) bond: u32,
    /// Elastic energy of what the contact carried \[J\].
    pub(super) carried_energy: f64,
    /// For partial slip: the contact, the overlap its layers end at and the first of them.
    pub(super) partial: partial_slip::Contact,
    pub(super) before: f64,
    pub(super) first_layer: u32,
}

/// No cement.
pub(super) const NO_BOND: u32 = u32::MAX;

/// Answer of a contact in another configuration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    normal: Vec3,
    arm: [f64; 2],
    /// Answer to the shear.
    pub(super) shear: Shear,
    /// Answer to the torsion.
    pub(super) torsion: Torsion,
}

impl Answer {
    /// What the linearisation needs of it, and what the balance does.
    #[inline(always)]
    pub(super) fn parts(&self) -> (Traction, Pull) {
        let Self { normal, arm, shear, torsion } = self;
        let single = |v: &Vec3| <[f64; 3]>::from(*v).map(|x| x as f32);
        let traction = Traction {
            live: true,
            slides: shear.slides,
            normal: single(normal),
            direction: single(&shear.direction),
            across: shear.across as f32,
            sliding: (shear.along - shear.across) as f32,
            arm: arm.map(|arm| arm as f32),
            torsion: torsion.stiffness as f32,
            ..Traction::default()
        };
        let potential = shear.potential + torsion.potential;
        (traction, Pull::of(normal, arm, &shear.force, torsion.couple, potential))
    }
}

/// The two ends of a contact.
pub(super) struct Ends {
    /// r_ij \[m\]; at a wall from the wall to the centre.
    pub(super) branch: Vec3,
    /// What the arms differ by, times the distance \[m²\].
    pub(super) offset: f64,
    /// Change of r_ij since the reference \[m\].
    pub(super) moved: Vec3,
    /// Change of the rotations since then \[rad\].
    pub(super) turned: [Vec3; 2],
}

impl Ends {
    /// How the contact moved.
    #[inline(always)]
    pub(super) fn motion(&self) -> Motion {
        let Self { branch, offset, moved, turned: [wi, wj] } = self;
        let distance = branch.norm();
        let inverse = 1.0 / distance;
        let normal = branch * inverse;
        // Of the current disc (T 2.16, 3.3a): a frozen one leaves a spurious couple.
        let arm_i = 0.5 * (distance + offset * inverse);
        let arm = [arm_i, distance - arm_i];
        let sweep = wi * arm[0] + wj * arm[1];
        // (3.2): Ω × R with R = -n̂ arm.
        let slid = moved - normal * normal.dot(moved) + normal.cross(&sweep);
        Motion { normal, arm, slid, twist: (wi - wj).dot(&normal) }
    }
}

/// Where a contact is and how it moved since the reference.
pub(super) struct Motion {
    pub(super) normal: Vec3,
    pub(super) arm: [f64; 2],
    /// u_s \[m\] (T 3.2).
    pub(super) slid: Vec3,
    /// Ω_t \[rad\] (T 3.7).
    pub(super) twist: f64,
}

/// Where the grains are.
pub(in crate::relax) struct Pose<'a> {
    pub(in crate::relax) model: &'a Model,
    pub(in crate::relax) position: &'a [Vec3],
    pub(in crate::relax) rotation: &'a [Vec3],
    pub(in crate::relax) bounds: &'a Room,
}

/// Constants of a pair of bodies in shear.
pub(super) struct Pair {
    pub(super) friction: f64,
    pub(super) effective_radius: f64,
    modulus: f64,
    compliance: f64,
    pub(super) shear_compliance: f64,
    pub(super) torsion_compliance: f64,
}

impl Pair {
    pub(super) fn of(model: &Model, friction: &Friction, first: u32, second: Other) -> Self {
        let i = first as usize;
        let (effective_radius, compliance, shear, torsion) = match second {
            Other::Grain(j) => {
                let j = j as usize;
                (
                    hertz::effective_radius(model.radius[i], model.radius[j]),
                    model.compliance[j],
                    friction.shear_compliance[j],
                    friction.torsion_compliance[j],
                )
            }
            Other::Wall(w) => (
                model.wall_radius(i, usize::from(w)),
                model.wall_compliance,
                friction.wall_shear_compliance,
                friction.wall_torsion_compliance,
            ),
        };
        Self {
            friction: friction.between(first, second),
            effective_radius,
            modulus: hertz::modulus(effective_radius, model.compliance[i] + compliance),
            compliance: model.compliance[i] + compliance,
            shear_compliance: friction.shear_compliance[i] + shear,
            torsion_compliance: friction.torsion_compliance[i] + torsion,
        }
    }

    pub(super) fn partial(&self) -> partial_slip::Contact {
        let ratio = partial_slip::stiffness_ratio(self.compliance, self.shear_compliance);
        partial_slip::Contact { modulus: self.modulus, ratio, friction: self.friction }
    }
}

/// Which overlap the stiffness of an increment is that of.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Midway {
    /// That of the limit.
    No,
    /// The mean of the reference and that of the limit: a path there and back then closes.
    Yes,
}

impl Held {
    /// The contact of `carried` with r_ij⁰ `branch`, n̂⁰ `normal` and h⁰ `overlap`, which counts from
    /// the approach `unstressed`.
    pub(super) fn new(
        pair: &Pair,
        carried: Remembered,
        [branch, normal]: [Vec3; 2],
        [overlap, unstressed]: [f64; 2],
        torsion: bool,
    ) -> Self {
        let mut held = Self {
            first: carried.first,
            second: carried.second,
            branch,
            normal,
            overlap,
            reference_overlap: overlap,
            unstressed,
            bond: NO_BOND,
            carried,
            carried_energy: 0.0,
            stiffness: 0.0,
            limit: 0.0,
            torsion_stiffness: 0.0,
            torsion_limit: 0.0,
            partial: pair.partial(),
            before: overlap,
            first_layer: 0,
        };
        held.freeze(pair, overlap, Midway::No, torsion);
        held.carried_energy = held.energy(&carried.shear, carried.torsion);
        held
    }

    /// Whether cement holds the bodies together.
    pub(in crate::relax) fn is_bonded(&self) -> bool {
        self.bond != NO_BOND
    }

    /// Whether the contact was open when its limit was renewed: it has no answer to shear.
    #[inline(always)]
    pub(super) fn is_open(&self) -> bool {
        self.overlap == 0.0 && !self.is_bonded()
    }

    /// Takes up the `layers` that the contact remembers, and puts them behind those in `all`.
    pub(super) fn take_layers(&mut self, layers: &[Layer], all: &mut Vec<Layer>) {
        self.first_layer = all.len() as u32;
        if let Some(last) = layers.last() {
            all.extend_from_slice(layers);
            self.before = last.reach;
        } else {
            // New, or loaded under another law: one ring for all.
            let shear = &self.carried.shear;
            let share = match self.limit.is_finite() && self.limit > 0.0 {
                true => shear / self.limit.max(shear.norm()),
                false => Vec3::zeros(),
            };
            all.push(Layer { reach: self.overlap, ratio: share.into() });
            self.carried.layers = 1;
        }
        self.carried_energy = self.partial.stored(self.layers(all), self.before)
            + self.twist_energy(self.carried.torsion);
    }

    /// Lets the contact carry what it remembers even beyond its limit.
    pub(super) fn be_lenient(&mut self) {
        self.overlap = self.before;
        self.limit = self.limit.max(self.carried.shear.norm());
        self.torsion_limit = self.torsion_limit.max(self.carried.torsion.abs());
    }

    /// Freezes the limit at `overlap`, and the stiffness there or, as `Midway` says, between the
    /// reference and there.
    pub(super) fn freeze(&mut self, pair: &Pair, overlap: f64, midway: Midway, torsion: bool) {
        let overlap = overlap.max(0.0);
        let force = hertz::force(pair.modulus, overlap);
        self.overlap = overlap;
        // An infinite coefficient at an open contact is no limit of zero times infinity.
        self.limit = if force > 0.0 { pair.friction * force } else { 0.0 };
        if torsion {
            let radius = mindlin::contact_radius(pair.effective_radius, overlap);
            self.torsion_limit = mindlin::torsion_limit(radius, self.limit);
        }
        let acting = match midway {
            Midway::No => overlap,
            Midway::Yes => 0.5 * (self.reference_overlap + overlap),
        };
        let radius = mindlin::contact_radius(pair.effective_radius, acting);
        self.stiffness = mindlin::shear_stiffness(radius, pair.shear_compliance);
        if torsion {
            self.torsion_stiffness = mindlin::torsion_stiffness(radius, pair.torsion_compliance);
        }
    }

    /// Whether both bodies take part in the balance, as `carries` says of the grains.
    #[inline(always)]
    pub(super) fn live(&self, carries: &[bool]) -> bool {
        let other = match self.second {
            Other::Grain(j) => carries[j as usize],
            Other::Wall(_) => true,
        };
        other && carries[self.first as usize]
    }

    /// How the contact moved, for the rotations `rotation` at the reference.
    #[inline(always)]
    pub(super) fn motion(&self, at: &Pose<'_>, rotation: &[Vec3]) -> Motion {
        self.ends(at, rotation).motion()
    }

    /// Where its bodies are, for the rotations `rotation` at the reference.
    #[inline(always)]
    pub(super) fn ends(&self, at: &Pose<'_>, rotation: &[Vec3]) -> Ends {
        let i = self.first as usize;
        let turned = |k: usize| at.rotation[k] - rotation[k];
        let xi = at.position[i];
        match self.second {
            Other::Grain(j) => {
                let j = j as usize;
                let branch = xi - at.position[j];
                let (ri, rj) = (at.model.radius[i], at.model.radius[j]);
                Ends {
                    branch,
                    offset: (ri - rj) * (ri + rj),
                    moved: branch - self.branch,
                    turned: [turned(i), turned(j)],
                }
            }
            Other::Wall(w) => {
                // The contact is at the wall, which is as far as the other end (3.3b).
                let Facing { gap, normal, .. } = at.bounds.facing(&xi, usize::from(w));
                let gap = gap.max(f64::MIN_POSITIVE);
                Ends {
                    branch: normal * gap,
                    offset: gap * gap,
                    moved: xi - self.branch,
                    turned: [turned(i), Vec3::zeros()],
                }
            }
        }
    }

    /// Answer to `motion` by `law`.
    #[inline(always)]
    pub(super) fn answer(&self, motion: &Motion, law: Law, layers: &[Layer]) -> Answer {
        let Motion { normal, arm, slid, twist } = *motion;
        let carried = || turned_into_plane(&self.carried.shear, &normal);
        let shear = match law {
            _ if self.is_open() => Shear::default(),
            Law::ReturnMap => coulomb::return_map(&carried(), &slid, self.stiffness, self.limit),
            Law::Secant => coulomb::secant(&carried(), &slid, self.stiffness, self.limit),
            Law::MindlinDeresiewicz => {
                let turn = Turn::between(&self.normal, &normal);
                let answer = self.partial.respond(self.layers(layers), &self.step(&slid, &turn));
                Shear {
                    force: turn.forth(&answer.shear),
                    across: answer.across,
                    along: answer.along,
                    direction: turn.forth(&answer.direction),
                    slides: answer.sliding,
                    ..Shear::default()
                }
            }
        };
        let torsion = coulomb::torsion(
            self.carried.torsion,
            twist,
            self.torsion_stiffness,
            self.torsion_limit,
        );
        Answer { normal, arm, shear, torsion }
    }

    /// Answer to `motion` of a contact without a limit.
    pub(super) fn stick(&self, motion: &Motion) -> Answer {
        let unlimited = Self { limit: f64::INFINITY, torsion_limit: f64::INFINITY, ..*self };
        unlimited.answer(motion, Law::ReturnMap, &[])
    }

    /// The layers of this contact among those of all.
    pub(super) fn layers<'a>(&self, layers: &'a [Layer]) -> &'a [Layer] {
        &layers[self.first_layer as usize..][..self.carried.layers as usize]
    }

    /// The step of partial slip that `slid` in the turned plane amounts to in the reference plane.
    pub(super) fn step(&self, slid: &Vec3, turn: &Turn) -> Step {
        Step { before: self.before, overlap: self.overlap, displacement: turn.back(slid) }
    }

    /// h \[m\] at `pose`, negative when the contact is open.
    pub(super) fn overlap_at(&self, pose: &Pose<'_>) -> f64 {
        let i = self.first as usize;
        let (reach, distance) = match self.second {
            Other::Grain(j) => {
                let j = j as usize;
                let distance = (pose.position[i] - pose.position[j]).norm();
                (pose.model.radius[i] + pose.model.radius[j], distance)
            }
            Other::Wall(w) => {
                let gap = wall_gap(&pose.position[i], usize::from(w), pose.bounds);
                (pose.model.radius[i], gap)
            }
        };
        reach - self.unstressed - distance
    }

    /// h \[m\] in `state`, negative when the contact is open.
    pub(in crate::relax) fn present_overlap(&self, model: &Model, state: &State) -> f64 {
        let State { position, rotation, .. } = state;
        self.overlap_at(&Pose { model, position, rotation, bounds: &state.bounds(model) })
    }
}
