//! One step of the law of Mindlin and Deresiewicz: its derivatives, its balance of energy, its
//! bounds under arbitrary histories, and its limits without friction and without slip.

use graintwin::Vec3;
use graintwin::contact::hertz;
use graintwin::contact::partial_slip::{Contact, MOST_LAYERS, Step};
use graintwin::pack::Layer;
use proptest::prelude::*;

use crate::sheared::{H, Line, MU, R, close, contact};

/// μh/η \[m\]: what a first loading slides at.
fn full(contact: &Contact, overlap: f64) -> f64 {
    contact.friction / contact.ratio * overlap
}

fn limit(contact: &Contact, overlap: f64) -> f64 {
    contact.friction * hertz::force(contact.modulus, overlap)
}

/// A contact that was loaded, turned and turned again, so that three rings remain.
fn turned(friction: f64) -> Line {
    let mut line = Line::pressed(contact(friction), H);
    for share in [0.7, -0.6, 0.25] {
        line.go(H, share * full(&contact(MU), H));
    }
    line
}

const OVERLAPS: [f64; 5] = [0.5 * H, 0.95 * H, H, 1.1 * H, 2.0 * H];

#[test]
fn force_is_the_slope_of_the_potential_through_slip_and_reversal() {
    for friction in [MU, f64::INFINITY] {
        let line = turned(friction);
        let unit = full(&contact(MU), H);
        let scale = line.respond(H, 0.0).across * unit;
        for overlap in OVERLAPS {
            let mut sliding = 0;
            for k in -60..=60 {
                let pull = (f64::from(k) + 0.3) / 25.0 * unit;
                let step = 1e-5 * unit;
                let energy =
                    |pull: f64| line.contact.potential(&line.layers, &line.step(overlap, pull));
                let slope = (energy(pull + step) - energy(pull - step)) / (2.0 * step);
                let answer = line.respond(overlap, pull);
                // The pull is positive along the force: Q = dΦ/d(pull).
                close(slope / scale, answer.shear.x / scale, 1e-8);
                sliding += i32::from(answer.sliding);
            }
            assert_eq!(sliding > 0, friction == MU, "sliding at {sliding} pulls");
        }
    }
}

#[test]
fn stiffness_is_the_slope_of_the_force() {
    let line = turned(MU);
    let unit = full(&line.contact, H);
    let scale = line.respond(H, 0.0).across;
    for overlap in OVERLAPS {
        for k in -60..=60 {
            let pull = (f64::from(k) + 0.3) / 25.0 * unit;
            let step = 1e-6 * unit;
            let slope = (line.force(overlap, pull + step) - line.force(overlap, pull - step))
                / (2.0 * step);
            let answer = line.respond(overlap, pull);
            close(slope / scale, answer.along / scale, 1e-6);
        }
    }
}

#[test]
fn stiffness_in_the_plane_misses_only_the_term_it_says() {
    let contact = contact(MU);
    let unit = full(&contact, H);
    let mut layers = Vec::new();
    let first = Step { before: H, overlap: H, displacement: Vec3::new(0.5, 0.0, 0.0) * unit };
    contact.commit(&mut layers, &first);
    let inside = |core: f64| {
        layers
            .iter()
            .find(|layer: &&Layer| layer.reach > core)
            .map_or(Vec3::zeros(), |l| Vec3::from(l.ratio))
    };
    let mut oblique = 0;
    for overlap in [0.9 * H, H, 1.05 * H] {
        for (x, y) in
            [(-0.1, 0.2), (-0.3, 0.3), (0.1, 0.9), (-0.2, -0.05), (2.0, 1.0), (0.01, 0.02)]
        {
            let at = |x: f64, y: f64| {
                let displacement = Vec3::new(x, y, 0.0) * unit;
                contact.respond(&layers, &Step { before: H, overlap, displacement })
            };
            let answer = at(x, y);
            let (e, across, along) = (answer.direction, answer.across, answer.along);
            for (dx, dy) in [(1e-6, 0.0), (0.0, 1e-6)] {
                let du = Vec3::new(dx, dy, 0.0);
                let slope = (at(x - dx, y - dy).shear - at(x + dx, y + dy).shear) / (2e-6 * unit);
                let unit_du = du * 1e6;
                let mut expected = across * unit_du + (along - across) * e.dot(&unit_du) * e;
                if !answer.sliding && e != Vec3::zeros() {
                    let ratio = inside(answer.core);
                    let part = ratio - ratio.dot(&e) * e;
                    oblique += i32::from(part.norm() > 0.1);
                    expected += (across - along) / (1.0 - ratio.dot(&e)) * e.dot(&unit_du) * part;
                }
                close((slope - expected).norm() / contact_stiffness(&contact), 0.0, 1e-6);
            }
        }
    }
    assert!(oblique >= 6, "{oblique} cases tell the term");
}

fn contact_stiffness(contact: &Contact) -> f64 {
    contact.ratio * hertz::stiffness(contact.modulus, H)
}

#[test]
fn work_is_stored_or_dissipated_while_overlap_and_displacement_change() {
    let unit = full(&contact(MU), H);
    let energy = 0.5 * contact_stiffness(&contact(MU)) * unit * unit;
    let balance = |friction: f64, overlap: f64, share: f64| {
        let mut line = Line::pressed(contact(friction), H);
        line.go(H, 0.6 * unit);
        let (stored, work) = (line.stored(), line.work(overlap, share * unit));
        let heat = line.dissipated(overlap, share * unit);
        line.go(overlap, share * unit);
        assert!(heat >= 0.0);
        ((work + stored - line.stored()) / energy, heat / energy)
    };
    for share in [-2.5, -0.3, 0.0, 0.02, 0.2, 0.8, 3.0] {
        for overlap in [0.8 * H, 0.99 * H, 1.01 * H, 1.3 * H] {
            let (lost, heat) = balance(MU, overlap, share);
            close(heat, lost, 2e-6);
        }
        let (lost, heat) = balance(MU, H, share);
        close(heat, lost, 1e-7);
        for overlap in [0.0, 0.3 * H, 2.0 * H] {
            let (lost, heat) = balance(MU, overlap, share);
            close(heat, lost, 1e-3);
        }
        for overlap in [0.3 * H, 0.8 * H, 0.99 * H, H] {
            let (lost, heat) = balance(f64::INFINITY, overlap, share);
            close(heat, lost, 1e-6);
        }
    }
}

#[test]
fn a_contact_that_opens_loses_what_it_stored() {
    for friction in [MU, f64::INFINITY] {
        let mut line = Line::pressed(contact(friction), H);
        line.go(H, 0.6 * full(&contact(MU), H));
        let heat = line.dissipated(-0.3 * H, 0.0);
        close(heat / line.stored(), 1.0, 1e-3);
    }
}

#[test]
fn work_is_stored_or_dissipated_on_small_turning_steps() {
    let contact = contact(MU);
    let unit = full(&contact, H);
    let mut layers = Vec::new();
    let (mut work, mut heat) = (0.0, 0.0);
    let mut last = Vec3::zeros();
    let at = |angle: f64| {
        Vec3::new(0.7 * angle.sin(), 0.5 * (1.3 * angle).sin() + 0.2 * (1.0 - angle.cos()), 0.0)
            * unit
    };
    let parts = 20_000;
    for k in 0..parts {
        let angle = |k: i32| 12.0 * f64::from(k) / f64::from(parts);
        let displacement = at(angle(k + 1)) - at(angle(k));
        let step = Step { before: H, overlap: H, displacement };
        let shear = contact.respond(&layers, &step).shear;
        heat += contact.dissipated(&layers, &step);
        contact.commit(&mut layers, &step);
        work -= 0.5 * (last + shear).dot(&displacement);
        last = shear;
    }
    let stored = contact.stored(&layers, H);
    assert!(heat > 0.5 * stored);
    close((stored + heat) / work, 1.0, 1e-3);
}

#[test]
fn the_answer_turns_with_the_displacements() {
    let contact = contact(MU);
    let turn = |v: Vec3| {
        let (sin, cos) = 0.7f64.sin_cos();
        Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
    };
    let (mut plain, mut turned) = (Vec::new(), Vec::new());
    let mut before = H;
    for (rise, x, y) in [(0.0, 0.5, 0.1), (0.1, -0.3, 0.4), (-0.3, 0.0, -0.2), (0.05, 0.02, 0.01)] {
        let displacement = Vec3::new(x, y, 0.0) * full(&contact, H);
        let step = Step { before, overlap: before + rise * H, displacement };
        let other = Step { displacement: turn(displacement), ..step };
        let (a, b) = (contact.respond(&plain, &step), contact.respond(&turned, &other));
        close((turn(a.shear) - b.shear).norm() / limit(&contact, H), 0.0, 1e-13);
        close(a.core / b.core, 1.0, 1e-12);
        contact.commit(&mut plain, &step);
        contact.commit(&mut turned, &other);
        before = step.overlap;
    }
}

#[test]
fn a_load_that_turns_as_it_grows_keeps_few_layers_and_its_force() {
    let contact = contact(MU);
    let mut layers = Vec::new();
    let mut force = Vec3::zeros();
    let overlap = |k: u32| H * (1.0 + f64::from(k) * 1e-3);
    for k in 0..1000 {
        let angle = f64::from(k) * 0.02;
        let pull = 0.9 * full(&contact, 1e-3 * H);
        let step = Step {
            before: overlap(k),
            overlap: overlap(k + 1),
            displacement: -pull * Vec3::new(angle.cos(), angle.sin(), 0.0),
        };
        contact.commit(&mut layers, &step);
        // Nothing slips: each rise adds 0.9 μ times the rise of P along the pull.
        let rise = limit(&contact, overlap(k + 1)) - limit(&contact, overlap(k));
        force += 0.9 * rise * Vec3::new(angle.cos(), angle.sin(), 0.0);
        assert!(layers.len() <= MOST_LAYERS);
    }
    assert_eq!(layers.len(), MOST_LAYERS);
    let rest = Step { before: 2.0 * H, overlap: 2.0 * H, displacement: Vec3::zeros() };
    let kept = contact.respond(&layers, &rest).shear;
    close((kept - force).norm() / limit(&contact, H), 0.0, 1e-12);
}

#[test]
fn without_slip_the_force_is_the_stiffness_of_the_way() {
    let mut line = Line::pressed(contact(f64::INFINITY), H);
    let stiffness = |overlap: f64| contact_stiffness(&contact(MU)) * (overlap / H).sqrt();
    let pull = 2.0 * R;
    close(line.force(H, pull) / (stiffness(H) * pull), 1.0, 1e-14);
    let first = line.go(H, 1e-9);
    let second = line.go(2.0 * H, 3e-9);
    // ∫ √x dx over the rise from H to 2H.
    let mean = stiffness(H) * 2.0 / 3.0 * (2f64.powf(1.5) - 1.0);
    close((second - first) / (mean * 3e-9), 1.0, 1e-13);
    // Back at H all of it hangs on the contact circle of H.
    close(line.go(H, 0.0) / (stiffness(H) * 4e-9), 1.0, 1e-13);
    close(line.go(0.25 * H, 0.0) / (stiffness(0.25 * H) * 4e-9), 1.0, 1e-13);
}

#[test]
fn much_friction_comes_near_the_contact_that_never_slips() {
    let mut bonded = Line::pressed(contact(f64::INFINITY), H);
    let mut strong = Line::pressed(contact(1e4), H);
    for (overlap, pull) in
        [(H, 1e-8), (1.5 * H, 2e-8), (0.7 * H, -1e-8), (1.2 * H, 0.0), (1.1 * H, -3e-8)]
    {
        let (a, b) = (bonded.go(overlap, pull), strong.go(overlap, pull));
        close(a / b, 1.0, 1e-4);
        // One punch for all of a rise by half stores a little more than they do.
        close(bonded.stored() / strong.stored(), 1.0, 0.02);
    }
}

#[test]
fn without_friction_or_contact_there_is_no_force_and_no_memory() {
    for (friction, overlap) in [(0.0, H), (MU, 0.0), (MU, -H), (f64::INFINITY, -H)] {
        let mut line = turned(MU);
        line.contact.friction = friction;
        let answer = line.respond(overlap, 1e-9);
        assert_eq!((answer.shear, answer.across, answer.sliding), (Vec3::zeros(), 0.0, false));
        line.go(overlap, 1e-9);
        assert!(line.layers.is_empty());
    }
}

/// |v| where its square may be out of range.
fn length(v: Vec3) -> f64 {
    let largest = v.amax().max(f64::MIN_POSITIVE);
    largest * (v / largest).norm()
}

/// Up to 80 steps: overlap and displacement in the plane, in units of H, from `tiny` to `huge`
/// powers of ten.
fn any_steps(tiny: f64, huge: f64) -> impl Strategy<Value = Vec<(f64, f64, f64)>> {
    let power = |huge: f64| (tiny..huge).prop_map(|power| 10f64.powf(power));
    let overlap = prop_oneof![
        6 => 0.2..2.0,
        2 => Just(1.0),
        1 => Just(0.0),
        1 => -1.0..0.0,
        1 => power(0.5),
    ];
    let way = move || prop_oneof![6 => -0.5..0.5, 1 => Just(0.0), 1 => power(huge)];
    prop::collection::vec((overlap, way(), way()), 1..80)
}

/// Takes one step and checks what holds with any friction.
fn check_step(
    contact: &Contact,
    layers: &mut Vec<Layer>,
    step: &Step,
) -> Result<(), TestCaseError> {
    let answer = contact.respond(layers, step);
    let heat = contact.dissipated(layers, step);
    contact.commit(layers, step);
    prop_assert!(layers.len() <= MOST_LAYERS);
    prop_assert!(layers.iter().all(|layer| length(Vec3::from(layer.ratio)) <= 1.0 + 1e-12));
    prop_assert!(layers.first().is_none_or(|core| core.reach > 0.0));
    prop_assert!(layers.windows(2).all(|pair| pair[0].reach < pair[1].reach));
    let stored = contact.stored(layers, step.overlap);
    for number in [length(answer.shear), answer.along, answer.across, heat, stored] {
        prop_assert!(number.is_finite() && number >= 0.0, "{answer:?}, {heat}, {stored}");
    }
    let rest = Step { before: step.overlap, displacement: Vec3::zeros(), ..*step };
    let kept = contact.respond(layers, &rest).shear;
    let normal = hertz::force(contact.modulus, step.overlap.max(H));
    let scale = length(answer.shear) + contact.friction.min(1.0) * normal;
    prop_assert!(length(kept - answer.shear) <= 1e-9 * scale, "{kept:?} {answer:?}");
    Ok(())
}

/// ∫ D dx.
fn taken(layers: &[Layer]) -> Vec3 {
    let inner = [0.0].into_iter().chain(layers.iter().map(|layer| layer.reach));
    layers.iter().zip(inner).fold(Vec3::zeros(), |sum, (layer, inner)| {
        sum + Vec3::from(layer.ratio) * (layer.reach - inner)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_history_breaks_the_limit_of_friction_or_loses_displacement(
        friction in prop::sample::select(vec![1e-12, 1e-3, 0.3, 2.0, 1e3, 1e5]),
        steps in any_steps(-150.0, 20.0),
    ) {
        let contact = contact(friction);
        let mut layers = Vec::new();
        let mut before = 0.0;
        for (share, x, y) in steps {
            let step = Step { before, overlap: share * H, displacement: Vec3::new(x, y, 0.0) * H };
            let answer = contact.respond(&layers, &step);
            let old = layers.clone();
            check_step(&contact, &mut layers, &step)?;
            before = step.overlap.max(0.0);
            prop_assert!(length(answer.shear) <= limit(&contact, before) * (1.0 + 1e-12));
            if before > 0.0 && !answer.sliding && old.len() < MOST_LAYERS {
                let way = taken(&layers) - taken(&old);
                let expected = -step.displacement * (contact.ratio / friction);
                prop_assert!(length(way - expected) <= 1e-11 * H.max(step.overlap), "{way:?} {expected:?}");
            }
        }
    }

    #[test]
    fn no_history_breaks_a_contact_that_never_slips(
        friction in prop::sample::select(vec![1e6, f64::INFINITY]),
        steps in any_steps(-3.0, 2.0),
    ) {
        let contact = contact(friction);
        let mut layers = Vec::new();
        let mut before = 0.0;
        for (share, x, y) in steps {
            let step = Step { before, overlap: share * H, displacement: Vec3::new(x, y, 0.0) * H };
            check_step(&contact, &mut layers, &step)?;
            before = step.overlap.max(0.0);
        }
    }
}
