//! Recordings as independent readers see them: the Python packages mcap-ros2-support and rosbags.

use std::path::Path;
use std::sync::Arc;

use graintwin::command::Stamp;
use graintwin::measure::discrepancy::Discrepancy;
use graintwin::msg::rcl::{Log, Parameter, ParameterEvent, ParameterValue};
use graintwin::msg::{
    DiagnosticArray, DiagnosticStatus, Duration, Header, JointState, JointTrajectory,
    JointTrajectoryPoint, KeyValue, Vector3, Wrench, WrenchStamped, convert,
};
use graintwin::record::{Recorded, Recorder};
use graintwin::report::{AngularForm, Crack, Measures, TangentModuli};
use graintwin::scene::{Compression, Record};
use graintwin::sink::{Beside, Recording, Served, Sink};
use graintwin::wall;
use serde_json::{Map, Value, json};

use crate::answers::{answers, provenance};
use crate::python;

fn record(folder: &Path, settings: &Record, answers: &[Arc<Served>]) -> Recorded {
    let mut recorder = Recorder::create(folder, settings, &provenance()).unwrap();
    for answer in answers {
        recorder.served(answer);
    }
    recorder.finish().unwrap()
}

fn number(value: f64) -> Value {
    if value.is_finite() {
        value.into()
    } else {
        (if value.is_nan() { "NaN" } else { "Infinity" }).into()
    }
}

fn numbers(values: &[f64]) -> Value {
    values.iter().copied().map(number).collect()
}

fn header(stamp: Stamp, frame: &str) -> Value {
    json!({"stamp": {"sec": stamp.sec, "nanosec": stamp.nanosec}, "frame_id": frame})
}

fn message(topic: &str, fields: &Value) -> Value {
    json!({"topic": format!("/graintwin/{topic}"), "fields": fields})
}

/// The messages that one answer must become, from the answer's own words.
fn expected(served: &Served) -> Vec<Value> {
    let mut messages = Vec::new();
    if let Some(command) = &served.command {
        messages.push(message(
            "boundary_command",
            &json!({
                "header": header(command.stamp, "pack"),
                "session": command.session,
                "sequence": command.sequence,
                "mode": u8::from(command.mode),
                "displacement": command.ask.numbers(),
            }),
        ));
    }
    let report = &served.report;
    if let Some(measures) = &report.measures {
        messages.extend(served.command.is_none().then(|| expected_frames(measures)));
        messages.extend(expected_measures(measures));
    }
    messages.push(message(
        "report",
        &json!({
            "header": header(report.stamp, "pack"),
            "session": report.session,
            "sequence": report.sequence,
            "increment": report.increment,
            "disposition": report.disposition as u8,
            "substeps": report.substeps,
            // The answers that were made up have no text where they have measures.
            "text": match report.measures {
                Some(_) => "wall forces within 2.5e-9 N of the exact equilibrium",
                None => &report.text,
            },
        }),
    ));
    messages
}

/// The frames: two roots, and the walls where they are.
fn expected_frames(measures: &Measures) -> Value {
    let [x_min, x_max, y_min, y_max, z_min, z_max] = measures.walls.position;
    let (x, y, z) = (0.5 * (x_min + x_max), 0.5 * (y_min + y_max), 0.5 * (z_min + z_max));
    let origins =
        [[x_min, y, z], [x_max, y, z], [x, y_min, z], [x, y_max, z], [x, y, z_min], [x, y, z_max]];
    let transforms = origins.iter().zip(wall::NAMES).map(|(origin, name)| {
        json!({
            "header": header(measures.stamp, "pack"),
            "child_frame_id": format!("wall_{name}"),
            "transform": {
                "translation": origin,
                "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            },
        })
    });
    let roots = ["pack", "pack_view"].map(|name| {
        json!({
            "header": header(measures.stamp, "world"),
            "child_frame_id": name,
            "transform": {
                "translation": [0.0, 0.0, 0.0],
                "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            },
        })
    });
    let transforms: Vec<_> = roots.into_iter().chain(transforms).collect();
    json!({"topic": "/tf_static", "fields": {"transforms": transforms}})
}

fn expected_measures(measures: &Measures) -> Vec<Value> {
    let common = |frame: &str| json!({"header": header(measures.stamp, frame), "increment": measures.increment});
    let walls = &measures.walls;
    let mut messages =
        vec![message("wall_forces", &merged(common("pack"), serde_json::to_value(walls).unwrap()))];
    for (index, name) in wall::NAMES.iter().enumerate() {
        messages.push(message(
            &format!("wall/{name}/wrench"),
            &json!({
                "header": header(measures.stamp, &format!("wall_{name}")),
                "wrench": {"force": walls.force[index], "torque": walls.moment[index]},
            }),
        ));
    }
    messages.push(message(
        "wall_states",
        &json!({
            "header": header(measures.stamp, "pack"),
            "name": ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"],
            "position": walls.displacement,
            "velocity": [],
            "effort": walls.normal_force,
        }),
    ));
    let state = serde_json::to_value(measures.state.unwrap()).unwrap();
    messages.push(message("state", &merged(common("pack"), state)));
    let moduli = measures.moduli.unwrap();
    messages.push(message(
        "moduli",
        &merged(
            common("pack"),
            json!({
                "valid": moduli.valid,
                "bulk": number(moduli.bulk),
                "shear": number(moduli.shear),
                "young": number(moduli.young),
                "poisson": number(moduli.poisson),
                "lame": number(moduli.lame),
                "p_wave": number(moduli.p_wave),
                "tangent": numbers(&moduli.tangent),
            }),
        ),
    ));
    let tangent = measures.tangent.unwrap();
    let part = |of: &TangentModuli| {
        json!({
            "valid": of.valid,
            "error": number(of.error),
            "relaxed": numbers(&of.relaxed),
            "affine": numbers(&of.affine),
            "wall_stiffness": numbers(&of.wall_stiffness.concat()),
            "bulk": number(of.bulk),
            "shear": number(of.shear),
            "young": number(of.young),
            "poisson": number(of.poisson),
            "lame": number(of.lame),
            "p_wave": number(of.p_wave),
            "shear_pairs": numbers(&of.shear_pairs),
            "p_speed": numbers(&of.p_speed),
            "s_speed": numbers(&of.s_speed),
            "isotropy_index": number(of.isotropy_index),
        })
    };
    messages.push(message(
        "tangent",
        &merged(
            common("pack"),
            json!({
                "density": number(tangent.density),
                "products": tangent.products,
                "stands": part(&tangent.stands),
                "sticks": part(&tangent.sticks),
            }),
        ),
    ));
    let network = measures.network.as_ref().unwrap();
    messages.push(message(
        "contact_network",
        &merged(
            common("pack"),
            json!({
                "chunk": 0,
                "chunk_count": 1,
                "first": network.first,
                "second": network.second,
                "normal": network.normal,
                "normal_force": network.normal_force,
                "tangential_force": network.tangential_force,
                "overlap": network.overlap,
                "state": network.state,
            }),
        ),
    ));
    let motion = measures.motion.as_ref().unwrap();
    let whole = &motion.localisation;
    messages.push(message(
        "grain_motion",
        &merged(
            common("pack"),
            json!({
                "chunk": 0,
                "chunk_count": 1,
                "first_grain": 0,
                "displacement": motion.displacement.concat(),
                "non_affine": motion.non_affine.concat(),
                "rotation": motion.rotation.concat(),
                "total_rotation": motion.total_rotation.concat(),
                "d2min": motion.d2min,
                "shear_strain": motion.shear_strain,
                "volumetric_strain": motion.volumetric_strain,
                "carries": motion.carries,
                "affine_rms": whole.affine_rms,
                "non_affine_rms": whole.non_affine_rms,
                "non_affine_ratio": whole.non_affine_ratio,
                "rotation_rms": number(whole.rotation_rms),
                "participation": whole.participation,
                "rotation_participation": number(whole.rotation_participation),
                "d2min_top_1": whole.d2min_top_1,
                "d2min_top_10": whole.d2min_top_10,
                "band_center": whole.band.center,
                "band_normal": whole.band.normal,
                "band_spread": whole.band.spread,
                "band_thickness": whole.band.thickness,
            }),
        ),
    ));
    messages.push(message("fabric", &merged(common("pack"), expected_fabric(measures))));
    messages.push(message("bonds", &merged(common("pack"), expected_bonds(measures))));
    messages.push(message("cracks", &merged(common("pack"), expected_cracks(measures))));
    for event in &measures.events {
        messages.push(message(
            "events",
            &merged(
                common("pack"),
                json!({
                    "kind": 0,
                    "stress_before": event.stress_before,
                    "stress_after": event.stress_after,
                    "grains": event.grains,
                    "displacement": event.displacement,
                }),
            ),
        ));
    }
    for (number, event) in measures.rearrangements.iter().enumerate() {
        let bodies = |pairs: &[[u32; 2]], body: usize| {
            pairs.iter().map(|pair| pair[body]).collect::<Vec<_>>()
        };
        messages.push(message(
            "rearrangements",
            &merged(
                common("pack"),
                json!({
                    "event": number,
                    "chunk": 0,
                    "chunk_count": 1,
                    "kind": 0,
                    "stress_before": event.stress_before,
                    "stress_after": event.stress_after,
                    "energy_before": event.energy_before,
                    "energy_after": event.energy_after,
                    "grains": event.grains,
                    "displacement": event.displacement.as_flattened(),
                    "rotation": event.rotation.as_flattened(),
                    "lost_first": bodies(&event.lost, 0),
                    "lost_second": bodies(&event.lost, 1),
                    "made_first": bodies(&event.made, 0),
                    "made_second": bodies(&event.made, 1),
                }),
            ),
        ));
    }
    for snapshot in &measures.snapshots {
        messages.push(message(
            "snapshots",
            &merged(
                common("pack"),
                json!({
                    "event": snapshot.event,
                    "when": snapshot.end as u8,
                    "wall_position": snapshot.wall_position,
                    "position": snapshot.position.as_flattened(),
                    "rotation": snapshot.rotation.as_flattened(),
                }),
            ),
        ));
    }
    messages
}

/// The bonds, whole.
fn expected_bonds(measures: &Measures) -> Value {
    let bonds = measures.bonds.as_ref().unwrap();
    json!({
        "chunk": 0,
        "chunk_count": 1,
        "tensile_strength": bonds.tensile_strength,
        "shear_strength": number(bonds.shear_strength),
        "first": bonds.first,
        "second": bonds.second,
        "condition": bonds.condition,
        "share": bonds.share,
        "radius": bonds.radius,
        "position": bonds.position,
        "normal": bonds.normal,
        "normal_force": bonds.normal_force,
        "tangential_force": bonds.tangential_force,
        "torsion": bonds.torsion,
        "strength_use": bonds.strength_use,
    })
}

/// The cracks, field by field.
fn expected_cracks(measures: &Measures) -> Value {
    let cracks = measures.cracks.as_ref().unwrap();
    let each = |of: &dyn Fn(&Crack) -> Value| cracks.list.iter().map(of).collect::<Value>();
    let vectors = |of: fn(&Crack) -> [f64; 3]| cracks.list.iter().flat_map(of).collect::<Value>();
    json!({
        "chunk": 0,
        "chunk_count": 1,
        "intact": cracks.intact,
        "broken_by_tension": cracks.tension,
        "broken_by_shear": cracks.shear,
        "first": each(&|crack| crack.first.into()),
        "second": each(&|crack| crack.second.into()),
        "mode": each(&|crack| (crack.mode as u8).into()),
        "substep": each(&|crack| crack.substep.into()),
        "position": vectors(|crack| crack.position),
        "normal": vectors(|crack| crack.normal),
        "normal_force": each(&|crack| crack.normal_force.into()),
        "tangential_force": each(&|crack| crack.tangential_force.into()),
        "torsion": each(&|crack| crack.torsion.into()),
        "overload": each(&|crack| crack.overload.into()),
        "stress_before": each(&|crack| crack.stress_before.into()),
        "stress_after": each(&|crack| crack.stress_after.into()),
        "energy_released": each(&|crack| crack.energy_released.into()),
    })
}

/// The statistics of the force network, flat.
fn expected_fabric(measures: &Measures) -> Value {
    let fabric = measures.fabric.as_ref().unwrap();
    let (directions, chains, angle) = (&fabric.directions, &fabric.chains, &fabric.angle);
    let form = |form: &AngularForm| [form.lateral, form.axial, form.shear];
    let fields = json!({
        "contacts": fabric.contacts,
        "grain_contacts": fabric.grain_contacts,
        "mean_normal_force": fabric.mean_normal_force,
        "mean_tangential_force": fabric.mean_tangential_force,
        "chain_share": chains.share,
        "chain_threshold": chains.threshold,
        "chain_contacts": chains.contacts,
        "chain_grains": chains.grains,
        "chains": chains.count,
        "largest_chain": chains.largest,
        "chain_load": chains.load,
        "chain_spans": chains.spans,
        "strongest_path": chains.strongest_path,
        "force_histogram": fabric.force_histogram,
        "mobilised_histogram": fabric.mobilised_histogram,
        "angle_count": angle.count,
        "angle_normal": numbers(&angle.normal),
        "angle_tangential": numbers(&angle.tangential),
        "angle_shear": numbers(&angle.shear),
        "angle_fitted": form(&angle.fitted),
        "angle_predicted": form(&angle.predicted),
        "coordination": fabric.coordination.all,
        "interior_coordination": fabric.coordination.interior,
    });
    merged(serde_json::to_value(directions).unwrap(), fields)
}

fn merged(one: Value, other: Value) -> Value {
    let (Value::Object(mut fields), Value::Object(more)) = (one, other) else { panic!("objects") };
    fields.extend(more);
    Value::Object(fields)
}

/// Records `answers` and lets the peers read; what they say, if there are any.
fn read_by_peers(
    name: &str,
    settings: &Record,
    answers: &[Arc<Served>],
) -> Option<Map<String, Value>> {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join(name);
    let recorded = record(&folder, settings, answers);
    let messages: Vec<Vec<Value>> = answers.iter().map(|answer| expected(answer)).collect();
    assert_eq!(recorded.messages, messages.concat().len() as u64);
    peers_find(&folder, messages)
}

/// Lets the peers read the bag, which must hold `messages`; what they say, if there are any.
fn peers_find(folder: &Path, messages: Vec<Vec<Value>>) -> Option<Map<String, Value>> {
    let texts = Path::new(env!("CARGO_MANIFEST_DIR")).join("msgs/graintwin_msgs/msg");
    let said = python::run("bag.py", &[folder, &texts], &Value::from_iter(messages).to_string())?;
    Some(serde_json::from_str(&said).unwrap())
}

#[test]
fn two_independent_readers_find_every_field_of_every_message() {
    let Some(said) = read_by_peers("run", &Record::default(), &answers(12, 40)) else { return };
    let topics: Vec<_> =
        said["topics"].as_array().unwrap().iter().map(|one| one.as_str().unwrap()).collect();
    assert_eq!(
        topics,
        [
            "/diagnostics",
            "/graintwin/bonds",
            "/graintwin/boundary_command",
            "/graintwin/circumstance",
            "/graintwin/contact_network",
            "/graintwin/cracks",
            "/graintwin/discrepancy",
            "/graintwin/dissociation",
            "/graintwin/events",
            "/graintwin/fabric",
            "/graintwin/grain_motion",
            "/graintwin/grains",
            "/graintwin/hydrate",
            "/graintwin/joint_states",
            "/graintwin/joint_trajectory",
            "/graintwin/markers",
            "/graintwin/measured_wrench/x_max",
            "/graintwin/measured_wrench/x_min",
            "/graintwin/measured_wrench/y_max",
            "/graintwin/measured_wrench/y_min",
            "/graintwin/measured_wrench/z_max",
            "/graintwin/measured_wrench/z_min",
            "/graintwin/moduli",
            "/graintwin/plane_state",
            "/graintwin/rearrangements",
            "/graintwin/report",
            "/graintwin/shear_command",
            "/graintwin/shear_state",
            "/graintwin/snapshots",
            "/graintwin/state",
            "/graintwin/tangent",
            "/graintwin/wall/x_max/wrench",
            "/graintwin/wall/x_min/wrench",
            "/graintwin/wall/y_max/wrench",
            "/graintwin/wall/y_min/wrench",
            "/graintwin/wall/z_max/wrench",
            "/graintwin/wall/z_min/wrench",
            "/graintwin/wall_forces",
            "/graintwin/wall_states",
            "/graintwin/wall_targets",
            "/parameter_events",
            "/rosout",
            "/tf_static",
        ]
    );
    let provenance = provenance();
    assert_eq!(
        said["attachments"],
        json!({
            "scene.yaml": provenance.scene,
            "pack.csv": String::from_utf8(provenance.pack_csv).unwrap(),
            "pack.json": String::from_utf8(provenance.pack_json).unwrap(),
            "pack.history.json": String::from_utf8(provenance.pack_history.unwrap()).unwrap(),
        })
    );
    let program = &said["program"];
    assert_eq!(program["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(program["threads"], "2");
    assert_eq!(program["seed"], "1");
    assert_eq!(program["kernels"], graintwin::relax::lanes::kernels());
    assert!(program["features"].as_str().unwrap().split(' ').any(|feature| feature == "mcap"));
    assert_eq!(said["compressions"], json!(["zstd"]));
}

#[test]
fn attachments_and_metadata_stand_before_the_first_chunk() {
    let Some(said) = read_by_peers("run", &Record::default(), &answers(1, 1)) else { return };
    let kinds: Vec<_> =
        said["kinds"].as_array().unwrap().iter().map(|one| one.as_str().unwrap()).collect();
    assert_eq!(
        kinds[..7],
        ["Header", "Attachment", "Attachment", "Attachment", "Attachment", "Metadata", "Chunk"]
    );
}

#[test]
fn every_compression_is_read() {
    for (compression, name) in [(Compression::Lz4, "lz4"), (Compression::None, "")] {
        let settings = Record { compression, ..Record::default() };
        let Some(said) = read_by_peers("run", &settings, &answers(3, 500)) else { return };
        assert_eq!(said["compressions"], json!([name]));
    }
}

/// Each answer is larger than a chunk, the first message too; rosbag2 refuses files with a chunk
/// without message, and the peer's script looks for one.
#[test]
fn messages_larger_than_a_chunk_never_make_a_chunk_without_message() {
    let settings = Record { chunk: 1, ..Record::default() };
    let answers = answers(2, 300);
    let Some(said) = read_by_peers("run", &settings, &answers) else { return };
    let chunks = said["kinds"].as_array().unwrap().iter().filter(|kind| *kind == "Chunk").count();
    assert_eq!(chunks, answers.len(), "a chunk holds whole answers");
}

#[test]
fn a_bag_without_an_answer_is_still_a_bag() {
    let Some(said) = read_by_peers("run", &Record::default(), &[]) else { return };
    assert_eq!(said["topics"], json!([]));
}

#[test]
fn a_folder_with_an_awkward_name_is_described_correctly() {
    let name = r#"Öl: "3" # - \ {a}"#;
    read_by_peers(name, &Record::default(), &answers(1, 1));
}

#[test]
fn measurements_and_how_the_twin_compares_are_recorded_between_the_answers() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let answers = answers(1, 3);
    let mut recorder = Recorder::create(&folder, &Record::default(), &provenance()).unwrap();
    let handle = recorder.handle();
    let stamp = Stamp { sec: 12, nanosec: 5 };
    let force = Vector3 { x: 1.0, y: -2.0, z: 3.5 };
    let measured = WrenchStamped {
        header: Header { stamp: stamp.into(), frame_id: "wall_z_max".into() },
        wrench: Wrench { force, torque: Vector3::default() },
    };
    let mut found = Discrepancy::unmeasured(stamp, 1, [4.0; 6]);
    (found.rig[5], found.delay[5]) = (3.5, 0.25);
    recorder.served(&answers[0]);
    handle.beside(Beside::Measured(5, measured.clone()));
    recorder.served(&answers[1]);
    handle.beside(Beside::Discrepancy(convert::discrepancy(&found)));
    let recorded = recorder.finish().unwrap();
    assert_eq!(
        (handle.state().messages, handle.state().bytes),
        (recorded.messages, recorded.bytes)
    );
    assert_eq!(handle.state().lost, 0);

    let nan = || json!(["NaN", "NaN", "NaN", "NaN", "NaN"]);
    let with = |value: f64| {
        let mut all = nan();
        all.as_array_mut().unwrap().push(value.into());
        all
    };
    let beside = [
        message(
            "measured_wrench/z_max",
            &json!({
                "header": header(stamp, "wall_z_max"),
                "wrench": {"force": [1.0, -2.0, 3.5], "torque": [0.0, 0.0, 0.0]},
            }),
        ),
        message(
            "discrepancy",
            &json!({
                "header": header(stamp, "pack"),
                "increment": 1,
                "valid": [false, false, false, false, false, true],
                "twin_force": found.twin,
                "rig_force": with(3.5),
                "difference": with(0.5),
                "delay": with(0.25),
            }),
        ),
    ];
    let [first, second] = beside.map(|message| vec![message]);
    peers_find(&folder, vec![expected(&answers[0]), first, expected(&answers[1]), second]);

    handle.beside(Beside::Measured(5, measured));
    assert_eq!(handle.state().lost, 1, "what comes after the end");
}

#[test]
fn what_the_node_hears_and_says_beside_the_answers_is_recorded_as_it_is() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let stamp = Stamp { sec: 12, nanosec: 5 };
    let head = || Header { stamp: stamp.into(), frame_id: "rig".into() };
    let at = json!({"sec": 12, "nanosec": 5});
    let point = JointTrajectoryPoint {
        positions: vec![1e-7],
        time_from_start: Duration { sec: 3, nanosec: 4 },
        ..JointTrajectoryPoint::default()
    };
    let value = ParameterValue { kind: 3, double_value: 0.5, ..ParameterValue::default() };
    let parameter = Parameter { name: "node.stale_after".into(), value };
    let pair = KeyValue { key: "residual".into(), value: "1e-9".into() };
    let status = DiagnosticStatus { level: 1, values: vec![pair], ..DiagnosticStatus::default() };
    let heard = [
        Beside::JointStates(JointState {
            header: head(),
            name: vec!["top".into()],
            position: vec![0.25],
            velocity: vec![],
            effort: vec![-3.0],
        }),
        Beside::JointTrajectory(JointTrajectory {
            header: head(),
            joint_names: vec!["side".into()],
            points: vec![point],
        }),
        Beside::Diagnostics(DiagnosticArray { header: head(), status: vec![status] }),
        Beside::Log(Log { stamp: stamp.into(), level: 30, msg: "µ".into(), ..Log::default() }),
        Beside::ParameterEvent(ParameterEvent {
            stamp: stamp.into(),
            changed_parameters: vec![parameter],
            ..ParameterEvent::default()
        }),
    ];
    let expected = [
        (
            "/graintwin/joint_states",
            json!({
                "header": header(stamp, "rig"), "name": ["top"], "position": [0.25], "velocity": [],
                "effort": [-3.0],
            }),
        ),
        (
            "/graintwin/joint_trajectory",
            json!({
                "header": header(stamp, "rig"), "joint_names": ["side"],
                "points": [{"positions": [1e-7], "time_from_start": {"sec": 3, "nanosec": 4}}],
            }),
        ),
        (
            "/diagnostics",
            json!({
                "header": header(stamp, "rig"),
                "status": [{"values": [{"key": "residual", "value": "1e-9"}]}],
            }),
        ),
        (
            "/rosout",
            json!({
                "stamp": at, "level": 30, "name": "", "msg": "µ", "file": "", "function": "", "line": 0,
            }),
        ),
        (
            "/parameter_events",
            json!({
                "stamp": at, "node": "", "new_parameters": [], "deleted_parameters": [],
                "changed_parameters": [
                    {"name": "node.stale_after", "value": {"double_value": 0.5, "string_value": ""}},
                ],
            }),
        ),
    ];
    let recorder = Recorder::create(&folder, &Record::default(), &provenance()).unwrap();
    let handle = recorder.handle();
    for beside in heard {
        handle.beside(beside);
    }
    recorder.finish().unwrap();
    let expected = expected.map(|(topic, fields)| vec![json!({"topic": topic, "fields": fields})]);
    peers_find(&folder, expected.to_vec());
}
