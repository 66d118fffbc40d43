//! The package of the messages, read as ROS 2's own tools read it (REP-149).

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::python;

fn package() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("msgs/graintwin_msgs")
}

fn strings(value: &Value) -> BTreeSet<&str> {
    value.as_array().unwrap().iter().map(|one| one.as_str().unwrap()).collect()
}

/// Definitions of one kind, by name.
fn definitions(kind: &str) -> Vec<(String, String)> {
    let files = fs::read_dir(package().join(kind)).unwrap();
    files
        .map(|file| {
            let path = file.unwrap().path();
            assert_eq!(path.extension().unwrap(), kind, "{}", path.display());
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            (name, fs::read_to_string(path).unwrap())
        })
        .collect()
}

/// Types and names of the fields and constants of a definition.
fn lines(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let lines = text.lines().map(|line| line.split('#').next().unwrap().trim());
    lines
        .filter(|line| !line.is_empty() && *line != "---")
        .map(|line| line.split_once(' ').unwrap())
}

/// Packages that the definitions take types from.
fn used_packages() -> BTreeSet<String> {
    let others = |package: &&str| *package != "graintwin_msgs";
    let all = definitions("msg").into_iter().chain(definitions("srv"));
    all.flat_map(|(_, text)| {
        let packages = lines(&text).filter_map(|(kind, _)| kind.split_once('/'));
        let packages = packages.map(|(package, _)| package).filter(others);
        packages.map(str::to_owned).collect::<Vec<_>>()
    })
    .collect()
}

#[test]
fn catkin_and_colcon_take_the_package_and_it_depends_on_what_it_uses() {
    let logs = tempfile::tempdir().unwrap();
    let Some(said) = python::run("package.py", &[&package(), logs.path()], "") else { return };
    let read: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(read["warnings"], json!([]));
    assert_eq!(read["name"], "graintwin_msgs");
    assert_eq!((&read["format"], &read["build_type"]), (&json!(3), &json!("ament_cmake")));
    assert_eq!(read["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(read["licenses"], json!([env!("CARGO_PKG_LICENSE")]));
    assert!(!read["maintainers"].as_array().unwrap().is_empty());
    assert_eq!(read["groups"], json!(["rosidl_interface_packages"]));
    assert!(
        strings(&read["buildtool"])
            .is_superset(&BTreeSet::from(["ament_cmake", "rosidl_default_generators"]))
    );
    assert!(strings(&read["run"]).contains("rosidl_default_runtime"));
    assert!(strings(&read["test"]).contains("ament_lint_common"));
    let recipe = fs::read_to_string(package().join("CMakeLists.txt")).unwrap();
    for used in used_packages() {
        assert!(strings(&read["build"]).contains(&*used), "package.xml lacks {used}");
        assert!(strings(&read["run"]).contains(&*used), "package.xml lacks {used}");
        assert!(recipe.contains(&format!("find_package({used} REQUIRED)")), "{used}");
    }
    // What README says: without --base-paths the cargo plug-in hides the package.
    assert_eq!(
        read["colcon_msgs"],
        json!([["graintwin_msgs", "msgs/graintwin_msgs", "(ros.ament_cmake)"]])
    );
    assert_eq!(read["colcon_root"], json!([["graintwin", ".", "(cargo)"]]));
    let readme =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    assert!(readme.contains("colcon build --base-paths msgs"));
}

#[test]
fn names_of_fields_and_constants_are_as_ros_2_wants_them() {
    let is_field = |name: &str| {
        let simple = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        name.starts_with(|c: char| c.is_ascii_lowercase())
            && name.chars().all(simple)
            && !name.ends_with('_')
            && !name.contains("__")
    };
    let is_constant =
        |name: &str| name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
    for (name, text) in definitions("msg").into_iter().chain(definitions("srv")) {
        assert!(name.starts_with(|c: char| c.is_ascii_uppercase()), "{name}");
        assert!(text.starts_with('#') && text.ends_with('\n'), "{name} begins without a comment");
        for (_, field) in lines(&text) {
            match field.split_once('=') {
                Some((constant, _)) => assert!(is_constant(constant.trim()), "{name}: {constant}"),
                None => assert!(is_field(field), "{name}: {field}"),
            }
        }
    }
}

#[test]
fn the_change_log_and_the_readme_of_the_package_name_every_definition() {
    let log = fs::read_to_string(package().join("CHANGELOG.rst")).unwrap();
    assert!(
        log.contains(&format!("\n{} (", env!("CARGO_PKG_VERSION"))),
        "no entry of this version"
    );
    let readme = fs::read_to_string(package().join("README.md")).unwrap();
    for kind in ["msg", "srv"] {
        for (name, _) in definitions(kind) {
            assert!(log.contains(&name), "CHANGELOG.rst lacks {name}");
            assert!(readme.contains(&format!("`{kind}/{name}.{kind}`")), "README.md lacks {name}");
        }
    }
}
