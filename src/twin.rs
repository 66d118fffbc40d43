//! The one door: [`Twin::apply`] takes a command and returns a report.

mod dissociation;
mod limited;
mod measured;
mod merged;
mod past;
mod requests;

use rayon::{ThreadPool, ThreadPoolBuilder};
use sha2::{Digest, Sha256};

use crate::command::gate::{Decision, Gate, Order, join};
use crate::command::{Command, Disposition, Stamp};
use crate::contact::cement::deposit::deposit;
use crate::contact::cement::strength::Mode;
use crate::model::Model;
use crate::pack::{Grain, History, Pack};
use crate::plane;
use crate::relax::advance::Advance;
use crate::relax::breakage::Crack;
use crate::relax::jump::Jump;
use crate::relax::{Effort, Outcome, Status, Workspace, accuracy, relax, two_step};
use crate::report::{Demand, Report};
use crate::scene::{Method, ModuliKind, Scene, When};
use crate::state::State;
use crate::wall::{self, Setpoint, WallTarget};
use limited::Gone;
pub use merged::Merged;
use past::Past;
pub use requests::Settings;

/// Why a twin could not be made.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// No grain.
    #[error("the pack has no grains: at least one is needed")]
    Empty,
    /// The history does not belong to the pack.
    #[error("the history of the pack: {0}")]
    History(String),
    /// The pack does not fit between the walls of the scene.
    #[error("the walls of the scene: {0}")]
    Cell(String),
    /// The operating system gave no threads.
    #[error("cannot start {threads} solver threads: {source}")]
    Threads {
        /// Threads asked for.
        threads: usize,
        /// The reason.
        source: rayon::ThreadPoolBuildError,
    },
}

/// The digital twin of one specimen.
#[derive(Debug)]
pub struct Twin {
    model: Model,
    state: State,
    work: Workspace,
    pool: ThreadPool,
    gate: Gate,
    increment: u64,
    /// How the present state was reached.
    outcome: Outcome,
    /// Normal stress \[Pa\] and engineering strain at the last equilibrium.
    stress_strain: ([f64; 3], [f64; 3]),
    /// Energy that events released since the initial equilibrium \[J\].
    event_energy: f64,
    /// The history of the pack as it was given.
    given_history: Option<History>,
    /// The work done before the last reset.
    spent: Effort,
    /// What the walls do from the start on.
    targets: [WallTarget; wall::COUNT],
    /// Where the grains were, when the scene lets their motion be measured, or they are discs.
    past: Option<Past>,
    /// Whether the scene lets their motion be measured.
    tells_motion: bool,
    /// Whether pictures of the grains show their motion.
    shows_motion: bool,
    /// Share of the contacts that make the force chains.
    chain_share: f64,
    /// Which moduli are asked for.
    moduli: ModuliKind,
    /// Whether strain is that since the start.
    refers_to_start: bool,
}

impl Twin {
    /// A twin of `pack` under the walls, laws and solver of `scene`, working on `threads` threads
    /// (0 = one a core). The bits of its answers do not depend on `threads`.
    ///
    /// # Errors
    /// When the pack is empty, its history is not that of such a pack, or the threads cannot be
    /// started.
    pub fn new(scene: &Scene, pack: &Pack, threads: usize) -> Result<Self, TwinError> {
        if pack.grains.is_empty() {
            return Err(TwinError::Empty);
        }
        let cell = plane::Cell::of(scene, &pack.bounds);
        if let Some(cell) = &cell {
            fits(cell, pack)?;
        }
        if let Some(history) = &pack.history {
            let bodies = cell.as_ref().map_or(wall::COUNT, plane::Cell::bodies);
            history.check_among(pack.grains.len(), bodies).map_err(TwinError::History)?;
        }
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|k| format!("solver-{k}"))
            .build()
            .map_err(|source| TwinError::Threads { threads, source })?;
        let model = Model::new(pack, scene);
        let mut state = State::new(&model);
        if let Some(history) = &pack.history {
            state.recall(&model, history);
        }
        Ok(Self {
            state,
            work: Workspace::new(&model),
            gate: match cell {
                None => Gate::new(pack.bounds, &scene.node).with_hydrate(&model.hydrate),
                Some(cell) => Gate::new(pack.bounds, &scene.node).within(cell),
            },
            pool,
            increment: 0,
            outcome: Outcome::NONE,
            stress_strain: ([0.0; 3], [0.0; 3]),
            event_energy: 0.0,
            given_history: pack.history.clone().filter(|_| model.friction.is_some()),
            spent: Effort::default(),
            targets: scene.walls.targets.in_order(),
            shows_motion: scene.view.color.is_of_motion(),
            tells_motion: scene.outputs.grain_motion != When::Never,
            past: (scene.dimension == 2 || scene.outputs.grain_motion != When::Never)
                .then(Past::default),
            chain_share: scene.outputs.chain_share,
            moduli: scene.outputs.moduli,
            refers_to_start: scene.reference.is_none(),
            model,
        })
    }

    /// Threads that it works on.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// Relaxes the pack as it was given, and then with the walls as the scene has them: increment 0.
    /// The report tells whether it was in equilibrium; when none is found the disposition is
    /// [`Disposition::NotConverged`].
    pub fn start(&mut self, demand: Demand) -> Report {
        let given = self.state.clone();
        self.past.iter_mut().for_each(|past| past.restart(&given));
        let mut reached = match &self.model.plane {
            None => self.settle(),
            Some(_) => self.settle_plane(),
        };
        self.outcome = reached.outcome;
        let mut report = Report {
            stamp: Stamp::default(),
            session: String::new(),
            sequence: 0,
            increment: 0,
            disposition: Disposition::Applied,
            substeps: 0,
            text: String::new(),
            measures: None,
        };
        let outcome = reached.outcome;
        if !outcome.status.is_equilibrium() {
            self.state = given;
            report.disposition = Disposition::NotConverged;
            report.text = format!("the pack as given: {}", self.explain(&outcome, 0.0));
            return report;
        }
        if self.refers_to_start && self.model.cell.is_some() {
            // Membranes have gone from where the walls were to the surface.
            self.model.reference = *self.state.bounds(&self.model);
        }
        self.state.initial_energy = outcome.sums.energy + self.state.friction.stored;
        report.text = match (outcome.status, outcome.iterations) {
            (Status::Unjammed, _) => UNJAMMED.into(),
            (_, 0) => String::new(),
            (_, steps) => {
                format!("the pack was not in equilibrium: relaxed in {steps} iterations")
            }
        };
        report.substeps = reached.substeps;
        if self.targets.iter().any(|target| *target != WallTarget::Keep) {
            match self.take_targets() {
                Ok(advance) => {
                    report.text = join(&report.text, "the walls were brought to their targets");
                    report.substeps += advance.substeps;
                    reached = advance;
                }
                Err(text) => {
                    self.state = given;
                    report.disposition = Disposition::NotConverged;
                    report.text = format!("the walls' targets of the scene: {text}");
                    return report;
                }
            }
        }
        report.measures = Some(self.measure(Stamp::default(), &reached, demand));
        report
    }

    /// Relaxes a pack of spheres as it was given, and deposits cement in it.
    fn settle(&mut self) -> Advance {
        let Self { model, state, work, pool, .. } = self;
        work.wrap(model, state);
        work.start(model, state);
        work.jumps.clear();
        let outcome = pool.install(|| {
            let outcome = match model.is_two_step() && !state.bonds.is_empty() {
                true => two_step::start(model, state, work, false),
                false => relax(model, state, work),
            };
            match &model.cement {
                Some(cement) if outcome.status.is_equilibrium() && state.bonds.is_empty() => {
                    deposit(model, cement, state);
                    work.start(model, state);
                    let cemented = match model.is_two_step() {
                        true => two_step::start(model, state, work, true),
                        false => relax(model, state, work),
                    };
                    Outcome { iterations: outcome.iterations + cemented.iterations, ..cemented }
                }
                _ => outcome,
            }
        });
        let mut reached = Advance::at(outcome);
        if !outcome.status.is_equilibrium() {
            return reached;
        }
        work.lead(model, state);
        reached.wall_force_error =
            pool.install(|| accuracy::wall_force_error(model, state, work, &outcome));
        reached.changes = match outcome.iterations {
            // What was an equilibrium stays what it was, to the bit.
            0 => work.keep(state),
            _ => work.commit(model, state),
        };
        reached.jumps = std::mem::take(&mut work.jumps);
        reached.substeps = u32::from(outcome.iterations > 0);
        Advance { iterations: outcome.iterations, descents: outcome.descents, ..reached }
    }

    /// Relaxes a pack of discs as it was given, and bonds it.
    fn settle_plane(&mut self) -> Advance {
        let Self { model, state, work, pool, .. } = self;
        let Workspace { plane, neighbours, .. } = work;
        pool.install(|| plane::advance::settle(model, state, plane, neighbours))
    }

    /// Brings the walls to the targets of the scene.
    fn take_targets(&mut self) -> Result<Advance, String> {
        let setpoint = self.gate.begin(self.targets)?;
        if loads_need_newton(&self.model, &setpoint) {
            return Err(LOADS_NEED_NEWTON.into());
        }
        let reached = self.advance(&setpoint, self.state.tilt);
        if !reached.outcome.status.is_equilibrium() {
            return Err(self.explain(&reached.outcome, reached.crept));
        }
        self.outcome = reached.outcome;
        self.event_energy += released(&reached);
        self.gate.begun(setpoint, self.state.displacement);
        Ok(reached)
    }

    /// Serves one command.
    pub fn apply(&mut self, command: &Command, demand: Demand) -> Report {
        let report = self.blank(command);
        match self.gate.decide(command) {
            Decision::Serve(order) if loads_need_newton(&self.model, &order.setpoint) => Report {
                disposition: Disposition::Invalid,
                text: LOADS_NEED_NEWTON.into(),
                ..report
            },
            Decision::Serve(order) => {
                let gone = self.go(&order, self.gate.limits().clamp);
                self.conclude(command, order, gone, demand)
            }
            Decision::Dissociate(to, text) => self.dissociate(command, &to, text, demand),
            Decision::Repeat(last) => repeat(report, last.map(|last| *last)),
            Decision::Refuse(disposition, text) => {
                let report = Report { disposition, text, ..report };
                if disposition == Disposition::Limit {
                    self.gate.served(command, None, self.state.displacement, &report);
                }
                report
            }
        }
    }

    /// The report of a command of which nothing is known yet.
    fn blank(&self, command: &Command) -> Report {
        Report {
            stamp: command.stamp,
            session: command.session.clone(),
            sequence: command.sequence,
            increment: self.increment,
            disposition: Disposition::Applied,
            substeps: 0,
            text: String::new(),
            measures: None,
        }
    }

    /// Counts and reports where the walls went for a command that the gate let through.
    fn conclude(&mut self, command: &Command, order: Order, gone: Gone, demand: Demand) -> Report {
        let Gone { reached, setpoint, beyond, clamped } = gone;
        let mut report = Report { substeps: reached.substeps, ..self.blank(command) };
        let refused = match &beyond {
            _ if !reached.outcome.status.is_equilibrium() => {
                Some((Disposition::NotConverged, self.explain(&reached.outcome, reached.crept)))
            }
            Some(beyond) if !clamped => Some((Disposition::Limit, beyond.clone())),
            _ => None,
        };
        if let Some((disposition, text)) = refused {
            (report.disposition, report.text) = (disposition, text);
            self.gate.served(command, None, self.state.displacement, &report);
            return report;
        }
        self.outcome = reached.outcome;
        self.event_energy += released(&reached);
        self.increment += 1;
        self.past.iter_mut().for_each(Past::arrive);
        report.increment = self.increment;
        report.text = order.text;
        if clamped || order.clamped {
            report.disposition = Disposition::Clamped;
        }
        if let Some(beyond) = beyond {
            report.text = join(&report.text, &format!("as far as allowed: {beyond}"));
        }
        if reached.outcome.status == Status::Unjammed {
            report.text = join(&report.text, UNJAMMED);
        }
        if reached.crept > 0.0 {
            let text = format!(
                "no equilibrium nearby carried the loads: walls yielded by a strain of {:.2e}",
                reached.crept
            );
            report.text = join(&report.text, &text);
        }
        report.text = join(&report.text, &broken(&reached.cracks));
        for jump in &reached.jumps {
            report.text = join(&report.text, &tell(jump));
        }
        self.gate.served(command, Some(setpoint), self.state.displacement, &report);
        self.gate.leant(self.state.tilt);
        report.measures = Some(self.measure(command.stamp, &reached, demand));
        report
    }

    /// One sentence about a relaxation that failed.
    fn explain(&self, outcome: &Outcome, crept: f64) -> String {
        let tolerance = self.model.solver.tolerance;
        let residual = outcome.residual;
        match outcome.status {
            Status::MaxIterations => format!(
                "no equilibrium in {} iterations: residual {residual:.1e}, {tolerance:.1e} asked",
                outcome.iterations
            ),
            Status::Unstable if crept > 0.0 => format!(
                "no equilibrium carries the loads: the walls yielded by a strain of {crept:.2e} \
                 without finding one"
            ),
            Status::Unstable => format!(
                "unstable: residual {residual:.1e} after {} legs of overdamped flow, \
                 {tolerance:.1e} asked",
                outcome.descents
            ),
            Status::Stalled => format!(
                "no step descends any more at residual {residual:.1e}, {tolerance:.1e} asked: \
                 rounding allows no less"
            ),
            Status::NonFinite => "a force or position is not finite".into(),
            Status::Converged | Status::Unjammed => String::new(),
        }
    }

    /// The work done since the start.
    #[must_use]
    pub fn effort(&self) -> Effort {
        let Effort { gradients, products } = self.work.effort();
        Effort {
            gradients: self.spent.gradients + gradients,
            products: self.spent.products + products,
        }
    }

    /// The present increment.
    #[must_use]
    pub fn increment(&self) -> u64 {
        self.increment
    }

    /// A digest of the state: two twins with the same one go on with the same bits. It is the
    /// SHA-256, in hexadecimal digits, of [`State::put`].
    #[must_use]
    pub fn digest(&self) -> String {
        let mut digest = Sha256::new();
        self.state.put(&mut |bytes| digest.update(bytes));
        digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Memory that state and scratch hold \[bytes\].
    #[must_use]
    pub fn bytes(&self) -> usize {
        let past = self.past.as_ref().map_or(0, Past::heap_bytes);
        self.state.heap_bytes() + self.work.heap_bytes() + past
    }

    /// The specimen as it is now, in the order of the pack file.
    #[must_use]
    pub fn pack(&self) -> Pack {
        let mut grains = self.model.grains.clone();
        for (k, &order) in self.model.order.iter().enumerate() {
            let position = self.state.position[k].into();
            grains[order as usize] = Grain { position, ..self.model.grain(k) };
        }
        Pack {
            bounds: *self.state.hull(&self.model),
            grains,
            history: self.state.history(&self.model),
        }
    }
}

/// Whether the grains of `pack` are in `cell`.
fn fits(cell: &plane::Cell, pack: &Pack) -> Result<(), TwinError> {
    if let Some(text) = cell.unfit() {
        return Err(TwinError::Cell(text));
    }
    for (row, grain) in pack.grains.iter().enumerate() {
        let [x, y, _] = grain.position;
        if let Some(text) = cell.shuts_out(plane::Vec2::new(x, y), grain.radius) {
            return Err(TwinError::Cell(format!("grain {row} {text}")));
        }
    }
    Ok(())
}

/// Whether walls shall carry loads that the scene's method cannot balance.
fn loads_need_newton(model: &Model, setpoint: &Setpoint) -> bool {
    model.plane.is_none()
        && model.solver.method != Method::Newton
        && setpoint.iter().any(|wall| wall.load().is_some())
}

/// The answer to a command that was served before, with its report then.
fn repeat(report: Report, last: Option<Report>) -> Report {
    let disposition = Disposition::Duplicate;
    match last {
        Some(last) => Report {
            disposition,
            text: join(&format!("served before: {:?}", last.disposition), &last.text),
            ..last
        },
        None => Report { disposition, text: "served before".into(), ..report },
    }
}

const LOADS_NEED_NEWTON: &str = "walls under loads need solver.method newton";
const UNJAMMED: &str = "no grain carries load";

/// Energy that the events of an increment released \[J\].
fn released(reached: &Advance) -> f64 {
    reached.jumps.iter().map(Jump::released).sum()
}

/// One sentence about the bonds that broke, if any.
fn broken(cracks: &[Crack]) -> String {
    let tension = cracks.iter().filter(|crack| crack.mode == Mode::Tension).count();
    let shear = cracks.len() - tension;
    let bonds = match cracks.len() {
        0 => return String::new(),
        1 => "1 bond".into(),
        many => format!("{many} bonds"),
    };
    match (tension, shear) {
        (_, 0) => format!("{bonds} broke by tension"),
        (0, _) => format!("{bonds} broke by shear"),
        _ => format!("{bonds} broke, {tension} by tension and {shear} by shear"),
    }
}

/// One sentence about a jump.
fn tell(jump: &Jump) -> String {
    let grains = match jump.grains.len() {
        1 => "1 grain".into(),
        many => format!("{many} grains"),
    };
    format!(
        "unstable on the way: {grains} jumped, confining stress from {:.4e} to {:.4e} Pa",
        jump.stress_before, jump.stress_after
    )
}
