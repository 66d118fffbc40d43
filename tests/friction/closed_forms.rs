//! Specimens with friction whose equilibrium is known in closed form: a ball between tilted plates,
//! and the pyramid of the thesis. The stiffnesses are written out here from Hertz' and Mindlin's
//! formulas, the balances are derived beside each test.

use std::f64::consts::{PI, SQRT_2};

use graintwin::Vec3;
use graintwin::command::Disposition;
use graintwin::pack::{Grain, Pack};
use graintwin::scene::{Law, Scene, Update};
use graintwin::wall::{self, Bounds};

use crate::packs::{E_GRAINS, Rig, bead, centered, close};
use crate::rough::{MU, R, frictional, root, wall_overlap};

/// Rubber balls of 10 mm, whose weight is a tenth of what presses them.
const BALL: f64 = 0.01;
const BALL_DENSITY: f64 = 1100.0;
const BALL_OVERLAP: f64 = 1e-4;

/// A ball between two plates across z, its weight at `angle` from their normal.
fn tilted(angle: f64, gravity: f64, gap: f64) -> (Scene, Pack) {
    let mut scene = frictional(1e-13, MU, Law::ReturnMap, Update::Frozen);
    scene.gravity = [gravity * angle.sin(), 0.0, -gravity * angle.cos()];
    let ball = Grain {
        position: [0.0; 3],
        radius: BALL,
        young: 1e7,
        poisson: 0.3,
        density: BALL_DENSITY,
        friction: MU,
        hydrate: false,
    };
    let half = [BALL + gap, 3.0 * BALL, BALL - BALL_OVERLAP];
    let bounds = centered(half.map(|half| 2.0 * half));
    (scene, Pack { bounds, grains: vec![ball], history: None })
}

/// Hertz' M of the ball at a wall and its k_s at [`BALL_OVERLAP`].
fn ball_constants() -> (f64, f64) {
    let effective = 1.0 / (0.91 / 1e7 + (1.0 - 0.495 * 0.495) / 7e12);
    let compliance = 1.7 / (1e7 / 2.6) + 1.505 / (7e12 / 2.99);
    let radius = (BALL * BALL_OVERLAP).sqrt();
    (4.0 / 3.0 * effective * BALL.sqrt(), 8.0 * radius / compliance)
}

#[test]
fn a_ball_between_tilted_plates_is_held_by_both_as_its_moments_ask() {
    let gravity = 100.0;
    let weight = 4.0 / 3.0 * PI * BALL.powi(3) * BALL_DENSITY * gravity;
    let (modulus, stiffness) = ball_constants();
    let press = modulus * BALL_OVERLAP.powf(1.5);
    for degrees in [0.0f64, 10.0, 45.0, 80.0, 90.0] {
        let angle = degrees.to_radians();
        let (scene, pack) = tilted(angle, gravity, BALL);
        let (rig, report) = Rig::start(&scene, &pack);
        let measures = report.measures.unwrap();
        // N_l - N_u = W cos and h_l + h_u = 2 h give the sinking s.
        let normal = |overlap: f64| modulus * overlap.powf(1.5);
        let sunk = root(-BALL_OVERLAP, BALL_OVERLAP, |s| {
            normal(BALL_OVERLAP + s) - normal(BALL_OVERLAP - s) - weight * angle.cos()
        });
        let [low, high] = [BALL_OVERLAP + sunk, BALL_OVERLAP - sunk];
        // Q_l + Q_u = W sin, and the moments Q_l A_l = Q_u A_u with the arms A = R - h.
        let arms = [BALL - low, BALL - high];
        let along = weight * angle.sin();
        let shear = [along * arms[1] / (arms[0] + arms[1]), along * arms[0] / (arms[0] + arms[1])];
        // Nothing slides: this is a test of sticking.
        assert!(shear[0].max(shear[1]) < MU * press);
        let allowed = 1e-11 * press;
        for (w, want) in [(4, [shear[0], 0.0, -normal(low)]), (5, [shear[1], 0.0, normal(high)])] {
            for (got, want) in measures.walls.force[w].iter().zip(want) {
                let off = (got - want).abs();
                assert!(
                    off <= allowed,
                    "{degrees} {}: {:?}",
                    wall::NAMES[w],
                    measures.walls.force[w]
                );
            }
        }
        // Slid by Q/k_s where the plates touched at the start: x - A_l Ω below, x + A_u Ω above.
        let slid = shear.map(|shear| shear / stiffness);
        let x = (arms[1] * slid[0] + arms[0] * slid[1]) / (arms[0] + arms[1]);
        let spin = (slid[1] - slid[0]) / (arms[0] + arms[1]);
        let found = rig.twin.pack();
        assert!((found.grains[0].position[0] - x).abs() <= 1e-11 * BALL_OVERLAP, "{degrees}");
        let turned = found.history.unwrap().rotation[0][1];
        assert!(
            (turned - spin).abs() * BALL <= 1e-11 * BALL_OVERLAP,
            "{degrees}: {turned:e} {spin:e}"
        );
    }
}

#[test]
fn a_ball_too_heavy_for_its_plates_slides_until_a_wall_takes_the_rest() {
    let (modulus, stiffness) = ball_constants();
    let press = modulus * BALL_OVERLAP.powf(1.5);
    let unit = 4.0 / 3.0 * PI * BALL.powi(3) * BALL_DENSITY;
    // Sticking takes 0.23 of the overlap, 0.0023 of the radius, to carry the limit. A wall that
    // touches from the start takes part before the plates give way, to the same end.
    for (share, gap) in
        [(0.99, 0.01), (1.01, 0.01), (1.5, 0.01), (3.0, 0.01), (1.5, 0.1), (1.5, 0.0)]
    {
        // W = share · 2 μP, along the plates.
        let weight = share * 2.0 * MU * press;
        let (mut scene, pack) = tilted(0.5 * PI, weight / unit, gap * BALL);
        scene.gravity[2] = 0.0;
        let (rig, report) = Rig::start(&scene, &pack);
        assert_eq!(report.disposition, Disposition::Applied, "{share}: {}", report.text);
        let walls = report.measures.unwrap().walls;
        let x = rig.twin.pack().grains[0].position[0];
        let allowed = 1e-11 * press;
        let rest = (share - 1.0).max(0.0) * 2.0 * MU * press;
        assert!(
            (walls.normal_force[1] - rest).abs() < allowed,
            "{share}: {:?}",
            walls.normal_force
        );
        for w in [4, 5] {
            let held = 0.5 * share.min(1.0) * 2.0 * MU * press;
            assert!((walls.force[w][0] - held).abs() < allowed, "{share}: {:?}", walls.force[w]);
        }
        if rest > 0.0 {
            let overlap = (rest / modulus).powf(2.0 / 3.0);
            assert!(
                (x - gap * BALL - overlap).abs() < 1e-11 * BALL_OVERLAP,
                "{share} {gap}: {x:e}"
            );
        } else {
            let want = 0.5 * weight / stiffness;
            assert!((x - want).abs() < 1e-11 * BALL_OVERLAP, "{share} {gap}: {x:e}");
        }
    }
}

/// The five-bead pyramid of tests/equilibrium/closed_forms.rs at the strain `eps`: its walls, and its beads.
fn pyramid(eps: f64) -> Pack {
    let edge = 2.0 * R * (1.0 - eps);
    let force = 4.0 / 3.0 * E_GRAINS * (0.5 * R).sqrt() * (2.0 * R * eps).powf(1.5);
    let reach = |wall_force: f64| R - wall_overlap(wall_force);
    let half = 0.5 * edge + reach(1.5 * force);
    let (low, high) = (-reach(force / SQRT_2), edge / SQRT_2 + reach(2.0 * SQRT_2 * force));
    let a = 0.5 * edge;
    let top = [0.0, 0.0, edge / SQRT_2];
    let at = [[-a, -a, 0.0], [a, -a, 0.0], [-a, a, 0.0], [a, a, 0.0], top];
    let grains = at.map(|at| Grain { friction: MU, ..bead(at, R) }).to_vec();
    Pack {
        bounds: Bounds { min: [-half, -half, low], max: [half, half, high] },
        grains,
        history: None,
    }
}

/// T 3.6.3.1: distances, walls and overlaps are all linear in eps, so each sub-increment is
/// self-similar too and no contact is sheared.
#[test]
fn a_frictional_pyramid_between_smooth_walls_is_strained_self_similarly_without_shear() {
    let first = 1e-3;
    for (law, update) in [
        (Law::ReturnMap, Update::Frozen),
        (Law::ReturnMap, Update::Current),
        (Law::Secant, Update::Frozen),
        (Law::MindlinDeresiewicz, Update::Frozen),
    ] {
        // A centre at 2R is resolved to 2R 2⁻⁵³, a force whose overlap is 1e-3 of that to 5e-13.
        let mut scene = frictional(5e-13, MU, law, update);
        scene.walls.friction = Some(0.0);
        let start = pyramid(first);
        let (mut rig, _) = Rig::start(&scene, &start);
        for eps in [2e-3, 1e-2, 5e-2] {
            let want = pyramid(eps);
            let inward =
                |w: usize| (want.bounds.position(w) - start.bounds.position(w)) * wall::inward(w);
            let measures = rig.go_quietly(std::array::from_fn(inward));
            let network = measures.network.unwrap();
            for (k, shear) in network.tangential_force.chunks(3).enumerate() {
                let share = Vec3::from_column_slice(shear).norm() / network.normal_force[k];
                assert!(share < 1e-12, "{law:?} {update:?} {eps}: {share:e} at contact {k}");
            }
            let found = rig.twin.pack();
            for i in 0..5 {
                for j in (i + 1..5).filter(|&j| (i, j) != (0, 3) && (i, j) != (1, 2)) {
                    let apart = |pack: &Pack| {
                        (Vec3::from(pack.grains[i].position) - Vec3::from(pack.grains[j].position))
                            .norm()
                    };
                    // A force that is off by 5e-13 moves a centre by 2/3 of that share of the
                    // overlap, and the walls' changes add up to a few times that.
                    close("distance", apart(&found), apart(&want), 1e-12 * eps + 1e-15);
                }
            }
        }
    }
}
