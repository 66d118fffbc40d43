//! Sandstone: cemented discs (B chapter 4).

use graintwin::analytic::cemented;
use graintwin::analytic::contact::stiffness_ratio;
use graintwin::analytic::fit::{record, strength};
use graintwin::pack::Pack;
use graintwin::scene::Loaded;

use super::rig::{Course, Rig, made_if, scene};
use super::{DIAMETER, POISSON, found, spread};

/// Lateral pressures \[Pa\]; the first stands for the unconfined test.
const PRESSURES: [f64; 4] = [1e4, 1e6, 3e6, 6e6];
/// k_n \[N/m\] and c_μ \[Pa\] (B table 8).
const STIFFNESS: f64 = 1e6;
const COHESION: f64 = 1e8;
/// Stress of the sample while it was made \[Pa\].
const MADE: f64 = 1e6;
/// Largest strain of a test.
const STRAIN: f64 = 2e-2;
/// A test ends when σ1 has fallen to this share of its peak.
const FALLEN: f64 = 0.75;

fn loaded(bond: bool, pack: &str, rotation: &str) -> Loaded {
    let bond = if bond { format!(", bond: {{cohesion: {COHESION:e}}}") } else { String::new() };
    let contact = format!(
        "{{normal: {{linear: {{stiffness: {STIFFNESS:e}{bond}}}}}, friction: {{coefficient: 0.6}}, \
         rotation: {rotation}}}"
    );
    scene(pack, &contact, "max_overlap_share: 100.0")
}

fn pack(seed: u64, grains: u32, grading: &str, aspect: f64) -> Option<Pack> {
    let text = format!(
        "  generate: {{grains: {grains}, radius: {{{grading}: {{mean: 0.1e-3, ratio: 4.0}}}}, \
         material: sand, seed: {seed}, confining_stress: {MADE:e}, aspect: [1, {aspect}, 1]}}"
    );
    made_if(&loaded(false, &text, "free"))
}

fn rig(pack: &Pack, rotation: &str, pressure: f64) -> Rig {
    let mut rig = Rig::new(&loaded(true, "  file: none.csv", rotation).scene, pack);
    rig.isotropic(pressure);
    rig
}

fn biaxial(pack: &Pack, pressure: f64) -> Course {
    rig(pack, "free", pressure).press(Some(pressure), |course| {
        course.strain() >= STRAIN || course.pressed() < FALLEN * course.major[course.peak()]
    })
}

/// E \[GPa\] and ν of the beginning, E50 \[GPa\].
fn elastic(course: &Course) -> [f64; 3] {
    let deviator = course.deviator();
    let Some(begin) = record::begin(&deviator) else { return [f64::NAN; 3] };
    let young = record::slope(&course.axial, &deviator, begin.clone());
    let poisson = record::poisson(&course.axial, &course.area, begin);
    let half = record::secant_50(&course.axial, &deviator);
    [found(young) / 1e9, found(poisson), found(half) / 1e9]
}

/// Runs and prints the tests.
pub(crate) fn run(seeds: &[u64]) {
    for (name, grading) in [("A", "grading_a"), ("B", "grading_b")] {
        let packs: Vec<Pack> =
            seeds.iter().filter_map(|&seed| pack(seed, 1000, grading, 2.5)).collect();
        kind(name, &packs);
    }
    sizes(seeds);
}

fn kind(name: &str, packs: &[Pack]) {
    println!("\nSandstone of grading {name} (B tables 10 and 11):\n");
    println!(
        "| σ3 [MPa] | σ1 at failure [MPa] | ε1 there [%] | E begin [GPa] | E50 [GPa] | ν | bonds broken at failure [%] | by tension | axial cracks at failure | axial cracks in all |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut failures = vec![Vec::new(); packs.len()];
    let mut density = Vec::new();
    for pressure in PRESSURES {
        let tests: Vec<Course> = packs.iter().map(|pack| biaxial(pack, pressure)).collect();
        for (failures, test) in failures.iter_mut().zip(&tests) {
            failures.push([pressure, test.major[test.peak()]]);
        }
        density.extend(tests.iter().map(|test| test.density));
        let all = |of: &dyn Fn(&Course) -> f64, digits| spread(tests.iter().map(of), digits);
        println!(
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            pressure / 1e6,
            all(&|t| t.major[t.peak()] / 1e6, 1),
            all(&|t| 1e2 * t.axial[t.peak()], 2),
            all(&|t| elastic(t)[0], 2),
            all(&|t| elastic(t)[2], 2),
            all(&|t| elastic(t)[1], 2),
            all(&|t| 1e2 * t.broken_share(), 2),
            all(&|t| t.tension_share(false), 2),
            all(&|t| t.axial_share(false), 2),
            all(&|t| t.axial_share(true), 2),
        );
    }
    let fits = failures.iter().filter_map(|failures| strength::cohesive(failures));
    let fits: Vec<_> = fits.map(|fit| fit.strength).collect();
    println!(
        "\nc' {} MPa, φ' {}°",
        spread(fits.iter().map(|fit| fit.cohesion / 1e6), 2),
        spread(fits.iter().map(|fit| fit.friction.to_degrees()), 1)
    );
    let mean = density.iter().sum::<f64>() / density.len() as f64;
    let predicted = cemented::strength(mean, COHESION);
    let kappa = stiffness_ratio(POISSON);
    let averaged = cemented::averaged(mean, STIFFNESS, DIAMETER, kappa);
    let uniform = cemented::uniform(mean, STIFFNESS, DIAMETER, kappa);
    println!(
        "n_c/v {}: A.95 c' {:.2} MPa, φ' {:.1}°; A.83 E {:.2} GPa, ν {:.2}; uniform strain E {:.2} GPa, ν {:.2}",
        spread(density, 3),
        predicted.cohesion / 1e6,
        predicted.friction.to_degrees(),
        averaged.young / 1e9,
        averaged.poisson,
        uniform.young / 1e9,
        uniform.poisson
    );
    compression(packs);
}

/// One-dimensional compression and locked rotations (table 10, 4.3).
fn compression(packs: &[Pack]) {
    for rotation in ["free", "locked"] {
        let (mut young, mut poisson) = (vec![], vec![]);
        let (mut biaxial_young, mut lateral) = (vec![], vec![]);
        for pack in packs {
            let short = |course: &Course| course.strain() >= 1e-3;
            let test = rig(pack, rotation, 1e6).press(None, short);
            let all = 0..test.axial.len();
            let ratio = found(record::slope(&test.major, &test.minor, all.clone()));
            let stiffness = found(record::slope(&test.axial, &test.major, all.clone()));
            young.push((1.0 - ratio * ratio) * stiffness / 1e9);
            poisson.push(ratio);
            let test = rig(pack, rotation, 1e6).press(Some(1e6), short);
            biaxial_young.push(found(record::slope(&test.axial, &test.major, all.clone())) / 1e9);
            lateral.push(found(record::poisson(&test.axial, &test.area, all)));
        }
        println!(
            "rotations {rotation}, up to 0.1 %: compression E {} GPa, ν {}; biaxial at 1 MPa E {} GPa, ν {}",
            spread(young, 2),
            spread(poisson, 3),
            spread(biaxial_young, 2),
            spread(lateral, 3)
        );
    }
}

/// Samples of other sizes and shapes at 1 MPa (table 9, figures 34 and 35).
fn sizes(seeds: &[u64]) {
    println!("\nSizes and shapes of sandstone, grading A, σ3 = 1 MPa (B table 9):\n");
    println!(
        "| grains | H/W | σ1 at failure [MPa] | E begin [GPa] | ν | bonds broken at failure [%] |"
    );
    println!("| --- | --- | --- | --- | --- | --- |");
    for (grains, aspect) in [(250, 2.5), (500, 2.5), (1000, 2.5), (1000, 0.4), (4000, 2.5)] {
        let seeds = if grains > 1000 { &seeds[..1] } else { seeds };
        let tests: Vec<Course> = (seeds.iter())
            .filter_map(|&seed| Some(biaxial(&pack(seed, grains, "grading_a", aspect)?, 1e6)))
            .collect();
        let all = |of: &dyn Fn(&Course) -> f64, digits| spread(tests.iter().map(of), digits);
        println!(
            "| {grains} | {aspect} | {} | {} | {} | {} |",
            all(&|t| t.major[t.peak()] / 1e6, 1),
            all(&|t| elastic(t)[0], 2),
            all(&|t| elastic(t)[1], 2),
            all(&|t| 1e2 * t.broken_share(), 2),
        );
    }
}
