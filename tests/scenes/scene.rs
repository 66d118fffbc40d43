//! Scenes: what is read, what is refused and in which words.

use std::fs;
use std::path::Path;

use graintwin::scene::{
    self, Choice, ColorBy, Coulomb, Discovery, Fault, Friction, Joint, Late, Lateral, Law, Limits,
    Scene, SceneError, Step, StrainUnit, Update, WallName, When, Zero, prepare,
};

fn parse(text: &str) -> Result<Scene, SceneError> {
    scene::parse(text, Path::new("scene.yaml"))
}

fn refusal(text: &str) -> String {
    match parse(text) {
        Ok(scene) => panic!("accepted: {text}\n{scene:?}"),
        Err(error) => error.to_string(),
    }
}

const PACK: &str = "pack: {file: pack.csv}\n";

/// The example of the interface.
const EXAMPLE: &str = r"
name: glass_beads_uniaxial
dimension: 3
materials:
  glass: {young: 70.0e9, poisson: 0.2, density: 2420.0, spread: 0.1}
walls: {young: 7.0e12, poisson: 0.495, friction: 0.3}
pack:
  generate: {grains: 2740, radius: {uniform: [0.07e-3, 0.13e-3]}, material: glass, seed: 1,
             confining_stress: 10.0e6}
contact:
  normal: hertz
  friction: FRICTION
  torsion: true
gravity: [0.0, 0.0, 0.0]
solver: {method: newton, tolerance: 1.0e-8, max_strain_increment: 1.0e-4}
load_path:
  - uniaxial: {axis: z, strain: 1.0e-3, increments: 10}
outputs: {contact_network: on_demand, markers: on_demand, moduli: secant}
node: {discovery: localhost, stale_after: 0.0}
record: {chunk: 4 MiB, compression: zstd}
";

#[test]
fn every_scene_that_is_shipped_loads_under_its_own_name() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("launch_configs");
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes: Vec<_> =
        files.filter(|file| file.extension().is_some_and(|e| e == "yaml")).collect();
    assert!(scenes.len() > 20);
    for file in scenes {
        let loaded = scene::load(&file).unwrap_or_else(|error| panic!("{error}"));
        if !loaded.scene.name.is_empty() && loaded.scene.dimension == 2 {
            assert_eq!(loaded.scene.name, file.file_stem().unwrap().to_str().unwrap());
        }
    }
}

#[test]
fn the_example_of_the_interface_loads() {
    let frictional = "{coefficient: 0.3, law: return_map, update: frozen}";
    let scene = parse(&EXAMPLE.replace("FRICTION", frictional)).unwrap();
    assert_eq!(scene.name, "glass_beads_uniaxial");
    assert_eq!(scene.pack.generate.as_ref().unwrap().grains, 2740);
    assert_eq!(scene.record.chunk, 4 * 1024 * 1024);
    assert_eq!(scene.outputs.contact_network, When::OnDemand);
    assert_eq!(scene.contact.friction.coefficient(), 0.3);
    let smooth = parse(&EXAMPLE.replace("FRICTION", "none")).unwrap();
    assert_eq!(smooth.contact.friction, Friction::None);
}

#[test]
fn everything_but_the_pack_has_a_default() {
    let scene = parse(PACK).unwrap();
    assert_eq!(scene.dimension, 3);
    assert_eq!(scene.walls.young, 7.0e12);
    assert_eq!(scene.solver.tolerance, 1e-8);
    assert_eq!(scene.node.discovery, Discovery::Localhost);
    assert!(scene.load_path.0.is_empty());
}

/// The table prints E and ν, and K and G beside them: K = E/3(1-2ν), G = E/2(1+ν).
#[test]
fn the_materials_of_the_thesis_need_no_definition() {
    let scene = parse("pack: {file: pack.csv, material: hydrate}").unwrap();
    for (name, density, bulk, shear, spread) in [
        ("quartz", 2650.0, 47.6, 43.5, 0.1),
        ("glass", 2420.0, 38.9, 29.2, 0.1),
        ("hydrate", 900.0, 6.1, 2.5, 0.0),
    ] {
        let material = &scene.materials[name];
        let k = material.young / (3.0 * (1.0 - 2.0 * material.poisson));
        let g = material.young / (2.0 * (1.0 + material.poisson));
        assert!((k * 1e-9 - bulk).abs() < 0.05, "{name}: K = {k}");
        assert!((g * 1e-9 - shear).abs() < 0.05, "{name}: G = {g}");
        assert_eq!((material.density, material.spread), (density, spread), "{name}");
    }
}

#[test]
fn a_definition_takes_the_place_of_a_material_of_the_thesis() {
    let own = "materials: {glass: {young: 1e9, poisson: 0.3, density: 1}}\n";
    let scene = parse(&format!("{own}{PACK}")).unwrap();
    assert_eq!(scene.materials["glass"].young, 1e9);
    assert_eq!(scene.materials["glass"].spread, 0.0);
    assert_eq!(scene.materials["quartz"].young, 100e9);
}

#[test]
fn numbers_may_be_written_without_a_point() {
    let scene = parse(&format!("{PACK}solver: {{tolerance: 1e-3}}\ngravity: [0, 0, -9.81]\n"));
    let scene = scene.unwrap();
    assert_eq!(scene.solver.tolerance, 1e-3);
    assert_eq!(scene.gravity, [0.0, 0.0, -9.81]);
}

#[test]
fn a_load_path_is_a_list_of_steps_or_one_step_alone() {
    let alone = parse(&format!(
        "{PACK}load_path:\n  rig_log: {{file: log.csv, time: t, axial_strain: e, unit: percent, \
         lateral: fixed}}\n"
    ))
    .unwrap();
    let [Step::RigLog(log)] = alone.load_path.0.as_slice() else { panic!("{alone:?}") };
    assert_eq!((log.unit, log.lateral), (StrainUnit::Percent, Lateral::Fixed));

    let listed = parse(&format!(
        "{PACK}load_path:\n\
         - isotropic: {{strain: -1e-3, increments: 2}}\n\
         - repeat:\n    times: 3\n    steps:\n    - commands: path.csv\n    - unload: {{increments: 1}}\n"
    ))
    .unwrap();
    let [Step::Isotropic(_), Step::Repeat(repeat)] = listed.load_path.0.as_slice() else {
        panic!("{listed:?}")
    };
    assert_eq!((repeat.times, repeat.steps.len()), (3, 2));
}

#[test]
fn every_key_of_the_view_has_a_default_and_some_can_be_left_to_the_program() {
    let view = |text: &str| parse(&format!("{PACK}{text}")).unwrap().view;
    let plain = view("");
    assert_eq!((plain.scale, plain.range, plain.every), (Choice::Auto, Choice::Auto, Choice::Auto));
    assert_eq!(view("view: {scale: auto, color: force, range: auto, every: auto}"), plain);
    let given = view("view: {scale: 500, color: displacement, range: [0, 1e-6], every: 7}");
    assert_eq!(given.scale, Choice::Given(500.0));
    assert_eq!(given.color, ColorBy::Displacement);
    assert_eq!(given.range, Choice::Given([0.0, 1e-6]));
    assert_eq!(given.every, Choice::Given(7));
    for word in ["always", "on_demand", "never"] {
        parse(&format!("{PACK}outputs: {{markers: {word}}}")).unwrap();
    }
}

#[test]
fn a_view_that_cannot_be_drawn_is_refused_with_what_is_allowed() {
    refused(&behind_pack(&[
        ("view: {scale: big}", "2:15: view.scale: `big` is no number; allowed: auto, or numbers"),
        ("view: {scale: 0}", "2:15: view.scale: 0.0 is outside 0 < scale <= 1e12, or auto"),
        ("view: {scale: .inf}", "2:15: view.scale: inf is not a finite number"),
        ("view: {range: 3}", "2:8: view.range: invalid type: integer `3`, expected an array"),
        ("view: {range: [1, 1]}", "2:19: view.range[1]: 1.0 is outside high > low = 1.0"),
        ("view: {range: [1, 2, 3]}", "2:15: view.range: "),
        ("view: {opacity: 0}", "2:17: view.opacity: 0.0 is outside 0 < opacity <= 1"),
        ("view: {every: 0}", "2:15: view.every: 0 is outside 1 to 1000000000"),
        ("view: {every: 1.5}", "2:8: view.every: invalid type: floating point `1.5`"),
        ("view: {color: red}", "2:15: view.color: unknown variant `red`, expected"),
        ("view: {colour: force}", "2:8: view.colour: unknown field `colour`"),
    ]));
}

/// The friction of a scene with `contact`.
fn friction(contact: &str) -> Friction {
    parse(&format!("{PACK}contact: {{{contact}}}")).unwrap().contact.friction
}

#[test]
fn without_a_word_of_it_there_is_no_friction() {
    let scene = parse(PACK).unwrap();
    assert_eq!((scene.contact.friction, scene.walls.friction), (Friction::None, None));
    assert_eq!(friction("friction: none"), Friction::None);
    assert_eq!(friction("torsion: false"), Friction::None);
}

#[test]
fn every_key_of_friction_has_a_default() {
    let default = Coulomb { coefficient: 0.3, law: Law::ReturnMap, update: Update::Frozen };
    assert_eq!(friction("friction: {}"), Friction::Coulomb(default));
    for (keys, expected) in [
        ("coefficient: 0", Coulomb { coefficient: 0.0, ..default }),
        ("coefficient: .inf", Coulomb { coefficient: f64::INFINITY, ..default }),
        ("law: return_map", default),
        ("law: secant", Coulomb { law: Law::Secant, ..default }),
        ("law: mindlin_deresiewicz", Coulomb { law: Law::MindlinDeresiewicz, ..default }),
        ("update: frozen", default),
        ("update: current", Coulomb { update: Update::Current, ..default }),
    ] {
        assert_eq!(friction(&format!("friction: {{{keys}}}")), Friction::Coulomb(expected));
    }
    assert!(parse(&format!("{PACK}contact: {{friction: {{}}}}")).unwrap().contact.torsion);
}

#[test]
fn walls_may_be_smooth_rough_or_perfectly_rough() {
    for (word, coefficient) in [("0", 0.0), ("0.7", 0.7), (".inf", f64::INFINITY)] {
        let scene = parse(&format!("{PACK}walls: {{friction: {word}}}")).unwrap();
        assert_eq!(scene.walls.friction, Some(coefficient));
    }
}

#[test]
fn an_echo_of_friction_writes_its_defaults_and_infinity_as_yaml_does() {
    let text = format!("{PACK}walls: {{friction: .inf}}\ncontact: {{friction: {{law: secant}}}}");
    let echo = parse(&text).unwrap().to_yaml().unwrap();
    let block = "contact:\n  normal: hertz\n  friction:\n    coefficient: 0.3\n    law: secant\n    \
                 update: frozen\n  torsion: true\n";
    assert!(echo.contains(block), "{echo}");
    assert!(echo.contains("\n  friction: .inf\n"), "{echo}");

    let smooth = parse(PACK).unwrap().to_yaml().unwrap();
    assert!(smooth.contains("contact:\n  normal: hertz\n  friction: none\n"), "{smooth}");
    assert!(
        smooth.contains("walls:\n  young: 7000000000000.0\n  poisson: 0.495\npack:"),
        "{smooth}"
    );
}

#[test]
fn wrong_friction_is_named_with_line_column_field_and_what_is_allowed() {
    refused(&behind_pack(&[
        (
            "contact: {friction: rough}",
            "2:11: contact.friction: unknown variant `rough`, expected one of none, {coefficient",
        ),
        (
            "contact: {friction: 0.3}",
            "2:11: contact.friction: invalid type: floating point `0.3`, expected `none`, or a mapping",
        ),
        (
            "contact: {friction: [0.3]}",
            "2:11: contact.friction: invalid type: sequence, expected `none`, or a mapping",
        ),
        (
            "contact: {friction: {coeficient: 0.3}}",
            "2:22: contact.friction.coeficient: unknown field `coeficient`, expected one of \
             coefficient, law, update",
        ),
        (
            "contact:\n  friction: {law: mindlin}",
            "3:19: contact.friction.law: unknown variant `mindlin`, expected one of return_map, \
             secant, mindlin_deresiewicz",
        ),
        (
            "contact: {friction: {update: sometimes}}",
            "2:30: contact.friction.update: unknown variant `sometimes`, expected one of frozen, \
             current",
        ),
        (
            "contact: {friction: {coefficient: rough}}",
            "2:35: contact.friction.coefficient: `rough` is not a number",
        ),
        (
            "contact: {friction: {coefficient: -0.1}}",
            "2:35: contact.friction.coefficient: -0.1 is outside coefficient >= 0, .inf included",
        ),
        (
            "contact: {friction: {coefficient: .nan}}",
            "2:35: contact.friction.coefficient: NaN is outside coefficient >= 0, .inf included",
        ),
        (
            "contact: {friction: {coefficient: -.inf}}",
            "2:35: contact.friction.coefficient: -inf is outside coefficient >= 0",
        ),
        ("walls: {friction: .nan}", "2:19: walls.friction: NaN is outside friction >= 0, .inf"),
        ("walls: {friction: none}", "2:19: walls.friction: `none` is not a number"),
    ]));
}

/// A scene with friction and these steps of a preparation, on a line each from line 3 on.
fn with_steps(steps: &[&str]) -> String {
    let steps: String = steps.iter().map(|step| format!("  - {step}\n")).collect();
    format!("pack:\n  prepare:\n{steps}  file: a.csv\ncontact: {{friction: {{}}}}\n")
}

#[test]
fn a_preparation_has_steps_with_defaults() {
    let steps = [
        "isotropic: {confining_stress: 10.0e6}",
        "uniaxial: {}",
        "uniaxial: {axis: x, moving: min, steady: 0.1, window: 3, max_strain: 0.4}",
        "uniaxial: {strain: -1.0e-3, strain_increment: 1.0e-5}",
    ];
    let steps = parse(&with_steps(&steps)).unwrap().pack.prepare;
    let [prepare::Step::Isotropic(confined), built_up, given, strained] = steps.as_slice() else {
        panic!("{steps:?}")
    };
    assert_eq!(confined.confining_stress, 10e6);
    let end = prepare::Steady { steady: 0.005, window: 10, max_strain: 0.02 };
    let default = prepare::Uniaxial {
        axis: scene::Axis::Z,
        moving: scene::Moving::Both,
        strain_increment: 1e-4,
        end: prepare::End::Steady(end),
    };
    assert_eq!(*built_up, prepare::Step::Uniaxial(default));
    let end = prepare::Steady { steady: 0.1, window: 3, max_strain: 0.4 };
    let (axis, moving) = (scene::Axis::X, scene::Moving::Min);
    let other = prepare::Uniaxial { axis, moving, end: prepare::End::Steady(end), ..default };
    assert_eq!(*given, prepare::Step::Uniaxial(other));
    let end = prepare::End::Strain(-1e-3);
    let other = prepare::Uniaxial { strain_increment: 1e-5, end, ..default };
    assert_eq!(*strained, prepare::Step::Uniaxial(other));
    assert!(parse(PACK).unwrap().pack.prepare.is_empty());
}

#[test]
fn wrong_preparations_are_named_with_their_step() {
    let cases = [
        ("squeeze: {}", "3:5: pack.prepare[0].squeeze: unknown variant `squeeze`, expected one of"),
        ("isotropic: {}", "3:16: pack.prepare[0].isotropic: missing field `confining_stress`"),
        (
            "isotropic: {confining_stress: 0}",
            "3:35: pack.prepare[0].isotropic.confining_stress: 0.0 is outside confining_stress > 0",
        ),
        (
            "isotropic: {confining_stress: .inf}",
            "3:35: pack.prepare[0].isotropic.confining_stress: inf is not a finite number",
        ),
        (
            "isotropic: {confining_stress: 1e6, friction: 0}",
            "3:40: pack.prepare[0].isotropic.friction: unknown field `friction`, expected",
        ),
        (
            "uniaxial: {increments: 3}",
            "3:16: pack.prepare[0].uniaxial.increments: unknown field `increments`, expected one \
             of axis, moving, strain_increment, strain, steady, window, max_strain",
        ),
        (
            "uniaxial: {strain: 1e-3, window: 5}",
            "3:15: pack.prepare[0].uniaxial: `strain` alone ends the step; allowed: `strain`, or",
        ),
        (
            "uniaxial: {axis: w}",
            "3:22: pack.prepare[0].uniaxial.axis: unknown variant `w`, expected one of x, y, z",
        ),
        (
            "uniaxial: {strain: 0}",
            "3:24: pack.prepare[0].uniaxial.strain: 0.0 is outside -0.5 < strain < 0.5, not 0",
        ),
        (
            "uniaxial: {strain: 0.5}",
            "3:24: pack.prepare[0].uniaxial.strain: 0.5 is outside -0.5 < strain < 0.5",
        ),
        (
            "uniaxial: {strain: .nan}",
            "3:24: pack.prepare[0].uniaxial.strain: NaN is not a finite number",
        ),
        (
            "uniaxial: {strain_increment: 0}",
            "3:34: pack.prepare[0].uniaxial.strain_increment: 0.0 is outside 1e-7 <=",
        ),
        ("uniaxial: {steady: 0}", "3:24: pack.prepare[0].uniaxial.steady: 0.0 is outside 0 <"),
        ("uniaxial: {steady: 1.1}", "3:24: pack.prepare[0].uniaxial.steady: 1.1 is outside 0 <"),
        ("uniaxial: {window: 0}", "3:24: pack.prepare[0].uniaxial.window: 0 is outside 1 to"),
        (
            "uniaxial: {window: 2.5}",
            "3:24: pack.prepare[0].uniaxial.window: `2.5` is not a whole number",
        ),
        (
            "uniaxial: {max_strain: 0.5}",
            "3:28: pack.prepare[0].uniaxial.max_strain: 0.5 is outside 0.001 <= max_strain < 0.5",
        ),
        (
            "uniaxial: {max_strain: 0.9e-3}",
            "3:28: pack.prepare[0].uniaxial.max_strain: 0.0009 is outside 0.001 <= max_strain < \
             0.5, where `window` increments have room",
        ),
    ];
    let cases: Vec<_> =
        cases.into_iter().map(|(step, start)| (with_steps(&[step]), start)).collect();
    refused(&cases);
}

#[test]
fn without_friction_a_preparation_cannot_wait_for_contacts_to_slide() {
    let smooth = |step: &str| format!("pack:\n  file: a.csv\n  prepare: [{{{step}}}]\n");
    parse(&smooth("uniaxial: {strain: 1e-3}")).unwrap();
    refused(&[(
        smooth("uniaxial: {}"),
        "3:24: pack.prepare[0].uniaxial: without friction no contact slides; allowed: \
         `contact.friction`, or `strain`",
    )]);
}

/// Checks the start of the message of each text.
fn refused(cases: &[(String, &str)]) {
    let mut wrong = String::new();
    for (text, start) in cases {
        let message = refusal(text);
        if !message.starts_with(&format!("scene.yaml:{start}")) {
            wrong += &format!("{text}\n  says  {message}\n  not   scene.yaml:{start}\n");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

/// The texts behind a line with a pack.
fn behind_pack<'a>(cases: &[(&str, &'a str)]) -> Vec<(String, &'a str)> {
    cases.iter().map(|&(text, start)| (format!("{PACK}{text}\n"), start)).collect()
}

#[test]
fn wrong_form_is_named_with_line_column_field_and_what_is_allowed() {
    refused(&behind_pack(&[
        (
            "solver: {tolerence: 1e-8}",
            "2:10: solver.tolerence: unknown field `tolerence`, expected one of method, tolerance, \
             max_strain_increment",
        ),
        ("solvers: {}", "2:1: solvers: unknown field `solvers`, expected one of name, dimension"),
        ("pack: {file: other.csv}", "2:1: duplicate mapping key `pack`"),
        ("solver: {tolerance: 1e-8, tolerance: 1e-8}", "2:27: duplicate mapping key `tolerance`"),
        ("solver: {tolerance: small}", "2:21: solver.tolerance: `small` is not a number"),
        (
            "solver: {max_iterations: 1.5}",
            "2:26: solver.max_iterations: `1.5` is not a whole number",
        ),
        ("solver: {max_iterations: -1}", "2:26: solver.max_iterations: `-1` is not a whole number"),
        ("solver: 0.5", "2:9: solver: `0.5` stands here; allowed: keys with values"),
        ("solver:", "2:7: solver: nothing stands here; allowed: keys with values"),
        ("gravity: [0, 0]", "2:1: gravity: invalid length 2, expected an array of length 3"),
        ("gravity: 9.81", "2:10: gravity: `9.81` stands here; allowed: a list"),
        ("solver:\n\ttolerance: 1e-8", "3:2: tabs disallowed"),
        ("solver: {tolerance: 1e-8", "2:9: unclosed bracket"),
        (
            "---\npack: {file: b.csv}",
            "3:1: a second document begins here; allowed: one scene a file",
        ),
        (
            "solver: {method: fire}",
            "2:18: solver.method: unknown variant `fire`, expected one of newton, \
             conjugate_gradient, gauss_seidel, dynamic",
        ),
        ("contact: {torsion: 1}", "2:20: contact.torsion: `1` is not true or false"),
        ("contact: {torsion: yes}", "2:20: contact.torsion: `yes` is not true or false"),
        ("name: [a]", "2:7: name: a list stands here; allowed: one value"),
    ]));
}

#[test]
fn values_out_of_range_are_named_with_line_column_field_and_what_is_allowed() {
    refused(&behind_pack(&[
        (
            "solver: {tolerance: 1}",
            "2:21: solver.tolerance: 1.0 is outside 1e-13 <= tolerance <= 1e-2",
        ),
        (
            "solver: {tolerance: .nan}",
            "2:21: solver.tolerance: NaN is not a finite number; allowed: 1e-13",
        ),
        ("solver: {tolerance: 1e999}", "2:21: solver.tolerance: `inf` is not a number"),
        (
            "solver: {max_strain_increment: 0}",
            "2:32: solver.max_strain_increment: 0.0 is outside 0 <",
        ),
        ("solver: {max_overlap_share: 0}", "2:29: solver.max_overlap_share: 0.0 is outside 0 <"),
        ("solver: {max_iterations: 0}", "2:26: solver.max_iterations: 0 is outside 1 to"),
        ("solver: {step_cap: 0}", "2:20: solver.step_cap: 0.0 is outside 1e-4 <="),
        ("solver: {damping: 1}", "2:19: solver.damping: 1.0 is outside 0 < damping < 1"),
        (
            "materials: {m: {young: 0, poisson: 0.2, density: 1}}",
            "2:24: materials.m.young: 0.0 is outside young > 0 Pa",
        ),
        (
            "materials: {m: {young: 1, poisson: 0.5, density: 1}}",
            "2:36: materials.m.poisson: 0.5 is outside -1 < nu < 0.5",
        ),
        (
            "materials: {m: {young: 1, poisson: -1, density: 1}}",
            "2:36: materials.m.poisson: -1.0 is outside -1 < nu < 0.5",
        ),
        (
            "materials: {m: {young: 1, poisson: 0.2, density: -1}}",
            "2:50: materials.m.density: -1.0 is outside density > 0 kg/m³",
        ),
        (
            "materials: {m: {young: 1, poisson: 0.2, density: 1, spread: 0.31}}",
            "2:61: materials.m.spread: 0.31 is outside 0 <= spread <= 0.3",
        ),
        (
            "materials: {m: {young: 1, poisson: 0.499, density: 1, spread: 0.1}}",
            "2:36: materials.m.poisson: 0.499 is outside -0.99 < nu < 0.495",
        ),
        ("materials: {m: {young: 1, density: 1}}", "2:27: materials.m: missing field `poisson`"),
        ("walls: {young: -7e12}", "2:16: walls.young: -7000000000000.0 is outside young > 0 Pa"),
        ("walls: {poisson: 0.5}", "2:18: walls.poisson: 0.5 is outside -1 < nu < 0.5"),
        (
            "walls: {friction: -0.1}",
            "2:19: walls.friction: -0.1 is outside friction >= 0, .inf included",
        ),
        ("dimension: 4", "2:12: dimension: 4; allowed: 2, 3"),
        ("name: ''", "2:7: name: \"\" is no name"),
        (
            "reference: {min: [0, 0, 0], max: [1, 0, 1]}",
            "2:38: reference.max[1]: y: 0.0 is outside max > min = 0.0",
        ),
        (
            "node: {measured_wrench: {walls: [z_max, top]}}",
            "2:33: node.measured_wrench.walls: `top` is no wall; allowed: x_min, x_max, y_min",
        ),
        (
            "node: {measured_wrench: {walls: [z_max, z_max]}}",
            "2:33: node.measured_wrench.walls: z_max stands here twice; allowed: each wall once",
        ),
        (
            "node: {measured_wrench: {walls: z_max}}",
            "2:33: node.measured_wrench.walls: `z_max` stands here; allowed: a list",
        ),
        (
            "node: {measured_wrench: {sign: 2}}",
            "2:32: node.measured_wrench.sign: 2.0 is outside 1 and -1",
        ),
        (
            "node: {measured_wrench: {max_delay: -1}}",
            "2:37: node.measured_wrench.max_delay: -1.0 is outside max_delay >= 0 s",
        ),
        ("node: {stale_after: -1}", "2:21: node.stale_after: -1.0 is outside stale_after >= 0 s"),
        ("node: {domain_id: 233}", "2:19: node.domain_id: 233 is outside 0 to 232"),
        (
            "node: {service_mapping: basic}",
            "2:25: node.service_mapping: unknown variant `basic`, expected one of auto, enhanced",
        ),
        ("record: {chunk: 4 miB}", "2:17: record.chunk: `4 miB` is no size"),
        ("record: {chunk: 99999999999 GiB}", "2:17: record.chunk: `99999999999 GiB` is no size"),
        ("record: {chunk: 64 KiB}", "2:17: record.chunk: 65536 bytes is outside 1 MiB to 1 GiB"),
    ]));
}

#[test]
fn wrong_limits_and_joints_are_named_with_what_is_allowed() {
    refused(&behind_pack(&[
        (
            "node: {limits: {travel: -1}}",
            "2:25: node.limits.travel: -1.0 is outside travel >= 0 m, 0 = no limit",
        ),
        ("node: {limits: {force: .nan}}", "2:24: node.limits.force: NaN is not a finite number"),
        ("node: {limits: {speed: 1}}", "2:17: node.limits.speed: unknown field `speed`"),
        ("node: {hold_after: [gap]}", "2:21: node.hold_after[0]: unknown variant `gap`"),
        ("node: {late: drop}", "2:14: node.late: unknown variant `drop`, expected one of every"),
        ("node: {joint_states: {}}", "2:22: node.joint_states: missing field `joints`"),
        (
            "node: {joint_states: {joints: {}}}",
            "2:31: node.joint_states.joints: no joint moves a wall; allowed: at least one",
        ),
        (
            "node: {joint_states: {joints: {a: {wall: top}}}}",
            "2:42: node.joint_states.joints.a.wall: unknown variant `top`, expected one of x_min",
        ),
        (
            "node: {joint_states: {joints: {a: {wall: z_max}, b: {wall: z_max}}}}",
            "2:60: node.joint_states.joints.b.wall: `a` moves z_max already; allowed: one joint a",
        ),
        (
            "node: {joint_states: {joints: {a: {wall: z_max, sign: 2}}}}",
            "2:55: node.joint_states.joints.a.sign: 2.0 is outside 1 and -1",
        ),
        (
            "node: {joint_states: {joints: {a: {wall: z_max, gear: 0}}}}",
            "2:55: node.joint_states.joints.a.gear: 0.0 is outside gear > 0 m a unit of the joint",
        ),
        (
            "node: {joint_states: {joints: {a: {wall: z_max, zero: last}}}}",
            "2:49: node.joint_states.joints.a.zero: unknown variant `last`, expected one of a number",
        ),
        (
            "node: {joint_trajectory: {joints: {a: {wall: z_max, zero: first}}}}",
            "2:59: node.joint_trajectory.joints.a.zero: `first` is for node.joint_states; allowed",
        ),
    ]));
}

#[test]
fn limits_and_joints_are_read() {
    let text = "pack: {file: a.csv}\nnode:\n  limits: {travel: 1e-3, force: 10, clamp: true}\n  \
                hold_after: [not_converged, limit]\n  late: merge\n  joint_states:\n    joints:\n      \
                top: {wall: z_max, sign: -1, zero: first, gear: 2.0e-3}\n      \
                side: {wall: x_min, zero: 5}\n";
    let node = scene::parse(text, Path::new("scene.yaml")).unwrap().node;
    let limits = Limits { travel: 1e-3, force: 10.0, clamp: true, ..Limits::default() };
    assert_eq!(node.limits, limits);
    assert_eq!(
        (node.hold_after, node.late),
        (vec![Fault::NotConverged, Fault::Limit], Late::Merge)
    );
    let joints = node.joint_states.unwrap().joints;
    let top = Joint { wall: WallName::ZMax, sign: -1.0, zero: Zero::First, gear: 2e-3 };
    let side = Joint { wall: WallName::XMin, sign: 1.0, zero: Zero::At(5.0), gear: 1.0 };
    assert_eq!((joints["top"], joints["side"]), (top, side));
    assert_eq!([WallName::XMin.index(), WallName::ZMax.index()], [0, 5]);
}

#[test]
fn wrong_load_paths_are_named_with_their_step() {
    refused(&behind_pack(&[
        (
            "load_path: fast",
            "2:1: load_path: invalid type: string \"fast\", expected a list of steps",
        ),
        (
            "load_path: [squeeze: {}]",
            "2:13: load_path[0].squeeze: unknown variant `squeeze`, expected one of isotropic,",
        ),
        (
            "load_path: [uniaxial: {strain: 1e-3}]",
            "2:24: load_path[0].uniaxial: missing field `increments`",
        ),
        (
            "load_path: [uniaxial: {strain: 1e-3, increments: 0}]",
            "2:50: load_path[0].uniaxial.increments: 0 is outside 1 to",
        ),
        (
            "load_path: [uniaxial: {strain: 1, increments: 1}]",
            "2:32: load_path[0].uniaxial.strain: 1.0 is outside -1 < strain < 1",
        ),
        (
            "load_path: [uniaxial: {axis: w, strain: 1e-3, increments: 1}]",
            "2:30: load_path[0].uniaxial.axis: unknown variant `w`, expected one of x, y, z",
        ),
        (
            "load_path: [polyaxial: {strain: [0, .inf, 0], increments: 1}]",
            "2:37: load_path[0].polyaxial.strain[1]: inf is not a finite number",
        ),
        (
            "load_path: [unload: {to: 1.5, increments: 1}]",
            "2:26: load_path[0].unload.to: 1.5 is outside 0 <= to < 1",
        ),
        (
            "load_path: [repeat: {times: 0, steps: []}]",
            "2:29: load_path[0].repeat.times: 0 is outside 1 to",
        ),
        (
            "load_path: {rig_log: {file: a, time: t, axial_strain: t}}",
            "2:55: load_path[0].rig_log.axial_strain: `t` is the column of the time as well",
        ),
        (
            "load_path:\n  uniaxial: {strain: 1e-3, increments: 1}\n  unload: {increments: 1}",
            "3:3: load_path.uniaxial: more than one step; allowed: a list with one `- step: {...}`",
        ),
        (
            "load_path: [repeat: {times: 1000000, steps: [unload: {increments: 2}]}]",
            "2:12: load_path: more than 1000000 increments",
        ),
    ]));
}

#[test]
fn what_this_version_cannot_do_is_said_so() {
    let linear = "2:19: contact.normal: linear contacts are those of discs; allowed: hertz, cement, or \
                  `dimension: 2`";
    refused(&behind_pack(&[("contact: {normal: {linear: {stiffness: 1}}}", linear)]));
}

#[test]
fn the_force_chains_are_a_share_of_the_contacts() {
    let scene = parse(&format!("{PACK}outputs: {{fabric: never, chain_share: 1.0}}")).unwrap();
    assert_eq!((scene.outputs.fabric, scene.outputs.chain_share), (When::Never, 1.0));
    assert_eq!(parse(PACK).unwrap().outputs.chain_share, 0.1);
    let outside =
        |text: &str| format!("2:24: outputs.chain_share: {text} is outside above 0, at most 1");
    refused(&behind_pack(&[
        ("outputs: {chain_share: 0.0}", &outside("0.0")),
        ("outputs: {chain_share: 1.5}", &outside("1.5")),
        ("outputs: {chain_share: .nan}", "2:24: outputs.chain_share: NaN is not a finite number"),
    ]));
}

#[test]
fn a_pack_is_made_or_read_and_its_keys_fit() {
    let generate =
        "generate: {grains: 10, radius: {constant: 1e-4}, material: glass, confining_stress: 1e6}";
    parse(&format!("pack: {{{generate}}}")).unwrap();
    let with = |more: &str| format!("pack: {{{generate}{more}}}");
    let changed = |from: &str, to: &str| format!("pack: {{{}}}", generate.replace(from, to));
    refused(&[
        ("name: nothing".into(), "1:1: missing field `pack`"),
        ("pack: {}".into(), "1:7: pack: neither `generate` nor `crystal` nor `file` is given"),
        (with(", file: a.csv"), "1:7: pack: more than one of `generate`, `crystal` and `file`"),
        (with(", material: glass"), "1:108: pack.material: only for a pack that is read"),
        (with(", seed: 3"), "1:104: pack.seed: only for a pack that is read"),
        (
            "pack: {file: a.csv, material: iron}".into(),
            "1:31: pack.material: no material is named `iron`; known: glass, hydrate, quartz",
        ),
        (
            changed("glass", "iron"),
            "1:67: pack.generate.material: no material is named `iron`; known: glass",
        ),
        (changed("10,", "0,"), "1:27: pack.generate.grains: 0 is outside 1 to"),
        (changed("1e-4", "0"), "1:50: pack.generate.radius.constant: 0.0 is outside radius > 0 m"),
        (
            changed("1e-4", "-.inf"),
            "1:50: pack.generate.radius.constant: -inf is not a finite number",
        ),
        (
            changed("constant: 1e-4", "uniform: [2e-4, 1e-4]"),
            "1:49: pack.generate.radius.uniform: 0.0002 is above 0.0001",
        ),
        (
            changed("1e6", "0"),
            "1:92: pack.generate.confining_stress: 0.0 is outside confining_stress > 0 Pa",
        ),
        (
            "pack: {file: a.csv, cut: {min: [0, 0, 0], max: [1, 1, -1]}}".into(),
            "1:55: pack.cut.max[2]: z: -1.0 is outside max > min = 0.0",
        ),
        (
            "pack: {file: a.csv, box: {min: [0, 0, .nan], max: [1, 1, 1]}}".into(),
            "1:39: pack.box.min[2]: NaN is not a finite number",
        ),
    ]);
}

#[test]
fn every_problem_is_told_at_once_each_on_its_line() {
    let text = "pack: {file: a.csv, material: iron}\n\
                materials:\n  glass:\n    young: -1\n    poisson: 0.7\n    density: .inf\n\
                solver: {tolerance: 1}\n";
    assert_eq!(
        refusal(text),
        "scene.yaml:1:31: pack.material: no material is named `iron`; known: glass, hydrate, quartz\n\
         scene.yaml:4:12: materials.glass.young: -1.0 is outside young > 0 Pa\n\
         scene.yaml:5:14: materials.glass.poisson: 0.7 is outside -1 < nu < 0.5\n\
         scene.yaml:6:14: materials.glass.density: inf is not a finite number; \
         allowed: density > 0 kg/m³\n\
         scene.yaml:7:21: solver.tolerance: 1.0 is outside 1e-13 <= tolerance <= 1e-2"
    );
}

#[test]
fn a_value_behind_an_alias_is_named_where_it_is_used() {
    let text =
        format!("{PACK}materials:\n  a: &a {{young: 0, poisson: 0.2, density: 1}}\n  b: *a\n");
    let message = refusal(&text);
    let lines: Vec<_> = message.lines().collect();
    assert!(lines[0].starts_with("scene.yaml:3:17: materials.a.young: 0.0 is"), "{message}");
    assert!(lines[1].starts_with("scene.yaml:4:6: materials.b.young: 0.0 is"), "{message}");
}

/// Every number of a scene with every kind of key, one after the other, made NaN and infinite.
#[test]
fn no_number_of_a_scene_may_be_nan_or_infinite() {
    let full = parse(
        "materials: {m: {young: 1e9, poisson: 0.2, density: 1000, spread: 0.1}}\n\
         pack:\n  generate: {grains: 5, radius: {uniform: [1e-4, 2e-4]}, material: m, \
         confining_stress: 1e6}\n  cut: {min: [-1, -1, -1], max: [1, 1, 1]}\n  \
         prepare: [isotropic: {confining_stress: 1e6}, uniaxial: {strain: 0.001}]\n\
         reference: {min: [-1, -1, -1], max: [1, 1, 1]}\n\
         load_path:\n\
         - isotropic: {strain: 0.001, increments: 1}\n\
         - uniaxial: {strain: 0.001, increments: 1}\n\
         - triaxial: {axial_strain: 0.001, lateral_strain: -0.0005, increments: 1}\n\
         - polyaxial: {strain: [0.001, 0.001, 0.001], increments: 1}\n\
         - unload: {to: 0.5, increments: 1}\n\
         - repeat: {times: 2, steps: [unload: {increments: 1}]}\n",
    )
    .unwrap();
    let yaml = full.to_yaml().unwrap();
    let mut numbers = 0;
    for (index, line) in yaml.lines().enumerate() {
        let word = line.rsplit(' ').next().unwrap();
        if word.parse::<f64>().is_err() {
            continue;
        }
        numbers += 1;
        for value in [".nan", ".inf", "-.inf"] {
            let mut lines: Vec<_> = yaml.lines().map(str::to_owned).collect();
            lines[index] = format!("{}{value}", &line[..line.len() - word.len()]);
            let message = refusal(&lines.join("\n"));
            let at = format!("scene.yaml:{}:", index + 1);
            assert!(message.contains(&at), "{line} with {value}: {message}");
        }
    }
    assert!(numbers > 60, "{numbers} numbers found in\n{yaml}");
}

#[test]
fn huge_nesting_and_bombs_of_anchors_are_refused() {
    let deep = format!("pack: {}{}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(refusal(&deep).starts_with("scene.yaml:1:"), "{}", refusal(&deep));

    let step = |depth: usize| {
        let indent = "    ".repeat(depth);
        format!("{indent}- repeat:\n{indent}    times: 1\n{indent}    steps:\n")
    };
    let repeats: String = (0..200).map(step).collect();
    assert!(refusal(&format!("{PACK}load_path:\n{repeats}")).contains("nested"));

    let mut bomb = "a0: &a0 [0, 0, 0, 0, 0, 0, 0, 0, 0, 0]\n".to_owned();
    for level in 1..12 {
        let aliases = vec![format!("*a{}", level - 1); 10].join(", ");
        bomb += &format!("a{level}: &a{level} [{aliases}]\n");
    }
    assert!(refusal(&bomb).contains("too large or too deeply nested"), "{}", refusal(&bomb));
}

#[test]
fn an_empty_scene_says_what_the_least_is() {
    for text in ["", "\n\n", "# only a comment\n", "---\n"] {
        let message = refusal(text);
        assert_eq!(
            message.split_once(' ').unwrap().1,
            "nothing stands here; allowed: a scene, at least `pack: ...`",
            "{text:?}: {message}"
        );
    }
}

#[test]
fn files_that_are_no_scene_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    let message = |path: &Path| scene::load(path).unwrap_err().to_string();

    let latin = file("latin.yaml", b"pack: {file: a.csv}\nname: caf\xe9\n");
    assert_eq!(message(&latin), format!("{}:2:1: not UTF-8", latin.display()));

    let large = file("large.yaml", &b"# comment\n".repeat(200_000));
    assert!(message(&large).contains("larger than 1 MiB"), "{}", message(&large));

    for absent in [folder.path().join("missing.yaml"), folder.path().to_owned()] {
        let start = format!("{}: the scene cannot be read: ", absent.display());
        assert!(message(&absent).starts_with(&start), "{}", message(&absent));
    }
}

#[test]
fn files_of_a_scene_are_meant_from_its_folder() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.yaml");
    fs::write(&file, PACK).unwrap();
    let loaded = scene::load(&file).unwrap();
    assert_eq!(loaded.resolve(Path::new("pack.csv")), folder.path().join("pack.csv"));
    assert_eq!(loaded.resolve(Path::new("/far/pack.csv")), Path::new("/far/pack.csv"));
}
