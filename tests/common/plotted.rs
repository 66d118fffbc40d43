//! A recording of answers, and what `graintwin plot` makes of it.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;

use graintwin::record::Recorder;
use graintwin::scene::Record;
use graintwin::sink::{Served, Sink};
use roxmltree::{Document, Node};

use crate::answers::provenance;

/// Records `answers` into the bag `folder`.
pub(crate) fn write(folder: &Path, answers: &[Arc<Served>]) {
    let mut recorder = Recorder::create(folder, &Record::default(), &provenance()).unwrap();
    for answer in answers {
        recorder.served(answer);
    }
    recorder.finish().unwrap();
}

/// Exit code, stdout and stderr of `graintwin plot`.
pub(crate) fn plot<A: AsRef<std::ffi::OsStr>>(arguments: &[A]) -> (i32, String, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_graintwin")).arg("plot").args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

/// The text of the SVG `name` that `answers` make.
#[allow(dead_code, reason = "some tests look at files only")]
pub(crate) fn drawn(answers: &[Arc<Served>], name: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag");
    write(&bag, answers);
    let (code, _, stderr) = plot(&[&bag]);
    assert_eq!(code, 0, "{stderr}");
    fs::read_to_string(bag.join("plots").join(name).with_extension("svg")).unwrap()
}

/// A chart of an SVG, read as a person reads it: by the numbers at the axes.
#[allow(dead_code, reason = "some tests look at files only")]
pub(crate) struct Read {
    /// All that is written in it.
    pub texts: Vec<String>,
    /// The marked points of each line, in the units of the axes.
    pub lines: Vec<Vec<[f64; 2]>>,
    /// The largest number at the upward axis.
    pub top: f64,
}

/// The chart of the given number in an SVG.
#[allow(dead_code, reason = "some tests look at files only")]
pub(crate) fn read(svg: &str, number: usize) -> Read {
    let document = Document::parse(svg).unwrap();
    let chart = by_class(document.root(), "chart")[number];
    let (across, upward) = (ticks(chart, "middle", "x"), ticks(chart, "end", "y"));
    let place = |dot: &Node| {
        // Labels stand four pixels below the height that they name.
        let (x, y) = (attribute(*dot, "cx"), attribute(*dot, "cy") + 4.0);
        [between(&across, x), between(&upward, y)]
    };
    let line = |group: &Node| {
        group.children().filter(|n| n.has_tag_name("circle")).map(|n| place(&n)).collect()
    };
    let texts = chart.descendants().filter(|node| node.has_tag_name("text"));
    Read {
        texts: texts.filter_map(|node| node.text()).map(str::to_owned).collect(),
        lines: by_class(chart, "series").iter().map(line).collect(),
        top: upward.iter().map(|tick| tick[1]).fold(f64::MIN, f64::max),
    }
}

fn by_class<'a>(node: Node<'a, 'a>, class: &str) -> Vec<Node<'a, 'a>> {
    node.descendants().filter(|node| node.attribute("class") == Some(class)).collect()
}

fn attribute(node: Node, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

/// Place and number of the labels of an axis.
fn ticks(chart: Node, anchor: &str, along: &str) -> Vec<[f64; 2]> {
    let labels = by_class_text(chart).into_iter();
    let labels = labels.filter(|node| node.attribute("text-anchor") == Some(anchor));
    let tick = |node: Node| {
        let number = node.text()?.replace('\u{2212}', "-").parse().ok()?;
        Some([node.attribute(along)?.parse().ok()?, number])
    };
    labels.filter_map(tick).collect()
}

fn by_class_text<'a>(chart: Node<'a, 'a>) -> Vec<Node<'a, 'a>> {
    let labels = by_class(chart, "label").into_iter();
    labels.filter(|node| node.has_tag_name("text")).collect()
}

/// The number at a place of an evenly divided axis.
fn between(ticks: &[[f64; 2]], at: f64) -> f64 {
    let ([from, low], [to, high]) = (ticks[0], ticks[ticks.len() - 1]);
    low + (at - from) / (to - from) * (high - low)
}
