//! The gate: accepts or refuses a command by its form, its place in the sequence and the limits.
//! It knows no clock and no socket (interfaces.md, "What becomes of a command").

mod hydrate;
mod limits;
mod setpoint;

use std::collections::VecDeque;

use crate::command::{Ask, Command, Disposition, Dissociation, Mode, Stamp};
use crate::plane::Cell;
use crate::report::Report;
use crate::scene::{self, Fault, Limits};
use crate::wall::{self, Bounds, Setpoint, WallTarget};

pub use limits::Stand;

/// What the gate says to a command.
#[derive(Clone, Debug)]
pub enum Decision {
    /// The walls shall do this.
    Serve(Order),
    /// Hydrate shall dissociate so far, with a text for the report.
    Dissociate(Dissociation, String),
    /// Served before, with the report then.
    Repeat(Option<Box<Report>>),
    /// Refused, with the reason.
    Refuse(Disposition, String),
}

/// What the walls shall do.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// Where they shall stand, or what they shall carry.
    pub setpoint: Setpoint,
    /// Shear γ by which the box shall lean.
    pub tilt: f64,
    /// Whether that is less than what the command asked.
    pub clamped: bool,
    /// For the report.
    pub text: String,
}

/// Sessions whose sequence is remembered: rigs that speak in turn. A command of one before them
/// begins anew.
const SESSIONS: usize = 16;

/// Remembers where the sequence stands, and what keeps commands from being served.
#[derive(Clone, Debug)]
pub struct Gate {
    start: Bounds,
    /// Age beyond which a command is refused \[s\]; 0 = never.
    stale_after: f64,
    limits: Limits,
    hold_after: Vec<Fault>,
    /// Somebody asked for a hold.
    held: bool,
    /// What happened that must be looked at first.
    fault: Option<String>,
    /// Where the sequence of each session stands, the latest session first.
    sessions: VecDeque<Place>,
    /// Session and stamp of the last command that was accepted.
    accepted: Option<(String, Stamp)>,
    /// What the walls do since then.
    now: Setpoint,
    /// Where the walls are \[m\].
    displacement: [f64; wall::COUNT],
    /// What hydrate there is, and what became of it.
    hydrate: hydrate::Stock,
    /// What surrounds the pack; `None` for spheres between six plane walls.
    cell: Option<Cell>,
    /// Whether the box can lean, and by how much it does.
    leans: bool,
    tilt: f64,
}

/// The last command of a session that took a place in its sequence.
#[derive(Clone, Debug)]
struct Place {
    session: String,
    sequence: u64,
    /// Its report without measures, once there is one.
    report: Option<Report>,
}

impl Gate {
    /// A gate for walls that start at `start`.
    #[must_use]
    pub fn new(start: Bounds, node: &scene::Node) -> Self {
        let displacement = [0.0; wall::COUNT];
        Self {
            start,
            stale_after: node.stale_after,
            limits: node.limits,
            hold_after: node.hold_after.clone(),
            held: false,
            fault: None,
            sessions: VecDeque::new(),
            accepted: None,
            now: wall::standing(&displacement),
            displacement,
            hydrate: hydrate::Stock::default(),
            cell: None,
            leans: false,
            tilt: 0.0,
        }
    }

    /// The same for a pack in `cell`.
    #[must_use]
    pub fn within(self, cell: Cell) -> Self {
        let leans = cell.leans();
        Self { cell: Some(cell), leans, ..self }
    }

    /// The box with walls displaced inwards by `displacement` \[m\].
    fn bounds(&self, displacement: &[f64; wall::COUNT]) -> Bounds {
        match &self.cell {
            None => self.start.displaced(displacement),
            Some(cell) => cell.bounds(displacement),
        }
    }

    /// From now on commands older than `seconds` are refused unless that is 0.
    pub fn set_stale_after(&mut self, seconds: f64) {
        self.stale_after = seconds;
    }

    /// From now on these limits hold.
    pub fn set_limits(&mut self, limits: Limits) {
        self.limits = limits;
    }

    /// The limits.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Begins or ends a hold. A fault holds on its own.
    pub fn hold(&mut self, held: bool) {
        self.held = held;
    }

    /// Forgets what happened; returns it.
    pub fn reset_faults(&mut self) -> Option<String> {
        self.fault.take()
    }

    /// Why no command is served at present.
    #[must_use]
    pub fn holds(&self) -> Option<String> {
        match &self.fault {
            Some(fault) => Some(format!("on hold after {fault}; reset_faults ends that")),
            None => self.held.then(|| "on hold; hold with false ends that".into()),
        }
    }

    /// Decides on `command`. On hold each is held and takes no place in the sequence.
    #[must_use]
    pub fn decide(&self, command: &Command) -> Decision {
        let refuse = |disposition, text| Decision::Refuse(disposition, text);
        if let Some(text) = self.holds() {
            return refuse(Disposition::Held, text);
        }
        if let Some(text) = setpoint::malformed(command) {
            return refuse(Disposition::Invalid, text);
        }
        if let Some(text) = self.stale(command) {
            return refuse(Disposition::Stale, text);
        }
        let mut text = String::new();
        if let Some(Place { sequence: last, report, .. }) = self.place(&command.session) {
            let (sequence, last) = (command.sequence, *last);
            if sequence == last {
                return Decision::Repeat(report.clone().map(Box::new));
            }
            if sequence < last {
                let text = format!("sequence {sequence} after {last}: commands must not go back");
                return refuse(Disposition::OutOfOrder, text);
            }
            let missing = sequence - last - 1;
            if missing > 0 {
                if command.mode == Mode::Increment {
                    let text = format!(
                        "{missing} commands missing before sequence {sequence}: an increment needs \
                         the one before it; send an absolute command or start a new session"
                    );
                    return refuse(Disposition::Gap, text);
                }
                text = format!("{missing} commands missing before it");
            }
        }
        if let Ask::Dissociation(asked) = &command.ask {
            return match self.dissociation(asked, command.mode) {
                Ok(to) => Decision::Dissociate(to, text),
                Err(text) => refuse(Disposition::Invalid, text),
            };
        }
        let tilt = self.tilted(&command.ask, command.mode);
        match tilt.and_then(|tilt| Ok((self.setpoint(&command.ask, command.mode)?, tilt))) {
            Ok((setpoint, tilt)) => match self.limit(command, (setpoint, tilt), text) {
                Ok(order) => Decision::Serve(order),
                Err(text) => refuse(Disposition::Limit, text),
            },
            Err(text) => refuse(Disposition::Invalid, text),
        }
    }

    /// What walls at the start do that are given `targets`, or what is wrong with them.
    ///
    /// # Errors
    /// When a target is none, or the walls of a pair ask for different loads.
    pub fn begin(&self, targets: [WallTarget; wall::COUNT]) -> Result<Setpoint, String> {
        self.setpoint(&Ask::Targets(targets), Mode::Absolute)
    }

    /// The walls do `setpoint` from now on and are at `displacement` \[m\].
    pub fn begun(&mut self, setpoint: Setpoint, displacement: [f64; wall::COUNT]) {
        self.now = setpoint;
        self.displacement = displacement;
    }

    /// Holds `setpoint`, and how the box shall lean, against the limits.
    ///
    /// # Errors
    /// When it is beyond one, unless it may be cut down to it.
    pub fn limit(
        &self,
        command: &Command,
        (setpoint, tilt): (Setpoint, f64),
        text: String,
    ) -> Result<Order, String> {
        if let Some(text) = self.beyond_hard_limits(&setpoint) {
            return Err(text);
        }
        match self.within_limits(&setpoint, tilt, self.elapsed(command)) {
            (setpoint, tilt, None) => Ok(Order { setpoint, tilt, clamped: false, text }),
            (.., Some(beyond)) if !self.limits.clamp => Err(beyond),
            (setpoint, tilt, Some(beyond)) => {
                let text = join(&text, &format!("as far as allowed: {beyond}"));
                Ok(Order { setpoint, tilt, clamped: true, text })
            }
        }
    }

    /// Time from the last accepted command to this one by their stamps \[s\]. None passes when a
    /// session does not go forward. A new session may count on another clock: when it does not go
    /// forward, nothing tells the time.
    fn elapsed(&self, command: &Command) -> Option<f64> {
        let (session, stamp) = self.accepted.as_ref()?;
        let nanoseconds = command.stamp.nanoseconds() - stamp.nanoseconds();
        match nanoseconds > 0 {
            true => Some(nanoseconds as f64 * 1e-9),
            false => (*session == command.session).then_some(0.0),
        }
    }

    /// The box leans by `tilt` from now on.
    pub fn leant(&mut self, tilt: f64) {
        self.tilt = tilt;
    }

    /// By how much the box leans.
    #[must_use]
    pub fn tilt(&self) -> f64 {
        self.tilt
    }

    /// What the walls do now.
    #[must_use]
    pub fn now(&self) -> &Setpoint {
        &self.now
    }

    /// Why the command is too old; what was served before is repeated at any age.
    fn stale(&self, command: &Command) -> Option<String> {
        let place = self.place(&command.session);
        let served = place.is_some_and(|last| last.sequence >= command.sequence);
        let age = command.age?;
        (self.stale_after > 0.0 && age > self.stale_after && !served).then(|| {
            format!("{age:.3} s old: at most {} s are allowed (node.stale_after)", self.stale_after)
        })
    }

    /// Remembers a command that took a place in the sequence: what the walls do since when it was
    /// accepted, where they are, and its report, which may be a fault.
    pub fn served(
        &mut self,
        command: &Command,
        setpoint: Option<Setpoint>,
        displacement: [f64; wall::COUNT],
        report: &Report,
    ) {
        self.take_place(command, Some(Report { measures: None, ..report.clone() }));
        if let Some(setpoint) = setpoint {
            self.accepted = Some((command.session.clone(), command.stamp));
            self.now = setpoint;
        }
        self.displacement = displacement;
        let fault = match report.disposition {
            Disposition::NotConverged => Some(Fault::NotConverged),
            Disposition::Limit => Some(Fault::Limit),
            _ => None,
        };
        if fault.is_some_and(|fault| self.hold_after.contains(&fault)) {
            let Report { session, sequence, text, .. } = report;
            self.fault = Some(format!("command {sequence} of session `{session}`: {text}"));
        }
    }

    /// Where the sequence of `session` stands.
    fn place(&self, session: &str) -> Option<&Place> {
        self.sessions.iter().find(|place| place.session == session)
    }

    /// The sequence of the session of `command` stands there from now on.
    fn take_place(&mut self, command: &Command, report: Option<Report>) {
        self.sessions.retain(|place| place.session != command.session);
        self.sessions.truncate(SESSIONS - 1);
        let Command { session, sequence, .. } = command.clone();
        self.sessions.push_front(Place { session, sequence, report });
    }

    /// Takes it that `command` is accepted and the walls do what `order` says.
    pub fn expect(&mut self, command: &Command, order: &Order) {
        self.displacement = self.destination(&order.setpoint);
        self.take_place(command, None);
        self.accepted = Some((command.session.clone(), command.stamp));
        self.now = order.setpoint;
        self.tilt = order.tilt;
    }

    /// Forgets every command; the walls are back at their start. Limits, hold and faults stay.
    pub fn forget_commands(&mut self) {
        self.displacement = [0.0; wall::COUNT];
        self.now = wall::standing(&self.displacement);
        self.hydrate.forget();
        self.tilt = 0.0;
        self.sessions.clear();
        self.accepted = None;
    }
}

/// Two remarks as one.
pub(crate) fn join(first: &str, second: &str) -> String {
    match (first, second) {
        ("", only) | (only, "") => only.into(),
        (first, second) => format!("{first}; {second}"),
    }
}
