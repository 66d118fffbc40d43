//! A scene written with all its defaults reads back as the same scene.

use std::collections::BTreeMap;
use std::path::Path;

use graintwin::scene::{
    self, Axis, Cement, CementLaw, CementStrength, Choice, ColorBy, Compression, Contact, Coulomb,
    Crystal, Discovery, Exponential, Fault, Friction, Generate, Grading, Hydrate, Isotropic, Joint,
    JointStates, JointTrajectory, Late, Lateral, Law, Limits, LoadPath, Material, MeasuredWrench,
    Method, ModuliKind, Moving, Node, Normal, Outputs, PackSource, Parallel, Polyaxial, Power,
    Radius, Record, Repeat, RigLog, Rotation, Scene, ServiceMapping, Solution, Solver, Step,
    StrainUnit, Targets, Triaxial, Uniaxial, Unload, Update, View, WallName, Walls, WallsStep,
    When, Zero, prepare,
};
use graintwin::wall::Bounds;
use graintwin::wall::WallTarget;
use proptest::option;
use proptest::prelude::*;

fn word() -> impl Strategy<Value = String> {
    // Words that YAML would rather take for something else are among them.
    prop_oneof![
        "[a-zA-Z][a-zA-Z0-9_ %.-]{0,11}[a-zA-Z0-9]",
        Just("yes".into()),
        Just("null".into()),
        Just("1e-3".into()),
        Just("y".into()),
        Just("- a: b # c".into()),
        Just("µ'\"ε".into()),
    ]
}

fn positive() -> impl Strategy<Value = f64> {
    (-290.0..290.0_f64).prop_map(|exponent| 10_f64.powf(exponent))
}

fn material() -> impl Strategy<Value = Material> {
    (positive(), -0.98..0.49, positive(), 0.0..0.3)
        .prop_map(|(young, poisson, density, spread)| Material { young, poisson, density, spread })
}

fn bounds() -> impl Strategy<Value = Bounds> {
    (prop::array::uniform3(-1.0..1.0), prop::array::uniform3(1e-9..1.0)).prop_map(|(min, side)| {
        Bounds { min, max: std::array::from_fn(|axis: usize| min[axis] + side[axis] + 1e-9) }
    })
}

fn radius() -> impl Strategy<Value = Radius> {
    prop_oneof![
        positive().prop_map(Radius::Constant),
        (positive(), 1.0..100.0).prop_map(|(low, ratio)| Radius::Uniform([low, low * ratio])),
        grading().prop_map(Radius::GradingA),
        grading().prop_map(Radius::GradingB),
    ]
}

fn grading() -> impl Strategy<Value = Grading> {
    (positive(), 1.0..100.0).prop_map(|(mean, ratio)| Grading { mean, ratio })
}

fn generate() -> impl Strategy<Value = Generate> {
    let sizes = (1..10_000_000_usize, radius(), any::<u64>(), positive());
    (sizes, prop::array::uniform3(0.01..100.0), 0..1000_u32).prop_map(
        |((grains, radius, seed, confining_stress), aspect, expand_floaters)| Generate {
            grains,
            radius,
            material: "glass".into(),
            seed,
            confining_stress,
            aspect,
            expand_floaters,
            // Only discs are compacted with friction.
            compaction_friction: 0.0,
        },
    )
}

fn steps() -> impl Strategy<Value = Vec<prepare::Step>> {
    let isotropic = positive().prop_map(|confining_stress| {
        prepare::Step::Isotropic(prepare::Isotropic { confining_stress })
    });
    let steady = (1e-6..1.0, 1..100_u32, 0.01..0.499).prop_map(|(steady, window, max_strain)| {
        prepare::End::Steady(prepare::Steady { steady, window, max_strain })
    });
    let end = prop_oneof![steady, (-0.499..-1e-9).prop_map(prepare::End::Strain)];
    let uniaxial =
        (axis(), moving(), 1e-7..1e-4, end).prop_map(|(axis, moving, strain_increment, end)| {
            prepare::Step::Uniaxial(prepare::Uniaxial { axis, moving, strain_increment, end })
        });
    let rescale = (1e-6..1e6, any::<bool>()).prop_map(|(factor, lengths)| {
        prepare::Step::Rescale(match lengths {
            true => prepare::Rescale::Lengths(factor),
            false => prepare::Rescale::Forces(factor),
        })
    });
    prop::collection::vec(prop_oneof![isotropic, uniaxial, rescale], 0..3)
}

/// A coefficient of friction.
fn coefficient() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..10.0, Just(0.0), Just(f64::INFINITY)]
}

fn friction() -> impl Strategy<Value = Friction> {
    let law = prop::sample::select(vec![Law::ReturnMap, Law::Secant, Law::MindlinDeresiewicz]);
    let update = prop::sample::select(vec![Update::Frozen, Update::Current]);
    let coulomb = (coefficient(), law, update).prop_map(|(coefficient, law, update)| Coulomb {
        coefficient,
        law,
        update,
    });
    prop_oneof![Just(Friction::None), coulomb.prop_map(Friction::Coulomb)]
}

fn normal() -> impl Strategy<Value = Normal> {
    let [a, b] = [positive(), positive()];
    let law = prop_oneof![
        Just(CementLaw::Fixed),
        Just(CementLaw::LinearElastic),
        positive().prop_map(|gamma| CementLaw::Exponential(Exponential { gamma })),
        (a, b).prop_map(|(eta, omega)| CementLaw::Power(Power { eta, omega })),
        (positive(), positive(), positive(), positive()).prop_map(|of| {
            let (young, shear, radius_ratio, length_ratio) = of;
            CementLaw::Parallel(Parallel { young, shear, radius_ratio, length_ratio })
        }),
    ];
    let strength = || prop_oneof![positive(), Just(f64::INFINITY)];
    let strength =
        (strength(), strength()).prop_map(|(tension, shear)| CementStrength { tension, shear });
    let shares = (0.0..=1.0, 0.0..=1.0, 0.0..0.99);
    let cement = (law, positive(), shares, any::<bool>(), option::of(strength));
    let cement = cement.prop_map(|(law, kappa, shares, walls, strength)| {
        let (partial_slip, bridge, saturation) = shares;
        let solution = Solution::default();
        let cement =
            Cement { law, kappa, partial_slip, bridge, walls, saturation, solution, strength };
        Normal::Cement(cement)
    });
    prop_oneof![Just(Normal::Hertz), cement]
}

fn pack() -> impl Strategy<Value = PackSource> {
    let made = (generate(), option::of(bounds()), steps()).prop_map(|(generate, cut, prepare)| {
        PackSource {
            generate: Some(generate),
            crystal: None,
            file: None,
            bounds: None,
            material: None,
            cut,
            hydrate: None,
            seed: 0,
            prepare,
        }
    });
    let read = (word(), option::of(bounds()), option::of(bounds()), any::<u64>(), steps())
        .prop_map(|(file, bounds, cut, seed, prepare)| PackSource {
            generate: None,
            crystal: None,
            file: Some(file.into()),
            bounds,
            material: Some("quartz".into()),
            cut,
            hydrate: Some(Hydrate { saturation: 0.22, material: "hydrate".into() }),
            seed,
            prepare,
        });
    let crystal = (1..10_000_usize, 1..9_999_usize, positive(), any::<u64>());
    let laid_out = crystal.prop_map(|(rows, columns, radius, seed)| PackSource {
        generate: None,
        crystal: Some(Crystal {
            rows,
            columns: [columns, columns + 1],
            radius,
            material: "glass".into(),
        }),
        file: None,
        bounds: None,
        material: None,
        cut: None,
        hydrate: None,
        seed,
        prepare: Vec::new(),
    });
    prop_oneof![made, read, laid_out]
}

/// Whether a step waits for contacts to slide.
fn waits(step: &prepare::Step) -> bool {
    matches!(step, prepare::Step::Uniaxial(step) if matches!(step.end, prepare::End::Steady(_)))
}

fn strain() -> impl Strategy<Value = f64> {
    -0.999..0.999
}

/// A strain or a stress.
fn way() -> impl Strategy<Value = (Option<f64>, Option<f64>)> {
    prop_oneof![
        strain().prop_map(|strain| (Some(strain), None)),
        positive().prop_map(|stress| (None, Some(stress))),
    ]
}

fn targets() -> impl Strategy<Value = Targets> {
    let target = prop_oneof![
        Just(WallTarget::Keep),
        (-1.0..1.0).prop_map(WallTarget::Displacement),
        positive().prop_map(WallTarget::Force),
        positive().prop_map(WallTarget::Stress),
    ];
    prop::array::uniform3((target, any::<bool>())).prop_map(|pairs| {
        let both = |(target, both): (WallTarget, bool)| {
            [target, if both { target } else { WallTarget::Keep }]
        };
        let [x, y, z] = pairs.map(both);
        Targets::from([x[0], x[1], y[0], y[1], z[0], z[1]])
    })
}

fn axis() -> impl Strategy<Value = Axis> {
    prop::sample::select(vec![Axis::X, Axis::Y, Axis::Z])
}

fn moving() -> impl Strategy<Value = Moving> {
    prop::sample::select(vec![Moving::Both, Moving::Min, Moving::Max])
}

fn rig_log() -> impl Strategy<Value = RigLog> {
    let unit =
        prop::sample::select(vec![StrainUnit::Ratio, StrainUnit::Percent, StrainUnit::Microstrain]);
    let lateral =
        prop::sample::select(vec![Lateral::ConstantVolume, Lateral::Fixed, Lateral::Free]);
    (word(), word(), unit, lateral, axis()).prop_map(|(file, time, unit, lateral, axis)| RigLog {
        file: file.into(),
        axial_strain: format!("{time} strain"),
        time,
        unit,
        lateral,
        axis,
    })
}

fn step() -> impl Strategy<Value = Step> {
    let count = 1..1000_u32;
    let leaf = prop_oneof![
        (way(), count.clone(), moving()).prop_map(|((strain, stress), increments, moving)| {
            Step::Isotropic(Isotropic { strain, stress, increments, moving })
        }),
        (axis(), way(), count.clone(), moving()).prop_map(
            |(axis, (strain, stress), increments, moving)| {
                Step::Uniaxial(Uniaxial { axis, strain, stress, increments, moving })
            }
        ),
        (axis(), way(), way(), count.clone(), moving()).prop_map(
            |(axis, axial, lateral, increments, moving)| {
                Step::Triaxial(Triaxial {
                    axis,
                    axial_strain: axial.0,
                    axial_stress: axial.1,
                    lateral_strain: lateral.0,
                    lateral_stress: lateral.1,
                    increments,
                    moving,
                })
            }
        ),
        (prop::array::uniform3(strain()), any::<bool>(), count.clone(), moving()).prop_map(
            |(values, strains, increments, moving)| {
                let strain = strains.then_some(values);
                let stress = (!strains).then(|| values.map(|value| 1e6 * (1.0 + value)));
                Step::Polyaxial(Polyaxial { strain, stress, increments, moving })
            }
        ),
        (targets(), count.clone())
            .prop_map(|(targets, increments)| { Step::Walls(WallsStep { targets, increments }) }),
        (0.0..0.999, count).prop_map(|(to, increments)| Step::Unload(Unload { to, increments })),
        word().prop_map(|file| Step::Commands(file.into())),
        rig_log().prop_map(Step::RigLog),
    ];
    leaf.prop_recursive(2, 8, 3, |inner| {
        (1..10_u32, prop::collection::vec(inner, 0..3))
            .prop_map(|(times, steps)| Step::Repeat(Repeat { times, steps }))
    })
}

fn solver() -> impl Strategy<Value = Solver> {
    let method = prop::sample::select(vec![
        Method::Newton,
        Method::ConjugateGradient,
        Method::GaussSeidel,
        Method::Dynamic,
    ]);
    let steps = (prop::option::of(1..10_000_000_u32), 1e-4..0.5, 1e-9..0.999_f64);
    (method, -13.0..-2.0_f64, 1e-12..0.1, 1e-6..100.0, steps).prop_map(
        |(method, exponent, max_strain_increment, max_overlap_share, steps)| Solver {
            method,
            tolerance: 10_f64.powf(exponent),
            max_strain_increment,
            max_overlap_share,
            max_iterations: steps.0,
            sweeps: None,
            step_cap: steps.1,
            damping: steps.2,
        },
    )
}

/// Joints, each with a wall of its own.
fn joints() -> impl Strategy<Value = BTreeMap<String, Joint>> {
    use WallName::{XMax, XMin, YMax, YMin, ZMax, ZMin};
    let walls = prop::sample::subsequence(vec![XMin, XMax, YMin, YMax, ZMin, ZMax], 1..=6);
    (walls, word(), prop::sample::select(vec![1.0, -1.0]), positive(), -1e3..1e3).prop_map(
        |(walls, name, sign, gear, zero)| {
            let joint = |wall| Joint { wall, sign, gear, zero: Zero::At(zero) };
            walls.into_iter().map(|wall| (format!("{name}{wall:?}"), joint(wall))).collect()
        },
    )
}

fn limits() -> impl Strategy<Value = Limits> {
    (prop::array::uniform4(prop_oneof![Just(0.0), positive()]), any::<bool>()).prop_map(
        |([travel, rate, strain, force], clamp)| Limits { travel, rate, strain, force, clamp },
    )
}

fn node() -> impl Strategy<Value = Node> {
    let reach = prop::sample::select(vec![Discovery::Localhost, Discovery::Subnet]);
    let faults = prop::sample::subsequence(vec![Fault::NotConverged, Fault::Limit], 0..=2);
    let late = prop::sample::select(vec![Late::Every, Late::Merge]);
    let states = (word(), joints(), any::<bool>()).prop_map(|(session, mut joints, first)| {
        joints.values_mut().filter(|_| first).for_each(|joint| joint.zero = Zero::First);
        JointStates { session, joints }
    });
    let trajectory =
        (word(), joints()).prop_map(|(session, joints)| JointTrajectory { session, joints });
    let mapping = prop::sample::select(vec![
        ServiceMapping::Auto,
        ServiceMapping::Enhanced,
        ServiceMapping::Cyclone,
    ]);
    let cells =
        (any::<[bool; 6]>(), any::<bool>(), 0.0..10.0).prop_map(|(walls, positive, max_delay)| {
            MeasuredWrench { walls, sign: if positive { 1.0 } else { -1.0 }, max_delay }
        });
    let switches = (any::<bool>(), any::<bool>(), mapping, cells);
    let rest = (faults, late, option::of(states), option::of(trajectory));
    (reach, 0..=232_u16, 0.0..1e6, switches, limits(), rest).prop_map(
        |(discovery, domain_id, stale_after, switches, limits, rest)| {
            let (hold_after, late, joint_states, joint_trajectory) = rest;
            let (virtual_rig, use_sim_time, service_mapping, measured_wrench) = switches;
            Node {
                discovery,
                domain_id,
                stale_after,
                limits,
                hold_after,
                late,
                joint_states,
                joint_trajectory,
                virtual_rig,
                service_mapping,
                use_sim_time,
                measured_wrench,
            }
        },
    )
}

fn service() -> impl Strategy<Value = (Outputs, Node, Record)> {
    let when = prop::sample::select(vec![When::Always, When::OnDemand, When::Never]);
    let moduli = prop::sample::select(vec![
        ModuliKind::Secant,
        ModuliKind::Tangent,
        ModuliKind::Both,
        ModuliKind::None,
    ]);
    let cement = (when.clone(), when.clone());
    let measures = (when.clone(), when.clone(), when.clone(), when.clone(), cement);
    let outputs = (when.clone(), when, moduli, measures, 1e-9..1.0);
    let outputs = outputs.prop_map(|(contact_network, markers, moduli, measures, chain_share)| {
        let (grain_motion, fabric, rearrangements, snapshots, (bonds, cracks)) = measures;
        Outputs {
            contact_network,
            markers,
            grain_motion,
            moduli,
            fabric,
            chain_share,
            rearrangements,
            snapshots,
            bonds,
            cracks,
        }
    });
    let kind = prop::sample::select(vec![Compression::Zstd, Compression::Lz4, Compression::None]);
    let record = ((1_u64 << 20)..=(1 << 30), kind).prop_map(|(chunk, compression)| Record {
        chunk,
        compression,
        ..Record::default()
    });
    (outputs, node(), record)
}

fn view() -> impl Strategy<Value = View> {
    let scale = option::of(1e-12..1e12).prop_map(choice);
    let range = option::of((-1e9..0.0, 1e-9..1e9)).prop_map(|r| choice(r.map(|(a, b)| [a, b])));
    let every = option::of(1..1_000_000_000_u64).prop_map(choice);
    let color = prop::sample::select(vec![ColorBy::Force, ColorBy::Displacement]);
    (scale, color, range, 1e-3..=1.0, every).prop_map(|(scale, color, range, opacity, every)| {
        View { scale, color, range, opacity, every }
    })
}

fn choice<T>(value: Option<T>) -> Choice<T> {
    value.map_or(Choice::Auto, Choice::Given)
}

fn scene() -> impl Strategy<Value = Scene> {
    let materials = prop::collection::btree_map(word(), material(), 0..3);
    let walls = (positive(), -0.999..0.499, option::of(coefficient()), targets()).prop_map(
        |(young, poisson, friction, targets)| Walls {
            young,
            poisson,
            friction,
            targets,
            ..Walls::default()
        },
    );
    let contact = (normal(), friction(), any::<bool>()).prop_map(|(normal, friction, torsion)| {
        Contact { normal, friction, torsion, rotation: Rotation::Free }
    });
    let laws = (walls, contact, prop::array::uniform3(-1e3..1e3), option::of(bounds()));
    let path = prop::collection::vec(step(), 0..4);
    (word(), materials, laws, pack(), solver(), path, (service(), view())).prop_map(
        |(name, own, (walls, contact, gravity, reference), mut pack, solver, path, service)| {
            let ((outputs, node, record), view) = service;
            let mut materials: BTreeMap<_, _> =
                scene::parse("pack: {file: a}", Path::new("a")).unwrap().materials;
            materials.extend(own);
            if contact.friction == Friction::None {
                // Such a scene is refused: no contact would slide.
                pack.prepare.retain(|step| !waits(step));
            }
            Scene {
                name,
                dimension: 3,
                materials,
                walls,
                pack,
                contact,
                gravity,
                reference,
                solver,
                load_path: LoadPath(path),
                outputs,
                node,
                record,
                view,
            }
        },
    )
}

proptest! {
    #[test]
    fn an_echoed_scene_reads_back_equal(scene in scene()) {
        let yaml = scene.to_yaml().unwrap();
        match scene::parse(&yaml, Path::new("echo.yaml")) {
            Ok(again) => prop_assert_eq!(again, scene, "{}", yaml),
            Err(error) => prop_assert!(false, "{error}\n{yaml}"),
        }
    }
}

#[test]
fn an_echo_holds_every_key_of_the_format() {
    let scene = scene::parse("pack: {file: a.csv}", Path::new("a")).unwrap();
    let yaml = scene.to_yaml().unwrap();
    for key in [
        "name",
        "dimension",
        "materials",
        "walls",
        "pack",
        "contact",
        "gravity",
        "solver",
        "load_path",
        "outputs",
        "node",
        "record",
        "view",
    ] {
        assert!(yaml.contains(&format!("\n{key}:")) || yaml.starts_with(key), "{key}\n{yaml}");
    }
}
