//! What recording costs: `cargo bench --bench record`.
//!
//! A pack of 2744 grains on a shaken lattice is compressed step by step, and its contacts are
//! recorded under every compression. Shown are the time that the solver's thread spends when the
//! disk keeps up, the time per increment when it does not, and the size per increment.
#![allow(clippy::print_stdout, reason = "a benchmark reports on stdout")]

use std::sync::Arc;
use std::time::{Duration, Instant};

use graintwin::command::{Disposition, Stamp};
use graintwin::record::{Provenance, Recorder};
use graintwin::report::{ContactNetwork, Measures, Moduli, PackState, Report, WallForces};
use graintwin::scene::{Compression, Record};
use graintwin::sink::{Served, Sink};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;

const SIDE: usize = 14;
const INCREMENTS: u32 = 84;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let answers: Vec<_> = networks().into_iter().zip(0..).map(answer).collect();
    let contacts = answers[0].report.measures.as_ref().and_then(|one| one.network.as_ref());
    println!("{} contacts, {INCREMENTS} increments", contacts.map_or(0, |one| one.first.len()));
    println!("compression  hand over: median, max  saturated     size");
    for compression in [Compression::Zstd, Compression::Lz4, Compression::None] {
        let settings = Record { compression, ..Record::default() };
        let (mut times, bytes) = record(&settings, &answers, Duration::from_millis(60))?;
        times.sort();
        let start = Instant::now();
        record(&settings, &answers, Duration::ZERO)?;
        println!(
            "{:11}  {:>12.1?} {:>10.1?}  {:>9.1?}  {:>7.0} B",
            format!("{compression:?}"),
            times[times.len() / 2],
            times[times.len() - 1],
            start.elapsed() / INCREMENTS,
            bytes as f64 / f64::from(INCREMENTS),
        );
    }
    Ok(())
}

/// Records with a pause between the answers; the time that each hand-over took, and the size.
fn record(
    settings: &Record,
    answers: &[Arc<Served>],
    pause: Duration,
) -> Result<(Vec<Duration>, u64), Box<dyn std::error::Error>> {
    let parent = tempfile::tempdir()?;
    let provenance = Provenance {
        scene: String::new(),
        pack_csv: Vec::new(),
        pack_json: Vec::new(),
        pack_history: None,
        threads: 1,
        seed: 1,
        painter: None,
    };
    let mut recorder = Recorder::create(&parent.path().join("bag"), settings, &provenance)?;
    let mut times = Vec::new();
    for answer in answers {
        let start = Instant::now();
        recorder.served(answer);
        times.push(start.elapsed());
        std::thread::sleep(pause);
    }
    Ok((times, recorder.finish()?.bytes))
}

fn answer((network, increment): (ContactNetwork, u64)) -> Arc<Served> {
    let measures = Measures {
        stamp: Stamp { sec: increment as i32, nanosec: 0 },
        increment,
        events: Vec::new(),
        walls: WallForces::default(),
        wall_force_error: 0.0,
        state: Some(PackState::default()),
        moduli: Some(Moduli {
            valid: false,
            bulk: f64::NAN,
            shear: f64::NAN,
            young: f64::NAN,
            poisson: f64::NAN,
            lame: f64::NAN,
            p_wave: f64::NAN,
            tangent: [f64::NAN; 9],
            p_speed: f64::NAN,
            s_speed: f64::NAN,
        }),
        network: Some(network),
        grains: None,
    };
    let report = Report {
        stamp: measures.stamp,
        session: "bench".into(),
        sequence: increment,
        increment,
        disposition: Disposition::Applied,
        substeps: 1,
        text: String::new(),
        measures: Some(measures),
    };
    Arc::new(Served { command: None, report })
}

/// The contacts of the pack at every increment of a uniaxial strain of 1e-4 each.
fn networks() -> Vec<ContactNetwork> {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut shaken = |size: f64| size * (f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5);
    let mut grains: Vec<[f64; 3]> = (0..SIDE.pow(3))
        .map(|cell| {
            let cell = [cell % SIDE, cell / SIDE % SIDE, cell / SIDE / SIDE];
            cell.map(|index| index as f64 + shaken(0.04))
        })
        .collect();
    let radius = 0.52;
    let neighbours = neighbours(&grains, 2.0 * radius + 0.1);
    (0..INCREMENTS)
        .map(|_| {
            for grain in &mut grains {
                for coordinate in &mut *grain {
                    *coordinate += shaken(1e-5);
                }
                grain[2] *= 1.0 - 1e-4;
            }
            network(&grains, &neighbours, radius)
        })
        .collect()
}

fn neighbours(grains: &[[f64; 3]], reach: f64) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for first in 0..grains.len() {
        for second in first + 1..grains.len() {
            if distance(&grains[first], &grains[second]) < reach {
                pairs.push((first, second));
            }
        }
    }
    pairs
}

fn distance(one: &[f64; 3], other: &[f64; 3]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn network(grains: &[[f64; 3]], pairs: &[(usize, usize)], radius: f64) -> ContactNetwork {
    let mut network = ContactNetwork::default();
    for &(first, second) in pairs {
        let (one, other) = (&grains[first], &grains[second]);
        let length = distance(one, other);
        let overlap = 2.0 * radius - length;
        if overlap <= 0.0 {
            continue;
        }
        network.first.push(first as u32);
        network.second.push(second as u32);
        network.normal.extend(one.iter().zip(other).map(|(a, b)| (a - b) / length));
        network.normal_force.push(overlap.powf(1.5));
        network.tangential_force.extend([0.0; 3]);
        network.overlap.push(overlap);
        network.state.push(0);
    }
    network
}
