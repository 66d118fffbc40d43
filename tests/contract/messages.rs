//! The message types against the texts under `msgs/`, and what is put into them.

use std::fs;
use std::path::Path;

use graintwin::command::{self, Ask, Command, Disposition, Mode, Stamp};
use graintwin::measure::discrepancy;
use graintwin::msg::convert::{self, CommandMessage, LIVE_CHUNK};
use graintwin::msg::picture::{
    ColorRGBA, CompressedImage, Marker, MarkerArray, MeshFile, Point, PointCloud2, PointField,
    Pose, UVCoordinate,
};
use graintwin::msg::rcl::{Log, Parameter, ParameterEvent, ParameterValue};
use graintwin::msg::rearrangement::{self, LIVE_CONTACTS, LIVE_GRAINS};
use graintwin::msg::services::{SavePack, Service, SetBool, Trigger};
use graintwin::msg::{
    Bonds, BoundaryCommand, Circumstance, Clock, ContactNetwork, Cracks, Described,
    DiagnosticArray, DiagnosticStatus, Discrepancy, Dissociation, Duration, Event, Fabric,
    GrainMotion, Header, Hydrate, JointState, JointTrajectory, JointTrajectoryPoint, KeyValue,
    Moduli, PackState, PlaneState, Quaternion, Rearrangement, Report, ShearCommand, ShearState,
    Snapshot, TFMessage, Tangent, TangentModuli, Time, Transform, TransformStamped, Vector3,
    WallForces, WallTargets, Wrench, WrenchStamped, topics,
};
use graintwin::report::{self, BondCondition, ContactState, EventEnd, EventKind, Measures};
use graintwin::wall::{self, WallTarget};
use serde::de::DeserializeOwned;

use crate::shape::{Shape, shape_of};

/// A line of a definition: type and name, or a constant with its value.
#[derive(Debug, PartialEq, Eq)]
enum Line<'a> {
    Field(&'a str, &'a str),
    Constant(&'a str, u8),
}

fn parse(text: &str) -> Vec<Line<'_>> {
    let lines = text.lines().map(|line| line.split('#').next().unwrap().trim());
    lines
        .filter(|line| !line.is_empty())
        .map(|line| {
            let (kind, rest) = line.split_once(' ').unwrap();
            match rest.split_once('=') {
                Some((name, value)) => Line::Constant(name.trim(), value.trim().parse().unwrap()),
                None => Line::Field(kind, rest.trim()),
            }
        })
        .collect()
}

/// A type as definitions write it; names of messages without their package.
fn written(shape: &Shape) -> String {
    match shape {
        Shape::Primitive(name) | Shape::Struct(name, _) => (*name).to_owned(),
        Shape::Sequence(of) => format!("{}[]", written(of)),
        Shape::Array(of, n) => format!("{}[{n}]", written(of)),
    }
}

fn assert_same_fields<T: Described + DeserializeOwned>() {
    let Shape::Struct(name, fields) = shape_of::<T>() else { panic!("no struct") };
    assert_eq!(name, T::TYPE.name);
    let of_struct: Vec<_> =
        fields.iter().map(|(name, shape)| format!("{} {name}", written(shape))).collect();
    let lines = parse(T::TYPE.text);
    let of_text: Vec<_> = lines
        .iter()
        .filter_map(|line| match line {
            // A byte is what Rust calls a u8.
            Line::Field("byte", name) => Some(format!("uint8 {name}")),
            Line::Field("byte[]", name) => Some(format!("uint8[] {name}")),
            Line::Field(kind, name) => Some(format!("{} {name}", kind.rsplit('/').next()?)),
            Line::Constant(..) => None,
        })
        .collect();
    assert_eq!(of_struct, of_text, "{name}");
}

#[test]
fn every_struct_has_the_fields_of_its_text() {
    assert_same_fields::<BoundaryCommand>();
    assert_same_fields::<WallTargets>();
    assert_same_fields::<WallForces>();
    assert_same_fields::<PackState>();
    assert_same_fields::<Moduli>();
    assert_same_fields::<Tangent>();
    assert_same_fields::<TangentModuli>();
    assert_same_fields::<ContactNetwork>();
    assert_same_fields::<GrainMotion>();
    assert_same_fields::<Report>();
    assert_same_fields::<Event>();
    assert_same_fields::<Bonds>();
    assert_same_fields::<Cracks>();
    assert_same_fields::<Fabric>();
    assert_same_fields::<Dissociation>();
    assert_same_fields::<ShearCommand>();
    assert_same_fields::<ShearState>();
    assert_same_fields::<Hydrate>();
    assert_same_fields::<PlaneState>();
    assert_same_fields::<Rearrangement>();
    assert_same_fields::<Snapshot>();
    assert_same_fields::<Time>();
    assert_same_fields::<Header>();
    assert_same_fields::<Vector3>();
    assert_same_fields::<Wrench>();
    assert_same_fields::<WrenchStamped>();
    assert_same_fields::<JointState>();
    assert_same_fields::<Duration>();
    assert_same_fields::<JointTrajectoryPoint>();
    assert_same_fields::<JointTrajectory>();
    assert_same_fields::<Discrepancy>();
    assert_same_fields::<Circumstance>();
    assert_same_fields::<Clock>();
    assert_same_fields::<KeyValue>();
    assert_same_fields::<DiagnosticStatus>();
    assert_same_fields::<DiagnosticArray>();
    assert_same_fields::<Quaternion>();
    assert_same_fields::<Transform>();
    assert_same_fields::<TransformStamped>();
    assert_same_fields::<TFMessage>();
    assert_same_fields::<Point>();
    assert_same_fields::<Pose>();
    assert_same_fields::<ColorRGBA>();
    assert_same_fields::<PointField>();
    assert_same_fields::<PointCloud2>();
    assert_same_fields::<CompressedImage>();
    assert_same_fields::<UVCoordinate>();
    assert_same_fields::<MeshFile>();
    assert_same_fields::<Marker>();
    assert_same_fields::<MarkerArray>();
    assert_same_fields::<ParameterValue>();
    assert_same_fields::<Parameter>();
    assert_same_fields::<ParameterEvent>();
    assert_same_fields::<Log>();
}

/// The fields of `T` as a `.srv` text writes them.
fn fields_of<T: DeserializeOwned>() -> Vec<String> {
    let Shape::Struct(_, fields) = shape_of::<T>() else { panic!("no struct") };
    fields.iter().map(|(name, shape)| format!("{} {name}", written(shape))).collect()
}

fn assert_same_service<S: Service>()
where
    S::Request: DeserializeOwned,
    S::Response: DeserializeOwned,
{
    let (request, response) = S::TYPE.text.split_once("---").unwrap();
    let of_text = |text| -> Vec<String> {
        let fields = parse(text).into_iter().map(|line| match line {
            Line::Field(kind, name) => format!("{kind} {name}"),
            Line::Constant(name, _) => panic!("{name} is a constant"),
        });
        fields.collect()
    };
    let mut asked = of_text(request);
    if asked.is_empty() {
        // What ROS 2 makes of nothing.
        asked.push("uint8 structure_needs_at_least_one_member".into());
    }
    assert_eq!(fields_of::<S::Request>(), asked, "{}", S::TYPE.name);
    assert_eq!(fields_of::<S::Response>(), of_text(response), "{}", S::TYPE.name);
}

#[test]
fn every_service_has_the_fields_of_its_text() {
    assert_same_service::<Trigger>();
    assert_same_service::<SetBool>();
    assert_same_service::<SavePack>();
}

#[test]
fn every_message_text_is_built_by_the_package_and_has_a_struct() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("msgs/graintwin_msgs");
    let recipe = fs::read_to_string(package.join("CMakeLists.txt")).unwrap();
    let structs = [
        BoundaryCommand::TYPE,
        WallTargets::TYPE,
        WallForces::TYPE,
        PackState::TYPE,
        Moduli::TYPE,
        Tangent::TYPE,
        TangentModuli::TYPE,
        ContactNetwork::TYPE,
        GrainMotion::TYPE,
        Report::TYPE,
        Event::TYPE,
        Bonds::TYPE,
        Cracks::TYPE,
        Fabric::TYPE,
        Dissociation::TYPE,
        ShearCommand::TYPE,
        ShearState::TYPE,
        Hydrate::TYPE,
        PlaneState::TYPE,
        Rearrangement::TYPE,
        Snapshot::TYPE,
        Discrepancy::TYPE,
        Circumstance::TYPE,
    ];
    for file in fs::read_dir(package.join("msg")).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        assert!(recipe.contains(&format!("\"msg/{name}.msg\"")), "CMakeLists.txt lacks {name}");
        assert!(structs.iter().any(|kind| kind.name == name), "{name} has no struct");
    }
    for file in fs::read_dir(package.join("srv")).unwrap() {
        let name = file.unwrap().file_name().into_string().unwrap();
        assert!(recipe.contains(&format!("\"srv/{name}\"")), "CMakeLists.txt lacks {name}");
        assert_eq!(name, format!("{}.srv", SavePack::TYPE.name), "{name} has no struct");
    }
}

fn constants<T: Described>() -> Vec<(String, u8)> {
    parse(T::TYPE.text)
        .into_iter()
        .filter_map(|line| match line {
            Line::Constant(name, value) => Some((name.to_owned(), value)),
            Line::Field(..) => None,
        })
        .collect()
}

#[test]
fn dispositions_have_the_names_and_numbers_of_the_report() {
    let dispositions = [
        Disposition::Applied,
        Disposition::Clamped,
        Disposition::Duplicate,
        Disposition::Stale,
        Disposition::Gap,
        Disposition::OutOfOrder,
        Disposition::Limit,
        Disposition::Invalid,
        Disposition::NotConverged,
        Disposition::Held,
    ];
    let named: Vec<_> = dispositions
        .iter()
        .map(|&one| (serde_json::to_value(one).unwrap().as_str().unwrap().to_owned(), one as u8))
        .collect();
    assert_eq!(named, constants::<Report>());
}

#[test]
fn modes_and_contact_states_have_the_numbers_of_their_messages() {
    let modes =
        [("ABSOLUTE".into(), Mode::Absolute.into()), ("INCREMENT".into(), Mode::Increment.into())];
    assert_eq!(modes.to_vec(), constants::<BoundaryCommand>());
    let controls = [
        ("KEEP", WallTarget::Keep),
        ("DISPLACEMENT", WallTarget::Displacement(1.0)),
        ("FORCE", WallTarget::Force(1.0)),
        ("STRESS", WallTarget::Stress(1.0)),
    ];
    let controls = controls.map(|(name, target)| (name.to_owned(), target.numbers().0));
    let targets: Vec<_> = modes.iter().cloned().chain(controls).collect();
    assert_eq!(targets, constants::<WallTargets>());
    assert_eq!(targets, constants::<ShearCommand>());
    let states = [
        ("STICK".into(), ContactState::Stick as u8),
        ("SLIDE".into(), ContactState::Slide as u8),
        ("BONDED".into(), ContactState::Bonded as u8),
        ("BROKEN".into(), ContactState::Broken as u8),
    ];
    assert_eq!(states.to_vec(), constants::<ContactNetwork>());
    let kinds = [
        ("STRESS_DROP".into(), EventKind::StressDrop as u8),
        ("CONTACT_BREAK".into(), EventKind::ContactBreak as u8),
    ];
    assert_eq!(kinds.to_vec(), constants::<Event>());
    let conditions = [
        ("INTACT".into(), BondCondition::Intact as u8),
        ("TENSION".into(), BondCondition::Tension as u8),
        ("SHEAR".into(), BondCondition::Shear as u8),
    ];
    assert_eq!(conditions.to_vec(), constants::<Bonds>());
    assert_eq!(conditions[1..].to_vec(), constants::<Cracks>());
    assert_eq!(constants::<Rearrangement>(), constants::<Event>());
    let ends = [("BEFORE".into(), EventEnd::Before as u8), ("AFTER".into(), EventEnd::After as u8)];
    assert_eq!(ends.to_vec(), constants::<Snapshot>());
}

#[test]
fn types_and_actions_of_pictures_have_the_numbers_of_their_messages() {
    let fields = [("UINT32".into(), PointField::UINT32), ("FLOAT32".into(), PointField::FLOAT32)];
    assert_eq!(fields.to_vec(), constants::<PointField>()[5..7]);
    let markers = constants::<Marker>();
    for (name, number) in [
        ("CUBE", Marker::CUBE),
        ("LINE_LIST", Marker::LINE_LIST),
        ("SPHERE_LIST", Marker::SPHERE_LIST),
        ("TEXT_VIEW_FACING", Marker::TEXT_VIEW_FACING),
        ("ADD", Marker::ADD),
        ("DELETE", Marker::DELETE),
    ] {
        let told = markers.iter().find(|(told, _)| told == name).unwrap();
        assert_eq!(i32::from(told.1), number, "{name}");
    }
}

#[test]
fn a_definition_names_every_part_once_and_depth_first() {
    let rule = "=".repeat(80);
    let expected = format!(
        "std_msgs/Header header\nWrench wrench\n\
         \n{rule}\nMSG: geometry_msgs/Wrench\nVector3 force\nVector3 torque\n\
         \n{rule}\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n\
         \n{rule}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
         \n{rule}\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
    );
    assert_eq!(WrenchStamped::TYPE.definition(), expected);
    assert_eq!(WallForces::TYPE.definition().matches("MSG: geometry_msgs/Vector3").count(), 1);
}

#[test]
fn wrench_topics_follow_the_order_of_the_walls() {
    for (name, topic) in wall::NAMES.iter().zip(&topics::WALL_WRENCH) {
        assert_eq!(topic.recorded_name(), format!("/graintwin/wall/{name}/wrench"));
    }
    for (name, topic) in wall::NAMES.iter().zip(&topics::MEASURED_WRENCH) {
        assert_eq!(topic.recorded_name(), format!("/graintwin/measured_wrench/{name}"));
    }
}

#[test]
fn a_command_survives_the_way_through_its_message() {
    for mode in [Mode::Absolute, Mode::Increment, Mode::Unknown(7)] {
        let command = Command {
            stamp: Stamp { sec: -3, nanosec: 999_999_999 },
            session: "Prüfstand 4".into(),
            sequence: u64::MAX,
            mode,
            ask: Ask::Displacement([1e-9, -2e-9, 0.0, f64::INFINITY, 5e-300, -0.0]),
            age: None,
        };
        let CommandMessage::Boundary(message) = CommandMessage::from(&command) else {
            panic!("displacements of all walls are a boundary command");
        };
        assert_eq!(Command::from(message), command);
        let targets = [
            WallTarget::Keep,
            WallTarget::Displacement(-2e-9),
            WallTarget::Force(5e-300),
            WallTarget::Stress(f64::INFINITY),
            WallTarget::Unknown(4, 1.0),
            WallTarget::Unknown(255, -0.0),
        ];
        let command = Command { ask: Ask::Targets(targets), ..command };
        let CommandMessage::Targets(message) = CommandMessage::from(&command) else {
            panic!("targets of the walls are no boundary command");
        };
        assert_eq!(message.control, [0, 1, 2, 3, 4, 255]);
        assert_eq!(Command::from(message), command);
        let asked = command::Dissociation {
            saturation_loss: 0.25,
            pore_pressure: f64::INFINITY,
            biot: -0.0,
        };
        let command = Command { ask: Ask::Dissociation(asked), ..command };
        let CommandMessage::Dissociation(message) = CommandMessage::from(&command) else {
            panic!("a dissociation moves no wall by itself");
        };
        let numbers = (message.saturation_loss, message.pore_pressure, message.biot);
        assert_eq!(numbers, (0.25, f64::INFINITY, -0.0));
        assert_eq!(Command::from(message), command);
        let shear = command::Shear { tilt: -0.25, targets };
        let command = Command { ask: Ask::Shear(shear), ..command };
        let CommandMessage::Shear(message) = CommandMessage::from(&command) else {
            panic!("a tilt is no boundary command");
        };
        assert_eq!((message.tilt, message.control), (-0.25, [0, 1, 2, 3, 4, 255]));
        assert_eq!(Command::from(message), command);
    }
}

fn measures(contacts: u32) -> Measures {
    let triples = |scale: f64| (0..3 * contacts).map(|i| scale * f64::from(i)).collect();
    let singles = |scale: f64| (0..contacts).map(|i| scale * f64::from(i)).collect();
    Measures {
        stamp: Stamp { sec: 12, nanosec: 34 },
        increment: 5,
        events: Vec::new(),
        rearrangements: Vec::new(),
        snapshots: Vec::new(),
        surfaces: Vec::new(),
        walls: report::WallForces {
            position: [-1.0, 3.0, -2.0, 2.0, -4.0, 4.0],
            ..report::WallForces::default()
        },
        wall_force_error: 1.2e-9,
        state: None,
        moduli: None,
        tangent: None,
        network: Some(report::ContactNetwork {
            first: (0..contacts).collect(),
            second: (0..contacts).map(|i| i + 1).collect(),
            normal: triples(1.0),
            normal_force: singles(2.0),
            tangential_force: triples(3.0),
            overlap: singles(4.0),
            state: (0..contacts).map(|i| (i % 2) as u8).collect(),
        }),
        grains: None,
        motion: None,
        fabric: None,
        hydrate: None,
        shear: None,
        plane: None,
        bonds: None,
        cracks: None,
    }
}

/// An event of so many grains, contacts lost and contacts made.
fn rearrangement(grains: u32, lost: u32, made: u32) -> report::Rearrangement {
    let vector = |k: u32| [f64::from(k), 0.5, -1.0];
    report::Rearrangement {
        kind: EventKind::StressDrop,
        stress_before: 2.0,
        stress_after: 1.0,
        energy_before: 4.0,
        energy_after: 3.0,
        grains: (0..grains).collect(),
        displacement: (0..grains).map(vector).collect(),
        rotation: (0..grains).map(vector).collect(),
        lost: (0..lost).map(|k| [k, k + 1]).collect(),
        made: (0..made).map(|k| [k, u32::MAX - k % 6]).collect(),
    }
}

#[test]
fn live_chunks_together_are_the_whole_event() {
    for (grains, lost, made) in [(1, 0, 0), (400, 1500, 1500), (401, 7, 1501), (2740, 9000, 3)] {
        let event = rearrangement(grains, lost, made);
        let measures = Measures { rearrangements: vec![event.clone(), event], ..measures(0) };
        let whole: Vec<Rearrangement> = rearrangement::whole(&measures).collect();
        let live = rearrangement::chunks(&measures, LIVE_GRAINS, LIVE_CONTACTS);
        let live: Vec<Rearrangement> = live.collect();
        let count = grains.div_ceil(400).max(lost.div_ceil(1500)).max(made.div_ceil(1500));
        assert_eq!((whole.len(), live.len()), (2, 2 * count as usize));
        for (number, whole) in whole.iter().enumerate() {
            assert_eq!((whole.event, whole.chunk, whole.chunk_count), (number as u32, 0, 1));
            assert_eq!(
                (whole.grains.len(), whole.rotation.len()),
                (grains as usize, 3 * grains as usize)
            );
            let mut joined = Rearrangement {
                grains: Vec::new(),
                displacement: Vec::new(),
                rotation: Vec::new(),
                lost_first: Vec::new(),
                lost_second: Vec::new(),
                made_first: Vec::new(),
                made_second: Vec::new(),
                ..whole.clone()
            };
            let own = live.iter().filter(|chunk| chunk.event == number as u32);
            for (chunk, place) in own.zip(0..) {
                assert_eq!((chunk.chunk, chunk.chunk_count), (place, count));
                assert!(chunk.grains.len() <= 400 && chunk.lost_first.len() <= 1500);
                assert!(chunk.made_first.len() <= 1500);
                joined.grains.extend(&chunk.grains);
                joined.displacement.extend(&chunk.displacement);
                joined.rotation.extend(&chunk.rotation);
                joined.lost_first.extend(&chunk.lost_first);
                joined.lost_second.extend(&chunk.lost_second);
                joined.made_first.extend(&chunk.made_first);
                joined.made_second.extend(&chunk.made_second);
            }
            assert_eq!(joined, *whole);
        }
    }
}

#[test]
fn live_chunks_together_are_the_whole_network() {
    for contacts in [1, 699, 700, 701, 1400, 1401] {
        let measures = measures(contacts);
        let chunks: Vec<_> = convert::network_chunks(&measures, LIVE_CHUNK).collect();
        let count = chunks.len() as u32;
        assert_eq!(count, contacts.div_ceil(700));
        let mut joined = chunks[0].clone();
        for (number, chunk) in chunks.iter().enumerate() {
            assert_eq!((chunk.chunk as usize, chunk.chunk_count), (number, count));
            assert!(chunk.first.len() <= 700);
        }
        for chunk in &chunks[1..] {
            joined.first.extend(&chunk.first);
            joined.second.extend(&chunk.second);
            joined.normal.extend(&chunk.normal);
            joined.normal_force.extend(&chunk.normal_force);
            joined.tangential_force.extend(&chunk.tangential_force);
            joined.overlap.extend(&chunk.overlap);
            joined.state.extend(&chunk.state);
        }
        joined.chunk_count = 1;
        assert_eq!(Some(joined), convert::whole_network(&measures));
    }
}

#[test]
fn a_network_without_contacts_is_one_empty_message() {
    let measures = measures(0);
    let chunks: Vec<_> = convert::network_chunks(&measures, LIVE_CHUNK).collect();
    assert_eq!(chunks.len(), 1);
    assert_eq!((chunks[0].chunk, chunks[0].chunk_count, chunks[0].first.len()), (0, 1, 0));
    assert_eq!(convert::whole_network(&measures).as_ref(), chunks.first());
}

/// A motion of so many grains, every number another one.
fn grain_motion(grains: u32, friction: bool) -> report::GrainMotion {
    let scalar = |scale: f64| (0..grains).map(|i| scale * f64::from(i + 1)).collect::<Vec<_>>();
    let vector = |scale: f64| -> Vec<[f64; 3]> {
        scalar(scale).iter().map(|&x| [x, x + 0.1, x + 0.2]).collect()
    };
    let rotation = |scale: f64| if friction { vector(scale) } else { Vec::new() };
    report::GrainMotion {
        displacement: vector(1e3),
        non_affine: vector(2e3),
        rotation: rotation(3e3),
        total_rotation: rotation(4e3),
        d2min: scalar(5e3),
        shear_strain: scalar(6e3),
        volumetric_strain: scalar(7e3),
        carries: (0..grains).map(|i| i % 3 > 0).collect(),
        localisation: report::Localisation {
            affine_rms: 1.0,
            non_affine_rms: 2.0,
            non_affine_ratio: 3.0,
            rotation_rms: 4.0,
            participation: 5.0,
            rotation_participation: 6.0,
            d2min_top_1: 7.0,
            d2min_top_10: 8.0,
            band: report::Band {
                center: [9.0, 10.0, 11.0],
                normal: [12.0, 13.0, 14.0],
                spread: [15.0, 16.0, 17.0],
                thickness: 18.0,
            },
        },
    }
}

#[test]
fn live_chunks_together_are_the_whole_motion() {
    for (grains, friction) in [(1, true), (450, false), (451, true), (1201, true), (0, false)] {
        let motion = grain_motion(grains, friction);
        let measures = Measures { motion: Some(motion.clone()), ..measures(0) };
        let chunks: Vec<_> = convert::motion_chunks(&measures, convert::LIVE_GRAINS).collect();
        assert_eq!(chunks.len() as u32, grains.div_ceil(450).max(1));
        let mut joined = GrainMotion { first_grain: 0, chunk: 0, ..chunks[0].clone() };
        for (number, chunk) in chunks.iter().enumerate() {
            let numbers = (chunk.chunk as usize, chunk.chunk_count as usize);
            assert_eq!(numbers, (number, chunks.len()));
            assert_eq!(chunk.first_grain as usize, 450 * number);
        }
        for chunk in &chunks[1..] {
            for (all, more) in [
                (&mut joined.displacement, &chunk.displacement),
                (&mut joined.non_affine, &chunk.non_affine),
                (&mut joined.rotation, &chunk.rotation),
                (&mut joined.total_rotation, &chunk.total_rotation),
                (&mut joined.d2min, &chunk.d2min),
                (&mut joined.shear_strain, &chunk.shear_strain),
                (&mut joined.volumetric_strain, &chunk.volumetric_strain),
            ] {
                all.extend(more);
            }
            joined.carries.extend(&chunk.carries);
        }
        joined.chunk_count = 1;
        assert_eq!(Some(&joined), convert::whole_motion(&measures).as_ref());
        assert_eq!(joined.displacement, motion.displacement.concat());
        assert_eq!(joined.non_affine, motion.non_affine.concat());
        assert_eq!(joined.rotation, motion.rotation.concat());
        assert_eq!(joined.total_rotation, motion.total_rotation.concat());
        assert_eq!(joined.d2min, motion.d2min);
        assert_eq!(joined.shear_strain, motion.shear_strain);
        assert_eq!(joined.volumetric_strain, motion.volumetric_strain);
        assert_eq!(joined.carries, motion.carries);
        let GrainMotion { affine_rms, non_affine_rms, non_affine_ratio, .. } = joined;
        assert_eq!([affine_rms, non_affine_rms, non_affine_ratio], [1.0, 2.0, 3.0]);
        let GrainMotion { rotation_rms, participation, rotation_participation, .. } = joined;
        assert_eq!([rotation_rms, participation, rotation_participation], [4.0, 5.0, 6.0]);
        let GrainMotion { d2min_top_1, d2min_top_10, band_thickness, .. } = joined;
        assert_eq!([d2min_top_1, d2min_top_10, band_thickness], [7.0, 8.0, 18.0]);
        let GrainMotion { band_center, band_normal, band_spread, .. } = joined;
        let band = [band_center, band_normal, band_spread].concat();
        assert_eq!(band, (9..18).map(f64::from).collect::<Vec<_>>());
    }
}

/// So many bonds, every number another one.
fn bonds(count: u32) -> report::Bonds {
    let singles = |scale: f64| (0..count).map(|i| scale + f64::from(i)).collect::<Vec<f64>>();
    let triples = |scale: f64| (0..3 * count).map(|i| scale + f64::from(i)).collect::<Vec<f64>>();
    report::Bonds {
        tensile_strength: 2e6,
        shear_strength: f64::INFINITY,
        first: (0..count).collect(),
        second: (0..count).map(|i| u32::MAX - i % 6).collect(),
        condition: (0..count).map(|i| (i % 3) as u8).collect(),
        share: singles(1e4),
        radius: singles(2e4),
        position: triples(3e4),
        normal: triples(4e4),
        normal_force: singles(5e4),
        tangential_force: triples(6e4),
        torsion: singles(7e4),
        strength_use: singles(8e4),
    }
}

#[test]
fn live_chunks_together_are_all_bonds() {
    for count in [0, 1, 439, 440, 441, 1300] {
        let told = bonds(count);
        let measures = Measures { bonds: Some(told.clone()), ..measures(0) };
        let chunks: Vec<_> = convert::bond_chunks(&measures, convert::LIVE_BONDS).collect();
        assert_eq!(chunks.len() as u32, count.div_ceil(440).max(1));
        for (number, chunk) in chunks.iter().enumerate() {
            let numbers = (chunk.chunk as usize, chunk.chunk_count as usize);
            assert_eq!(numbers, (number, chunks.len()));
            assert_eq!([chunk.tensile_strength, chunk.shear_strength], [2e6, f64::INFINITY]);
            assert!(chunk.first.len() <= 440);
        }
        let joined = report::Bonds {
            tensile_strength: 2e6,
            shear_strength: f64::INFINITY,
            first: chunks.iter().flat_map(|chunk| chunk.first.clone()).collect(),
            second: chunks.iter().flat_map(|chunk| chunk.second.clone()).collect(),
            condition: chunks.iter().flat_map(|chunk| chunk.condition.clone()).collect(),
            share: chunks.iter().flat_map(|chunk| chunk.share.clone()).collect(),
            radius: chunks.iter().flat_map(|chunk| chunk.radius.clone()).collect(),
            position: chunks.iter().flat_map(|chunk| chunk.position.clone()).collect(),
            normal: chunks.iter().flat_map(|chunk| chunk.normal.clone()).collect(),
            normal_force: chunks.iter().flat_map(|chunk| chunk.normal_force.clone()).collect(),
            tangential_force: (chunks.iter().flat_map(|chunk| chunk.tangential_force.clone()))
                .collect(),
            torsion: chunks.iter().flat_map(|chunk| chunk.torsion.clone()).collect(),
            strength_use: chunks.iter().flat_map(|chunk| chunk.strength_use.clone()).collect(),
        };
        assert_eq!(joined, told);
        let whole = convert::whole_bonds(&measures).unwrap();
        assert_eq!((whole.chunk, whole.chunk_count), (0, 1));
        assert_eq!((whole.first, whole.strength_use), (told.first, told.strength_use));
    }
}

/// The crack number `k` of an increment.
fn crack(k: u32) -> report::Crack {
    let number = |scale: f64| scale + f64::from(k);
    report::Crack {
        first: k,
        second: u32::MAX - k % 6,
        mode: if k.is_multiple_of(2) { BondCondition::Tension } else { BondCondition::Shear },
        substep: k / 3,
        position: [number(1e4), number(2e4), number(3e4)],
        normal: [number(4e4), number(5e4), number(6e4)],
        normal_force: -number(7e4),
        tangential_force: number(8e4),
        torsion: number(9e4),
        overload: number(1e5),
        stress_before: number(2e5),
        stress_after: number(3e5),
        energy_released: number(4e5),
    }
}

#[test]
fn live_chunks_together_are_all_cracks_in_their_order() {
    for count in [0, 1, 440, 441, 1300] {
        let list: Vec<report::Crack> = (0..count).map(crack).collect();
        let told = report::Cracks { intact: 7, tension: 8, shear: 9, list };
        let measures = Measures { cracks: Some(told.clone()), ..measures(0) };
        let chunks: Vec<_> = convert::crack_chunks(&measures, convert::LIVE_BONDS).collect();
        assert_eq!(chunks.len() as u32, count.div_ceil(440).max(1));
        let mut k = 0;
        for (number, chunk) in chunks.iter().enumerate() {
            let numbers = (chunk.chunk as usize, chunk.chunk_count as usize);
            assert_eq!(numbers, (number, chunks.len()));
            let Cracks { intact, broken_by_tension, broken_by_shear, .. } = chunk;
            assert_eq!([*intact, *broken_by_tension, *broken_by_shear], [7, 8, 9]);
            for i in 0..chunk.first.len() {
                let found = report::Crack {
                    first: chunk.first[i],
                    second: chunk.second[i],
                    mode: match chunk.mode[i] {
                        1 => BondCondition::Tension,
                        2 => BondCondition::Shear,
                        other => panic!("{other}"),
                    },
                    substep: chunk.substep[i],
                    position: std::array::from_fn(|axis| chunk.position[3 * i + axis]),
                    normal: std::array::from_fn(|axis| chunk.normal[3 * i + axis]),
                    normal_force: chunk.normal_force[i],
                    tangential_force: chunk.tangential_force[i],
                    torsion: chunk.torsion[i],
                    overload: chunk.overload[i],
                    stress_before: chunk.stress_before[i],
                    stress_after: chunk.stress_after[i],
                    energy_released: chunk.energy_released[i],
                };
                assert_eq!(found, told.list[k]);
                k += 1;
            }
        }
        assert_eq!(k as u32, count);
        assert_eq!(convert::whole_cracks(&measures).unwrap().first.len() as u32, count);
    }
}

#[test]
fn measures_nobody_asked_for_make_no_message() {
    let measures = Measures { network: None, ..measures(3) };
    assert_eq!(convert::network_chunks(&measures, LIVE_CHUNK).count(), 0);
    assert_eq!(convert::pack_state(&measures), None);
    assert_eq!(convert::moduli(&measures), None);
    assert_eq!(convert::whole_motion(&measures), None);
    assert_eq!(convert::fabric(&measures), None);
    assert_eq!(convert::whole_bonds(&measures), None);
    assert_eq!(convert::whole_cracks(&measures), None);
    assert_eq!(convert::tangent(&measures), None);
}

/// A force F at the centre of the wall x_max, 2 m from the centre of the box along x, turns about
/// that centre by (2, 0, 0) x F, and about the wall's own centre not at all.
#[test]
fn a_wall_wrench_is_taken_about_the_centre_of_the_wall() {
    let mut measures = measures(0);
    measures.walls.force[1] = [10.0, 20.0, 30.0];
    measures.walls.moment[1] = [0.0, -60.0, 40.0];
    let wrench = convert::wall_wrench(&measures, 1);
    assert_eq!(wrench.header.frame_id, "wall_x_max");
    assert_eq!(wrench.wrench.force, Vector3 { x: 10.0, y: 20.0, z: 30.0 });
    assert_eq!(wrench.wrench.torque, Vector3::default());
}

/// The box from (-1, -2, -4) to (3, 2, 4) has its centre at (1, 0, 0).
#[test]
fn the_frame_of_a_wall_stands_at_its_centre_with_the_axes_of_the_pack() {
    let frames = convert::wall_frames(&measures(0)).transforms;
    let origins = [
        [-1.0, 0.0, 0.0],
        [3.0, 0.0, 0.0],
        [1.0, -2.0, 0.0],
        [1.0, 2.0, 0.0],
        [1.0, 0.0, -4.0],
        [1.0, 0.0, 4.0],
    ];
    let (roots, frames) = frames.split_at(2);
    for (root, name) in roots.iter().zip(["pack", "pack_view"]) {
        assert_eq!((&*root.header.frame_id, &*root.child_frame_id), ("world", name));
        assert_eq!(root.transform, Transform::default());
    }
    assert_eq!(frames.len(), origins.len());
    for ((frame, origin), name) in frames.iter().zip(origins).zip(wall::NAMES) {
        assert_eq!(frame.header.frame_id, "pack");
        assert_eq!(frame.child_frame_id, format!("wall_{name}"));
        assert_eq!(frame.transform.translation, Vector3::from(origin));
        assert_eq!(frame.transform.rotation, Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 });
    }
}

#[test]
fn a_discrepancy_is_twin_minus_rig_where_the_rig_was_measured() {
    let mut found = discrepancy::Discrepancy::unmeasured(
        Stamp { sec: 3, nanosec: 4 },
        7,
        [1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
    );
    (found.rig[5], found.delay[5]) = (8.5, -0.25);
    let message = convert::discrepancy(&found);
    assert_eq!((message.header.stamp, message.increment), (Time { sec: 3, nanosec: 4 }, 7));
    assert_eq!(message.valid, [false, false, false, false, false, true]);
    assert_eq!(message.twin_force, found.twin);
    assert_eq!((message.rig_force[5], message.difference[5], message.delay[5]), (8.5, -2.5, -0.25));
    for wall in 0..5 {
        assert!(message.rig_force[wall].is_nan() && message.difference[wall].is_nan());
        assert!(message.delay[wall].is_nan());
    }
}

#[test]
fn a_report_of_an_equilibrium_says_how_exact_its_wall_forces_are() {
    let said = |text: &str, measures: Option<Measures>| {
        let report = report::Report {
            stamp: Stamp { sec: 12, nanosec: 34 },
            session: "test".into(),
            sequence: 5,
            increment: 5,
            disposition: Disposition::Applied,
            substeps: 1,
            text: text.into(),
            measures,
        };
        Report::from(&report).text
    };
    let exact = "wall forces within 1.2e-9 N of the exact equilibrium";
    assert_eq!(said("", Some(measures(3))), exact);
    assert_eq!(said("clamped", Some(measures(3))), format!("clamped; {exact}"));
    assert_eq!(said("too far", None), "too far");
}
