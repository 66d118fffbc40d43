//! What the runs came to, in numbers.

use std::collections::BTreeSet;

use super::{Course, Point, Seed};

pub(super) fn print(seeds: &[Seed]) {
    println!("Isotropic loading of 306 grains:\n");
    println!(
        "| seed | increments | sub-steps | events | mean stress at the end [MPa] | largest drop in an event | energy released [µJ] | dissipated [µJ] | increments in which the stress fell, without an event |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for seed in seeds {
        println!("| {} | {} |", seed.seed, counts(&seed.loading));
    }
    println!("\nFour configurations around the event that took one grain furthest:\n");
    println!(
        "| seed | from, to | mean stress [MPa] | furthest grain [mean radii] | contacts lost | contacts made | largest tenth of the forces in common |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for seed in seeds {
        let course = &seed.loading;
        let at = course.furthest();
        for (pair, k) in course.points[at - 2..=at + 1].windows(2).zip(1..) {
            println!("| {} | {k}, {} | {} |", seed.seed, k + 1, apart(course, &pair[0], &pair[1]));
        }
    }
    println!("\nPolyaxial cycle of 2740 grains:\n");
    println!(
        "| seed | events up | events down | area of the loop [µJ] | change of the stored energy [µJ] | dissipated [µJ] | released in events [µJ] | difference | work up [µJ] |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for seed in seeds {
        println!("| {} | {} |", seed.seed, cycle(&seed.cycle));
    }
    println!();
}

fn counts(course: &Course) -> String {
    let points = &course.points;
    let last = points[points.len() - 1].state();
    let events = || points.iter().flat_map(|point| &point.measures.events);
    let drop = events().map(|event| 1.0 - event.stress_after / event.stress_before);
    let fell = points.windows(2).filter(|pair| {
        let [before, after] = [&pair[0], &pair[1]].map(|point| point.state().confining_stress);
        after < before && pair[1].measures.events.is_empty()
    });
    format!(
        "{} | {} | {} | {:.2} | {:.2} % | {:.4} | {:.4} | {}",
        points.len() - 1,
        points.iter().map(|point| point.substeps).sum::<u32>(),
        events().count(),
        last.confining_stress / 1e6,
        100.0 * drop.fold(0.0, f64::max),
        1e6 * last.event_energy,
        1e6 * last.dissipated_energy,
        fell.count(),
    )
}

/// How two configurations differ.
fn apart(course: &Course, before: &Point, after: &Point) -> String {
    let mean = course.radius.iter().sum::<f64>() / course.radius.len() as f64;
    let ways =
        before.positions().iter().zip(after.positions()).map(|(from, to)| {
            from.iter().zip(to).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        });
    let [was, is] = [before, after].map(|point| contacts(point, 0.0));
    let [strong, stronger] = [before, after].map(|point| contacts(point, 0.9));
    let common = strong.intersection(&stronger).count() as f64;
    format!(
        "{:.3}, {:.3} | {:.3} | {} | {} | {:.0} %",
        before.state().confining_stress / 1e6,
        after.state().confining_stress / 1e6,
        ways.fold(0.0, f64::max) / mean,
        was.difference(&is).count(),
        is.difference(&was).count(),
        100.0 * common / strong.len() as f64,
    )
}

/// The pairs in contact whose force is above the quantile `share` of all.
fn contacts(point: &Point, share: f64) -> BTreeSet<(u32, u32)> {
    let network = point.measures.network.as_ref().expect("it was demanded");
    let mut forces = network.normal_force.clone();
    forces.sort_by(f64::total_cmp);
    let least = forces[(share * forces.len() as f64) as usize];
    (network.first.iter().zip(&network.second).zip(&network.normal_force))
        .filter(|(_, force)| **force >= least)
        .map(|((first, second), _)| (*first, *second))
        .collect()
}

fn cycle(course: &Course) -> String {
    let points = &course.points;
    let turn = points.len() / 2;
    let events = |part: &[Point]| part.iter().map(|at| at.measures.events.len()).sum::<usize>();
    let work = course.work();
    let [start, end] = [&points[0], &points[points.len() - 1]].map(Point::state);
    let area = work[work.len() - 1];
    format!(
        "{} | {} | {:.3} | {:.3} | {:.3} | {:.3} | {:.1} % | {:.0}",
        events(&points[..=turn]),
        events(&points[turn + 1..]),
        1e6 * area,
        1e6 * (end.stored_energy - start.stored_energy),
        1e6 * end.dissipated_energy,
        1e6 * end.event_energy,
        100.0 * (end.event_energy / end.dissipated_energy - 1.0),
        1e6 * work[turn],
    )
}
