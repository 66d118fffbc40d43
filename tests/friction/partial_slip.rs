//! The law of Mindlin and Deresiewicz against closed forms, against many rigid punches, and under
//! arbitrary histories.

use graintwin::contact::{hertz, mindlin};
use proptest::prelude::*;

use crate::punches::Punches;
use crate::sheared::{E, G, H, Line, MU, NU, R, close, contact};

/// P \[N\] with E* and R* of equal spheres written out.
fn normal(overlap: f64) -> f64 {
    4.0 / 3.0 * E / (2.0 * 0.96) * (0.5 * R).sqrt() * overlap.powf(1.5)
}

/// B \[m\] at `overlap`: twice Mindlin's 3(2-ν)μP/(16Ga) of one sphere.
fn full_slip(overlap: f64) -> f64 {
    let radius = (0.5 * R * overlap).sqrt();
    3.0 * (2.0 - NU) * MU * normal(overlap) / (8.0 * G * radius)
}

/// Displacement \[m\] of a first loading to Q = q μP.
fn first_loading(overlap: f64, q: f64) -> f64 {
    full_slip(overlap) * (1.0 - (1.0 - q).powf(2.0 / 3.0))
}

#[test]
fn the_stiffness_ratio_is_that_of_mindlin_and_hertz() {
    let contact = contact(MU);
    let shear = mindlin::shear_stiffness(
        mindlin::contact_radius(0.5 * R, H),
        2.0 * mindlin::shear_compliance(E, NU),
    );
    close(contact.ratio * hertz::stiffness(contact.modulus, H) / shear, 1.0, 1e-14);
    let start = Line::pressed(contact, H).respond(H, 0.0);
    close(start.along / shear, 1.0, 1e-14);
    close(start.across / shear, 1.0, 1e-14);
}

#[test]
fn a_first_loading_follows_mindlin_in_one_step_or_many() {
    let limit = MU * normal(H);
    let mut many = Line::pressed(contact(MU), H);
    let mut gone = 0.0;
    for k in 1..=40 {
        let q = f64::from(k) / 40.0;
        let delta = first_loading(H, q);
        let one = Line::pressed(contact(MU), H);
        close(one.force(H, delta) / limit, q, 1e-13);
        close(many.go(H, delta - gone) / limit, q, 1e-13);
        gone = delta;
    }
    assert_eq!(many.layers.len(), 1);
    assert!(many.respond(H, 1e-12).sliding);
    assert!(!Line::pressed(contact(MU), H).respond(H, 0.999 * full_slip(H)).sliding);
}

#[test]
fn unloading_and_reloading_follow_mindlin_and_deresiewicz() {
    let (limit, full) = (MU * normal(H), full_slip(H));
    let top = 0.8;
    let root = |x: f64| x.powf(2.0 / 3.0);
    // δ of unloading from q* and of reloading from -q* (1953, eqs. for constant N).
    let down = |q: f64| full * (2.0 * root(1.0 - 0.5 * (top - q)) - root(1.0 - top) - 1.0);
    let up = |q: f64| -down(-q);
    let mut line = Line::pressed(contact(MU), H);
    line.go(H, first_loading(H, top));
    for cycle in 0..3 {
        for (branch, sign) in [(&down as &dyn Fn(f64) -> f64, -1.0), (&up, 1.0)] {
            let start = -sign * top;
            for k in 1..=10 {
                let (last, q) =
                    (start + sign * 0.16 * f64::from(k - 1), start + sign * 0.16 * f64::from(k));
                let force = line.go(H, branch(q) - branch(last));
                close(force / limit, q, 1e-12);
            }
        }
        assert!(line.layers.len() <= 2, "cycle {cycle} leaves {} layers", line.layers.len());
    }
    // Beyond the old turning point the first loading goes on.
    close(line.force(H, first_loading(H, 0.9) - first_loading(H, top)) / limit, 0.9, 1e-12);
}

#[test]
fn a_loop_loses_what_mindlin_and_deresiewicz_print() {
    let limit = MU * normal(H);
    let radius = (0.5 * R * H).sqrt();
    for q in [0.2f64, 0.5, 0.9, 1.0] {
        let printed = 1.8 * (2.0 - NU) * limit * limit / (G * radius)
            * (1.0 - (1.0 - q).powf(5.0 / 3.0) - 5.0 * q / 6.0 * (1.0 + (1.0 - q).powf(2.0 / 3.0)));
        let mut line = Line::pressed(contact(MU), H);
        line.go(H, first_loading(H, q));
        let (mut area, mut heat) = (0.0, 0.0);
        for swing in [-2.0, 2.0] {
            let pull = swing * first_loading(H, q);
            area += line.work(H, pull);
            heat += line.dissipated(H, pull);
            line.go(H, pull);
        }
        close(area / printed, 1.0, 1e-6);
        close(heat / printed, 1.0, 1e-11);
    }
}

#[test]
fn stick_or_slide_overshoots_by_a_fifth_of_the_limit_and_loses_nothing() {
    let (limit, full) = (MU * normal(H), full_slip(H));
    let line = Line::pressed(contact(MU), H);
    let stick = line.respond(H, 0.0).along;
    let (at, most) = (0..=3000)
        .map(|k| full * f64::from(k) / 3000.0)
        .map(|pull| (pull, (stick * pull).min(limit) - line.force(H, pull)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap();
    close(most / limit, 3f64.powf(-1.5), 1e-12);
    close(at / full, 2.0 / 3.0, 1e-12);
    close(most / limit, 0.1925, 5e-5);
    assert!(line.dissipated(H, at) > 0.0);
}

#[test]
fn overlap_and_shear_that_grow_together_below_the_limit_do_not_slip() {
    let contact = contact(MU);
    let mut line = Line::pressed(contact, H);
    line.go(H, first_loading(H, 0.3));
    let start = line.force(H, 0.0);
    // dQ/dP = κμ with κ < 1: Q rises by the integral of k_s along the way, k_s = 4Ga/(2-ν).
    let (rise, pull) = (H, 0.7 * MU / contact.ratio * H);
    let parts = 2000;
    let stiffness = |x: f64| 4.0 * G * (0.5 * R * x).sqrt() / (2.0 - NU);
    let integral: f64 = (0..parts)
        .map(|k| stiffness(H + rise * (f64::from(k) + 0.5) / f64::from(parts)))
        .sum::<f64>()
        * pull
        / f64::from(parts);
    let answer = line.respond(2.0 * H, pull);
    close((answer.shear.x - start) / integral, 1.0, 1e-7);
    close((answer.shear.x - start) / (0.7 * MU * (normal(2.0 * H) - normal(H))), 1.0, 1e-12);
    assert!(!answer.sliding && answer.core == H);
    assert_eq!(line.dissipated(2.0 * H, pull), 0.0);
    // In ten steps the same, and one ring for all ten.
    let mut force = 0.0;
    for k in 1..=10 {
        force = line.go(H + 0.1 * rise * f64::from(k), 0.1 * pull);
    }
    close(force / answer.shear.x, 1.0, 1e-12);
    assert_eq!(line.layers.len(), 3);
}

#[test]
fn shear_that_outruns_the_limit_forgets_the_way_of_the_normal_force() {
    // dQ/dP > μ on the way: the state is that of a first loading at the last P.
    let mut line = Line::pressed(contact(MU), H);
    let mut gone = 0.0;
    for (overlap, q) in [(H, 0.4), (1.2 * H, 0.6), (1.25 * H, 0.65), (2.0 * H, 0.9)] {
        let delta = first_loading(overlap, q);
        let force = line.go(overlap, delta - gone);
        gone = delta;
        close(force / (MU * normal(overlap)), q, 1e-12);
    }
    assert_eq!(line.layers.len(), 2);
}

#[test]
fn a_constant_shear_slips_on_while_the_normal_force_falls() {
    // 1953, case N decreasing and T constant: a first loading at the last N.
    let shear = 0.5 * MU * normal(H);
    let mut line = Line::pressed(contact(MU), H);
    line.go(H, first_loading(H, 0.5));
    let mut gone = first_loading(H, 0.5);
    for share in [0.95, 0.8, 0.7, 0.64] {
        let overlap = share * H;
        let delta = first_loading(overlap, shear / (MU * normal(overlap)));
        assert!(delta > gone);
        close(line.go(overlap, delta - gone) / shear, 1.0, 1e-12);
        gone = delta;
    }
    // With the displacement held it slides when B of the last N is no longer than it.
    let share = gone / full_slip(H);
    assert!(!line.respond(1.001 * share * H, 0.0).sliding);
    assert!(line.respond(0.999 * share * H, 0.0).sliding);
}

#[test]
fn normal_force_and_shear_that_fall_in_proportion_stay_on_the_first_loading() {
    let q = 0.6;
    let mut line = Line::pressed(contact(MU), H);
    line.go(H, first_loading(H, q));
    let mut gone = first_loading(H, q);
    for share in [0.9, 0.5, 0.1, 1e-3] {
        let delta = first_loading(share * H, q);
        let force = line.go(share * H, delta - gone);
        close(force / (MU * normal(share * H)), q, 1e-9);
        gone = delta;
    }
}

#[test]
fn a_cycle_of_more_normal_force_alone_leaves_no_trace() {
    let mut line = Line::pressed(contact(MU), H);
    line.go(H, first_loading(H, 0.7));
    line.go(H, -first_loading(H, 0.2));
    let before = line.layers.clone();
    let force = line.force(H, 0.0);
    close(line.go(1.5 * H, 0.0), force, 1e-14 * force.abs());
    close(line.go(H, 0.0), force, 1e-12 * force.abs());
    for (old, new) in before.iter().zip(&line.layers) {
        close(new.reach, old.reach, 1e-12 * H);
        close(new.ratio[0], old.ratio[0], 1e-12);
    }
}

/// Up to twelve turns on a line: punches more or fewer, and displacement in units of μH/η.
fn turns() -> impl Strategy<Value = Vec<(i64, f64)>> {
    let more = prop_oneof![Just(0), -1500..1500i64];
    let pull = prop_oneof![Just(0.0), -0.4..0.4, -1.2..1.2];
    prop::collection::vec((more, pull), 1..12)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn many_punches_agree_with_the_rings(start in 500..4000i64, turns in turns()) {
        let contact = contact(MU);
        let width = H / 4000.0;
        let mut punches = Punches::new(contact, width);
        punches.drive(start, 0.0);
        let mut line = Line::pressed(contact, punches.overlap());
        for (more, share) in turns {
            let more = more.max(100 - (line.overlap / width).round() as i64);
            let pull = share * MU / contact.ratio * H;
            let stored = punches.stored();
            let heat = punches.drive(more, pull) - (punches.stored() - stored);
            let (now, overlap) = (line.overlap, punches.overlap());
            let top = now.max(overlap);
            let limit = MU * normal(top);
            let energy = limit * full_slip(top);
            // Share of the last punch in the energy: it may come before or after the shear.
            let punch = 2.5 * width / top;
            // Only where the overlap falls may slip turn within a step, and short ones seldom do.
            let parts = if more < 0 { 64 } else { 1 };
            let (mut force, mut lost) = (0.0, 0.0);
            for k in 1..=parts {
                let next = now + (overlap - now) * f64::from(k) / f64::from(parts);
                lost += line.dissipated(next, pull / f64::from(parts));
                force = line.go(next, pull / f64::from(parts));
            }
            for (name, rings, many) in [
                ("force", force / limit, punches.force() / limit),
                ("stored", line.stored() / energy, punches.stored() / energy),
                ("lost", lost / energy, heat / energy),
            ] {
                let tolerance = punch * many.abs().max(1.0);
                prop_assert!((rings - many).abs() < tolerance, "{name}: {rings} against {many}");
            }
        }
    }
}
