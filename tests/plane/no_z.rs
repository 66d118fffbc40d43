//! Scenes of discs that speak of z.

use graintwin::scene;

fn refused(keys: &str, at: &str) {
    let text = format!("dimension: 2\npack: {{file: none.csv}}\n{keys}\n");
    let message = scene::parse(&text, "scene.yaml".as_ref()).unwrap_err().to_string();
    assert!(message.contains(at), "{keys}: {message}");
}

#[test]
fn steps_and_targets_along_z_are_refused() {
    let path = |step: &str| format!("load_path: [{step}]");
    let axis = "axis: there is no z in the plane; allowed: x, y";
    // z is the axis of a step that names none.
    refused(
        &path("uniaxial: {strain: 0.01, increments: 2}"),
        &format!("load_path[0].uniaxial.{axis}"),
    );
    refused(
        &path("triaxial: {axis: z, axial_strain: 0.01, lateral_stress: 1.0e5, increments: 2}"),
        &format!("load_path[0].triaxial.{axis}"),
    );
    refused(
        &path("repeat: {times: 2, steps: [uniaxial: {axis: z, strain: 0.01, increments: 2}]}"),
        &format!("load_path[0].repeat.steps[0].uniaxial.{axis}"),
    );
    refused(
        &path("polyaxial: {strain: [0.01, 0.0, 0.01], increments: 2}"),
        "load_path[0].polyaxial.strain[2]: there is no z in the plane; allowed: 0",
    );
    let wall = "targets.z_max: discs have no such wall; allowed: no such key";
    refused(
        &path("walls: {targets: {z_max: {stress: 1.0e5}}, increments: 2}"),
        &format!("load_path[0].walls.{wall}"),
    );
    refused("walls: {targets: {z_max: {stress: 1.0e5}}}", &format!("walls.{wall}"));
}
