//! The launch and parameter files, held against the program: their command lines against its
//! parsers, their parameters against its own.
#![cfg(feature = "ros")]

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use graintwin::node::Identity;
use graintwin::node::args::{self, Severity};
use graintwin::node::parameters::{Descriptor, Parameters, all, overrides};
use graintwin::scene;
use roxmltree::{Document, Node};

fn configs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("launch_configs")
}

fn files(folder: &str) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        fs::read_dir(configs().join(folder)).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty());
    files
}

/// Arguments of a launch file by name.
type Arguments = BTreeMap<String, String>;

/// `$(dirname)` and `$(var NAME)` replaced, as the launcher does it.
fn substituted(text: &str, file: &Path, arguments: &Arguments) -> String {
    let mut text = text.replace("$(dirname)", file.parent().unwrap().to_str().unwrap());
    for (name, value) in arguments {
        text = text.replace(&format!("$(var {name})"), value);
    }
    text
}

/// The command lines that the launcher would start with `arguments`, of all branches.
fn command_lines(file: &Path, given: &Arguments) -> Vec<Vec<String>> {
    let text = fs::read_to_string(file).unwrap();
    let document = Document::parse(&text).unwrap();
    let mut arguments = given.clone();
    let mut lines = Vec::new();
    for element in document.root_element().children().filter(Node::is_element) {
        let attribute = |name: &str| {
            let text = element.attribute(name).unwrap_or_else(|| panic!("{element:?}: no {name}"));
            let text = substituted(text, file, &arguments);
            assert!(!text.contains("$("), "{text}");
            text
        };
        match element.tag_name().name() {
            "arg" => {
                let name = attribute("name");
                assert!(!attribute("description").is_empty());
                if !given.contains_key(&name) {
                    let default = attribute("default");
                    arguments.insert(name, default);
                }
            }
            "include" => {
                let passed = element
                    .children()
                    .filter(Node::is_element)
                    .map(|arg| {
                        let value = arg.attribute("value").unwrap();
                        (
                            arg.attribute("name").unwrap().to_owned(),
                            substituted(value, file, &arguments),
                        )
                    })
                    .collect();
                lines.extend(command_lines(Path::new(&attribute("file")), &passed));
            }
            "node" => {
                assert!(element.attribute("pkg").is_none(), "there is no package");
                let words =
                    |text: String| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
                let mut line = words(attribute("args"));
                line.push("--ros-args".into());
                line.extend(words(attribute("ros_args")));
                line.extend(["-r".into(), format!("__node:={}", attribute("name"))]);
                line.extend(["-r".into(), format!("__ns:={}", attribute("namespace"))]);
                for parameter in element.children().filter(|child| child.has_tag_name("param")) {
                    let value = |name| {
                        parameter.attribute(name).map(|text| substituted(text, file, &arguments))
                    };
                    match (value("from"), value("name"), value("value")) {
                        (Some(from), None, None) => line.extend(["--params-file".into(), from]),
                        (None, Some(name), Some(value)) => {
                            line.extend(["-p".into(), format!("{name}:={value}")]);
                        }
                        other => panic!("{other:?}"),
                    }
                }
                lines.push(line);
            }
            other => panic!("{other}: the test does not know what the launcher makes of it"),
        }
    }
    lines
}

fn store() -> Parameters {
    let scene = scene::parse("pack: {file: a.csv}", "a.yaml".as_ref()).unwrap();
    Parameters::new(&scene, 1)
}

#[test]
fn every_launch_file_makes_command_lines_that_the_program_takes() {
    let folder = tempfile::tempdir().unwrap();
    let record = folder.path().join("bag").to_str().unwrap().to_owned();
    for file in files("launch") {
        let given = Arguments::from([("record".to_owned(), record.clone())]);
        let lines = command_lines(&file, &given);
        assert_eq!(lines.len(), 2, "with a recording and without");
        let recorded = lines.iter().filter(|line| line.contains(&record)).count();
        assert_eq!(recorded, 1);
        for line in lines {
            let (_, taken) = args::split(line.iter().map(OsString::from)).unwrap();
            let taken = taken.unwrap();
            assert!(taken.ignored.is_empty(), "{:?}", taken.ignored);
            assert!(matches!(taken.log.level, Some(Severity::Info | Severity::Warn)));
            let identity = Identity::new(&taken.remaps);
            assert_eq!(identity.name(), "graintwin");
            let values = overrides::read(&taken.parameters, &identity).unwrap();
            assert!(!values.is_empty());
            assert_eq!(store().start_with(&values).unwrap(), Vec::<String>::new());

            let output = Command::new(env!("CARGO_BIN_EXE_graintwin"))
                .arg("--print-config")
                .args(&line)
                .output()
                .unwrap();
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success() && said.is_empty(), "{line:?}: {said}");
        }
    }
}

#[test]
fn the_two_nodes_of_the_launch_file_differ_in_the_recording_only_and_exclude_each_other() {
    let text = fs::read_to_string(configs().join("launch/graintwin.launch.xml")).unwrap();
    let document = Document::parse(&text).unwrap();
    let nodes: Vec<_> =
        document.root_element().children().filter(|node| node.has_tag_name("node")).collect();
    let [with, without] = nodes[..] else { panic!("{nodes:?}") };
    assert_eq!(with.attribute("unless").unwrap(), without.attribute("if").unwrap());
    assert!(with.attribute("if").is_none() && without.attribute("unless").is_none());
    let args = |node: &Node| node.attribute("args").unwrap().to_owned();
    assert_eq!(args(&with), format!("{} --record $(var record)", args(&without)));
    for attribute in with.attributes().filter(|a| !["unless", "args"].contains(&a.name())) {
        assert_eq!(Some(attribute.value()), without.attribute(attribute.name()));
    }
}

#[test]
fn every_parameter_in_the_files_exists_and_takes_its_value() {
    for file in files("params") {
        let text = fs::read_to_string(&file).unwrap();
        let values = overrides::parse_file(&text, &file, "/any/name").unwrap();
        assert!(!values.is_empty());
        assert_eq!(store().start_with(&values).unwrap(), Vec::<String>::new());
    }
}

#[test]
fn the_default_file_names_every_parameter_that_can_be_set_with_its_default() {
    let file = configs().join("params/default.yaml");
    let text = fs::read_to_string(&file).unwrap();
    let (head, body) = text.split_once("/**:").unwrap();
    assert!(head.lines().all(|line| line.starts_with('#')));
    let all_set = format!("/**:{}", body.replace("\n    # ", "\n    "));
    let values = overrides::parse_file(&all_set, &file, "/n").unwrap();
    let mut named: Vec<&str> = values.iter().map(|value| value.name.as_str()).collect();
    named.sort_unstable();
    let taken: Vec<&str> = all().iter().filter(|one| !one.tells()).map(|one| one.name).collect();
    assert_eq!(named, taken);
    let defaults = store();
    for value in &values {
        assert_eq!(defaults.get(&value.name).as_ref(), Some(&value.value), "{}", value.name);
    }
}

#[test]
fn the_documentation_names_every_parameter_with_its_type() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/ros.md");
    let text = fs::read_to_string(file).unwrap();
    let table = text.split_once("## Parameters").unwrap().1.split_once("\n## ").unwrap().0;
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with("| `")).collect();
    let start = |one: &Descriptor| {
        let read_only = if one.read_only() { ", read-only" } else { "" };
        format!("| `{}` | {}{read_only} |", one.name, one.kind())
    };
    let expected: Vec<String> = all().iter().map(start).collect();
    assert_eq!(rows.len(), expected.len());
    for (row, expected) in rows.iter().zip(&expected) {
        assert!(row.starts_with(expected), "{row}: {expected}");
    }
}
