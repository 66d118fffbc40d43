//! Charts of discs: the biaxial test, directions, Mohr circles, what is told of the interior.

pub(super) mod fields;
mod stiffness;

use std::f64::consts::TAU;

use super::strain::Strain;
use crate::analytic::cylinder::{Cylinder, Hoop, Ring, Rings};
use crate::analytic::fit::biaxial::Test;
use crate::analytic::tensor::Tensor;
use crate::msg::{PackState, PlaneState};
use crate::view::biaxial::{self, Drawn};
use crate::view::chart::{Chart, Pattern, Series};
use crate::view::mohr::{self, Failures};
use crate::view::rose::{self, ByDirection, Predicted};
use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;
use stiffness::Theory;

/// The lateral stress of a biaxial test stays within this share of what it is at the end.
const STEADY: f64 = 0.05;

/// Stress ratio and area against the strain along y, with the bilinear material fitted to them; from
/// where on the stress along x stays.
pub(super) fn biaxial(run: &Run) -> Vec<Chart> {
    if !run.is_plane() {
        return Vec::new();
    }
    let states = steady(run);
    let series = |value: fn(&PackState) -> f64| -> Vec<f64> { states.iter().map(value).collect() };
    let minor = series(|state| state.stress_walls[0]);
    let axial_strain = series(|state| state.strain[1]);
    let strained =
        axial_strain.iter().any(|strain| strain - axial_strain[0] > super::strain::LEAST);
    if !strained {
        return vec![stiffness::chart(run, None)];
    }
    let area_strain =
        series(|state| state.strain[0] + state.strain[1] - state.strain[0] * state.strain[1]);
    let major = series(|state| state.stress_walls[4]);
    let test = Test {
        axial_strain: &axial_strain,
        area_strain: &area_strain,
        major: &major,
        minor: &minor,
    };
    let material = test.material();
    let mut charts = biaxial::charts(&[Drawn { name: "simulated", test, material }]).to_vec();
    match material {
        Some(material) => {
            let [friction, dilatancy] =
                [material.strength.friction, material.dilatancy].map(f64::to_degrees);
            let (young, poisson) = (material.elastic.young, material.elastic.poisson);
            charts[0].notes.push(format!(
                "Fitted: E50 = {}, ν = {poisson:.2}, φ' = {friction:.1}°, ψ = {dilatancy:.1}°.",
                Unit::Si("Pa").written(young)
            ));
        }
        None => charts.iter_mut().for_each(|chart| chart.notes.clear()),
    }
    // E50 at the mean stress of B's (24), 1.5 σ3.
    if let Some(predicted) = Theory::at_start(run, 1.5 * minor[minor.len() - 1]) {
        charts[0].notes.push(told(&predicted));
    }
    charts.push(stiffness::chart(run, Some(&test)));
    charts
}

/// One sentence about what theory says of a test.
fn told(predicted: &Theory) -> String {
    let Theory { averaged, strength, .. } = predicted;
    let young = Unit::Si("Pa").written(averaged.young);
    match strength {
        None => format!("Predicted: E50 = {young} at 1.5 σ3 (24, A.89)."),
        Some(strength) => format!(
            "Predicted: E = {young}, ν = {:.2}, φ' = {:.1}°, c' = {} (A.80-A.95).",
            averaged.poisson,
            strength.friction.to_degrees(),
            Unit::Si("Pa").written(strength.cohesion)
        ),
    }
}

/// The states of discs from which on the stress along x stays what it is at the end.
fn steady(run: &Run) -> &[PackState] {
    let lateral = |state: &PackState| state.stress_walls[0];
    let end = run.states.last().map_or(f64::NAN, lateral);
    let stays = |state: &PackState| (lateral(state) - end).abs() <= STEADY * end;
    let count = run.states.iter().rev().take_while(|state| stays(state)).count();
    &run.states[run.states.len() - count..]
}

/// ν of the cylinder of uneven modulus, which hardly depends on it (32).
const POISSON: f64 = 0.1;

fn line(
    number: usize,
    name: &str,
    run: &Run,
    strain: &Strain,
    value: impl Fn(&PlaneState) -> f64,
) -> Series {
    let point = |state: &PlaneState| [strain.at(state.increment), value(state)];
    Series::new(number, name, run.plane.states.iter().map(point))
}

/// Contacts of the grains in the interior, and n_c/v.
pub(super) fn contacts(run: &Run, strain: &Strain) -> Chart {
    Chart {
        title: format!("Contacts against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("contacts", Unit::None),
        series: vec![
            line(0, "per grain, n_c/g", run, strain, |state| state.contacts_per_grain),
            line(1, "per volume, n_c/v", run, strain, |state| state.contact_density),
        ],
        notes: vec!["Further from the walls than the largest diameter.".into()],
    }
}

/// Principal stresses in the interior.
pub(super) fn principal(run: &Run, strain: &Strain) -> Chart {
    Chart {
        title: format!("Principal stresses against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("stress in the interior", Unit::Si("Pa")),
        series: vec![
            line(0, "σ1", run, strain, |state| state.principal_stress[0]),
            line(1, "σ3", run, strain, |state| state.principal_stress[1]),
        ],
        notes: Vec::new(),
    }
}

/// Directions of the major principal stress and of the strain of the increment (A.11, A.12).
pub(super) fn directions(run: &Run, strain: &Strain) -> Chart {
    let of_strain = |state: &PlaneState| {
        let [xx, yy, xy] = state.network_strain;
        Tensor { xx, yy, xy }.direction().map_or(f64::NAN, |angle| upward(angle.to_degrees()))
    };
    let of_stress = |state: &PlaneState| upward(state.principal_direction.to_degrees());
    Chart {
        title: format!("Principal directions against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("angle to the x-axis [°]", Unit::None),
        series: vec![
            line(0, "major stress", run, strain, of_stress),
            line(1, "major strain of the increment", run, strain, of_strain),
        ],
        notes: vec!["Stress in the interior; strain of the network of contacts (A.51).".into()],
    }
}

/// Directions have no sense: from 0 to 180 degrees nothing jumps about the vertical.
fn upward(degrees: f64) -> f64 {
    degrees.rem_euclid(180.0)
}

/// Mean rotation of the grains and shear of the box since the start (30).
pub(super) fn rotation(run: &Run, strain: &Strain) -> Chart {
    let start = run.plane.states.first().map_or(0.0, |state| state.mean_rotation);
    let leant = run.plane.states.iter().any(|state| state.tilt != 0.0);
    let mut series =
        vec![line(0, "γ_μ, to the right", run, strain, |state| start - state.mean_rotation)];
    if leant {
        series.push(line(1, "γ of the box", run, strain, |state| state.tilt));
        series.push(line(2, "half of it", run, strain, |state| 0.5 * state.tilt));
        series[2].stroke.pattern = Pattern::Dashed;
    }
    Chart {
        title: format!("Mean rotation against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("rotation [rad]", Unit::None),
        series,
        notes: Vec::new(),
    }
}

/// Mohr circles of the first and the last state of the interior.
pub(super) fn mohr(run: &Run) -> Chart {
    let ends = ends(run);
    let circles: Vec<(String, [[f64; 2]; 1])> = (ends.iter())
        .map(|state| {
            let [major, minor] = state.principal_stress;
            (format!("increment {}", state.increment), [[minor, major]])
        })
        .collect();
    let strength = Theory::at_start(run, 1.0).and_then(|predicted| predicted.strength);
    let last = circles.len().saturating_sub(1);
    let materials: Vec<Failures> = (circles.iter().enumerate())
        .map(|(place, (name, states))| Failures {
            name,
            states,
            strength: strength.filter(|_| place == last),
        })
        .collect();
    let notes = strength.map(|_| "Dashed: strength of the bonds (A.90-A.95).".into());
    Chart {
        title: "Mohr circles of the interior".into(),
        notes: notes.into_iter().collect(),
        ..mohr::chart(&materials)
    }
}

/// The roses of the first and of the last state, side by side.
pub(super) fn roses(run: &Run) -> Vec<Chart> {
    let of = |state: &&PlaneState| {
        rose_of(state).map(|chart| Chart {
            title: format!("{}, increment {}", chart.title, state.increment),
            ..chart
        })
    };
    let ends: Vec<[Chart; 3]> = ends(run).iter().map(of).collect();
    (0..3).flat_map(|which| ends.iter().map(move |charts| charts[which].clone())).collect()
}

fn rose_of(state: &PlaneState) -> [Chart; 3] {
    let bins = state.polar_contacts.len().max(1) as f64;
    let angle: Vec<f64> =
        (0..state.polar_contacts.len()).map(|bin| TAU * (bin as f64 + 0.5) / bins).collect();
    let count: Vec<f64> = state.polar_contacts.iter().map(|&count| f64::from(count)).collect();
    let mean = |sums: &[f64]| -> Vec<f64> {
        sums.iter().zip(&count).map(|(sum, count)| sum / count).collect()
    };
    let (normal, shear) = (mean(&state.polar_normal), mean(&state.polar_shear));
    let measured = ByDirection { angle: &angle, count: &count, normal: &normal, shear: &shear };
    let [xx, yy, xy] = state.stress;
    let predicted = Predicted {
        stress: Tensor { xx, yy, xy },
        diameter: state.mean_diameter,
        contact_density: state.contact_density,
    };
    rose::charts(&measured, Some(&predicted))
}

/// Radial profiles of the first and of the last state, of a pack between circles.
pub(super) fn profiles(run: &Run) -> Vec<Chart> {
    let ends = ends(run);
    let stress: Vec<Series> = (ends.iter().zip(0..))
        .flat_map(|(state, number)| {
            let name = |of: &str| format!("{of}, increment {}", state.increment);
            let against = |values: &[f64]| along(&state.ring_radius, values);
            [
                Series::new(2 * number, &name("σrr"), against(&state.ring_radial_stress)),
                Series::new(2 * number + 1, &name("σtt"), against(&state.ring_hoop_stress)),
            ]
        })
        .collect();
    let density = (ends.iter().zip(0..)).map(|(state, number)| {
        let name = format!("increment {}", state.increment);
        Series::new(number, &name, along(&state.ring_radius, &state.ring_contact_density))
    });
    let chart = |title: &str, y: Axis, series: Vec<Series>| Chart {
        title: title.into(),
        x: Axis::linear("distance from the centre", Unit::Si("m")),
        y,
        series,
        notes: Vec::new(),
    };
    let mut stress = stress;
    if let Some(last) = ends.last() {
        stress.extend(predicted(run, last));
    }
    vec![
        chart("Stress against radius", Axis::linear("stress", Unit::Si("Pa")), stress),
        chart("Contacts against radius", Axis::linear("n_c/v", Unit::None), density.collect()),
    ]
}

/// What an elastic cylinder has at the pressures of `state`: with the same modulus everywhere (A.113), and
/// with one in proportion to n_c/v (figure 46).
fn predicted(run: &Run, state: &PlaneState) -> Vec<Series> {
    let radius = &state.ring_radius;
    let [first, second, ..] = radius[..] else { return Vec::new() };
    let Some(walls) = run.walls.iter().find(|walls| walls.increment == state.increment) else {
        return Vec::new();
    };
    let half = 0.5 * (second - first);
    let [inner, outer] = [first - half, radius[radius.len() - 1] + half];
    let [inner_pressure, outer_pressure] = [(0, inner), (1, outer)]
        .map(|(wall, radius)| walls.normal_force[wall] / (TAU * radius * state.mean_diameter));
    let cylinder = Cylinder { inner, outer, inner_pressure, outer_pressure };
    let count = radius.len();
    let rings: Vec<Ring> = (0..count)
        .map(|k| {
            let outer = if k + 1 == count { outer } else { radius[k] + half };
            Ring { outer, young: state.ring_contact_density[k] }
        })
        .collect();
    let mut series = dashed("A.113", 4, radius, |r| Some(cylinder.stress(r))).to_vec();
    if let Some(uneven) = Rings::new(&cylinder, POISSON, rings) {
        series.extend(dashed("E ~ n_c/v", 6, radius, |r| uneven.stress(r)));
    }
    series
}

fn dashed(
    name: &str,
    number: usize,
    radius: &[f64],
    of: impl Fn(f64) -> Option<Hoop>,
) -> [Series; 2] {
    let line = |number: usize, part: &str, value: fn(Hoop) -> f64| {
        let points = radius.iter().map(|&r| [r, of(r).map_or(f64::NAN, value)]);
        let mut series = Series::new(number, &format!("{part}, {name}"), points);
        series.stroke.pattern = Pattern::Dashed;
        series
    };
    [line(number, "σrr", |hoop| hoop.radial), line(number + 1, "σtt", |hoop| hoop.tangential)]
}

fn along(radius: &[f64], values: &[f64]) -> Vec<[f64; 2]> {
    radius.iter().zip(values).map(|(&radius, &value)| [radius, value]).collect()
}

/// The first and the last state.
fn ends(run: &Run) -> Vec<&PlaneState> {
    let states = &run.plane.states;
    let last = states.last().filter(|_| states.len() > 1);
    states.first().into_iter().chain(last).collect()
}
