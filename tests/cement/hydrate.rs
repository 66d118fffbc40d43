//! Hydrate that dissociates, against closed forms and what must hold whatever the code does.

use std::f64::consts::PI;

use graintwin::command::{Ask, Disposition};
use graintwin::pack::{Grain, Pack};
use graintwin::wall::{self, WallTarget};

use crate::hydrates::{self, HYDRATE, filled, hydrate};
use crate::packs::{GLASS, Rig, bead, by_strain, centered, close, scene_to, state};

/// Radius of the single sphere and its overlap with each wall \[m\].
const R: f64 = 1e-3;
const H: f64 = 2e-6;
/// E* of hydrate and the default walls, E_w = 7e12 Pa, ν_w = 0.495 \[Pa\].
fn effective() -> f64 {
    1.0 / ((1.0 - 0.32 * 0.32) / 6.6e9 + (1.0 - 0.495 * 0.495) / 7e12)
}

/// A sphere of hydrate between six walls.
fn ball() -> Pack {
    let ball = Grain {
        young: HYDRATE.young,
        poisson: HYDRATE.poisson,
        density: HYDRATE.density,
        hydrate: true,
        ..bead([0.0; 3], R)
    };
    Pack { bounds: centered([2.0 * (R - H); 3]), grains: vec![ball], history: None }
}

/// Hertz' force of a sphere of radius `r` on a wall at `distance`.
fn hertz(r: f64, distance: f64) -> f64 {
    4.0 / 3.0 * effective() * r.sqrt() * (r - distance).max(0.0).powf(1.5)
}

/// Volume of the sphere in the box, six caps less, over that of the box: there is no other grain.
fn saturation() -> f64 {
    let cap = PI * H * H * (3.0 * R - H) / 3.0;
    (4.0 / 3.0 * PI * R.powi(3) - 6.0 * cap) / (2.0 * (R - H)).powi(3)
}

#[test]
fn a_sphere_between_walls_shrinks_and_its_force_is_that_of_hertz() {
    let (mut rig, report) = Rig::start(&scene_to(1e-12), &ball());
    let start = hydrate(report.measures.as_ref().unwrap());
    close("saturation", start.saturation, saturation(), 1e-13);
    assert_eq!(start.present_saturation, start.saturation);
    assert_eq!(start.pore_fraction, 1.0);
    for part in [0.0005, 0.002, 0.005] {
        let measures = rig.dissociate(part * saturation(), 0.0, 0.8);
        let radius = R * (1.0 - part).powf(1.0 / 3.0);
        for force in measures.walls.normal_force {
            close("force", force, hertz(radius, R - H), 1e-9);
        }
        let now = hydrate(&measures);
        close("saturation", now.saturation, saturation() * (1.0 - part), 1e-12);
        assert_eq!(measures.walls.displacement, [0.0; wall::COUNT]);
    }
    // What is left does not reach the walls any more.
    let measures = rig.dissociate(0.01 * saturation(), 0.0, 0.8);
    assert_eq!(measures.walls.normal_force, [0.0; wall::COUNT]);
}

#[test]
fn the_pore_pressure_compresses_a_grain_by_its_bulk_modulus() {
    // K = E/(3 (1 - 2ν)) = 6.6/1.08 GPa; the table of the thesis has 6.1.
    let bulk = 6.6e9 / 1.08;
    let (mut rig, _) = Rig::start(&scene_to(1e-12), &ball());
    for pressure in [1e6, 5e6, 20e6] {
        let measures = rig.dissociate(0.0, pressure, 0.0);
        let radius = R * (1.0 - pressure / bulk).powf(1.0 / 3.0);
        for force in measures.walls.normal_force {
            close("force", force, hertz(radius, R - H), 1e-9);
        }
        let now = hydrate(&measures);
        close("saturation", now.saturation, saturation(), 1e-13);
        assert_eq!(now.pore_pressure, pressure);
        // With a Biot coefficient of 0 nothing is taken over.
        assert_eq!(now.total_stress, now.effective_stress);
    }
    // It goes back as it came.
    let measures = rig.dissociate(0.0, 0.0, 0.0);
    close("force", measures.walls.normal_force[0], hertz(R, R - H), 1e-10);
}

#[test]
fn the_pore_pressure_expands_the_box_by_the_bulk_modulus_that_the_sphere_has_by_hand() {
    let (pressure, biot) = (2e3, 0.8);
    let (mut rig, report) = Rig::start(&scene_to(1e-12), &ball());
    let force = report.measures.unwrap().walls.normal_force[0];
    // A wall's stiffness is 3/2 P/h. With both walls of a pair strained by half, dσ_l/dε_l is
    // k/(2 L), and dσ_l/dε_m is σ for the area that shrinks; K is a ninth of all nine.
    let side = 2.0 * (R - H);
    let (stiffness, stress) = (1.5 * force / H, force / side.powi(2));
    let bulk = (3.0 * stiffness / (2.0 * side) + 6.0 * stress) / 9.0;
    let out = 0.5 * side * biot * pressure / (3.0 * bulk);
    let measures = rig.dissociate(0.0, pressure, biot);
    let radius = R * (1.0 - pressure * 1.08 / 6.6e9).powf(1.0 / 3.0);
    for w in 0..wall::COUNT {
        close("wall", measures.walls.displacement[w], -out, 1e-9);
        close("force", measures.walls.normal_force[w], hertz(radius, R - H + out), 1e-9);
    }
    let now = hydrate(&measures);
    close("borne", now.total_stress - now.effective_stress, biot * pressure, 1e-9);
}

#[test]
fn what_dissolves_takes_its_weight_along_and_what_is_compressed_keeps_it() {
    let mut scene = scene_to(1e-12);
    scene.gravity = [0.0, 0.0, -1e3];
    scene.solver.tolerance = 1e-11;
    let mut pack = ball();
    // It rests on the floor, held at its sides and far from the ceiling.
    pack.bounds = centered([2.0 * (R - H), 2.0 * (R - H), 3.0 * R]);
    pack.grains[0].position[2] = -0.5 * R - 1e-7;
    let weight = 4.0 / 3.0 * PI * R.powi(3) * HYDRATE.density * 1e3;
    let (mut rig, report) = Rig::start(&scene, &pack);
    let start = report.measures.unwrap();
    close("weight", start.walls.normal_force[4], weight, 1e-9);
    let all = hydrate(&start).saturation;
    for (part, pressure) in [(0.1, 0.0), (0.1, 30e6), (0.7, 30e6), (0.7, 0.0)] {
        let measures = rig.dissociate(part * all, pressure, 0.0);
        close("weight", measures.walls.normal_force[4], (1.0 - part) * weight, 1e-9);
    }
    // The stored pack weighs the same.
    let (_, again) = Rig::start(&scene, &rig.twin.pack());
    close("weight", again.measures.unwrap().walls.normal_force[4], 0.3 * weight, 1e-9);
}

/// Shares of hydrate, of other grains and of fluid, by points thrown into the box: in an overlap the
/// disc through the circle of intersection decides, which is where both power distances are equal.
fn by_points(pack: &Pack, count: u32) -> [f64; 3] {
    let sides = pack.bounds.sides();
    let mut hits = [0_u32; 3];
    // A lattice that fills the cube evenly (powers of the plastic number's kin in three dimensions).
    let g: f64 = 1.220_744_084_605_759_5;
    for k in 1..=count {
        let at: [f64; 3] = std::array::from_fn(|axis| {
            let share = (f64::from(k) / g.powi(axis as i32 + 1)).fract();
            pack.bounds.min[axis] + share * sides[axis]
        });
        let power = |grain: &Grain| {
            let square: f64 = (0..3).map(|axis| (at[axis] - grain.position[axis]).powi(2)).sum();
            square - grain.radius.powi(2)
        };
        let inside = pack.grains.iter().map(|grain| (power(grain), grain.hydrate));
        let nearest = inside.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        hits[match nearest {
            (power, _) if power > 0.0 => 2,
            (_, true) => 0,
            (_, false) => 1,
        }] += 1;
    }
    hits.map(|hits| f64::from(hits) / f64::from(count))
}

#[test]
fn the_smallest_grains_are_hydrate_up_to_the_saturation_and_the_pack_is_in_equilibrium() {
    let pack = filled(200, 10e6, 0.22, &HYDRATE);
    let mut radii: Vec<(f64, bool)> =
        pack.grains.iter().map(|grain| (grain.radius, grain.hydrate)).collect();
    radii.sort_by(|a, b| a.0.total_cmp(&b.0));
    let number = radii.iter().filter(|(_, hydrate)| *hydrate).count();
    assert!(radii[..number].iter().all(|(_, hydrate)| *hydrate));
    for grain in &pack.grains {
        let material = if grain.hydrate { HYDRATE } else { GLASS };
        assert_eq!((grain.young, grain.poisson), (material.young, material.poisson));
        assert_eq!(grain.density, material.density);
    }
    let (_, report) = Rig::start(&scene_to(1e-8), &pack);
    assert_eq!(report.text, "");
    let measures = report.measures.unwrap();
    let stress = state(&measures).stress_walls;
    for k in [0, 4, 8] {
        close("stress", stress[k], 10e6, 1.1e-3);
    }
    let found = hydrate(&measures);
    // One grain more or less is further off.
    let grain = 4.0 / 3.0 * PI * radii[number].0.powi(3);
    let step = grain / (found.pore_fraction * pack.bounds.volume());
    assert!((found.saturation - 0.22).abs() < 0.51 * step, "{found:?} {step}");
    close("porosity", found.porosity, state(&measures).porosity, 1e-12);
    let [ice, _, fluid] = by_points(&pack, 400_000);
    close("porosity by points", found.porosity, fluid, 2e-3);
    close("pores by points", found.pore_fraction, fluid + ice, 2e-3);
    close("saturation by points", found.saturation, ice / (fluid + ice), 4e-3);
}

#[test]
fn a_grain_loses_what_the_saturation_loses_and_the_others_keep_their_volume() {
    let pack = filled(200, 10e6, 0.22, &HYDRATE);
    let (mut rig, report) = Rig::start(&scene_to(1e-8), &pack);
    let start = hydrate(&report.measures.unwrap());
    let measures = rig.dissociate(0.05, 0.0, 0.8);
    let left = 1.0 - 0.05 / start.saturation;
    let volume = |r: f64| r.powi(3);
    for (before, after) in pack.grains.iter().zip(&rig.twin.pack().grains) {
        let ratio = volume(after.radius) / volume(before.radius);
        close("volume", ratio, if before.hydrate { left } else { 1.0 }, 1e-14);
    }
    let now = hydrate(&measures);
    close("saturation", now.saturation, start.saturation - 0.05, 1e-12);
    let [ice, _, fluid] = by_points(&rig.twin.pack(), 400_000);
    close("present saturation by points", now.present_saturation, ice / (fluid + ice), 5e-3);
    close("porosity by points", now.porosity, fluid, 2e-3);
    // The box stands: what is lost of the hydrate is fluid now, but for overlaps that close or open.
    let gained = now.porosity - start.porosity;
    close("fluid", gained, 0.05 * start.pore_fraction, 3e-2);
}

#[test]
fn grains_of_one_material_that_are_compressed_are_as_a_box_that_expands() {
    // All radii shrink by one factor. A pack between walls scaled by that factor has the same
    // stresses, so a box that is expanded by its inverse has them too.
    let pack = filled(120, 5e6, 0.2, &GLASS);
    let bulk = GLASS.young / (3.0 * (1.0 - 2.0 * GLASS.poisson));
    let pressure = 10e6;
    let mut scene = scene_to(1e-11);
    scene.solver.max_strain_increment = 1e-5;
    let (mut compressed, _) = Rig::start(&scene, &pack);
    let measures = compressed.dissociate(0.0, pressure, 0.0);
    let strain = 1.0 - (1.0 - pressure / bulk).powf(-1.0 / 3.0);
    let (mut expanded, _) = Rig::start(&scene, &pack);
    let other = expanded.go(by_strain(&pack.bounds, [strain; 3]));
    assert!(measures.events.is_empty() && other.events.is_empty());
    for k in [0, 4, 8] {
        let (got, want) = (state(&measures).stress_walls[k], state(&other).stress_walls[k]);
        close("stress", got, want, 1e-9);
    }
}

/// Effective stress before and after a pore pressure on a pack of one material, and K of the state
/// before; with the Biot coefficient 1 - K/K_s that poroelasticity has for it.
fn relief(pressure: f64) -> (f64, f64, f64) {
    let pack = filled(120, 5e6, 0.2, &GLASS);
    let mut scene = scene_to(1e-12);
    scene.outputs.moduli = graintwin::scene::ModuliKind::Tangent;
    let (mut rig, report) = Rig::start(&scene, &pack);
    let start = report.measures.unwrap();
    let bulk = start.tangent.unwrap().stands.bulk;
    let solid = GLASS.young / (3.0 * (1.0 - 2.0 * GLASS.poisson));
    let measures = rig.dissociate(0.0, pressure, 1.0 - bulk / solid);
    assert!(measures.events.is_empty());
    (hydrate(&start).effective_stress, hydrate(&measures).effective_stress, bulk)
}

#[test]
fn with_the_biot_coefficient_of_the_pack_the_grains_lose_the_whole_pore_pressure() {
    // The box expands by α p/K and the grains shrink by p/K_s: the frame loses α p + K p/K_s, which
    // is p for α = 1 - K/K_s. What is left is of second order in p.
    let mut errors = Vec::new();
    for pressure in [4e3, 2e3, 1e3] {
        let (before, after, _) = relief(pressure);
        errors.push(((before - after) / pressure - 1.0).abs());
    }
    assert!(errors[2] < 1e-3, "{errors:?}");
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] - 2.0).abs() < 0.1, "{errors:?}");
    }
}

#[test]
fn without_pore_pressure_halves_are_the_whole() {
    // Smooth grains that never rearrange remember nothing: only the radii count.
    let pack = filled(120, 10e6, 0.22, &HYDRATE);
    let course = |losses: &[f64]| {
        let (mut rig, _) = Rig::start(&scene_to(1e-11), &pack);
        let all: Vec<_> = losses.iter().map(|&loss| rig.dissociate(loss, 0.0, 0.8)).collect();
        assert!(all.iter().all(|measures| measures.events.is_empty()));
        all.last().unwrap().walls.normal_force
    };
    let (whole, halves) = (course(&[2e-4]), course(&[1e-4, 2e-4]));
    for w in 0..wall::COUNT {
        close("force", halves[w], whole[w], 1e-9);
    }
}

#[test]
fn with_pore_pressure_halves_differ_from_the_whole_by_a_second_order() {
    let pack = filled(120, 10e6, 0.22, &HYDRATE);
    let stress = |pressures: &[f64]| {
        let (mut rig, _) = Rig::start(&scene_to(1e-12), &pack);
        let all: Vec<_> = pressures.iter().map(|&p| rig.dissociate(0.0, p, 0.8)).collect();
        assert!(all.iter().all(|measures| measures.events.is_empty()));
        hydrate(all.last().unwrap()).effective_stress
    };
    let start = 10e6;
    let difference = |p: f64| (stress(&[p]) - stress(&[0.5 * p, p])).abs();
    let (one, half) = (difference(2e4), difference(1e4));
    assert!((one / half - 4.0).abs() < 0.4, "{one} {half}");
    assert!(one < 1e-3 * (start - stress(&[2e4])).abs(), "{one}");
}

#[test]
fn energy_that_goes_with_the_grains_is_not_counted_as_dissipated() {
    let pack = filled(120, 10e6, 0.22, &HYDRATE);
    let left = |strain_increment: f64| {
        let mut scene = scene_to(1e-11);
        scene.solver.max_strain_increment = strain_increment;
        let (mut rig, report) = Rig::start(&scene, &pack);
        let start = state(&report.measures.unwrap()).stored_energy;
        let measures = rig.dissociate(2e-4, 2e4, 0.8);
        assert!(measures.events.is_empty());
        let now = state(&measures);
        (now.dissipated_energy / (start - now.stored_energy)).abs()
    };
    // The trapezoidal rule is of second order in the parts.
    let (coarse, fine) = (left(4e-5), left(2e-5));
    assert!(coarse < 1e-4, "{coarse}");
    assert!((coarse / fine - 4.0).abs() < 1.0, "{coarse} {fine}");
}

#[test]
fn walls_under_a_load_keep_it_and_settle() {
    let pack = filled(120, 10e6, 0.22, &HYDRATE);
    let (mut rig, _) = Rig::start(&scene_to(1e-8), &pack);
    let loads = Ask::Targets([WallTarget::Stress(10e6); wall::COUNT]);
    let before = rig.ask(loads).measures.unwrap().walls.displacement;
    let measures = rig.dissociate(0.01, 0.0, 0.8);
    for k in [0, 4, 8] {
        close("stress", state(&measures).stress_walls[k], 10e6, 1e-7);
    }
    for axis in 0..3 {
        let closing = |walls: &[f64; wall::COUNT]| walls[2 * axis] + walls[2 * axis + 1];
        assert!(closing(&measures.walls.displacement) > closing(&before));
    }
    // A pore pressure has no wall to move, unless it only compresses the grains.
    let report = rig.ask(hydrates::dissociation(0.01, 1e5, 0.8));
    assert_eq!(report.disposition, Disposition::Invalid);
    assert!(report.text.contains("x_min carries a load"), "{}", report.text);
    let measures = rig.dissociate(0.01, 1e5, 0.0);
    close("stress", state(&measures).stress_walls[0], 10e6, 1e-7);
}
