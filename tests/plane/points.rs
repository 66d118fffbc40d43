//! Supports and loads at points, and sides that are open.

use graintwin::command::{Ask, Disposition};
use graintwin::pack::Pack;
use graintwin::scene::Scene;
use graintwin::twin::Twin;
use graintwin::wall::WallTarget::{self, Keep};

use crate::discs::*;

/// Where the supports are \[m\], and their radius.
const SPAN: f64 = 0.8 * RADIUS;
const POINT: f64 = 0.5 * RADIUS;

fn bend(friction: &str) -> Scene {
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\ncontact: {friction}\n\
         walls:\n  open: [x_min, x_max]\n  points:\n\
         \x20   y_min: {{at: [-{SPAN:e}, {SPAN:e}], radius: {POINT:e}}}\n\
         \x20   y_max: {{at: [0.0], radius: {POINT:e}}}\n"
    );
    graintwin::scene::parse(&text, "points.yaml".as_ref()).unwrap()
}

/// A disc that just touches two supports below and a load above.
fn pack(friction: f64) -> Pack {
    // y_min is where the supports end, y_max where the load does.
    let height = ((RADIUS + POINT).powi(2) - SPAN * SPAN).sqrt() - POINT;
    let bounds = boxed([-2.0 * RADIUS, 0.0], [2.0 * RADIUS, height + RADIUS]);
    Pack { bounds, grains: vec![disc(0.0, height, RADIUS, friction)], history: None }
}

fn load(force: f64) -> Ask {
    Ask::Targets([Keep, Keep, Keep, WallTarget::Force(force), Keep, Keep])
}

#[test]
fn a_disc_on_two_supports_sinks_as_its_contacts_do() {
    let (mut rig, report) = Rig::new(&bend("{normal: hertz}"), &pack(0.0));
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let force = 0.02;
    let measures = rig.go(load(force));
    let compliance = (1.0 - POISSON * POISSON) / YOUNG + (1.0 - 0.495f64.powi(2)) / 7e12;
    let modulus = 4.0 / 3.0 / compliance * (RADIUS * POINT / (RADIUS + POINT)).sqrt();
    let overlap = |force: f64| (force / modulus).powf(2.0 / 3.0);
    // 2 N cos α = F, and the centre is where both supports are so far away.
    let mut support = force;
    let mut distance = 0.0;
    for _ in 0..200 {
        distance = RADIUS + POINT - overlap(support);
        support = force / (2.0 * (1.0 - (SPAN / distance).powi(2)).sqrt());
    }
    let centre = (distance * distance - SPAN * SPAN).sqrt() - POINT;
    let grains = measures.grains.unwrap();
    assert!((grains.position[0][1] - centre).abs() < 1e-10 * RADIUS);
    assert!(grains.position[0][0].abs() < 1e-10 * RADIUS);
    let top = pack(0.0).bounds.max[1] - measures.walls.displacement[3];
    assert!((top - (centre + RADIUS - overlap(force))).abs() < 1e-10 * RADIUS);
    let normal = measures.walls.normal_force;
    assert!((normal[3] / force - 1.0).abs() < 1e-9);
    // The supports carry the load together, whatever they push sideways.
    assert!((normal[2] / force - 1.0).abs() < 1e-9, "{}", normal[2]);
    let [x, y, _] = measures.walls.force[2];
    assert!((-y / force - 1.0).abs() < 1e-9 && x.abs() < 1e-9 * force);
    assert_eq!(normal[..2], [0.0; 2]);
}

#[test]
fn work_of_a_point_load_is_stored() {
    let (mut rig, _) = Rig::new(&bend("{normal: hertz}"), &pack(0.0));
    let mut measures = rig.go(load(1e-4));
    let first = measures.state.unwrap();
    for k in 1..=400 {
        measures = rig.go(load(1e-4 + 5e-5 * f64::from(k)));
    }
    let last = measures.state.unwrap();
    let worked = last.wall_work - first.wall_work;
    let stored = last.stored_energy - first.stored_energy;
    // The trapezoidal rule in 400 parts.
    assert!((worked / stored - 1.0).abs() < 1e-4, "{worked:e} {stored:e}");
}

#[test]
fn points_keep_their_contacts_in_a_pack_that_is_stored() {
    let scene = bend("{friction: {coefficient: 0.5}}");
    let (mut rig, _) = Rig::new(&scene, &pack(0.5));
    // A load beside the middle would turn the disc: first straight down, then from the side.
    rig.go(load(0.02));
    let measures = rig.go(load(0.03));
    assert!(measures.state.unwrap().shear_energy > 0.0);
    let saved = rig.twin.pack();
    let contacts = &saved.history.as_ref().unwrap().contacts;
    let seconds: Vec<u32> = contacts.iter().map(|contact| u32::MAX - contact.second).collect();
    assert_eq!(seconds, [4, 3, 2]);
    // The bodies are where the box says.
    let (again, report) = Rig::new(&scene, &saved);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let state = report.measures.unwrap().state.unwrap();
    assert_eq!(state.iterations, 0);
    assert_eq!(again.twin.pack().history, saved.history);
    // Such a body is none of a box.
    let boxed = scene_of_box();
    let refused = Twin::new(&boxed, &saved, 1).unwrap_err().to_string();
    assert!(refused.contains("contacts[0].second"), "{refused}");
}

fn scene_of_box() -> Scene {
    scene("{friction: {coefficient: 0.5}}", "")
}

#[test]
fn open_sides_take_no_order() {
    let (mut rig, _) = Rig::new(&bend("{normal: hertz}"), &pack(0.0));
    let load = WallTarget::Stress(1e5);
    let report = rig.ask(Ask::Targets([load, load, Keep, Keep, Keep, Keep]));
    assert_eq!(report.disposition, Disposition::Invalid);
    assert!(report.text.contains("x_min is asked for something"), "{}", report.text);
    for (walls, text) in [
        ("{open: [z_min]}", "discs have no z_min"),
        ("{open: [x_min], points: {x_min: {at: [0.0], radius: 1.0}}}", "is something else too"),
        ("{points: {y_min: {at: [], radius: 1.0}}}", "no point"),
        ("{points: {y_min: {at: [0.0], radius: 0.0}}}", "radius > 0 m"),
        ("{membranes: [x_min]}", "a membrane carries a stress from the start on"),
    ] {
        let text_of = format!("dimension: 2\npack: {{file: none.csv}}\nwalls: {walls}\n");
        let refused = graintwin::scene::parse(&text_of, "points.yaml".as_ref()).unwrap_err();
        assert!(refused.to_string().contains(text), "{refused}");
    }
}
