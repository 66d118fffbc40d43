//! What the kernels of the relaxation cost: `cargo bench --bench kernels --no-default-features`.
//!
//! Instructions, counted by callgrind when valgrind is installed, do not depend on what else the
//! machine does: a change of a percent is a change of the program. The bench runs itself under
//! valgrind for each kernel and collects within [`measured`] only. Valgrind's processor has AVX2
//! but no AVX-512. The times beside them are the shortest of [`REPEATS`] without valgrind.
//!
//! All on the benchmark pack of 2740 grains, one increment of 1e-4 after its equilibrium, on one
//! thread. A factorisation and a product cannot be called alone: solves of different length are
//! subtracted, and what a solve does once (right-hand side, first direction) counts as factorising.
#![allow(clippy::print_stdout, clippy::expect_used)] // A bench prints, and ends when its input is not there.

#[path = "common/callgrind.rs"]
mod callgrind;

use std::path::Path;
use std::time::{Duration, Instant};

use callgrind::{instructions, measured};
use graintwin::model::Model;
use graintwin::pack;
use graintwin::relax::advance::move_walls;
use graintwin::relax::linear::Inner;
use graintwin::relax::{Workspace, relax};
use graintwin::scene;
use graintwin::state::State;

/// Runs without valgrind; the shortest counts.
const REPEATS: usize = 100;
/// Products of the shorter and the longer solve.
const PRODUCTS: [u32; 2] = [1, 9];

/// A kernel that can be called alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kernel {
    MakeList,
    KeepList,
    Balance,
    Assemble,
    ShortSolve,
    LongSolve,
}

impl Kernel {
    const ALL: [Self; 6] = [
        Self::MakeList,
        Self::KeepList,
        Self::Balance,
        Self::Assemble,
        Self::ShortSolve,
        Self::LongSolve,
    ];
}

/// Instructions or nanoseconds; `None` without valgrind.
type Cost = Option<f64>;

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    pool.expect("the thread that is there").install(|| match callgrind::order() {
        Some(order) => run_one(&order),
        None => run_all(),
    });
}

/// Runs the kernel of `order` once, under valgrind.
fn run_one(order: &str) {
    let (scene, kernel) = order.split_once(' ').expect("scene and kernel");
    let kernel = Kernel::ALL.into_iter().find(|one| format!("{one:?}") == kernel);
    Specimen::load(scene).run(kernel.expect("a kernel"));
}

fn run_all() {
    println!("| kernel | friction | instructions a grain | a contact | µs, shortest |");
    println!("| --- | --- | --- | --- | --- |");
    for (scene, friction) in [("g2740", "none"), ("g2740_friction", "0.3")] {
        let mut specimen = Specimen::load(scene);
        let counts = Kernel::ALL.map(|kernel| instructions(&format!("{scene} {kernel:?}")));
        let times = Kernel::ALL.map(|kernel| Some(specimen.shortest(kernel).as_nanos() as f64));
        let (grains, contacts) = (specimen.model.len() as f64, specimen.contacts());
        for ((name, count), (_, time)) in parts(&counts).into_iter().zip(parts(&times)) {
            let over = |by: f64| count.map_or("-".into(), |count| format!("{:.0}", count / by));
            let micros = time.map_or("-".into(), |time| format!("{:.0}", 1e-3 * time));
            println!("| {name} | {friction} | {} | {} | {micros} |", over(grains), over(contacts));
        }
    }
}

/// The costs by name, of which those of a solve are put together from a short and a long one.
fn parts(of: &[Cost; 6]) -> [(&'static str, Cost); 6] {
    let [make, keep, balance, assemble, short, long] = *of;
    let product =
        short.zip(long).map(|(short, long)| (long - short) / f64::from(PRODUCTS[1] - PRODUCTS[0]));
    let factorise =
        short.zip(product).map(|(short, product)| short - f64::from(PRODUCTS[0]) * product);
    [
        ("neighbour list made", make),
        ("neighbour list kept", keep),
        ("balance", balance),
        ("assemble", assemble),
        ("factorise", factorise),
        ("product, preconditioned", product),
    ]
}

/// The benchmark pack after its walls moved by an increment.
struct Specimen {
    model: Model,
    state: State,
    work: Workspace,
}

impl Specimen {
    fn load(name: &str) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
        let job = scene::load(&root.join(name).with_extension("yaml")).expect("it is shipped");
        let pack = pack::build(&job).expect("the benchmark pack is in tests/data");
        let model = Model::new(&pack, &job.scene);
        let mut state = State::new(&model);
        let mut work = Workspace::new(&model);
        work.start(&model, &state);
        relax(&model, &mut state, &mut work);
        work.commit(&model, &mut state);
        work.begin(&model, &state);
        let travel = 0.5e-4 * model.start.sides()[2];
        move_walls(&model, &mut state, &[0.0, 0.0, 0.0, 0.0, travel, travel], 1.0);
        let mut specimen = Self { model, state, work };
        specimen.call(Kernel::Balance);
        specimen
    }

    fn contacts(&self) -> f64 {
        f64::from(self.work.balance.sums.contacts)
    }

    /// Does `kernel` after what it needs.
    fn run(&mut self, kernel: Kernel) -> Duration {
        if matches!(kernel, Kernel::ShortSolve | Kernel::LongSolve) {
            self.call(Kernel::Assemble);
        }
        let before = self.work.effort().products;
        let start = Instant::now();
        measured(&mut || self.call(kernel));
        let time = start.elapsed();
        let done = self.work.effort().products - before;
        match kernel {
            Kernel::ShortSolve => assert_eq!(done, u64::from(PRODUCTS[0])),
            Kernel::LongSolve => assert_eq!(done, u64::from(PRODUCTS[1])),
            _ => {}
        }
        time
    }

    fn shortest(&mut self, kernel: Kernel) -> Duration {
        (0..REPEATS).map(|_| self.run(kernel)).min().expect("there are repeats")
    }

    fn call(&mut self, kernel: Kernel) {
        let Self { model, state, work } = self;
        let bounds = state.bounds(model);
        match kernel {
            Kernel::MakeList => work.neighbours.rebuild(model, &state.position, &bounds),
            Kernel::KeepList => assert!(work.neighbours.holds(model, &state.position, &bounds)),
            Kernel::Balance => work.evaluate(model, state, &bounds),
            Kernel::Assemble => work.assemble(model),
            Kernel::ShortSolve => solve(work, PRODUCTS[0]),
            Kernel::LongSolve => solve(work, PRODUCTS[1]),
        }
    }
}

/// Solves in `products` products.
fn solve(work: &mut Workspace, products: u32) {
    assert_eq!(work.solve(work.balance.largest(), 0.0, products), Inner::Step);
}
