//! The charts of a recording.

mod contacts;
mod energy;
mod friction;
mod measures;
mod moduli;
mod solver;
mod strain;
mod typical;
mod volume;

use super::chart::Chart;
use super::history::History;
use super::sheet::Sheet;

use strain::Strain;

/// Charts on the overview, at most.
const OVERVIEW: usize = 4;

/// The sheets of a recording by the name of their file without its ending, under `title`. Those
/// that would hold no value are not among them.
#[must_use]
pub fn sheets(history: &History, title: &str) -> Vec<(&'static str, Sheet)> {
    let strain = Strain::of(history);
    let stress = measures::stress(history, &strain);
    let walls = measures::wall_forces(history);
    let volume = volume::change(history, &strain);
    let moduli = moduli::moduli(history, &strain);
    let ratio = moduli::poisson(history, &strain);
    let coordination = measures::coordination(history, &strain);
    let friction = friction::mobilised(history, &strain);
    let forces = contacts::normal(history);
    let effort = [solver::iterations(history), solver::residual(history)];

    // The most telling first; the later ones stand in where an earlier one has no value.
    let telling = [&stress, &walls, &moduli, &friction, &forces, &coordination, &volume];
    let overview: Vec<Chart> =
        telling.into_iter().filter(|chart| !chart.is_empty()).take(OVERVIEW).cloned().collect();
    let sheets = [
        ("overview", overview),
        ("stress_strain", vec![stress]),
        ("stress_path", vec![measures::path(history)]),
        ("volume_change", vec![volume, volume::porosity(history, &strain)]),
        ("wall_forces", vec![walls]),
        ("moduli", vec![moduli, ratio]),
        ("coordination", vec![coordination]),
        ("friction", vec![friction]),
        ("energy", vec![energy::energy(history, &strain)]),
        ("effort", effort.to_vec()),
        ("forces", vec![forces, contacts::tangential(history)]),
    ];
    let subtitle = subtitle(history);
    let sheet = |(name, mut charts): (_, Vec<Chart>)| {
        charts.retain(|chart| !chart.is_empty());
        let sheet = Sheet { title: title.into(), subtitle: subtitle.clone(), charts };
        (!sheet.charts.is_empty()).then_some((name, sheet))
    };
    sheets.into_iter().filter_map(sheet).collect()
}

fn subtitle(history: &History) -> String {
    let mut text = match history.increments() {
        Some((first, last)) if first < last => format!("Increments {first} to {last}."),
        Some((only, _)) => format!("Increment {only}."),
        None => String::new(),
    };
    text.push_str(" Compression is positive.");
    if history.damage.is_some() {
        text.push_str(" The recording is damaged: this is what could be read.");
    }
    text
}
