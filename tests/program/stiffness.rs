//! The stiffness of discs in `graintwin plot`, beside what theory makes of their grains.
#![cfg(feature = "mcap")]

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::plotted::{Read, plot, read};

/// Runs a scene of discs with these keys, and reads the chart of its stiffness; the summary beside it.
fn drawn(keys: &str) -> (Read, String, Value) {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("discs.yaml");
    fs::write(
        &scene,
        format!(
            "dimension: 2\nmaterials: {{sand: {{young: 2.32e9, poisson: 0.16, density: 2650.0}}}}\n\
             pack: {{generate: {{grains: 150, radius: {{grading_a: {{mean: 0.1e-3, ratio: 4.0}}}}, \
             material: sand, seed: 2, confining_stress: 1.0e6}}}}\nwalls: {{friction: 0.0}}\n{keys}"
        ),
    )
    .unwrap();
    let bag = folder.path().join("bag");
    let run = Command::new(env!("CARGO_BIN_EXE_graintwin"))
        .args(["run".as_ref(), scene.as_os_str(), "--json".as_ref(), "--record".as_ref()])
        .arg(&bag)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let summary = serde_json::from_slice(&run.stdout).unwrap();
    let (code, _, stderr) = plot(&[&bag]);
    assert_eq!(code, 0, "{stderr}");
    let svg = fs::read_to_string(bag.join("plots/biaxial.svg")).unwrap();
    keep(&bag);
    (read(&svg, place(&svg)), svg, summary)
}

/// Leaves the charts where `GRAINTWIN_PLOTS` says, to be looked at.
fn keep(bag: &Path) {
    let Some(to) = std::env::var_os("GRAINTWIN_PLOTS") else { return };
    let file = fs::read_dir(Path::new(&to)).unwrap().count();
    fs::copy(bag.join("plots/biaxial.png"), Path::new(&to).join(format!("{file}.png"))).unwrap();
}

/// Which chart of the sheet it is.
fn place(svg: &str) -> usize {
    let document = roxmltree::Document::parse(svg).unwrap();
    let mut charts = document.descendants().filter(|node| node.attribute("class") == Some("chart"));
    let title = "Stiffness against mean stress";
    charts.position(|chart| chart.descendants().any(|node| node.text() == Some(title))).unwrap()
}

fn has(chart: &Read, text: &str) {
    assert!(chart.texts.iter().any(|one| one.contains(text)), "{text}: {:?}", chart.texts);
}

#[test]
fn moduli_of_states_are_drawn_with_e50_of_sand() {
    let (chart, _, summary) = drawn(
        "contact: {friction: {coefficient: 0.6}}\noutputs: {moduli: both}\n\
         load_path: [isotropic: {stress: 4.0e6, increments: 12}]\n",
    );
    for name in ["E, all stick", "E, as they stand", "K, all stick", "E50 (24, A.89)"] {
        has(&chart, name);
    }
    has(&chart, "predicted from n_c/v");
    // Marked: the state at the start and the twelve that follow, three moduli each.
    let marked: Vec<usize> =
        chart.lines.iter().map(Vec::len).filter(|&count| count == 13).collect();
    assert_eq!(marked, [13; 3], "{:?}", chart.lines);
    let end = &summary["end"]["tangent"]["sticks"];
    let [stress, young] = *chart.lines[0].last().unwrap();
    assert!((stress - 4.0).abs() < 4e-2, "{stress} MPa");
    let want = end["young"].as_f64().unwrap() / 1e6;
    assert!((young / want - 1.0).abs() < 1e-2, "{young} {want}");
    assert!(end["relaxed"][8].is_null() && end["shear_pairs"][1].is_null());
}

#[test]
fn cemented_grains_have_e_and_strength_of_their_bonds() {
    let (chart, sheet, _) = drawn(
        "contact: {friction: {coefficient: 0.6}, normal: {linear: {stiffness: 1.0e6, \
         bond: {cohesion: 100.0e6}}}}\noutputs: {moduli: tangent}\n\
         solver: {max_overlap_share: 100.0}\nload_path:\n  \
         - triaxial: {axis: y, axial_strain: 2.0e-3, lateral_stress: 1.0e6, increments: 15}\n",
    );
    has(&chart, "E (A.80)");
    assert!(sheet.contains("(A.80-A.95)") && sheet.contains("strength of the bonds"), "{sheet}");
}
