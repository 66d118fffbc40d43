//! What loads cost: increments with standing walls, and with walls whose positions are unknowns of
//! the equilibrium or are found by a loop around it. `cargo bench --bench loads
//! --no-default-features`
//!
//! Every row walks ten increments of an axial strain of 1e-4 of the benchmark pack at 10 MPa, one
//! thread: at lateral walls that stand, or at lateral walls that keep their stress. The loop around
//! the equilibrium is Broyden's method on the two lateral stresses, which begins each increment with
//! the stiffness that it knows from the last; its relaxations start from the last equilibrium. The
//! last columns are the largest error of a lateral stress, relative, and the axial stress at the
//! end.
#![allow(clippy::print_stdout, clippy::expect_used)] // A bench prints, and ends when its input is not there.

use std::path::Path;
use std::time::Instant;

use nalgebra::{Matrix2, Vector2};

use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::{self, Pack};
use graintwin::relax::advance::advance;
use graintwin::relax::{Outcome, Workspace, relax};
use graintwin::scene::{self, Coulomb, Friction, Law, Scene, Update};
use graintwin::state::State;
use graintwin::wall::{self, Control, Load, Setpoint, standing};

const INCREMENTS: usize = 10;
/// Name of the row whose lateral walls are asked for no stress.
const STAND: &str = "stand";
/// Lateral stress \[Pa\], and how close the loop comes to it.
const STRESS: f64 = 1e7;
const CLOSE: f64 = 1e-8;
/// Most relaxations of the loop in one increment.
const MOST: usize = 60;

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let job = scene::load(&root.join("tests/data/g2740.yaml")).expect("it is shipped");
    let pack = pack::build(&job).expect("the benchmark pack is in tests/data");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    println!("2740 grains at 10 MPa, axial increments of 1e-4, tolerance 1e-8, medians of ten");
    println!(
        "friction  lateral walls   ms  relaxations  balances  products  stress off  axial [MPa]"
    );
    for coefficient in [0.0, 0.3] {
        let rows: [(&str, Walk); 3] =
            [(STAND, stand), ("carry a load", carry), ("in a loop", in_a_loop)];
        for (name, walk) in rows {
            let (scene, pack) = with_friction(&job.scene, &pack, coefficient);
            let row = pool.install(|| Row::of(&Model::new(&pack, &scene), walk));
            println!(
                "{coefficient:<8}  {name:<12} {:5.1}  {:11.0}  {:8.0}  {:8.0}  {:>10}  {:11.4}",
                median(&row.times),
                median(&row.relaxations),
                median(&row.balances),
                median(&row.products),
                if name == STAND { "-".into() } else { format!("{:.0e}", row.off) },
                row.axial * 1e-6,
            );
        }
    }
}

fn with_friction(scene: &Scene, pack: &Pack, coefficient: f64) -> (Scene, Pack) {
    let (mut scene, mut pack) = (scene.clone(), pack.clone());
    if coefficient > 0.0 {
        let (law, update) = (Law::ReturnMap, Update::Frozen);
        scene.contact.friction = Friction::Coulomb(Coulomb { coefficient, law, update });
    }
    // Smooth walls: the two of a pair carry the same.
    scene.walls.friction = Some(0.0);
    pack.grains.iter_mut().for_each(|grain| grain.friction = coefficient);
    (scene, pack)
}

/// Where a walk is.
struct Specimen<'a> {
    model: &'a Model,
    state: State,
    work: Workspace,
    here: Outcome,
    /// Lateral stress per lateral strain of the loop \[Pa\].
    stiffness: Option<Matrix2<f64>>,
}

/// Goes to an axial displacement of each wall \[m\]; says how often the pack was relaxed.
type Walk = fn(&mut Specimen<'_>, axial: f64) -> usize;

impl Specimen<'_> {
    fn go(&mut self, setpoint: &Setpoint) {
        let done = advance(self.model, &mut self.state, &mut self.work, setpoint, self.here);
        assert!(done.outcome.status.is_equilibrium(), "{:?}", done.outcome.status);
        self.here = done.outcome;
    }

    fn stress(&mut self) -> [f64; 3] {
        let bounds = self.state.bounds(self.model);
        self.work.neighbours.refresh(self.model, &self.state.position, &bounds);
        let forces = walls::normal_forces(self.model, &self.state, &self.work.neighbours);
        std::array::from_fn(|axis| {
            0.5 * (forces[2 * axis] + forces[2 * axis + 1]) / bounds.area(2 * axis)
        })
    }
}

fn stand(specimen: &mut Specimen<'_>, axial: f64) -> usize {
    specimen.go(&standing(&[0.0, 0.0, 0.0, 0.0, axial, axial]));
    1
}

fn carry(specimen: &mut Specimen<'_>, axial: f64) -> usize {
    let mut setpoint: Setpoint = [Control::Load(Load::Stress(STRESS)); wall::COUNT];
    setpoint[4..].fill(Control::Displacement(axial));
    specimen.go(&setpoint);
    1
}

fn in_a_loop(specimen: &mut Specimen<'_>, axial: f64) -> usize {
    let (start, before) = (specimen.state.clone(), specimen.here);
    let sides = specimen.model.start.sides();
    let at = |d: &Vector2<f64>| {
        let (x, y) = (0.5 * d.x * sides[0], 0.5 * d.y * sides[1]);
        standing(&[x, x, y, y, axial, axial])
    };
    let mut lateral = Vector2::new(
        (start.displacement[0] + start.displacement[1]) / sides[0],
        (start.displacement[2] + start.displacement[3]) / sides[1],
    );
    let mut relaxations = 0;
    let mut off = |specimen: &mut Specimen<'_>, lateral: &Vector2<f64>| {
        specimen.state = start.clone();
        specimen.here = before;
        specimen.go(&at(lateral));
        relaxations += 1;
        let [x, y, _] = specimen.stress();
        Vector2::new(x - STRESS, y - STRESS)
    };
    let mut left = off(specimen, &lateral);
    let mut stiffness = specimen.stiffness.unwrap_or_else(|| {
        let strain = 1e-6;
        Matrix2::from_columns(
            &[Vector2::x(), Vector2::y()]
                .map(|along| (off(specimen, &(lateral + along * strain)) - left) / strain),
        )
    });
    for _ in 0..MOST {
        if left.amax() <= CLOSE * STRESS {
            break;
        }
        let Some(inverse) = stiffness.try_inverse() else { break };
        let step = -inverse * left;
        lateral += step;
        let now = off(specimen, &lateral);
        stiffness += (now - left - stiffness * step) * step.transpose() / step.norm_squared();
        left = now;
    }
    specimen.stiffness = Some(stiffness);
    relaxations
}

/// What a walk cost and where it led.
#[derive(Default)]
struct Row {
    times: Vec<f64>,
    relaxations: Vec<f64>,
    balances: Vec<f64>,
    products: Vec<f64>,
    /// Largest error of a lateral stress over that asked for.
    off: f64,
    /// Axial stress at the end \[Pa\].
    axial: f64,
}

impl Row {
    fn of(model: &Model, walk: Walk) -> Self {
        let (mut state, mut work) = (State::new(model), Workspace::new(model));
        work.start(model, &state);
        let here = relax(model, &mut state, &mut work);
        work.commit(model, &mut state);
        let mut specimen = Specimen { model, state, work, here, stiffness: None };
        let mut row = Self::default();
        for k in 1..=INCREMENTS {
            let before = specimen.work.effort();
            let start = Instant::now();
            row.relaxations
                .push(walk(&mut specimen, 0.5e-4 * k as f64 * model.start.sides()[2]) as f64);
            row.times.push(start.elapsed().as_secs_f64() * 1e3);
            let after = specimen.work.effort();
            row.balances.push((after.gradients - before.gradients) as f64);
            row.products.push((after.products - before.products) as f64);
            let [x, y, z] = specimen.stress();
            row.off = [x, y].map(|s| (s / STRESS - 1.0).abs()).into_iter().fold(row.off, f64::max);
            row.axial = z;
        }
        row
    }
}

fn median(of: &[f64]) -> f64 {
    let mut sorted = of.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    0.5 * (sorted[(sorted.len() - 1) / 2] + sorted[middle])
}
