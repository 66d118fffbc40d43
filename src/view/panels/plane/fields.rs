//! Pictures of the grains: what they carry, how they moved and turned, where bonds broke
//! (B figures 26, 39, 42 and 49).

use std::f64::consts::TAU;

use crate::msg::ContactNetwork;
use crate::pack::wall_of;
use crate::report::ContactState;
use crate::view::chart::{Chart, Pattern, Series, Stroke};
use crate::view::run::Run;
use crate::view::run::cement::Broken;
use crate::view::run::plane::{Disc, Picture};
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// Corners of a disc, and of a circular wall.
const CORNERS: u32 = 20;
const ROUND: u32 = 180;

/// The wall of an annulus that is around it.
const OUTER: u8 = 1;

/// Colours of the cracks from the first to the last.
const AGES: [&str; 4] = [VERMILLION, "#e69f00", "#56b4e9", BLUE];

/// Outline of the grains.
const OUTLINE: Stroke = Stroke { color: "#c3cad1", width: 0.6, pattern: Pattern::Bare };

const BLACK: &str = "#000000";
const GREY: &str = "#8c959f";
const BLUE: &str = "#0072b2";
const VERMILLION: &str = "#d55e00";

/// Widths of force lines \[pixels\], and the least force of each over the mean.
const WIDTHS: [(f64, f64); 5] = [(0.5, 0.0), (1.2, 0.5), (2.2, 1.0), (3.6, 2.0), (5.4, 3.5)];

/// A displacement of this rank among all is as long as [`LENGTH`] mean diameters.
const RANK: f64 = 0.95;
const LENGTH: f64 = 1.5;

/// A break in a line.
const GAP: [f64; 2] = [f64::NAN; 2];

/// The pictures of the last state, those of motion since the first.
pub(in crate::view::panels) fn charts(run: &Run) -> Vec<Chart> {
    let (Some([first, last]), Some(state)) = (&run.plane.pictures, run.plane.states.first()) else {
        return Vec::new();
    };
    let count = last.grains.len();
    let mean = last.grains.iter().map(|disc| disc.radius).sum::<f64>() / count.max(1) as f64;
    if count == 0 || first.grains.len() != count || mean <= 0.0 {
        return Vec::new();
    }
    // Pictures are larger than the pack.
    let scale = 0.5 * state.mean_diameter / mean;
    let [first, last] = [first, last].map(|picture| scaled(picture, scale));
    let diameter = state.mean_diameter;
    let mut charts = vec![forces(&last)];
    if first.network.increment != last.network.increment {
        charts.push(displacements(&first, &last, diameter));
        charts.push(rotations(&first, &last));
    }
    charts.push(cracks(&last));
    charts.push(order(run, &last, diameter));
    let circles = circles(run, &last);
    for chart in charts.iter_mut().filter(|chart| !chart.series.is_empty()) {
        chart.series.extend(circles.clone());
    }
    charts
}

/// The walls of a pack between circles: the edges of its rings, about where the outer wall pushes to.
fn circles(run: &Run, picture: &Picture) -> Option<Series> {
    let network = &picture.network;
    let state = run.plane.states.iter().find(|state| state.increment == network.increment)?;
    let [.., before, last] = state.ring_radius[..] else { return None };
    let half = 0.5 * (last - before);
    let radii = [state.ring_radius[0] - half, last + half];
    let pushed = (0..network.first.len()).filter(|&k| wall_of(network.second[k]) == Some(OUTER));
    let pushed_to = pushed.filter_map(|contact| {
        let [_, at] = branch(&picture.grains, network, contact)?;
        let normal = network.normal.get(3 * contact..3 * contact + 2)?;
        Some([0, 1].map(|axis| at[axis] + radii[1] * normal[axis]))
    });
    let (count, sum) = pushed_to
        .fold((0_u32, [0.0; 2]), |(count, sum), at| (count + 1, [sum[0] + at[0], sum[1] + at[1]]));
    let centre = (count > 0).then(|| sum.map(|x| x / f64::from(count)))?;
    let circle = |radius: f64| {
        let corner = move |k: u32| {
            let (sine, cosine) = (TAU * f64::from(k) / f64::from(ROUND)).sin_cos();
            [centre[0] + radius * cosine, centre[1] + radius * sine]
        };
        (0..=ROUND).map(corner).chain([GAP])
    };
    Some(lines("", BLACK, 1.6, radii.into_iter().flat_map(circle).collect()))
}

fn scaled(picture: &Picture, scale: f64) -> Picture {
    let disc = |disc: &Disc| Disc {
        at: disc.at.map(|x| x * scale),
        radius: disc.radius * scale,
        turn: disc.turn,
    };
    Picture { network: picture.network.clone(), grains: picture.grains.iter().map(disc).collect() }
}

fn chart(title: String, series: Vec<Series>, notes: Vec<String>) -> Chart {
    let [x, y] = ["x", "y"].map(|axis| Axis::plane(axis, Unit::Si("m")));
    Chart { title, x, y, series, notes }
}

fn lines(name: &str, color: &'static str, width: f64, points: Vec<[f64; 2]>) -> Series {
    let stroke = Stroke { color, width, pattern: Pattern::Bare };
    Series { name: name.into(), points, spread: Vec::new(), stroke }
}

fn outlines(grains: &[Disc]) -> Series {
    let circle = |disc: &Disc| {
        let Disc { at: [x, y], radius, .. } = *disc;
        let corner = move |k: u32| {
            let (sine, cosine) = (TAU * f64::from(k) / f64::from(CORNERS)).sin_cos();
            [x + radius * cosine, y + radius * sine]
        };
        (0..=CORNERS).map(corner).chain([GAP])
    };
    let points = grains.iter().flat_map(circle).collect();
    Series { name: String::new(), points, spread: Vec::new(), stroke: OUTLINE }
}

/// Both ends of the branch of a contact, from centre to centre or wall.
fn branch(grains: &[Disc], network: &ContactNetwork, contact: usize) -> Option<[[f64; 2]; 2]> {
    let first = grains.get(network.first[contact] as usize)?;
    let second = match wall_of(network.second[contact]) {
        Some(_) => {
            let reach = first.radius - network.overlap[contact];
            let normal = network.normal.get(3 * contact..3 * contact + 2)?;
            [first.at[0] - reach * normal[0], first.at[1] - reach * normal[1]]
        }
        None => grains.get(network.second[contact] as usize)?.at,
    };
    Some([first.at, second])
}

/// Black compressive and grey tensile lines, wider with the force (figure 49).
fn forces(picture: &Picture) -> Chart {
    let network = &picture.network;
    let forces = &network.normal_force;
    let carrying = forces.iter().filter(|force| **force != 0.0).count();
    let mean = forces.iter().map(|force| force.abs()).sum::<f64>() / carrying.max(1) as f64;
    let mut bins: [[Vec<[f64; 2]>; WIDTHS.len()]; 2] = Default::default();
    for (contact, force) in forces.iter().enumerate().filter(|(_, force)| **force != 0.0) {
        let width = WIDTHS.iter().rposition(|(_, least)| force.abs() >= least * mean);
        let Some(ends) = branch(&picture.grains, network, contact) else { continue };
        bins[usize::from(*force < 0.0)][width.unwrap_or(0)].extend([ends[0], ends[1], GAP]);
    }
    let mut series = vec![outlines(&picture.grains)];
    for (bins, (name, color)) in bins.into_iter().zip([("pressed", BLACK), ("pulled", GREY)]) {
        let mut name = Some(name).filter(|_| bins.iter().any(|bin| !bin.is_empty()));
        for (points, (width, _)) in bins.into_iter().zip(WIDTHS).filter(|(bin, _)| !bin.is_empty())
        {
            series.push(lines(name.take().unwrap_or(""), color, width, points));
        }
    }
    let note = format!(
        "Mean normal force {}; lines are wider with the force.",
        Unit::Si("N").written(mean)
    );
    chart(format!("Contact forces, increment {}", network.increment), series, vec![note])
}

/// Ways of the grains between two states, less their mean (figure 26).
fn displacements(first: &Picture, last: &Picture, diameter: f64) -> Chart {
    let pairs = || first.grains.iter().zip(&last.grains);
    let ways: Vec<[f64; 2]> =
        pairs().map(|(from, to)| [to.at[0] - from.at[0], to.at[1] - from.at[1]]).collect();
    let count = ways.len() as f64;
    let mean = [0, 1].map(|axis| ways.iter().map(|way| way[axis]).sum::<f64>() / count);
    let ways: Vec<[f64; 2]> = ways.iter().map(|way| [way[0] - mean[0], way[1] - mean[1]]).collect();
    let typical = ranked(ways.iter().map(|way| way[0].hypot(way[1])));
    let grown = if typical > 0.0 { LENGTH * diameter / typical } else { 0.0 };
    let arrow = |(way, disc): (&[f64; 2], &Disc)| {
        let way = way.map(|part| part * grown);
        let [x, y] = disc.at;
        let tip = [x + way[0], y + way[1]];
        let barb = |side: f64| {
            [
                tip[0] - 0.25 * way[0] - side * 0.12 * way[1],
                tip[1] - 0.25 * way[1] + side * 0.12 * way[0],
            ]
        };
        [disc.at, tip, barb(1.0), tip, barb(-1.0), GAP]
    };
    let arrows = ways.iter().zip(&last.grains).flat_map(arrow).collect();
    let increments = [first, last].map(|picture| picture.network.increment);
    chart(
        format!("Displacements, increments {} to {}", increments[0], increments[1]),
        vec![outlines(&last.grains), lines("", BLACK, 0.9, arrows)],
        vec![format!("Less their mean; drawn {grown:.3} : 1.")],
    )
}

/// Turns of the grains: a pointer that stood upright turned with them (figure 42).
fn rotations(first: &Picture, last: &Picture) -> Chart {
    let turns: Vec<f64> =
        first.grains.iter().zip(&last.grains).map(|(from, to)| to.turn - from.turn).collect();
    let known = turns.iter().filter(|turn| turn.is_finite());
    let typical = ranked(known.map(|turn| turn.abs()));
    let grown = if typical > 0.0 { TAU / 4.0 / typical } else { 0.0 };
    let mut pointers: [Vec<[f64; 2]>; 2] = Default::default();
    for (turn, disc) in turns.iter().zip(&last.grains).filter(|(turn, _)| turn.is_finite()) {
        let (sine, cosine) = (turn * grown).clamp(-TAU / 2.0, TAU / 2.0).sin_cos();
        let [x, y] = disc.at;
        let tip = [x - disc.radius * sine, y + disc.radius * cosine];
        pointers[usize::from(*turn < 0.0)].extend([disc.at, tip, GAP]);
    }
    let [left, right] = pointers;
    let increments = [first, last].map(|picture| picture.network.increment);
    let series = match typical > 0.0 {
        true => vec![
            outlines(&last.grains),
            lines("turned to the left", BLUE, 1.3, left),
            lines("to the right", VERMILLION, 1.3, right),
        ],
        false => Vec::new(),
    };
    chart(
        format!("Rotations, increments {} to {}", increments[0], increments[1]),
        series,
        vec![format!("Pointers that stood upright, turned {grown:.1} times as far.")],
    )
}

/// Broken bonds as thick lines across the contact (figure 39); none where nothing broke.
fn cracks(picture: &Picture) -> Chart {
    let network = &picture.network;
    let broken = network.state.iter().enumerate();
    let broken = broken.filter(|(_, state)| **state == ContactState::Broken as u8);
    let across = |(contact, _): (usize, &u8)| {
        let [from, to] = branch(&picture.grains, network, contact)?;
        let half = [0, 1].map(|axis| 0.5 * (to[axis] - from[axis]));
        let [x, y] = [from[0] + half[0], from[1] + half[1]];
        Some([[x - half[1], y + half[0]], [x + half[1], y - half[0]], GAP])
    };
    let cracks: Vec<[f64; 2]> = broken.filter_map(across).flatten().collect();
    let series = match cracks.is_empty() {
        true => Vec::new(),
        false => vec![outlines(&picture.grains), lines("", BLACK, 3.0, cracks)],
    };
    let note = "Lines across the contacts whose bond broke.".into();
    chart(format!("Cracks, increment {}", network.increment), series, vec![note])
}

/// The cracks of the run in the order in which bonds broke, a quarter of them in each colour, where they were
/// then (figure 50).
fn order(run: &Run, last: &Picture, diameter: f64) -> Chart {
    let all = &run.cement.order;
    let until = last.network.increment;
    let all = &all[..all.partition_point(|crack| crack.increment <= until)];
    let mut series = vec![outlines(&last.grains)];
    let size = all.len().div_ceil(AGES.len()).max(1);
    for ((part, color), number) in all.chunks(size).zip(AGES).zip(0..) {
        let half = 0.5 * diameter;
        let across = |crack: &Broken| {
            let ([x, y, _], [nx, ny, _]) = (crack.at, crack.normal);
            [[x - half * ny, y + half * nx], [x + half * ny, y - half * nx], GAP]
        };
        let from = number * size + 1;
        let name = format!("{from} to {}", from + part.len() - 1);
        series.push(lines(&name, color, 3.0, part.iter().flat_map(across).collect()));
    }
    if all.is_empty() {
        series.clear();
    }
    let note = "Lines across the contacts whose bond broke, where they were then.".into();
    chart(format!("Cracks in order, until increment {until}"), series, vec![note])
}

/// The value at [`RANK`] among all; 0 of none.
fn ranked(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    let place = (RANK * values.len() as f64) as usize;
    values.get(place.min(values.len().saturating_sub(1))).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::msg::PlaneState;

    /// Two grains that pull at each other with a broken bond to a third, drawn ten times as large.
    fn run() -> Run {
        let disc = |x: f64, y: f64, turn: f64| Disc { at: [x, y], radius: 5.0, turn };
        let picture = |increment: u64, way: f64, turn: f64| Picture {
            network: ContactNetwork {
                increment,
                first: vec![0, 0],
                second: vec![1, 2],
                normal: vec![-1.0, 0.0, 0.0, 0.0, -1.0, 0.0],
                normal_force: vec![-2.0, 0.0],
                tangential_force: vec![0.0; 6],
                overlap: vec![0.0; 2],
                state: vec![ContactState::Bonded as u8, ContactState::Broken as u8],
                ..ContactNetwork::default()
            },
            grains: vec![disc(0.0, 0.0, turn), disc(10.0, way, 0.0), disc(0.0, 10.0, 0.0)],
        };
        let mut run = Run::default();
        run.plane.states = vec![PlaneState { mean_diameter: 1.0, ..PlaneState::default() }];
        run.plane.pictures = Some([picture(0, 0.0, 0.0), picture(3, 0.0, -0.5)]);
        run
    }

    #[test]
    fn cracks_are_drawn_in_order_and_circles_where_the_rings_end() {
        let mut run = run();
        let crack = |increment| Broken { increment, at: [0.5, 0.0, 0.0], normal: [1.0, 0.0, 0.0] };
        // The last one broke after the picture.
        run.cement.order = (1..=5).map(crack).collect();
        let rings = vec![3.5, 4.5];
        run.plane.states.push(PlaneState {
            increment: 3,
            ring_radius: rings,
            ..PlaneState::default()
        });
        // The second grain, of radius 0.5 at x = 1, touches the outer wall at x = 1.5, which is a circle of
        // 5 about x = -3.5.
        if let Some([_, last]) = &mut run.plane.pictures {
            let network = &mut last.network;
            (network.first[1], network.second[1]) = (1, u32::MAX - 1);
            network.normal[3..].copy_from_slice(&[-1.0, 0.0, 0.0]);
        }
        let charts = charts(&run);
        let names = ["1 to 1", "2 to 2", "3 to 3"];
        for name in names {
            assert_eq!(series(&charts[4], name)[..2], [[0.5, 0.5], [0.5, -0.5]]);
        }
        assert!(series(&charts[4], "4 to 4").is_empty());
        for chart in &charts {
            let circles = &chart.series[chart.series.len() - 1].points;
            let (inner, outer) = (circles[0], circles[ROUND as usize + 2]);
            assert!((inner[0] + 0.5).abs() < 1e-12 && (outer[0] - 1.5).abs() < 1e-12);
        }
    }

    fn series<'a>(chart: &'a Chart, name: &str) -> &'a [[f64; 2]] {
        let named = |series: &&Series| series.name == name && series.stroke != OUTLINE;
        chart.series.iter().find(named).map_or(&[], |series| &series.points)
    }

    #[test]
    fn tension_is_grey_cracks_lie_across_and_pointers_turn_with_the_grains() {
        let charts = charts(&run());
        assert_eq!(charts.len(), 5);
        assert!(charts[4].series.is_empty());
        assert_eq!(series(&charts[0], "pulled")[..2], [[0.0, 0.0], [1.0, 0.0]]);
        assert!(series(&charts[0], "pressed").is_empty());
        // Only the first grain turned, a quarter to the right as drawn.
        let [from, tip] = [0, 1].map(|at| series(&charts[2], "to the right")[at]);
        assert_eq!(from, [0.0, 0.0]);
        assert!((tip[0] - 0.5).abs() < 1e-12 && tip[1].abs() < 1e-12, "{tip:?}");
        assert_eq!(series(&charts[3], "")[..2], [[-0.5, 0.5], [0.5, 0.5]]);
    }
}
