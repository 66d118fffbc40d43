#![allow(missing_docs, clippy::all, clippy::unwrap_used, clippy::print_stdout)]
use graintwin::*;
fn main() {
    let dir = std::env::args().nth(1).unwrap();
    let txt = std::fs::read_to_string(format!("{dir}/g2740_10MPa.csv")).unwrap();
    let grains = txt
        .lines()
        .skip(1)
        .map(|l| {
            let v: Vec<f64> = l.split(',').map(|x| x.parse().unwrap()).collect();
            pack::Grain {
                position: [v[0], v[1], v[2]],
                radius: v[3],
                young: 70e9,
                poisson: 0.2,
                density: 2420.0,
                friction: 0.3,
            }
        })
        .collect();
    let (lo, hi) = (
        [-0.0013596298864540447, -0.0013621499317994505, -0.0013596777749968617],
        [0.0013596298864540447, 0.0013621499317994505, 0.0013596777749968617],
    );
    let p = pack::Pack { bounds: wall::Bounds { min: lo, max: hi }, grains };
    let solver = scene::Solver {
        tolerance: std::env::args().nth(2).map_or(1e-8, |t| t.parse().unwrap()),
        ..Default::default()
    };
    let model = model::Model::with(&p, &scene::Walls::default(), [0.0; 3], solver, None);
    let mut state = state::State::new(&model);
    let mut work = relax::Workspace::new(&model);
    let o = relax::relax(&model, &mut state, &mut work);
    println!("{:?} carries {}", o, state.carries.iter().filter(|c| **c).count());
    let l0 = hi[2] - lo[2];
    for k in 1..=10 {
        let b0 = state.bounds(&model);
        state.displacement[4] = 0.5e-4 * k as f64 * l0;
        state.displacement[5] = state.displacement[4];
        let b1 = state.bounds(&model);
        let (c, s) = (b0.center()[2], b1.sides()[2] / b0.sides()[2]);
        for x in &mut state.position {
            x.z = b1.center()[2] + (x.z - c) * s;
        }
        let t = std::time::Instant::now();
        let h0 = work.linear.products;
        let o = relax::relax(&model, &mut state, &mut work);
        let mut f = 0.0;
        for i in 0..model.len() {
            let h = model.radius[i] - contact::neighbours::wall_gap(&state.position[i], 5, &b1);
            if h > 0.0 {
                f += contact::hertz::force(work.neighbours.wall_modulus[i], h);
            }
        }
        println!(
            "{k} {:?} it {} res {:.1e} contacts {} Hv {} {:.1} ms  Fz {:.10} rebuilds {}",
            o.status,
            o.iterations,
            o.residual,
            o.sums.contacts,
            work.linear.products - h0,
            t.elapsed().as_secs_f64() * 1e3,
            f,
            work.neighbours.rebuilds
        );
    }
}
