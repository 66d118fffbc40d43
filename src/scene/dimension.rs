//! What a scene of spheres or of discs cannot have.

mod path;

use super::check::{Field, Problems};
use super::{Axis, Friction, Law, Method, Normal, Rotation, Scene, Step, prepare};

pub(super) fn check(scene: &Scene, problems: &mut Problems) {
    let at = Field::root();
    let mut not = |field: Field, text: &str| problems.add(field, text);
    if scene.dimension != 2 {
        if matches!(scene.contact.normal, Normal::Linear(_)) {
            let text =
                "linear contacts are those of discs; allowed: hertz, cement, or `dimension: 2`";
            not(at.key("contact").key("normal"), text);
        }
        if scene.contact.rotation == Rotation::Locked {
            let text = "only discs can be locked; allowed: free, or `dimension: 2`";
            not(at.key("contact").key("rotation"), text);
        }
        if tilts(&scene.load_path.0) {
            let text = "only a box of discs leans; allowed: steps without shear, or `dimension: 2`";
            not(at.key("load_path"), text);
        }
        if scene.walls.glue {
            not(
                at.key("walls").key("glue"),
                "only discs are glued; allowed: false, or `dimension: 2`",
            );
        }
        if scene.solver.sweeps.is_some() {
            let text =
                "spheres are brought to equilibrium; allowed: no such key, or `dimension: 2`";
            not(at.key("solver").key("sweeps"), text);
        }
        if scene.pack.generate.as_ref().is_some_and(|spec| spec.compaction_friction != 0.0) {
            let text = "spheres are compacted without friction; allowed: 0, or `dimension: 2`";
            not(at.key("pack").key("generate").key("compaction_friction"), text);
        }
        return;
    }
    if scene.walls.glue && scene.solver.method == Method::GaussSeidel {
        let text = "gauss_seidel moves grains one by one; allowed with walls.glue: newton, dynamic";
        not(at.key("solver").key("method"), text);
    }
    if scene.solver.sweeps.is_some() && scene.solver.method != Method::GaussSeidel {
        let text = "counts the sweeps of another method; allowed with it: gauss_seidel";
        not(at.key("solver").key("method"), text);
    }
    if matches!(scene.contact.normal, Normal::Cement(_)) {
        not(at.key("contact").key("normal"), "cement is for spheres; allowed: hertz, linear");
    }
    if let Friction::Coulomb(coulomb) = &scene.contact.friction
        && coulomb.law != Law::ReturnMap
    {
        let text = "discs slide by radial return; allowed: return_map";
        not(at.key("contact").key("friction").key("law"), text);
    }
    if !scene.solver.method.relaxes(2) {
        let text = format!(
            "{} is for spheres; allowed in the plane: newton, gauss_seidel, dynamic",
            scene.solver.method.name()
        );
        not(at.key("solver").key("method"), &text);
    }
    if scene.outputs.moduli.takes_tangent() && !scene.walls.is_plain() {
        let text = "tangent moduli are those of a box of straight walls; allowed: secant, none";
        not(at.key("outputs").key("moduli"), text);
    }
    if scene.outputs.moduli.takes_tangent() && scene.solver.sweeps.is_some() {
        let text = "tangent moduli are those of an equilibrium; allowed with sweeps: secant, none";
        not(at.key("outputs").key("moduli"), text);
    }
    if scene.pack.hydrate.is_some() {
        not(at.key("pack").key("hydrate"), "hydrate is for spheres; allowed: no such key");
    }
    if scene.pack.generate.as_ref().is_some_and(|spec| spec.expand_floaters != 0) {
        let text = "only spheres are expanded; allowed: 0";
        not(at.key("pack").key("generate").key("expand_floaters"), text);
    }
    for (index, step) in scene.pack.prepare.iter().enumerate() {
        if matches!(step, prepare::Step::Uniaxial(step) if step.axis == Axis::Z) {
            let step = at.key("pack").key("prepare").index(index);
            not(step.key("uniaxial").key("axis"), "there is no z in the plane; allowed: x, y");
        }
    }
    if scene.gravity[2] != 0.0 {
        let text = "there is no z in the plane; allowed: 0";
        not(at.key("gravity").index(2), text);
    }
    path::check(&scene.load_path.0, &at.key("load_path"), problems);
    path::targets(&scene.walls.targets, &at.key("walls").key("targets"), problems);
}

fn tilts(steps: &[Step]) -> bool {
    steps.iter().any(|step| match step {
        Step::Shear(_) => true,
        Step::Repeat(repeat) => tilts(&repeat.steps),
        _ => false,
    })
}
