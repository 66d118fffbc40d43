//! What a cylinder cannot have.

use graintwin::command::Disposition;
use graintwin::pack::Pack;
use graintwin::scene;
use graintwin::twin::{Twin, TwinError};
use graintwin::wall::{Bounds, WallTarget};

use crate::cylinder::{HOLE, KEEP, hollow, scene_in, solid};
use crate::packs::{Rig, bead};

#[test]
fn what_does_not_fit_a_cylinder_is_refused() {
    let oblong = Pack {
        bounds: Bounds { min: [-1e-3; 3], max: [1e-3, 1.1e-3, 1e-3] },
        grains: vec![bead([0.0; 3], 1e-4)],
        history: None,
    };
    let scene = scene_in(None, "", "");
    let refused = Twin::new(&scene, &oblong, 1).unwrap_err();
    assert!(matches!(&refused, TwinError::Cell(text) if text.contains("square")), "{refused}");
    let mut round = Pack { bounds: Bounds { min: [-1e-3; 3], max: [1e-3; 3] }, ..oblong };
    let wide = Twin::new(&scene_in(Some(2e-3), "", ""), &round, 1).unwrap_err().to_string();
    assert!(wide.contains("no less than the outer one"), "{wide}");
    let inside = Twin::new(&scene_in(Some(2e-4), "", ""), &round, 1).unwrap_err().to_string();
    assert!(inside.contains("grain 0 is"), "{inside}");
    round.grains[0].position = [8e-4, 8e-4, 0.0];
    let beyond = Twin::new(&scene, &round, 1).unwrap_err().to_string();
    assert!(beyond.contains("grain 0 is"), "{beyond}");

    let (mut rig, _) = Rig::start(&scene, solid());
    let way = WallTarget::Displacement(1e-7);
    for (w, name) in [(0, "x_min"), (2, "y_min"), (3, "y_max")] {
        let mut targets = [KEEP; 6];
        targets[w] = way;
        let report = rig.aim(targets);
        assert_eq!(report.disposition, Disposition::Invalid);
        assert!(report.text.contains(name), "{}", report.text);
    }
    // The wall through its opposite.
    let outer = 0.5 * solid().bounds.sides()[0];
    let through = WallTarget::Displacement(1.1 * outer);
    let report = rig.aim([KEEP, through, KEEP, KEEP, KEEP, KEEP]);
    assert_eq!(report.disposition, Disposition::Limit, "{}", report.text);
    let (mut rig, _) = Rig::start(&scene_in(Some(HOLE), "", ""), hollow());
    for w in 0..2 {
        let mut targets = [KEEP; 6];
        let room = 0.5 * hollow().bounds.sides()[0] - HOLE;
        targets[w] = WallTarget::Displacement(1.01 * room);
        let report = rig.aim(targets);
        assert_eq!(report.disposition, Disposition::Limit, "{}", report.text);
    }
}

#[test]
fn scenes_that_a_cylinder_cannot_have_are_refused() {
    let refused = |walls: &str, rest: &str| {
        let text = format!("pack: {{file: none.csv}}\nwalls: {{{walls}}}\n{rest}\n");
        scene::parse(&text, "cylinder.yaml".as_ref()).unwrap_err().to_string()
    };
    let solid = "cell: {cylinder: {}}";
    for (walls, rest, field) in [
        ("open: [x_min]", "", "walls.open"),
        ("cell: {cylinder: {}}, open: [x_min]", "", "walls.open[0]"),
        ("cell: {cylinder: {inner: 1.0e-3}}, open: [x_max]", "", "walls.open[0]"),
        ("cell: {cylinder: {inner: -1.0}}", "", "walls.cell.cylinder.inner"),
        ("cell: {annulus: {inner: 1.0}}", "", "walls.cell"),
        (solid, "dimension: 2", "walls.cell"),
        ("cell: {cylinder: {}}, targets: {y_max: {stress: 1.0e6}}", "", "walls.targets.y_max"),
        ("cell: {cylinder: {}}, targets: {x_min: {stress: 1.0e6}}", "", "walls.targets.x_min"),
        (solid, "load_path: [{isotropic: {strain: 1.0e-3, increments: 2}}]", "load_path[0]"),
        (
            solid,
            "load_path: [{walls: {targets: {y_min: {displacement: 1.0e-6}}, increments: 2}}]",
            "load_path[0].walls.targets.y_min",
        ),
        (solid, "outputs: {moduli: tangent}", "outputs.moduli"),
        (
            solid,
            "contact: {normal: {cement: {law: fixed, solution: two_step}}}",
            "contact.normal.cement.solution",
        ),
        (
            solid,
            "contact: {normal: {cement: {law: fixed, saturation: 0.1}}}",
            "contact.normal.cement.saturation",
        ),
    ] {
        let text = refused(walls, rest);
        assert!(text.contains(field), "{walls} {rest}: {text}");
    }
}

#[test]
fn a_cut_that_is_no_square_is_refused() {
    let text = "pack: {file: none.csv, cut: {min: [0.0, 0.0, 0.0], max: [1.0e-3, 1.1e-3, 1.0e-3]}}\n\
                walls: {cell: {cylinder: {}}}\n";
    let refusal = scene::parse(text, "cylinder.yaml".as_ref()).unwrap_err().to_string();
    assert!(refusal.contains("pack.cut") && refusal.contains("square"), "{refusal}");
}
