use graintwin::model::Model;
use graintwin::relax::{Workspace, relax};
use graintwin::relax::advance::advance;
use graintwin::state::State;
use graintwin::scene::{self, *};
use graintwin::pack;
use std::path::Path;
use std::time::Instant;
fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let job = scene::load(&root.join("tests/data/g2740.yaml")).unwrap();
    let pack = pack::build(&job).unwrap();
    let mu: f64 = std::env::var("MU").map_or(0.0, |v| v.parse().unwrap());
    let strict: u32 = std::env::var("STRICT").map_or(0, |v| v.parse().unwrap());
    let share: f64 = std::env::var("SHARE").map_or(0.1, |v| v.parse().unwrap());
    let err: f64 = std::env::var("ERR").map_or(0.05, |v| v.parse().unwrap());
    let mut sc = job.scene.clone();
    let mut pack = pack;
    if mu > 0.0 {
        sc.contact.friction = Friction::Coulomb(Coulomb{coefficient: mu, law: Law::ReturnMap, update: Update::Frozen});
        for g in &mut pack.grains { g.friction = mu; }
    }
    let model = Model::new(&pack, &sc);
    pool.install(|| {
        let mut state = State::new(&model);
        let mut work = Workspace::new(&model);
        work.strict = strict; work.share = share; work.flow_error = err;
        let get = |k: &str, d: f64| std::env::var(k).map_or(d, |v| v.parse().unwrap());
        work.relative = get("REL", 0.5); work.proj = get("PROJ", 1.0); work.least = get("LEAST", 1.5); work.after = get("AFTER", 0.7); work.forcing = (get("F1", 0.1), get("F2", 0.2));
        work.start(&model, &state);
        let mut outcome = relax(&model, &mut state, &mut work);
        work.commit(&model, &mut state);
        let mut total = 0.0;
        for k in 0..10 {
            let travel = 0.5e-4 * (k + 1) as f64 * model.start.sides()[2];
            let target = [0.0, 0.0, 0.0, 0.0, travel, travel];
            work.watch = [0; 3]; work.flow_steps = 0;
            let before = work.effort();
            let start = Instant::now();
            let done = advance(&model, &mut state, &mut work, &target, outcome);
            let ms = start.elapsed().as_secs_f64()*1e3;
            total += ms;
            outcome = done.outcome;
            let e = work.effort();
            println!("{k} {:?} it {} desc {} flow {} sub {} prod {} grad {} watch {:?} {ms:.1} ms E {:.6e} Fz {:.6}", outcome.status, done.iterations, done.descents, work.flow_steps, done.substeps, e.products-before.products, e.gradients-before.gradients, work.watch, outcome.sums.energy,
             graintwin::measure::walls::normal_forces(&model,&state,&work.neighbours)[5]);
        }
        println!("mean {:.1}", total/10.0);
    });
}
