//! The gate: accepts or refuses a command by its form and its place in the sequence. It knows no
//! clock and no socket (interfaces.md, "What becomes of a command").

use crate::command::{Command, Disposition, Mode};
use crate::report::Report;
use crate::wall::{self, Bounds};

/// A box side may shrink to this share of what it was at the start.
const LEAST_SIDE: f64 = 0.5;
/// A box side may grow, and the box may travel, up to this many times the side at the start.
const MOST_SIDE: f64 = 2.0;

/// What the gate says to a command.
#[derive(Clone, Debug, PartialEq)]
pub enum Decision {
    /// Move the walls to this displacement since the start \[m\]; the text is for the report.
    Serve([f64; wall::COUNT], String),
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
    /// Last accepted target \[m\].
    target: [f64; wall::COUNT],
    /// Report of the last command that reached the walls, without measures.
    report: Option<Report>,
}

impl Gate {
    /// A gate for walls that start at `start`; commands older than `stale_after` s are refused
    /// unless that is 0.
    #[must_use]
    pub fn new(start: Bounds, stale_after: f64) -> Self {
        Self { start, stale_after, last: None, target: [0.0; wall::COUNT], report: None }
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
        let target: [f64; wall::COUNT] = match command.mode {
            Mode::Increment => std::array::from_fn(|w| self.target[w] + command.displacement[w]),
            Mode::Absolute | Mode::Unknown(_) => command.displacement,
        };
        match self.beyond_travel(&target) {
            Some(text) => Decision::Refuse(Disposition::Limit, text),
            None => Decision::Serve(target, text),
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

    /// Why the walls cannot go to `target`.
    fn beyond_travel(&self, target: &[f64; wall::COUNT]) -> Option<String> {
        let (start, now) = (self.start.sides(), self.start.displaced(target).sides());
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

    /// Remembers a command that reached the walls; `target` when they moved there.
    pub fn served(
        &mut self,
        command: &Command,
        target: Option<[f64; wall::COUNT]>,
        report: &Report,
    ) {
        self.last = Some((command.session.clone(), command.sequence));
        self.target = target.unwrap_or(self.target);
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
    let wall = command.displacement.iter().position(|d| !d.is_finite())?;
    Some(format!(
        "displacement of {} is {}: a finite number of metres is needed",
        wall::NAMES[wall],
        command.displacement[wall]
    ))
}
