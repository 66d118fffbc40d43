//! Sample Q2699 of the thesis (T 2.7, 4.8.1).

use std::path::Path;

use graintwin::pack::{Pack, generate};
use graintwin::scene::{self, Scene};

use crate::specimen::LOOSE;

/// Its grains.
pub(crate) const GRAINS: usize = 2699;

/// Stress of the frictionless compaction before the cement \[Pa\].
pub(crate) const COMPACTED: f64 = 10e6;

/// Quartz and walls of T table 2.1.
pub(crate) fn scene(seed: u64) -> Scene {
    let text = format!(
        "pack: {{generate: {{grains: {GRAINS}, radius: {{uniform: [0.07e-3, 0.13e-3]}}, \
         material: quartz, seed: {seed}, confining_stress: {LOOSE:e}}}}}\n\
         walls: {{young: 1.0e13, poisson: 0.495}}"
    );
    scene::parse(&text, Path::new("validation.yaml")).expect("the scene is right")
}

/// The pack of a seed at [`COMPACTED`], without friction and without cement.
pub(crate) fn compacted(seed: u64) -> Pack {
    let scene = scene(seed);
    let spec = scene.pack.generate.as_ref().expect("the scene asks for it");
    let quartz = &scene.materials[&spec.material];
    let loose = generate::generate(spec, quartz, &scene.walls, 0.0, scene.solver);
    let loose = loose.expect("the pack is found");
    generate::compact(&loose, COMPACTED, &scene.walls, scene.solver)
        .expect("the pack can be compacted")
}
