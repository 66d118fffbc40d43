//! `graintwin plot`: what is drawn of a recording, at the boundary of the process.
#![cfg(feature = "mcap")]

#[cfg(feature = "png")]
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use crate::answers::answers;
use crate::plotted::{plot, write};

/// A recording of the initial equilibrium and 14 commands, every fifth of them refused.
fn record(folder: &Path) {
    write(folder, &answers(14, 40));
}

#[test]
fn every_sheet_is_well_formed_and_named_after_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag");
    record(&bag);
    let (code, stdout, stderr) = plot(&[&bag]);
    assert_eq!(code, 0, "{stderr}");
    let files: Vec<&str> = stdout.lines().filter(|file| file.ends_with(".svg")).collect();
    assert_eq!(files.len(), 15, "{stdout}");
    for file in files {
        let text = fs::read_to_string(file).unwrap();
        let svg = roxmltree::Document::parse(&text).unwrap_or_else(|e| panic!("{file}: {e}"));
        assert_eq!(svg.root_element().tag_name().name(), "svg", "{file}");
        assert!(text.contains("Probe 7 µm"), "{file} does not name the scene");
    }
}

#[test]
fn a_curve_has_a_point_for_each_increment() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag");
    record(&bag);
    let (code, _, stderr) = plot(&[&bag]);
    assert_eq!(code, 0, "{stderr}");
    let text = fs::read_to_string(bag.join("plots/wall_forces.svg")).unwrap();
    let svg = roxmltree::Document::parse(&text).unwrap();
    let points: Vec<usize> = svg
        .descendants()
        .filter_map(|node| node.attribute("points"))
        .map(|points| points.split_whitespace().count())
        .filter(|&count| count > 2) // a stroke of the legend has two
        .collect();
    // Increment 0 and the twelve of 14 commands that were served; six walls.
    assert_eq!(points, [13; 6]);
}

#[test]
fn friction_is_drawn_where_contacts_carry_it_and_left_out_elsewhere() {
    let folder = tempfile::tempdir().unwrap();
    let (rough, smooth) = (folder.path().join("rough"), folder.path().join("smooth"));
    record(&rough);
    let mut without = answers(14, 40);
    for answer in &mut without {
        let Some(measures) = &mut Arc::get_mut(answer).unwrap().report.measures else { continue };
        measures.state.as_mut().unwrap().sliding_ratio = 0.0;
        measures.network.as_mut().unwrap().tangential_force.fill(0.0);
    }
    write(&smooth, &without);

    let (_, stdout, _) = plot(&[&rough]);
    assert!(stdout.contains("friction.svg"), "{stdout}");
    let text = fs::read_to_string(rough.join("plots/friction.svg")).unwrap();
    assert!(text.contains("sliding ratio") && text.contains("tangential over normal"), "{text}");
    let (_, stdout, _) = plot(&[&smooth]);
    assert!(!stdout.contains("friction.svg") && stdout.contains("energy.svg"), "{stdout}");
}

#[test]
fn exit_2_where_there_is_no_bag_and_3_for_a_damaged_one() {
    let folder = tempfile::tempdir().unwrap();
    let (code, _, stderr) = plot(&[folder.path()]);
    assert_eq!(code, 2);
    assert!(stderr.contains("holds no .mcap file"), "{stderr}");

    let bag = folder.path().join("bag");
    record(&bag);
    let file = bag.join("bag_0.mcap");
    let bytes = fs::read(&file).unwrap();
    let cut = folder.path().join("cut.mcap");
    fs::write(&cut, &bytes[..bytes.len() - bytes.len() / 4]).unwrap();
    let out = folder.path().join("out");
    let (code, stdout, stderr) = plot(&[&cut, Path::new("--out"), &out]);
    assert_eq!(code, 3, "{stderr}");
    assert!(stdout.contains("overview.svg") && stderr.contains("cut.mcap"), "{stdout}{stderr}");
}

#[test]
fn exit_2_when_the_bag_holds_no_measure_and_1_when_nothing_can_be_written() {
    let folder = tempfile::tempdir().unwrap();
    let (bare, bag) = (folder.path().join("bare"), folder.path().join("bag"));
    let refused: Vec<_> = answers(5, 40).split_off(5);
    assert!(refused[0].report.measures.is_none());
    write(&bare, &refused);
    let (code, stdout, stderr) = plot(&[&bare]);
    assert_eq!((code, stdout.as_str()), (2, ""), "{stderr}");
    assert!(stderr.contains("there is nothing to draw"), "{stderr}");

    record(&bag);
    let taken = folder.path().join("taken");
    fs::write(&taken, "a file").unwrap();
    for out in [taken.clone(), taken.join("below")] {
        let (code, _, stderr) = plot(&[&bag, Path::new("--out"), &out]);
        assert_eq!(code, 1, "{stderr}");
        assert!(stderr.contains(out.to_str().unwrap()), "{stderr}");
        assert!(stderr.contains("--out names another folder"), "{stderr}");
    }
    assert_eq!(fs::read(&taken).unwrap(), b"a file");
}

#[cfg(feature = "png")]
#[test]
fn each_chart_is_there_as_svg_and_png_unless_one_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let bag = folder.path().join("bag");
    record(&bag);
    let of = |out: &Path, format: &[&str]| {
        let mut arguments = vec![bag.to_str().unwrap(), "--out", out.to_str().unwrap()];
        arguments.extend(format);
        let (code, stdout, stderr) = plot(&arguments);
        assert_eq!(code, 0, "{stderr}");
        let printed: BTreeSet<String> = stdout.lines().map(str::to_owned).collect();
        let found = fs::read_dir(out).unwrap().map(|file| file.unwrap().path());
        let found: BTreeSet<String> = found.map(|file| file.to_str().unwrap().into()).collect();
        assert_eq!(printed, found);
        found
    };
    let [both, svg, png, again] =
        ["both", "svg", "png", "again"].map(|name| folder.path().join(name));
    let files = of(&both, &[]);
    let count = |ending: &str| files.iter().filter(|file| file.ends_with(ending)).count();
    assert_eq!((count(".svg"), count(".png"), files.len()), (15, 15, 30));
    assert!(of(&svg, &["--format", "svg"]).iter().all(|file| file.ends_with(".svg")));
    let alone = of(&png, &["--format", "png"]);
    assert_eq!(alone.len(), 15);
    of(&again, &[]);
    for file in files {
        let name = Path::new(&file).file_name().unwrap();
        let bytes = fs::read(&file).unwrap();
        assert_eq!(bytes, fs::read(again.join(name)).unwrap(), "{file} differs when drawn again");
        if file.ends_with(".png") {
            assert_eq!(bytes, fs::read(png.join(name)).unwrap());
        }
    }
}
