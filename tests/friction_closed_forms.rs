//! Specimens with friction whose equilibrium is known in closed form. The stiffnesses are written
//! out here from Hertz' and Mindlin's formulas, the balances are derived beside each test.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "common/packs.rs"]
mod packs;

use std::f64::consts::{PI, SQRT_2};

use graintwin::Vec3;
use graintwin::command::Disposition;
use graintwin::pack::{Grain, Pack};
use graintwin::report::Measures;
use graintwin::scene::{Coulomb, Friction, Law, Scene, Update};
use graintwin::wall::{self, Bounds};
use packs::{E_GRAINS, E_WALL, Rig, bead, centered, close, scene_to, state};

/// Radius of the beads \[m\].
const R: f64 = 1e-4;
const MU: f64 = 0.3;

fn frictional(tolerance: f64, law: Law) -> Scene {
    let mut scene = scene_to(tolerance);
    let coulomb = Coulomb { coefficient: MU, law, update: Update::Frozen };
    scene.contact.friction = Friction::Coulomb(coulomb);
    scene
}

/// Hertz' M of a bead at a wall \[N/m^1.5\].
fn wall_modulus() -> f64 {
    4.0 / 3.0 * E_WALL * R.sqrt()
}

/// Overlap of a bead and a wall that carries `force` \[m\].
fn wall_overlap(force: f64) -> f64 {
    (force / wall_modulus()).powf(2.0 / 3.0)
}

/// Where `f` rises through zero between `low` and `high`, by halving to the last bit.
fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    assert!(f(low) <= 0.0 && f(high) >= 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        *(if f(middle) < 0.0 { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

/// A bead pressed between floor and ceiling, and the two x walls that push it to and fro.
///
/// It moves by d along x and does not turn: floor and ceiling answer with the same force Q at the
/// same arm. A wall x_min that moved inwards by D pushes it with P_x = M (D - d)^1.5, so
/// P_x = 2 Q. P_z stays, so k_s and μP_z do, and however an increment is divided
/// Q = k_s (d - d_slip) up to μP_z.
struct Clamped {
    /// P_z \[N\].
    press: f64,
    /// k_s \[N/m\]: 8 a / ((2 - ν)/G + (2 - ν_w)/G_w) with a = √(R h), G = E/(2 (1 + ν)).
    stiffness: f64,
    /// d at which the contacts carry nothing \[m\].
    slipped: f64,
    /// Energy that slip took \[J\].
    heat: f64,
}

/// Overlap at floor and ceiling \[m\].
const PRESSED: f64 = 0.01 * R;

impl Clamped {
    fn new() -> Self {
        let compliance = 1.8 / (70e9 / 2.4) + 1.505 / (7e12 / 2.99);
        Self {
            press: wall_modulus() * PRESSED.powf(1.5),
            stiffness: 8.0 * (R * PRESSED).sqrt() / compliance,
            slipped: 0.0,
            heat: 0.0,
        }
    }

    fn pack() -> Pack {
        let sides = [2.0 * R, 6.0 * R, 2.0 * (R - PRESSED)];
        Pack { bounds: centered(sides), grains: vec![bead([0.0; 3], R)], history: None }
    }

    /// Both x walls moved to the side by `to`, so that the bead is always between them.
    fn walls(to: f64) -> [f64; wall::COUNT] {
        [to, -to, 0.0, 0.0, 0.0, 0.0]
    }

    /// Moves the walls by `to`: the force of x_min less that of x_max, and d.
    fn go(&mut self, to: f64) -> (f64, f64) {
        let most = MU * self.press;
        let push = |gap: f64| wall_modulus() * gap.abs().powf(1.5) * gap.signum();
        let excess = |d: f64| 2.0 * self.stiffness * (d - self.slipped) - push(to - d);
        let stuck = root(-10.0 * PRESSED, 10.0 * PRESSED, excess);
        let shear = self.stiffness * (stuck - self.slipped);
        if shear.abs() <= most {
            return (2.0 * shear, stuck);
        }
        let limited = most.copysign(shear);
        let d = to - wall_overlap(2.0 * most).copysign(shear);
        let slipped = d - limited / self.stiffness;
        self.heat += 2.0 * most * (slipped - self.slipped).abs();
        self.slipped = slipped;
        (2.0 * limited, d)
    }
}

fn x_force(measures: &Measures) -> f64 {
    measures.walls.normal_force[0] - measures.walls.normal_force[1]
}

#[test]
fn a_clamped_bead_sticks_slides_and_turns_back_as_its_two_contacts_allow() {
    let unit = PRESSED;
    // Loads to sticking, to sliding, on, back through zero, to sliding the other way, and again.
    let path = [0.3, 0.8, 0.9, 1.0, 1.5, 2.0, 1.9, 1.4, 1.0, 0.5, -0.5, -2.0, -1.0, 0.0, 1.0, 2.0];
    for law in [Law::ReturnMap, Law::Secant] {
        let mut closed = Clamped::new();
        let (mut rig, _) = Rig::start(&frictional(1e-13, law), &Clamped::pack());
        let mut sliding = 0;
        for share in path {
            let measures = rig.go_quietly(Clamped::walls(share * unit));
            let (push, d) = closed.go(share * unit);
            let what = format!("{law:?} at {share}");
            // The residual: 1e-13 of the mean force, times a hundred sub-increments at most.
            let allowed = 1e-11 * closed.press;
            assert!((x_force(&measures) - push).abs() <= allowed, "{what}: {}", x_force(&measures));
            let found = rig.twin.pack();
            assert!((found.grains[0].position[0] - d).abs() <= 1e-11 * unit, "{what}");
            let turned = Vec3::from(found.history.unwrap().rotation[0]).norm();
            assert!(turned * R <= 1e-11 * unit, "{what}: turned by {turned:e}");
            // Floor and ceiling take half of the push each, along it, and P_z.
            for (w, down) in [(4, -1.0), (5, 1.0)] {
                let want = [0.5 * push, 0.0, down * closed.press];
                for (got, want) in measures.walls.force[w].iter().zip(want) {
                    assert!((got - want).abs() <= allowed, "{what}: {:?}", measures.walls.force[w]);
                }
            }
            let at_limit = push.abs() >= 2.0 * MU * closed.press * (1.0 - 1e-3);
            sliding += u32::from(at_limit);
            let ratio = state(&measures).sliding_ratio * f64::from(state(&measures).contacts);
            // The contact of the x wall is never sheared.
            assert_eq!(ratio.round() as u32, if at_limit { 2 } else { 0 }, "{what}");
        }
        assert!((4..12).contains(&sliding), "{sliding}");
    }
}

#[test]
fn the_loop_of_a_clamped_bead_loses_what_its_slip_takes() {
    let mut closed = Clamped::new();
    let (mut rig, _) = Rig::start(&frictional(1e-13, Law::ReturnMap), &Clamped::pack());
    let ends = [3.0, -3.0, 3.0, -3.0].map(|share| share * PRESSED);
    let mut loops = Vec::new();
    for to in ends {
        let measures = rig.go_quietly(Clamped::walls(to));
        closed.go(to);
        close("heat", state(&measures).slip_energy, closed.heat, 1e-10);
        loops.push((state(&measures), closed.heat));
    }
    // From one end to the other the two contacts slip by the way of the bead less the way back to
    // the other limit: ∮ P_x dD = 2 μP_z · 2 (2 d - 2 μP_z/k_s), d = 3 h - (2 μP_z/M)^(2/3).
    let most = MU * closed.press;
    let d = 3.0 * PRESSED - wall_overlap(2.0 * most);
    let area = 2.0 * most * 2.0 * (2.0 * d - 2.0 * most / closed.stiffness);
    let (first, last) = (loops[1].0, loops[3].0);
    close("slip", last.slip_energy - first.slip_energy, area, 1e-10);
    // The work of the walls is trapezoidal. On a monotone branch that is off by half a step times
    // the rise of the force at most; a step is 1e-4 of the box over two walls, a branch 4 μP_z.
    let step = 0.5 * 1e-4 * 2.0 * R;
    let allowed = 2.0 * 0.5 * step * 4.0 * most;
    let lost = last.dissipated_energy - first.dissipated_energy;
    assert!((lost - area).abs() <= allowed, "{lost:e} {area:e} {allowed:e}");
    assert!(allowed < 0.01 * area);
    // A closed loop stores nothing.
    close("stored", last.stored_energy, first.stored_energy, 1e-11);
}

/// Rubber balls of 10 mm, whose weight is a tenth of what presses them.
const BALL: f64 = 0.01;
const BALL_DENSITY: f64 = 1100.0;
const BALL_OVERLAP: f64 = 1e-4;

/// A ball between two plates across z, its weight at `angle` from their normal.
fn tilted(angle: f64, gravity: f64, gap: f64) -> (Scene, Pack) {
    let mut scene = frictional(1e-13, Law::ReturnMap);
    scene.gravity = [gravity * angle.sin(), 0.0, -gravity * angle.cos()];
    let ball = Grain {
        position: [0.0; 3],
        radius: BALL,
        young: 1e7,
        poisson: 0.3,
        density: BALL_DENSITY,
        friction: MU,
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

/// The five-bead pyramid of tests/closed_forms.rs at the strain `eps`: its walls, and its beads.
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
        let mut scene = frictional(5e-13, law);
        scene.contact.friction = Friction::Coulomb(Coulomb { coefficient: MU, law, update });
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
