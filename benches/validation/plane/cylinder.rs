//! Thick-walled cylinders of sandstone (B 4.4): table 12.

use graintwin::analytic::cylinder::{edge_effect, failure_pressure};
use graintwin::analytic::strength::MohrCoulomb;
use graintwin::command::Disposition;
use graintwin::pack::Pack;
use graintwin::report::{BondCondition, Bonds, Crack, Demand, Grains};
use graintwin::wall::WallTarget::{Displacement, Keep};

use super::rig::{Rig, made, surrounded};
use super::{DIAMETER, spread};

/// k_n \[N/m\] and c_μ \[Pa\] (B table 8).
const STIFFNESS: f64 = 1e6;
const COHESION: f64 = 1e8;
/// Stress of the sample while it was made \[Pa\].
const MADE: f64 = 1e6;
/// a/b (35).
const RATIO: f64 = 1.0 / 3.0;
/// Share of the area that the grains fill.
const SOLID: f64 = 0.85;
/// Mean of the squares of the radii over the square of their mean, of both gradings with M = 4.
const SQUARES: f64 = 1.12;
/// Strain of the outer radius in an increment and at the end.
const STEP: f64 = 5e-5;
const STRAIN: f64 = 1.6e-2;
/// The cylinder has failed where this share of the bonds in this share of the area, at the hole, is broken
/// (4.4.2).
const AREA: f64 = 0.1;
const BROKEN: f64 = 0.01;
/// φ' of the sandstone \[°\] and c' of gradings A and B \[Pa\] (B table 11).
const FRICTION: f64 = 22.0;
const STRENGTHS: [f64; 2] = [9.3e6, 9.6e6];
/// B table 12: grains, grading, pressures at failure and breakout \[MPa\].
const BOOK: &str = "B: 4000 grains of B 15.3 and 29.7 MPa, 10000 of A 15.7 and 30.2 MPa; 11.2 MPa make \
                    two opposite breakouts in 10000 with half of the strength along x.";

/// What a test tells: pressures on the outer wall \[Pa\].
struct Test {
    /// Inner radius \[m\].
    inner: f64,
    /// At the first crack.
    first: f64,
    /// Where the cylinder has failed at the hole.
    failure: f64,
    /// Where grains break out of the wall of the hole.
    breakout: f64,
    /// Share of the bonds that were broken then.
    broken: f64,
    /// Of all cracks until then: the share that broke while pulled, and that whose bond was nearer to the
    /// radius than to the circle, so that the crack lies along the surface.
    pulled: f64,
    along_surface: f64,
    /// Share of the cracks until failure, and until breakout, that are nearer to the x-axis through the hole
    /// than to the y-axis.
    opposite: [f64; 2],
    /// Pressure over the strain of the outer radius, at first \[Pa\].
    stiffness: f64,
}

/// Runs and prints the tests.
pub(crate) fn run(seeds: &[u64]) {
    println!("\nThick-walled cylinders (B table 12), pressures in MPa:\n");
    println!(
        "| grains | grading | along x | by (36) | by (37) | first crack | failure | breakout | broken then [%] | pulled | along the surface | left and right of the hole, at failure | at breakout | dP/dε [GPa] |"
    );
    println!(
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    );
    for (grains, grading, along_x) in
        [(1000, "A", 1.0), (1000, "B", 1.0), (4000, "B", 1.0), (1000, "A", 0.5), (4000, "A", 0.5)]
    {
        let seeds = if grains > 1000 { &seeds[..1] } else { seeds };
        let tests: Vec<Test> =
            seeds.iter().map(|&seed| test(seed, grains, grading, along_x)).collect();
        let cohesion = STRENGTHS[usize::from(grading == "B")];
        let material = MohrCoulomb { friction: FRICTION.to_radians(), cohesion };
        let theory = failure_pressure(&material, RATIO);
        let edge = edge_effect(material.friction, DIAMETER / tests[0].inner);
        let all = |of: &dyn Fn(&Test) -> f64, digits| spread(tests.iter().map(of), digits);
        println!(
            "| {grains} | {grading} | {along_x} | {:.1} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            theory / 1e6,
            edge.map_or("-".into(), |edge| format!("{:.1}", edge * theory / 1e6)),
            all(&|t| t.first / 1e6, 1),
            all(&|t| t.failure / 1e6, 1),
            all(&|t| t.breakout / 1e6, 1),
            all(&|t| 1e2 * t.broken, 2),
            all(&|t| t.pulled, 2),
            all(&|t| t.along_surface, 2),
            all(&|t| t.opposite[0], 2),
            all(&|t| t.opposite[1], 2),
            all(&|t| t.stiffness / 1e9, 2),
        );
    }
    println!("\n{BOOK}");
}

fn test(seed: u64, grains: u32, grading: &str, along_x: f64) -> Test {
    // What `grains` fill between both circles.
    let area = f64::from(grains) * SQUARES * 0.25 * DIAMETER * DIAMETER / SOLID;
    let inner = (area / (RATIO.powi(-2) - 1.0)).sqrt();
    let generate = format!(
        "  generate: {{grains: {grains}, radius: {{grading_{}: {{mean: 0.1e-3, ratio: 4.0}}}}, \
         material: sand, seed: {seed}, confining_stress: {MADE:e}}}",
        grading.to_lowercase()
    );
    let walls = format!("friction: 0.0, cell: {{annulus: {{inner: {inner:e}}}}}, open: [x_min]");
    let contact = format!(
        "{{normal: {{linear: {{stiffness: {STIFFNESS:e}, bond: {{cohesion: {COHESION:e}, \
         along_x: {along_x}}}}}}}, friction: {{coefficient: 0.6}}}}"
    );
    let loaded = surrounded(&generate, &walls, &contact, "max_overlap_share: 100.0");
    let pack = made(&loaded);
    press(&mut Rig::new(&loaded.scene, &pack), &pack, inner)
}

fn press(rig: &mut Rig, pack: &Pack, inner: f64) -> Test {
    let outer = 0.5 * pack.bounds.sides()[0];
    let edge = (inner * inner + AREA * (outer * outer - inner * inner)).sqrt();
    let mut test = Test {
        inner,
        first: f64::NAN,
        failure: f64::NAN,
        breakout: f64::NAN,
        broken: f64::NAN,
        pulled: f64::NAN,
        along_surface: f64::NAN,
        opposite: [f64::NAN; 2],
        stiffness: f64::NAN,
    };
    let mut cracks: Vec<Crack> = Vec::new();
    let begin = rig.last.stress_walls[0];
    let demand = Demand { state: true, cracks: true, bonds: true, grains: true, ..Demand::NONE };
    for step in 1..=(STRAIN / STEP) as u32 {
        let way = Displacement(STEP * f64::from(step) * outer);
        let report = rig.go([Keep, way, Keep, Keep, Keep, Keep], demand);
        if report.disposition != Disposition::Applied {
            println!("    {:?}: {}", report.disposition, report.text);
            continue;
        }
        let measures = report.measures.expect("it was served");
        let pressure = rig.last.stress_walls[0];
        let (Some(bonds), Some(grains)) = (&measures.bonds, &measures.grains) else { break };
        cracks.extend(measures.cracks.into_iter().flat_map(|cracks| cracks.list));
        if step == 10 {
            test.stiffness = (pressure - begin) / (STEP * f64::from(step));
        }
        if test.first.is_nan() && !cracks.is_empty() {
            test.first = pressure;
        }
        if test.failure.is_nan() && broken_within(bonds, edge) >= BROKEN {
            (test.failure, test.opposite[0]) = (pressure, opposite(&cracks));
        }
        if breaks_out(bonds, grains, inner) {
            test.breakout = pressure;
            test.broken = cracks.len() as f64 / bonds.first.len() as f64;
            let share = |of: &dyn Fn(&Crack) -> bool| {
                cracks.iter().filter(|crack| of(crack)).count() as f64 / cracks.len() as f64
            };
            test.pulled = share(&|crack| crack.normal_force < 0.0);
            test.along_surface = share(&|crack| {
                let [x, y, _] = crack.position;
                let radial = (crack.normal[0] * x + crack.normal[1] * y) / x.hypot(y);
                radial.abs() > 0.5_f64.sqrt()
            });
            test.opposite[1] = opposite(&cracks);
            break;
        }
    }
    test
}

/// Share of the bonds inside of the radius `edge` \[m\] that are broken.
fn broken_within(bonds: &Bonds, edge: f64) -> f64 {
    let places = bonds.position.chunks_exact(3);
    let near = places.zip(&bonds.condition).filter(|(at, _)| at[0].hypot(at[1]) < edge);
    let (all, broken) = near.fold((0_u32, 0_u32), |(all, broken), (_, &condition)| {
        (all + 1, broken + u32::from(condition != BondCondition::Intact as u8))
    });
    f64::from(broken) / f64::from(all.max(1))
}

/// Whether grains that were bonded at the hole have come into it by more than half of a mean diameter: the
/// first cluster breaks out of the wall.
fn breaks_out(bonds: &Bonds, grains: &Grains, inner: f64) -> bool {
    let bonded = bonds.first.iter().chain(&bonds.second).map(|&grain| grain as usize);
    bonded.into_iter().any(|grain| {
        let ([x, y, _], [dx, dy, _]) = (grains.position[grain], grains.displacement[grain]);
        let (now, then) = (x.hypot(y), (x - dx).hypot(y - dy));
        now < inner && then - now > 0.5 * DIAMETER
    })
}

/// Share of `cracks` that lie nearer to the x-axis through the hole than to the y-axis.
fn opposite(cracks: &[Crack]) -> f64 {
    let aside = cracks.iter().filter(|crack| crack.position[0].abs() > crack.position[1].abs());
    aside.count() as f64 / cracks.len() as f64
}
