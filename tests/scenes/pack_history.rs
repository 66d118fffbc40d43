//! Packs that carry their contact history: stored, loaded, damaged.

use std::fs;
use std::path::PathBuf;

use graintwin::pack::{self, ContactMemory, Grain, History, Layer, Pack, PackError};
use graintwin::scene::{self, Coulomb, Friction, Loaded};
use graintwin::twin::Twin;
use proptest::prelude::*;

use crate::histories;
use crate::packs::{self, bead, centered};

const GRAINS: u32 = 4;

/// Four beads in a row, in a box of 2 mm.
fn row(history: Option<History>) -> Pack {
    let grain = |k: u32| Grain { friction: 0.3, ..bead([f64::from(k) * 2e-4, 0.0, 0.0], 1e-4) };
    Pack { bounds: centered([2e-3; 3]), grains: (0..GRAINS).map(grain).collect(), history }
}

fn contact(first: u32, second: u32) -> ContactMemory {
    let (shear, torsion) = ([1e-3, -2e-3, 0.0], 1e-9);
    ContactMemory { first, second, shear, torsion, sliding: true, layers: Vec::new() }
}

/// A row whose first two beads touch, the first one the lower x wall as well.
fn frictional() -> Pack {
    let layer = |reach: f64, x: f64| Layer { reach, ratio: [x, 0.0, 0.0] };
    let mut contacts = vec![contact(0, 1), contact(0, u32::MAX)];
    contacts[0].layers = vec![layer(1e-9, 0.5), layer(2e-9, -1.0)];
    contacts[1].sliding = false;
    row(Some(History {
        rotation: vec![[1e-5, 0.0, -1e-6]; GRAINS as usize],
        contacts,
        bonds: Vec::new(),
    }))
}

/// A folder in which a pack was saved as `p.csv`.
struct Saved(tempfile::TempDir);

impl Saved {
    fn new(pack: &Pack) -> Self {
        let saved = Self(tempfile::tempdir().unwrap());
        saved.again(pack).unwrap();
        saved
    }

    fn again(&self, pack: &Pack) -> Result<(), PackError> {
        pack::save(pack, &self.path("p.csv"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn load(&self, more: &str) -> Result<Pack, PackError> {
        let file = self.path("scene.yaml");
        let scene = scene::parse(&format!("pack: {{file: p.csv{more}}}"), &file).unwrap();
        pack::build(&Loaded { scene, file })
    }

    /// Replaces the history.
    fn with(&self, history: &str) -> &Self {
        fs::write(self.path("p.history.json"), history).unwrap();
        self
    }

    /// The message of a pack that is refused, without the folder.
    fn refusal(&self) -> String {
        let message = self.load("").unwrap_err().to_string();
        message.replace(&format!("{}/", self.0.path().display()), "")
    }
}

/// A JSON of a history, its rotations and contacts as given.
fn json(rotations: &str, contacts: &str) -> String {
    format!("{{\"rotations\": [{rotations}], \"contacts\": [{contacts}]}}")
}

const REST: &str = "[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]";

/// A contact of the JSON with other keys than those of a grain that only lies there.
fn lying(first: u32, second: u32, changed: &str) -> String {
    let keys = ["shear", "torsion", "sliding"];
    let values = ["[0, 0, 0]", "0", "false"];
    let mut text = format!("{{\"first\": {first}, \"second\": {second}");
    for (key, value) in keys.iter().zip(values).filter(|(key, _)| !changed.contains(*key)) {
        text += &format!(", \"{key}\": {value}");
    }
    text + changed + "}"
}

proptest! {
    #[test]
    fn a_stored_history_reads_back_to_the_same_bits(history in histories::history(GRAINS)) {
        let again = Saved::new(&row(Some(history.clone()))).load("").unwrap();
        prop_assert_eq!(histories::bits(&again.history.unwrap()), histories::bits(&history));
    }
}

#[test]
fn the_history_stands_in_a_file_that_the_json_with_the_box_names() {
    let saved = Saved::new(&frictional());
    let beside: serde_json::Value = serde_json::from_str(&saved.text("p.json")).unwrap();
    assert_eq!(beside["history"], "p.history.json");
    let json: serde_json::Value = serde_json::from_str(&saved.text("p.history.json")).unwrap();
    assert_eq!(json["contacts"][1]["second"], 4_294_967_295_u64);
    assert_eq!(json["contacts"][0]["layers"][1]["ratio"][0], -1.0);
    assert_eq!(json["rotations"].as_array().unwrap().len(), 4);
    // An entry a line, so that a person can find one.
    assert!(saved.text("p.history.json").lines().count() > 6);
}

#[test]
fn a_pack_moved_to_another_folder_takes_its_history_along() {
    let saved = Saved::new(&frictional());
    let other = Saved(tempfile::tempdir().unwrap());
    for name in ["p.csv", "p.json", "p.history.json"] {
        fs::rename(saved.path(name), other.path(name)).unwrap();
    }
    assert_eq!(other.load("").unwrap(), frictional());
}

#[test]
fn a_pack_without_history_replaces_one_that_had_one() {
    let saved = Saved::new(&frictional());
    saved.again(&row(None)).unwrap();
    assert_eq!(saved.load("").unwrap(), row(None));
    assert!(!saved.text("p.json").contains("history"));
    assert!(!saved.path("p.history.json").exists());
}

#[test]
fn a_history_is_taken_only_when_the_json_names_it() {
    let saved = Saved::new(&frictional());
    let beside = r#"{"box": {"min": [-1e-3, -1e-3, -1e-3], "max": [1e-3, 1e-3, 1e-3]}}"#;
    fs::write(saved.path("p.json"), beside).unwrap();
    assert_eq!(saved.load("").unwrap().history, None);
}

#[test]
fn a_box_of_the_scene_leaves_the_history_where_the_json_names_it() {
    let own = ", box: {min: [-1, -1, -1], max: [1, 1, 1]}";
    let saved = Saved::new(&frictional());
    let loaded = saved.load(own).unwrap();
    assert_eq!((loaded.bounds.min, loaded.history), ([-1.0; 3], frictional().history));
    fs::remove_file(saved.path("p.json")).unwrap();
    assert_eq!(saved.load(own).unwrap().history, None);
    // Whether such a file names a history cannot be told.
    fs::write(saved.path("p.json"), "{\"history\"").unwrap();
    assert!(saved.load(own).is_err());
}

#[test]
fn a_cut_drops_the_history() {
    let cut = ", cut: {min: [-1e-3, -1e-3, -1e-3], max: [5e-4, 1e-3, 1e-3]}";
    let pack = Saved::new(&frictional()).load(cut).unwrap();
    assert_eq!((pack.grains.len(), pack.history), (3, None));
}

#[test]
fn a_wrong_history_is_named_with_file_field_index_and_what_is_allowed() {
    let with = |first: u32, second: u32, changed: &str| json(REST, &lying(first, second, changed));
    let layers = |layers: &str| with(0, 1, &format!(", \"layers\": [{layers}]"));
    let twice = |a: (u32, u32), b: (u32, u32)| {
        json(REST, &[lying(a.0, a.1, ""), lying(b.0, b.1, "")].join(", "))
    };
    let cases = [
        (String::new(), "EOF while parsing a value at line 1"),
        ("7".into(), "invalid type: integer `7`, expected `{rotations: [...], contacts: [...]}`"),
        ("{\"rotations\": []}".into(), "missing field `contacts`"),
        (json(REST, "") + "x", "trailing characters at line 1"),
        (json("[0, 0, 0]", ""), "rotations: 1 entries; allowed: 4, one a grain"),
        (json("[0, 0, null]", ""), "rotations[0][2]: invalid type: null, expected f64"),
        (json("[0, 0, 0], [0, 0]", ""), "rotations[1]: invalid length 2"),
        (json("[0, 1e999, 0]", ""), "rotations[0][1]: number out of range"),
        (with(0, 1, ", \"colour\": 1"), "contacts[0].colour: unknown field `colour`, expected"),
        (with(0, 1, ", \"torsion\": null"), "contacts[0].torsion: invalid type: null"),
        (with(0, 1, ", \"torsion\": NaN"), "contacts[0].torsion: expected value at line 1"),
        (with(0, 1, ", \"shear\": [0, \"1\", 0]"), "contacts[0].shear[1]: invalid type: string"),
        (with(0, 1, ", \"sliding\": 1"), "contacts[0].sliding: invalid type: integer `1`"),
        (
            json(REST, "{\"first\": 0, \"second\": 1, \"torsion\": 0, \"sliding\": true}"),
            "contacts[0]: missing field `shear`",
        ),
        (with(4, 5, ""), "contacts[0].first: 4; allowed: a grain, 0 to 3"),
        (
            with(0, 4, ""),
            "contacts[0].second: 4; allowed: a grain above first = 0 and up to 3, or 4294967226 \
             to 4294967295 for a wall",
        ),
        (with(0, u32::MAX - 70, ""), "contacts[0].second: 4294967225; allowed: a grain above"),
        (with(2, 1, ""), "contacts[0].second: 1; allowed: a grain above first = 2 and up to 3"),
        (with(1, 1, ""), "contacts[0].second: 1; allowed: a grain above first = 1"),
        (
            twice((0, 3), (0, 1)),
            "contacts[1]: (first, second) = (0, 1) follows (0, 3); allowed: ascending, each",
        ),
        (twice((0, 1), (0, 1)), "contacts[1]: (first, second) = (0, 1) follows (0, 1)"),
        (
            layers("{\"reach\": 0, \"ratio\": [0, 0, 0]}"),
            "contacts[0].layers[0].reach: 0.0; allowed: a finite number above 0.0 m",
        ),
        (
            layers("{\"reach\": 2, \"ratio\": [0, 0, 0]}, {\"reach\": 1, \"ratio\": [0, 0, 0]}"),
            "contacts[0].layers[1].reach: 1.0; allowed: a finite number above 2.0 m, where",
        ),
        (
            layers("{\"reach\": 1, \"ratio\": [0, 0.8, 0.7]}"),
            "contacts[0].layers[0].ratio: its length is 1.06",
        ),
        (layers("{\"reach\": 1}"), "contacts[0].layers[0]: missing field `ratio`"),
    ];
    let saved = Saved::new(&frictional());
    let mut wrong = String::new();
    for (text, start) in &cases {
        let message = saved.with(text).refusal();
        if !message.starts_with(&format!("p.history.json: {start}")) {
            wrong += &format!("{text}\n  says  {message}\n  not   {start}\n");
        }
    }
    assert!(wrong.is_empty(), "\n{wrong}");
}

#[test]
fn a_ratio_of_one_may_be_a_rounding_longer() {
    let layer = |x: f64| format!(", \"layers\": [{{\"reach\": 1, \"ratio\": [{x:?}, 0, 0]}}]");
    let saved = Saved::new(&frictional());
    saved.with(&json(REST, &lying(0, 1, &layer(1.0 + 0.9e-9)))).load("").unwrap();
    saved.with(&json(REST, &lying(0, 1, &layer(1.0 + 1.1e-9)))).load("").unwrap_err();
}

#[test]
fn a_history_cut_short_anywhere_is_refused() {
    let saved = Saved::new(&frictional());
    let whole = saved.text("p.history.json");
    for end in 0..whole.trim_end().len() {
        let message = saved.with(&whole[..end]).refusal();
        assert!(message.starts_with("p.history.json: "), "{end}: {message}");
    }
}

#[test]
fn a_history_much_larger_than_its_grains_need_is_refused() {
    let saved = Saved::new(&frictional());
    let wall = |k: u32| lying(0, u32::MAX - 5 + k % 6, "");
    let contacts: Vec<_> = (0..401).map(wall).collect();
    let message = saved.with(&json(REST, &contacts.join(","))).refusal();
    assert!(message.starts_with("p.history.json: contacts: 401 entries; allowed: at most 400"));

    let blanks = " ".repeat(600_000);
    let message = saved.with(&json(REST, &blanks)).refusal();
    assert!(message.starts_with("p.history.json: larger than 524288 bytes"), "{message}");
}

#[test]
fn a_history_that_is_not_there_or_has_no_name_is_told_with_its_file() {
    let saved = Saved::new(&frictional());
    fs::remove_file(saved.path("p.history.json")).unwrap();
    let message = saved.refusal();
    let start = "p.history.json: the history of the pack cannot be read: ";
    assert!(message.starts_with(start), "{message}");

    let beside = saved.text("p.json").replace("\"p.history.json\"", "[1]");
    fs::write(saved.path("p.json"), beside).unwrap();
    assert_eq!(saved.refusal(), "p.json: history: [1]; allowed: the name of a file");
}

#[test]
fn a_history_that_could_not_be_read_is_not_stored() {
    let refused = |change: &dyn Fn(&mut History)| {
        let mut pack = frictional();
        change(pack.history.as_mut().unwrap());
        let saved = Saved(tempfile::tempdir().unwrap());
        let message = saved.again(&pack).unwrap_err().to_string();
        assert!(!saved.path("p.csv").exists(), "half a pack");
        message
    };
    let message = refused(&|history| history.contacts[1].shear[2] = f64::NAN);
    assert_eq!(message, "p.history.json: contacts[1].shear[2]: NaN; allowed: a finite number");
    let message = refused(&|history| history.rotation.truncate(2));
    assert_eq!(message, "p.history.json: rotations: 2 entries; allowed: 4, one a grain");
}

#[test]
fn a_twin_refuses_a_history_of_another_pack() {
    let mut scene = packs::scene();
    scene.contact.friction = Friction::Coulomb(Coulomb::default());
    let mut pack = frictional();
    let error = |pack: &Pack| Twin::new(&scene, pack, 1).unwrap_err().to_string();
    let contacts = |pack: &mut Pack| pack.history.take().unwrap().contacts;
    let (rotation, mut wrong) = (vec![[0.0; 3]; 4], contacts(&mut pack));
    wrong[0].first = 4;
    wrong[0].second = 5;
    pack.history = Some(History { rotation, contacts: wrong, bonds: Vec::new() });
    assert_eq!(
        error(&pack),
        "the history of the pack: contacts[0].first: 4; allowed: a grain, 0 to 3"
    );
    pack.history = Some(History::default());
    assert_eq!(
        error(&pack),
        "the history of the pack: rotations: 0 entries; allowed: 4, one a grain"
    );
}
