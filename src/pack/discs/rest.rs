//! The equilibrium of discs that have come nearly to rest.

use super::motion::{Discs, Goal};
use crate::command::Disposition;
use crate::pack::Pack;
use crate::pack::generate::CompactError;
use crate::report::Demand;
use crate::scene::{
    Cell, Coulomb, Friction, Method, Node, Normal, PointSides, Rotation, Scene, Targets,
};
use crate::twin::Twin;
use crate::wall::WallTarget;

/// Residuals at which the core takes over, one after the other until it finds an equilibrium.
const RESIDUALS: [f64; 3] = [1e-3, 1e-4, 1e-5];

/// Most relaxations until nothing moves any more, and residual over that asked for.
const MOST_ROUNDS: u32 = 6;
const TIGHTER: f64 = 0.1;

/// Compacts `discs`, the grains of `pack`, to `goal` and then to the equilibrium of the core; their own
/// friction is that of `pack`.
pub(super) fn compact(
    scene: &Scene,
    pack: &Pack,
    mut discs: Discs,
    goal: Goal,
) -> Result<Pack, CompactError> {
    let making = making(scene, &goal);
    let mut text = String::from("the discs do not come to rest");
    for stress in discs.relief(&goal) {
        if !discs.compact(&Goal { stress, ..goal }, RESIDUALS[0]) {
            return Err(CompactError::Discs { wanted: goal.stress, text });
        }
    }
    for residual in RESIDUALS {
        if !discs.compact(&goal, residual) {
            break;
        }
        let mut now = discs.pack(pack, goal.friction);
        now.grains.iter_mut().for_each(|grain| grain.friction = goal.friction);
        match settled(&making, &now) {
            Ok(mut found) => {
                for (grain, own) in found.grains.iter_mut().zip(&pack.grains) {
                    grain.friction = own.friction;
                }
                return Ok(found);
            }
            Err(said) => text = said,
        }
    }
    Err(CompactError::Discs { wanted: goal.stress, text })
}

/// `pack` in an equilibrium that a run finds as it is, or what was found instead.
///
/// Shear counts from where the contacts were when a relaxation began: when they have moved on it has
/// other levers, and so the relaxation begins anew, with walls that stand, until nothing moves.
fn settled(making: &Scene, pack: &Pack) -> Result<Pack, String> {
    let (mut pack, _) = started(making, pack)?;
    let mut standing = making.clone();
    standing.walls.targets = Targets::default();
    for _ in 0..MOST_ROUNDS {
        let (again, rested) = started(&standing, &pack)?;
        if rested {
            return Ok(again);
        }
        // What moved under standing walls has changed their loads a little.
        (pack, _) = started(making, &again)?;
    }
    Ok(started(&standing, &pack)?.0)
}

/// `pack` where a twin starts from it, and whether it was that already.
fn started(scene: &Scene, pack: &Pack) -> Result<(Pack, bool), String> {
    let twin = Twin::new(scene, pack, rayon::current_num_threads());
    let mut twin = twin.map_err(|error| error.to_string())?;
    let report = twin.start(Demand::NONE);
    match report.disposition {
        Disposition::Applied => Ok((twin.pack(), report.text.is_empty())),
        _ => Err(report.text),
    }
}

/// `scene` while a pack is made: smooth walls without gaps that carry the stress, and grains with the friction of the
/// compaction.
fn making(scene: &Scene, goal: &Goal) -> Scene {
    let mut making = scene.clone();
    making.walls.friction = Some(0.0);
    let side = WallTarget::Stress(goal.stress);
    let keep = WallTarget::Keep;
    making.walls.targets = Targets::from(match making.walls.cell {
        Cell::Box => [side, side, side, side, keep, keep],
        // The inner wall stands.
        Cell::Annulus(_) | Cell::Cylinder(_) => [keep, side, keep, keep, keep, keep],
    });
    making.walls.points = PointSides::default();
    making.walls.open.clear();
    making.walls.membranes.clear();
    let coefficient = goal.friction;
    making.contact.friction = match coefficient > 0.0 {
        true => Friction::Coulomb(Coulomb { coefficient, ..Coulomb::default() }),
        false => Friction::None,
    };
    making.contact.rotation = Rotation::Free;
    if let Normal::Linear(linear) = &mut making.contact.normal {
        linear.bond = None;
    }
    making.gravity = [0.0; 3];
    making.reference = None;
    making.solver.method = Method::Newton;
    making.solver.max_iterations = None;
    making.solver.sweeps = None;
    making.solver.tolerance *= TIGHTER;
    making.node = Node::default();
    making
}
