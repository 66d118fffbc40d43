//! Recorded pictures as independent readers see them: rosbags and mcap-ros2-support.
#![cfg(feature = "mcap")]

use std::fs;
use std::path::Path;
use std::process::Command;

use graintwin::msg::picture::{Marker, MarkerArray};
use graintwin::pack::generate::generate;
use graintwin::report::{Demand, Measures};
use graintwin::scene::{Choice, ColorBy, Generate, Radius, Scene, Solver, Walls, When};
use graintwin::view::picture::{MOST_SPHERES, Painter};
use serde_json::{Value, json};

use crate::packs::{self, Rig, bead, centered, made, scene};
use crate::python;

/// Runs the program on a scene and records; the folder of the bag.
fn record(folder: &Path, scene: &str) -> std::path::PathBuf {
    let file = folder.join("scene.yaml");
    fs::write(&file, scene).unwrap();
    let bag = folder.join("bag");
    let output = Command::new(env!("CARGO_BIN_EXE_graintwin"))
        .args(["run", "--json", "--threads", "1"])
        .arg(&file)
        .arg("--record")
        .arg(&bag)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    bag
}

/// What the peers see in the pictures of a bag, if there are any peers.
fn seen(bag: &Path, about: &Value) -> Option<Value> {
    let said = python::run("picture.py", &[bag], &about.to_string())?;
    Some(serde_json::from_str(&said).unwrap())
}

#[test]
fn readers_find_each_grain_as_a_sphere_each_strong_contact_as_a_line_and_the_walls_where_they_are()
{
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/g2740_10MPa.csv");
    let scene = format!(
        "name: \"Probe 7 µm\"\npack: {{file: {}, material: glass}}\n\
         load_path: [uniaxial: {{axis: z, strain: 2.0e-4, increments: 2}}]\n",
        data.display()
    );
    let bag = record(folder.path(), &scene);
    let about = json!({"name": "Probe 7 µm", "scale": 1000.0, "color": "pressure"});
    let Some(seen) = seen(&bag, &about) else { return };
    let increments = seen["increments"].as_array().unwrap();
    assert_eq!(increments.len(), 3);
    for (number, increment) in increments.iter().enumerate() {
        assert_eq!(increment["increment"], number);
        assert_eq!(increment["bins"], 16);
        // About a third of the 8000 contacts carry more than the mean.
        assert!((2000..4000).contains(&increment["lines"].as_u64().unwrap()), "{seen}");
    }
    // What a picture of this pack costs in a recording.
    let bytes = |topic: &str| seen["bytes"][topic].as_u64().unwrap();
    assert!(bytes("/graintwin/grains") < 80_000 && bytes("/graintwin/markers") < 320_000, "{seen}");
}

#[test]
fn spheres_of_one_size_are_one_list_and_take_the_colour_of_their_way() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "name: equal\n\
         pack: {generate: {grains: 60, radius: {uniform: [1.0e-3, 1.0e-3]}, material: glass, \
         confining_stress: 1.0e6}}\n\
         view: {scale: 25.0, color: displacement}\n\
         load_path: [uniaxial: {axis: z, strain: 1.0e-3, increments: 3}]\n";
    let bag = record(folder.path(), scene);
    let about = json!({"name": "equal", "scale": 25.0, "color": "displacement"});
    let Some(seen) = seen(&bag, &about) else { return };
    assert!(seen["increments"].as_array().unwrap().iter().all(|one| one["bins"] == 1), "{seen}");
}

#[test]
fn pictures_are_recorded_when_the_scene_says() {
    let folder = tempfile::tempdir().unwrap();
    let pack = "pack: {generate: {grains: 30, radius: {uniform: [1.0e-3, 1.2e-3]}, \
                material: glass, confining_stress: 1.0e6}}\n\
                load_path: [uniaxial: {axis: z, strain: 1.0e-3, increments: 5}]\n";
    for (name, view, expected) in [
        ("always", "outputs: {markers: always}", 6),
        ("never", "outputs: {markers: never}", 0),
        ("third", "view: {every: 3}", 2),
    ] {
        let own = folder.path().join(name);
        fs::create_dir(&own).unwrap();
        let bag = record(&own, &format!("{pack}{view}\n"));
        let text = fs::read_to_string(bag.join("metadata.yaml")).unwrap();
        for topic in ["grains", "markers"] {
            let at = text.find(&format!("name: \"/graintwin/{topic}\"\n")).unwrap();
            let count = text[at..].split("message_count: ").nth(1).unwrap();
            let count: u32 = count.split_whitespace().next().unwrap().parse().unwrap();
            assert_eq!(count, expected, "{name} {topic}");
        }
    }
}

/// Chains are drawn from what is measured, whether the contacts themselves are recorded or not.
#[test]
fn pictures_are_made_again_whatever_else_is_recorded() {
    let pack = "pack: {generate: {grains: 60, radius: {uniform: [1.0e-3, 1.2e-3]}, \
                material: glass, confining_stress: 1.0e6}}\n\
                load_path: [uniaxial: {axis: z, strain: 1.0e-3, increments: 7}]\n";
    let folder = tempfile::tempdir().unwrap();
    for (number, orders) in [
        "record: {exclude: [state, contact_network, grains]}\n",
        "outputs: {contact_network: never}\nview: {every: 3, color: displacement}\n",
        "record: {exclude: [markers]}\nview: {range: [0, 1e6]}\n",
    ]
    .into_iter()
    .enumerate()
    {
        let own = folder.path().join(number.to_string());
        fs::create_dir(&own).unwrap();
        let bag = record(&own, &format!("{pack}{orders}"));
        let output = Command::new(env!("CARGO_BIN_EXE_graintwin"))
            .args(["replay", "--verify"])
            .arg(&bag)
            .output()
            .unwrap();
        assert!(output.status.success(), "{orders}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

fn draw(scene: &Scene, measures: &Measures, side: f64) -> MarkerArray {
    Painter::new(scene, &centered([side; 3]), 1).markers(measures).unwrap()
}

fn of<'a>(array: &'a MarkerArray, namespace: &'a str) -> impl Iterator<Item = &'a Marker> {
    array.markers.iter().filter(move |marker| marker.ns == namespace)
}

/// The measures of a grain between walls, drawn as many times as there are too many.
#[test]
fn of_more_grains_than_viewers_stand_there_are_no_spheres_but_chains_and_walls() {
    let (_, report) = Rig::start(&scene(), &made(60, 1e6, 1));
    let mut measures = report.measures.unwrap();
    let grains = measures.grains.as_mut().unwrap();
    let extra = MOST_SPHERES - grains.radius.len();
    for _ in 0..=extra {
        if grains.radius.len() == MOST_SPHERES {
            let array = draw(&scene(), &measures, 1e-3);
            assert_eq!(of(&array, "spheres").map(|one| one.points.len()).sum::<usize>(), 20_000);
            break;
        }
        grains.position.push([0.0; 3]);
        grains.radius.push(1e-4);
        grains.pressure.push(0.0);
        grains.displacement.push([0.0; 3]);
    }
    let grains = measures.grains.as_mut().unwrap();
    grains.position.push([0.0; 3]);
    grains.radius.push(1e-4);
    grains.pressure.push(0.0);
    grains.displacement.push([0.0; 3]);
    let array = draw(&scene(), &measures, 1e-3);
    assert_eq!(of(&array, "spheres").count(), 0);
    assert_eq!(of(&array, "walls").count(), 6);
    assert!(of(&array, "chains").any(|one| !one.points.is_empty()));
    let painter = Painter::new(&scene(), &centered([1e-3; 3]), 1);
    assert_eq!(painter.cloud(&measures).unwrap().width, 20_001);
}

#[test]
fn the_scale_is_the_power_of_ten_that_brings_the_largest_side_nearest_to_a_metre() {
    let scale = |sides| Painter::new(&scene(), &centered(sides), 1).scale();
    assert_eq!(scale([1e-3, 2e-3, 3e-3]), 1000.0);
    assert_eq!(scale([1e-3, 2e-3, 3.2e-3]), 100.0);
    assert_eq!(scale([0.5, 0.1, 0.1]), 1.0);
    assert_eq!(scale([40.0, 1.0, 1.0]), 0.01);
    let mut given = scene();
    given.view.scale = Choice::Given(7.0);
    assert_eq!(Painter::new(&given, &centered([1e-3; 3]), 1).scale(), 7.0);
}

#[test]
fn the_first_pictures_are_recorded_then_each_tenth_and_those_of_small_packs_for_longer() {
    let recorded = |grains| -> Vec<u64> {
        let painter = Painter::new(&scene(), &centered([1e-3; 3]), grains);
        (0..45).filter(|&increment| painter.records(increment)).collect()
    };
    let ten: Vec<u64> = (0..=10).chain([20, 30, 40]).collect();
    assert_eq!(recorded(2740), ten);
    assert_eq!(recorded(100_000), ten);
    assert_eq!(recorded(1000), (0..=30).chain([40]).collect::<Vec<u64>>());
    assert_eq!(recorded(120), (0..45).collect::<Vec<u64>>());
    let mut given = scene();
    given.view.every = Choice::Given(20);
    let painter = Painter::new(&given, &centered([1e-3; 3]), 1);
    assert_eq!((0..45).filter(|&k| painter.records(k)).collect::<Vec<u64>>(), [0, 20, 40]);
}

#[test]
fn what_was_not_measured_is_not_drawn_and_what_is_empty_is_deleted() {
    let pack = graintwin::pack::Pack {
        bounds: centered([1.9e-3; 3]),
        grains: vec![bead([0.0; 3], 1e-3)],
        history: None,
    };
    let start = |demand| {
        let mut twin = graintwin::twin::Twin::new(&scene(), &pack, 1).unwrap();
        twin.start(demand).measures.unwrap()
    };
    let painter = Painter::new(&scene(), &pack.bounds, pack.grains.len());
    let nothing = start(Demand { grains: false, ..Demand::ALL });
    assert_eq!((painter.cloud(&nothing), painter.markers(&nothing)), (None, None));

    let bare = start(Demand { grains: true, ..Demand::default() });
    let array = painter.markers(&bare).unwrap();
    assert!(of(&array, "chains").all(|one| one.action == Marker::DELETE && one.points.is_empty()));
    assert_eq!(of(&array, "chains").count(), 4);
    assert_eq!(of(&array, "text").next().unwrap().text, "unnamed, increment 0, drawn 1000 : 1");
}

/// Of equal spheres, which are one list in the order of the pack file, the lighter ones are those that
/// moved more.
#[test]
fn spheres_are_coloured_by_the_motion_that_is_measured_with_them() {
    let recipe = Generate { radius: Radius::Constant(1e-4), ..packs::recipe(80, 2e6, 3) };
    let (walls, solver) = (Walls::default(), Solver::default());
    let mut pack = generate(&recipe, &packs::GLASS, &walls, 0.0, solver).unwrap();
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    let friction = "{friction: {coefficient: 0.3}}";
    let text = format!("pack: {{file: none.csv, material: glass}}\ncontact: {friction}\n");
    for color in [ColorBy::NonAffine, ColorBy::D2min, ColorBy::Rotation] {
        let mut scene = graintwin::scene::parse(&text, Path::new("scene.yaml")).unwrap();
        scene.view.color = color;
        scene.outputs.grain_motion = When::OnDemand;
        let mut twin = graintwin::twin::Twin::new(&scene, &pack, 1).unwrap();
        let only_grains = Demand { grains: true, ..Demand::NONE };
        twin.start(only_grains);
        let command = packs::absolute(1, [1e-8, 0.0, 0.0, 0.0, 0.0, 2e-8]);
        let measures = twin.apply(&command, only_grains).measures.unwrap();
        let motion = measures.motion.as_ref().unwrap();
        let length = |vector: &[f64; 3]| vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        let values: Vec<f64> = match color {
            ColorBy::D2min => motion.d2min.clone(),
            ColorBy::Rotation => motion.rotation.iter().map(length).collect(),
            _ => motion.non_affine.iter().map(length).collect(),
        };
        let array = draw(&scene, &measures, 1e-3);
        let spheres: Vec<&Marker> = of(&array, "spheres").collect();
        assert_eq!(spheres.len(), 1);
        let luma = |grain: usize| {
            let color = spheres[0].colors[grain];
            0.2126 * color.r + 0.7152 * color.g + 0.0722 * color.b
        };
        let mut order: Vec<usize> = (0..values.len()).collect();
        // A grain without neighbours enough has the first colour, as the smallest.
        let key = |grain: usize| if values[grain].is_nan() { 0.0 } else { values[grain] };
        order.sort_by(|&one, &other| key(one).total_cmp(&key(other)));
        assert!(order.windows(2).all(|pair| luma(pair[0]) <= luma(pair[1])), "{color:?}");
        assert!(luma(order[0]) < luma(order[values.len() - 1]), "{color:?}");
    }
}

#[test]
fn a_scene_that_forbids_the_motion_cannot_show_it() {
    let parse = |when: When, color: &str| {
        let when = serde_json::to_string(&when).unwrap();
        let text = format!(
            "pack: {{file: none.csv, material: glass}}\nview: {{color: {color}}}\n\
             outputs: {{grain_motion: {when}}}\n"
        );
        graintwin::scene::parse(&text, Path::new("scene.yaml")).map_err(|error| error.to_string())
    };
    for color in ["non_affine", "d2min", "rotation"] {
        let refusal = parse(When::Never, color).unwrap_err();
        assert!(refusal.contains("view.color") && refusal.contains("grain_motion"), "{refusal}");
        assert!(parse(When::OnDemand, color).is_ok());
    }
    assert!(parse(When::Never, "force").is_ok());
}
