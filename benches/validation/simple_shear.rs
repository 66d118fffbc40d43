//! Simple shear of sand: B table 7, figures 29 to 32.

use std::path::Path;

use graintwin::analytic::fit::record::{peak, secant_50};
use graintwin::analytic::fit::strength::mobilised;
use graintwin::analytic::flow::dilatancy;
use graintwin::analytic::sand::young;
use graintwin::analytic::tensor::Tensor;
use graintwin::command::{Ask, Command, Disposition, Mode, Shear, Stamp};
use graintwin::pack::{self, Pack};
use graintwin::report::{self, Demand};
use graintwin::scene::{self, Loaded, Scene};
use graintwin::twin::Twin;
use graintwin::wall::WallTarget;

/// σxx and σyy of the tests \[Pa\].
const TESTS: [(&str, [f64; 2]); 2] = [("I", [1e5, 1e5]), ("II", [1e5, 2e5])];
/// B table 7: G \[MPa\], φ' and ψ \[°\].
const BOOK: [[f64; 3]; 2] = [[18.1, 28.6, 16.9], [16.7, 32.4, 14.5]];
/// Steps of the tilt: finer where the sand is elastic.
const STEPS: [(f64, u32); 2] = [(0.01, 50), (0.05, 100)];

/// What a test tells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheared {
    /// G at half of the strength, at a mean stress of 1 bar \[Pa\].
    modulus: f64,
    /// φ' at the peak, of the walls and of the grains in the middle \[rad\].
    friction: [f64; 2],
    /// ψ of the second half of the tilt \[rad\].
    dilatancy: f64,
    /// γ_μ/γ of the second half.
    rotation: f64,
    /// β of stress and strain at the end \[rad\].
    directions: [f64; 2],
}

fn scene(seed: u64) -> Scene {
    let text = format!(
        "dimension: 2\nmaterials: {{sand: {{young: 2.32e9, poisson: 0.16, density: 2650.0}}}}\n\
         pack:\n  generate: {{grains: 1000, radius: {{grading_a: {{mean: 0.1e-3, ratio: 4.0}}}}, \
         material: sand, seed: {seed}, confining_stress: 1.0e5, aspect: [1, 1, 1]}}\n\
         walls: {{friction: .inf, glue: true}}\ncontact: {{friction: {{coefficient: 0.6}}}}"
    );
    scene::parse(&text, Path::new("validation.yaml")).expect("the scene is right")
}

/// Both tests of the sample `seed`.
pub(crate) fn run(seed: u64) -> [Sheared; 2] {
    let scene = scene(seed);
    let loaded = Loaded { scene: scene.clone(), file: "validation.yaml".into() };
    let pack = pack::build(&loaded).expect("the pack is found");
    TESTS.map(|(_, stress)| sheared(&scene, &pack, stress))
}

/// Shears `pack` at constant σxx and σyy \[Pa\].
pub(crate) fn sheared(scene: &Scene, pack: &Pack, stress: [f64; 2]) -> Sheared {
    let mut twin = Twin::new(scene, pack, 1).expect("the pack has grains");
    twin.start(Demand::NONE);
    let [x, y] = stress.map(WallTarget::Stress);
    let targets = [x, x, y, y, WallTarget::Keep, WallTarget::Keep];
    let mut sequence = 0;
    let mut ask = |ask: Ask| {
        sequence += 1;
        let (stamp, session) = (Stamp::default(), "shear".into());
        let command = Command { stamp, session, sequence, mode: Mode::Absolute, ask, age: None };
        let demand = Demand { state: true, shear: true, ..Demand::NONE };
        let report = twin.apply(&command, demand);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        let measures = report.measures.expect("it was applied");
        let [xx, xy, _, yx, yy, ..] = measures.state.expect("it was asked for").stress_walls;
        let shear = measures.shear.expect("it was asked for");
        (shear, Tensor { xx, yy, xy: 0.5 * (xy + yx) })
    };
    let mut course = vec![ask(Ask::Targets(targets))];
    let mut from = 0.0;
    for (tilt, increments) in STEPS {
        for k in 1..=increments {
            let tilt = from + tilt * f64::from(k) / f64::from(increments);
            course.push(ask(Ask::Shear(Shear { tilt, targets })));
        }
        from += tilt;
    }
    read(&course, 0.5 * stress.iter().sum::<f64>())
}

fn read(course: &[(report::Shear, Tensor)], mean: f64) -> Sheared {
    let tilts: Vec<f64> = course.iter().map(|(shear, _)| shear.tilt).collect();
    let shear_stress: Vec<f64> = course.iter().map(|(_, stress)| -stress.xy).collect();
    let friction = |of: &dyn Fn(&(report::Shear, Tensor)) -> Tensor| {
        let angle = |one| mobilised(of(one).major(), of(one).minor()).unwrap_or(f64::NAN);
        let angles: Vec<f64> = course.iter().map(angle).collect();
        peak(&angles).map_or(f64::NAN, |place| angles[place])
    };
    let (middle, end) = (&course[course.len() / 2].0, &course[course.len() - 1].0);
    let strain = tensor(end.strain).since(&tensor(middle.strain));
    Sheared {
        modulus: secant_50(&tilts, &shear_stress).unwrap_or(f64::NAN) / young(1.0, mean),
        friction: [
            friction(&|(_, walls)| *walls),
            friction(&|(shear, _)| tensor(shear.inner_stress)),
        ],
        dilatancy: dilatancy(strain.major(), strain.minor()).unwrap_or(f64::NAN),
        rotation: (middle.mean_rotation - end.mean_rotation) / (end.tilt - middle.tilt),
        directions: [end.stress_direction, end.strain_direction],
    }
}

fn tensor([xx, xy, yx, yy]: [f64; 4]) -> Tensor {
    Tensor { xx, yy, xy: 0.5 * (xy + yx) }
}

/// Prints the table of the documentation.
pub(crate) fn print(all: &[[Sheared; 2]]) {
    println!("\nSimple shear of sand (B table 7):\n");
    println!(
        "| test | G MPa | B | φ' walls | φ' middle | B | ψ | B | γμ/γ | β stress | β strain |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (k, ((name, _), book)) in TESTS.iter().zip(BOOK).enumerate() {
        let spread = |of: &dyn Fn(&Sheared) -> f64| {
            let values: Vec<f64> = all.iter().map(|tests| of(&tests[k])).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let (low, high) =
                values.iter().fold((f64::MAX, f64::MIN), |(l, h), &v| (l.min(v), h.max(v)));
            format!("{mean:.2} [{low:.2}, {high:.2}]")
        };
        println!(
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            spread(&|test| test.modulus * 1e-6),
            book[0],
            spread(&|test| test.friction[0].to_degrees()),
            spread(&|test| test.friction[1].to_degrees()),
            book[1],
            spread(&|test| test.dilatancy.to_degrees()),
            book[2],
            spread(&|test| test.rotation),
            spread(&|test| test.directions[0].to_degrees()),
            spread(&|test| test.directions[1].to_degrees()),
        );
    }
}
