use crate::discs::*;
use graintwin::command::{Ask, Shear};
use graintwin::pack::Pack;
use graintwin::scene::Scene;
use graintwin::wall::WallTarget;

/// Sand between walls that `walls` describes.
fn scene(walls: &str, friction: f64) -> Scene {
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\nwalls: {{{walls}}}\n\
         contact: {{friction: {{coefficient: {friction}}}}}\n"
    );
    graintwin::scene::parse(&text, "shear.yaml".as_ref()).unwrap()
}

const GLUED: &str = "friction: .inf, glue: true";

fn shear(tilt: f64, [x, y]: [WallTarget; 2]) -> Ask {
    Ask::Shear(Shear { tilt, targets: [x, x, y, y, WallTarget::Keep, WallTarget::Keep] })
}

#[test]
fn look() {
    let pack: Pack = dense(20, 20, 1, 1e5, 0.6);
    for walls in [GLUED, "friction: .inf"] {
        let (mut rig, report) = Rig::new(&scene(walls, 0.6), &pack);
        println!("{walls} {} {:?}", report.text, report.measures.as_ref().unwrap().state);
        let load = [WallTarget::Stress(1e5); 2];
        rig.stress([1e5; 2]);
        for k in 1..=100 {
            let m = rig.go(shear(1e-3 * f64::from(k), load));
            let s = m.state.unwrap();
            if k % 5 == 0 || k < 4 {
                println!(
                    "{k} w {:?} c {:?} vol {:.4e} it {} res {:.1e} work {:.5e} stored {:.5e} init dis {:.4e} slip {:.4e} ren {:.2e} ev {:.2e}",
                    [0, 1, 3, 4].map(|i| (s.stress_walls[i] / 1e2).round() / 1e3),
                    [0, 1, 3, 4].map(|i| (s.stress_contacts[i] / 1e2).round() / 1e3),
                    s.strain[0] + s.strain[1],
                    s.iterations,
                    s.residual,
                    s.wall_work,
                    s.stored_energy,
                    s.dissipated_energy,
                    s.slip_energy,
                    s.renewal_energy,
                    s.event_energy
                );
            }
        }
        println!("{:?}", rig.twin.effort());
    }
}
