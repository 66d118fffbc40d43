//! Displacement and rotation fields of packs: every pair of grains looked at again, what increments add
//! up to, and that looking changes nothing.

use graintwin::Vec3;
use graintwin::command::{Disposition, Mode};
use graintwin::measure::motion::local::GAP;
use graintwin::pack::{Grain, Pack};
use graintwin::report::{Demand, GrainMotion, Localisation, Measures};
use graintwin::scene::{Law, Scene, Update, When};
use graintwin::twin::{Settings, Twin};
use graintwin::wall::{self, Bounds};
use nalgebra::{DMatrix, Matrix3};

use crate::packs::{Rig, absolute, centered, made, scene};
#[cfg(feature = "mcap")]
use crate::python;
use crate::rough::{MU, frictional};

/// √(½ e:e) of the Green-Lagrange strain and 1 - det F, from the stretches of `gradient`.
fn strains(gradient: &Matrix3<f64>) -> [f64; 2] {
    let stretch = gradient.singular_values();
    let principal = stretch.map(|s| 0.5 * (s * s - 1.0));
    let [a, b, c] = principal.into();
    let shear = (((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2)) / 6.0).sqrt();
    [shear, 1.0 - gradient.determinant()]
}

/// The walls after `step` steps of uneven squeezing.
fn squeezed(bounds: &Bounds, step: u32) -> [f64; wall::COUNT] {
    let strain = 2e-5 * f64::from(step);
    let [x, y, z] = bounds.sides();
    [0.0, -0.3 * x, 0.1 * y, 0.2 * y, 0.7 * z, 0.4 * z].map(|side| strain * side)
}

fn frictional_scene() -> Scene {
    moving(frictional(1e-10, MU, Law::ReturnMap, Update::Frozen))
}

/// The scene with the motion of the grains.
fn moving(mut scene: Scene) -> Scene {
    scene.outputs.grain_motion = When::OnDemand;
    scene
}

fn rough_pack(grains: usize, seed: u64) -> Pack {
    let mut pack = made(grains, 2e6, seed);
    pack.grains.iter_mut().for_each(|grain| grain.friction = MU);
    pack
}

fn motion(measures: &Measures) -> &GrainMotion {
    measures.motion.as_ref().unwrap()
}

/// D²min of every grain from all pairs, G from the singular values of the neighbours' places.
#[test]
fn in_a_pack_every_pair_looked_at_gives_the_same_local_deformation() {
    let pack = rough_pack(220, 3);
    let (mut rig, _) = Rig::start(&frictional_scene(), &pack);
    let mut floating = 0;
    for step in 1..=3 {
        let before = rig.twin.pack();
        let measures = rig.go(squeezed(&pack.bounds, step));
        let after = rig.twin.pack();
        let found = motion(&measures);
        let mean = pack.grains.iter().map(|g| g.radius).sum::<f64>() / pack.grains.len() as f64;
        floating = found.carries.iter().filter(|carries| !**carries).count();
        assert_eq!(floating, measures.state.unwrap().rattlers as usize);
        let moved: Vec<Vec3> = before
            .grains
            .iter()
            .zip(&after.grains)
            .map(|(from, to)| Vec3::from(to.position) - Vec3::from(from.position))
            .collect();
        for (i, grain) in before.grains.iter().enumerate() {
            assert_eq!(Vec3::from(found.displacement[i]), moved[i]);
            let rows: Vec<(Vec3, Vec3)> = (0..pack.grains.len())
                .filter(|&j| j != i && found.carries[j])
                .map(|j| (Vec3::from(before.grains[j].position) - Vec3::from(grain.position), j))
                .filter(|(from, j)| {
                    from.norm() < grain.radius + before.grains[*j].radius + GAP * mean
                })
                .map(|(from, j)| (from, moved[j] - moved[i]))
                .collect();
            assert_eq!(rows.len() < 4, found.d2min[i].is_nan(), "{i}");
            if rows.len() < 4 {
                continue;
            }
            let from = DMatrix::from_fn(rows.len(), 3, |row, axis| rows[row].0[axis]);
            let to = DMatrix::from_fn(rows.len(), 3, |row, axis| rows[row].1[axis]);
            let solved = from.clone().svd(true, true).solve(&to, 0.0).unwrap();
            let left = (&to - &from * &solved).norm_squared() / rows.len() as f64;
            assert!((found.d2min[i] / left - 1.0).abs() < 1e-9, "{i}: {left:e}");
            let gradient = Matrix3::from_fn(|k, l| solved[(l, k)]);
            let [shear, loss] = strains(&(Matrix3::identity() + gradient));
            // The stretches hold strains of 1e-5 to eleven digits.
            assert!((found.shear_strain[i] - shear).abs() < 1e-13, "{i}: {shear:e}");
            assert!((found.volumetric_strain[i] - loss).abs() < 1e-13, "{i}: {loss:e}");
            assert!((1e-7..1e-2).contains(&shear), "{i}: {shear:e}");
        }
    }
    assert!(floating > 0, "a pack without rattlers does not show how they are treated");
}

/// u less what the box takes along, and the numbers of the whole, written out from their definitions.
#[test]
fn the_parts_of_the_displacement_and_the_numbers_of_the_whole_are_what_they_are_defined_as() {
    let pack = rough_pack(220, 3);
    let (mut rig, _) = Rig::start(&frictional_scene(), &pack);
    let before = rig.twin.pack();
    let measures = rig.go(squeezed(&pack.bounds, 1));
    let (found, bounds) = (motion(&measures), rig.twin.pack().bounds);
    let ([from, to], low) = ([before.bounds.sides(), bounds.sides()], before.bounds.min);
    let size = pack.bounds.sides()[0];
    let (mut affine, mut non_affine, mut fourth, mut carriers) = (0.0, 0.0, 0.0, 0.0);
    let (mut turned, mut turned_fourth) = (0.0, 0.0);
    for (i, grain) in before.grains.iter().enumerate() {
        let at = grain.position;
        let carried: [f64; 3] =
            std::array::from_fn(|k| bounds.min[k] + (at[k] - low[k]) / from[k] * to[k] - at[k]);
        let rest: [f64; 3] = std::array::from_fn(|k| found.displacement[i][k] - carried[k]);
        let off = Vec3::from(found.non_affine[i]) - Vec3::from(rest);
        assert!(off.amax() < 1e-15 * size);
        if found.carries[i] {
            let middle: [f64; 3] = std::array::from_fn(|k| low[k] + 0.5 * from[k]);
            let stretched: f64 =
                (0..3).map(|k| ((to[k] / from[k] - 1.0) * (at[k] - middle[k])).powi(2)).sum();
            let squared = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
            carriers += 1.0;
            affine += stretched;
            non_affine += squared(rest);
            fourth += squared(rest).powi(2);
            turned += squared(found.rotation[i]);
            turned_fourth += squared(found.rotation[i]).powi(2);
        }
    }
    let close = |one: f64, other: f64| (one / other - 1.0).abs() < 1e-8;
    let Localisation { affine_rms, non_affine_rms, non_affine_ratio, .. } = found.localisation;
    assert!(close(affine_rms, (affine / carriers).sqrt()));
    assert!(close(non_affine_rms, (non_affine / carriers).sqrt()));
    assert!(close(non_affine_ratio, (non_affine / affine).sqrt()));
    let Localisation { rotation_rms, participation, rotation_participation, .. } =
        found.localisation;
    assert!(close(rotation_rms, (turned / carriers).sqrt()));
    assert!(close(participation, non_affine * non_affine / (carriers * fourth)));
    assert!(close(rotation_participation, turned * turned / (carriers * turned_fourth)));
    let mut d2min: Vec<f64> =
        (0..pack.grains.len()).filter(|&i| found.carries[i]).map(|i| found.d2min[i]).collect();
    d2min.retain(|d2min| !d2min.is_nan());
    d2min.sort_by(f64::total_cmp);
    let share =
        |count: usize| d2min.iter().rev().take(count).sum::<f64>() / d2min.iter().sum::<f64>();
    assert!(close(found.localisation.d2min_top_1, share(d2min.len().div_ceil(100))));
    assert!(close(found.localisation.d2min_top_10, share(d2min.len().div_ceil(10))));
}

#[test]
fn the_motions_of_all_increments_add_up_to_the_whole_way_whatever_was_refused_between() {
    let pack = rough_pack(160, 8);
    let mut scene = frictional_scene();
    scene.node.limits.clamp = true;
    scene.node.limits.strain = 5e-5;
    let (mut rig, first) = Rig::start(&scene, &pack);
    let count = pack.grains.len();
    let (mut way, mut turn) = (vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]);
    let mut measures = first.measures.unwrap();
    let mut seen = Vec::new();
    for step in 1..=5 {
        let found = motion(&measures);
        for i in 0..count {
            way[i] += Vec3::from(found.displacement[i]);
            turn[i] += Vec3::from(found.rotation[i]);
        }
        let grains = measures.grains.as_ref().unwrap();
        let size = pack.bounds.sides()[0];
        for i in 0..count {
            assert!((way[i] - Vec3::from(grains.displacement[i])).norm() < 1e-15 * size);
            assert!((turn[i] - Vec3::from(found.total_rotation[i])).norm() < 1e-17, "{i}");
        }
        // A command that is none, one on hold, and one served before change nothing.
        let held = rig.twin.motion();
        rig.sequence += 1;
        let mut none = absolute(rig.sequence, squeezed(&pack.bounds, step));
        none.mode = Mode::Unknown(7);
        assert_eq!(rig.twin.apply(&none, Demand::ALL).disposition, Disposition::Invalid);
        let [held, again] = [held, rig.twin.motion()].map(|motion| bits(&motion.unwrap()));
        assert!(again == held && held == bits(found));
        let report = rig.send(squeezed(&pack.bounds, step));
        seen.push(report.disposition);
        measures = report.measures.unwrap();
    }
    assert!(seen.contains(&Disposition::Clamped) && seen.contains(&Disposition::Applied));
    assert!(turn.iter().any(|turn| turn.norm() > 1e-6), "nothing turned");
}

#[test]
fn a_command_that_finds_no_equilibrium_leaves_the_motion_as_it_was() {
    let pack = made(120, 2e6, 4);
    let mut scene = moving(scene());
    let (mut rig, _) = Rig::start(&scene, &pack);
    rig.go(squeezed(&pack.bounds, 1));
    let before = bits(&rig.twin.motion().unwrap());
    let mut settings = Settings::of(&scene);
    settings.tolerance = 1e-30;
    rig.twin.set(&settings);
    assert_eq!(rig.send(squeezed(&pack.bounds, 2)).disposition, Disposition::NotConverged);
    assert!(bits(&rig.twin.motion().unwrap()) == before);
    // After a reset it is that of the start.
    scene.solver.tolerance = 1e-8;
    rig.twin.set(&Settings::of(&scene));
    let again = rig.twin.reset(Demand::ALL);
    let (_, first) = Rig::start(&scene, &pack);
    let [again, first] = [again, first].map(|report| bits(motion(&report.measures.unwrap())));
    assert!(again == first);
}

/// A rubber ball between two plates of which gravity, at 45° to them, pulls it: it sinks, and rolls on
/// what is sunk more.
#[test]
fn a_ball_between_plates_turns_as_the_moments_of_its_contacts_ask() {
    let (radius, overlap, density, gravity) = (0.01, 1e-4, 1100.0, 100.0);
    let mut scene = moving(frictional(1e-13, MU, Law::ReturnMap, Update::Frozen));
    let pull = gravity * 0.5f64.sqrt();
    scene.gravity = [pull, 0.0, -pull];
    let (young, poisson) = (1e7, 0.3);
    let ball =
        Grain { position: [0.0; 3], radius, young, poisson, density, friction: MU, hydrate: false };
    let half = [3.0 * radius, 3.0 * radius, radius - overlap];
    let pack = Pack { bounds: centered(half.map(|h| 2.0 * h)), grains: vec![ball], history: None };
    let (_, report) = Rig::start(&scene, &pack);
    let measures = report.measures.unwrap();
    let found = motion(&measures);
    let [x, y, z] = found.displacement[0];
    // Q_l + Q_u = W sin 45° with equal moments about the centre; each contact gave way by Q/k_s,
    // k_s = 8 a / (Σ (2 - ν)/G) of the given overlap, where x - A_l Ω and x + A_u Ω are that way.
    let [low, high] = [radius - overlap + z, radius - overlap - z];
    let along = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * density * pull;
    let compliance = 1.7 / (young / 2.6) + 1.505 / (7e12 / 2.99);
    let stiffness = 8.0 * (radius * overlap).sqrt() / compliance;
    let [slid_low, slid_high] = [high, low].map(|arm| along * arm / (low + high) / stiffness);
    let spin = (slid_high - slid_low) / (low + high);
    assert!(z < -1e-3 * overlap && y == 0.0);
    assert!((x - (slid_low + low * spin)).abs() < 1e-11 * overlap);
    let [about_x, about_y, about_z] = found.rotation[0];
    assert!((about_y - spin).abs() * radius < 1e-11 * overlap, "{about_y:e} {spin:e}");
    assert!(spin.abs() * radius > 1e-5 * overlap, "{spin:e}");
    assert_eq!([about_x, about_z], [0.0; 2]);
    assert_eq!(found.total_rotation, found.rotation);
    // Nothing stretched the box, and one grain has no neighbour.
    assert_eq!(found.non_affine, found.displacement);
    assert_eq!(found.localisation.affine_rms, 0.0);
    assert_eq!(found.localisation.participation, 1.0);
    assert!(found.localisation.non_affine_ratio.is_nan() && found.d2min[0].is_nan());
}

/// Every number of a motion.
fn bits(motion: &GrainMotion) -> Vec<u64> {
    let vectors = [&motion.displacement, &motion.non_affine, &motion.rotation]
        .into_iter()
        .chain([&motion.total_rotation]);
    let scalars = [&motion.d2min, &motion.shear_strain, &motion.volumetric_strain];
    let whole = serde_json::to_string(&motion.localisation).unwrap();
    vectors
        .flatten()
        .flatten()
        .chain(scalars.into_iter().flatten())
        .map(|number| number.to_bits())
        .chain(motion.carries.iter().map(|&carries| carries.into()))
        .chain(whole.bytes().map(u64::from))
        .collect()
}

#[test]
fn the_bits_are_the_same_on_any_number_of_threads_and_whoever_looked_before() {
    let pack = rough_pack(600, 6);
    let run = |threads: usize, looks: &[u32]| {
        let mut twin = Twin::new(&frictional_scene(), &pack, threads).unwrap();
        let demand = |step| Demand { grain_motion: looks.contains(&step), ..Demand::NONE };
        assert_eq!(twin.start(demand(0)).measures.unwrap().motion.is_some(), looks.contains(&0));
        let mut last = None;
        for step in 1..=3 {
            let command = absolute(u64::from(step), squeezed(&pack.bounds, step));
            last = twin.apply(&command, demand(step)).measures.unwrap().motion;
            assert_eq!(last.is_some(), looks.contains(&step));
        }
        (bits(&last.unwrap()), twin.digest())
    };
    let want = run(1, &[3]);
    for (threads, looks) in [(2, &[0, 1, 2, 3][..]), (7, &[3]), (1, &[1, 3])] {
        assert!(run(threads, looks) == want, "{threads} {looks:?}");
    }
}

#[test]
fn a_scene_that_forbids_it_has_no_motion_and_the_same_state() {
    let pack = rough_pack(120, 2);
    let run = |when| {
        let mut scene = frictional_scene();
        scene.outputs.grain_motion = when;
        let (mut rig, first) = Rig::start(&scene, &pack);
        let measures = rig.go(squeezed(&pack.bounds, 2));
        let both = [first.measures.unwrap(), measures];
        (both.map(|measures| measures.motion.is_some()), rig.twin.digest(), rig.twin.bytes())
    };
    let [(kept, with, more), (none, without, less)] = [When::OnDemand, When::Never].map(run);
    assert_eq!((kept, none), ([true; 2], [false; 2]));
    assert_eq!(with, without);
    // Twice a place and a rotation a grain.
    assert_eq!(more - less, 2 * 2 * 24 * pack.grains.len());
}

#[test]
fn grains_in_another_order_move_the_same() {
    let pack = rough_pack(160, 8);
    let count = pack.grains.len();
    // 7 and 160 have no common divisor.
    let place = |i: usize| (7 * i + 5) % count;
    let mut other = pack.clone();
    (0..count).for_each(|i| other.grains[place(i)] = pack.grains[i]);
    let run = |pack: &Pack| {
        let (mut rig, _) = Rig::start(&frictional_scene(), pack);
        rig.go(squeezed(&pack.bounds, 1)).motion.unwrap()
    };
    let [one, other] = [&pack, &other].map(run);
    for i in 0..count {
        let j = place(i);
        for (one, other) in [
            (&one.displacement, &other.displacement),
            (&one.non_affine, &other.non_affine),
            (&one.rotation, &other.rotation),
        ] {
            let [one, other] = [one[i], other[j]].map(Vec3::from);
            assert!((one - other).norm() <= 1e-6 * one.norm().max(1e-12), "{i}");
        }
        if !one.d2min[i].is_nan() {
            assert!((one.d2min[i] / other.d2min[j] - 1.0).abs() < 1e-5);
            assert!((one.shear_strain[i] / other.shear_strain[j] - 1.0).abs() < 1e-5);
        }
        assert_eq!(one.carries[i], other.carries[j]);
    }
    let [one, other] = [one, other].map(|motion| motion.localisation);
    for (one, other) in [
        (one.participation, other.participation),
        (one.d2min_top_10, other.d2min_top_10),
        (one.band.thickness, other.band.thickness),
    ] {
        assert!((one / other - 1.0).abs() < 1e-5);
    }
}

/// A run of the program in `folder`, recorded into `bag` there; its summary.
#[cfg(feature = "mcap")]
fn recorded(folder: &std::path::Path, scene: &str) -> serde_json::Value {
    std::fs::write(folder.join("scene.yaml"), scene).unwrap();
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_graintwin"))
        .current_dir(folder)
        .args(["run", "scene.yaml", "--record", "bag", "--json", "--threads", "1"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The same from the recording alone, by another program; and a replay gives it again.
#[cfg(feature = "mcap")]
#[test]
fn numpy_finds_the_same_in_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "pack: {generate: {grains: 400, radius: {uniform: [0.7e-3, 1.3e-3]}, \
         material: glass, confining_stress: 2.0e6}}\n\
         contact: {friction: {coefficient: 0.3}}\n\
         load_path: [uniaxial: {axis: z, strain: 1.0e-3, increments: 6}]\n\
         outputs: {grain_motion: on_demand}\n";
    let summary = recorded(folder.path(), scene);
    let end = &summary["grain_motion"];
    assert!(end["participation"].as_f64().is_some_and(|part| part > 0.0 && part < 1.0), "{end}");
    assert!(end["band"]["thickness"].as_f64().is_some_and(|thickness| thickness > 0.0), "{end}");
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_graintwin"))
        .args(["replay", "--verify"])
        .arg(folder.path().join("bag"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let Some(said) = python::run("motion.py", &[&folder.path().join("bag")], "") else { return };
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!((&said["increments"], &said["grains"]), (&6.into(), &400.into()), "{said}");
    assert!(said["floating"].as_u64().is_some_and(|floating| floating > 0), "{said}");
}

/// Without `outputs.grain_motion`: neither computed nor recorded nor in the summary, and the run is the same.
#[cfg(feature = "mcap")]
#[test]
fn a_recording_without_the_motion_verifies_and_is_of_the_same_run() {
    let scene = |more: &str| {
        format!(
            "pack: {{generate: {{grains: 60, radius: {{uniform: [0.7e-3, 1.3e-3]}}, \
             material: glass, confining_stress: 2.0e6}}}}\n\
             load_path: [uniaxial: {{axis: z, strain: 1.0e-3, increments: 3}}]\n{more}"
        )
    };
    let mut digests = Vec::new();
    for (more, messages, known) in [
        ("outputs: {grain_motion: on_demand}\n", 4, true),
        ("", 0, false),
        ("outputs: {grain_motion: on_demand}\nrecord: {exclude: [grain_motion]}\n", 0, true),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let summary = recorded(folder.path(), &scene(more));
        assert_eq!(summary["grain_motion"].is_object(), known, "{more}");
        let bag = folder.path().join("bag");
        let survey = graintwin::record::reader::Bag::open(&bag).unwrap().survey().unwrap();
        let found = survey.topics.get("/graintwin/grain_motion").map_or(0, |topic| topic.messages);
        assert_eq!(found, messages, "{more}");
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_graintwin"))
            .args(["replay", "--verify", "--json"])
            .arg(&bag)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let verdict: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        digests.push(verdict["compared"]["state"].clone());
    }
    assert!(digests[0].is_string() && digests.iter().all(|one| *one == digests[0]), "{digests:?}");
}
