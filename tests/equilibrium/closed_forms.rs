//! Specimens whose equilibrium is known in closed form. The numbers come from Hertz' law written
//! out here with E* as literals, and from the balance of forces derived beside each test.

use std::f64::consts::{PI, SQRT_2};

use graintwin::command::Disposition;
use graintwin::pack::{Grain, Pack};
use graintwin::report::{ContactNetwork, Measures};
use graintwin::scene::{Method, Scene, Solver};
use graintwin::wall::{self, Bounds};

use crate::packs::{
    self, E_GRAINS, E_WALL, Rig, bead, by_strain, centered, close, scene, scene_to, state,
};

/// Radius of the beads \[m\].
const R: f64 = 1e-4;
/// What machine precision leaves of a force.
const EXACT: f64 = 1e-12;

/// A scene relaxed as far as rounding allows: a centre at 2R is resolved to 2R 2⁻⁵³, so a force
/// whose overlap is `share` of 2R to a few times that over `share`.
fn exact(share: f64) -> Scene {
    scene_to(f64::max(1e-13, 5e-16 / share))
}

/// Force of an overlap between two beads \[N\]: R* = R/2.
fn grain_force(overlap: f64) -> f64 {
    4.0 / 3.0 * E_GRAINS * (0.5 * R).sqrt() * overlap.powf(1.5)
}

/// Force of an overlap between a bead and a wall \[N\]: R* = R.
fn wall_force(overlap: f64) -> f64 {
    4.0 / 3.0 * E_WALL * R.sqrt() * overlap.powf(1.5)
}

/// Overlap of a bead and a wall that carries `force` \[m\].
fn wall_overlap(force: f64) -> f64 {
    (force / (4.0 / 3.0 * E_WALL * R.sqrt())).powf(2.0 / 3.0)
}

/// Force along a row of `n` beads between two walls that is `short` \[m\] shorter than 2nR: one
/// force F in all contacts, so h_grain = c h_wall with c = (M_wall/M_grain)^(2/3), and
/// 2 h_wall + (n - 1) h_grain = short.
fn row_force(n: usize, short: f64) -> f64 {
    let ratio = (E_WALL * R.sqrt() / (E_GRAINS * (0.5 * R).sqrt())).powf(2.0 / 3.0);
    wall_force(short / (2.0 + (n - 1) as f64 * ratio))
}

fn forces(measures: &Measures) -> [f64; wall::COUNT] {
    measures.walls.normal_force
}

fn network(measures: &Measures) -> &ContactNetwork {
    measures.network.as_ref().unwrap()
}

/// A box that holds `n` beads a side with these overlaps, and the beads a little off their places.
fn block(n: [usize; 3], short: [f64; 3]) -> Pack {
    let sides = [0, 1, 2].map(|axis| 2.0 * R * n[axis] as f64 - short[axis]);
    let mut grains = Vec::new();
    for x in 0..n[0] {
        for y in 0..n[1] {
            for z in 0..n[2] {
                let cell = [x, y, z];
                let wobble = 1e-3 * R * ((7 * x + 3 * y + 5 * z) % 4) as f64;
                let at = |axis: usize| {
                    sides[axis] * ((cell[axis] as f64 + 0.5) / n[axis] as f64 - 0.5) + wobble
                };
                grains.push(bead([at(0), at(1), at(2)], R));
            }
        }
    }
    Pack { bounds: centered(sides), grains, history: None }
}

/// Wall forces of a block: a wall carries the rows that end at it.
fn check_block(measures: &Measures, n: [usize; 3], short: [f64; 3], tolerance: f64) {
    for w in 0..wall::COUNT {
        let axis = wall::axis(w);
        let rows = n.iter().product::<usize>() / n[axis];
        let want = rows as f64 * row_force(n[axis], short[axis]);
        close(&format!("{n:?} {short:?} {}", wall::NAMES[w]), forces(measures)[w], want, tolerance);
    }
}

#[test]
fn one_sphere_between_six_walls_follows_hertz() {
    for short in [[1e-3, 1e-3, 1e-3], [2e-3, 3e-3, 0.1], [0.02, 0.01, 0.05]] {
        let short = short.map(|share| share * R);
        let (_, report) = Rig::start(&exact(5e-4), &block([1, 1, 1], short));
        check_block(&report.measures.unwrap(), [1, 1, 1], short, EXACT);
    }
}

#[test]
fn a_sphere_between_two_walls_alone_follows_hertz() {
    for share in [1e-3, 1e-2, 0.1] {
        let sides = [4.0 * R, 4.0 * R, (2.0 - share) * R];
        let grains = vec![bead([0.0, 0.0, 1e-4 * R], R)];
        let (_, report) =
            Rig::start(&exact(5e-4), &Pack { bounds: centered(sides), grains, history: None });
        let found = forces(&report.measures.unwrap());
        let want = wall_force(0.5 * share * R);
        assert_eq!(found[..4], [0.0; 4]);
        close("floor", found[4], want, EXACT);
        close("ceiling", found[5], want, EXACT);
    }
}

#[test]
fn overlaps_of_a_column_split_between_walls_and_spheres() {
    for share in [1e-3, 1e-2, 0.1] {
        let (n, short) = ([1, 1, 2], [2e-3 * R, 4e-3 * R, share * R]);
        let (_, report) = Rig::start(&exact(5e-4), &block(n, short));
        let measures = report.measures.unwrap();
        check_block(&measures, n, short, EXACT);
        // The middle contact: what the walls leave of the shortening.
        let network = network(&measures);
        let middle = network.second.iter().position(|&second| second < 2).unwrap();
        let force = row_force(2, short[2]);
        let overlap = short[2] - 2.0 * wall_overlap(force);
        close("middle overlap", network.overlap[middle], overlap, EXACT);
        close("middle force", network.normal_force[middle], force, EXACT);
        close("middle force by its own law", grain_force(overlap), force, EXACT);
    }
}

#[test]
fn simple_cubic_blocks_have_the_wall_forces_of_their_rows() {
    for n in [2, 3] {
        let size = [n; 3];
        let touching = block(size, [0.0; 3]);
        let side = 2.0 * R * n as f64;
        let (mut rig, _) = Rig::start(&exact(5e-4), &block(size, [1e-3 * side; 3]));
        let start = rig.twin.pack().bounds;
        assert_eq!(touching.bounds.sides(), [side; 3]);
        for strain in [[0.0; 3], [2e-3; 3], [2e-3, 2e-3, 4e-3], [2e-3, 5e-3, 1e-2]] {
            let measures = rig.go(by_strain(&start, strain));
            let sides = rig.twin.pack().bounds.sides();
            check_block(&measures, size, sides.map(|now| side - now), EXACT);
        }
    }
}

/// Five beads whose centres are a pyramid of edge 2R(1 - eps), in walls that hold it.
///
/// F is the force of each of the eight grain contacts. A bottom bead is pushed by its two
/// neighbours with F along x and F along y, and by the top bead along (1, 1, -√2)/2: its side walls
/// give 3/2 F each, the floor F/√2. The ceiling gives the top bead 4 F/√2 = 2√2 F.
struct Pyramid {
    edge: f64,
    force: f64,
    bounds: Bounds,
}

impl Pyramid {
    fn new(eps: f64) -> Self {
        let edge = 2.0 * R * (1.0 - eps);
        let force = grain_force(2.0 * R * eps);
        let reach = |wall_force: f64| R - wall_overlap(wall_force);
        let half = 0.5 * edge + reach(1.5 * force);
        // Base at z = 0, top at edge/√2.
        let low = -reach(force / SQRT_2);
        let high = edge / SQRT_2 + reach(2.0 * SQRT_2 * force);
        Self { edge, force, bounds: Bounds { min: [-half, -half, low], max: [half, half, high] } }
    }

    /// The centres: four corners, then the top.
    fn pack(&self) -> Pack {
        let a = 0.5 * self.edge;
        let corners = [[-a, -a, 0.0], [a, -a, 0.0], [-a, a, 0.0], [a, a, 0.0]];
        let top = [0.0, 0.0, self.edge / SQRT_2];
        let grains = corners.into_iter().chain([top]).map(|at| bead(at, R)).collect();
        Pack { bounds: self.bounds, grains, history: None }
    }

    /// The beads a little off their places.
    fn pushed(&self) -> Pack {
        let mut pack = self.pack();
        for (k, grain) in pack.grains.iter_mut().enumerate() {
            let push = 0.1 * (2.0 * R - self.edge) * (k as f64 - 1.7);
            grain.position =
                [0, 1, 2].map(|axis| grain.position[axis] + push * (axis as f64 - 0.8));
        }
        pack
    }

    /// Holds the equilibrium found against the closed form.
    fn check(&self, found: &Pack, measures: &Measures, tolerance: f64) {
        let at = |grain: &Grain| graintwin::Vec3::from(grain.position);
        let mut contacts = 0;
        for i in 0..5 {
            for j in i + 1..5 {
                // The diagonals of the base are no contacts.
                if (i, j) != (0, 3) && (i, j) != (1, 2) {
                    let distance = (at(&found.grains[i]) - at(&found.grains[j])).norm();
                    close(&format!("distance {i}-{j}"), distance, self.edge, tolerance);
                    contacts += 1;
                }
            }
        }
        assert_eq!(contacts, 8);
        for w in 0..wall::COUNT {
            let share = if w < 4 { 3.0 } else { 2.0 * SQRT_2 };
            close(wall::NAMES[w], forces(measures)[w], share * self.force, tolerance);
        }
        assert_eq!(network(measures).first.len(), 8 + 8 + 4 + 1);
    }
}

/// Strains of T 2.7.3.1 that issue and thesis ask for.
const PYRAMID_STRAINS: [f64; 3] = [1e-3, 1e-2, 5e-2];

#[test]
fn the_pyramid_is_found_in_equilibrium_between_its_walls() {
    for eps in PYRAMID_STRAINS {
        let pyramid = Pyramid::new(eps);
        let (rig, report) = Rig::start(&exact(eps), &pyramid.pack());
        pyramid.check(&rig.twin.pack(), &report.measures.unwrap(), EXACT);
    }
}

#[test]
fn the_pyramid_finds_its_places_when_it_starts_between_the_final_walls() {
    for eps in PYRAMID_STRAINS {
        let pyramid = Pyramid::new(eps);
        let (rig, report) = Rig::start(&exact(eps), &pyramid.pushed());
        assert!(report.text.contains("not in equilibrium"), "{}", report.text);
        pyramid.check(&rig.twin.pack(), &report.measures.unwrap(), EXACT);
    }
}

/// One command from the touching state to the final walls.
fn command_pyramid(scene: &Scene, eps: f64, tolerance: f64) -> u32 {
    let (pyramid, touching) = (Pyramid::new(eps), Pyramid::new(0.0));
    let (mut rig, report) = Rig::start(scene, &touching.pack());
    assert_eq!(forces(&report.measures.unwrap()), [0.0; wall::COUNT]);
    let displacement = std::array::from_fn(|w| {
        (pyramid.bounds.position(w) - touching.bounds.position(w)) * wall::inward(w)
    });
    let report = rig.send(displacement);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    pyramid.check(&rig.twin.pack(), &report.measures.unwrap(), tolerance);
    report.substeps
}

#[test]
fn the_pyramid_follows_one_command_from_the_touching_state() {
    for eps in PYRAMID_STRAINS {
        // Every sub-increment must reach the tolerance, so the first one must not be too small.
        let mut scene = exact(0.5 * eps);
        scene.solver.max_strain_increment = eps;
        scene.solver.max_overlap_share = 100.0;
        let substeps = command_pyramid(&scene, eps, EXACT);
        assert!((2..5).contains(&substeps), "{substeps}");
    }
}

#[test]
fn the_pyramid_follows_hundreds_of_sub_increments() {
    for eps in PYRAMID_STRAINS {
        // The default steps: overlaps begin at a strain of 1e-4, where rounding allows 5e-12.
        let substeps = command_pyramid(&scene_to(1e-11), eps, 1e-11);
        assert!(substeps >= (eps / 1e-4) as u32, "{substeps}");
    }
}

/// The methods of the seeds, to a residual of 1e-10: forces of these few contacts in a row are then
/// known to a few times that.
fn by_the_seeds(scene: &Scene) -> [Scene; 3] {
    [Method::ConjugateGradient, Method::GaussSeidel, Method::Dynamic].map(|method| {
        let solver = Solver { method, tolerance: 1e-10, ..scene.solver };
        Scene { solver, ..scene.clone() }
    })
}

#[test]
fn the_methods_of_the_seeds_find_spheres_and_cubic_blocks_between_walls() {
    for scene in by_the_seeds(&scene()) {
        for (n, share) in
            [([1, 1, 1], 1e-2), ([1, 1, 2], 1e-2), ([2, 2, 2], 4e-3), ([3, 3, 3], 2e-3)]
        {
            let short = [0.8, 1.0, 1.5].map(|part| part * share * R * n[2] as f64);
            let mut pack = block(n, short);
            pack.grains[0].position = pack.grains[0].position.map(|x| x + 1e-4 * R);
            let (_, report) = Rig::start(&scene, &pack);
            assert!(report.text.contains("not in equilibrium"), "{}", report.text);
            check_block(&report.measures.unwrap(), n, short, 1e-9);
        }
    }
}

#[test]
fn the_methods_of_the_seeds_find_the_pyramid_between_its_final_walls() {
    for scene in by_the_seeds(&scene()) {
        for eps in PYRAMID_STRAINS {
            let pyramid = Pyramid::new(eps);
            let (rig, report) = Rig::start(&scene, &pyramid.pushed());
            assert!(report.text.contains("not in equilibrium"), "{}", report.text);
            pyramid.check(&rig.twin.pack(), &report.measures.unwrap(), 1e-9);
        }
    }
}

#[test]
fn the_methods_of_the_seeds_rest_a_sphere_on_the_floor_with_its_weight() {
    let bounds = Bounds { min: [-0.02, -0.02, 0.0], max: [0.02, 0.02, 0.06] };
    let pack = Pack { bounds, grains: vec![ball(0.0099)], history: None };
    for scene in by_the_seeds(&under_gravity(1e-10)) {
        let (_, report) = Rig::start(&scene, &pack);
        close("floor", forces(&report.measures.unwrap())[4], BALL_WEIGHT, 1e-9);
    }
}

/// Rubber balls of 10 mm: their weight makes overlaps that double precision resolves.
fn ball(z: f64) -> Grain {
    let (young, poisson, density) = (1e7, 0.3, 1100.0);
    Grain {
        position: [0.0, 0.0, z],
        radius: 0.01,
        young,
        poisson,
        density,
        friction: 0.0,
        hydrate: false,
    }
}

/// 4/3 π (0.01 m)³ 1100 kg/m³ 9.81 m/s².
const BALL_WEIGHT: f64 = 4.0 / 3.0 * PI * 1e-6 * 1100.0 * 9.81;

fn under_gravity(tolerance: f64) -> Scene {
    Scene { gravity: [0.0, 0.0, -9.81], ..scene_to(tolerance) }
}

#[test]
fn a_sphere_rests_on_the_floor_with_its_weight() {
    for height in [0.01, 0.0099, 0.0115, 0.03, 0.05] {
        let bounds = Bounds { min: [-0.02, -0.02, 0.0], max: [0.02, 0.02, 0.06] };
        let pack = Pack { bounds, grains: vec![ball(height)], history: None };
        let (rig, report) = Rig::start(&under_gravity(1e-13), &pack);
        let found = forces(&report.measures.unwrap());
        assert_eq!([&found[..4], &found[5..]].concat(), [0.0; 5]);
        close("floor", found[4], BALL_WEIGHT, EXACT);
        // 1/E* = 0.91/1e7 + (1 - 0.495²)/7e12.
        let modulus = 4.0 / 3.0 * 0.1 / (0.91 / 1e7 + 0.754_975 / 7e12);
        let overlap = 0.01 - rig.twin.pack().grains[0].position[2];
        close("overlap", overlap, (BALL_WEIGHT / modulus).powf(2.0 / 3.0), EXACT);
    }
}

#[test]
fn a_column_of_three_carries_one_two_and_three_weights() {
    // Lateral walls touch the balls lightly, so that the column stands.
    let side = 0.02 - 1e-4;
    let bounds =
        Bounds { min: [-0.5 * side, -0.5 * side, 0.0], max: [0.5 * side, 0.5 * side, 0.1] };
    let grains = vec![ball(0.0101), ball(0.085), ball(0.0399)];
    let (_, report) = Rig::start(&under_gravity(1e-13), &Pack { bounds, grains, history: None });
    let measures = report.measures.unwrap();
    close("floor", forces(&measures)[4], 3.0 * BALL_WEIGHT, EXACT);
    assert_eq!(forces(&measures)[5], 0.0);
    let network = network(&measures);
    let force = |first: u32, second: u32| {
        let found = network.first.iter().zip(&network.second);
        let at = found.clone().position(|pair| pair == (&first, &second)).unwrap();
        network.normal_force[at]
    };
    close("on the lowest", force(0, 2), 2.0 * BALL_WEIGHT, EXACT);
    close("on the second", force(1, 2), BALL_WEIGHT, EXACT);
}

#[test]
fn a_pack_under_gravity_leaves_its_weight_between_floor_and_ceiling() {
    let pack = packs::made(60, 1e6, 3);
    // A centrifuge of 5000 g: the weight is a tenth of the wall forces.
    let (rig, report) = Rig::start(&Scene { gravity: [0.0, 0.0, -5e4], ..scene() }, &pack);
    let measures = report.measures.unwrap();
    let found = forces(&measures);
    let weight: f64 = rig
        .twin
        .pack()
        .grains
        .iter()
        .map(|g| 4.0 / 3.0 * PI * g.radius.powi(3) * g.density * 5e4)
        .sum();
    assert!(weight > 0.01 * found[4], "{weight} {found:?}");
    // Sixty unbalanced forces, each at most the residual times the mean force.
    let contacts = &network(&measures).normal_force;
    let mean = contacts.iter().sum::<f64>() / contacts.len() as f64;
    let allowed = 60.0 * state(&measures).residual * mean + 1e-13 * found[4];
    assert!((found[4] - found[5] - weight).abs() <= allowed, "{} {weight}", found[4] - found[5]);
    assert!((found[0] - found[1]).abs() <= allowed && (found[2] - found[3]).abs() <= allowed);
}
