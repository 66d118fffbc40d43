//! The end of an increment: what the contacts remember, and where the energy of shear went.

use super::act::{Act, Scenery};
use super::law;
use super::reference::Joint;
use super::work::Workspace;
use crate::Vec3;
use crate::model::Model;
use crate::relax::tangential::Changes;
use crate::state::{Ledger, Remembered, State};

/// Writes the equilibrium at the pose into `state`.
pub(super) fn commit(model: &Model, state: &mut State, work: &mut Workspace) -> Changes {
    work.put(state);
    let mut changes = Changes::default();
    let Some(setup) = &model.plane else { return changes };
    for (rotation, turn) in state.rotation.iter_mut().zip(&work.pose.turn) {
        rotation.z += turn;
    }
    let Some(friction) = &model.friction else { return changes };
    let Workspace { reference, bodies, membranes, pose, memory, .. } = work;
    memory.clear();
    let mut ledger = Ledger { stored: 0.0, ..state.friction };
    let mut had = 0.0;
    {
        let scenery = Scenery::of(model, setup, state, (reference, bodies, membranes));
        let pairs = reference.pairs.iter().map(|joint| (joint, scenery.pair(joint, pose)));
        let edges = reference.edges.iter().map(|joint| (joint, scenery.edge(joint, pose)));
        for (joint, act) in pairs.chain(edges) {
            let touches = act.as_ref().is_some_and(|act| act.overlap > 0.0 || joint.bonded);
            if !joint.held {
                let rubs = friction.between(joint.first, joint.second) > 0.0;
                changes.formed += u32::from(touches && rubs);
                continue;
            }
            had += joint.stored;
            let Some(act) = act.filter(|_| touches && !joint.opened) else {
                changes.opened += 1;
                ledger.renewal += joint.stored;
                continue;
            };
            let force = act.shear.force;
            let (first, second) = joint.key();
            let stiffness =
                setup.law.shear_stiffness(model, (first, second), joint.radius, act.overlap);
            let now = law::Shear { stiffness, ..joint.shear };
            let stored = now.stored(force);
            ledger.slip += joint.shear.lost(act.slid);
            ledger.stored += stored;
            ledger.renewal += joint.stored - joint.shear.stored(joint.shear.carried)
                + joint.shear.stored(force)
                - stored;
            changes.excess = changes.excess.max(excess(model, joint, &act));
            let shear = act.tangential();
            memory.contacts.push(Remembered {
                first,
                second,
                shear: Vec3::new(shear.x, shear.y, 0.0),
                torsion: 0.0,
                slides: act.slides,
                layers: 0,
            });
        }
    }
    // Of contacts whose grains have left the balance.
    ledger.renewal += state.friction.stored - had;
    // Pairs before edges is not the order of the list.
    memory.contacts.sort_unstable_by_key(Remembered::key);
    state.friction = ledger;
    std::mem::swap(&mut state.memory, memory);
    changes
}

/// Ends a relaxation that did not move anything: `state` remembers what it did before.
pub(super) fn keep(state: &mut State, work: &Workspace) -> Changes {
    let Workspace { reference, .. } = work;
    let joints = reference.pairs.iter().chain(&reference.edges);
    state.friction.stored = joints.map(|joint| joint.stored).sum();
    Changes::default()
}

/// How far the shear is from what the present normal force allows \[N\].
fn excess(model: &Model, joint: &Joint, act: &Act) -> f64 {
    let Some(friction) = &model.friction else { return 0.0 };
    if joint.bonded {
        return 0.0;
    }
    let limit = friction.between(joint.first, joint.second) * act.normal.force;
    let beyond = act.shear.force.abs() - limit;
    if act.slides { beyond.abs() } else { beyond.max(0.0) }
}
