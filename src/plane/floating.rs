//! Grains that cannot carry load: they are kept where they are and left out of the balance, until what
//! moves around them leaves them no room.

use super::pose::Pose;
use super::reference::Joint;
use super::work::Workspace;
use super::{Vec2, glue};
use crate::contact::Other;
use crate::model::Model;
use crate::state::State;

/// Contacts below this share of the mean force hold nobody.
const FAINT: f64 = 1e-9;
/// Contacts that a grain needs: without friction two forces balance only face to face.
const SUPPORTS: u32 = 2;
/// Sweeps in which floating grains are moved out of others, and the overlap that may be left over the
/// mean radius.
const SWEEPS: u32 = 60;
const TOUCHING: f64 = 1e-10;
/// How much further than needed a grain is moved out.
const CLEAR: f64 = 1e-9;

/// Scratch: who holds whom.
#[derive(Clone, Debug, Default)]
pub(super) struct Floating {
    /// Grains that came back during this search and are not dropped again, shape (n).
    back: Vec<bool>,
    /// Joints of floating grains: number among the pairs, or beyond them among the edges.
    joints: Vec<u32>,
    /// Whether these are those of the grains that float now.
    listed: bool,
}

impl Floating {
    /// A search begins.
    pub(super) fn begin(&mut self, grains: usize) {
        self.back.clear();
        self.back.resize(grains, false);
        self.listed = false;
    }

    /// The joints are others.
    pub(super) fn relist(&mut self) {
        self.listed = false;
    }

    pub(super) fn heap_bytes(&self) -> usize {
        crate::heap::bytes(&self.back) + crate::heap::bytes(&self.joints)
    }
}

/// Takes the grains out of the balance that fewer than two contacts touch, and those that come to lack
/// them then. Says whether there were any.
pub(super) fn drop_loose(model: &Model, state: &mut State, work: &mut Workspace) -> bool {
    if model.has_gravity() {
        return false;
    }
    work.balance.faint = (FAINT * work.balance.sums.mean_force()).max(work.negligible);
    let mut dropped = false;
    loop {
        let Workspace { balance, floating, .. } = work;
        let mut more = false;
        for (i, carries) in state.carries.iter_mut().enumerate() {
            let free = !floating.back[i] && glue::side(&state.glued, i).is_none();
            if *carries && free && balance.support[i] < SUPPORTS {
                *carries = false;
                more = true;
            }
        }
        if !more {
            return dropped;
        }
        dropped = true;
        work.floating.listed = false;
        // Without them others may lack support.
        work.evaluate(model, state);
    }
}

/// Lets all grains take part again. Says whether any did not.
pub(super) fn take_back(state: &mut State) -> bool {
    let floats = state.carries.iter().any(|carries| !carries);
    state.carries.fill(true);
    floats
}

/// Moves floating grains out of those that they overlap. Those that find no room join the balance
/// again: says whether any does.
pub(super) fn rejoin(model: &Model, state: &mut State, work: &mut Workspace) -> bool {
    if state.carries.iter().all(|carries| *carries) {
        return false;
    }
    let Workspace { reference, bodies, pose, floating, .. } = work;
    let floats = |grain: u32| !state.carries[grain as usize];
    let pairs = reference.pairs.len() as u32;
    if !floating.listed {
        let pairs_float = reference.near.iter().map(|near| near.grains.iter().any(|g| floats(*g)));
        let edges_float = reference.edges.iter().map(|joint| floats(joint.first));
        let joints = (0..).zip(pairs_float.chain(edges_float));
        floating.joints.clear();
        floating.joints.extend(joints.filter(|(_, floats)| *floats).map(|(k, _)| k));
        floating.listed = true;
    }
    let joint = |k: u32| match k.checked_sub(pairs) {
        None => &reference.pairs[k as usize],
        Some(k) => &reference.edges[k as usize],
    };
    let overlap = |joint: &Joint, pose: &Pose| -> (f64, Vec2) {
        let at = pose.at[joint.first as usize];
        match joint.second {
            Other::Grain(j) => {
                let branch = at - pose.at[j as usize];
                let distance = branch.norm();
                (joint.reach - distance, branch / distance)
            }
            Other::Wall(b) => {
                let near = bodies[b as usize].near(at, model.radius[joint.first as usize]);
                (near.overlap, near.along * near.sign)
            }
        }
    };
    let most = TOUCHING * model.mean_radius;
    for _ in 0..SWEEPS {
        let mut free = true;
        for &k in &floating.joints {
            let joint = joint(k);
            if k < pairs && is_apart(joint, pose) {
                continue;
            }
            let (deep, out) = overlap(joint, pose);
            if deep <= 0.0 {
                continue;
            }
            free &= deep <= most;
            let way = out * (deep + CLEAR * model.mean_radius);
            let (i, other) = (joint.first as usize, joint.second);
            match other {
                Other::Grain(j) if floats(joint.first) && floats(j) => {
                    pose.at[i] += way * 0.5;
                    pose.at[j as usize] -= way * 0.5;
                }
                Other::Grain(j) if floats(j) => pose.at[j as usize] -= way,
                _ => pose.at[i] += way,
            }
        }
        if free {
            return false;
        }
    }
    let mut joined = false;
    for &k in &floating.joints {
        let joint = joint(k);
        if overlap(joint, pose).0 > most {
            let other = match joint.second {
                Other::Grain(j) => Some(j),
                Other::Wall(_) => None,
            };
            for grain in [Some(joint.first), other].into_iter().flatten() {
                let grain = grain as usize;
                if !state.carries[grain] {
                    state.carries[grain] = true;
                    floating.back[grain] = true;
                    joined = true;
                    floating.listed = false;
                }
            }
        }
    }
    joined
}

/// Whether two grains are so far apart that they do not touch.
#[inline]
fn is_apart(joint: &Joint, pose: &Pose) -> bool {
    let Other::Grain(j) = joint.second else { return false };
    (pose.at[joint.first as usize] - pose.at[j as usize]).norm_squared() > joint.reach * joint.reach
}
