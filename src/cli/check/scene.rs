//! What is in a scene.

use graintwin::scene::Loaded;
use graintwin::scene::prepare::{End, Rescale, Step};
use graintwin::wall::Bounds;
use graintwin::{pack, path};

use crate::cli::output::significant;
use crate::cli::{Failure, specimen};

/// Reads the files of the scene as well.
pub(super) fn describe(loaded: &Loaded) -> Result<String, Failure> {
    let scene = &loaded.scene;
    // What a path file holds is checked in any box; the pack to be made has none yet.
    let unit = Bounds { min: [0.0; 3], max: [1.0; 3] };
    let (contents, bounds) = match &scene.pack.generate {
        Some(spec) => {
            let stress = significant(spec.confining_stress * 1e-6, 4);
            let (grains, material) = (spec.grains, &spec.material);
            let hydrate = scene.pack.hydrate.as_ref().map_or_else(String::new, |hydrate| {
                let saturation = significant(hydrate.saturation, 4);
                format!(
                    "hydrate         the smallest of them, up to a saturation of {saturation}\n"
                )
            });
            (
                format!(
                    "pack            {grains} grains of {material} to be made at {stress} MPa\n\
                     {hydrate}"
                ),
                unit,
            )
        }
        None => {
            let pack = pack::unprepared(loaded)?;
            (specimen::describe(&pack, scene.dimension), pack.bounds)
        }
    };
    let commands = path::commands_of(scene, loaded.folder(), &bounds)?;
    let duration = commands.last().map_or(0.0, |command| command.stamp.seconds());
    Ok(format!(
        "scene           {}, {}: right\n{contents}{}load path       {} commands, {} s\n",
        scene.name,
        loaded.file.display(),
        preparation(&scene.pack.prepare),
        commands.len(),
        significant(duration, 6),
    ))
}

/// What is to be done with the pack, a line a step.
fn preparation(steps: &[Step]) -> String {
    let step = |(index, step): (usize, &Step)| {
        let what = match step {
            Step::Isotropic(step) => {
                format!("to {} MPa without friction", significant(step.confining_stress * 1e-6, 4))
            }
            Step::Uniaxial(step) => match step.end {
                End::Strain(strain) => format!("uniaxial, a strain of {strain:?}"),
                End::Steady(_) => "uniaxial until the sliding ratio is steady".into(),
            },
            Step::Rescale(Rescale::Lengths(factor)) => format!("all lengths times {factor:?}"),
            Step::Rescale(Rescale::Forces(factor)) => format!("all forces times {factor:?}"),
        };
        format!("step {}          {what}\n", index + 1)
    };
    steps.iter().enumerate().map(step).collect()
}
