//! The charts of a recording.

mod cement;
mod contacts;
mod energy;
mod events;
mod fabric;
mod friction;
mod hydrate;
mod measures;
mod moduli;
mod motion;
mod network;
mod plane;
mod shear;
mod solver;
mod strain;
mod typical;
mod volume;

use super::chart::Chart;
use super::history::History;
use super::run::Run;
use super::sheet::Sheet;

use strain::Strain;

/// Charts on the overview, at most.
const OVERVIEW: usize = 4;

/// The sheets of a recording by the name of their file without its ending, under `title`. Those
/// that would hold no value are not among them.
#[must_use]
pub fn sheets(history: &History, title: &str) -> Vec<(&'static str, Sheet)> {
    let run = &history.run;
    let strain = Strain::of(run);
    let stress = measures::stress(run, &strain);
    let walls = measures::wall_forces(run);
    let volume = volume::change(run, &strain);
    let moduli = moduli::moduli(run, &strain);
    let ratio = moduli::poisson(run, &strain);
    let tangent = moduli::tangent(run, &strain);
    let coordination = measures::coordination(run, &strain);
    let friction = friction::mobilised(run, &strain);
    let forces = contacts::normal(run);
    let motions = vec![
        motion::non_affine(run, &strain),
        motion::localisation(run, &strain),
        motion::band(run, &strain),
        motion::distribution(run),
    ];
    let effort = [solver::iterations(run), solver::residual(run)];

    // The most telling first; the later ones stand in where an earlier one has no value.
    let mut telling = vec![&stress, &walls, &friction, &forces, &coordination, &volume];
    // A path that tells one modulus alone tells little of the stiffness.
    let place = if moduli.shown().count() > 1 { 2 } else { telling.len() };
    telling.insert(place, &moduli);
    let overview: Vec<Chart> =
        telling.into_iter().filter(|chart| !chart.is_empty()).take(OVERVIEW).cloned().collect();
    let sheets = [
        ("overview", overview),
        ("stress_strain", vec![stress]),
        ("stress_path", vec![measures::path(run)]),
        ("volume_change", vec![volume, volume::porosity(run, &strain)]),
        ("wall_forces", vec![walls]),
        ("moduli", vec![moduli, ratio, tangent]),
        ("coordination", vec![coordination]),
        ("friction", vec![friction]),
        ("energy", vec![energy::energy(run, &strain)]),
        ("effort", effort.to_vec()),
        ("forces", vec![forces, contacts::tangential(run)]),
        ("motion", motions),
        ("hydrate", hydrate::charts(run)),
        ("shear", shear::charts(run)),
        (
            "fabric",
            // About the axis z, which discs do not have.
            if run.is_plane() {
                Vec::new()
            } else {
                vec![
                    fabric::anisotropy(run, &strain),
                    fabric::stress_ratio(run, &strain),
                    fabric::axial_share(run, &strain),
                    fabric::by_angle(run),
                ]
            },
        ),
        (
            "network",
            vec![
                network::strongest_paths(run, &strain),
                network::coordination(run),
                network::mobilised(run),
            ],
        ),
    ];
    let sheets = sheets.into_iter().chain([("cement", cement::cracks(run, &strain))]);
    let sheets = sheets.chain(of_discs(run, &strain));
    let subtitle = subtitle(history);
    let sheet = |(name, mut charts): (_, Vec<Chart>)| {
        charts.retain(|chart| !chart.is_empty());
        let sheet = Sheet { title: title.into(), subtitle: subtitle.clone(), charts };
        (!sheet.charts.is_empty()).then_some((name, sheet))
    };
    sheets.filter_map(sheet).collect()
}

/// The sheets of discs; empty ones for spheres.
fn of_discs(run: &Run, strain: &Strain) -> [(&'static str, Vec<Chart>); 5] {
    let mut biaxial = plane::biaxial(run);
    biaxial.push(plane::contacts(run, strain));
    biaxial.push(plane::mohr(run));
    let interior = vec![
        plane::principal(run, strain),
        plane::directions(run, strain),
        plane::rotation(run, strain),
    ];
    [
        ("biaxial", biaxial),
        ("roses", plane::roses(run)),
        ("interior", interior),
        ("profiles", plane::profiles(run)),
        ("grains", plane::fields::charts(run)),
    ]
}

fn subtitle(history: &History) -> String {
    let mut text = match history.run.increments() {
        Some((first, last)) if first < last => format!("Increments {first} to {last}."),
        Some((only, _)) => format!("Increment {only}."),
        None => String::new(),
    };
    text.push_str(" Compression is positive.");
    if history.runs > 1 {
        let (number, runs) = (history.number, history.runs);
        text.push_str(&format!(" Run {number} of {runs}, the longest: each reset begins another."));
    }
    if history.damage.is_some() {
        text.push_str(" The recording is damaged: this is what could be read.");
    }
    text
}
