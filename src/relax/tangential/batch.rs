//! The radial return for many contacts at a time, so that the compiler can put several in a register.

use crate::Vec3;
use crate::contact::coulomb;
use crate::relax::lanes::{Kernel, Lanes, dispatch};
use crate::relax::tangential::held::{Ends, Held, Motion, Pose};
use crate::relax::tangential::turn::turned_into_plane;
use crate::relax::tangential::{Pull, Reference, Traction};

/// Contacts of a batch, and how many of them a register may hold at most.
const SIZE: usize = 64;
const LANES: usize = 8;

type Numbers = [f64; SIZE];
type Vectors = [Numbers; 3];

/// Where contacts are, what they carried, and their answers.
struct Batch {
    branch: Vectors,
    offset: Numbers,
    moved: Vectors,
    turned: [Vectors; 2],
    carried: Vectors,
    stiffness: Numbers,
    limit: Numbers,
    carried_torsion: Numbers,
    torsion_stiffness: Numbers,
    torsion_limit: Numbers,
    normal: Vectors,
    arm: [Numbers; 2],
    force: Vectors,
    direction: Vectors,
    across: Numbers,
    along: Numbers,
    potential: Numbers,
    couple: Numbers,
    torsion: Numbers,
    /// One where the contact slides, else zero.
    slides: Numbers,
}

#[inline(always)]
fn put(to: &mut Vectors, k: usize, v: &Vec3) {
    for axis in 0..3 {
        to[axis][k] = v[axis];
    }
}

#[inline(always)]
fn get(from: &Vectors, k: usize) -> Vec3 {
    Vec3::new(from[0][k], from[1][k], from[2][k])
}

impl Batch {
    #[inline(always)]
    fn new() -> Self {
        let zeros = [0.0; SIZE];
        let (nothing, ones) = ([zeros; 3], [1.0; SIZE]);
        Self {
            branch: [ones; 3],
            offset: zeros,
            moved: nothing,
            turned: [nothing; 2],
            carried: nothing,
            stiffness: ones,
            limit: zeros,
            carried_torsion: zeros,
            torsion_stiffness: zeros,
            torsion_limit: zeros,
            normal: nothing,
            arm: [zeros; 2],
            force: nothing,
            direction: nothing,
            across: zeros,
            along: zeros,
            potential: zeros,
            couple: zeros,
            torsion: zeros,
            slides: zeros,
        }
    }

    /// Takes `held` at `ends`; what `sticks` has no limit.
    #[inline(always)]
    fn take(&mut self, k: usize, held: &Held, ends: &Ends, sticks: bool) {
        let limit = |limit: f64| if sticks { f64::INFINITY } else { limit };
        put(&mut self.branch, k, &ends.branch);
        self.offset[k] = ends.offset;
        put(&mut self.moved, k, &ends.moved);
        put(&mut self.turned[0], k, &ends.turned[0]);
        put(&mut self.turned[1], k, &ends.turned[1]);
        put(&mut self.carried, k, &held.carried.shear);
        self.stiffness[k] = held.stiffness;
        self.limit[k] = limit(held.limit);
        self.carried_torsion[k] = held.carried.torsion;
        self.torsion_stiffness[k] = held.torsion_stiffness;
        self.torsion_limit[k] = limit(held.torsion_limit);
        if held.is_open() {
            put(&mut self.carried, k, &Vec3::zeros());
            (self.stiffness[k], self.limit[k]) = (1.0, 0.0);
        }
    }

    /// Answers for the first `count`; entries beyond are those of an earlier batch.
    #[inline(always)]
    fn answer(&mut self, count: usize) {
        for k in 0..count.next_multiple_of(LANES).min(SIZE) {
            let ends = Ends {
                branch: get(&self.branch, k),
                offset: self.offset[k],
                moved: get(&self.moved, k),
                turned: [get(&self.turned[0], k), get(&self.turned[1], k)],
            };
            let Motion { normal, arm, slid, twist } = ends.motion();
            let carried = turned_into_plane(&get(&self.carried, k), &normal);
            let shear = coulomb::return_map(&carried, &slid, self.stiffness[k], self.limit[k]);
            let torsion = coulomb::torsion(
                self.carried_torsion[k],
                twist,
                self.torsion_stiffness[k],
                self.torsion_limit[k],
            );
            put(&mut self.normal, k, &normal);
            self.arm[0][k] = arm[0];
            self.arm[1][k] = arm[1];
            put(&mut self.force, k, &shear.force);
            put(&mut self.direction, k, &shear.direction);
            self.across[k] = shear.across;
            self.along[k] = shear.along;
            self.potential[k] = shear.potential + torsion.potential;
            self.couple[k] = torsion.couple;
            self.torsion[k] = torsion.stiffness;
            self.slides[k] = if shear.slides { 1.0 } else { 0.0 };
        }
    }

    /// The answer of entry `k`.
    #[inline(always)]
    fn parts(&self, k: usize) -> (Traction, Pull) {
        let (normal, force) = (get(&self.normal, k), get(&self.force, k));
        let single = |v: &Vectors| [0, 1, 2].map(|axis| v[axis][k] as f32);
        let arm = [self.arm[0][k], self.arm[1][k]];
        let traction = Traction {
            live: true,
            slides: self.slides[k] != 0.0,
            normal: single(&self.normal),
            direction: single(&self.direction),
            across: self.across[k] as f32,
            sliding: (self.along[k] - self.across[k]) as f32,
            arm: arm.map(|arm| arm as f32),
            torsion: self.torsion[k] as f32,
            ..Traction::default()
        };
        (traction, Pull::of(&normal, &arm, &force, self.couple[k], self.potential[k]))
    }
}

/// What contacts are answered for.
pub(super) struct Answer<'a, 'b> {
    pub(super) reference: &'a Reference,
    pub(super) pose: &'a Pose<'b>,
    pub(super) carries: &'a [bool],
    pub(super) contacts: &'a [Held],
    pub(super) tractions: &'a mut [Traction],
    pub(super) pulls: &'a mut [Pull],
}

impl Answer<'_, '_> {
    /// Answers by the radial return.
    pub(super) fn all(self) {
        dispatch(self);
    }
}

impl Kernel for Answer<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Self { reference, pose, carries, contacts, tractions, pulls } = self;
        let mut batch = Batch::new();
        let chunks = contacts.chunks(SIZE).zip(tractions.chunks_mut(SIZE));
        for ((contacts, tractions), pulls) in chunks.zip(pulls.chunks_mut(SIZE)) {
            for (k, held) in contacts.iter().enumerate() {
                let ends = held.ends(pose, &reference.rotation);
                batch.take(k, held, &ends, reference.sticks && !held.carried.slides);
            }
            batch.answer(contacts.len());
            for (k, held) in contacts.iter().enumerate() {
                (tractions[k], pulls[k]) = match held.live(carries) {
                    true => reference.with_cement(held, batch.parts(k), pose),
                    false => Default::default(),
                };
            }
        }
    }
}
