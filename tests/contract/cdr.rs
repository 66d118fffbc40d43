//! Bytes, hashes and definitions of the messages against an independent implementation: the
//! Python package rosbags.
#![cfg(feature = "mcap")]

use std::fmt::Debug;
use std::path::Path;

use graintwin::msg::cdr::{self, CdrError};
use graintwin::msg::convert::{LIVE_BONDS, LIVE_GRAINS};
use graintwin::msg::picture::{
    ColorRGBA, CompressedImage, Marker, MarkerArray, MeshFile, Point, PointCloud2, PointField,
    Pose, UVCoordinate,
};
use graintwin::msg::{
    Bonds, BoundaryCommand, Circumstance, Clock, ContactNetwork, Cracks, Described,
    DiagnosticArray, DiagnosticStatus, Discrepancy, Dissociation, Duration, Event, Fabric,
    GrainMotion, Header, Hydrate, JointState, JointTrajectory, JointTrajectoryPoint, KeyValue,
    Moduli, PackState, PlaneState, Quaternion, Rearrangement, Report, ShearCommand, ShearState,
    Snapshot, TFMessage, Tangent, TangentModuli, Time, Transform, TransformStamped, Vector3,
    WallForces, WallTargets, Wrench, WrenchStamped,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::python;

fn header(frame: &str) -> Header {
    Header { stamp: Time { sec: -7, nanosec: 123_456_789 }, frame_id: frame.into() }
}

fn vector(seed: f64) -> Vector3 {
    Vector3 { x: seed + 0.1, y: -seed / 3.0, z: seed * 1e-300 }
}

fn boundary_command() -> BoundaryCommand {
    BoundaryCommand {
        header: header(""),
        session: "öffnung".into(),
        sequence: u64::MAX - 1,
        mode: 1,
        displacement: [0.1, -0.2, 0.3, -0.4, 5e-324, 1.797e308],
    }
}

fn wall_forces() -> WallForces {
    WallForces {
        header: header("pack"),
        increment: 3,
        normal_force: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        displacement: [-1e-9; 6],
        force: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(vector),
        moment: [7.0, 8.0, 9.0, 10.0, 11.0, 12.0].map(vector),
    }
}

fn pack_state() -> PackState {
    PackState {
        header: header("pack."),
        increment: 1 << 40,
        strain: [0.01, 0.02, 0.03],
        stress_walls: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
        stress_contacts: [-1.0, -2.0, -3.0, -4.0, -5.0, -6.0, -7.0, -8.0, -9.0],
        confining_stress: 1.5e7,
        deviatoric_stress: -2.5e3,
        porosity: 0.36,
        coordination_number: 6.29,
        sliding_ratio: 0.125,
        stored_energy: 1e-5,
        dissipated_energy: 2e-7,
        contacts: 8000,
        rattlers: 61,
        iterations: u32::MAX,
        residual: 3e-9,
        solve_seconds: 0.25,
        converged: true,
    }
}

fn moduli() -> Moduli {
    Moduli {
        header: header("p"),
        increment: 4,
        valid: true,
        bulk: 1e9,
        shear: 2e9,
        young: 3e9,
        poisson: 0.2,
        lame: 4e9,
        p_wave: 5e9,
        tangent: [0.5; 9],
    }
}

fn tangent() -> Tangent {
    let part = |valid, from: f64| TangentModuli {
        valid,
        error: 1e-11,
        relaxed: std::array::from_fn(|k| from + k as f64),
        affine: std::array::from_fn(|k| from - k as f64),
        wall_stiffness: (0..36).map(|k| from * f64::from(k)).collect(),
        bulk: from,
        shear: -from,
        young: 3e9,
        poisson: 0.2,
        lame: 4e9,
        p_wave: 5e9,
        shear_pairs: [1e9, 2e9, 3e9],
        p_speed: [700.0, 800.0, 900.0],
        s_speed: [400.0, 500.0, 600.0],
        isotropy_index: 0.97,
    };
    Tangent {
        header: header("pack"),
        increment: 5,
        density: 1600.5,
        products: 1 << 40,
        stands: part(true, 1.5),
        sticks: part(false, -2.5),
    }
}

fn contact_network(contacts: u32) -> ContactNetwork {
    let values = |count: u32| (0..count).map(|i| f64::from(i) / 7.0).collect();
    ContactNetwork {
        header: header("pack"),
        increment: 9,
        chunk: 2,
        chunk_count: 3,
        first: (0..contacts).collect(),
        second: (0..contacts).map(|i| u32::MAX - i).collect(),
        normal: values(3 * contacts),
        normal_force: values(contacts),
        tangential_force: values(3 * contacts),
        overlap: values(contacts),
        state: (0..contacts).map(|i| (i % 4) as u8).collect(),
    }
}

fn grain_motion(grains: u32) -> GrainMotion {
    let values = |count: u32| (0..count).map(|i| f64::from(i) / 7.0).collect();
    GrainMotion {
        header: header("pack"),
        increment: 9,
        chunk: 1,
        chunk_count: 3,
        first_grain: 450,
        displacement: values(3 * grains),
        non_affine: values(3 * grains),
        rotation: Vec::new(),
        total_rotation: values(3 * grains),
        d2min: values(grains),
        shear_strain: values(grains),
        volumetric_strain: values(grains),
        carries: (0..grains).map(|i| i % 2 == 0).collect(),
        affine_rms: 0.5,
        non_affine_rms: 1.5,
        non_affine_ratio: 3.0,
        rotation_rms: 2.5,
        participation: 0.25,
        rotation_participation: 0.75,
        d2min_top_1: 0.1,
        d2min_top_10: 0.2,
        band_center: [1.0, 2.0, 3.0],
        band_normal: [0.6, 0.8, 0.0],
        band_spread: [0.1, 0.9, 1.1],
        band_thickness: 4.5,
    }
}

fn report(text: &str) -> Report {
    Report {
        header: header("pack"),
        session: String::new(),
        sequence: 12,
        increment: 11,
        disposition: 8,
        substeps: 3,
        text: text.into(),
    }
}

fn event() -> Event {
    Event {
        header: header("pack"),
        increment: 2,
        kind: 1,
        stress_before: 2.0,
        stress_after: 1.0,
        grains: vec![5, 6, 7],
        displacement: vec![1e-3],
    }
}

fn fabric() -> Fabric {
    Fabric {
        header: header("pack"),
        contacts: 5,
        shear_fabric: [0.5; 9],
        cone_largest: [0.25, 0.5, 0.125],
        largest_chain: 7,
        chain_load: 0.75,
        chain_spans: [true, false, true],
        strongest_path: [1e-3, 0.0, 2e-3],
        force_histogram: vec![1, 2, 3],
        angle_count: vec![4],
        angle_normal: vec![f64::MAX],
        angle_predicted: [-1.0, 5e-324, 1.0],
        interior_coordination: vec![0, 9],
        ..Fabric::default()
    }
}

fn bonds(count: u32) -> Bonds {
    let values = |count: u32| (0..count).map(|i| f64::from(i) / 7.0).collect();
    Bonds {
        header: header("pack"),
        increment: 9,
        chunk: 2,
        chunk_count: 3,
        tensile_strength: 2e6,
        shear_strength: 5e6,
        first: (0..count).collect(),
        second: (0..count).map(|i| u32::MAX - i).collect(),
        condition: (0..count).map(|i| (i % 3) as u8).collect(),
        share: values(count),
        radius: values(count),
        position: values(3 * count),
        normal: values(3 * count),
        normal_force: values(count),
        tangential_force: values(3 * count),
        torsion: values(count),
        strength_use: values(count),
    }
}

fn cracks(count: u32) -> Cracks {
    let values = |count: u32| (0..count).map(|i| f64::from(i) / 7.0).collect();
    Cracks {
        header: header("pack"),
        increment: 1 << 40,
        chunk: 0,
        chunk_count: 1,
        intact: 10,
        broken_by_tension: 11,
        broken_by_shear: u32::MAX,
        first: (0..count).collect(),
        second: (0..count).map(|i| u32::MAX - i).collect(),
        mode: (0..count).map(|i| 1 + (i % 2) as u8).collect(),
        substep: (0..count).map(|i| i / 3).collect(),
        position: values(3 * count),
        normal: values(3 * count),
        normal_force: values(count),
        tangential_force: values(count),
        torsion: values(count),
        overload: values(count),
        stress_before: values(count),
        stress_after: values(count),
        energy_released: values(count),
    }
}

fn joint_trajectory() -> JointTrajectory {
    let point = |sec, positions: &[f64]| JointTrajectoryPoint {
        positions: positions.into(),
        velocities: vec![0.5],
        time_from_start: Duration { sec, nanosec: 7 },
        ..JointTrajectoryPoint::default()
    };
    JointTrajectory {
        header: header("rig"),
        joint_names: vec!["top".into(), String::new()],
        points: vec![point(1, &[0.1, -0.2]), point(-2, &[]), point(i32::MAX, &[1e-3])],
    }
}

fn joint_state() -> JointState {
    JointState {
        header: header("pack"),
        name: vec!["x_min".into(), String::new(), "z".into()],
        position: vec![0.5, 0.25],
        velocity: Vec::new(),
        effort: vec![3.0],
    }
}

fn discrepancy() -> Discrepancy {
    Discrepancy {
        header: header("pack"),
        increment: 11,
        valid: [true, false, false, true, true, false],
        twin_force: [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        rig_force: [0.5; 6],
        difference: [0.5, 1.5, 2.5, 3.5, 4.5, 5.5],
        delay: [1e-3, -1e-3, 0.0, -0.0, 1e9, -1e-9],
    }
}

fn circumstance() -> Circumstance {
    Circumstance {
        header: header(""),
        increment: 7,
        kind: 5,
        success: true,
        text: "ü".into(),
        name: vec!["solver.tolerance".into(), "a".into()],
        value: vec![1e-9, -1e300],
    }
}

fn diagnostics(count: usize) -> DiagnosticArray {
    let value = KeyValue { key: "iterations".into(), value: "5".into() };
    let status = DiagnosticStatus {
        level: 3,
        name: "graintwin: solver".into(),
        message: "ü".into(),
        hardware_id: "rig 4".into(),
        values: vec![value; count],
    };
    DiagnosticArray { header: header(""), status: vec![status; count] }
}

fn frames(count: usize) -> TFMessage {
    let transform = Transform {
        translation: vector(2.0),
        rotation: Quaternion { x: 0.1, y: 0.2, z: 0.3, w: 0.4 },
    };
    let child_frame_id = "wall_z_max".into();
    let frame = TransformStamped { header: header("pack"), child_frame_id, transform };
    TFMessage { transforms: vec![frame; count] }
}

fn cloud(points: u8) -> PointCloud2 {
    let field =
        |name: &str, datatype| PointField { name: name.into(), offset: 4, datatype, count: 1 };
    PointCloud2 {
        header: header("pack_view"),
        height: 1,
        width: points.into(),
        fields: vec![field("x", PointField::FLOAT32), field("id", PointField::UINT32)],
        is_bigendian: true,
        point_step: 3,
        row_step: 3 * u32::from(points),
        data: (0..3 * points).collect(),
        is_dense: true,
    }
}

/// Every field set, those too that graintwin leaves empty.
fn marker(points: u8) -> Marker {
    let color = ColorRGBA { r: 0.25, g: 0.5, b: 0.75, a: 1.0 };
    let point = Point { x: 0.1, y: -2.0, z: 3e-9 };
    let orientation = Quaternion { x: 0.1, y: 0.2, z: 0.3, w: 0.4 };
    Marker {
        header: header("pack_view"),
        ns: "spheres".into(),
        id: -3,
        r#type: Marker::SPHERE_LIST,
        action: Marker::DELETE,
        pose: Pose { position: point, orientation },
        scale: vector(1.0),
        color,
        lifetime: Duration { sec: -1, nanosec: 7 },
        frame_locked: true,
        points: vec![point; points.into()],
        colors: vec![color; points.into()],
        texture_resource: "a".into(),
        texture: CompressedImage {
            header: header("image"),
            format: "png".into(),
            data: (0..points).collect(),
        },
        uv_coordinates: vec![UVCoordinate { u: 0.5, v: 0.125 }; points.into()],
        text: "σ = 1 MPa".into(),
        mesh_resource: "b".into(),
        mesh_file: MeshFile { filename: "c".into(), data: (0..points).collect() },
        mesh_use_embedded_materials: true,
    }
}

/// Holds one answer of the peer against the message it is about.
type Check = Box<dyn Fn(&Value)>;

/// Messages as the peer gets them, and the checks of what it answers, in the same order.
#[derive(Default)]
struct Exchange {
    asked: Vec<Value>,
    checks: Vec<Check>,
}

impl Exchange {
    fn add<T>(&mut self, message: T)
    where
        T: Described + Serialize + DeserializeOwned + PartialEq + Debug + 'static,
    {
        self.asked.push(json!({
            "type": T::TYPE.full_name(),
            "definition": T::TYPE.definition(),
            "value": message,
        }));
        self.checks.push(Box::new(move |answer| {
            let kind = T::TYPE.full_name();
            let mut bytes = Vec::new();
            cdr::encode(&message, &mut bytes).unwrap();
            assert_eq!(hex(&bytes), answer["little"].as_str().unwrap(), "{kind}");
            for order in ["little", "big"] {
                let bytes = unhex(answer[order].as_str().unwrap());
                assert_eq!(cdr::decode::<T>(&bytes).unwrap(), message, "{kind} {order}");
            }
            assert_eq!(answer["hash"], T::TYPE.hash, "{kind}");
            assert_eq!(answer["same_fields"], true, "{kind}");
        }));
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn unhex(text: &str) -> Vec<u8> {
    let digits: Vec<u8> =
        text.chars().map(|digit| digit.to_digit(16).unwrap().try_into().unwrap()).collect();
    digits.chunks(2).map(|pair| 16 * pair[0] + pair[1]).collect()
}

#[test]
fn bytes_hashes_and_definitions_are_those_of_an_independent_implementation() {
    let mut exchange = Exchange::default();
    exchange.add(boundary_command());
    exchange.add(BoundaryCommand::default());
    exchange.add(WallTargets {
        session: "séance".into(),
        sequence: 1 << 40,
        mode: 1,
        control: [0, 1, 2, 3, 4, 255],
        value: [0.0, -1e-6, 12.5, 1e5, f64::MAX, 5e-324],
        ..WallTargets::default()
    });
    exchange.add(WallTargets::default());
    exchange.add(wall_forces());
    exchange.add(pack_state());
    exchange.add(moduli());
    exchange.add(tangent());
    exchange.add(Tangent::default());
    for contacts in [0, 1, 2, 5] {
        exchange.add(contact_network(contacts));
        exchange.add(grain_motion(contacts));
        exchange.add(bonds(contacts));
        exchange.add(cracks(contacts));
    }
    for text in ["", "1", "12", "123", "1234"] {
        exchange.add(report(text));
    }
    exchange.add(event());
    exchange.add(Event::default());
    exchange.add(fabric());
    exchange.add(Fabric::default());
    exchange.add(Dissociation {
        header: header(""),
        session: "ß".into(),
        sequence: 3,
        mode: 1,
        saturation_loss: 0.015,
        pore_pressure: 1e6,
        biot: 0.8,
    });
    exchange.add(Dissociation::default());
    exchange.add(ShearCommand {
        header: header(""),
        session: "ß".into(),
        sequence: 3,
        mode: 1,
        tilt: -0.015,
        control: [0, 1, 2, 3, 0, 3],
        value: [0.0, 1e-6, 2.0, 1e5, 0.0, 2e5],
    });
    exchange.add(ShearState {
        header: header("pack"),
        increment: 1 << 33,
        tilt: 0.02,
        strain: [1e-3, -1e-2, -1e-2, 2e-3],
        inner_stress: [1e5, -3e4, -3.1e4, 2e5],
        inner_grains: 1000,
        stress_direction: -1.1,
        strain_direction: 0.7,
        mean_rotation: -0.01,
    });
    exchange.add(Hydrate {
        header: header("pack"),
        increment: 1 << 33,
        saturation: 0.22,
        present_saturation: 0.21,
        pore_pressure: 1e6,
        effective_stress: 2e7,
        total_stress: 2.08e7,
        porosity: 0.36,
        pore_fraction: 0.46,
    });
    exchange.add(PlaneState {
        header: header("pack"),
        increment: 7,
        mean_diameter: 2e-4,
        stress: [1e5, 3e5, -2e4],
        principal_stress: [3.02e5, 9.8e4],
        network_strain: [-1e-4, 2e-4, 1e-5],
        contact_strain: [-0.5e-4, 1e-4],
        polar_contacts: vec![3, 0, 5],
        polar_normal: vec![0.25, 0.0, 1.5],
        ring_radius: vec![1e-3],
        ..PlaneState::default()
    });
    exchange.add(Rearrangement {
        header: header("pack"),
        increment: 2,
        event: 1,
        chunk: 0,
        chunk_count: 1,
        kind: 0,
        stress_before: 2.0,
        stress_after: 1.0,
        energy_before: 1e-9,
        energy_after: -1e-9,
        grains: vec![5, 6],
        displacement: vec![1e-3, 2e-3, -3e-3, 0.0, 5e-324, 1.0],
        rotation: vec![0.5],
        lost_first: vec![5],
        lost_second: vec![u32::MAX],
        made_first: Vec::new(),
        made_second: vec![1, 2, 3],
    });
    exchange.add(Rearrangement::default());
    exchange.add(Snapshot {
        header: header("pack"),
        increment: 2,
        event: 1,
        when: 1,
        wall_position: [-1.0, 1.0, -2.0, 2.0, -3.0, 3.0],
        position: vec![0.25, -0.5, 1e300],
        rotation: Vec::new(),
    });
    exchange.add(Snapshot::default());
    exchange.add(joint_state());
    exchange.add(JointState::default());
    exchange.add(joint_trajectory());
    exchange.add(JointTrajectory::default());
    let wrench = Wrench { force: vector(1.0), torque: vector(2.0) };
    exchange.add(WrenchStamped { header: header("wall_x_min"), wrench });
    exchange.add(wrench);
    exchange.add(vector(3.0));
    exchange.add(header("frame"));
    let time = Time { sec: i32::MIN, nanosec: 5 };
    exchange.add(time);
    exchange.add(Clock { clock: time });
    exchange.add(discrepancy());
    exchange.add(circumstance());
    exchange.add(circumstance());
    for count in 0..3 {
        exchange.add(diagnostics(count));
        exchange.add(frames(count));
    }
    for points in [0, 1, 5] {
        exchange.add(cloud(points));
        exchange.add(marker(points));
        exchange.add(MarkerArray { markers: vec![marker(points); points.into()] });
    }
    exchange.add(Marker::default());
    exchange.add(Pose::default());
    exchange.add(KeyValue { key: "größe".into(), value: String::new() });
    exchange.add(Transform::default());
    exchange.add(Quaternion { x: 0.5, y: -0.5, z: 0.1, w: 0.7 });

    let texts = Path::new(env!("CARGO_MANIFEST_DIR")).join("msgs/graintwin_msgs/msg");
    let asked = Value::from(exchange.asked).to_string();
    let Some(answers) = python::run("messages.py", &[&texts], &asked) else { return };
    let answers: Vec<Value> = serde_json::from_str(&answers).unwrap();
    assert_eq!(answers.len(), exchange.checks.len());
    for (check, answer) in exchange.checks.iter().zip(&answers) {
        check(answer);
    }
}

/// What one sample can carry without losses is 60 KB.
#[test]
fn a_live_chunk_of_a_motion_fits_into_a_sample() {
    let grains = LIVE_GRAINS as u32;
    let rotation = vec![0.5; 3 * LIVE_GRAINS];
    let mut bytes = Vec::new();
    cdr::encode(&GrainMotion { rotation, ..grain_motion(grains) }, &mut bytes).unwrap();
    assert!((54_000..60_000).contains(&bytes.len()), "{}", bytes.len());
}

/// As above.
#[test]
fn live_chunks_of_bonds_and_cracks_fit_into_a_sample() {
    let mut bytes = Vec::new();
    cdr::encode(&bonds(LIVE_BONDS as u32), &mut bytes).unwrap();
    assert!((50_000..60_000).contains(&bytes.len()), "{}", bytes.len());
    cdr::encode(&cracks(LIVE_BONDS as u32), &mut bytes).unwrap();
    assert!((50_000..60_000).contains(&bytes.len()), "{}", bytes.len());
}

#[test]
fn bytes_that_are_no_plain_cdr_are_refused() {
    for bytes in [&[][..], &[0], &[0, 1, 0], &[0, 3, 0, 0, 1, 2, 3, 4], b"PK\x03\x04"] {
        let refusal = cdr::decode::<Time>(bytes).unwrap_err();
        assert!(matches!(refusal, CdrError::Encapsulation { .. }), "{bytes:?}: {refusal}");
    }
}

#[test]
fn a_message_that_is_cut_off_anywhere_is_refused() {
    let mut bytes = Vec::new();
    cdr::encode(&contact_network(3), &mut bytes).unwrap();
    for length in 4..bytes.len() {
        let refusal = cdr::decode::<ContactNetwork>(&bytes[..length]).unwrap_err();
        assert!(matches!(refusal, CdrError::Body { .. }), "{length}: {refusal}");
    }
}

/// Wherever the four bytes stand, in numbers, lengths or text: the message is another one or is
/// refused, and takes no more memory than its bytes can fill.
#[test]
fn a_sequence_that_claims_to_be_endless_is_refused() {
    let mut bytes = Vec::new();
    cdr::encode(&event(), &mut bytes).unwrap();
    let mut refused = 0;
    for at in 4..=bytes.len() - 4 {
        let mut hostile = bytes.clone();
        hostile[at..at + 4].copy_from_slice(&[0xff; 4]);
        match cdr::decode::<Event>(&hostile) {
            Ok(event) => assert_eq!((event.grains.len(), event.displacement.len()), (3, 1)),
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 0);
}
