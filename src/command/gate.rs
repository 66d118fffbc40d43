//! The gate: accepts or refuses a command by its form and its place in the sequence. It knows no
//! clock and no socket (interfaces.md, "What becomes of a command").

use crate::command::{Ask, Command, Disposition, Mode};
use crate::report::Report;
use crate::wall::{self, Bounds, Control, Load, Setpoint, WallTarget};

/// A box side may shrink to this share of what it was at the start.
const LEAST_SIDE: f64 = 0.5;
/// A box side may grow, and the box may travel, up to this many times the side at the start.
const MOST_SIDE: f64 = 2.0;

/// What the gate says to a command.
#[derive(Clone, Debug, PartialEq)]
pub enum Decision {
    /// The walls shall do this; the text is for the report.
    Serve(Setpoint, String),
    /// Served before.
    Repeat,
    /// Refused, with the reason.
    Refuse(Disposition, String),
}

/// Remembers where the sequence stands.
#[derive(Clone, Debug)]
pub struct Gate {
    start: Bounds,
    /// Age beyond which a command is refused \[s\]; 0 = never.
    stale_after: f64,
    /// Session and sequence of the last command that reached the walls.
    last: Option<(String, u64)>,
    /// What the walls do since the last accepted command.
    now: Setpoint,
    /// Where the walls are \[m\].
    displacement: [f64; wall::COUNT],
    /// Report of the last command that reached the walls, without measures.
    report: Option<Report>,
}

impl Gate {
    /// A gate for walls that start at `start`; commands older than `stale_after` s are refused
    /// unless that is 0.
    #[must_use]
    pub fn new(start: Bounds, stale_after: f64) -> Self {
        let displacement = [0.0; wall::COUNT];
        let now = wall::standing(&displacement);
        Self { start, stale_after, last: None, now, displacement, report: None }
    }

    /// Decides on `command`.
    #[must_use]
    pub fn decide(&self, command: &Command) -> Decision {
        if let Some(text) = malformed(command) {
            return Decision::Refuse(Disposition::Invalid, text);
        }
        if let Some(text) = self.stale(command) {
            return Decision::Refuse(Disposition::Stale, text);
        }
        let mut text = String::new();
        if let Some((session, last)) = &self.last
            && *session == command.session
        {
            let sequence = command.sequence;
            if sequence == *last {
                return Decision::Repeat;
            }
            if sequence < *last {
                let text = format!("sequence {sequence} after {last}: commands must not go back");
                return Decision::Refuse(Disposition::OutOfOrder, text);
            }
            let missing = sequence - last - 1;
            if missing > 0 {
                if command.mode == Mode::Increment {
                    let text = format!(
                        "{missing} commands missing before sequence {sequence}: an increment needs \
                         the one before it; send an absolute command or start a new session"
                    );
                    return Decision::Refuse(Disposition::Gap, text);
                }
                text = format!("{missing} commands missing before it");
            }
        }
        let setpoint = match self.setpoint(&command.ask, command.mode) {
            Ok(setpoint) => setpoint,
            Err(text) => return Decision::Refuse(Disposition::Invalid, text),
        };
        match self.beyond_travel(&setpoint) {
            Some(text) => Decision::Refuse(Disposition::Limit, text),
            None => Decision::Serve(setpoint, text),
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

    /// What the walls do when they are asked so, or what is wrong with it.
    fn setpoint(&self, ask: &Ask, mode: Mode) -> Result<Setpoint, String> {
        let targets = ask.targets();
        let mut setpoint = self.now;
        for (w, target) in targets.into_iter().enumerate() {
            let keeps = matches!(ask, Ask::Displacement(_)) && self.now[w].load().is_some();
            if !keeps {
                setpoint[w] = self.control(w, target, mode)?;
            }
        }
        for axis in 0..3 {
            let [low, high] = [2 * axis, 2 * axis + 1];
            if let (Some(one), Some(other)) = (setpoint[low].load(), setpoint[high].load())
                && one != other
            {
                return Err(format!(
                    "{} and {} shall carry {one:?} and {other:?}: the two walls of a pair carry \
                     the same load, or one of them stands",
                    wall::NAMES[low],
                    wall::NAMES[high]
                ));
            }
        }
        Ok(setpoint)
    }

    /// What `target` makes wall `w` do.
    fn control(&self, w: usize, target: WallTarget, mode: Mode) -> Result<Control, String> {
        let name = wall::NAMES[w];
        let on_top = mode == Mode::Increment;
        let load = |load: Load, value: f64, unit: &str| {
            if value > 0.0 {
                return Ok(Control::Load(load));
            }
            Err(format!("{name} shall carry {value:e} {unit}: a load is above 0"))
        };
        let under_none =
            || format!("{name} carries no such load that an increment could go on top of");
        match target {
            WallTarget::Keep => Ok(self.now[w]),
            WallTarget::Displacement(value) => {
                let before = match self.now[w] {
                    Control::Displacement(before) => before,
                    Control::Load(_) => self.displacement[w],
                };
                Ok(Control::Displacement(if on_top { before + value } else { value }))
            }
            WallTarget::Force(value) => {
                let before = match self.now[w] {
                    _ if !on_top => 0.0,
                    Control::Load(Load::Force(before)) => before,
                    _ => return Err(under_none()),
                };
                load(Load::Force(before + value), before + value, "N")
            }
            WallTarget::Stress(value) => {
                let before = match self.now[w] {
                    _ if !on_top => 0.0,
                    Control::Load(Load::Stress(before)) => before,
                    _ => return Err(under_none()),
                };
                load(Load::Stress(before + value), before + value, "Pa")
            }
            WallTarget::Unknown(number, _) => Err(format!(
                "control {number} of {name}: 0 (keep), 1 (displacement), 2 (force) and 3 (stress) \
                 are allowed"
            )),
        }
    }

    /// Why the command is too old; what was served before is repeated at any age.
    fn stale(&self, command: &Command) -> Option<String> {
        let served = self
            .last
            .as_ref()
            .is_some_and(|last| last.0 == command.session && last.1 >= command.sequence);
        let age = command.age?;
        (self.stale_after > 0.0 && age > self.stale_after && !served).then(|| {
            format!("{age:.3} s old: at most {} s are allowed (node.stale_after)", self.stale_after)
        })
    }

    /// Why the walls cannot go where `setpoint` sends them; those under a load stay meanwhile.
    fn beyond_travel(&self, setpoint: &Setpoint) -> Option<String> {
        let target: [f64; wall::COUNT] = std::array::from_fn(|w| match setpoint[w] {
            Control::Displacement(displacement) => displacement,
            Control::Load(_) => self.displacement[w],
        });
        let (start, now) = (self.start.sides(), self.start.displaced(&target).sides());
        (0..3).find_map(|axis| {
            let (low, high) = (wall::NAMES[2 * axis], wall::NAMES[2 * axis + 1]);
            let allowed = [LEAST_SIDE * start[axis], MOST_SIDE * start[axis]];
            if !(allowed[0]..=allowed[1]).contains(&now[axis]) {
                return Some(format!(
                    "{low} and {high} would be {:e} m apart: {:e} to {:e} m are allowed",
                    now[axis], allowed[0], allowed[1]
                ));
            }
            let travel = target[2 * axis].abs().max(target[2 * axis + 1].abs());
            (travel > allowed[1]).then(|| {
                format!("{low} or {high} would travel {travel:e} m: {:e} m are allowed", allowed[1])
            })
        })
    }

    /// Remembers a command that reached the walls, what they do since when they moved, and where
    /// they are.
    pub fn served(
        &mut self,
        command: &Command,
        setpoint: Option<Setpoint>,
        displacement: [f64; wall::COUNT],
        report: &Report,
    ) {
        self.last = Some((command.session.clone(), command.sequence));
        self.now = setpoint.unwrap_or(self.now);
        self.displacement = displacement;
        self.report = Some(Report { measures: None, ..report.clone() });
    }

    /// The report of the last command that reached the walls.
    #[must_use]
    pub fn last_report(&self) -> Option<&Report> {
        self.report.as_ref()
    }
}

/// What is wrong with the form of a command.
fn malformed(command: &Command) -> Option<String> {
    if let Mode::Unknown(mode) = command.mode {
        return Some(format!("mode {mode}: 0 (absolute) and 1 (increment) are allowed"));
    }
    let values = command.ask.numbers();
    let wall = values.iter().position(|value| !value.is_finite())?;
    let (name, value) = (wall::NAMES[wall], values[wall]);
    Some(match command.ask {
        Ask::Displacement(_) => {
            format!("displacement of {name} is {value}: a finite number of metres is needed")
        }
        Ask::Targets(_) => format!("value of {name} is {value}: a finite number is needed"),
    })
}
