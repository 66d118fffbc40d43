//! T A.2.2: cemented packs in two linear steps against the same laws solved in the geometry at the
//! end of the increment, on the thesis' uniaxial path (T 4.8.1).

use std::path::Path;

use graintwin::command::{Ask, Command, Mode, Stamp};
use graintwin::measure::moduli;
use graintwin::model::Model;
use graintwin::pack::{Pack, generate};
use graintwin::relax::{Effort, Workspace, rattlers};
use graintwin::report::{Demand, Measures};
use graintwin::scene::{self, Scene};
use graintwin::state::State;
use graintwin::twin::Twin;
use graintwin::wall;

/// Grains of a pack, of quartz, cemented at 10 MPa.
const GRAINS: usize = 500;
const STRESS: f64 = 10e6;

/// Laws of the contacts, as T 4.8.3 compares them.
const LAWS: [&str; 4] =
    ["fixed", "linear_elastic", "{power: {eta: 1111, omega: 1}}", "{exponential: {gamma: 3000}}"];

/// Axial strain at the end, and of the increments there.
const END: f64 = 1e-3;
const INCREMENTS: [f64; 3] = [5e-5, 1e-4, 5e-4];

/// Axial strain over which E is taken.
const WINDOW: f64 = 5e-4;

/// Axial strain where single increments begin, and theirs.
const BEGIN: f64 = 5e-4;
const SINGLE: [f64; 5] = [2.5e-5, 5e-5, 1e-4, 2e-4, 4e-4];

/// Lateral over axial strain.
const EXPANSION: f64 = -0.25;

const SOLUTIONS: [&str; 2] = ["two_step", "nonlinear"];

/// Where a path ended.
struct Ended {
    pack: Pack,
    /// Normal forces on the walls \[N\].
    forces: [f64; wall::COUNT],
    /// E over the last [`WINDOW`] \[Pa\].
    young: f64,
    /// Largest residual on the way.
    residual: f64,
    increments: f64,
    effort: Effort,
}

/// Runs the packs of `seeds` and prints the tables.
pub(crate) fn run(seeds: &[u64]) {
    let packs: Vec<Pack> = seeds.iter().map(|&seed| packed(seed)).collect();
    println!("\n## Two linear steps, {GRAINS} grains, seeds {seeds:?}\n");
    println!(
        "| law | increment | wall forces apart by | E two steps (GPa) | E nonlinear (GPa) | \
         residual | of the law | products | evaluations |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for law in LAWS {
        for increment in INCREMENTS {
            path(&packs, law, increment);
        }
    }
    println!(
        "\n| law | increment | apart by, of the forces at the start | order |\n| --- | --- | --- | --- |"
    );
    for law in LAWS {
        single(&packs, law);
    }
}

/// One row: a path to [`END`].
fn path(packs: &[Pack], law: &str, increment: f64) {
    let ended: Vec<[Ended; 2]> = (packs.iter())
        .map(|pack| SOLUTIONS.map(|solution| walk(&cemented(law, solution), pack, END, increment)))
        .collect();
    let mean =
        |of: &dyn Fn(&[Ended; 2]) -> f64| ended.iter().map(of).sum::<f64>() / ended.len() as f64;
    let most = |of: &dyn Fn(&[Ended; 2]) -> f64| ended.iter().map(of).fold(0.0, f64::max);
    let per = |count: fn(&Effort) -> u64, which: usize| {
        mean(&move |both| count(&both[which].effort) as f64 / both[which].increments)
    };
    let scene = cemented(law, "nonlinear");
    println!(
        "| {law} | {increment:.1e} | {:.1e} | {:.3} | {:.3} | {:.1e} | {:.1e} | {:.0} / {:.0} | \
         {:.0} / {:.0} |",
        most(&|[two, non]| apart(&two.forces, &non.forces, &non.forces)),
        mean(&|[two, _]| two.young / 1e9),
        mean(&|[_, non]| non.young / 1e9),
        most(&|[two, _]| two.residual),
        most(&|[two, _]| residual_of_law(&scene, &two.pack)),
        per(|effort| effort.products, 0),
        per(|effort| effort.products, 1),
        per(|effort| effort.gradients, 0),
        per(|effort| effort.gradients, 1),
    );
}

/// The rows of single increments from one equilibrium.
fn single(packs: &[Pack], law: &str) {
    let begun: Vec<Ended> = (packs.iter())
        .map(|pack| walk(&cemented(law, "nonlinear"), pack, BEGIN, INCREMENTS[0]))
        .collect();
    let mut before: Option<f64> = None;
    for increment in SINGLE {
        let most = begun.iter().map(|begun| {
            let [two, non] = SOLUTIONS.map(|solution| {
                let scene = cemented(law, solution);
                walk(&scene, &begun.pack, increment, increment).forces
            });
            apart(&two, &non, &begun.forces)
        });
        let most = most.fold(0.0, f64::max);
        let order = before.map_or("".into(), |before| format!("{:.2}", (most / before).log2()));
        println!("| {law} | {increment:.1e} | {most:.2e} | {order} |");
        before = Some(most);
    }
}

/// The grains of `seed` pressed without friction.
fn packed(seed: u64) -> Pack {
    let text = format!(
        "pack: {{generate: {{grains: {GRAINS}, radius: {{uniform: [0.07e-3, 0.13e-3]}}, \
         material: quartz, seed: {seed}, confining_stress: {STRESS:e}}}}}"
    );
    let scene = scene::parse(&text, Path::new("two_step.yaml")).expect("the scene is right");
    let spec = scene.pack.generate.as_ref().expect("the scene asks for it");
    let quartz = &scene.materials[&spec.material];
    generate::generate(spec, quartz, &scene.walls, 0.0, scene.solver).expect("the pack is found")
}

/// Cement of the law `law`, whose increments are never cut.
fn cemented(law: &str, solution: &str) -> Scene {
    let text = format!(
        "pack: {{file: none.csv, material: quartz}}\n\
         contact: {{normal: {{cement: {{law: {law}, solution: {solution}}}}}}}\n\
         solver: {{max_strain_increment: 0.1, max_overlap_share: 100}}"
    );
    scene::parse(&text, Path::new("two_step.yaml")).expect("the scene is right")
}

/// Strains `pack` to the axial strain `to`.
fn walk(scene: &Scene, pack: &Pack, to: f64, increment: f64) -> Ended {
    let mut twin = Twin::new(scene, pack, 1).expect("the pack has grains");
    let started = twin.start(Demand::ALL);
    let before = twin.effort();
    let count = (to / increment).round() as u64;
    let mut course = vec![started.measures.expect("the pack is in equilibrium")];
    let mut residual = 0.0_f64;
    for sequence in 1..=count {
        let strain = increment * sequence as f64;
        let sides = pack.bounds.sides();
        let share = |w: usize| if wall::axis(w) == 2 { 0.5 } else { 0.5 * EXPANSION };
        let displacement = std::array::from_fn(|w| share(w) * strain * sides[wall::axis(w)]);
        let command = Command {
            stamp: Stamp::default(),
            session: "two steps".into(),
            sequence,
            mode: Mode::Absolute,
            ask: Ask::Displacement(displacement),
            age: None,
        };
        let report = twin.apply(&command, Demand::ALL);
        let measures = report.measures.expect("the increment is found");
        residual = residual.max(measures.state.expect("it was demanded").residual);
        course.push(measures);
    }
    let last = &course[course.len() - 1];
    let window = (WINDOW / increment).round() as usize;
    let first = &course[course.len().saturating_sub(1 + window)];
    let after = twin.effort();
    Ended {
        pack: twin.pack(),
        forces: last.walls.normal_force,
        young: young(first, last),
        residual,
        increments: count as f64,
        effort: Effort {
            gradients: after.gradients - before.gradients,
            products: after.products - before.products,
        },
    }
}

/// E between two states \[Pa\].
fn young(first: &Measures, last: &Measures) -> f64 {
    let [a, b] = [first, last].map(|measures| measures.state.expect("it was demanded"));
    let stress = [0, 4, 8].map(|k| b.stress_walls[k] - a.stress_walls[k]);
    let strain = [0, 1, 2].map(|k| b.strain[k] - a.strain[k]);
    moduli::secant(stress, strain, 1.0).young
}

/// Largest difference of the wall forces `a` and `b` over the largest of `unit`.
fn apart(a: &[f64; wall::COUNT], b: &[f64; wall::COUNT], unit: &[f64; wall::COUNT]) -> f64 {
    let largest = unit.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

/// Residual of `pack` where the law gives the normal force for each distance.
fn residual_of_law(scene: &Scene, pack: &Pack) -> f64 {
    let model = Model::new(pack, scene);
    let mut state = State::new(&model);
    state.recall(&model, pack.history.as_ref().expect("it is cemented"));
    let mut work = Workspace::new(&model);
    work.start(&model, &state);
    rattlers::find(&model, &mut state, &mut work);
    work.evaluate(&model, &state, &state.bounds(&model));
    work.balance.largest() / work.balance.sums.mean_force()
}
