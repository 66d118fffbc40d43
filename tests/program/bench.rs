//! `graintwin bench` at the boundary of its process: table, JSON, CSV, diagram, exit codes.
#![cfg(unix)]

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use graintwin::bench::TOLERANCES;
use graintwin::scene::Method;
use serde_json::Value;

const LOAD_PATH: &str = "load_path: [{uniaxial: {axis: z, strain: 1.0e-3, increments: 10}}]\n";

/// A folder with a scene of 120 glass beads, and `more` of the scene.
struct Beads(tempfile::TempDir);

impl Beads {
    fn new(more: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scene = format!(
            "name: beads\npack: {{generate: {{grains: 120, radius: {{uniform: [0.07e-3, 0.13e-3]}}, \
             material: glass, confining_stress: 10.0e6}}}}\n{more}"
        );
        fs::write(folder.path().join("scene.yaml"), scene).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Exit code, stdout and stderr of `graintwin bench`.
    fn bench(&self, more: &[&str]) -> (i32, String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_graintwin"));
        command.arg("bench").arg(self.path("scene.yaml")).args(more).env_remove("RUST_LOG");
        let output = command.output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
    }

    /// The object that `--json` prints.
    fn json(&self, more: &[&str]) -> Value {
        let (code, stdout, stderr) = self.bench(&[&["--json"], more].concat());
        assert_eq!((code, stderr.as_str()), (0, ""));
        serde_json::from_str(&stdout).unwrap()
    }
}

/// The rows of Newton's method, from loose to tight.
fn newton(json: &Value) -> Vec<&Value> {
    let rows = json["rows"].as_array().unwrap();
    rows.iter().filter(|row| row["method"] == "newton").collect()
}

fn number(row: &Value, path: &str) -> f64 {
    row.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}: {row}"))
}

#[test]
fn tighter_tolerances_cost_more_work_and_leave_smaller_errors() {
    for friction in ["none", "{coefficient: 0.3}"] {
        let beads = Beads::new(&format!("contact: {{friction: {friction}}}\n{LOAD_PATH}"));
        let json = beads.json(&["--increments", "3", "--rounds", "1"]);
        let rows = newton(&json);
        let reference = number(&json, "/reference/tolerance");
        let looser: Vec<f64> = TOLERANCES.into_iter().filter(|one| *one > reference).collect();
        assert!(looser.len() >= 7, "{reference}");
        assert_eq!(rows.iter().map(|row| number(row, "/tolerance")).collect::<Vec<_>>(), looser);
        let (loose, tight) = (rows[1], rows[rows.len() - 1]);
        for row in &rows {
            assert_eq!((&row["ended"], &row["increments"]), (&"complete".into(), &3.into()));
            assert!(number(row, "/residual") <= number(row, "/tolerance"));
            assert!(number(row, "/cpu_seconds_mean") > 0.0);
            // Positions, two gradients, and the linear system are more than this.
            assert!((300.0..20_000.0).contains(&number(row, "/bytes_per_grain")), "{row}");
        }
        for work in ["/gradients", "/products"] {
            assert!(number(loose, work) < number(tight, work), "{work}: {json}");
        }
        for error in ["/force_error", "/position_error", "/modulus_error"] {
            for kind in ["/median", "/worst"] {
                let at = format!("{error}{kind}");
                let (loose, tight) = (number(loose, &at), number(tight, &at));
                // From a tolerance of 1e-3 to 1e-8 at least.
                assert!(tight < 1e-3 * loose, "{friction} {at}: {loose} {tight}");
            }
        }
        assert!(number(tight, "/force_error/worst") < 1e-8);
    }
}

#[test]
fn increments_are_those_of_the_path_and_the_work_does_not_depend_on_threads_or_rounds() {
    let beads = Beads::new("load_path: [{uniaxial: {axis: z, strain: 2.0e-4, increments: 2}}]\n");
    let one = beads.json(&["--rounds", "1"]);
    let two = beads.json(&["--rounds", "2", "--threads", "2"]);
    assert_eq!((&one["increments"], &two["threads"]), (&2.into(), &2.into()));
    for (one, two) in newton(&one).into_iter().zip(newton(&two)) {
        assert_eq!((&one["rounds"], &two["rounds"]), (&1.into(), &2.into()));
        for field in ["gradients", "products", "residual", "force_error", "modulus_error"] {
            assert_eq!(one[field], two[field], "{field}");
        }
    }
}

#[test]
fn the_folder_holds_the_table_as_csv_and_json_and_the_diagram_with_a_line_a_method() {
    let beads = Beads::new(LOAD_PATH);
    let out = beads.path("a/b");
    let arguments = ["--increments", "2", "--rounds", "1", "--out", out.to_str().unwrap()];
    let (code, table, stderr) = beads.bench(&arguments);
    assert_eq!((code, stderr.as_str()), (0, ""));
    for column in ["method", "tolerance", "ms, median", "gradients", "products", "bytes/grain"] {
        assert!(table.contains(column), "{column}: {table}");
    }
    let lines = table.lines().filter(|line| line.starts_with("newton"));

    let csv = fs::read_to_string(out.join("bench.csv")).unwrap();
    let cells: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert!(cells.iter().all(|row| row.len() == cells[0].len()), "{csv}");
    let json: Value =
        serde_json::from_str(&fs::read_to_string(out.join("bench.json")).unwrap()).unwrap();
    let rows = json["rows"].as_array().unwrap();
    assert_eq!((cells.len() - 1, lines.count()), (rows.len(), newton(&json).len()));
    let column = |name: &str| cells[0].iter().position(|cell| *cell == name).unwrap();
    for (cells, row) in cells[1..].iter().zip(rows) {
        assert_eq!(row["method"], cells[column("method")]);
        for (name, at) in
            [("tolerance", "/tolerance"), ("modulus_error_worst", "/modulus_error/worst")]
        {
            let written: Option<f64> = cells[column(name)].parse().ok();
            assert_eq!(written, row.pointer(at).unwrap().as_f64(), "{name}");
        }
    }

    let text = fs::read_to_string(out.join("bench.svg")).unwrap();
    let svg = roxmltree::Document::parse(&text).unwrap();
    let charts: Vec<_> =
        svg.descendants().filter(|node| node.attribute("class") == Some("chart")).collect();
    assert_eq!(charts.len(), 4);
    for chart in charts {
        let series = chart.children().filter(|node| node.attribute("class") == Some("series"));
        let names: Vec<_> =
            series.map(|node| node.first_element_child().unwrap().text().unwrap()).collect();
        assert_eq!(names, Method::ALL.map(Method::name));
        let places: Vec<&str> = chart
            .descendants()
            .filter(|node| node.parent().unwrap().attribute("class") == Some("series"))
            .filter_map(|node| node.attribute("points"))
            .collect();
        assert_eq!(places[0].split(' ').count(), newton(&json).len(), "{places:?}");
    }
}

#[test]
fn exit_2_for_wrong_arguments_and_scenes_without_a_path() {
    let beads = Beads::new("");
    let (code, stdout, stderr) = beads.bench(&[]);
    assert_eq!((code, stdout.as_str()), (2, ""), "{stderr}");
    assert!(stderr.contains("load_path has no increment"), "{stderr}");
    for arguments in [
        ["--increments", "0"],
        ["--rounds", "0"],
        ["--limit", "0"],
        ["--limit", "-1"],
        ["--threads", "0"],
        ["--speed", "1"],
    ] {
        let (code, stdout, stderr) = beads.bench(&arguments);
        assert_eq!((code, stdout.as_str()), (2, ""), "{arguments:?}: {stderr}");
    }
    let beads = Beads::new("load_path: [{commands: gone.csv}]\n");
    let (code, _, stderr) = beads.bench(&[]);
    assert!(code == 2 && stderr.contains("gone.csv: cannot be read"), "{stderr}");
}

#[test]
fn exit_1_where_the_path_cannot_be_walked_or_the_folder_not_be_made() {
    let beads = Beads::new("load_path: [{uniaxial: {axis: z, strain: 0.9, increments: 1}}]\n");
    let (code, stdout, stderr) = beads.bench(&[]);
    assert_eq!((code, stdout.as_str()), (1, ""), "{stderr}");
    assert!(stderr.contains("no reference: ") && stderr.contains("increment 1"), "{stderr}");

    let beads = Beads::new(LOAD_PATH);
    fs::write(beads.path("file"), "").unwrap();
    let out = beads.path("file/folder");
    let (code, stdout, stderr) = beads.bench(&["--out", out.to_str().unwrap()]);
    assert_eq!((code, stdout.as_str()), (1, ""), "{stderr}");
    assert!(stderr.starts_with(&format!("error: cannot write {}", out.display())), "{stderr}");
}
