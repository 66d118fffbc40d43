use crate::discs::*;

#[test]
fn a_biaxial_test() {
    let pack = dense(20, 50, 1, 1e5, 0.6);
    let (mut rig, report) = Rig::new(&sand("0.6"), &pack);
    println!("{:?}", report.measures.unwrap().state);
    let t = std::time::Instant::now();
    let height = pack.bounds.sides()[1];
    for k in 1..=std::env::var("N").map_or(1000, |n| n.parse().unwrap()) {
        let m = rig.biaxial(1e5, 0.5 * 4e-5 * f64::from(k) * height);
        let s = m.state.unwrap();
        if k % 50 == 0 {
            println!(
                "{k} {:?} s1 {:.4e} s3 {:.4e} vol {:.4e} it {} sub res {:.1e} z {:.3} slid {:.3} work {:.4e} st {:.4e} dis {:.4e} ev {:.3e} slip {:.3e} ren {:.2e} jumps {}",
                t.elapsed(),
                s.stress_walls[4],
                s.stress_walls[0],
                s.strain[0] + s.strain[1],
                s.iterations,
                s.residual,
                s.coordination_number,
                s.sliding_ratio,
                s.wall_work,
                s.stored_energy,
                s.dissipated_energy,
                s.event_energy,
                s.slip_energy,
                s.renewal_energy,
                m.events.len()
            );
        }
    }
    println!("{:?}", rig.twin.effort());
}
