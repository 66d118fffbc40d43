//! Events: what is told of an instability against what its snapshots show, and none where there is
//! none.

use graintwin::report::{Demand, EventEnd, Measures, Rearrangement, Snapshot};

use crate::hard::{self, Hard};
use crate::packs::{Rig, absolute, by_strain, close, made};
use crate::pairs::Pairs;

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
        hard::constriction(0.3, 60),
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

/// Smooth paths: crystals, cycles of a dense pack, a pack with friction far beyond its first slip.
fn smooth(friction: f64) -> [Hard; 4] {
    [
        hard::crystal(false, friction, 10),
        hard::crystal(true, friction, 10),
        hard::cycles(150, friction, 100),
        hard::plain(200, friction),
    ]
}

#[test]
fn smooth_paths_raise_no_alarm() {
    for friction in [0.0, 0.3] {
        for hard in smooth(friction) {
            let path = driven(&hard);
            assert_eq!(path.len(), hard.path.len(), "{}", hard.name);
            let events: usize = path.iter().map(|measures| measures.events.len()).sum();
            assert_eq!(events, 0, "{}, friction {friction}", hard.name);
        }
    }
}

#[test]
fn a_cycle_without_an_alarm_is_reversible() {
    // Ten increments a cycle, without friction: had the pack jumped it would not come back.
    let hard = hard::cycles(150, 0.0, 100);
    let path = driven(&hard);
    let ends: Vec<_> = path.chunks(10).map(|cycle| cycle[9].walls.normal_force).collect();
    let largest = ends[0].iter().copied().fold(0.0, f64::max);
    for end in &ends {
        for (now, first) in end.iter().zip(ends[0]) {
            assert!((now - first).abs() <= 1e-6 * largest, "{now:e} was {first:e}");
        }
    }
}

#[test]
fn a_thousand_increments_of_a_pack_that_slips_raise_no_alarm() {
    let pack = {
        let mut pack = made(150, 1e7, 3);
        pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
        pack
    };
    let mut scene = hard::plain(10, 0.3).scene;
    scene.contact.torsion = true;
    let (mut rig, _) = Rig::start(&scene, &pack);
    let mut slips = 0;
    for increment in 1..=1000 {
        // Uniaxial loading and unloading between 0 and 4 promille of strain.
        let strain = 4e-3 * (f64::from(increment) / 250.0).rem_euclid(2.0).min(1.0)
            - 4e-3 * ((f64::from(increment) / 250.0).rem_euclid(2.0) - 1.0).max(0.0);
        let measures = rig.go_quietly(by_strain(&pack.bounds, [0.0, 0.0, strain]));
        assert!(measures.events.is_empty());
        slips += measures.state.unwrap().slipped;
    }
    assert!(slips > 10_000, "only {slips} contacts slipped");
}

#[test]
fn nothing_is_told_that_nobody_asked_for_and_asking_changes_nothing() {
    let hard = hard::near_jamming(150, 0.0, 2e4, 1e-3, 3);
    let (mut asked, _) = Rig::start(&hard.scene, &hard.pack);
    let (mut silent, _) = Rig::start(&hard.scene, &hard.pack);
    let mut events = 0;
    for (target, sequence) in hard.path.iter().zip(1..) {
        let told = asked.send(*target).measures.unwrap();
        let report = silent.twin.apply(&absolute(sequence, *target), Demand::NONE);
        let short = report.measures.unwrap();
        assert_eq!(short.events, told.events);
        assert_eq!((short.rearrangements.len(), short.snapshots.len()), (0, 0));
        events += told.rearrangements.len();
    }
    assert!(events > 0, "the path had no event");
    assert_eq!(asked.twin.digest(), silent.twin.digest());
}
