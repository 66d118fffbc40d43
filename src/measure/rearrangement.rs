//! What a jump did to grains and contacts, in the order of the pack file.

use std::borrow::Cow;

use crate::Vec3;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::model::Model;
use crate::pack::wall_index;
use crate::plane::boundary;
use crate::relax::jump::{Jump, Pose};
use crate::report::{Event, EventEnd, EventKind, Rearrangement, Snapshot};

/// A pair counts as a contact from this share of the mean overlap on: grains that float hover
/// around none. It is [`FAINT`](super::contacts::FAINT) as an overlap, h ~ P^(2/3).
pub const FAINT_OVERLAP: f64 = 1e-4;

/// The jump in short.
#[must_use]
pub fn event(model: &Model, jump: &Jump) -> Event {
    let named = |&(grain, moved): &(u32, f64)| (model.order[grain as usize], moved);
    let mut grains: Vec<(u32, f64)> = jump.grains.iter().map(named).collect();
    grains.sort_unstable_by_key(|&(grain, _)| grain);
    let (grains, displacement) = grains.into_iter().unzip();
    Event {
        kind: EventKind::StressDrop,
        stress_before: jump.stress_before,
        stress_after: jump.stress_after,
        energy_released: jump.released(),
        grains,
        displacement,
    }
}

/// The jump in full.
#[must_use]
pub fn rearrangement(model: &Model, jump: &Jump) -> Rearrangement {
    let mut grains: Vec<(u32, usize)> =
        jump.grains.iter().map(|&(k, _)| (model.order[k as usize], k as usize)).collect();
    grains.sort_unstable();
    let way = |from: &[Vec3], to: &[Vec3]| {
        let ways = grains.iter().filter_map(|&(_, k)| Some((to.get(k)? - from.get(k)?).into()));
        ways.collect()
    };
    let [before, after] = [&jump.before, &jump.after].map(|pose| contacts(model, pose));
    Rearrangement {
        kind: EventKind::StressDrop,
        stress_before: jump.stress_before,
        stress_after: jump.stress_after,
        energy_before: jump.energy_before,
        energy_after: jump.energy_after,
        displacement: way(&jump.before.position, &jump.after.position),
        rotation: way(&jump.before.rotation, &jump.after.rotation),
        grains: grains.into_iter().map(|(grain, _)| grain).collect(),
        lost: without(&before, &after),
        made: without(&after, &before),
    }
}

/// Where all grains were before and after the jump that is number `event` of its increment.
#[must_use]
pub fn snapshots(model: &Model, jump: &Jump, event: u32) -> [Snapshot; 2] {
    let ends = [(EventEnd::Before, &jump.before), (EventEnd::After, &jump.after)];
    ends.map(|(end, pose)| {
        let bounds = pose.bounds(model);
        Snapshot {
            event,
            end,
            wall_position: std::array::from_fn(|w| bounds.position(w)),
            position: in_file_order(model, &pose.position),
            rotation: in_file_order(model, &pose.rotation),
        }
    })
}

fn in_file_order(model: &Model, list: &[Vec3]) -> Vec<[f64; 3]> {
    let mut ordered = vec![[0.0; 3]; list.len()];
    for (vector, &grain) in list.iter().zip(&model.order) {
        ordered[grain as usize] = (*vector).into();
    }
    ordered
}

/// The contacts of `pose` as the pack file counts their bodies, sorted: every pair, floating grains
/// too, whose overlap is at least [`FAINT_OVERLAP`] of the mean of all overlaps.
fn contacts(model: &Model, pose: &Pose) -> Vec<[u32; 2]> {
    // The radii may have been others on the way to the state of the model.
    let mut model = Cow::Borrowed(model);
    if !model.stands_for(&pose.dissociated) {
        model.to_mut().dissociate(&pose.dissociated);
    }
    let model = &*model;
    let bounds = pose.bounds(model);
    let mut near = Neighbours::default();
    near.refresh(model, &pose.position, &bounds);
    let mut bodies = Vec::new();
    boundary::bodies(model, &pose.displacement, 0.0, &mut bodies);
    let mut pairs: Vec<([u32; 2], f64)> = Vec::new();
    for (i, at) in pose.position.iter().enumerate() {
        let first = model.order[i];
        for k in near.row(i) {
            let j = near.second[k] as usize;
            let second = model.order[j];
            let overlap = near.reach(model, i, k) - (at - pose.position[j]).norm();
            pairs.push(([first.min(second), first.max(second)], overlap));
        }
        if model.plane.is_some() {
            let touches =
                bodies.iter().map(|body| (body.side, body.near(at.xy(), model.radius[i])));
            pairs.extend(touches.map(|(side, near)| ([first, wall_index(side)], near.overlap)));
            continue;
        }
        for (wall, reach) in near.walls_near(model, i) {
            let overlap = reach - wall_gap(at, usize::from(wall), &bounds);
            pairs.push(([first, wall_index(wall)], overlap));
        }
    }
    pairs.retain(|&(_, overlap)| overlap > 0.0);
    let mean = pairs.iter().map(|(_, overlap)| overlap).sum::<f64>() / pairs.len().max(1) as f64;
    pairs.retain(|&(_, overlap)| overlap >= FAINT_OVERLAP * mean);
    let mut contacts: Vec<[u32; 2]> = pairs.into_iter().map(|(pair, _)| pair).collect();
    contacts.sort_unstable();
    contacts
}

/// What of `these` is not among `those`; both are sorted.
fn without(these: &[[u32; 2]], those: &[[u32; 2]]) -> Vec<[u32; 2]> {
    these.iter().filter(|pair| those.binary_search(pair).is_err()).copied().collect()
}
