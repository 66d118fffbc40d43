//! Packs that were bonded between walls which are gone when the run begins: beams and cylinders.

use graintwin::command::{Ask, Disposition};
use graintwin::pack::Pack;
use graintwin::scene::Scene;
use graintwin::wall::WallTarget::{self, Keep};

use crate::discs::*;

/// Bonds that never break.
const BONDED: &str = "{normal: {linear: {stiffness: 1.0e6, bond: {cohesion: .inf}}}, \
                      friction: {coefficient: 0.6}}";

fn surrounded(walls: &str) -> Scene {
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\nwalls: {{{walls}}}\ncontact: {BONDED}\n\
         solver: {{tolerance: 1.0e-10}}\n"
    );
    graintwin::scene::parse(&text, "beam.yaml".as_ref()).unwrap()
}

/// A hexagonal beam of three rows about x = 0 whose bonds overlap as under a stress from all sides; the box
/// touches the rows.
fn beam(columns: usize, overlap: f64) -> Pack {
    let pitch = 2.0 * RADIUS - overlap;
    let rise = 0.75_f64.sqrt() * pitch;
    let half = 0.5 * (columns - 1) as f64 * pitch;
    let row = |row: usize| {
        let shift = if row == 1 { 0.5 } else { 0.0 };
        let count = columns - row % 2;
        (0..count).map(move |k| {
            let x = (k as f64 + shift) * pitch - half;
            disc(x, RADIUS + row as f64 * rise, RADIUS, 0.6)
        })
    };
    let grains = (0..3).flat_map(row).collect();
    let wide = half + RADIUS;
    let bounds = boxed([-wide, 0.0], [wide, 2.0 * RADIUS + 2.0 * rise]);
    Pack { bounds, grains, history: None }
}

fn press(way: f64) -> Ask {
    Ask::Targets([Keep, Keep, Keep, WallTarget::Displacement(way), Keep, Keep])
}

#[test]
fn what_touched_between_the_walls_stays_bonded_without_them() {
    let overlap = 1e-3 * RADIUS;
    let pack = beam(7, overlap);
    let (_, report) = Rig::new(&surrounded("friction: 0.0, open: [x_min, x_max, y_max]"), &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let measures = report.measures.unwrap();
    // Along the rows 6 + 5 + 6, and two from each grain of the middle row up and down.
    assert_eq!(measures.cracks.unwrap().intact, 17 + 24);
    // It has grown to where nothing is pressed: the distances are those of grains that just touch.
    let grains = measures.grains.unwrap().position;
    let length = grains[6][0] - grains[0][0];
    assert!((length / (12.0 * RADIUS) - 1.0).abs() < 1e-9, "{length:e}");
    assert!(measures.walls.normal_force.iter().all(|&force| force.abs() < 1e-9));
}

#[test]
fn supports_carry_the_load_by_its_lever() {
    let pack = beam(21, 0.0);
    let span = 16.0 * RADIUS;
    let points = |load: f64| {
        let half = 0.5 * span;
        format!(
            "friction: .inf, open: [x_min, x_max], points: {{\
             y_min: {{at: [-{half:e}, {half:e}], radius: {RADIUS:e}}}, \
             y_max: {{at: [{load:e}], radius: {RADIUS:e}}}}}"
        )
    };
    for load in [0.0, 4.0 * RADIUS] {
        // The points face grains of both outer rows.
        let (mut rig, report) = Rig::new(&surrounded(&points(load)), &pack);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        let measures = rig.go(press(1e-3 * RADIUS));
        let (network, grains) = (measures.network.unwrap(), measures.grains.unwrap());
        let (mut pushes, mut sum, mut moment) = (Vec::new(), [0.0; 2], 0.0);
        for (k, &second) in network.second.iter().enumerate() {
            if (second as usize) < pack.grains.len() {
                continue;
            }
            let at = grains.position[network.first[k] as usize];
            let [nx, ny] = [network.normal[3 * k], network.normal[3 * k + 1]];
            let reach = RADIUS - network.overlap[k];
            let force = [0, 1].map(|axis| {
                network.normal_force[k] * network.normal[3 * k + axis]
                    + network.tangential_force[3 * k + axis]
            });
            let place = [at[0] - reach * nx, at[1] - reach * ny];
            pushes.push((place[0], force[1]));
            (0..2).for_each(|axis| sum[axis] += force[axis]);
            moment += place[0] * force[1] - place[1] * force[0];
        }
        assert_eq!(pushes.len(), 3);
        let top = pushes.iter().map(|(_, force)| -force).fold(0.0, f64::max);
        assert!(top > 1e-4, "{top:e}");
        assert!(sum.iter().all(|sum| sum.abs() < 1e-7 * top), "{sum:?}");
        assert!(moment.abs() < 1e-7 * top * span, "{moment:e}");
        // Alike under a load in the middle, else more nearer to it.
        let [left, right] = [-1.0, 1.0].map(|side| {
            let own = pushes.iter().find(|(x, force)| *force > 0.0 && x * side > 0.0);
            own.map_or(f64::NAN, |(_, force)| *force)
        });
        match load == 0.0 {
            true => assert!((right / left - 1.0).abs() < 1e-6, "{left:e} {right:e}"),
            false => assert!(right > 1.2 * left, "{left:e} {right:e}"),
        }
        for side in [2, 3] {
            let normal = measures.walls.normal_force[side];
            assert!((normal / top - 1.0).abs() < 1e-7, "{normal:e} {top:e}");
        }
    }
}
