//! Packs between two circles.

use std::f64::consts::PI;

use graintwin::command::{Ask, Disposition};
use graintwin::report::Measures;
use graintwin::scene::Scene;
use graintwin::twin::TwinError;
use graintwin::wall::WallTarget::{self, Keep};

use crate::discs::*;

/// Hertz' M of discs of the effective radius `radius` \[m\] with each other, and with the walls.
fn moduli(radius: [f64; 2]) -> [f64; 2] {
    let compliance = (1.0 - POISSON * POISSON) / YOUNG;
    let wall = (1.0 - 0.495f64.powi(2)) / 7e12;
    let modulus = |sum: f64, radius: f64| 4.0 / 3.0 / sum * radius.sqrt();
    [modulus(2.0 * compliance, radius[0]), modulus(compliance + wall, radius[1])]
}

pub(crate) fn ring_scene(inner: f64, rest: &str, contact: &str) -> Scene {
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\ncontact: {contact}\n\
         walls: {{friction: 0.0, cell: {{annulus: {{inner: {inner:e}}}}}{rest}}}\n"
    );
    graintwin::scene::parse(&text, "annulus.yaml".as_ref()).unwrap()
}

/// `count` discs that just touch each other in a ring.
fn ring(count: usize) -> Vec<graintwin::pack::Grain> {
    let radius = RADIUS / (PI / count as f64).sin();
    let angle = |k: usize| 2.0 * PI * k as f64 / count as f64;
    (0..count)
        .map(|k| disc(radius * angle(k).cos(), radius * angle(k).sin(), RADIUS, 0.0))
        .collect()
}

fn square(half: f64) -> graintwin::wall::Bounds {
    boxed([-half; 2], [half; 2])
}

/// Sends x_min and x_max where they are asked to go.
fn sides(inner: WallTarget, outer: WallTarget) -> Ask {
    Ask::Targets([inner, outer, Keep, Keep, Keep, Keep])
}

/// Root of a falling function.
fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[test]
fn a_ring_of_discs_under_pressure_shrinks_as_its_contacts_do() {
    const COUNT: usize = 12;
    let half = (PI / COUNT as f64).sin();
    let mut grains = ring(COUNT);
    grains.iter_mut().for_each(|grain| grain.position = grain.position.map(|x| 0.9995 * x));
    let outer = 0.9995 * RADIUS / half + 0.9995 * RADIUS;
    let pack = graintwin::pack::Pack { bounds: square(outer), grains, history: None };
    let scene = ring_scene(0.5 * outer, ", open: [x_min]", "{normal: hertz}");
    let (mut rig, report) = Rig::new(&scene, &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let stress = 2e5;
    let measures = rig.go(sides(Keep, WallTarget::Stress(stress)));
    let radius = outer - measures.walls.displacement[1];
    // N of the wall on a disc is 2 f sin(π/n) of its neighbours.
    let wall = stress * 2.0 * PI * radius * 2.0 * RADIUS / COUNT as f64;
    let force = wall / (2.0 * half);
    let [grains, walls] = moduli([0.5 * RADIUS, RADIUS / (1.0 - RADIUS / outer)]);
    let overlap = |force: f64, modulus: f64| (force / modulus).powf(2.0 / 3.0);
    let centres = (RADIUS - 0.5 * overlap(force, grains)) / half;
    let want = centres + RADIUS - overlap(wall, walls);
    assert!((radius / want - 1.0).abs() < 1e-10, "{radius:e} {want:e}");
    let normal = measures.walls.normal_force;
    assert!((normal[1] / (COUNT as f64 * wall) - 1.0).abs() < 1e-9);
    assert_eq!(normal[0], 0.0);
    let state = measures.state.unwrap();
    assert!((state.stress_walls[0] / stress - 1.0).abs() < 1e-9);
    assert!((state.stress_walls[4] / stress - 1.0).abs() < 1e-9);
    assert!((state.strain[0] - (1.0 - radius / outer)).abs() < 1e-15);
    assert!((state.strain[1] - (1.0 - radius / outer)).abs() < 1e-15);
    let hole = 0.5 * outer;
    let discs = COUNT as f64 * PI * RADIUS * RADIUS;
    let porosity = 1.0 - discs / (PI * (radius * radius - hole * hole));
    // But for the caps of the contacts, which are of the order of overlap^1.5.
    assert!((state.porosity - porosity).abs() < 1e-3, "{} {porosity}", state.porosity);
    assert!(measures.walls.force[1].iter().all(|f| f.abs() < 1e-9 * normal[1]));
}

#[test]
fn both_walls_hold_a_ring_between_them() {
    const COUNT: usize = 20;
    let half = (PI / COUNT as f64).sin();
    let middle = RADIUS / half;
    let (inner, outer) = (middle - RADIUS, middle + RADIUS);
    let pack = graintwin::pack::Pack { bounds: square(outer), grains: ring(COUNT), history: None };
    let (mut rig, _) = Rig::new(&ring_scene(inner, "", "{normal: hertz}"), &pack);
    let (shrinks, grows) = (1.1e-7, 0.6e-7);
    let targets = [grows, shrinks].map(WallTarget::Displacement);
    let measures = rig.go(sides(targets[0], targets[1]));
    let [grains, inside] = moduli([0.5 * RADIUS, RADIUS / (1.0 + RADIUS / inner)]);
    let [_, outside] = moduli([RADIUS, RADIUS / (1.0 - RADIUS / outer)]);
    let force = |overlap: f64, modulus: f64| modulus * overlap.max(0.0).powf(1.5);
    // Outwards push the neighbours and the inner wall, inwards the outer one.
    let of = |at: f64| {
        [
            force(inner + grows + RADIUS - at, inside),
            force(at + RADIUS - (outer - shrinks), outside),
            2.0 * half * force(2.0 * RADIUS - 2.0 * at * half, grains),
        ]
    };
    let balance = |at: f64| of(at)[0] + of(at)[2] - of(at)[1];
    let [want_in, want_out, _] = of(root(balance, middle - 3e-7, middle + 3e-7));
    let normal = measures.walls.normal_force.map(|force| force / COUNT as f64);
    assert!((normal[0] / want_in - 1.0).abs() < 1e-7, "{} {want_in}", normal[0]);
    assert!((normal[1] / want_out - 1.0).abs() < 1e-7, "{} {want_out}", normal[1]);
}

/// A dense ring of sand between the radii of `inner` and `outer` grains, under `stress` \[Pa\].
fn dense_ring(inner: f64, outer: f64, stress: f64) -> graintwin::pack::Pack {
    let loose = loose(2 * outer as usize, 2 * outer as usize, 5, 0.0);
    let [x, y, _] = loose.bounds.center();
    let half = 0.5 * loose.bounds.sides()[0];
    let hole = inner * half / outer;
    let mut grains = loose.grains;
    grains.retain_mut(|grain| {
        grain.position[0] -= x;
        grain.position[1] -= y;
        let distance = grain.position[0].hypot(grain.position[1]);
        distance < half - 1.3 * RADIUS && distance > hole + 1.3 * RADIUS
    });
    let pack = graintwin::pack::Pack { bounds: square(half), grains, history: None };
    let (mut rig, report) = Rig::new(&ring_scene(hole, "", "{normal: hertz}"), &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    rig.go(sides(WallTarget::Displacement(0.0), WallTarget::Stress(stress)));
    rig.twin.pack()
}

/// Mean stress of the contacts between the radii of `shell` \[m\]: radial and tangential \[Pa\].
fn in_shell(measures: &Measures, pack: &graintwin::pack::Pack, shell: [f64; 2]) -> [f64; 2] {
    let network = measures.network.as_ref().unwrap();
    let position = &measures.grains.as_ref().unwrap().position;
    let mut sum = [0.0; 2];
    for k in 0..network.first.len() {
        let (i, j) = (network.first[k] as usize, network.second[k] as usize);
        let Some(other) = position.get(j) else { continue };
        let branch = [position[i][0] - other[0], position[i][1] - other[1]];
        let at = [position[i][0] - 0.5 * branch[0], position[i][1] - 0.5 * branch[1]];
        let radius = at[0].hypot(at[1]);
        if radius < shell[0] || radius > shell[1] {
            continue;
        }
        let force = [0, 1].map(|a| {
            network.normal_force[k] * network.normal[3 * k + a]
                + network.tangential_force[3 * k + a]
        });
        let out = at.map(|x| x / radius);
        let round = [-out[1], out[0]];
        for (sum, e) in sum.iter_mut().zip([out, round]) {
            *sum += (force[0] * e[0] + force[1] * e[1]) * (branch[0] * e[0] + branch[1] * e[1]);
        }
    }
    let depth = pack.bounds.sides()[2];
    let volume = PI * (shell[1] * shell[1] - shell[0] * shell[0]) * depth;
    sum.map(|sum| sum / volume)
}

#[test]
fn a_cemented_cylinder_is_that_of_lame() {
    let mut pack = dense_ring(5.0, 15.0, 1e5);
    pack.history = None;
    let outer = 0.5 * pack.bounds.sides()[0];
    let inner = 5.0 / 15.0 * 0.5 * 30.0 * 2.7 * RADIUS;
    let contact = "{normal: {linear: {stiffness: 5.0e5, bond: {cohesion: .inf}}}}";
    let (mut rig, report) = Rig::new(&ring_scene(inner, "", contact), &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    // The grains stick together by now: the wall of the hole can go.
    let free = rig.go(sides(WallTarget::Displacement(-0.1 * RADIUS), Keep));
    assert_eq!(free.walls.normal_force[0], 0.0);
    let before = rig.go(sides(Keep, WallTarget::Stress(1e5)));
    let after = rig.go(sides(Keep, WallTarget::Stress(1.1e5)));
    let (a, b) = (inner - 0.1 * RADIUS, outer - before.walls.displacement[1]);
    let lame = |r: f64, sign: f64| b * b / (b * b - a * a) * (1.0 + sign * a * a / (r * r));
    let change = |shell: [f64; 2]| {
        let [now, then] = [&after, &before].map(|measures| in_shell(measures, &pack, shell));
        [0, 1].map(|k| (now[k] - then[k]) / 1e4)
    };
    // Away from both edges, where contacts are fewer; a wall of ten grains is no continuum.
    let third = (b - a) / 3.0;
    for shell in [[a + 0.5 * third, a + 1.5 * third], [a + 1.5 * third, b - 0.5 * third]] {
        let middle = 0.5 * (shell[0] + shell[1]);
        let [radial, tangential] = change(shell);
        let want = [lame(middle, -1.0), lame(middle, 1.0)];
        assert!((radial / want[0] - 1.0).abs() < 0.3);
        assert!((tangential / want[1] - 1.0).abs() < 0.3);
    }
    let state = after.state.unwrap();
    let mean = 0.5 * (state.stress_contacts[0] + state.stress_contacts[4]);
    // The mean stress of a ring under the outer pressure P is P b²/(b² - a²), whatever it is made of.
    let b = outer - after.walls.displacement[1];
    let want = 1.1e5 * b * b / (b * b - a * a);
    assert!((mean / want - 1.0).abs() < 1e-8);
}

#[test]
fn a_hole_without_a_wall_is_one_whose_wall_was_drawn_back() {
    let mut pack = dense_ring(5.0, 12.0, 1e5);
    pack.history = None;
    let outer = 0.5 * pack.bounds.sides()[0];
    let inner = 5.0 / 12.0 * 0.5 * 24.0 * 2.7 * RADIUS;
    let contact = "{normal: {linear: {stiffness: 5.0e5, bond: {cohesion: .inf}}}}";
    let drawn_back = {
        let (mut rig, report) = Rig::new(&ring_scene(inner, "", contact), &pack);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        rig.go(sides(WallTarget::Displacement(-0.1 * RADIUS), Keep));
        rig.go(sides(Keep, WallTarget::Displacement(1e-3 * RADIUS)))
    };
    let without = {
        let (mut rig, report) = Rig::new(&ring_scene(inner, ", open: [x_min]", contact), &pack);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        rig.go(sides(Keep, WallTarget::Displacement(1e-3 * RADIUS)))
    };
    let [one, other] = [&drawn_back, &without].map(|m| m.walls.normal_force[1]);
    assert!((one / other - 1.0).abs() < 2e-3, "{one:e} {other:e}");
    let [one, other] = [&drawn_back, &without].map(|m| m.cracks.as_ref().unwrap().intact);
    assert!(other <= one && other + one / 50 >= one, "{one} {other}");
    // It stands by itself: the mean stress is that of the pressure outside alone.
    let pressure = without.state.unwrap().stress_walls[0];
    let b = outer - without.walls.displacement[1];
    let state = without.state.unwrap();
    let mean = 0.5 * (state.stress_contacts[0] + state.stress_contacts[4]);
    let want = pressure * b * b / (b * b - inner * inner);
    assert!((mean / want - 1.0).abs() < 1e-8, "{mean:e} {want:e}");
}

#[test]
fn what_does_not_fit_an_annulus_is_refused() {
    let grains = ring(12);
    let bounds = boxed([-1e-3; 2], [1e-3, 2e-3]);
    let pack = graintwin::pack::Pack { bounds, grains, history: None };
    let scene = ring_scene(1e-4, "", "{normal: hertz}");
    let oblong = graintwin::twin::Twin::new(&scene, &pack, 1).unwrap_err();
    assert!(matches!(oblong, TwinError::Cell(_)), "{oblong}");
    let pack = graintwin::pack::Pack { bounds: square(1e-3), ..pack };
    let inside = graintwin::twin::Twin::new(&ring_scene(6e-4, "", "{normal: hertz}"), &pack, 1);
    let inside = inside.unwrap_err().to_string();
    assert!(inside.contains("grain 0 is"), "{inside}");
    let (mut rig, _) = Rig::new(&scene, &pack);
    let up = WallTarget::Displacement(1e-7);
    let report = rig.ask(Ask::Targets([Keep, Keep, up, Keep, Keep, Keep]));
    assert_eq!(report.disposition, Disposition::Invalid);
    assert!(report.text.contains("y_min is asked for something"), "{}", report.text);
    let report = rig.ask(sides(Keep, WallTarget::Displacement(8e-4)));
    assert_eq!(report.disposition, Disposition::Limit, "{}", report.text);
    let refused = graintwin::scene::parse(
        "pack: {file: none.csv}\nwalls: {cell: {annulus: {inner: 1.0}}}\n",
        "spheres.yaml".as_ref(),
    );
    assert!(refused.unwrap_err().to_string().contains("walls.cell"));
}
