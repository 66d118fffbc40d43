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
        
        work.start(&model, &state);
        let mut outcome = relax(&model, &mut state, &mut work);
        work.commit(&model, &mut state);
        let mut total = 0.0;
        for k in 0..10 {
            let travel = 0.5e-4 * (k + 1) as f64 * model.start.sides()[2];
            let target = [0.0, 0.0, 0.0, 0.0, travel, travel];
            
            let before = work.effort();
            let start = Instant::now();
            let done = advance(&model, &mut state, &mut work, &target, outcome);
            let ms = start.elapsed().as_secs_f64()*1e3;
            total += ms;
            outcome = done.outcome;
            let e = work.effort();
            println!("{k} {:?} it {} desc {} sub {} prod {} grad {} jumps {:?} {ms:.1} ms E {:.6e} Fz {:.6}", outcome.status, done.iterations, done.descents, done.substeps, e.products-before.products, e.gradients-before.gradients, done.jumps.iter().map(|j| (j.grains.len(), j.stress_before, j.stress_after)).collect::<Vec<_>>(), outcome.sums.energy,
             graintwin::measure::walls::normal_forces(&model,&state,&work.neighbours)[5]);
        }
        println!("mean {:.1}", total/10.0);
    });
}
