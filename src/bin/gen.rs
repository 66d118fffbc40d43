#![allow(missing_docs, clippy::all, clippy::unwrap_used, clippy::print_stdout)]
use graintwin::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let n: usize = a[1].parse().unwrap(); let p: f64 = a[2].parse().unwrap(); let seeds: u64 = a[3].parse().unwrap();
    for seed in 1..=seeds {
        let spec = scene::Generate { grains: n, radius: scene::Radius::Uniform([0.07e-3, 0.13e-3]), material: "glass".into(), seed, confining_stress: p, aspect: [1.0; 3], expand_floaters: 0 };
        let m = scene::Material { young: 70e9, poisson: 0.2, density: 2420.0, spread: 0.1 };
        let t = std::time::Instant::now();
        match pack::generate::generate(&spec, &m, &scene::Walls::default(), 0.3, scene::Solver::default()) {
            Ok(pack) => { let v = pack.bounds.volume(); let s: f64 = pack.grains.iter().map(|g| model::sphere_volume(g.radius)).sum();
                let w = scene::Walls::default();
                let model = model::Model::with(&pack, &w, [0.0; 3], scene::Solver::default(), None);
                let mut st = state::State::new(&model); let mut work = relax::Workspace::new(&model);
                let o = relax::relax(&model, &mut st, &mut work);
                let c = measure::contacts::Contacts::of(&model, &st, &work.neighbours);
                let f = measure::walls::forces(&model, &st, &c.list); let s3 = measure::stress::from_walls(&f, &pack.bounds);
                println!("seed {seed} {:.2} s phi {:.4} Z {:.3} sigma {:?} outcome {:?} it {}", t.elapsed().as_secs_f64(), s / v, 2.0 * o.sums.contacts as f64 / n as f64, s3.diagonal().as_slice(), o.status, o.iterations);
            }
            Err(e) => println!("seed {seed} {:.2} s {e}", t.elapsed().as_secs_f64()),
        }
    }
}
