//! A crystal as the pack of a scene.

use std::path::Path;

use graintwin::pack;
use graintwin::scene::{self, Loaded};

fn built(yaml: &str) -> Result<pack::Pack, String> {
    let file = Path::new("scene.yaml");
    let scene = scene::parse(yaml, file).map_err(|error| error.to_string())?;
    pack::build(&Loaded { scene, file: file.into() }).map_err(|error| error.to_string())
}

#[test]
fn a_scene_lays_out_the_crystal_of_figure_51() {
    let pack = built(
        "pack: {crystal: {rows: 41, columns: [15, 16], radius: 0.1e-3, material: quartz}, seed: 3}\n\
         contact: {friction: {coefficient: 0.6}}",
    )
    .unwrap();
    assert_eq!(pack.grains.len(), 635);
    assert!(pack.grains.iter().all(|grain| grain.friction == 0.6 && grain.radius == 1e-4));
    let [x, y, z] = pack.bounds.sides();
    assert!((x - 32e-4).abs() < 1e-17 && (z - 2e-4).abs() < 1e-18, "{x} {z}");
    assert!((y - (2.0 + 40.0 * 3f64.sqrt()) * 1e-4).abs() < 1e-17, "{y}");
    // Quartz has a spread.
    assert!(pack.grains.iter().any(|grain| grain.young != pack.grains[0].young));
}

#[test]
fn what_is_no_crystal_is_named() {
    let wrong = [
        ("rows: 0, columns: [3, 4]", "pack.crystal.rows: 0 is outside 1 to"),
        ("rows: 2, columns: [3, 0]", "pack.crystal.columns[1]: 0 is outside 1 to"),
        ("rows: 2, columns: [3, 5]", "pack.crystal.columns: 3 and 5 grains do not lie in each"),
        ("rows: 2, columns: [3]", "pack.crystal.columns"),
    ];
    for (rows, text) in wrong {
        let yaml = format!("pack: {{crystal: {{{rows}, radius: 1e-4, material: quartz}}}}");
        let said = built(&yaml).unwrap_err();
        assert!(said.contains(text), "{said}");
    }
    let with = |more: &str| {
        built(&format!(
            "pack: {{crystal: {{rows: 2, columns: [1, 2], radius: 1e-4, material: quartz}}{more}}}"
        ))
    };
    assert!(with(", material: glass").unwrap_err().contains("here it is `crystal.material`"));
    assert!(with(", file: a.csv").unwrap_err().contains("more than one of"));
    assert!(with("").is_ok());
}
