//! How viewers see what is round: cylinders with their platens, membranes, and the circles of discs.

use std::f64::consts::PI;
use std::path::Path;

use graintwin::msg::picture::{Marker, MarkerArray};
use graintwin::pack::Pack;
use graintwin::pack::generate::generate;
use graintwin::report::{Demand, Measures};
use graintwin::scene::{self, Cell, Cylinder, Generate, Scene, Solver, Walls};
use graintwin::twin::Twin;
use graintwin::view::picture::Painter;

use crate::packs::{GLASS, bead, recipe};

const SCALE: f64 = 1000.0;

fn scene_of(text: &str) -> Scene {
    scene::parse(text, Path::new("pictures.yaml")).unwrap()
}

fn drawn(scene: &Scene, pack: &Pack) -> (Measures, MarkerArray) {
    let mut twin = Twin::new(scene, pack, 1).unwrap();
    let report = twin.start(Demand::ALL);
    let measures = report.measures.expect(&report.text);
    let painter = Painter::new(scene, &pack.bounds, pack.grains.len());
    assert_eq!(painter.scale(), SCALE);
    let array = painter.markers(&measures).unwrap();
    (measures, array)
}

fn walls(array: &MarkerArray) -> Vec<&Marker> {
    array.markers.iter().filter(|marker| marker.ns == "walls").collect()
}

fn made(inner: Option<f64>) -> Pack {
    let walls = Walls { cell: Cell::Cylinder(Cylinder { inner }), ..Walls::default() };
    let recipe = Generate { aspect: [1.0, 1.0, 1.5], ..recipe(200, 2e6, 5) };
    generate(&recipe, &GLASS, &walls, 0.0, Solver::default()).unwrap()
}

fn near(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-6 * b.abs().max(1e-3), "{a} {b}");
}

#[test]
fn cylinders_stand_where_their_walls_are() {
    const HOLE: f64 = 3e-4;
    let pack = made(Some(HOLE));
    let scene = |open: &str| {
        scene_of(&format!(
            "pack: {{file: none.csv}}\nwalls: {{cell: {{cylinder: {{inner: {HOLE:e}}}}}{open}}}\n"
        ))
    };
    let (measures, array) = drawn(&scene(""), &pack);
    let markers = walls(&array);
    let told = &measures.walls;
    assert_eq!(markers.iter().map(|marker| marker.id).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
    for (w, marker) in markers.iter().enumerate() {
        if w == 2 || w == 3 {
            assert_eq!(marker.action, Marker::DELETE);
            continue;
        }
        assert_eq!((marker.action, marker.r#type), (Marker::ADD, Marker::CYLINDER));
        let outer = 0.5 * (told.position[1] - told.position[0]);
        let radius = if w == 0 { HOLE } else { outer };
        near(marker.scale.x, 2.0 * radius * SCALE);
        near(marker.scale.y, 2.0 * radius * SCALE);
        near(marker.pose.position.x, 500.0 * (told.position[0] + told.position[1]));
        near(marker.pose.position.y, 500.0 * (told.position[2] + told.position[3]));
        let [low, high] = [-0.5, 0.5].map(|end| marker.pose.position.z + end * marker.scale.z);
        let [bottom, top] = [told.position[4], told.position[5]].map(|z| z * SCALE);
        match w {
            4 => near(high, bottom),
            5 => near(low, top),
            // The ends are hidden in the platens.
            _ => assert!(low < bottom && high > top && high - low < 1.02 * (top - bottom)),
        }
    }
    // A borehole has no wall: the smooth pack would fall into it, but its picture is that of the cell.
    let painter = Painter::new(&scene(", open: [x_min]"), &pack.bounds, pack.grains.len());
    let array = painter.markers(&measures).unwrap();
    assert_eq!(walls(&array)[0].action, Marker::DELETE);
    assert_eq!(walls(&array)[1].action, Marker::ADD);
}

#[test]
fn a_membrane_is_drawn_as_it_is_bent() {
    let mut pack = made(None);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.4);
    let scene = scene_of(
        "pack: {file: none.csv}\nwalls: {friction: 0.0, cell: {cylinder: {}}, membranes: [x_max], \
         targets: {x_max: {stress: 2.0e6}}}\ncontact: {friction: {coefficient: 0.4}}\n",
    );
    let (measures, array) = drawn(&scene, &pack);
    let marker = walls(&array)[1];
    assert_eq!((marker.action, marker.r#type), (Marker::ADD, Marker::TRIANGLE_LIST));
    let corners: Vec<[f64; 3]> =
        marker.points.iter().map(|at| [at.x, at.y, at.z].map(|x| x / SCALE)).collect();
    assert!(corners.len() > 100 && corners.len().is_multiple_of(3));
    // Each corner is over the axis where a grain is, and where that is in height or on a platen.
    let grains = &measures.grains.as_ref().unwrap().position;
    let platens = [measures.walls.position[4], measures.walls.position[5]];
    let same = |a: f64, b: f64| (a - b).abs() < 1e-6 * 1e-3;
    for at in &corners {
        let beside = |grain: &&[f64; 3]| same(grain[0], at[0]) && same(grain[1], at[1]);
        let height = |grain: &[f64; 3]| {
            same(grain[2], at[2]) || platens.iter().any(|platen| same(*platen, at[2]))
        };
        assert!(grains.iter().filter(beside).any(height), "{at:?}");
    }
    // With the platens it encloses what the pack is told to fill: radius and height from the walls.
    let centre = [0, 1].map(|axis| {
        0.5 * (measures.walls.position[2 * axis] + measures.walls.position[2 * axis + 1])
    });
    let volume: f64 = corners
        .chunks(3)
        .map(|corner| {
            let [a, b, c] = [corner[0], corner[1], corner[2]];
            let edge = |to: [f64; 3]| [0, 1, 2].map(|k| to[k] - a[k]);
            let ([u, v, w], [x, y, z]) = (edge(b), edge(c));
            let area = [0.5 * (v * z - w * y), 0.5 * (w * x - u * z)];
            (0..2).map(|k| 0.5 * ((a[k] + b[k] + c[k]) / 3.0 - centre[k]) * area[k]).sum::<f64>()
        })
        .sum();
    let radius = 0.5 * (measures.walls.position[1] - measures.walls.position[0]);
    let told = PI * radius * radius * (platens[1] - platens[0]);
    assert!((volume / told - 1.0).abs() < 1e-5, "{volume:e} {told:e}");
    // The platens are as wide as it is.
    let platen = walls(&array)[4];
    assert_eq!(platen.r#type, Marker::CYLINDER);
    near(platen.scale.x, 2.0 * radius * SCALE);
}

#[test]
fn circles_of_discs_are_lines_along_their_walls() {
    const R: f64 = 1e-4;
    let count = 16;
    let at = R / (PI / f64::from(count)).sin() * 0.9999;
    let grains = (0..count).map(|k| {
        let (sin, cos) = (2.0 * PI * f64::from(k) / f64::from(count)).sin_cos();
        bead([at * cos, at * sin, 0.0], R)
    });
    let outer = at + 0.9999 * R;
    let max = [outer, outer, R];
    let bounds = graintwin::wall::Bounds { min: max.map(|x| -x), max };
    let pack = Pack { bounds, grains: grains.collect(), history: None };
    let inner = at - R;
    let scene = scene_of(&format!(
        "dimension: 2\npack: {{file: none.csv}}\nwalls: {{cell: {{annulus: {{inner: {inner:e}}}}}}}\n"
    ));
    let (_, array) = drawn(&scene, &pack);
    let markers = walls(&array);
    for (marker, radius, sign) in [(markers[0], inner, -1.0), (markers[1], outer, 1.0)] {
        assert_eq!((marker.action, marker.r#type), (Marker::ADD, Marker::LINE_STRIP));
        let [first, last] = [&marker.points[0], &marker.points[marker.points.len() - 1]];
        assert!((first.x - last.x).hypot(first.y - last.y) < 1e-6 * SCALE * radius);
        // The edge of the line that faces the pack is the wall.
        for at in &marker.points {
            near(at.x.hypot(at.y) - sign * 0.5 * marker.scale.x, radius * SCALE);
        }
        // No side of the polygon is far inside of the circle.
        assert!(marker.points.len() > 90);
    }
    assert!(markers[2..].iter().all(|marker| marker.action == Marker::DELETE));
}
