//! The variants of the job.

use std::path::Path;

use graintwin::report::Demand;
use graintwin::scene::{self, Loaded};

/// Who takes the answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Listens {
    Nobody,
    Recorder,
    Node,
    Subscriber,
}

impl Listens {
    /// Whether the serving thread does the same in every run.
    pub(crate) fn is_deterministic(self) -> bool {
        match self {
            Self::Nobody | Self::Recorder => true,
            Self::Node | Self::Subscriber => false,
        }
    }
}

/// The job with one feature set.
pub(crate) struct Variant {
    pub(crate) feature: &'static str,
    /// How it is set.
    pub(crate) setting: &'static str,
    /// What the scene says of it, YAML.
    physics: &'static str,
    /// What is asked for, beside what who listens wants.
    pub(crate) demand: Demand,
    pub(crate) listens: Listens,
}

impl Variant {
    /// The scene of the job with this variant's physics.
    pub(crate) fn scene(&self) -> Loaded {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/g2740.yaml");
        let job = std::fs::read_to_string(&file).expect("it is shipped");
        let scene = scene::parse(&format!("{job}{}", self.physics), &file).expect("a scene");
        Loaded { scene, file }
    }
}

/// Nothing but wall forces, which are always there.
const NOTHING: Demand = Demand::NONE;

/// Measures that take scenes which ask for them.
const TANGENT: Demand = Demand { tangent: true, ..NOTHING };
const MOTION: Demand = Demand { grain_motion: true, ..NOTHING };

/// Cement of T 4.8.
const EXPONENTIAL: &str = "contact: {normal: {cement: {law: {exponential: {gamma: 3000.0}}}}}\n";
const PARALLEL: &str = "contact: {normal: {cement: {law: {parallel: {young: 70.0e9, shear: 29.2e9, \
     radius_ratio: 0.003, length_ratio: 0.001}}}}}\n";

/// Every variant; the first is the one with everything off.
pub(crate) fn variants() -> Vec<Variant> {
    let physics = |feature, setting, physics| Variant {
        feature,
        setting,
        physics,
        demand: NOTHING,
        listens: Listens::Nobody,
    };
    let asked = |feature, demand| Variant {
        feature,
        setting: "on",
        physics: "",
        demand,
        listens: Listens::Nobody,
    };
    let ordered = |feature, demand, outputs| Variant { demand, ..physics(feature, "on", outputs) };
    let rough = "contact: {friction: {coefficient: 0.3}, torsion: false}\n";
    let heard = |feature, setting, listens| Variant {
        feature,
        setting,
        physics: "",
        demand: NOTHING,
        listens,
    };
    vec![
        physics("none of them", "off", ""),
        physics("friction", "off: coefficient 0", "contact: {friction: {coefficient: 0.0}}\n"),
        physics("friction", "on: 0.3", rough),
        physics("torsion", "off: no friction", "contact: {torsion: true}\n"),
        physics("torsion", "on, with friction", "contact: {friction: {coefficient: 0.3}}\n"),
        physics("cement", "off: Hertz", "contact: {normal: hertz}\n"),
        physics("cement", "on: exponential", EXPONENTIAL),
        physics("cement", "on: parallel bond", PARALLEL),
        physics("gravity", "off: zero", "gravity: [0.0, 0.0, 0.0]\n"),
        physics("gravity", "on: 9.81 m/s²", "gravity: [0.0, 0.0, -9.81]\n"),
        asked("state measures", Demand { state: true, ..NOTHING }),
        asked("moduli", Demand { moduli: true, ..NOTHING }),
        ordered("tangent moduli", TANGENT, "outputs: {moduli: both}\n"),
        asked("contact network", Demand { contact_network: true, ..NOTHING }),
        asked("grains", Demand { grains: true, ..NOTHING }),
        ordered("motion of the grains", MOTION, "outputs: {grain_motion: on_demand}\n"),
        asked("force network statistics", Demand { fabric: true, ..NOTHING }),
        asked("rearrangements", Demand { rearrangements: true, ..NOTHING }),
        asked("snapshots", Demand { snapshots: true, ..NOTHING }),
        ordered("all of them", Demand::ALL, "outputs: {moduli: both, grain_motion: on_demand}\n"),
        heard("recording", "on", Listens::Recorder),
        heard("ROS 2 node", "nobody subscribed", Listens::Node),
        heard("ROS 2 node", "contact network subscribed", Listens::Subscriber),
    ]
}
