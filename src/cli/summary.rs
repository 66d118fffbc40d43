//! What a run came to: a table for people, JSON for programs.

mod table;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use serde::Serialize;

use graintwin::command::Disposition;
use graintwin::measure::coordination::Histograms;
use graintwin::pack::prepare::Reached;
use graintwin::report::{
    Demand, Event, EventKind, Fabric, Hydrate, Localisation, Measures, Moduli, PackState,
    PlaneState, Tangent, WallForces,
};
use graintwin::scene::{Friction, Loaded, Outputs, When};
use graintwin::sink::{Served, Sink};
use graintwin::twin::Twin;
use graintwin::wall::Bounds;

use super::Failure;
use super::specimen::Specimen;

/// Collects answers; SI units, names as in the messages.
#[derive(Debug, Serialize)]
pub(super) struct Summary {
    version: &'static str,
    scene: String,
    file: PathBuf,
    grains: usize,
    #[serde(rename = "box")]
    bounds: Bounds,
    /// What the preparation of the pack reached, one entry a step.
    #[serde(skip)]
    prepared: Vec<Reached>,
    /// Commands by what became of them.
    commands: BTreeMap<String, u64>,
    /// Commands that did not move the walls though they should have.
    refused: u64,
    /// The first of them, in words.
    first_refusal: Option<String>,
    increments: u64,
    substeps: u64,
    iterations: u64,
    /// Frictional contacts that opened and that formed, summed over the increments.
    opened: u64,
    formed: u64,
    /// Sudden changes, in order.
    events: Vec<Happened>,
    worst_residual: f64,
    solve_seconds: f64,
    /// Whether the scene has friction.
    #[serde(skip)]
    frictional: bool,
    /// Axes that the pack has walls along.
    #[serde(skip)]
    axes: usize,
    /// The node, when there was one.
    #[cfg(feature = "ros")]
    node: Option<graintwin::node::Summary>,
    /// The rig inside the program, when there was one.
    #[cfg(feature = "ros")]
    virtual_rig: Option<graintwin::node::rig::Played>,
    /// The recording, when there is one.
    #[cfg(feature = "mcap")]
    recording: Option<graintwin::record::Recorded>,
    /// What was lost on the way out, in words.
    lost: Vec<String>,
    /// How many grains have 0, 1, 2, ... contacts at the end.
    coordination: Histograms,
    /// How unevenly the grains moved in the last increment, unless the scene says never.
    grain_motion: Option<Localisation>,
    /// Statistics of the force network at the end.
    fabric: Option<Fabric>,
    /// What became of the cement; nothing without any.
    cement: Option<Cement>,
    /// The initial equilibrium.
    start: Option<Moment>,
    /// The last one.
    end: Option<Moment>,
}

/// One equilibrium.
#[derive(Clone, Debug, Serialize)]
struct Moment {
    increment: u64,
    walls: WallForces,
    /// Estimated error of the normal forces on the walls, the largest \[N\].
    wall_force_error: f64,
    state: Option<PackState>,
    moduli: Option<Moduli>,
    tangent: Option<Tangent>,
    /// When the pack has hydrate.
    #[serde(skip_serializing_if = "Option::is_none")]
    hydrate: Option<Hydrate>,
    /// Of discs.
    #[serde(skip_serializing_if = "Option::is_none")]
    plane: Option<PlaneState>,
}

/// The bonds at the end, and what broke in this run.
#[derive(Debug, Serialize)]
struct Cement {
    bonds: u32,
    intact: u32,
    broken_by_tension: u32,
    broken_by_shear: u32,
    /// Bonds that broke in the increments of this run.
    cracks: u64,
    /// Energy that was lost with them \[J\].
    broken_energy: f64,
}

/// One event and when it was.
#[derive(Debug, Serialize)]
struct Happened {
    increment: u64,
    #[serde(flatten)]
    event: Event,
}

impl Summary {
    pub(super) fn new(loaded: &Loaded, specimen: &Specimen) -> Self {
        let Specimen { pack, prepared } = specimen;
        Self {
            version: env!("CARGO_PKG_VERSION"),
            scene: loaded.scene.name.clone(),
            file: loaded.file.clone(),
            grains: pack.grains.len(),
            bounds: pack.bounds,
            prepared: prepared.clone(),
            commands: BTreeMap::new(),
            refused: 0,
            first_refusal: None,
            increments: 0,
            substeps: 0,
            iterations: 0,
            opened: 0,
            formed: 0,
            events: Vec::new(),
            worst_residual: 0.0,
            solve_seconds: 0.0,
            frictional: loaded.scene.contact.friction != Friction::None,
            axes: usize::from(loaded.scene.dimension),
            #[cfg(feature = "ros")]
            node: None,
            #[cfg(feature = "ros")]
            virtual_rig: None,
            #[cfg(feature = "mcap")]
            recording: None,
            lost: Vec::new(),
            coordination: Histograms::default(),
            grain_motion: None,
            fabric: None,
            cement: None,
            start: None,
            end: None,
        }
    }

    /// Whether every command was served and nothing was lost.
    pub(super) fn complete(&self) -> bool {
        self.refused == 0 && self.lost.is_empty()
    }

    /// Whether nothing was lost.
    #[cfg(feature = "mcap")]
    pub(super) fn is_undamaged(&self) -> bool {
        self.lost.is_empty()
    }

    /// Takes what is asked of the twin at the end only, and what of it the scene wants.
    pub(super) fn ends(&mut self, twin: &mut Twin, outputs: Outputs) {
        self.coordination = twin.coordination();
        self.grain_motion = twin.motion().map(|motion| motion.localisation);
        self.fabric = (outputs.fabric != When::Never).then(|| twin.fabric());
        let broke = |one: &&Happened| one.event.kind == EventKind::ContactBreak;
        let cracks = self.events.iter().filter(broke).count() as u64;
        let broken_energy = self.end.as_ref().and_then(|end| end.state).map(|s| s.broken_energy);
        self.cement = twin.cracks().map(|bonds| Cement {
            bonds: bonds.bonds(),
            intact: bonds.intact,
            broken_by_tension: bonds.tension,
            broken_by_shear: bonds.shear,
            cracks,
            broken_energy: broken_energy.unwrap_or_default(),
        });
    }

    /// Takes what the node and the rig did.
    #[cfg(feature = "ros")]
    pub(super) fn linked(&mut self, linked: super::ros::Linked) {
        let super::ros::Linked { node, rig } = linked;
        if node.lost > 0 {
            self.lose(format!("{} messages could not be published", node.lost));
        }
        if node.unreadable > 0 {
            self.lose(format!("{} samples on the command topic were no commands", node.unreadable));
        }
        self.node = Some(node);
        match rig {
            Some(Ok(played)) => self.virtual_rig = Some(played),
            Some(Err(error)) => self.lose(error.to_string()),
            None => {}
        }
    }

    /// Takes how the recording ended.
    #[cfg(feature = "mcap")]
    pub(super) fn recorded(
        &mut self,
        ended: Result<graintwin::record::Recorded, graintwin::record::RecordError>,
    ) {
        match ended {
            Ok(recorded) => self.recording = Some(recorded),
            Err(error) => self.lose(error.to_string()),
        }
    }

    #[cfg(any(feature = "ros", feature = "mcap"))]
    fn lose(&mut self, what: String) {
        tracing::error!("{what}");
        self.lost.push(what);
    }

    /// One JSON object; numbers that are not known are null.
    pub(super) fn json(&self) -> Result<String, Failure> {
        let mut text = serde_json::to_string_pretty(self).map_err(Failure::other)?;
        text.push('\n');
        Ok(text)
    }

    pub(super) fn table(&self) -> String {
        table::write(self)
    }

    fn measured(&mut self, measures: &Measures) {
        let moment = Moment {
            increment: measures.increment,
            walls: measures.walls,
            wall_force_error: measures.wall_force_error,
            state: measures.state,
            moduli: measures.moduli,
            tangent: measures.tangent,
            hydrate: measures.hydrate,
            plane: measures.plane.clone(),
        };
        self.increments = measures.increment;
        let increment = measures.increment;
        let happened = |event: &Event| Happened { increment, event: event.clone() };
        self.events.extend(measures.events.iter().map(happened));
        if let Some(state) = measures.state {
            self.iterations += u64::from(state.iterations);
            self.opened += u64::from(state.opened);
            self.formed += u64::from(state.formed);
            self.worst_residual = self.worst_residual.max(state.residual);
            self.solve_seconds += state.solve_seconds;
        }
        if self.start.is_none() {
            self.start = Some(moment.clone());
        }
        self.end = Some(moment);
    }
}

impl Sink for &mut Summary {
    fn demand(&self) -> Demand {
        let (state, moduli, tangent) = (true, true, true);
        Demand { state, moduli, tangent, hydrate: true, plane: true, ..Demand::NONE }
    }

    fn served(&mut self, served: &Arc<Served>) {
        let report = &served.report;
        self.substeps += u64::from(report.substeps);
        if let Some(measures) = &report.measures {
            self.measured(measures);
        }
        if served.command.is_none() {
            if !report.text.is_empty() {
                tracing::info!("at the start {}", report.text);
            }
            return;
        }
        *self.commands.entry(name(report.disposition)).or_default() += 1;
        let moved = matches!(
            report.disposition,
            Disposition::Applied | Disposition::Clamped | Disposition::Duplicate
        );
        if !moved {
            let what = format!(
                "command {} of session `{}`: {}: {}",
                report.sequence,
                report.session,
                name(report.disposition),
                report.text
            );
            tracing::warn!("{what}");
            self.refused += 1;
            self.first_refusal.get_or_insert(what);
        } else if !report.text.is_empty() {
            tracing::info!("command {}: {}", report.sequence, report.text);
        }
    }
}

/// The name that the messages give it.
pub(super) fn name(disposition: Disposition) -> String {
    match serde_json::to_value(disposition) {
        Ok(serde_json::Value::String(name)) => name,
        _ => format!("{disposition:?}"),
    }
}
