//! The table of scenes.

use std::time::Instant;

use crate::hard::{self, Hard, Seen, apart, nudged, scaled};

/// Grains of the packs that are made.
const GRAINS: usize = 300;
/// Grains of the pack that yields all the time.
const FEWER: usize = 40;

/// Runs every scene whose name contains `only` and prints the table.
pub(crate) fn run(only: Option<&str>) {
    let mut refusals = Vec::new();
    println!(
        "| scene | friction | increments | applied | sub-steps | worst residual | events | worst ms | the program says |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for friction in [0.0, 0.3] {
        for make in makers() {
            let hard = make(friction);
            if only.is_some_and(|only| !hard.name.contains(only)) {
                continue;
            }
            let (seen, worst) = timed(&hard);
            let said = match seen.bonds {
                [0, 0] => seen.said.clone(),
                [held, broke] if seen.said.is_empty() => {
                    format!("{broke} of {} bonds broke", held + broke)
                }
                [held, broke] => format!("{broke} of {} bonds broke; {}", held + broke, seen.said),
            };
            row(&hard.name, friction, &seen, worst, &said);
            refusals
                .extend(seen.refused.iter().map(|why| format!("{}, {friction}: {why}", hard.name)));
        }
        if only.is_none_or(|only| only == "units") {
            units(friction);
        }
    }
    println!();
    for refusal in refusals {
        println!("refused: {refusal}");
    }
}

type Maker = Box<dyn Fn(f64) -> Hard>;

fn makers() -> Vec<Maker> {
    let mut makers: Vec<Maker> = vec![
        Box::new(|friction| hard::contrast(GRAINS, friction)),
        Box::new(|friction| hard::radii(GRAINS, friction)),
        Box::new(|friction| hard::stiff_walls(GRAINS, friction)),
    ];
    for stress in [2e5, 2e4] {
        for (increment, parts) in [(1e-6, 20), (1e-5, 20), (1e-4, 10), (1e-3, 5)] {
            makers.push(Box::new(move |friction| {
                hard::near_jamming(GRAINS, friction, stress, increment, parts)
            }));
        }
    }
    makers.push(Box::new(|friction| hard::decompression(GRAINS, friction)));
    for (strength, parts) in [(1e8, 100), (1e8, 10), (f64::INFINITY, 10)] {
        makers.push(Box::new(move |friction| hard::cemented(GRAINS, friction, strength, parts)));
    }
    makers.push(Box::new(|friction| hard::large_strain(FEWER, friction, 100)));
    makers.push(Box::new(|friction| hard::cycles(30, friction, 10_000)));
    makers.push(Box::new(|friction| hard::constriction(friction, 60)));
    for count in [1, 2, 5] {
        makers.push(Box::new(move |friction| hard::few(count, friction)));
    }
    for face_centred in [false, true] {
        makers.push(Box::new(move |friction| hard::crystal(face_centred, friction, 10)));
    }
    makers
}

/// The same pack in other units, and nudged by one step of the last digit.
fn units(friction: f64) {
    let base = hard::plain(GRAINS, friction);
    let (here, _) = timed(&base);
    for (length, modulus) in [(1e-6, 1.0), (1e6, 1.0), (1.0, 1e-6), (1.0, 1e6)] {
        let other = scaled(&base, length, modulus);
        let (seen, worst) = timed(&other);
        let off = apart(&here, &seen, 1.0 / (length * length * modulus));
        row(&other.name, friction, &seen, worst, &format!("wall forces apart by {off:.0e}"));
    }
    let (seen, worst) = timed(&nudged(&base));
    let off = apart(&here, &seen, 1.0);
    row(
        "one ulp in every coordinate",
        friction,
        &seen,
        worst,
        &format!("wall forces apart by {off:.0e}"),
    );
}

fn row(name: &str, friction: f64, seen: &Seen, worst: f64, says: &str) {
    println!(
        "| {name} | {friction} | {} | {} | {} | {:.1e} | {} | {worst:.0} | {says} |",
        seen.increments, seen.applied, seen.substeps, seen.worst_residual, seen.events,
    );
}

/// Drives a scene; the longest increment \[ms\].
fn timed(hard: &Hard) -> (Seen, f64) {
    let mut last = Instant::now();
    let mut worst = 0.0_f64;
    let mut started = false;
    let seen = hard.drive(|| {
        let now = Instant::now();
        // The first one has the start in it.
        if std::mem::replace(&mut started, true) {
            worst = worst.max((now - last).as_secs_f64() * 1e3);
        }
        last = now;
    });
    (seen, worst)
}
