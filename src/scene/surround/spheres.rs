//! What a scene of spheres cannot have of it, and what a cylinder cannot have of a scene.

use super::{Cell, check_pressed, check_steps};
use crate::plane::cell::SQUARE;
use crate::scene::check::{Field, Problems};
use crate::scene::{Axis, Method, Normal, Scene, Solution, Step, Targets, WallName, prepare};
use crate::wall::{self, WallTarget};

pub(super) fn check(scene: &Scene, at: &Field, problems: &mut Problems) {
    let walls = &scene.walls;
    if let Cell::Annulus(_) = walls.cell {
        problems.add(at.key("cell"), "an annulus is for discs; allowed: box, cylinder");
    }
    if !walls.points.is_empty() {
        problems.add(at.key("points"), "is for discs; allowed: no such key, or `dimension: 2`");
    }
    check_membranes(scene, at, problems);
    check_rest(scene, problems);
    let Cell::Cylinder(cylinder) = walls.cell else {
        if !walls.open.is_empty() {
            problems.add(at.key("open"), "is for discs and cylinders; allowed: no such key");
        }
        return;
    };
    if let Some(inner) = cylinder.inner {
        problems.positive(at.key("cell").key("cylinder").key("inner"), inner, "inner > 0 m");
    }
    for (index, side) in walls.open.iter().enumerate() {
        if *side != WallName::XMin || cylinder.inner.is_none() {
            let text = "a cylinder needs it; allowed: x_min where there is an inner wall";
            problems.add(at.key("open").index(index), text);
        }
    }
    let has_inner = cylinder.inner.is_some() && walls.open.is_empty();
    targets(&walls.targets, has_inner, &at.key("targets"), problems);
    let root = Field::root();
    check_steps(&scene.load_path.0, &root.key("load_path"), problems);
    step_targets(&scene.load_path.0, has_inner, &root.key("load_path"), problems);
    let pack = root.key("pack");
    if let Some(cut) = &scene.pack.cut {
        let [x, y, _] = cut.sides();
        if (x - y).abs() > SQUARE * x {
            let text = "the square around a cylinder; allowed: as wide along y as along x";
            problems.add(pack.key("cut"), text);
        }
    }
    if let Some(spec) = &scene.pack.generate
        && spec.aspect[0] != spec.aspect[1]
    {
        let aspect = pack.key("generate").key("aspect").index(1);
        problems
            .add(aspect, "a cylinder is as wide along y as along x; allowed: the same as for x");
    }
    for (index, step) in scene.pack.prepare.iter().enumerate() {
        if matches!(step, prepare::Step::Uniaxial(step) if step.axis != Axis::Z) {
            let step = pack.key("prepare").index(index);
            let axis = step.key("uniaxial").key("axis");
            problems.add(axis, "across the axis of the cylinder; allowed: z");
        }
    }
}

/// Membranes press from the start on, with a stress, and end at walls.
fn check_membranes(scene: &Scene, at: &Field, problems: &mut Problems) {
    let walls = &scene.walls;
    let round = !walls.cell.is_box();
    check_pressed(walls, at, problems);
    let mut axes = Vec::new();
    for (index, side) in walls.membranes.iter().enumerate() {
        let (at, w) = (at.key("membranes").index(index), side.index());
        let allowed = match round {
            true => [WallName::XMax].as_slice(),
            false => [WallName::XMin, WallName::XMax, WallName::YMin, WallName::YMax].as_slice(),
        };
        let names: Vec<_> = allowed.iter().map(|name| wall::NAMES[name.index()]).collect();
        if !allowed.contains(side) {
            let text = format!("no membrane can be there; allowed: {}", names.join(", "));
            problems.add(at.clone(), text);
        }
        if walls.membranes[..index].contains(side) {
            problems.add(at.clone(), "is named twice; allowed: once");
        }
        axes.push(wall::axis(w));
        if axes.iter().any(|axis| *axis != axes[0]) {
            problems.add(at, "a membrane ends at walls; allowed: no membranes beside it");
        }
    }
    if !walls.membranes.is_empty() && scene.solver.method != Method::Newton {
        let at = Field::root().key("solver").key("method");
        problems
            .add(at, "moves grains without their membrane; allowed with walls.membranes: newton");
    }
}

/// What neither cylinders nor membranes go with.
///
/// Tangent moduli are answers to the strains of a box along its axes, which a round wall cannot follow and a
/// membrane does not prescribe. Hydrate that dissociates lets the walls of a box give way by a pore pressure.
fn check_rest(scene: &Scene, problems: &mut Problems) {
    let root = Field::root();
    let mut not = |field: Field, text: &str| problems.add(field, text);
    if let Normal::Cement(cement) = &scene.contact.normal {
        let at = root.key("contact").key("normal").key("cement");
        if cement.solution == Solution::TwoStep {
            not(at.key("solution"), "is for plane walls; allowed: nonlinear");
        }
        if cement.saturation > 0.0 {
            not(at.key("saturation"), "dissociates between plane walls only; allowed: 0");
        }
    }
    if scene.outputs.moduli.takes_tangent() {
        let text = "tangent moduli are those of a box of plane walls; allowed: secant, none";
        not(root.key("outputs").key("moduli"), text);
    }
    let pack = root.key("pack");
    if scene.pack.hydrate.is_some() {
        not(pack.key("hydrate"), "hydrate is between plane walls only; allowed: no such key");
    }
}

/// Targets of walls that a cylinder does not have.
fn targets(targets: &Targets, has_inner: bool, at: &Field, problems: &mut Problems) {
    for (w, target) in targets.in_order().into_iter().enumerate() {
        let there = w != 2 && w != 3 && (w > 0 || has_inner);
        if !there && target != WallTarget::Keep {
            let text = "the cylinder has no such wall; allowed: no such key";
            problems.add(at.key(wall::NAMES[w]), text);
        }
    }
}

fn step_targets(steps: &[Step], has_inner: bool, at: &Field, problems: &mut Problems) {
    for (index, step) in steps.iter().enumerate() {
        let at = at.index(index);
        match step {
            Step::Walls(step) => {
                targets(&step.targets, has_inner, &at.key("walls").key("targets"), problems);
            }
            Step::Repeat(step) => {
                let at = at.key("repeat").key("steps");
                step_targets(&step.steps, has_inner, &at, problems);
            }
            _ => {}
        }
    }
}
