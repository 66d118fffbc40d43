//! Scenes that are hard on a solver, and what becomes of their increments.

use graintwin::command::Disposition;
use graintwin::pack::generate::{compact, generate};
use graintwin::pack::{Grain, Kept, Pack};
use graintwin::report::Demand;
use graintwin::scene::{
    Cement, CementLaw, CementStrength, Coulomb, Exponential, Friction, Generate, Law, Normal,
    Radius, Scene, Solver, Update, Walls,
};
use graintwin::wall::{self, Bounds};

use crate::packs::{GLASS, Rig, bead, by_strain, centered, made, recipe, scene};

/// A pack, its scene, and where the walls go: displacements since the start \[m\].
pub(crate) struct Hard {
    pub(crate) name: String,
    pub(crate) scene: Scene,
    pub(crate) pack: Pack,
    pub(crate) path: Vec<[f64; wall::COUNT]>,
}

/// What a path came to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Seen {
    pub(crate) increments: u32,
    pub(crate) applied: u32,
    pub(crate) substeps: u32,
    pub(crate) worst_residual: f64,
    pub(crate) events: u32,
    /// Bonds that held at the end and that broke.
    pub(crate) bonds: [usize; 2],
    /// Wall forces at the end \[N\].
    pub(crate) forces: [f64; wall::COUNT],
    /// What the program said last, and what of it was no success.
    pub(crate) said: String,
    pub(crate) refused: Vec<String>,
}

impl Hard {
    fn new(name: &str, friction: f64, pack: Pack, strains: &[[f64; 3]]) -> Self {
        let path = strains.iter().map(|strain| by_strain(&pack.bounds, *strain)).collect();
        let mut hard = Self { name: name.into(), scene: scene(), pack, path };
        if friction > 0.0 {
            let coefficient = friction;
            let coulomb = Coulomb { coefficient, law: Law::ReturnMap, update: Update::Frozen };
            hard.scene.contact.friction = Friction::Coulomb(coulomb);
            hard.scene.walls.friction = Some(friction);
            hard.pack.grains.iter_mut().for_each(|grain| grain.friction = friction);
        }
        hard
    }

    /// Drives the walls; `watch` hears of each increment when it is done.
    pub(crate) fn drive(&self, mut watch: impl FnMut()) -> Seen {
        let demand = Demand { state: true, ..Demand::default() };
        let (mut rig, first) = Rig::start(&self.scene, &self.pack);
        let mut seen = Seen::default();
        if first.disposition != Disposition::Applied {
            seen.refused.push(format!("start: {}", first.text));
        }
        for target in &self.path {
            rig.sequence += 1;
            let report = rig.twin.apply(&crate::packs::absolute(rig.sequence, *target), demand);
            watch();
            seen.increments += 1;
            seen.substeps += report.substeps;
            if !report.text.is_empty() {
                seen.said.clone_from(&report.text);
            }
            let Some(measures) = report.measures else {
                let strain = target.map(|d| d / self.pack.bounds.sides()[0]);
                seen.refused.push(format!("{} at {strain:?}: {}", seen.increments, report.text));
                continue;
            };
            seen.applied += 1;
            seen.events += measures.events.len() as u32;
            seen.forces = measures.walls.normal_force;
            let residual = measures.state.map_or(0.0, |state| state.residual);
            seen.worst_residual = seen.worst_residual.max(residual);
        }
        let pack = rig.twin.pack();
        for bond in pack.history.iter().flat_map(|history| &history.bonds) {
            seen.bonds[usize::from(bond.condition != Kept::Intact)] += 1;
        }
        seen
    }
}

/// `parts` equal steps to `strain` and, for each further entry, from one to the next.
pub(crate) fn through(points: &[[f64; 3]], parts: u32) -> Vec<[f64; 3]> {
    let mut from = [0.0; 3];
    let mut path = Vec::new();
    for to in points {
        for part in 1..=parts {
            let share = f64::from(part) / f64::from(parts);
            path.push(std::array::from_fn(|k| from[k] + share * (to[k] - from[k])));
        }
        from = *to;
    }
    path
}

fn uniaxial(strain: f64, parts: u32) -> Vec<[f64; 3]> {
    through(&[[0.0, 0.0, strain]], parts)
}

/// Every other grain a thousand times softer.
pub(crate) fn contrast(grains: usize, friction: f64) -> Hard {
    let mut pack = made(grains, 1e6, 3);
    pack.grains.iter_mut().step_by(2).for_each(|grain| grain.young *= 1e-3);
    let pack = compact(&pack, 1e6, &Walls::default(), Solver::default()).unwrap();
    Hard::new("stiffness contrast 1:1000", friction, pack, &uniaxial(1e-3, 10))
}

/// Radii of 1:20.
pub(crate) fn radii(grains: usize, friction: f64) -> Hard {
    let radius = Radius::Uniform([0.01e-3, 0.2e-3]);
    let recipe = Generate { radius, ..recipe(grains, 1e6, 5) };
    let pack = generate(&recipe, &GLASS, &Walls::default(), 0.0, Solver::default()).unwrap();
    Hard::new("radius ratio 1:20", friction, pack, &uniaxial(1e-3, 10))
}

/// Walls ten thousand times stiffer than the grains.
pub(crate) fn stiff_walls(grains: usize, friction: f64) -> Hard {
    let walls = Walls { young: 70e13, ..Walls::default() };
    let recipe = recipe(grains, 1e7, 4);
    let pack = generate(&recipe, &GLASS, &walls, 0.0, Solver::default()).unwrap();
    let mut hard = Hard::new("walls 1e4 stiffer", friction, pack, &uniaxial(1e-3, 10));
    hard.scene.walls.young = walls.young;
    hard
}

/// A pack of little `stress` \[Pa\] in steps of `increment`.
pub(crate) fn near_jamming(
    grains: usize,
    friction: f64,
    stress: f64,
    increment: f64,
    parts: u32,
) -> Hard {
    let name = format!("{:.0} kPa, increments of {increment:.0e}", stress * 1e-3);
    let strains = uniaxial(increment * f64::from(parts), parts);
    Hard::new(&name, friction, made(grains, stress, 6), &strains)
}

/// From 10 MPa until nothing touches, and back.
pub(crate) fn decompression(grains: usize, friction: f64) -> Hard {
    let strains = through(&[[-4e-3; 3], [0.0; 3]], 10);
    Hard::new("10 MPa to zero and back", friction, made(grains, 1e7, 2), &strains)
}

/// A cemented pack at 10 MPa, stretched by a hundredth and pressed back in `parts` increments
/// each, whose cement breaks where its tensile or shear stress reaches `strength` \[Pa\].
pub(crate) fn cemented(grains: usize, friction: f64, strength: f64, parts: u32) -> Hard {
    let name = format!("cement of {strength:.0e} Pa, 1 % of stretch in {parts} increments");
    let strains = through(&[[0.0, 0.0, -1e-2], [0.0; 3]], parts);
    let mut hard = Hard::new(&name, friction, made(grains, 1e7, 9), &strains);
    hard.scene.contact.normal = Normal::Cement(Cement {
        law: CementLaw::Exponential(Exponential { gamma: 3000.0 }),
        kappa: 0.01,
        partial_slip: 0.1,
        bridge: 0.1,
        walls: true,
        solution: graintwin::scene::Solution::Nonlinear,
        strength: Some(CementStrength { tension: strength, shear: strength }),
    });
    hard
}

/// A tenth of compression at constant volume.
pub(crate) fn large_strain(grains: usize, friction: f64, parts: u32) -> Hard {
    let strains: Vec<[f64; 3]> = (1..=parts)
        .map(|part| {
            let axial = 0.1 * f64::from(part) / f64::from(parts);
            let lateral = 1.0 - (1.0 - axial).sqrt().recip();
            [lateral, lateral, axial]
        })
        .collect();
    Hard::new("10 % of strain at constant volume", friction, made(grains, 1e6, 7), &strains)
}

/// Up and down between two strains in ten increments a cycle.
pub(crate) fn cycles(grains: usize, friction: f64, increments: usize) -> Hard {
    let up = through(&[[0.0, 0.0, 1e-4], [0.0; 3]], 5);
    let strains: Vec<[f64; 3]> = up.into_iter().cycle().take(increments).collect();
    Hard::new(
        &format!("{increments} increments of a cycle"),
        friction,
        made(grains, 1e6, 8),
        &strains,
    )
}

/// A grain pushed through the gap between two columns of others, which is narrower than the grain.
pub(crate) fn constriction(friction: f64, parts: u32) -> Hard {
    let mm = |position: [f64; 3], radius: f64| bead(position.map(|x| x * 1e-3), radius * 1e-3);
    let (column, passing) = (0.8, 1.0);
    // The passing grain overlaps 2 % at the narrowest.
    let x = 0.98 * (column + passing);
    let mut grains = vec![mm([0.01, 1.3, 0.0], passing)];
    for side in [-1.0, 1.0] {
        for y in [0.0, -1.6, -3.2] {
            grains.push(mm([side * x, y, 0.0], column));
        }
    }
    let bounds = Bounds {
        min: [-(x + column) * 1e-3, -4.0e-3, -1e-3],
        max: [(x + column) * 1e-3, 2.3e-3, 1e-3],
    };
    let pack = Pack { bounds, grains, history: None };
    let mut hard = Hard::new("a grain through a constriction", friction, pack, &[]);
    hard.scene.solver.max_strain_increment = 1e-3;
    // The top comes down on the columns at the end.
    hard.path = (1..=parts)
        .map(|part| [0.0, 0.0, 0.0, 1.49e-3 * f64::from(part) / f64::from(parts), 0.0, 0.0])
        .collect();
    hard
}

/// `count` grains in a row between two walls, pressed, let go and pressed again.
pub(crate) fn few(count: usize, friction: f64) -> Hard {
    let radius = 1e-3;
    let half = count as f64 * radius;
    let grains: Vec<Grain> =
        (0..count).map(|k| bead([0.0, 0.0, -half + (2 * k + 1) as f64 * radius], radius)).collect();
    let pack = Pack { bounds: centered([2e-3, 2e-3, 2.0 * half]), grains, history: None };
    let strains = through(&[[1e-4, 1e-4, 1e-3], [-1e-3; 3], [0.0, 0.0, 1e-3]], 10);
    Hard::new(&format!("{count} grains in a row"), friction, pack, &strains)
}

/// Equal spheres on a simple cubic (`false`) or face-centred cubic lattice, pressed along z.
pub(crate) fn crystal(face_centred: bool, friction: f64, parts: u32) -> Hard {
    let radius = 1e-3;
    let cells = 3;
    let edge = if face_centred { 8f64.sqrt() * radius } else { 2.0 * radius };
    let sites: &[[f64; 3]] = match face_centred {
        true => &[[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]],
        false => &[[0.0; 3]],
    };
    let mut grains = Vec::new();
    for cell in 0..cells * cells * cells {
        let corner = [cell % cells, cell / cells % cells, cell / cells / cells];
        for site in sites {
            let at = std::array::from_fn(|k| (corner[k] as f64 + site[k]) * edge);
            grains.push(bead(at, radius));
        }
    }
    let max: [f64; 3] = std::array::from_fn(|k| {
        grains.iter().map(|grain| grain.position[k]).fold(0.0, f64::max) + radius
    });
    let pack = Pack { bounds: Bounds { min: [-radius; 3], max }, grains, history: None };
    let name = if face_centred { "fcc crystal" } else { "simple cubic crystal" };
    let strains = through(&[[1e-4; 3], [1e-4, 1e-4, 2e-3], [1e-4; 3]], parts);
    Hard::new(name, friction, pack, &strains)
}

/// `hard` with lengths times `length` and moduli times `modulus`.
pub(crate) fn scaled(hard: &Hard, length: f64, modulus: f64) -> Hard {
    let mut pack = hard.pack.clone();
    pack.bounds.min = pack.bounds.min.map(|x| x * length);
    pack.bounds.max = pack.bounds.max.map(|x| x * length);
    for grain in &mut pack.grains {
        grain.position = grain.position.map(|x| x * length);
        grain.radius *= length;
        grain.young *= modulus;
    }
    let mut scene = hard.scene.clone();
    scene.walls.young *= modulus;
    let path = hard.path.iter().map(|target| target.map(|d| d * length)).collect();
    let name = format!("lengths x {length:.0e}, moduli x {modulus:.0e}");
    Hard { name, scene, pack, path }
}

/// `hard` with every coordinate one step of its last digit further from zero.
pub(crate) fn nudged(hard: &Hard) -> Hard {
    let mut pack = hard.pack.clone();
    for grain in &mut pack.grains {
        grain.position = grain.position.map(|x| f64::from_bits(x.to_bits() + 1));
    }
    let (scene, path) = (hard.scene.clone(), hard.path.clone());
    Hard { name: "one ulp".into(), scene, pack, path }
}

/// Uniaxial increments without an event, the base of [`scaled`] and [`nudged`].
pub(crate) fn plain(grains: usize, friction: f64) -> Hard {
    Hard::new("plain", friction, made(grains, 1e7, 5), &uniaxial(2e-4, 4))
}

/// Largest difference of wall forces over the largest, `b` times `factor`.
pub(crate) fn apart(a: &Seen, b: &Seen, factor: f64) -> f64 {
    let most = a.forces.iter().copied().fold(0.0, f64::max);
    let off = |(a, b): (&f64, &f64)| (a - b * factor).abs() / most;
    a.forces.iter().zip(&b.forces).map(off).fold(0.0, f64::max)
}
