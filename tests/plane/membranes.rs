//! Membranes.

use std::f64::consts::PI;

use graintwin::command::{Ask, Disposition};
use graintwin::pack::Pack;
use graintwin::report::Measures;
use graintwin::scene::Scene;
use graintwin::wall::WallTarget::{self, Keep};

use crate::annulus::ring_scene;
use crate::discs::*;

/// Membranes at the x sides under `pressure` \[Pa\], or walls that carry it.
fn wrapped(membranes: bool, pressure: f64, contact: &str) -> Scene {
    let what = if membranes { "membranes: [x_min, x_max], " } else { "" };
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\ncontact: {contact}\n\
         walls: {{friction: 0.0, {what}targets: {{x_min: {{stress: {pressure:e}}}, \
         x_max: {{stress: {pressure:e}}}}}}}\n"
    );
    graintwin::scene::parse(&text, "membranes.yaml".as_ref()).unwrap()
}

/// Grains that stick and do not turn: a square lattice of them holds.
const STIFF: &str = "{rotation: locked, friction: {coefficient: 10.0}}";

/// A square lattice whose contacts overlap about as much as under 1e5 Pa.
fn lattice(columns: usize, rows: usize) -> Pack {
    let pitch = 1.995 * RADIUS;
    let grains = (0..columns * rows).map(|k| {
        let (column, row) = ((k % columns) as f64, (k / columns) as f64);
        disc((column + 0.5) * pitch, (row + 0.5) * pitch, RADIUS, 10.0)
    });
    let bounds = boxed([0.0; 2], [columns, rows].map(|count| count as f64 * pitch));
    Pack { bounds, grains: grains.collect(), history: None }
}

fn down(way: f64) -> Ask {
    let down = WallTarget::Displacement(way);
    Ask::Targets([Keep, Keep, down, down, Keep, Keep])
}

#[test]
fn on_a_straight_edge_a_membrane_is_a_wall_under_the_same_stress() {
    let pack = lattice(5, 6);
    let run = |membranes: bool| {
        let (mut rig, report) = Rig::new(&wrapped(membranes, 1e5, STIFF), &pack);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        rig.go(down(2e-7))
    };
    let (with, without) = (run(true), run(false));
    let [one, other] = [&with, &without].map(|m| &m.grains.as_ref().unwrap().position);
    for (one, other) in one.iter().zip(other) {
        for axis in 0..2 {
            // Under the load all columns are as close; where they are together is free.
            let far = (one[axis] - other[axis]).abs();
            assert!(far < 1e-8 * RADIUS, "{far:e}");
        }
    }
    for w in 0..4 {
        let [one, other] = [&with, &without].map(|m| m.walls.normal_force[w]);
        assert!((one / other - 1.0).abs() < 1e-8, "{w}: {one:e} {other:e}");
    }
    let [one, other] = [with, without].map(|m| m.state.unwrap());
    assert!((one.stress_walls[0] / 1e5 - 1.0).abs() < 1e-12);
    // The outline goes through the centres: it does not have the overlaps with the walls, and the areas
    // of the platens differ as the widths do.
    let wider = other.strain[0] - one.strain[0];
    assert!(wider.abs() < 1e-4);
    let ratio = one.stress_walls[4] / other.stress_walls[4];
    assert!((ratio - (1.0 - wider)).abs() < 2e-8, "{wider:e}");
}

/// Work of the sides is what the pack stores and loses.
fn books(first: &Measures, last: &Measures) -> [f64; 2] {
    let [a, b] = [first, last].map(|m| m.state.unwrap());
    let stored = b.stored_energy - a.stored_energy;
    let lost = |s: &graintwin::report::PackState| {
        s.slip_energy + s.renewal_energy + s.event_energy + s.broken_energy
    };
    [b.wall_work - a.wall_work, stored + lost(&b) - lost(&a)]
}

#[test]
fn work_of_the_pressure_is_p_times_the_volume_and_is_stored() {
    let pack = lattice(5, 6);
    let (mut rig, first) = Rig::new(&wrapped(true, 1e5, STIFF), &pack);
    let first = first.measures.unwrap();
    let mut last = first.clone();
    for k in 1..=100 {
        let press = WallTarget::Stress(1e5 + 1e3 * f64::from(k));
        last = rig.go(Ask::Targets([press, press, Keep, Keep, Keep, Keep]));
    }
    let [worked, kept] = books(&first, &last);
    assert!((worked / kept - 1.0).abs() < 1e-4, "{worked:e} {kept:e}");
    // Upon a pack that is smaller by ΔV the mean pressure did p ΔV.
    let area = 12.0 * RADIUS * 2.0 * RADIUS;
    let [a, b] = [&first, &last].map(|m| m.walls.displacement[0] + m.walls.displacement[1]);
    let mean = 1.5e5 * (b - a) * area;
    assert!((worked / mean - 1.0).abs() < 2e-2, "{worked:e} {mean:e}");
}

#[test]
fn a_ring_on_a_wall_carries_its_membrane() {
    const COUNT: usize = 12;
    let half = (PI / COUNT as f64).sin();
    let around = RADIUS / half;
    let grains: Vec<_> = (0..COUNT)
        .map(|k| {
            let (sin, cos) = (2.0 * PI * k as f64 / COUNT as f64).sin_cos();
            disc(0.999 * around * cos, 0.999 * around * sin, RADIUS, 0.0)
        })
        .collect();
    let side = around + RADIUS;
    let pack = Pack { bounds: boxed([-side; 2], [side; 2]), grains, history: None };
    let pressure = 2e5;
    let rest = format!(", membranes: [x_max], targets: {{x_max: {{stress: {pressure:e}}}}}");
    let inner = around - 1.001 * RADIUS;
    let (_, report) = Rig::new(&ring_scene(inner, &rest, "{normal: hertz}"), &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let measures = report.measures.unwrap();
    let grains = measures.grains.unwrap();
    let network = measures.network.unwrap();
    let grain = network.second.iter().position(|&second| (second as usize) < COUNT).unwrap();
    let force = network.normal_force[grain];
    let wall = measures.walls.normal_force[0] / COUNT as f64;
    for at in &grains.position {
        // The pressure on two halves of the sides of the polygon beside a grain, along the radius.
        let distance = at[0].hypot(at[1]);
        let out = pressure * 2.0 * RADIUS * distance * 2.0 * half * (PI / COUNT as f64).cos();
        assert!(
            ((2.0 * half * force + wall) / out - 1.0).abs() < 1e-8,
            "{force:e} {wall:e} {out:e}"
        );
    }
    let radius = side - measures.walls.displacement[1];
    let area = 0.5 * COUNT as f64 * (2.0 * PI / COUNT as f64).sin();
    let first = 0.999 * around * (area / PI).sqrt();
    let now = grains.position[0][0].hypot(grains.position[0][1]) * (area / PI).sqrt();
    assert!((radius - (side - first + now)).abs() < 1e-12 * side);
}

#[test]
fn what_a_disordered_pack_is_pressed_with_is_the_pressure_on_its_straight_sides() {
    let pack = dense(9, 16, 3, 1e5, 0.6);
    let scene = wrapped(true, 1e5, "{friction: {coefficient: 0.6}}");
    let (mut rig, report) = Rig::new(&scene, &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let [_, height, depth] = pack.bounds.sides();
    let middle = pack.bounds.center()[0];
    for k in 1..=20 {
        let way = 2e-5 * f64::from(k) * height;
        let measures = rig.go(down(way));
        let (network, grains) = (measures.network.unwrap(), measures.grains.unwrap());
        // What contacts leave over on each grain is what the membranes press it with.
        let mut left_over = vec![[0.0; 2]; grains.position.len()];
        for (k, (&first, &second)) in network.first.iter().zip(&network.second).enumerate() {
            for axis in 0..2 {
                let force = network.normal_force[k] * network.normal[3 * k + axis]
                    + network.tangential_force[3 * k + axis];
                left_over[first as usize][axis] += force;
                if let Some(other) = left_over.get_mut(second as usize) {
                    other[axis] -= force;
                }
            }
        }
        let side = |right: bool| {
            let own = left_over.iter().zip(&grains.position);
            own.filter(|(_, at)| (at[0] > middle) == right).map(|(force, _)| force[0]).sum::<f64>()
        };
        let want = 1e5 * depth * (height - 2.0 * way);
        for (force, want) in [(side(true), want), (side(false), -want)] {
            assert!((force / want - 1.0).abs() < 1e-6, "{force:e} {want:e}");
        }
        // They push inwards and press surfaces only: most grains are in balance without them.
        let pressed = left_over.iter().filter(|force| force[0].hypot(force[1]) > 1e-4 * want);
        assert!(pressed.count() < left_over.len() / 2);
    }
}

#[test]
fn newton_and_gauss_seidel_find_the_same() {
    let pack = lattice(3, 4);
    let run = |method: &str| {
        let text = format!(
            "dimension: 2\npack: {{file: none.csv}}\ncontact: {STIFF}\n\
             solver: {{method: {method}, tolerance: 1.0e-10}}\n\
             walls: {{membranes: [x_min, x_max], targets: {{x_min: {{stress: 1.0e5}}, \
             x_max: {{stress: 1.0e5}}}}}}\n"
        );
        let scene = graintwin::scene::parse(&text, "methods.yaml".as_ref()).unwrap();
        let (mut rig, report) = Rig::new(&scene, &pack);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        rig.go(down(2e-7))
    };
    let [newton, sweeps] = ["newton", "gauss_seidel"].map(run);
    let [one, other] = [newton, sweeps].map(|m| m.walls);
    for w in 0..4 {
        assert!((one.normal_force[w] / other.normal_force[w] - 1.0).abs() < 1e-7);
        assert!((one.displacement[w] - other.displacement[w]).abs() < 1e-7 * RADIUS);
    }
}

#[test]
fn what_is_no_order_for_a_membrane_is_refused() {
    let (mut rig, _) = Rig::new(&wrapped(true, 1e5, STIFF), &lattice(3, 4));
    for target in [WallTarget::Force(1.0), WallTarget::Displacement(1e-7)] {
        let report = rig.ask(Ask::Targets([target, Keep, Keep, Keep, Keep, Keep]));
        assert_eq!(report.disposition, Disposition::Invalid);
        assert!(report.text.contains("x_min is a membrane"), "{}", report.text);
    }
    // As ever what carries a load keeps it when displacements are asked for.
    let report = rig.ask(Ask::Displacement([0.0, 0.0, 1e-7, 1e-7, 0.0, 0.0]));
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
}
