use super::*;

const Z_MIN: usize = 4;
const Z_MAX: usize = 5;
const START: Duration = Duration::ZERO;

fn cells(walls: &[usize]) -> Cells {
    let mut cells = Cells { walls: [false; 6], sign: 1.0, max_delay: 0.0 };
    for &wall in walls {
        cells.walls[wall] = true;
    }
    cells
}

fn at(seconds: f64) -> Stamp {
    Stamp::from_seconds(seconds)
}

fn along_z(force: f64) -> [f64; 3] {
    [1e3, -2e3, force]
}

#[test]
fn the_nearest_sample_counts_whichever_came_first() {
    let mut pairing = Pairing::new(cells(&[Z_MAX]));
    for (time, force) in [(0.9, 9.0), (0.98, 10.0), (1.07, 11.0)] {
        assert!(pairing.measured(Z_MAX, at(time), along_z(force)));
    }
    pairing.served(at(1.0), 1, [5.0; 6], START);
    let found = pairing.ready(START).unwrap();
    assert_eq!((found.increment, found.twin, found.rig[Z_MAX]), (1, [5.0; 6], 10.0));
    assert!((found.delay[Z_MAX] + 0.02).abs() < 1e-12);
    pairing.served(at(1.05), 2, [5.0; 6], START);
    assert_eq!(pairing.ready(START).unwrap().rig[Z_MAX], 11.0);
}

#[test]
fn a_wall_without_a_cell_is_not_valid() {
    let mut pairing = Pairing::new(cells(&[Z_MAX]));
    assert!(!pairing.measured(Z_MIN, at(1.0), along_z(3.0)));
    pairing.measured(Z_MAX, at(1.0), along_z(4.0));
    pairing.served(at(1.0), 1, [5.0; 6], START);
    let found = pairing.ready(START).unwrap();
    let valid: Vec<bool> = (0..6).map(|wall| found.is_valid(wall)).collect();
    assert_eq!(valid, [false, false, false, false, false, true]);
    assert!(found.delay[Z_MIN].is_nan());
}

/// The pack pushes the bottom down and the top up.
#[test]
fn the_signs_follow_the_walls_and_the_cells() {
    for (sign, bottom, top) in [(1.0, -7.0, 8.0), (-1.0, 7.0, -8.0)] {
        let mut pairing = Pairing::new(Cells { sign, ..cells(&[Z_MIN, Z_MAX]) });
        pairing.measured(Z_MIN, at(1.0), along_z(bottom));
        pairing.measured(Z_MAX, at(1.0), along_z(top));
        pairing.served(at(1.0), 1, [5.0; 6], START);
        let found = pairing.ready(START).unwrap();
        assert_eq!((found.rig[Z_MIN], found.rig[Z_MAX]), (7.0, 8.0));
    }
}

#[test]
fn an_increment_waits_for_the_samples_of_its_time_but_not_for_ever() {
    let mut pairing = Pairing::new(cells(&[Z_MIN, Z_MAX]));
    pairing.measured(Z_MIN, at(2.0), along_z(-1.0));
    pairing.measured(Z_MAX, at(0.5), along_z(1.0));
    pairing.served(at(1.0), 1, [5.0; 6], START);
    assert_eq!(pairing.ready(START), None);
    pairing.measured(Z_MAX, at(1.1), along_z(2.0));
    assert_eq!(pairing.ready(START).unwrap().rig[Z_MAX], 2.0);

    pairing.served(at(3.0), 2, [5.0; 6], START);
    assert_eq!(pairing.ready(PATIENCE / 2), None);
    let late = pairing.ready(PATIENCE).unwrap();
    assert_eq!((late.increment, late.rig[Z_MAX]), (2, 2.0));
    assert_eq!(pairing.ready(PATIENCE), None);
}

#[test]
fn increments_come_out_in_order_and_all_of_them_at_the_end() {
    let mut pairing = Pairing::new(cells(&[Z_MAX]));
    for increment in 0..3 {
        pairing.served(at(1.0 + increment as f64), increment, [5.0; 6], START);
    }
    pairing.measured(Z_MAX, at(1.5), along_z(2.0));
    assert_eq!(pairing.ready(START).unwrap().increment, 0);
    assert_eq!(pairing.ready(START), None);
    assert_eq!(pairing.take_oldest().unwrap().increment, 1);
    assert_eq!(pairing.take_oldest().unwrap().increment, 2);
    assert_eq!(pairing.take_oldest(), None);
}

#[test]
fn a_sample_too_far_away_in_time_is_none() {
    let mut pairing = Pairing::new(Cells { max_delay: 0.1, ..cells(&[Z_MAX]) });
    pairing.measured(Z_MAX, at(1.25), along_z(2.0));
    for (increment, stamp, valid) in [(1, 1.125, false), (2, 1.1875, true), (3, 0.0, false)] {
        pairing.served(at(stamp), increment, [5.0; 6], START);
        assert_eq!(pairing.ready(START).unwrap().is_valid(Z_MAX), valid, "{stamp}");
    }
}

#[test]
fn forces_that_are_no_numbers_are_not_used() {
    let mut pairing = Pairing::new(cells(&[Z_MAX]));
    for force in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(!pairing.measured(Z_MAX, at(1.0), along_z(force)));
    }
    pairing.served(at(1.0), 1, [5.0; 6], START);
    assert!(!pairing.take_oldest().unwrap().is_valid(Z_MAX));
}

#[test]
fn a_rig_that_never_stops_and_one_that_never_comes_take_bounded_memory() {
    let mut pairing = Pairing::new(cells(&[Z_MAX]));
    let many = 3 * SAMPLES as u64;
    for number in 0..many {
        pairing.measured(Z_MAX, at(number as f64), along_z(number as f64));
    }
    assert_eq!(pairing.samples[Z_MAX].len(), SAMPLES);
    pairing.served(at(0.0), 0, [5.0; 6], START);
    assert_eq!(pairing.take_oldest().unwrap().rig[Z_MAX], (many - SAMPLES as u64) as f64);

    let mut pairing = Pairing::new(cells(&[Z_MAX]));
    let mut out = 0;
    for increment in 0..3 * WAITING as u64 {
        pairing.served(at(0.0), increment, [5.0; 6], START);
        out += u64::from(pairing.ready(START).is_some());
    }
    assert_eq!(pairing.waiting.len() as u64 + out, 3 * WAITING as u64);
    assert_eq!(pairing.waiting.len(), WAITING);
}
