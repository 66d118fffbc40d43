//! Gradings as the radii of a scene.

use std::path::Path;

use graintwin::command::Disposition;
use graintwin::pack;
use graintwin::scene::{self, Grading, Loaded, Radius};

use crate::packs::{Rig, state};

fn with(radius: &str) -> String {
    format!(
        "pack: {{generate: {{grains: 150, radius: {radius}, material: quartz, \
         confining_stress: 2.0e6}}}}"
    )
}

fn parsed(radius: &str) -> Result<scene::Scene, String> {
    scene::parse(&with(radius), Path::new("scene.yaml")).map_err(|error| error.to_string())
}

#[test]
fn both_gradings_make_packs_of_spheres_in_equilibrium() {
    for (text, limits) in [
        ("{grading_a: {mean: 0.1e-3, ratio: 4.0}}", [0.07e-3, 0.28e-3]),
        ("{grading_b: {mean: 0.1e-3, ratio: 4.0}}", [0.04e-3, 0.16e-3]),
    ] {
        let loaded = Loaded { scene: parsed(text).unwrap(), file: "scene.yaml".into() };
        let pack = pack::build(&loaded).unwrap();
        let radii: Vec<f64> = pack.grains.iter().map(|grain| grain.radius).collect();
        assert!(radii.iter().all(|radius| (limits[0]..=limits[1]).contains(radius)));
        // The s.d. of one is below 0.04 mm in both, that of the mean of 150 a twelfth of it.
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        assert!((mean - 0.1e-3).abs() < 4.0 * 0.04e-3 / 150f64.sqrt(), "{text}: {mean}");
        let (_, report) = Rig::start(&loaded.scene, &pack);
        assert_eq!((report.disposition, report.text.as_str()), (Disposition::Applied, ""));
        let stress = state(&report.measures.unwrap()).confining_stress;
        assert!((stress / 2e6 - 1.0).abs() <= 1.001e-3, "{text}: {stress}");
    }
}

#[test]
fn gradings_are_read_and_wrong_ones_named() {
    let radius = parsed("{grading_a: {mean: 0.1e-3, ratio: 4}}").unwrap().pack.generate.unwrap();
    assert_eq!(radius.radius, Radius::GradingA(Grading { mean: 1e-4, ratio: 4.0 }));
    for (radius, text) in [
        ("{grading_a: {mean: 0, ratio: 4}}", "radius.grading_a.mean: 0.0 is outside mean > 0 m"),
        ("{grading_b: {mean: 1e-4, ratio: 0.9}}", "radius.grading_b.ratio: 0.9 is outside 1 <="),
        ("{grading_b: {mean: 1e-4}}", "radius.grading_b: missing field `ratio`"),
    ] {
        let said = parsed(radius).unwrap_err();
        assert!(said.contains(text), "{said}");
    }
}
