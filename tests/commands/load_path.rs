//! Load paths: where the walls end up, told by the box and not by the program's own formulas.

use std::fs;
use std::path::{Path, PathBuf};

use graintwin::command::{Command, Mode};
use graintwin::path::{self, PathError};
use graintwin::scene::{self, LoadPath};
use graintwin::wall::Bounds;
use proptest::prelude::*;

/// Sides of 2, 4 and 8 mm, away from the origin.
const BOX: Bounds = Bounds { min: [1e-3, -2e-3, 0.0], max: [3e-3, 2e-3, 8e-3] };

fn load_path(yaml: &str) -> LoadPath {
    let text = format!("pack: {{file: a.csv}}\nload_path:\n{yaml}\n");
    scene::parse(&text, Path::new("scene.yaml")).unwrap().load_path
}

fn commands(yaml: &str) -> Vec<Command> {
    path::commands(&load_path(yaml), Path::new(""), &BOX).unwrap()
}

/// Engineering strain of the box at a command, against the box at `before`.
fn strain(command: &Command, before: &Bounds) -> [f64; 3] {
    let now = BOX.displaced(&command.ask.numbers()).sides();
    std::array::from_fn(|axis| (before.sides()[axis] - now[axis]) / before.sides()[axis])
}

fn close(found: [f64; 3], expected: [f64; 3]) {
    for axis in 0..3 {
        let error = (found[axis] - expected[axis]).abs();
        assert!(error < 1e-15, "{found:?} is not {expected:?}");
    }
}

#[test]
fn every_command_is_absolute_numbered_from_one_and_a_second_apart() {
    let commands = commands("- uniaxial: {strain: 1e-3, increments: 3}\n- unload: {increments: 2}");
    assert_eq!(commands.iter().map(|c| c.sequence).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
    let stamps: Vec<_> = commands.iter().map(|c| c.stamp.nanoseconds() / 1_000_000_000).collect();
    assert_eq!(stamps, [1, 2, 3, 4, 5]);
    assert!(commands.iter().all(|c| c.session == "load_path" && c.mode == Mode::Absolute));
}

#[test]
fn no_step_gives_no_command() {
    assert_eq!(path::commands(&LoadPath::default(), Path::new(""), &BOX).unwrap(), []);
}

#[test]
fn strain_steps_reach_their_strains_in_equal_parts() {
    let cases = [
        ("isotropic: {strain: 2e-3, increments: 4}", [2e-3, 2e-3, 2e-3]),
        ("isotropic: {strain: -2e-3, increments: 4}", [-2e-3, -2e-3, -2e-3]),
        ("uniaxial: {strain: 1e-3, increments: 4}", [0.0, 0.0, 1e-3]),
        ("uniaxial: {axis: x, strain: 1e-3, increments: 4}", [1e-3, 0.0, 0.0]),
        (
            "triaxial: {axis: y, axial_strain: 4e-3, lateral_strain: -1e-3, increments: 4}",
            [-1e-3, 4e-3, -1e-3],
        ),
        ("polyaxial: {strain: [1e-3, 2e-3, -3e-3], increments: 4}", [1e-3, 2e-3, -3e-3]),
    ];
    for (step, expected) in cases {
        let commands = commands(&format!("- {step}"));
        assert_eq!(commands.len(), 4);
        for (k, command) in commands.iter().enumerate() {
            close(strain(command, &BOX), expected.map(|e| e * (k + 1) as f64 / 4.0));
        }
    }
}

#[test]
fn both_walls_of_a_pair_move_or_the_one_that_is_named() {
    for (moving, shares) in [("both", [0.5, 0.5]), ("min", [1.0, 0.0]), ("max", [0.0, 1.0])] {
        let step = format!("- uniaxial: {{strain: 1e-3, increments: 1, moving: {moving}}}");
        let moved = commands(&step)[0].ask.numbers();
        // A strain of 1e-3 along 8 mm is 8 µm.
        assert_eq!(moved[..4], [0.0; 4]);
        assert!((moved[4] - shares[0] * 8e-6).abs() < 1e-20, "{moving}: {moved:?}");
        assert!((moved[5] - shares[1] * 8e-6).abs() < 1e-20, "{moving}: {moved:?}");
    }
}

#[test]
fn a_strain_is_of_the_box_at_the_start_of_its_step() {
    let commands = commands(
        "- isotropic: {strain: 0.1, increments: 1}\n- uniaxial: {strain: 0.1, increments: 1}",
    );
    close(strain(&commands[1], &BOX), [0.1, 0.1, 0.19]);
    let between = BOX.displaced(&commands[0].ask.numbers());
    close(strain(&commands[1], &between), [0.0, 0.0, 0.1]);
}

#[test]
fn unloading_goes_straight_back_to_the_start_or_to_a_share() {
    let load = "- polyaxial: {strain: [1e-3, 2e-3, 3e-3], increments: 3, moving: max}\n";
    let all = commands(&format!("{load}- unload: {{increments: 2}}"));
    close(strain(&all[3], &BOX), [0.5e-3, 1e-3, 1.5e-3]);
    assert_eq!(all[4].ask.numbers(), [0.0; 6]);
    let half = commands(&format!("{load}- unload: {{to: 0.5, increments: 1}}"));
    close(strain(&half[3], &BOX), [0.5e-3, 1e-3, 1.5e-3]);
}

#[test]
fn repeating_is_writing_the_steps_again() {
    let steps = "isotropic: {strain: 1e-3, increments: 2}\n";
    let repeated = commands(&format!(
        "- repeat:\n    times: 3\n    steps:\n    - {steps}    - unload: {{to: 0.25, increments: 3}}"
    ));
    let written = commands(&format!("- {steps}- unload: {{to: 0.25, increments: 3}}\n").repeat(3));
    assert_eq!(repeated, written);
    assert_eq!(repeated.len(), 15);
}

/// A file in a folder of its own; the folder lives as long as the first value.
fn file(text: impl AsRef<[u8]>) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("path.csv");
    fs::write(&path, text).unwrap();
    (folder, path)
}

#[test]
fn a_command_csv_is_taken_as_it_is() {
    let (_folder, path) = file(
        "# from a rig\nstamp, z_max, x_min # two walls\n0.5, 1e-6, 0\n\n1.25,2e-6,-3e-6\n1.25,0,0\n",
    );
    let commands = path::read_csv(&path).unwrap();
    let moved: Vec<_> = commands.iter().map(|c| c.ask.numbers()).collect();
    assert_eq!(
        moved,
        [[0.0, 0.0, 0.0, 0.0, 0.0, 1e-6], [-3e-6, 0.0, 0.0, 0.0, 0.0, 2e-6], [0.0; 6],]
    );
    let stamps: Vec<_> = commands.iter().map(|c| (c.stamp.sec, c.stamp.nanosec)).collect();
    assert_eq!(stamps, [(0, 500_000_000), (1, 250_000_000), (1, 250_000_000)]);
}

#[test]
fn a_command_csv_within_a_path_moves_its_walls_since_the_start_and_leaves_the_others() {
    let (folder, _) = file("stamp,z_max\n0.5,2e-6\n");
    let steps = load_path(
        "- uniaxial: {axis: x, strain: 1e-3, increments: 2}\n- commands: path.csv\n\
         - unload: {increments: 1}",
    );
    let commands = path::commands(&steps, folder.path(), &BOX).unwrap();
    assert_eq!(commands[2].ask.numbers(), [1e-6, 1e-6, 0.0, 0.0, 0.0, 2e-6]);
    let stamps: Vec<_> = commands.iter().map(|c| c.stamp.seconds()).collect();
    assert_eq!(stamps, [1.0, 2.0, 2.5, 3.5]);
}

#[test]
fn walls_may_be_sent_through_each_other_by_a_csv_and_the_twin_will_say_so() {
    let (_folder, path) = file("stamp,x_min\n0,1.0\n");
    assert_eq!(path::read_csv(&path).unwrap()[0].ask.numbers()[0], 1.0);
}

#[test]
fn a_wrong_command_csv_is_named_with_file_and_line() {
    let walls = "allowed: stamp, x_min, x_max, y_min, y_max, z_min, z_max, each also with \
                 :stress or :force";
    let cases: &[(&[u8], &str)] = &[
        (b"", "1: the file is empty"),
        (b"stamp,x_min\n", "1: no row follows the header"),
        (b"x_min\n0\n", "1: column `stamp` is missing; the header has `x_min`"),
        (b"stamp,x_min,x_min\n", "1: column `x_min` appears twice"),
        (b"stamp,top\n0,0\n", &format!("1: column `top` is unknown; {walls}")),
        (
            b"stamp,x_min:pressure\n0,0\n",
            &format!("1: column `x_min:pressure` is unknown; {walls}"),
        ),
        (b"stamp,x_min,x_min:stress\n0,0,1\n", "1: x_min has more than one column; allowed: one"),
        (
            b"# rig\nstamp,x_min:stress\n0,0\n",
            "3: column `x_min:stress`: 0.0 is no load; allowed: above 0",
        ),
        (
            b"stamp,z_max:force\n0,1\n1,-2\n",
            "3: column `z_max:force`: -2.0 is no load; allowed: above 0",
        ),
        (b"stamp,x_min\n0,0\n1\n", "3: 1 fields; allowed: 2, as in the header"),
        (b"stamp,x_min\n0,0,0\n", "2: 3 fields; allowed: 2, as in the header"),
        (b"stamp,x_min\n0,up\n", "2: column `x_min`: `up` is not a number"),
        (b"stamp,x_min\n0,\n", "2: column `x_min`: `` is not a number"),
        (b"stamp,x_min\n0,nan\n", "2: column `x_min`: `nan` is not a finite number"),
        (b"stamp,x_min\n0,-inf\n", "2: column `x_min`: `-inf` is not a finite number"),
        (b"stamp,x_min\nnan,0\n", "2: column `stamp`: `nan` is not a finite number"),
        (b"stamp,x_min\n-1,0\n", "2: column `stamp`: -1.0 is outside 0 to 2147483647 s"),
        (b"stamp,x_min\n3e9,0\n", "2: column `stamp`: 3000000000.0 is outside 0 to 2147483647 s"),
        (b"stamp,x_min\n2,0\n1,0\n", "3: column `stamp`: 1.0 is before 2.0, the row above"),
        (b"stamp,x_min\n0,0\n1,\xff\n", "3: not UTF-8"),
    ];
    for (text, start) in cases {
        let (_folder, path) = file(text);
        let message = path::read_csv(&path).unwrap_err().to_string();
        let expected = format!("{}:{start}", path.display());
        assert!(message.starts_with(&expected), "{message}\n{expected}");
    }
    let missing = path::read_csv(Path::new("missing.csv")).unwrap_err().to_string();
    assert!(missing.starts_with("missing.csv: cannot be read: "), "{missing}");
}

#[test]
fn files_may_not_add_up_to_more_commands_than_a_path_may_have() {
    let rows: String = (0..1001).map(|row| format!("{row},0\n")).collect();
    let (folder, _) = file(format!("stamp,x_min\n{rows}"));
    let steps = load_path("- repeat: {times: 1000, steps: [commands: path.csv]}");
    let error = path::commands(&steps, folder.path(), &BOX).unwrap_err();
    assert!(matches!(error, PathError::TooMany), "{error}");
}

#[test]
fn a_path_longer_than_ros_time_is_refused() {
    let (folder, _) = file("stamp,x_min\n2e9,0\n");
    let steps = load_path("- repeat: {times: 2, steps: [commands: path.csv]}");
    let error = path::commands(&steps, folder.path(), &BOX).unwrap_err();
    assert!(matches!(error, PathError::TooLong), "{error}");
}

/// The log that is shipped, and what its columns say.
fn shipped_log() -> (PathBuf, Vec<(f64, f64)>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("launch_configs");
    let text = fs::read_to_string(folder.join("logs/triaxial_undrained_g1.csv")).unwrap();
    let row = |line: &str| {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        (fields[0], fields[1])
    };
    (folder, text.lines().skip(1).map(row).collect())
}

#[test]
fn the_shipped_log_drives_the_box_undrained() {
    let (folder, log) = shipped_log();
    let scene = scene::load(&folder.join("rig_log.yaml")).unwrap().scene;
    let commands = path::commands(&scene.load_path, &folder, &BOX).unwrap();
    assert_eq!(commands.len(), 84);
    for (command, (time, percent)) in commands.iter().zip(log) {
        assert_eq!(command.stamp.seconds(), time);
        let now = BOX.displaced(&command.ask.numbers());
        assert!((now.volume() / BOX.volume() - 1.0).abs() < 1e-14, "{now:?}");
        let [x, y, z] = strain(command, &BOX);
        assert!((z - percent / 100.0).abs() < 1e-15, "{z} for {percent} %");
        assert!((x - y).abs() < 1e-15);
        // Undrained to first order: half of the axial strain outwards.
        assert!((x + 0.5 * z).abs() <= z * z, "{x} for {z}");
        let [x_min, x_max, ..] = command.ask.numbers();
        assert_eq!(x_min, x_max);
    }
}

#[test]
fn units_of_a_log_are_what_they_say_and_fixed_sides_stay() {
    let (folder, _) = file("t,ratio,percent,micro\n0,-1e-4,-0.01,-100\n1,2e-3,0.2,2000\n");
    for (column, unit) in [("ratio", "ratio"), ("percent", "percent"), ("micro", "microstrain")] {
        let steps = load_path(&format!(
            "  rig_log: {{file: path.csv, time: t, axial_strain: {column}, unit: {unit}, \
             lateral: fixed, axis: y}}"
        ));
        let commands = path::commands(&steps, folder.path(), &BOX).unwrap();
        close(strain(&commands[0], &BOX), [0.0, -1e-4, 0.0]);
        close(strain(&commands[1], &BOX), [0.0, 2e-3, 0.0]);
    }
}

#[test]
fn a_wrong_rig_log_is_named_with_file_and_line() {
    let cases = [
        ("t,e\n0,0\n1,100\n", "3: column `e`: `100` is a strain of 1.0; allowed: below 1"),
        ("t,e\n0,0\n1,inf\n", "3: column `e`: `inf` is not a finite number"),
        ("t,e\n5,0\n1,0\n", "3: column `t`: 1.0 is before 5.0"),
        ("t,strain\n0,0\n", "1: column `e` is missing; the header has `t`, `strain`"),
        ("time,e\n0,0\n", "1: column `t` is missing; the header has `time`, `e`"),
        ("t,e\n", "1: no row follows the header"),
    ];
    for (text, start) in cases {
        let (folder, path) = file(text);
        let steps =
            load_path("  rig_log: {file: path.csv, time: t, axial_strain: e, unit: percent}");
        let error = path::commands(&steps, folder.path(), &BOX).unwrap_err().to_string();
        let expected = format!("{}:{start}", path.display());
        assert!(error.starts_with(&expected), "{error}\n{expected}");
    }
}

proptest! {
    #[test]
    fn an_undrained_log_keeps_any_volume_at_any_strain(
        strains in prop::collection::vec(-0.9..0.9_f64, 1..20),
        sides in prop::array::uniform3(1e-4..1e-2_f64),
        before in -0.2..0.2_f64,
    ) {
        let rows: String = (0..).zip(&strains).map(|(t, e)| format!("{t},{e:?}\n")).collect();
        let (folder, _) = file(format!("t,e\n{rows}"));
        let bounds = Bounds { min: sides.map(|side| -0.5 * side), max: sides.map(|side| 0.5 * side) };
        let steps = load_path(&format!(
            "- polyaxial: {{strain: [{before:?}, 0.0, 0.1], increments: 1}}\n\
             - rig_log: {{file: path.csv, time: t, axial_strain: e}}"
        ));
        let commands = path::commands(&steps, folder.path(), &bounds).unwrap();
        let volume = bounds.displaced(&commands[0].ask.numbers()).volume();
        for command in &commands[1..] {
            let now = bounds.displaced(&command.ask.numbers()).volume();
            prop_assert!((now / volume - 1.0).abs() < 1e-14, "{}", now / volume - 1.0);
        }
    }
}
