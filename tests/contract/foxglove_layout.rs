//! The layout for Foxglove and Lichtblick, held against the topics, their types and the frames.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use graintwin::msg::topics::{self, Topic};
use graintwin::msg::{Described, DiagnosticArray, MarkerArray, MessageType, PointCloud2, rcl};
use graintwin::wall;
use serde_json::{Map, Value};

fn layout() -> Value {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("launch_configs/foxglove/graintwin.json");
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

/// The panels by type, as `Plot`, and the rest of their name.
fn panels(layout: &Value) -> Vec<(&str, &str, &Map<String, Value>)> {
    let panels = layout["configById"].as_object().unwrap();
    panels
        .iter()
        .map(|(id, config)| {
            let (kind, _) = id.split_once('!').unwrap();
            (kind, id.as_str(), config.as_object().unwrap())
        })
        .collect()
}

fn topic(name: &str) -> &'static Topic {
    let found = topics::all().find(|topic| topic.recorded_name() == name);
    found.unwrap_or_else(|| panic!("no topic {name}"))
}

/// The type of a field of `kind`, as its definition writes it.
fn field(kind: &'static MessageType, name: &str) -> &'static str {
    let lines = kind.text.lines().map(|line| line.split('#').next().unwrap().trim());
    let mut fields = lines.filter_map(|line| line.split_once(' '));
    let found = fields.find(|(_, rest)| rest.trim() == name);
    found.unwrap_or_else(|| panic!("{} has no field {name}", kind.full_name())).0
}

/// The type at the end of a path, as `/topic.field[3].field`: a number, or a message.
fn resolve(path: &str) -> &'static str {
    let (name, fields) = path.split_once('.').unwrap_or((path, ""));
    let mut kind = topic(name).kind;
    let mut at = "";
    for step in fields.split('.').filter(|step| !step.is_empty()) {
        let (name, index) = match step.split_once('[') {
            Some((name, rest)) => (name, Some(rest.strip_suffix(']').unwrap())),
            None => (step, None),
        };
        at = field(kind, name);
        match (at.split_once('['), index) {
            (Some((of, rest)), Some(index)) => {
                let length = rest.strip_suffix(']').unwrap();
                let index: usize = index.parse().unwrap();
                assert!(length.is_empty() || index < length.parse().unwrap(), "{path}");
                at = of;
            }
            (None, None) => {}
            other => panic!("{path}: {other:?}"),
        }
        let short = at.rsplit('/').next().unwrap();
        kind = kind.uses.iter().find(|one| one.name == short).copied().unwrap_or(kind);
    }
    at
}

/// Panels in the order in which the tree names them.
fn placed(tree: &Value, into: &mut Vec<String>) {
    match tree {
        Value::String(id) => into.push(id.clone()),
        Value::Object(split) => {
            assert!(["row", "column"].contains(&split["direction"].as_str().unwrap()));
            placed(&split["first"], into);
            placed(&split["second"], into);
        }
        other => panic!("{other}"),
    }
}

/// Every text of a value, keys among them.
fn texts<'a>(value: &'a Value, into: &mut Vec<&'a str>) {
    match value {
        Value::String(text) => into.push(text),
        Value::Array(all) => all.iter().for_each(|one| texts(one, into)),
        Value::Object(all) => all.iter().for_each(|(key, one)| {
            into.push(key);
            texts(one, into);
        }),
        _ => {}
    }
}

#[test]
fn every_panel_has_one_place() {
    let layout = layout();
    let mut all = Vec::new();
    placed(&layout["layout"], &mut all);
    for (_, _, config) in panels(&layout).iter().filter(|(kind, ..)| *kind == "Tab") {
        for tab in config["tabs"].as_array().unwrap() {
            assert!(!tab["title"].as_str().unwrap().is_empty());
            placed(&tab["layout"], &mut all);
        }
    }
    all.sort();
    let mut known: Vec<&str> = panels(&layout).into_iter().map(|(_, id, _)| id).collect();
    known.sort_unstable();
    assert_eq!(all, known);
}

#[test]
fn every_topic_and_field_exists() {
    let layout = layout();
    let mut all = Vec::new();
    texts(&layout, &mut all);
    let paths: BTreeSet<&str> = all.into_iter().filter(|text| text.starts_with('/')).collect();
    paths.iter().for_each(|path| {
        resolve(path);
    });
    let wanted = [
        "/diagnostics",
        "/graintwin/grains",
        "/graintwin/markers",
        "/graintwin/report",
        "/graintwin/state",
        "/rosout",
    ];
    assert!(wanted.iter().all(|topic| paths.contains(topic)), "{paths:?}");
}

#[test]
fn what_is_plotted_is_a_number_of_every_increment() {
    let layout = layout();
    let plots: Vec<_> = panels(&layout).into_iter().filter(|(kind, ..)| *kind == "Plot").collect();
    assert_eq!(plots.len(), 3);
    for (_, id, config) in plots {
        // The nth value of one is drawn over the nth of the other.
        assert_eq!(config["xAxisVal"], "custom", "{id}");
        let paths = config["paths"].as_array().unwrap().iter();
        for path in paths.chain([&config["xAxisPath"]]) {
            let path = path["value"].as_str().unwrap();
            assert_eq!(resolve(path), "float64", "{id}: {path}");
            let (name, _) = path.split_once('.').unwrap();
            let each = [&topics::STATE, &topics::WALL_FORCES, &topics::MODULI];
            assert!(each.contains(&topic(name)), "{id}: {path}");
        }
    }
}

#[test]
fn panels_show_topics_of_types_that_they_can_draw() {
    let layout = layout();
    let (mut drawn, mut told) = (0, 0);
    for (kind, id, config) in panels(&layout) {
        let kinds: &[&MessageType] = match kind {
            "3D" => &[PointCloud2::TYPE, MarkerArray::TYPE],
            "DiagnosticSummary" | "DiagnosticStatusPanel" => &[DiagnosticArray::TYPE],
            "RosOut" => &[rcl::Log::TYPE],
            "Plot" | "RawMessages" | "Tab" => continue,
            other => panic!("{other} is no panel of both programs"),
        };
        let names: Vec<&str> = match config.get("topics") {
            Some(shown) => shown.as_object().unwrap().keys().map(String::as_str).collect(),
            None => vec![config["topicToRender"].as_str().unwrap()],
        };
        for name in names {
            assert!(kinds.contains(&topic(name).kind), "{id}: {name}");
            if kind == "3D" { drawn += 1 } else { told += 1 }
        }
    }
    assert_eq!((drawn, told), (2, 3));
}

#[test]
fn frames_are_those_of_the_node() {
    let layout = layout();
    let mut known: Vec<String> = (0..wall::COUNT).map(topics::wall_frame).collect();
    known.extend([topics::WORLD_FRAME, topics::PACK_FRAME, topics::VIEW_FRAME].map(String::from));
    let (_, _, config) = panels(&layout).into_iter().find(|(kind, ..)| *kind == "3D").unwrap();
    assert_eq!(config["followTf"], topics::VIEW_FRAME);
    let shown = config["transforms"].as_object().unwrap();
    assert_eq!(shown.len(), known.len());
    for frame in shown.keys() {
        assert!(known.contains(&frame.strip_prefix("frame:").unwrap().into()), "{frame}");
    }
}
