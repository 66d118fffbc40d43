//! Events: what is told of an instability against what its snapshots show, and none where there is
//! none.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "common/hard.rs"]
#[allow(dead_code, reason = "other tests take the rest")]
mod hard;
#[path = "common/packs.rs"]
mod packs;
#[path = "common/pairs.rs"]
mod pairs;

use graintwin::report::{EventEnd, Measures, Rearrangement, Snapshot};
use hard::Hard;
use packs::{Rig, close};
use pairs::Pairs;

/// The increments of `hard` that were served, the first equilibrium not among them.
fn driven(hard: &Hard) -> Vec<Measures> {
    let (mut rig, _) = Rig::start(&hard.scene, &hard.pack);
    hard.path.iter().filter_map(|target| rig.send(*target).measures).collect()
}

/// The events of an increment, each with its snapshots before and after.
fn events(measures: &Measures) -> Vec<(&Rearrangement, [&Snapshot; 2])> {
    assert_eq!(measures.rearrangements.len(), measures.events.len());
    assert_eq!(measures.snapshots.len(), 2 * measures.events.len());
    let pairs = measures.snapshots.chunks(2).map(|pair| [&pair[0], &pair[1]]);
    measures.rearrangements.iter().zip(pairs).collect()
}

/// Paths with instabilities: two packs near jamming, one let go and pressed again, and a grain
/// that is pushed through a constriction, without and with friction.
fn unstable() -> [Hard; 5] {
    [
        hard::near_jamming(300, 0.0, 2e5, 1e-4, 10),
        hard::near_jamming(300, 0.0, 2e4, 1e-3, 2),
        hard::decompression(150, 0.0),
        hard::constriction(0.0, 60),
        hard::constriction(0.3, 12),
    ]
}

#[test]
fn what_an_event_tells_is_what_its_snapshots_show() {
    for hard in unstable() {
        let mut seen = 0;
        for measures in driven(&hard) {
            for (k, (event, [before, after])) in events(&measures).into_iter().enumerate() {
                seen += 1;
                assert_eq!([before.event, after.event], [k as u32; 2]);
                assert_eq!([before.end, after.end], [EventEnd::Before, EventEnd::After]);
                assert_eq!(before.wall_position, after.wall_position, "the walls stand still");
                let [was, is] = [before, after].map(|one| Pairs::of(&hard, one));
                let (lost, made) = was.apart(&is);
                assert_eq!((&event.lost, &event.made), (&lost, &made), "{}", hard.name);
                for (grain, way) in event.grains.iter().zip(&event.displacement) {
                    let [from, to] = [before, after].map(|one| one.position[*grain as usize]);
                    assert_eq!(*way, std::array::from_fn(|axis| to[axis] - from[axis]));
                }
                for (grain, turn) in event.grains.iter().zip(&event.rotation) {
                    let [from, to] = [before, after].map(|one| one.rotation[*grain as usize]);
                    assert_eq!(*turn, std::array::from_fn(|axis| to[axis] - from[axis]));
                }
                assert!(event.energy_before > event.energy_after, "a jump goes downhill");
                let short = &measures.events[k];
                assert_eq!(short.grains, event.grains);
                assert_eq!(short.stress_before.to_bits(), event.stress_before.to_bits());
                assert_eq!(short.stress_after.to_bits(), event.stress_after.to_bits());
                assert_eq!(short.energy_released, event.energy_before - event.energy_after);
                let rough = hard.pack.grains[0].friction > 0.0;
                let turns = if rough { event.grains.len() } else { 0 };
                assert_eq!(event.rotation.len(), turns);
            }
        }
        assert!(seen > 0, "{}: the path had no event", hard.name);
    }
}

#[test]
fn energy_and_stress_of_a_frictionless_event_are_those_of_its_snapshots() {
    for hard in &unstable()[..3] {
        for measures in driven(hard) {
            for (event, [before, after]) in events(&measures) {
                let [was, is] = [before, after].map(|one| Pairs::of(hard, one));
                close("energy before", event.energy_before, was.energy, 1e-10);
                close("energy after", event.energy_after, is.energy, 1e-10);
                close("stress before", event.stress_before, was.stress, 1e-10);
                close("stress after", event.stress_after, is.stress, 1e-10);
                // Every other configuration is out of balance, the one after is not.
                let tolerance = hard.scene.solver.tolerance;
                assert!(is.residual <= 1.01 * tolerance, "{}: {:e}", hard.name, is.residual);
                assert!(was.residual > 10.0 * tolerance, "{}: {:e}", hard.name, was.residual);
                assert!(event.grains.iter().zip(&event.displacement).all(|(_, way)| {
                    let way = way.iter().map(|x| x * x).sum::<f64>().sqrt();
                    way > 0.999 * is.mean_overlap
                }));
            }
        }
    }
}
