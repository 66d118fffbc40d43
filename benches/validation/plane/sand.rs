//! Dense and loose sand (B chapter 3).

use graintwin::analytic::fit::{record, strength};
use graintwin::analytic::sand;
use graintwin::pack::Pack;

use super::rig::{Course, Rig, made, scene};
use super::{POISSON, found, spread};

/// G of the grains \[Pa\].
const SHEAR_MODULUS: f64 = 1e9;
/// Lateral pressures \[Pa\] (B table 3).
const PRESSURES: [f64; 4] = [1e5, 2e5, 3e5, 4e5];
/// B table 3: φ', ν and ψ \[°\]; table 4: E50, simulated and predicted \[MPa\].
const BOOK: [[f64; 5]; 4] = [
    [30.2, 0.17, 14.2, 48.2, 50.8],
    [31.6, 0.12, 11.7, 65.2, 64.0],
    [31.4, 0.12, 10.4, 76.4, 73.3],
    [31.6, 0.12, 9.8, 84.1, 80.7],
];
/// Axial strain of the biaxial tests.
const STRAIN: f64 = 4e-2;
/// Axial strain from which a test counts as failing.
const FAILING: f64 = 2e-2;
/// Stress at which the compression tests turn \[Pa\].
const HIGHEST: f64 = 6e5;

/// What a biaxial test says.
struct Biaxial {
    friction: f64,
    failing: f64,
    poisson: f64,
    dilatancy: f64,
    young: f64,
    theory: f64,
    contacts: [f64; 2],
}

impl Biaxial {
    fn of(course: &Course, pressure: f64) -> Self {
        let deviator = course.deviator();
        let peak = course.peak();
        let mobilised =
            |place: usize| found(strength::mobilised(course.major[place], course.minor[place]));
        let tail: Vec<usize> =
            (0..course.axial.len()).filter(|&place| course.axial[place] >= FAILING).collect();
        let mean = |of: &dyn Fn(usize) -> f64| {
            tail.iter().map(|&place| of(place)).sum::<f64>() / tail.len() as f64
        };
        let begin = record::begin(&deviator);
        let plastic = record::plastic(&course.axial, &deviator);
        let dilatancy =
            plastic.and_then(|places| record::dilatancy(&course.axial, &course.area, places));
        let reference = sand::reference_modulus(SHEAR_MODULUS, POISSON, course.density);
        Self {
            friction: mobilised(peak).to_degrees(),
            failing: mean(&mobilised).to_degrees(),
            poisson: found(
                begin.and_then(|places| record::poisson(&course.axial, &course.area, places)),
            ),
            dilatancy: found(dilatancy).to_degrees(),
            young: found(record::secant_50(&course.axial, &deviator)) / 1e6,
            theory: sand::young(reference, 1.5 * pressure) / 1e6,
            contacts: [course.coordination[0], mean(&|place| course.coordination[place])],
        }
    }
}

/// Sand of B table 1, compacted with a friction and brought to a stress \[Pa\] without any.
fn pack(seed: u64, compaction: f64, pressure: f64) -> Pack {
    let more = match pressure {
        1e5 => String::new(),
        _ => format!("\n  prepare: [isotropic: {{confining_stress: {pressure:e}}}]"),
    };
    let text = format!(
        "  generate: {{grains: 1000, radius: {{grading_a: {{mean: 0.1e-3, ratio: 4.0}}}}, \
         material: sand, seed: {seed}, confining_stress: 1.0e5, aspect: [1, 2.5, 1], \
         compaction_friction: {compaction}}}{more}"
    );
    made(&scene(&text, CONTACT, ""))
}

const CONTACT: &str = "{friction: {coefficient: 0.6}}";

/// A biaxial test of `pack` with the coefficient `friction`, as YAML has it.
fn biaxial(pack: &Pack, pressure: f64, friction: &str, rotation: &str, strain: f64) -> Course {
    let mut rig = rig(pack, friction, rotation);
    rig.press(Some(pressure), |course| course.strain() >= strain - 1e-9)
}

fn rig(pack: &Pack, friction: &str, rotation: &str) -> Rig {
    let contact = match friction {
        "0" => format!("{{rotation: {rotation}}}"),
        _ => format!("{{friction: {{coefficient: {friction}}}, rotation: {rotation}}}"),
    };
    let loaded = scene("  file: none.csv", &contact, "");
    let mut pack = pack.clone();
    let coefficient =
        if friction == ".inf" { f64::INFINITY } else { friction.parse().unwrap_or(0.0) };
    for grain in &mut pack.grains {
        grain.friction = coefficient;
    }
    Rig::new(&loaded.scene, &pack)
}

/// Runs and prints the tests.
pub(crate) fn run(seeds: &[u64]) {
    let dense: Vec<Pack> = seeds.iter().map(|&seed| pack(seed, 0.0, PRESSURES[0])).collect();
    let loose: Vec<Pack> = seeds.iter().map(|&seed| pack(seed, 0.6, PRESSURES[0])).collect();
    compression(&dense);
    pressures(seeds, &dense);
    densities(&dense, &loose);
    frictions(&dense);
    rotations(&dense[0]);
}

/// Tables 3 and 4, in equilibrium and as B does them: increments end with so many sweeps (2.3, table 1).
fn pressures(seeds: &[u64], dense: &[Pack]) {
    println!("\nBiaxial tests on dense sand (B tables 3 and 4):\n");
    println!(
        "| σ3 [bar] | sweeps | φ' peak [°] | φ' beyond 2 % [°] | ν | ψ [°] | E50 [MPa] | A.89 [MPa] | contacts a grain | beyond 2 % |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (pressure, book) in PRESSURES.into_iter().zip(BOOK) {
        let packs: Vec<Pack> = match pressure == PRESSURES[0] {
            true => dense.to_vec(),
            false => seeds.iter().map(|&seed| pack(seed, 0.0, pressure)).collect(),
        };
        let of = |course: &Course| Biaxial::of(course, pressure);
        let tests: Vec<Biaxial> =
            packs.iter().map(|pack| of(&biaxial(pack, pressure, "0.6", "free", STRAIN))).collect();
        pressed(pressure, "until equilibrium", &tests);
        let sweeps: &[u32] = if pressure == PRESSURES[0] { &[50, 20] } else { &[20] };
        for sweeps in sweeps {
            let tests: Vec<Biaxial> =
                packs.iter().map(|pack| of(&swept(pack, pressure, *sweeps))).collect();
            pressed(pressure, &sweeps.to_string(), &tests);
        }
        let [friction, poisson, dilatancy, young, theory] = book;
        println!(
            "| {:.0} | B, 20 | {friction} | | {poisson} | {dilatancy} | {young} | {theory} | | |",
            pressure / 1e5
        );
    }
}

fn pressed(pressure: f64, sweeps: &str, tests: &[Biaxial]) {
    let all = |of: fn(&Biaxial) -> f64, digits| spread(tests.iter().map(of), digits);
    println!(
        "| {:.0} | {sweeps} | {} | {} | {} | {} | {} | {} | {} | {} |",
        pressure / 1e5,
        all(|t| t.friction, 1),
        all(|t| t.failing, 1),
        all(|t| t.poisson, 2),
        all(|t| t.dilatancy, 1),
        all(|t| t.young, 1),
        all(|t| t.theory, 1),
        all(|t| t.contacts[0], 2),
        all(|t| t.contacts[1], 2),
    );
}

/// A biaxial test of increments that end with so many `sweeps` and no equilibrium.
fn swept(pack: &Pack, pressure: f64, sweeps: u32) -> Course {
    let contact = "{friction: {coefficient: 0.6, update: current}}";
    let solver = format!("method: gauss_seidel, sweeps: {sweeps}");
    let loaded = scene("  file: none.csv", contact, &solver);
    Rig::new(&loaded.scene, pack).press(Some(pressure), |course| course.strain() >= STRAIN - 1e-9)
}

/// Figures 13 and 15.
fn densities(dense: &[Pack], loose: &[Pack]) {
    println!("\nDensity, σ3 = 1 bar (B figures 13 and 15):\n");
    println!(
        "| sample | φ' peak [°] | φ' beyond 2 % [°] | ψ [°] | E50 [MPa] | contacts a grain | beyond 2 % |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (name, packs) in [("dense", dense), ("loose", loose)] {
        row(name, packs, "0.6");
    }
}

/// Figure 17.
fn frictions(dense: &[Pack]) {
    println!("\nFriction between the grains, dense, σ3 = 1 bar (B figure 17):\n");
    println!(
        "| f_gg | φ' peak [°] | φ' beyond 2 % [°] | ψ [°] | E50 [MPa] | contacts a grain | beyond 2 % |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for friction in ["0.1", "0.3", "0.6", "1.0", ".inf"] {
        row(friction, dense, friction);
    }
}

fn row(name: &str, packs: &[Pack], friction: &str) {
    let tests: Vec<Biaxial> = packs
        .iter()
        .map(|pack| {
            Biaxial::of(&biaxial(pack, PRESSURES[0], friction, "free", STRAIN), PRESSURES[0])
        })
        .collect();
    print(name, &tests);
}

fn print(name: &str, tests: &[Biaxial]) {
    let all = |of: fn(&Biaxial) -> f64, digits| spread(tests.iter().map(of), digits);
    println!(
        "| {name} | {} | {} | {} | {} | {} | {} |",
        all(|t| t.friction, 1),
        all(|t| t.failing, 1),
        all(|t| t.dilatancy, 1),
        all(|t| t.young, 1),
        all(|t| t.contacts[0], 2),
        all(|t| t.contacts[1], 2),
    );
}

/// Table 6 and the right half of figure 22.
fn compression(dense: &[Pack]) {
    println!("\nOne-dimensional compression from 1 to 6 bar (B table 6):\n");
    let (mut begin, mut end, mut theory) = (vec![], vec![], vec![]);
    for pack in dense {
        let mut rig = rig(pack, "0.6", "free");
        let course = rig.press(None, |course| course.pressed() >= HIGHEST);
        let places = course.axial.len();
        let first = course.major.iter().position(|&s| s >= 1.5e5).unwrap_or(places);
        let last = course.major.iter().position(|&s| s >= 5e5).unwrap_or(places);
        begin.push(found(record::slope(&course.major, &course.minor, 0..first)));
        end.push(found(record::slope(&course.major, &course.minor, last..places)));
        let reference = sand::reference_modulus(SHEAR_MODULUS, POISSON, course.density);
        let mean = (course.minor[places - 1] - course.minor[0])
            / (course.major[places - 1] - course.major[0]);
        let predicted = sand::compression(reference, mean, course.major[0], course.strain());
        theory.push(course.pressed() / predicted);
        println!(
            "    strain {:.5} to {:.0} kPa, mean coefficient {mean:.3}",
            course.strain(),
            course.pressed() / 1e3
        );
    }
    println!(
        "    σ̇3/σ̇1 up to 1.5 bar {}, B 0.18; beyond 5 bar {}, B 0.35 at the end",
        spread(begin, 2),
        spread(end, 2)
    );
    println!("    σ1 over that of A.22 and A.89 {}", spread(theory, 2));
}

/// Figure 18.
fn rotations(dense: &Pack) {
    println!("\nRotations, dense, first seed, σ3 = 1 bar (B figure 18):\n");
    println!(
        "| rotations | σ1/σ3 at 1 % | σ1/σ3 at the end | strain there | ε3 over ε1 there | σ̇3/σ̇1 in compression to 6 bar |"
    );
    println!("| --- | --- | --- | --- | --- | --- |");
    for rotation in ["free", "locked"] {
        let test = biaxial(dense, PRESSURES[0], "0.6", rotation, 2e-2);
        let end = test.axial.len() - 1;
        let one = test.axial.iter().position(|&strain| strain >= 1e-2).unwrap_or(end);
        let mut rig = rig(dense, "0.6", rotation);
        let press = rig.press(None, |course| course.pressed() >= HIGHEST);
        println!(
            "| {rotation} | {:.2} | {:.2} | {:.4} | {:.3} | {:.3} |",
            test.major[one] / test.minor[one],
            test.major[end] / test.minor[end],
            test.axial[end],
            test.area[end] / test.axial[end] - 1.0,
            found(record::slope(&press.major, &press.minor, 0..press.major.len())),
        );
    }
}
