//! The stick-or-slide laws of one contact: radial return, the rule of the thesis, and torsion.
//!
//! Units do not matter here: forces and stiffnesses are of the order of one.

use graintwin::Vec3;
use graintwin::contact::coulomb::{Shear, Torsion, return_map, secant, torsion};
use proptest::prelude::*;

/// What rounding leaves of numbers that do not cancel.
const EXACT: f64 = 1e-12;

/// One contact and how it moves.
#[derive(Clone, Copy, Debug)]
struct Case {
    carried: Vec3,
    u: Vec3,
    stiffness: f64,
    limit: f64,
}

impl Case {
    fn at(&self, u: &Vec3) -> Shear {
        return_map(&self.carried, u, self.stiffness, self.limit)
    }

    /// The largest number that enters the energies.
    fn energy_scale(&self) -> f64 {
        (self.carried - self.u * self.stiffness).norm_squared() / self.stiffness
    }

    /// The force if nothing slips.
    fn trial(&self) -> Vec3 {
        self.carried - self.u * self.stiffness
    }
}

fn vector(size: f64) -> impl Strategy<Value = Vec3> {
    [-size..size, -size..size, -size..size].prop_map(Vec3::from)
}

/// Limits: none, any, and one that is never reached.
fn limit() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 8 => 0.0..4.0f64, 1 => Just(f64::INFINITY)]
}

/// A contact that may carry more than its limit.
fn case() -> impl Strategy<Value = Case> {
    (vector(3.0), vector(2.0), 0.1..10.0f64, limit())
        .prop_map(|(carried, u, stiffness, limit)| Case { carried, u, stiffness, limit })
}

/// A contact on the edge of sliding: its trial force is off a finite limit by 1e-3 at most.
fn edge() -> impl Strategy<Value = Case> {
    let off = prop_oneof![Just(0.0), -1e-3..1e-3f64, -1e-9..1e-9f64];
    (vector(3.0), vector(1.0), 0.1..10.0f64, 0.1..4.0f64, off)
        .prop_filter("a direction", |(_, to, ..)| to.norm() > 1e-2)
        .prop_map(|(carried, to, stiffness, limit, off)| {
            let u = (carried - to.normalize() * (limit * (1.0 + off))) / stiffness;
            Case { carried, u, stiffness, limit }
        })
}

/// A contact that carries no more than its limit, which is finite and above zero.
fn within() -> impl Strategy<Value = Case> {
    (vector(1.0), 0.0..0.999f64, vector(2.0), 0.1..10.0f64, 0.1..4.0f64)
        .prop_filter("directions", |(q, _, u, ..)| q.norm() > 1e-2 && u.norm() > 1e-3)
        .prop_map(|(q, share, u, stiffness, limit)| {
            let carried = q.normalize() * (share * limit);
            Case { carried, u, stiffness, limit }
        })
}

/// The secant stiffness as (3.4)-(3.5b) print it.
fn printed(case: &Case) -> f64 {
    let Case { carried, u, stiffness, limit } = case;
    if case.trial().norm() <= *limit {
        return *stiffness;
    }
    let along = carried.dot(u);
    let bracket = along.powi(2) + (limit.powi(2) - carried.norm_squared()) * u.norm_squared();
    let bracket = if bracket < 0.0 { return 0.0 } else { bracket };
    (along + bracket.sqrt()) / u.norm_squared()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn force_is_the_slope_of_the_potential(case in prop_oneof![case(), edge()]) {
        let step = 1e-6;
        let force = case.at(&case.u).force;
        for axis in 0..3 {
            let energy = |sign: f64| {
                let mut u = case.u;
                u[axis] += sign * step;
                case.at(&u).potential
            };
            let slope = (energy(1.0) - energy(-1.0)) / (2.0 * step);
            // The force changes by at most k a unit of u, so over the step by at most k step.
            let bound = case.stiffness * step + 1e-15 * case.energy_scale() / step;
            prop_assert!((force[axis] + slope).abs() <= bound, "{} {slope}", force[axis]);
        }
    }

    #[test]
    fn potential_is_convex_with_a_continuous_slope(case in case(), to in vector(2.0), share in 0.0..1.0f64) {
        let between = case.u.lerp(&to, share);
        let (a, b, c) = (case.at(&case.u), case.at(&between), case.at(&to));
        let chord = a.potential + share * (c.potential - a.potential);
        let rounding = EXACT * (a.potential + c.potential);
        prop_assert!(b.potential <= chord + rounding, "{} above {chord}", b.potential);
        // The nearest points of a disc are no further apart than the points themselves.
        let apart = (to - case.u).norm() * case.stiffness;
        let rounding = EXACT * (case.trial().norm() + apart);
        prop_assert!((a.force - c.force).norm() <= apart + rounding);
    }

    #[test]
    fn force_never_exceeds_the_limit(case in prop_oneof![case(), edge(), within()]) {
        for law in [return_map, secant] {
            let force = law(&case.carried, &case.u, case.stiffness, case.limit).force.norm();
            prop_assert!(force <= case.limit * (1.0 + EXACT), "{force} above {}", case.limit);
        }
    }

    #[test]
    fn force_is_the_point_of_the_disc_nearest_to_that_without_slip(case in case(), other in vector(1.0)) {
        let force = case.at(&case.u).force;
        if case.trial().norm() <= case.limit {
            prop_assert_eq!(force, case.trial());
        } else if other.norm() <= 1.0 {
            let nearest = (case.trial() - force).norm();
            prop_assert!(nearest <= (case.trial() - other * case.limit).norm() * (1.0 + EXACT));
        }
    }

    #[test]
    fn linearisation_is_the_slope_of_the_force(case in case(), d in vector(1.0)) {
        let step = 1e-6;
        let far = case.limit.is_infinite() || case.limit == 0.0 || case.limit > 0.1;
        let away = (case.trial().norm() - case.limit).abs() > 4.0 * case.stiffness * step;
        prop_assume!(far && away);
        let here = case.at(&case.u);
        let move_by = |sign: f64| case.at(&(case.u + d * (sign * step))).force;
        let slope = (move_by(1.0) - move_by(-1.0)) / (-2.0 * step);
        let along = here.direction * here.direction.dot(&d);
        let want = (d - along) * here.across + along * here.along;
        // Third derivative of the force: at most some k³/Q_max², with k <= 10 and Q_max > 0.1.
        let bound = 1e5 * step * step + 1e-15 * case.trial().norm() / step;
        prop_assert!((slope - want).norm() <= bound, "{slope} {want}");
    }

    #[test]
    fn what_slip_takes_is_the_limit_times_the_slip(case in prop_oneof![case(), edge()]) {
        let answer = case.at(&case.u);
        // What the spring does not follow is slip.
        let slip = (case.trial() - answer.force).norm() / case.stiffness;
        let heat = if slip > 0.0 { case.limit * slip } else { 0.0 };
        let rounding = EXACT * case.energy_scale();
        prop_assert!(answer.dissipated >= 0.0);
        prop_assert!((answer.dissipated - heat).abs() <= rounding);
        let stored = 0.5 * answer.force.norm_squared() / case.stiffness;
        prop_assert!((answer.potential - stored - heat).abs() <= rounding);
        prop_assert_eq!(answer.slides, case.trial().norm_squared() > case.limit * case.limit);
    }

    #[test]
    fn secant_is_the_printed_formula_where_the_carried_force_is_allowed(case in within()) {
        let Case { carried, u, stiffness, limit } = case;
        let found = secant(&carried, &u, stiffness, limit);
        let want = carried - u * printed(&case);
        // The printed sum cancels to a share of |Q⁰| of rounding; 1 - 0.999² keeps the root away
        // from zero.
        prop_assert!((found.force - want).norm() <= 1e-11 * limit, "{} {want}", found.force);
        prop_assert_eq!(found.slides, case.trial().norm_squared() > limit * limit);
    }

    #[test]
    fn the_secant_loses_no_less_than_nothing(case in prop_oneof![case(), edge(), within()]) {
        let answer = secant(&case.carried, &case.u, case.stiffness, case.limit);
        let scale = case.energy_scale() + case.carried.norm_squared() / case.stiffness;
        let stored = 0.5 * answer.force.norm_squared() / case.stiffness;
        prop_assert!(answer.dissipated >= -EXACT * scale, "{}", answer.dissipated);
        prop_assert!((answer.potential - stored - answer.dissipated).abs() <= EXACT * scale);
    }

    #[test]
    fn both_laws_are_the_same_on_a_line(
        to in vector(1.0), carried in -1.0..1.0f64, u in -3.0..3.0f64, stiffness in 0.1..10.0f64, limit in 0.1..4.0f64
    ) {
        prop_assume!(to.norm() > 1e-2);
        let axis = to.normalize();
        let (carried, u) = (axis * (carried * limit), axis * u);
        let (a, b) = (return_map(&carried, &u, stiffness, limit), secant(&carried, &u, stiffness, limit));
        // A carried force near the limit: its square is off by rounding, and the secant by the
        // root of that where the force turns round.
        prop_assert!((a.force - b.force).norm() <= 1e-11 * limit, "{} {}", a.force, b.force);
    }

    #[test]
    fn both_laws_are_the_same_until_a_contact_slides_that_carried_something(case in within()) {
        let Case { carried, u, stiffness, limit } = case;
        let answers = |carried: &Vec3| {
            (return_map(carried, &u, stiffness, limit), secant(carried, &u, stiffness, limit))
        };
        let (a, b) = answers(&carried);
        prop_assert_eq!(a.slides, b.slides);
        if !a.slides {
            prop_assert_eq!(a, b);
        }
        let (a, b) = answers(&Vec3::zeros());
        prop_assert!((a.force - b.force).norm() <= EXACT * limit, "{} {}", a.force, b.force);
    }

    #[test]
    fn torsion_is_shear_on_a_line(carried in -3.0..3.0f64, angle in -3.0..3.0f64, stiffness in 0.1..10.0f64, limit in limit()) {
        let found = torsion(carried, angle, stiffness, limit);
        let line = |x: f64| Vec3::new(0.0, x, 0.0);
        let want = return_map(&line(carried), &line(angle), stiffness, limit);
        let trial = carried - stiffness * angle;
        let rounding = EXACT * trial * trial / stiffness;
        prop_assert!((found.couple - want.force.y).abs() <= EXACT * trial.abs());
        prop_assert!((found.potential - want.potential).abs() <= rounding);
        prop_assert!((found.dissipated - want.dissipated).abs() <= rounding);
        prop_assert_eq!(found.stiffness, want.along);
        prop_assert_eq!(found.slides, want.slides);
    }

    #[test]
    fn torsion_is_the_printed_formula_where_the_carried_couple_is_allowed(
        share in -0.999..0.999f64, angle in -3.0..3.0f64, stiffness in 0.1..10.0f64, limit in 0.1..4.0f64
    ) {
        prop_assume!(angle.abs() > 1e-3);
        let carried = share * limit;
        let trial = carried - stiffness * angle;
        let secant = match trial.abs() <= limit {
            true => stiffness,
            // (3.9b).
            false => {
                let bracket = (carried * angle).powi(2) + (limit.powi(2) - carried.powi(2)) * angle.powi(2);
                (carried * angle + bracket.sqrt()) / angle.powi(2)
            }
        };
        let found = torsion(carried, angle, stiffness, limit).couple;
        prop_assert!((found - (carried - secant * angle)).abs() <= 1e-11 * limit);
    }
}

#[test]
fn force_and_slope_are_continuous_where_sliding_begins() {
    let (carried, stiffness, limit) = (Vec3::new(0.3, -0.4, 0.0), 2.0, 1.0);
    // |Q⁰ - k t e| = 1 with Q⁰·e = -0.14 and |Q⁰|² = 0.25: 4t² + 0.56 t - 0.75 = 0.
    let e = Vec3::new(0.6, 0.8, 0.0);
    let t = (-0.56 + (0.56f64 * 0.56 + 12.0).sqrt()) / 8.0;
    let at = |off: f64| return_map(&carried, &(e * (t + off)), stiffness, limit);
    for off in [1e-3, 1e-6, 1e-9] {
        let (stuck, slid) = (at(-off), at(off));
        assert!(!stuck.slides && slid.slides);
        assert!((stuck.force - slid.force).norm() <= 2.0 * off * stiffness * (1.0 + 1e-6));
        assert!((stuck.potential - slid.potential).abs() <= 2.0 * off * limit * (1.0 + 1e-6));
    }
}

#[test]
fn a_carried_force_at_the_limit_stays_under_the_secant_when_pushed_on_and_turns_when_pulled_back() {
    let carried = Vec3::new(1.0, 0.0, 0.0);
    let slides_on = secant(&carried, &Vec3::new(-0.3, 0.2, 0.0), 5.0, 1.0);
    assert_eq!((slides_on.force, slides_on.across, slides_on.slides), (carried, 0.0, true));
    // u = (0.1, 0.3): the force is mirrored across the line that u is normal to,
    // Q - 2 (Q·u) u/u² = (1 - 0.2, -0.6).
    let turned = secant(&carried, &Vec3::new(0.1, 0.3, 0.0), 5.0, 1.0);
    assert!((turned.force - Vec3::new(0.8, -0.6, 0.0)).norm() < EXACT, "{}", turned.force);
}

#[test]
fn the_secant_turns_a_sliding_force_otherwise_than_the_radial_return() {
    let (carried, u) = (Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, -1.0, 0.0));
    let (a, b) = (return_map(&carried, &u, 1.0, 1.0), secant(&carried, &u, 1.0, 1.0));
    // Radial return: (1, 1) shortened to 1. The secant: at the limit and pushed across it gives
    // way without a change.
    assert!((a.force - Vec3::new(1.0, 1.0, 0.0) / 2.0f64.sqrt()).norm() < EXACT);
    assert_eq!(b.force, carried);
}

#[test]
fn a_carried_force_beyond_the_limit_is_shortened_where_the_printed_root_reverses_it() {
    // 1.2 is carried, 1 is allowed, and the contact is moved by little: back, on and across.
    let carried = Vec3::new(1.2, 0.0, 0.0);
    for u in [[1e-3, 0.0], [-1e-3, 0.0], [1e-3, 2e-4]] {
        let u = Vec3::new(u[0], u[1], 0.0);
        let case = Case { carried, u, stiffness: 1.0, limit: 1.0 };
        let as_printed = carried - u * printed(&case);
        let found = secant(&carried, &u, 1.0, 1.0);
        assert!((found.force - Vec3::new(1.0, 0.0, 0.0)).norm() < 2e-3, "{}", found.force);
        if u.x > 0.0 {
            // Both roots are positive and (3.5b) takes the one on the other side of the disc.
            assert!(as_printed.x < -0.5, "{as_printed}");
        } else {
            // Both roots are negative: a contact that pushes where it is pulled.
            assert!(printed(&case) < -100.0, "{}", printed(&case));
        }
        // The energy of the part that was cut off is lost: 1 (1.2 - 1).
        assert!((found.dissipated - 0.2).abs() < 2e-3, "{}", found.dissipated);
    }
}

#[test]
fn laws_answer_in_numbers_without_displacement_load_or_limit() {
    let vectors = [[0.0; 3], [1.0, 0.0, 0.0], [-0.4, 0.3, 2.0], [1e-300; 3], [1e-160, 0.0, 0.0]];
    for carried in vectors.map(Vec3::from) {
        for u in vectors.map(Vec3::from) {
            for limit in [0.0, 1e-300, 1.0, f64::INFINITY] {
                for law in [return_map, secant] {
                    let answer = law(&carried, &u, 1.5, limit);
                    let Shear { force, potential, dissipated, across, along, direction, .. } =
                        answer;
                    let numbers = [potential, dissipated, across, along];
                    let vectors = force.iter().chain(direction.iter());
                    assert!(
                        numbers.iter().chain(vectors).all(|number| number.is_finite()),
                        "{carried} {u} {limit}: {answer:?}"
                    );
                }
                let answer = torsion(carried.x, u.x, 1.5, limit);
                let Torsion { couple, potential, dissipated, stiffness, .. } = answer;
                let numbers = [couple, potential, dissipated, stiffness];
                assert!(numbers.iter().all(|number| number.is_finite()), "{answer:?}");
            }
        }
    }
}

#[test]
fn a_contact_that_is_not_moved_keeps_its_force() {
    let carried = Vec3::new(0.3, -0.4, 0.0);
    for law in [return_map, secant] {
        for limit in [0.5, 0.51, f64::INFINITY] {
            let answer = law(&carried, &Vec3::zeros(), 3.0, limit);
            assert!((answer.force - carried).norm() <= 1e-16, "{limit}: {}", answer.force);
        }
        assert_eq!(law(&carried, &Vec3::zeros(), 3.0, 0.0).force, Vec3::zeros());
    }
}

#[test]
fn a_contact_without_torsional_stiffness_has_no_couple() {
    assert_eq!(torsion(0.7, 0.3, 0.0, 0.5), Torsion::default());
}
