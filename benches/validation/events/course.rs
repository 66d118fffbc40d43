//! A frictionless pack on a path of strains, with everything that its events tell.

use std::path::Path;

use graintwin::command::{Ask, Command, Mode, Stamp};
use graintwin::pack::generate;
use graintwin::report::{Demand, Measures};
use graintwin::scene;
use graintwin::twin::Twin;
use graintwin::wall;

use crate::specimen::LOOSE;

/// The equilibria of a path.
pub(crate) struct Course {
    /// The initial one first.
    pub(crate) points: Vec<Point>,
    /// Radii of the grains \[m\].
    pub(crate) radius: Vec<f64>,
}

/// One equilibrium.
pub(crate) struct Point {
    /// Strain of the walls asked for.
    pub(crate) strain: [f64; 3],
    pub(crate) measures: Measures,
    /// Equilibria on the way to it.
    pub(crate) substeps: u32,
}

impl Point {
    /// Normal stresses on the walls \[Pa\].
    pub(crate) fn stress(&self) -> [f64; 3] {
        [0, 4, 8].map(|k| self.state().stress_walls[k])
    }

    pub(crate) fn state(&self) -> graintwin::report::PackState {
        self.measures.state.expect("it was demanded")
    }

    /// tr ε.
    pub(crate) fn volumetric(&self) -> f64 {
        self.strain.iter().sum()
    }

    /// Centres of the grains \[m\].
    pub(crate) fn positions(&self) -> &[[f64; 3]] {
        &self.measures.grains.as_ref().expect("they were demanded").position
    }
}

impl Course {
    /// A pack of `grains` glass beads, pressed to `stress` \[Pa\], through `strains`; what is
    /// `kept` of each equilibrium.
    pub(crate) fn run(
        (grains, seed): (usize, u64),
        stress: f64,
        strains: &[[f64; 3]],
        kept: Demand,
    ) -> Self {
        let text = format!(
            "pack: {{generate: {{grains: {grains}, radius: {{uniform: [0.07e-3, 0.13e-3]}}, \
             material: glass, seed: {seed}, confining_stress: {LOOSE:e}}}}}"
        );
        let scene = scene::parse(&text, Path::new("validation.yaml")).expect("the scene is right");
        let spec = scene.pack.generate.as_ref().expect("the scene asks for it");
        let glass = &scene.materials[&spec.material];
        let loose = generate::generate(spec, glass, &scene.walls, 0.0, scene.solver);
        let mut pack = loose.expect("the pack is found");
        if stress > LOOSE {
            pack = generate::compact(&pack, stress, &scene.walls, scene.solver)
                .expect("the pack can be compacted");
        }
        let mut twin = Twin::new(&scene, &pack, 1).expect("the pack has grains");
        let start = twin.start(kept).measures.expect("the pack is in equilibrium");
        let mut points = vec![Point { strain: [0.0; 3], measures: start, substeps: 0 }];
        let sides = pack.bounds.sides();
        for (strain, sequence) in strains.iter().zip(1..) {
            let displacement: [f64; wall::COUNT] =
                std::array::from_fn(|w| 0.5 * strain[w / 2] * sides[w / 2]);
            let command = Command {
                stamp: Stamp::default(),
                session: "events".into(),
                sequence,
                mode: Mode::Absolute,
                ask: Ask::Displacement(displacement),
                age: None,
            };
            let report = twin.apply(&command, kept);
            let measures = report.measures.unwrap_or_else(|| panic!("{}", report.text));
            points.push(Point { strain: *strain, measures, substeps: report.substeps });
        }
        let radius = pack.grains.iter().map(|grain| grain.radius).collect();
        Self { points, radius }
    }

    /// The point whose event took one grain furthest, over its radius, of those with two points
    /// before and one after them.
    pub(crate) fn furthest(&self) -> usize {
        let inner = 2..self.points.len() - 1;
        let reach = |k: &usize| {
            let events = &self.points[*k].measures.events;
            let ways = events.iter().flat_map(|event| event.grains.iter().zip(&event.displacement));
            ways.map(|(grain, way)| way / self.radius[*grain as usize]).fold(0.0, f64::max)
        };
        inner.max_by(|a, b| reach(a).total_cmp(&reach(b))).expect("the path is longer than that")
    }

    /// Work of the walls up to each point, by trapezoids \[J\].
    pub(crate) fn work(&self) -> Vec<f64> {
        let mut sum = 0.0;
        let steps = self.points.windows(2).map(|pair| {
            let [from, to] = [&pair[0], &pair[1]].map(|point| point.measures.walls);
            for w in 0..wall::COUNT {
                let force = 0.5 * (from.normal_force[w] + to.normal_force[w]);
                sum += force * (to.displacement[w] - from.displacement[w]);
            }
            sum
        });
        [0.0].into_iter().chain(steps).collect()
    }
}
