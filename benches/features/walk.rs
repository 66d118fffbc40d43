//! One walk through the job.

use std::sync::Arc;
use std::time::Duration;

use graintwin::contact::cement::deposit::deposit;
use graintwin::model::Model;
use graintwin::pack;
use graintwin::path;
use graintwin::relax::advance::advance;
use graintwin::relax::{Workspace, relax};
use graintwin::sink::Served;
use graintwin::state::State;
use graintwin::twin::Twin;
use graintwin::wall::standing;
use nix::time::ClockId;

use crate::callgrind::measured;
use crate::heap;
use crate::listen::Listener;
use crate::variant::Variant;

/// Increments whose instructions are counted.
pub(crate) const COUNTED: usize = 3;

/// What a walk took, one entry an increment.
pub(crate) struct Walk {
    /// CPU time of all threads \[s\]; the last includes the end of the listening.
    pub(crate) seconds: Vec<f64>,
    /// Evaluations of energy and gradient.
    pub(crate) gradients: Vec<f64>,
    /// Products with the Hessian.
    pub(crate) products: Vec<f64>,
    /// Allocations of all threads.
    pub(crate) allocations: Vec<f64>,
    /// Wall forces and positions.
    pub(crate) bits: Vec<u64>,
}

impl Walk {
    /// Takes the times of another walk where they are shorter.
    pub(crate) fn shorten(&mut self, other: &Self) {
        for (least, time) in self.seconds.iter_mut().zip(&other.seconds) {
            *least = least.min(*time);
        }
    }
}

/// Walks the whole job.
pub(crate) fn walk(variant: &Variant) -> Walk {
    let mut walk = Walk {
        seconds: Vec::new(),
        gradients: Vec::new(),
        products: Vec::new(),
        allocations: Vec::new(),
        bits: Vec::new(),
    };
    let listener = serve(variant, usize::MAX, &mut |twin, step| {
        let before = twin.effort();
        let (start, calls) = (cpu(), heap::calls());
        let served = step(twin);
        walk.seconds.push((cpu() - start).as_secs_f64());
        walk.allocations.push((heap::calls() - calls) as f64);
        let now = twin.effort();
        walk.gradients.push((now.gradients - before.gradients) as f64);
        walk.products.push((now.products - before.products) as f64);
        let measures = served.report.measures.as_ref().expect("the increment was served");
        walk.bits.extend(measures.walls.normal_force.map(f64::to_bits));
        let grains = twin.pack().grains;
        walk.bits.extend(grains.iter().flat_map(|grain| grain.position.map(f64::to_bits)));
    });
    let start = cpu();
    listener.end();
    if let Some(last) = walk.seconds.last_mut() {
        *last += (cpu() - start).as_secs_f64();
    }
    walk
}

/// Walks the first increments for callgrind: what the serving thread does, or the solver.
pub(crate) fn count(variant: &Variant, part: &str) {
    match part {
        "serving" => {
            let listener = serve(variant, COUNTED, &mut |twin, step| {
                measured(&mut || drop(step(twin)));
            });
            listener.end();
        }
        _ => solve(variant),
    }
}

type Step<'a> = dyn FnMut(&mut Twin) -> Arc<Served> + 'a;

/// Serves the first `most` increments; `around` calls each.
fn serve(
    variant: &Variant,
    most: usize,
    around: &mut dyn FnMut(&mut Twin, &mut Step<'_>),
) -> Listener {
    let job = variant.scene();
    let pack = pack::build(&job).expect("the benchmark pack is in tests/data");
    let commands = path::commands(&job.scene.load_path, job.folder(), &pack.bounds);
    let mut twin = Twin::new(&job.scene, &pack, 1).expect("one thread");
    let mut listener = Listener::start(variant.listens, &job.scene);
    let report = twin.start(listener.demand().or(variant.demand));
    listener.served(&Arc::new(Served { command: None, report }));
    listener.settle();
    for command in commands.expect("a path").into_iter().take(most) {
        around(&mut twin, &mut |twin| {
            let report = twin.apply(&command, listener.demand().or(variant.demand));
            let served = Arc::new(Served { command: Some(command.clone()), report });
            listener.served(&served);
            served
        });
    }
    listener
}

/// The first increments without a twin, on this thread.
fn solve(variant: &Variant) {
    let job = variant.scene();
    let pack = pack::build(&job).expect("the benchmark pack is in tests/data");
    let model = Model::new(&pack, &job.scene);
    let (mut state, mut work) = (State::new(&model), Workspace::new(&model));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    pool.expect("the thread that is there").install(|| {
        work.start(&model, &state);
        let mut here = relax(&model, &mut state, &mut work);
        if let Some(cement) = &model.cement {
            deposit(&model, cement, &mut state);
            work.start(&model, &state);
            here = relax(&model, &mut state, &mut work);
        }
        work.commit(&model, &mut state);
        for k in 1..=COUNTED {
            let travel = 0.5e-4 * k as f64 * model.start.sides()[2];
            let target = [0.0, 0.0, 0.0, 0.0, travel, travel];
            measured(&mut || {
                here = advance(&model, &mut state, &mut work, &standing(&target), here).outcome;
            });
            assert!(here.status.is_equilibrium());
        }
    });
}

/// CPU time of this process.
fn cpu() -> Duration {
    Duration::from(ClockId::CLOCK_PROCESS_CPUTIME_ID.now().expect("a CPU clock"))
}
