//! Packs: the CSV, the box, and what the grains are made of.

use std::fs;
use std::path::{Path, PathBuf};

use graintwin::pack::{self, Columns, Grain, Pack, PackError};
use graintwin::scene::{self, Loaded};
use graintwin::wall::Bounds;
use proptest::prelude::*;

const BOX: Bounds = Bounds { min: [-1e-3; 3], max: [1e-3; 3] };

/// A folder with a pack, its box beside it when given, and a scene that names it.
struct Files(tempfile::TempDir);

impl Files {
    fn new(csv: impl AsRef<[u8]>, json: Option<&str>) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("p.csv"), csv).unwrap();
        if let Some(json) = json {
            fs::write(folder.path().join("p.json"), json).unwrap();
        }
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn scene(&self, pack: &str) -> Loaded {
        let file = self.path("scene.yaml");
        fs::write(&file, format!("pack: {{file: p.csv{pack}}}")).unwrap();
        scene::load(&file).unwrap()
    }

    fn build(&self, pack: &str) -> Result<Pack, PackError> {
        pack::build(&self.scene(pack))
    }

    /// The message of a pack that is refused, without the folder.
    fn refusal(&self, pack: &str) -> String {
        let message = self.build(pack).unwrap_err().to_string();
        message.replace(&format!("{}/", self.0.path().display()), "")
    }
}

const IN_BOX: &str =
    ", material: hydrate, box: {min: [-1e-3, -1e-3, -1e-3], max: [1e-3, 1e-3, 1e-3]}";
const JSON: &str = r#"{"box": {"min": [-1e-3, -1e-3, -1e-3], "max": [1e-3, 1e-3, 1e-3]}}"#;

fn bits(pack: &Pack) -> Vec<u64> {
    let grain = |g: &Grain| {
        let [x, y, z] = g.position;
        [x, y, z, g.radius, g.young, g.poisson, g.density, g.friction].map(f64::to_bits)
    };
    let walls = pack.bounds.min.iter().chain(&pack.bounds.max).map(|wall| wall.to_bits());
    walls.chain(pack.grains.iter().flat_map(grain)).collect()
}

fn any_grain() -> impl Strategy<Value = Grain> {
    // Two centres may agree in all but x.
    let other = || prop_oneof![-1.0..1.0, Just(0.0), Just(-0.0)];
    let position = (-1.0..1.0, other(), other()).prop_map(|(x, y, z)| [x, y, z]);
    let size = -300.0..-1.0_f64;
    let friction = prop_oneof![0.0..5.0, Just(f64::INFINITY)];
    let hydrate = any::<bool>();
    (position, size, 0.0..300.0_f64, -0.999..0.499, 0.0..20.0_f64, friction, hydrate).prop_map(
        |(position, radius, young, poisson, density, friction, hydrate)| Grain {
            position,
            radius: 10_f64.powf(radius),
            young: 10_f64.powf(young),
            poisson,
            density: 10_f64.powf(density),
            friction,
            hydrate,
        },
    )
}

proptest! {
    #[test]
    fn a_stored_pack_reads_back_to_the_same_bits(
        grains in prop::collection::vec(any_grain(), 1..20),
        min in prop::array::uniform3(-2.0..-1.0),
        max in prop::array::uniform3(1.0..2.0),
    ) {
        let pack = Pack { bounds: Bounds { min, max }, grains, history: None };
        let files = Files::new("", None);
        pack::save(&pack, &files.path("p.csv")).unwrap();
        prop_assert_eq!(bits(&files.build("").unwrap()), bits(&pack));
    }
}

#[test]
fn columns_come_in_any_order_with_blanks_and_comments() {
    let files = Files::new("# beads\nradius, z ,y,x\n1e-4,3e-4,2e-4,1e-4 # first\n", None);
    let pack = files.build(IN_BOX).unwrap();
    assert_eq!(pack.bounds, BOX);
    let [grain] = pack.grains.as_slice() else { panic!("{pack:?}") };
    assert_eq!((grain.position, grain.radius), ([1e-4, 2e-4, 3e-4], 1e-4));
    // Hydrate of T table 2.1, and no friction.
    assert_eq!((grain.young, grain.poisson), (6.6e9, 0.32));
    assert_eq!((grain.density, grain.friction), (900.0, 0.0));
}

#[test]
fn materials_and_constants_may_differ_from_grain_to_grain() {
    let files =
        Files::new("x,y,z,radius,material\n0,0,0,1e-4,hydrate\n5e-4,0,0,1e-4,glass\n", Some(JSON));
    let pack = files.build("").unwrap();
    assert_eq!(pack.grains[0].density, 900.0);
    assert_eq!(pack.grains[1].density, 2420.0);

    let constants = "x,y,z,radius,young,poisson,density,friction\n0,0,0,1e-4,1e9,-0.5,1000,0.7\n";
    let pack = Files::new(constants, Some(JSON)).build("").unwrap();
    let grain = pack.grains[0];
    assert_eq!(
        (grain.young, grain.poisson, grain.density, grain.friction),
        (1e9, -0.5, 1000.0, 0.7)
    );
}

#[test]
fn a_material_with_spread_is_drawn_from_the_seed_of_the_scene() {
    let rows: String = (0..9).map(|k| format!("{k}e-4,0,0,1e-5\n")).collect();
    let files = Files::new(format!("x,y,z,radius\n{rows}"), Some(JSON));
    let drawn = |seed: u64| files.build(&format!(", material: glass, seed: {seed}")).unwrap();
    assert_eq!(bits(&drawn(1)), bits(&drawn(1)));
    assert_ne!(bits(&drawn(1)), bits(&drawn(2)));
    let grains = drawn(1).grains;
    assert!(grains.windows(2).all(|pair| pair[0].young != pair[1].young));
}

#[test]
fn a_wrong_pack_is_named_with_file_line_and_column() {
    let cases: &[(&[u8], &str)] = &[
        (b"", "p.csv:1: the file is empty"),
        (b"x,y,z,radius\n", "p.csv:1: no grain follows the header"),
        (b"x,y,z\n0,0,0\n", "p.csv:1: column `radius` is missing; the header has `x`, `y`, `z`"),
        (b"x,y,z,radius,x\n", "p.csv:1: column `x` appears twice"),
        (
            b"x,y,z,radius,colour\n",
            "p.csv:1: column `colour` is unknown; allowed: x, y, z, radius and",
        ),
        (b"x,y,z,radius,young\n0,0,0,1e-4,1\n", "p.csv:1: column `poisson` is missing"),
        (
            b"x,y,z,radius,material,young\n0,0,0,1e-4,glass,1\n",
            "p.csv:1: both material and constants; allowed: either",
        ),
        (b"x,y,z,radius\n0,0,0,1e-4\n0,0,0\n", "p.csv:3: 3 fields; allowed: 4, as in the header"),
        (b"x,y,z,radius\n0,0,0,1e-4,7\n", "p.csv:2: 5 fields; allowed: 4, as in the header"),
        (b"x,y,z,radius\nnan,0,0,1e-4\n", "p.csv:2: column `x`: `nan` is not a finite number"),
        (b"x,y,z,radius\n0,inf,0,1e-4\n", "p.csv:2: column `y`: `inf` is not a finite number"),
        (b"x,y,z,radius\n0,0,1e400,1e-4\n", "p.csv:2: column `z`: `1e400` is not a finite number"),
        (b"x,y,z,radius\n0,0,0,NaN\n", "p.csv:2: column `radius`: `NaN` is not a finite number"),
        (
            b"x,y,z,radius\n0,0,0,-1e-4\n",
            "p.csv:2: column `radius`: -0.0001 is outside radius > 0 m",
        ),
        (b"x,y,z,radius\n0,0,0,0\n", "p.csv:2: column `radius`: 0.0 is outside radius > 0 m"),
        (b"x,y,z,radius\n0,0,zero,1e-4\n", "p.csv:2: column `z`: `zero` is not a number"),
        (b"x,y,z,radius\n0,0,0,\xff\n", "p.csv:2: not UTF-8"),
        (
            b"x,y,z,radius\n0,0,0,1e-4\n0,0,1.5e-3,1e-4\n0,0,-2e-3,1e-4\n",
            "p.csv:3: the grain's centre (0.0, 0.0, 0.0015) lies outside the box, beyond z_max = \
             0.001 m; grains outside: 2",
        ),
        (
            b"x,y,z,radius\n0,0,0,1e-4\n1e-4,0,0,1e-4\n0,0,0,2e-4\n",
            "p.csv:4: the grain has the same centre as that of line 2",
        ),
        (
            b"x,y,z,radius,material\n0,0,0,1e-4,iron\n",
            "p.csv:2: column `material`: no material is named `iron`; known: glass, hydrate, quartz",
        ),
    ];
    for (csv, start) in cases {
        let message = Files::new(csv, None).refusal(IN_BOX);
        assert!(message.starts_with(start), "{message}\n{start}");
    }
}

#[test]
fn constants_out_of_range_are_refused() {
    let cases = [
        ("0,0.2,1e3,0", "column `young`: 0.0 is outside young > 0 Pa"),
        ("1e9,0.5,1e3,0", "column `poisson`: 0.5 is outside -1 < poisson < 0.5"),
        ("1e9,-1,1e3,0", "column `poisson`: -1.0 is outside -1 < poisson < 0.5"),
        ("1e9,0.2,-1,0", "column `density`: -1.0 is outside density > 0 kg/m³"),
        ("1e9,0.2,1e3,-0.1", "column `friction`: -0.1 is outside friction >= 0, inf included"),
        ("1e9,0.2,1e3,1e999", "column `friction`: `1e999` is not a finite number"),
        ("1e9,0.2,1e3,nan", "column `friction`: `nan` is not a finite number"),
    ];
    for (constants, text) in cases {
        let csv = format!("x,y,z,radius,young,poisson,density,friction\n0,0,0,1e-4,{constants}\n");
        assert_eq!(Files::new(csv, Some(JSON)).refusal(""), format!("p.csv:2: {text}"));
    }
}

/// 1e-9 of the radius is 1e-13 m here; grains in different cells of the search are near as well.
#[test]
fn centres_a_rounding_apart_are_the_same_and_a_little_more_are_not() {
    for x in [0.0, 1e-7, 2.3e-4, -1e-7] {
        for (apart, same) in [(0.0, true), (0.9e-13, true), (1.1e-13, false), (-0.9e-13, true)] {
            let csv = format!("x,y,z,radius\n{x:?},0,0,1e-4\n{:?},0,0,1e-4\n", x + apart);
            let built = Files::new(csv, None).build(IN_BOX);
            assert_eq!(built.is_err(), same, "{x} and {apart:e} more: {built:?}");
        }
    }
}

#[test]
fn without_a_material_the_pack_says_where_one_could_stand() {
    let message = Files::new("x,y,z,radius\n0,0,0,1e-4\n", Some(JSON)).refusal("");
    assert_eq!(
        message,
        "p.csv: it has neither a column `material` nor `young,poisson,density,friction`; allowed \
         besides: `pack.material` in the scene, one for all grains"
    );
}

#[test]
fn the_box_is_beside_the_pack_or_in_the_scene_which_goes_first() {
    let files = Files::new("x,y,z,radius\n0,0,0,1e-4\n", Some(JSON));
    assert_eq!(files.build(", material: glass").unwrap().bounds, BOX);
    let own = ", material: glass, box: {min: [-1, -1, -1], max: [1, 1, 1]}";
    assert_eq!(files.build(own).unwrap().bounds, Bounds { min: [-1.0; 3], max: [1.0; 3] });
}

#[test]
fn a_pack_without_a_box_says_where_one_could_stand() {
    let cases = [
        (None, "p.json: cannot be read: "),
        (Some("{"), "p.json: EOF while parsing"),
        (Some("[]"), "p.json: it has no key `box`, only []"),
        (
            Some(r#"{"N": 1, "walls": {"lo": [0, 0, 0], "hi": [1, 1, 1]}}"#),
            r#"p.json: it has no key `box`, only ["N", "walls"]"#,
        ),
        (Some(r#"{"box": {"min": [0, 0, 0]}}"#), "p.json: box: missing field `max`"),
        (
            Some(r#"{"box": {"min": [0, 0, 0], "max": [1, 1, null]}}"#),
            "p.json: box: invalid type: null",
        ),
        (
            Some(r#"{"box": {"min": [0, 0, 0], "max": [1, 1, 1], "mid": 0}}"#),
            "p.json: box: unknown field `mid`",
        ),
        (
            Some(r#"{"box": {"min": [0, 0, 0], "max": [1, 0, 1]}}"#),
            "p.json: box: max[1] = 0.0 is not above min[1] = 0.0",
        ),
    ];
    for (json, start) in cases {
        let message = Files::new("x,y,z,radius\n0,0,0,1e-4\n", json).refusal(", material: glass");
        assert!(message.starts_with(start), "{message}\n{start}");
        assert!(message.contains("in the scene, `pack: {file: ..., box: {min:"), "{message}");
    }
}

#[test]
fn a_cut_keeps_the_grains_wholly_inside_and_becomes_the_box() {
    // At 0 wholly inside, at 4e-4 touching the cut from inside, at 4.1e-4 across it.
    let csv = "x,y,z,radius\n0,0,0,1e-4\n4e-4,0,0,1e-4\n0,4.1e-4,0,1e-4\n0,0,-9e-4,1e-4\n";
    let files = Files::new(csv, None);
    let cut = ", cut: {min: [-5e-4, -5e-4, -5e-4], max: [5.0000001e-4, 5e-4, 5e-4]}";
    let pack = files.build(&format!("{IN_BOX}{cut}")).unwrap();
    assert_eq!(pack.bounds.min, [-5e-4; 3]);
    let kept: Vec<_> = pack.grains.iter().map(|grain| grain.position[0]).collect();
    assert_eq!(kept, [0.0, 4e-4]);

    let nothing = ", cut: {min: [8e-4, 8e-4, 8e-4], max: [9e-4, 9e-4, 9e-4]}";
    let message = files.refusal(&format!("{IN_BOX}{nothing}"));
    assert!(message.starts_with("pack.cut: none of the 4 grains lies wholly inside"), "{message}");
}

#[test]
fn a_cut_does_not_change_what_the_grains_are_made_of() {
    let rows: String = (0..9).map(|k| format!("{k}e-4,0,0,1e-5\n")).collect();
    let files = Files::new(format!("x,y,z,radius\n{rows}"), Some(JSON));
    let whole = files.build(", material: glass").unwrap();
    let cut = ", material: glass, cut: {min: [3.5e-4, -1, -1], max: [1, 1, 1]}";
    assert_eq!(files.build(cut).unwrap().grains, whole.grains[4..]);
}

#[test]
fn a_pack_is_stored_under_a_csv_name_or_not_at_all() {
    let pack = Pack { bounds: BOX, grains: Vec::new(), history: None };
    let files = Files::new("", None);
    for name in ["p.json", "p", "p.yaml"] {
        let error = pack::save(&pack, &files.path(name)).unwrap_err();
        assert!(matches!(error, PackError::Name { .. }), "{error}");
    }
    let error = pack::save(&pack, Path::new("/missing/folder/p.csv")).unwrap_err();
    assert!(error.to_string().starts_with("/missing/folder/p.csv: the pack cannot be written: "));
}

#[test]
fn a_file_tells_which_columns_it_has() {
    let geometry = Files::new("x,y,z,radius\n0,0,0,1\n", None);
    assert_eq!(pack::read(&geometry.path("p.csv")).unwrap().columns, Columns::Geometry);
    let material = Files::new("x,y,z,radius,material\n0,0,0,1,m\n", None);
    assert_eq!(pack::read(&material.path("p.csv")).unwrap().columns, Columns::Material);
}
