//! The program at the boundary of its process: exit codes, stdout, stderr.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

fn graintwin(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_graintwin"));
    command.args(arguments).env_remove("RUST_LOG");
    command
}

/// What a process left: exit code, stdout, stderr.
fn ended(command: &mut Command) -> (i32, String, String) {
    let Output { status, stdout, stderr } = command.output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

fn launch_config(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("launch_configs");
    folder.join(name).to_str().unwrap().to_owned()
}

const RADIUS: f64 = 1e-4;
/// Overlap of the one grain with each wall.
const OVERLAP: f64 = 1e-7;
const GLASS: (f64, f64) = (70e9, 0.2);
const WALL: (f64, f64) = (7e12, 0.495);

/// A folder with a scene of one glass bead pressed by six walls, and `more` of the scene.
struct Bead(tempfile::TempDir);

impl Bead {
    fn new(more: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let half = RADIUS - OVERLAP;
        let scene = format!(
            "materials: {{glass: {{young: 70e9, poisson: 0.2, density: 2420}}}}\n\
             pack:\n  file: bead.csv\n  material: glass\n  \
             box: {{min: [-{half}, -{half}, -{half}], max: [{half}, {half}, {half}]}}\n{more}\n"
        );
        fs::write(folder.path().join("bead.csv"), format!("x,y,z,radius\n0,0,0,{RADIUS}\n"))
            .unwrap();
        fs::write(folder.path().join("scene.yaml"), scene).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }

    fn run(&self, more: &[&str]) -> (i32, String, String) {
        let scene = self.text("scene.yaml");
        ended(graintwin(&["run", &scene]).args(more))
    }
}

/// Hertz between a sphere and a half space: F = 4/3 E* sqrt(R) h^(3/2).
fn wall_force(overlap: f64) -> f64 {
    let compliance = |(young, poisson): (f64, f64)| (1.0 - poisson * poisson) / young;
    4.0 / 3.0 / (compliance(GLASS) + compliance(WALL)) * RADIUS.sqrt() * overlap.powf(1.5)
}

#[test]
fn exit_0_with_the_summary_on_stdout_alone_when_all_commands_are_served() {
    let bead = Bead::new("load_path: {uniaxial: {strain: 1e-4, increments: 2}}");
    let (code, stdout, stderr) = bead.run(&[]);
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert!(stdout.contains("2 (2 APPLIED)"), "{stdout}");
}

#[test]
fn the_summary_as_json_is_one_object_with_the_forces_of_start_and_end() {
    let bead = Bead::new("load_path: {uniaxial: {strain: 1e-4, increments: 2}}");
    let (code, stdout, stderr) = bead.run(&["--json", "--threads", "2"]);
    assert_eq!((code, stderr.as_str()), (0, ""));
    let json: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&json["grains"], &json["increments"]), (&1.into(), &2.into()));
    assert_eq!(json["commands"]["APPLIED"], 2);
    let force =
        |moment: &str, wall: usize| json[moment]["walls"]["normal_force"][wall].as_f64().unwrap();
    let start = wall_force(OVERLAP);
    // Each z wall goes in by half of 1e-4 of the side.
    let end = wall_force(OVERLAP + 1e-4 * (RADIUS - OVERLAP));
    for wall in 0..6 {
        assert!((force("start", wall) / start - 1.0).abs() < 1e-9, "{wall}: {stdout}");
        let expected = if wall < 4 { start } else { end };
        assert!((force("end", wall) / expected - 1.0).abs() < 1e-9, "{wall}: {stdout}");
    }
}

#[test]
fn the_table_speaks_of_friction_where_there_is_some() {
    // The x_min wall pushes the grain, which the y and z walls hold back by friction.
    let push = "load_path: {uniaxial: {axis: x, strain: 1e-5, increments: 1, moving: min}}";
    let rows = ["sliding ratio", "tangential/normal", "dissipated energy", "contacts opened"];
    let rough = Bead::new(&format!("contact: {{friction: {{coefficient: 0.3}}}}\n{push}"));
    let (code, table, stderr) = rough.run(&[]);
    assert_eq!((code, stderr.as_str()), (0, ""));
    for row in rows {
        assert!(table.contains(row), "no `{row}`: {table}");
    }
    let (_, json, _) = rough.run(&["--json"]);
    let json: Value = serde_json::from_str(&json).unwrap();
    let number = |field: &str| json["end"]["state"][field].as_f64().unwrap();
    let share = number("mean_tangential_force") / number("mean_normal_force");
    let line = table.lines().find(|line| line.starts_with("tangential/normal")).unwrap();
    let shown: Vec<f64> =
        line.split_whitespace().skip(1).map(|word| word.parse().unwrap()).collect();
    assert_eq!(shown[0], 0.0);
    assert!(share > 0.0 && (shown[1] / share - 1.0).abs() < 1e-5, "{share}: {line}");

    let (_, table, _) = Bead::new(push).run(&[]);
    for row in rows {
        assert!(!table.contains(row), "`{row}` without friction: {table}");
    }
}

#[test]
fn without_commands_the_initial_equilibrium_is_measured() {
    let (code, stdout, _) = Bead::new("").run(&["--json"]);
    let json: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((code, &json["increments"]), (0, &0.into()));
    assert_eq!(json["end"]["state"]["coordination_number"], 6.0);
}

#[test]
fn a_command_csv_takes_the_place_of_the_load_path() {
    let bead = Bead::new("load_path: {uniaxial: {strain: 1e-4, increments: 5}}");
    fs::write(bead.path("c.csv"), "stamp,x_min\n0,1e-8\n").unwrap();
    let (code, stdout, _) = bead.run(&["--json", "--commands", &bead.text("c.csv")]);
    let json: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((code, &json["increments"]), (0, &1.into()));
    assert_eq!(json["end"]["walls"]["displacement"][0], 1e-8);
}

#[test]
fn exit_1_when_a_result_cannot_be_written() {
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let (code, _, stderr) = ended(graintwin(&["completions", "bash"]).stdout(full()));
    assert_eq!(code, 1, "{stderr}");
    assert!(stderr.starts_with("error: stdout: "), "{stderr}");

    let bead = Bead::new("");
    std::os::unix::fs::symlink("/dev/full", bead.path("full.csv")).unwrap();
    for name in ["full.csv", "missing/folder.csv"] {
        let out = bead.text(name);
        let scene = bead.text("scene.yaml");
        let (code, stdout, stderr) = ended(&mut graintwin(&["generate", &scene, "--out", &out]));
        assert_eq!((code, stdout.as_str()), (1, ""), "{stderr}");
        assert!(stderr.starts_with(&format!("error: {out}: the pack cannot be written: ")));
    }
}

#[test]
fn exit_2_for_wrong_arguments() {
    let scene = launch_config("quickstart.yaml");
    let cases: &[&[&str]] = &[
        &[],
        &["fly"],
        &["run"],
        &["run", &scene, "--threads", "0"],
        &["run", &scene, "--speed", "1"],
        &["run", &scene, "-v", "-q"],
        &["generate", &scene],
        &["completions", "dos"],
    ];
    for arguments in cases {
        let (code, stdout, stderr) = ended(&mut graintwin(arguments));
        assert_eq!((code, stdout.as_str()), (2, ""), "{arguments:?}: {stderr}");
        assert!(!stderr.is_empty(), "{arguments:?}");
    }
}

#[test]
fn exit_2_for_wrong_input_files_with_every_complaint_on_a_line_of_stderr() {
    let bead = Bead::new("solver: {tolerance: 1}\ndimension: 4");
    let scene = bead.text("scene.yaml");
    let missing = bead.text("missing.yaml");
    for verb in ["run", "check"] {
        let (code, stdout, stderr) = ended(&mut graintwin(&[verb, &scene]));
        assert_eq!((code, stdout.as_str()), (2, ""), "{stderr}");
        let expected = format!(
            "error: {scene}:6:21: solver.tolerance: 1.0 is outside 1e-13 <= tolerance <= 1e-2\n\
             error: {scene}:7:12: dimension: 4; allowed: 2, 3\n"
        );
        assert_eq!(stderr, expected);

        let (code, stdout, stderr) = ended(&mut graintwin(&[verb, &missing]));
        assert_eq!((code, stdout.as_str()), (2, ""), "{stderr}");
        assert!(stderr.starts_with(&format!("error: {missing}: the scene cannot be read: ")));
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
    }
}

#[test]
fn exit_2_for_wrong_files_that_a_scene_or_an_argument_names() {
    let bead = Bead::new("load_path: {commands: gone.csv}");
    let (code, stdout, stderr) = bead.run(&[]);
    assert_eq!((code, stdout.as_str()), (2, ""), "{stderr}");
    assert!(stderr.contains("gone.csv: cannot be read: "), "{stderr}");

    fs::write(bead.path("c.csv"), "stamp,x_min\n0,nan\n").unwrap();
    let (code, _, stderr) = bead.run(&["--commands", &bead.text("c.csv")]);
    assert_eq!(code, 2);
    assert!(stderr.contains("c.csv:2: column `x_min`: `nan` is not a finite number"), "{stderr}");

    fs::write(bead.path("bead.csv"), "x,y,z,radius\n0,0,0,-1e-4\n").unwrap();
    let (code, _, stderr) = bead.run(&[]);
    assert_eq!(code, 2);
    assert!(stderr.contains("bead.csv:2: column `radius`: -0.0001 is outside"), "{stderr}");
}

#[test]
fn exit_2_for_a_pack_whose_name_is_no_csv() {
    let bead = Bead::new("");
    let (scene, out) = (bead.text("scene.yaml"), bead.text("bead.json"));
    let (code, _, stderr) = ended(&mut graintwin(&["generate", &scene, "--out", &out]));
    assert_eq!(code, 2, "{stderr}");
    assert!(!bead.path("bead.json").exists());
}

#[test]
fn exit_3_when_a_command_is_refused_and_the_summary_says_which() {
    let bead = Bead::new("");
    fs::write(bead.path("c.csv"), "stamp,x_min\n0,1e-8\n1,1.0\n2,2e-8\n").unwrap();
    let commands = bead.text("c.csv");
    let (code, stdout, stderr) = bead.run(&["--json", "--commands", &commands]);
    assert_eq!(code, 3, "{stderr}");
    let json: Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!((&json["refused"], &json["increments"]), (&1.into(), &2.into()));
    let why = json["first_refusal"].as_str().unwrap();
    assert!(why.starts_with("command 2 of session `load_path`: LIMIT: "), "{why}");
    assert!(stderr.contains(why), "{stderr}");
    // -q leaves the errors only; this is none.
    let (code, _, stderr) = bead.run(&["-q", "--commands", &commands]);
    assert_eq!((code, stderr.as_str()), (3, ""));
}

#[test]
fn an_interrupt_ends_the_run_after_the_increment_at_hand_with_its_summary() {
    let bead = Bead::new("load_path: {isotropic: {strain: 1e-4, increments: 1000000}}");
    let scene = bead.text("scene.yaml");
    let mut child = graintwin(&["run", &scene, "--json", "-v"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Signals are listened to before the commands are counted.
    let mut line = String::new();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    while !line.contains("1000000 commands") {
        line.clear();
        assert!(stderr.read_line(&mut line).unwrap() > 0, "no word about the commands");
    }
    // A launcher passes the signal on that the terminal has sent as well.
    let twice = format!("kill -INT {0}; kill -INT {0}; kill -TERM {0}", child.id());
    let sent = Command::new("sh").args(["-c", &twice]).status().unwrap();
    assert!(sent.success(), "{sent}");
    let Output { status, stdout, .. } = child.wait_with_output().unwrap();
    assert_eq!(status.code(), Some(0));
    let json: Value = serde_json::from_slice(&stdout).unwrap();
    assert!(json["increments"].as_u64().unwrap() < 1_000_000);
}

#[test]
fn a_generated_pack_is_stored_checked_and_run() {
    let bead = Bead::new("");
    let out = bead.text("beads.csv");
    let made = launch_config("quickstart.yaml");
    let (code, stdout, stderr) = ended(&mut graintwin(&["generate", &made, "--out", &out]));
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert!(stdout.contains("306"), "{stdout}");

    let (code, stdout, stderr) = ended(&mut graintwin(&["check", &out]));
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert!(stdout.contains("grains          306") && stdout.contains("beads.json"), "{stdout}");

    fs::write(bead.path("scene.yaml"), "pack: {file: beads.csv}\n").unwrap();
    let (code, stdout, stderr) = bead.run(&["--json"]);
    assert_eq!((code, stderr.as_str()), (0, ""));
    let json: Value = serde_json::from_str(&stdout).unwrap();
    let stress = json["end"]["state"]["confining_stress"].as_f64().unwrap();
    assert!((stress / 10e6 - 1.0).abs() < 1e-2, "{stress} Pa for the 10 MPa of the scene");
}

#[test]
fn a_prepared_pack_is_told_step_by_step_and_runs_from_where_it_was_left() {
    let bead = Bead::new("");
    let source = "generate: {grains: 40, radius: {constant: 1e-4}, material: glass, \
                  confining_stress: 1e6}";
    let steps = "[isotropic: {confining_stress: 5e6}, uniaxial: {strain: 2e-4}]";
    fs::write(bead.path("scene.yaml"), format!("pack: {{{source}, prepare: {steps}}}")).unwrap();
    let (scene, out) = (bead.text("scene.yaml"), bead.text("beads.csv"));

    let (code, stdout, stderr) = ended(&mut graintwin(&["check", &scene]));
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert!(stdout.contains("step 1          to 5.000 MPa without friction"), "{stdout}");
    assert!(stdout.contains("step 2          uniaxial, a strain of 0.0002"), "{stdout}");

    let (code, stdout, stderr) = ended(&mut graintwin(&["generate", &scene, "--out", &out]));
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert!(stdout.contains("step 1          5.000 MPa confining, without friction\n"), "{stdout}");
    let told = stdout.lines().find(|line| line.starts_with("step 2")).unwrap();
    let told: f64 = told.split_whitespace().nth(2).unwrap().parse().unwrap();
    assert!(told > 5.0, "{stdout}");

    let stress = |json: &str| {
        let json: Value = serde_json::from_str(json).unwrap();
        json["start"]["state"]["confining_stress"].as_f64().unwrap()
    };
    let (code, whole, _) = bead.run(&["--json"]);
    assert_eq!(code, 0);
    fs::write(bead.path("scene.yaml"), "pack: {file: beads.csv}\n").unwrap();
    let (code, loaded, _) = bead.run(&["--json"]);
    assert_eq!(code, 0);
    assert_eq!(stress(&whole).to_bits(), stress(&loaded).to_bits());
    assert!((stress(&whole) * 1e-6 - told).abs() < 1e-3, "{whole}");
}

#[test]
fn exit_1_for_a_preparation_that_does_not_settle() {
    // Infinite friction: no contact ever slides.
    let bead = Bead::new("contact: {friction: {coefficient: .inf}}");
    let scene = fs::read_to_string(bead.path("scene.yaml")).unwrap();
    let steps = "  prepare: [uniaxial: {window: 1, max_strain: 2e-4}]\ncontact:";
    fs::write(bead.path("scene.yaml"), scene.replace("contact:", steps)).unwrap();
    let (code, stdout, stderr) = bead.run(&[]);
    assert_eq!((code, stdout.as_str()), (1, ""), "{stderr}");
    assert_eq!(
        stderr,
        "error: pack.prepare[0].uniaxial: not steady at max_strain = 0.0002: the sliding ratio is \
         0.0000 and changed by 0.0000 over the last 1 increments; allowed: above 0 and less than \
         steady = 0.005, so take a larger max_strain or steady\n"
    );
}

#[test]
fn the_history_of_a_pack_is_checked_and_told_and_its_loss_as_well() {
    let bead = Bead::new("contact: {friction: {}}");
    let json = r#"{"box": {"min": [-1, -1, -1], "max": [1, 1, 1]}, "history": "h.json"}"#;
    fs::write(bead.path("bead.json"), json).unwrap();
    let history = r#"{"rotations": [[0, 0, 0]], "contacts": [{"first": 0, "second": 4294967295,
        "shear": [0, 1, 0], "torsion": 0, "sliding": true}]}"#;
    fs::write(bead.path("h.json"), history).unwrap();
    for file in ["bead.csv", "scene.yaml"] {
        let (code, stdout, stderr) = ended(&mut graintwin(&["check", &bead.text(file)]));
        assert_eq!((code, stderr.as_str()), (0, ""));
        assert!(stdout.contains("history         1 contacts, of which 1 slid last"), "{stdout}");
    }
    let scene = fs::read_to_string(bead.path("scene.yaml")).unwrap();
    let cut = "  cut: {min: [-1, -1, -1], max: [1, 1, 1]}\ncontact:";
    fs::write(bead.path("cut.yaml"), scene.replace("contact:", cut)).unwrap();
    let (code, stdout, stderr) = ended(&mut graintwin(&["check", &bead.text("cut.yaml")]));
    assert_eq!(code, 0);
    assert!(stderr.contains("pack.cut drops the history"), "{stderr}");
    assert!(stdout.contains("history         none"), "{stdout}");
    fs::write(bead.path("smooth.yaml"), scene.replace("friction: {}", "friction: none")).unwrap();
    let (code, _, stderr) = ended(&mut graintwin(&["check", &bead.text("smooth.yaml")]));
    assert_eq!(code, 0);
    assert!(stderr.contains("bead.csv: the history of the pack is not used"), "{stderr}");

    fs::write(bead.path("h.json"), history.replace("4294967295", "1")).unwrap();
    for file in ["bead.csv", "scene.yaml"] {
        let (code, stdout, stderr) = ended(&mut graintwin(&["check", &bead.text(file)]));
        assert_eq!((code, stdout.as_str()), (2, ""));
        assert!(stderr.contains("h.json: contacts[0].second: 1; allowed: a grain"), "{stderr}");
    }
}

#[test]
fn the_printed_scene_is_a_scene_with_the_same_defaults() {
    let bead = Bead::new("load_path: {uniaxial: {strain: 1e-4, increments: 2}}");
    let scene = bead.text("scene.yaml");
    let (code, printed, stderr) = ended(&mut graintwin(&["run", "--print-config", &scene]));
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert!(printed.contains("tolerance: 1.0e-8"), "{printed}");
    fs::write(bead.path("scene.yaml"), &printed).unwrap();
    let (code, again, _) = ended(&mut graintwin(&["check", "--print-config", &scene]));
    assert_eq!((code, again), (0, printed));
}

#[test]
fn every_launch_config_is_right() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("launch_configs");
    let mut scenes = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "yaml") {
            let file = path.to_str().unwrap();
            let (code, stdout, stderr) = ended(&mut graintwin(&["check", file]));
            assert_eq!((code, stderr.as_str()), (0, ""), "{file}");
            assert!(stdout.contains("load path"), "{stdout}");
            scenes += 1;
        }
    }
    assert!(scenes >= 7, "{scenes}");
}

#[test]
fn a_kind_of_file_that_is_not_known_is_refused() {
    let (code, _, stderr) = ended(&mut graintwin(&["check", "Cargo.toml"]));
    assert_eq!(code, 2);
    assert!(stderr.contains("allowed: .yaml or .yml for a scene, .csv for a pack"), "{stderr}");
}

#[test]
fn help_and_version_are_results() {
    for arguments in [&["--help"][..], &["run", "--help"], &["--version"], &["help", "check"]] {
        let (code, stdout, stderr) = ended(&mut graintwin(arguments));
        assert_eq!((code, stderr.as_str()), (0, ""), "{arguments:?}");
        assert!(!stdout.is_empty());
    }
    let (_, version, _) = ended(&mut graintwin(&["--version"]));
    assert!(version.starts_with(concat!("graintwin ", env!("CARGO_PKG_VERSION"), " (features: ")));
}

#[test]
fn every_shell_gets_its_completions() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let (code, stdout, stderr) = ended(&mut graintwin(&["completions", shell]));
        assert_eq!((code, stderr.as_str()), (0, ""));
        assert!(stdout.contains("print-config"), "{shell}");
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let mut child = graintwin(&["completions", "bash"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let Output { status, stderr, .. } = child.wait_with_output().unwrap();
    assert_eq!((status.code(), stderr.as_slice()), (Some(0), &b""[..]));
}
