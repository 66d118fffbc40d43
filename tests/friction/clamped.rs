//! A bead that two plates press and two walls push between them, against closed forms: it sticks,
//! slides, turns back, and is pressed and let go on the way.

use graintwin::Vec3;
use graintwin::pack::Pack;
use graintwin::report::Measures;
use graintwin::scene::{Law, Update};
use graintwin::wall;

use crate::packs::{Rig, bead, centered, close, state};
use crate::rough::{MU, R, frictional, root, wall_modulus, wall_overlap};

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
        let (mut rig, _) =
            Rig::start(&frictional(1e-13, MU, law, Update::Frozen), &Clamped::pack());
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
    let (mut rig, _) =
        Rig::start(&frictional(1e-13, MU, Law::ReturnMap, Update::Frozen), &Clamped::pack());
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

/// As [`Clamped::walls`], with floor and ceiling moved inwards by `press` \[m\].
fn pressed(to: f64, press: f64) -> [f64; wall::COUNT] {
    let mut walls = Clamped::walls(to);
    walls[4..].fill(press);
    walls
}

fn plate_force(overlap: f64) -> f64 {
    wall_modulus() * overlap.powf(1.5)
}

#[test]
fn without_a_limit_a_clamped_bead_never_slides() {
    let mut closed = Clamped::new();
    for law in [Law::ReturnMap, Law::Secant, Law::MindlinDeresiewicz] {
        let scene = frictional(1e-13, f64::INFINITY, law, Update::Frozen);
        let (mut rig, _) = Rig::start(&scene, &Clamped::pack());
        for share in [1.0, 5.0, -5.0, 0.0] {
            let to = share * PRESSED;
            let measures = rig.go_quietly(Clamped::walls(to));
            // P_x = 2 k_s d with M (D - d)^1.5 = P_x.
            let d = root(-10.0 * PRESSED, 10.0 * PRESSED, |d| {
                2.0 * closed.stiffness * d - plate_force((to - d).abs()).copysign(to - d)
            });
            let want = 2.0 * closed.stiffness * d;
            let off = (x_force(&measures) - want).abs();
            assert!(off <= 1e-11 * closed.press, "{law:?} {share}: {}", x_force(&measures));
            assert_eq!(state(&measures).sliding_ratio, 0.0);
            assert!(state(&measures).slip_energy.abs() <= 1e-11 * closed.press * PRESSED);
        }
    }
    closed.go(5.0 * PRESSED);
    assert!(closed.heat > 0.0, "with a limit it would slide");
}

#[test]
fn a_sliding_bead_is_held_by_the_present_press_or_by_that_before_the_increment() {
    for law in [Law::ReturnMap, Law::Secant, Law::MindlinDeresiewicz] {
        for update in [Update::Frozen, Update::Current] {
            let mut scene = frictional(1e-11, MU, law, update);
            // One sub-increment a command.
            scene.solver.max_strain_increment = 0.1;
            scene.solver.max_overlap_share = 100.0;
            let (mut rig, _) = Rig::start(&scene, &Clamped::pack());
            let mut before = PRESSED;
            for (to, press) in [(3.0, 0.0), (4.0, 0.1), (5.0, 0.3), (6.0, 0.2), (7.0, -0.1)] {
                let measures = rig.go_quietly(pressed(to * PRESSED, press * PRESSED));
                let now = PRESSED * (1.0 + press);
                let limiting = if update == Update::Frozen { before } else { now };
                let want = 2.0 * MU * plate_force(limiting);
                close("push", x_force(&measures), want, 1e-10);
                close("press", measures.walls.normal_force[4], plate_force(now), 1e-11);
                // The defect is what the present press would change of it.
                let defect = MU * (plate_force(now) - plate_force(limiting)).abs();
                let found = state(&measures).friction_defect * state(&measures).mean_normal_force;
                assert!((found - defect).abs() <= 1e-10 * want, "{update:?}: {found:e} {defect:e}");
                before = now;
            }
        }
    }
}

#[test]
fn a_bead_that_is_let_go_forgets_its_shear_and_begins_anew() {
    let mut scene = frictional(1e-13, MU, Law::ReturnMap, Update::Frozen);
    scene.solver.max_strain_increment = 0.1;
    scene.solver.max_overlap_share = 100.0;
    let mut closed = Clamped::new();
    let (mut rig, _) = Rig::start(&scene, &Clamped::pack());
    let to = 0.5 * PRESSED;
    let measures = rig.go_quietly(Clamped::walls(to));
    let (push, d) = closed.go(to);
    close("push", x_force(&measures), push, 1e-11);
    let sheared = state(&measures);
    // Two contacts with Q = P_x/2 store Q²/(2 k_s) each.
    let energy = 0.25 * push * push / closed.stiffness;
    close("energy", sheared.shear_energy, energy, 1e-11);

    // The plates part, and with them the wall that pushed.
    let open = rig.send(pressed(0.0, -1.5 * PRESSED));
    assert_eq!(open.text, "no grain carries load");
    let measures = open.measures.unwrap();
    let gone = state(&measures);
    assert_eq!(measures.walls.normal_force, [0.0; wall::COUNT]);
    assert_eq!((gone.shear_energy, gone.contacts), (0.0, 0));
    close("renewal", gone.renewal_energy - sheared.renewal_energy, energy, 1e-10);
    // Floor and ceiling, and the wall x_min that touched too.
    assert_eq!(gone.opened, 3);

    // Closed again, the bead lies where it is and carries P_z alone.
    let again = state(&rig.go(pressed(0.0, 0.0)));
    assert!((rig.twin.pack().grains[0].position[0] - d).abs() < PRESSED);
    assert_eq!((again.shear_energy, again.formed), (0.0, 2));
}
