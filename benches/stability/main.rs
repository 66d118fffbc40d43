#![allow(clippy::print_stdout, clippy::expect_used, missing_docs)]
mod reference;
#[path = "../../tests/common/packs.rs"]
mod packs;
use graintwin::Vec3;
use graintwin::model::Model;
use graintwin::measure::walls;
use graintwin::relax::advance::move_walls;
use graintwin::relax::{Workspace, relax};
use graintwin::scene::{Coulomb, Friction, Law, Update};
use graintwin::state::State;
use rand::{RngExt, SeedableRng};
use std::time::Instant;

fn forces(model: &Model, state: &State, work: &mut Workspace) -> [f64; 6] {
    work.neighbours.refresh(model, &state.position, &state.bounds(model));
    walls::normal_forces(model, state, &work.neighbours)
}

fn compare(model: &Model, a: &State, b: &State, work: &mut Workspace) -> (f64, f64) {
    let (fa, mut bb) = (forces(model, a, work), b.clone());
    bb.carries.copy_from_slice(&a.carries);
    let fb = forces(model, &bb, work);
    let mean = fa.iter().sum::<f64>() / 6.0;
    let off = fa.iter().zip(fb).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / mean;
    let mut held = vec![0; model.len()];
    let b0 = a.bounds(model);
    work.neighbours.refresh(model, &a.position, &b0);
    let contacts = graintwin::measure::contacts::Contacts::of(model, a, &work.neighbours);
    for c in &contacts.list { if c.force > 1e-3 * contacts.mean_force {
        held[c.first as usize] += 1;
        if let graintwin::contact::Other::Grain(j) = c.second { held[j as usize] += 1; }
    }}
    let need = if model.friction.is_some() { 2 } else { 4 };
    let moved = (0..model.len()).filter(|&i| a.carries[i] && held[i] >= need).map(|i| (a.position[i] - b.position[i]).norm()).fold(0.0, f64::max);
    (off, moved)
}

fn main() {
    let get = |k: &str, d: f64| std::env::var(k).map_or(d, |v| v.parse().expect("number"));
    let (seeds, mu, incs) = (get("SEEDS", 4.0) as u64, get("MU", 0.0), get("INCS", 5.0) as usize);
    let first = get("FIRST", 1.0) as u64;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    pool.install(|| for seed in first..first+seeds { for (si, stress) in [1e5, 1e6, 1e7].into_iter().enumerate() {
        let mut rng = rand_pcg::Pcg64::seed_from_u64(seed * 10 + si as u64);
        let grains = rng.random_range(20..=60usize);
        let recipe = packs::recipe(grains, stress, seed);
        let Ok(mut pack) = graintwin::pack::generate::generate(&recipe, &packs::GLASS, &graintwin::scene::Walls::default(), 0.0, Default::default()) else { println!("no pack {seed} {stress}"); continue };
        let mut sc = packs::scene();
        if mu > 0.0 {
            sc.contact.friction = Friction::Coulomb(Coulomb { coefficient: mu, law: Law::ReturnMap, update: Update::Frozen });
            for g in &mut pack.grains { g.friction = mu; }
        }
        let model = Model::new(&pack, &sc);
        let mut work = Workspace::new(&model);
        let mut state = State::new(&model);
        work.strict = 0;
        work.start(&model, &state);
        relax(&model, &mut state, &mut work);
        work.commit(&model, &mut state);
        for inc in 0..incs {
            let share = [0.01, 0.05, 0.05, 0.2][rng.random_range(0..4usize)];
            let dir: [f64; 3] = std::array::from_fn(|_| 2.0 * rng.random::<f64>() - 1.0);
            let big = dir.iter().map(|d| d.abs()).fold(0.0, f64::max);
            let overlap = work.balance.sums.mean_overlap();
            let strain = share * overlap / (2.0 * model.mean_radius) / big;
            let sides = model.start.sides();
            let target: [f64; 6] = std::array::from_fn(|w| state.displacement[w] + 0.5 * strain * dir[w / 2] * sides[w / 2]);
            work.begin(&model, &state);
            let mut start = state.clone();
            move_walls(&model, &mut start, &target, 1.0);
            let mut refr = start.clone();
            let t = Instant::now();
            let evals = reference::follow(&model, &mut refr, &mut work);
            let tref = t.elapsed().as_secs_f64();
            use std::io::Write;
            print!("RES seed {seed} stress {stress:.0e} n {grains} share {share} ref {evals:?} {tref:.2}s");
            std::io::stdout().flush().expect("x");
            let mut keep = None;
            for strict in [0, 1] {
                let mut end = start.clone();
                work.strict = strict; work.watch = [0; 3]; work.flow_steps = 0;
                work.flow_error = get("ERR", 0.05); work.forcing = (get("F1", 0.1), get("F2", 0.2)); work.relative = get("REL", 0.5); work.proj = get("PROJ", 1.0); work.least = get("LEAST", 1.5); work.after = get("AFTER", 0.7); work.share = get("SHARE", 0.1);
                let p = work.effort().products;
                let out = relax(&model, &mut end, &mut work);
                let p = work.effort().products - p;
                std::io::stdout().flush().expect("x");
                let (off, moved) = compare(&model, &end, &refr, &mut work);
                let jump = (0..model.len()).filter(|&i| end.carries[i]).map(|i| (end.position[i] - start.position[i]).norm()).fold(0.0, f64::max) / overlap;
                let same = off < 1e-3 && moved < 0.05 * overlap;
                print!(" | S{strict} {:?} same {} off {off:.1e} moved {:.1e} jump {jump:.2} it {} desc {} watch {:?} flow {} prod {p}", out.status, same as u8, moved / overlap, out.iterations, out.descents, work.watch, work.flow_steps);
                if out.status == graintwin::relax::Status::Converged { keep = Some(end); }
            }
            println!(" inc {inc}");
            let Some(end) = keep else { break };
            state = end;
            let b = state.bounds(&model);
            work.evaluate(&model, &state, &b);
            work.commit(&model, &mut state);
        }
    }});
    let _ = Vec3::zeros();
}
