//! The balance of what surrounds a pack is the derivative of its potential, and its slope that of the
//! balance, by differences.

use graintwin::contact::Other;
use graintwin::contact::neighbours::Neighbours;
use graintwin::model::Model;
use graintwin::pack::{Grain, Pack};
use graintwin::plane::act::Scenery;
use graintwin::plane::balance::Balance;
use graintwin::plane::boundary::{self, Body};
use graintwin::plane::matrix::FREEDOMS;
use graintwin::plane::membrane::Membrane;
use graintwin::plane::pose::Pose;
use graintwin::plane::reference::Reference;
use graintwin::plane::slope::Slope;
use graintwin::scene::Scene;
use graintwin::state::State;
use nalgebra::{DMatrix, Vector2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::discs::*;

/// A pack near its reference.
struct Bench {
    model: Model,
    state: State,
    reference: Reference,
    near: Neighbours,
    bodies: Vec<Body>,
    membranes: Vec<Membrane>,
    pose: Pose,
}

impl Bench {
    fn new(scene: &Scene, pack: &Pack, membranes: Vec<(usize, f64, Vec<usize>)>) -> Self {
        let model = Model::new(pack, scene);
        let state = State::new(&model);
        let mut near = Neighbours::default();
        near.refresh(&model, &state.position, &state.bounds(&model));
        let mut bodies = Vec::new();
        boundary::bodies(&model, &state.displacement, 0.0, &mut bodies);
        let mut reference = Reference::default();
        reference.begin(&model, &state, &near, &bodies, true);
        let place =
            |row: usize| model.order.iter().position(|&g| g as usize == row).unwrap() as u32;
        let cell = &model.plane.as_ref().unwrap().cell;
        let membranes = membranes.into_iter().map(|(side, pressure, chain)| {
            let mut membrane = Membrane::new(cell, side, pressure);
            membrane.chain = chain.into_iter().map(place).collect();
            let b = cell.start;
            let out = membrane.axes[0];
            let ends = match out.x.abs() > 0.5 {
                true => [b.min[1], b.max[1]],
                false => [b.min[0], b.max[0]],
            };
            let sign = membrane.axes[1].x + membrane.axes[1].y;
            let ends = ends.map(|x| x * sign);
            membrane.ends =
                cell.inner.is_none().then(|| [ends[0].min(ends[1]), ends[0].max(ends[1])]);
            membrane
        });
        let membranes = membranes.collect();
        let mut rng = Pcg64::seed_from_u64(3);
        let mut shift = || 2e-3 * RADIUS * (rng.random::<f64>() - 0.5);
        let at = state.position.iter().map(|at| Vector2::new(at.x + shift(), at.y + shift()));
        let at: Vec<_> = at.collect();
        let turn = (0..model.len()).map(|_| shift() / RADIUS).collect();
        Self { pose: Pose { at, turn }, model, state, reference, near, bodies, membranes }
    }

    fn with<T>(&self, bodies: &[Body], of: impl FnOnce(&Scenery<'_>) -> T) -> T {
        of(&Scenery {
            model: &self.model,
            setup: self.model.plane.as_ref().unwrap(),
            reference: &self.reference,
            bodies,
            membranes: &self.membranes,
            carries: &self.state.carries,
            glued: &self.state.glued,
            goes_on: false,
        })
    }

    /// The balance with freedom `k` and side `side` moved on by so much \[m\].
    fn balance(&self, grain: Option<(usize, f64)>, side: Option<(usize, f64)>) -> Balance {
        let mut pose = self.pose.clone();
        if let Some((k, way)) = grain {
            match k % FREEDOMS {
                2 => pose.turn[k / FREEDOMS] += way / self.model.radius[k / FREEDOMS],
                a => pose.at[k / FREEDOMS][a] += way,
            }
        }
        let mut displacement = self.state.displacement;
        if let Some((w, way)) = side {
            displacement[w] += way;
        }
        let mut bodies = Vec::new();
        boundary::bodies(&self.model, &displacement, 0.0, &mut bodies);
        let mut balance = Balance::default();
        self.with(&bodies, |scenery| balance.evaluate(scenery, &pose));
        balance
    }

    fn check(&self) {
        let n = FREEDOMS * self.model.len();
        let here = self.balance(None, None);
        let step = 1e-6 * RADIUS;
        let potential = |b: &Balance| b.potential() + b.pressure_potential;
        let most = here.gradient.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
        assert!(most > 0.0);
        let mut links = Vec::new();
        for membrane in &self.membranes {
            let count = membrane.chain.len();
            let pairs = if membrane.ends.is_some() { count - 1 } else { count };
            links.extend((0..pairs).map(|k| (membrane.chain[k], membrane.chain[(k + 1) % count])));
        }
        let mut slope = Slope::default();
        let positions: Vec<_> = self.pose.at.iter().map(|at| [at.x, at.y]).collect();
        slope.matrix.arrange(&positions, &self.near.start, &self.near.second, |_| true, &links);
        self.with(&self.bodies, |scenery| slope.assemble(scenery, &self.pose, false));
        let mut dense = DMatrix::<f64>::zeros(n, n);
        for (i, block) in slope.matrix.diagonal.iter().enumerate() {
            for (a, row) in block.iter().enumerate() {
                for (b, x) in row.iter().enumerate() {
                    dense[(FREEDOMS * i + a, FREEDOMS * i + b)] += x;
                }
            }
        }
        let pairs = self.reference.pairs.iter().map(|joint| match joint.second {
            Other::Grain(j) => (joint.first, j),
            Other::Wall(_) => unreachable!(),
        });
        let links = links.iter().map(|&(i, j)| (i.min(j), i.max(j)));
        for ((i, j), block) in pairs.chain(links).zip(&slope.matrix.pairs) {
            let (i, j) = (FREEDOMS * i as usize, FREEDOMS * j as usize);
            for (a, row) in block.iter().enumerate() {
                for (b, x) in row.iter().enumerate() {
                    dense[(i + a, j + b)] += x;
                    dense[(j + b, i + a)] += x;
                }
            }
        }
        let stiff = dense.amax();
        let close = |found: f64, want: f64, scale: f64, what: &str| {
            assert!((found - want).abs() < 1e-6 * scale, "{what}: {found:e} {want:e} of {scale:e}");
        };
        for k in 0..n {
            let [low, high] = [-step, step].map(|way| self.balance(Some((k, way)), None));
            let difference = (potential(&high) - potential(&low)) / (2.0 * step);
            close(here.gradient[k], difference, most, &format!("gradient {k}"));
            for l in 0..n {
                let difference = (high.gradient[l] - low.gradient[l]) / (2.0 * step);
                close(dense[(l, k)], difference, stiff, &format!("slope {l} {k}"));
            }
        }
        for w in 0..boundary::SIDES {
            let [low, high] = [-step, step].map(|way| self.balance(None, Some((w, way))));
            let difference = (potential(&high) - potential(&low)) / (2.0 * step);
            let scale = here.sides.iter().fold(most, |most, f| most.max(f.abs()));
            close(here.sides[w], difference, scale, &format!("side {w}"));
            let corner = (high.sides[w] - low.sides[w]) / (2.0 * step);
            let scale = slope.corner.iter().fold(stiff, |most, k| most.max(k.abs()));
            close(slope.corner[w], corner, scale, &format!("corner {w}"));
            for l in 0..n {
                let difference = (high.gradient[l] - low.gradient[l]) / (2.0 * step);
                close(slope.columns[w][l], difference, stiff, &format!("column {w} {l}"));
            }
        }
    }
}

/// Discs on a grid that overlap by a hundredth of their radius.
fn grid(columns: usize, rows: usize) -> Pack {
    let pitch = 1.99 * RADIUS;
    let grains = (0..columns * rows).map(|k| {
        let (column, row) = ((k % columns) as f64, (k / columns) as f64);
        disc((column + 0.5) * pitch, (row + 0.5) * pitch, RADIUS, 0.3)
    });
    let grains = grains.collect();
    let bounds = boxed([0.0; 2], [columns as f64 * pitch, rows as f64 * pitch]);
    Pack { bounds, grains, history: None }
}

fn surrounded(walls: &str, contact: &str) -> Scene {
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\ncontact: {contact}\nwalls: {{friction: 0.3, {walls}}}\n"
    );
    graintwin::scene::parse(&text, "surrounded.yaml".as_ref()).unwrap()
}

const RUBS: &str = "{friction: {coefficient: 0.3}}";
const GLUED: &str = "{normal: {linear: {stiffness: 1.0e6, bond: {cohesion: .inf}}}}";

#[test]
fn of_an_annulus() {
    let count = 14;
    let around = RADIUS / (std::f64::consts::PI / f64::from(count)).sin();
    let angle = |k: i32| std::f64::consts::TAU * f64::from(k) / f64::from(count);
    let grains: Vec<Grain> = (0..count)
        .map(|k| {
            let (sin, cos) = angle(k).sin_cos();
            disc(0.995 * around * cos, 0.995 * around * sin, RADIUS, 0.3)
        })
        .collect();
    let half = around + 0.98 * RADIUS;
    let pack = Pack { bounds: boxed([-half; 2], [half; 2]), grains, history: None };
    let inner = around - 1.01 * RADIUS;
    for contact in [RUBS, GLUED] {
        let walls = format!("cell: {{annulus: {{inner: {inner:e}}}}}");
        Bench::new(&surrounded(&walls, contact), &pack, Vec::new()).check();
    }
    let walls = format!(
        "cell: {{annulus: {{inner: {inner:e}}}}}, membranes: [x_min, x_max], \
         targets: {{x_min: {{stress: 1.0e5}}, x_max: {{stress: 3.0e5}}}}"
    );
    // The hole is walked around clockwise, the rim the other way.
    let rim: Vec<usize> = (0..count as usize).collect();
    let hole: Vec<usize> = (0..count as usize).rev().collect();
    let membranes = vec![(0, 1e7, hole), (1, 3e7, rim)];
    Bench::new(&surrounded(&walls, RUBS), &pack, membranes).check();
}

#[test]
fn of_points() {
    let mut pack = grid(4, 2);
    let side = pack.bounds.max[0];
    pack.bounds.max[1] -= 0.002 * RADIUS;
    let walls = format!(
        "open: [x_min, x_max], points: {{y_min: {{at: [{:e}, {:e}], radius: 1.3e-4}}, \
         y_max: {{at: [{:e}], radius: 2.0e-4}}}}",
        1.1 * RADIUS,
        side - 0.9 * RADIUS,
        2.8 * RADIUS
    );
    for contact in [RUBS, GLUED] {
        Bench::new(&surrounded(&walls, contact), &pack, Vec::new()).check();
    }
}

#[test]
fn of_membranes() {
    let pack = grid(3, 4);
    let targets = |sides: [&str; 2]| {
        format!(
            "membranes: [{}, {}], targets: {{{}: {{stress: 1.0e5}}, {}: {{stress: 1.0e5}}}}",
            sides[0], sides[1], sides[0], sides[1]
        )
    };
    let along_x = surrounded(&targets(["x_min", "x_max"]), RUBS);
    // One of them goes around a grain and back.
    let chains = vec![(0, 2e7, vec![9, 6, 3, 0]), (1, 2e7, vec![2, 5, 4, 5, 8, 11])];
    Bench::new(&along_x, &pack, chains).check();
    let along_y = surrounded(&targets(["y_min", "y_max"]), GLUED);
    let chains = vec![(2, 3e7, vec![0, 1, 2]), (3, 3e7, vec![11, 10, 9])];
    Bench::new(&along_y, &pack, chains).check();
}
