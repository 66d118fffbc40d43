//! Circumstances as messages, and back.

use std::path::PathBuf;

use super::{Circumstance as Message, Header};
use crate::command::circumstance::{Circumstance, Happened};
use crate::command::request::{Answer, Request};
use crate::twin::Settings;

const RESET: u8 = 0;
const HOLD: u8 = 1;
const RELEASE: u8 = 2;
const RESET_FAULTS: u8 = 3;
const SAVE_PACK: u8 = 4;
const SETTINGS: u8 = 5;
const AGE: u8 = 6;
const MALFORMED: u8 = 7;

/// Name of the value of [`AGE`].
const SECONDS: &str = "age";

/// A setting as a number: its key in the scene, how it is read and how it is set.
type Setting = (&'static str, fn(&Settings) -> f64, fn(&mut Settings, f64));

const KEYS: [Setting; 8] = [
    ("node.stale_after", |of| of.stale_after, |of, value| of.stale_after = value),
    ("node.limits.travel", |of| of.limits.travel, |of, value| of.limits.travel = value),
    ("node.limits.rate", |of| of.limits.rate, |of, value| of.limits.rate = value),
    ("node.limits.strain", |of| of.limits.strain, |of, value| of.limits.strain = value),
    ("node.limits.force", |of| of.limits.force, |of, value| of.limits.force = value),
    (
        "node.limits.clamp",
        |of| f64::from(u8::from(of.limits.clamp)),
        |of, value| of.limits.clamp = value != 0.0,
    ),
    ("solver.tolerance", |of| of.tolerance, |of, value| of.tolerance = value),
    (
        "solver.max_strain_increment",
        |of| of.max_strain_increment,
        |of, value| of.max_strain_increment = value,
    ),
];

impl From<&Happened> for Message {
    fn from(happened: &Happened) -> Self {
        let Happened { increment, stamp, what } = happened;
        let header = Header { stamp: (*stamp).into(), frame_id: String::new() };
        let mut message = Self { header, increment: *increment, success: true, ..Self::default() };
        match what {
            Circumstance::Asked(request, answer) => {
                message.kind = match request {
                    Request::Reset => RESET,
                    Request::Hold(true) => HOLD,
                    Request::Hold(false) => RELEASE,
                    Request::ResetFaults => RESET_FAULTS,
                    Request::SavePack(_) => SAVE_PACK,
                };
                message.success = answer.is_ok();
                let (Ok(text) | Err(text)) = answer;
                message.text.clone_from(text);
            }
            Circumstance::Settings(settings) => {
                message.kind = SETTINGS;
                message.name = KEYS.iter().map(|(name, ..)| (*name).into()).collect();
                message.value = KEYS.iter().map(|(_, value, _)| value(settings)).collect();
            }
            Circumstance::Age(seconds) => {
                message.kind = AGE;
                message.name = vec![SECONDS.into()];
                message.value = vec![*seconds];
            }
            Circumstance::Malformed(text) => {
                message.kind = MALFORMED;
                message.text.clone_from(text);
            }
        }
        message
    }
}

impl TryFrom<Message> for Happened {
    type Error = String;

    /// The error says what the message lacks. Where a pack was stored, the message does not tell.
    fn try_from(message: Message) -> Result<Self, String> {
        let Message { header, increment, kind, success, text, .. } = &message;
        let asked = |request| {
            let answer: Answer = if *success { Ok(text.clone()) } else { Err(text.clone()) };
            Circumstance::Asked(request, answer)
        };
        let what = match *kind {
            RESET => asked(Request::Reset),
            HOLD => asked(Request::Hold(true)),
            RELEASE => asked(Request::Hold(false)),
            RESET_FAULTS => asked(Request::ResetFaults),
            SAVE_PACK => asked(Request::SavePack(PathBuf::new())),
            SETTINGS => Circumstance::Settings(settings(&message)?),
            AGE => Circumstance::Age(value(&message, SECONDS)?),
            MALFORMED => Circumstance::Malformed(text.clone()),
            other => return Err(format!("a circumstance of kind {other}; known: 0 to 7")),
        };
        Ok(Self { increment: *increment, stamp: header.stamp.into(), what })
    }
}

fn settings(message: &Message) -> Result<Settings, String> {
    let mut settings = Settings::default();
    for (name, _, set) in KEYS {
        set(&mut settings, value(message, name)?);
    }
    Ok(settings)
}

fn value(message: &Message, name: &str) -> Result<f64, String> {
    let found = message.name.iter().position(|found| found == name);
    found
        .and_then(|place| message.value.get(place).copied())
        .ok_or_else(|| format!("a circumstance of kind {} without `{name}`", message.kind))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Stamp;
    use crate::scene::Limits;

    #[test]
    fn every_circumstance_comes_back_from_its_message() {
        let limits = Limits { travel: 1.0, rate: 2.0, strain: 3.0, force: 4.0, clamp: true };
        let settings =
            Settings { stale_after: 5.0, limits, tolerance: 6.0, max_strain_increment: 7.0 };
        let done = || Ok("done".into());
        let all = [
            Circumstance::Asked(Request::Reset, done()),
            Circumstance::Asked(Request::Hold(true), done()),
            Circumstance::Asked(Request::Hold(false), Err("a fault".into())),
            Circumstance::Asked(Request::ResetFaults, done()),
            Circumstance::Asked(Request::SavePack(PathBuf::new()), Err("a disk".into())),
            Circumstance::Settings(settings),
            Circumstance::Age(0.25),
            Circumstance::Malformed("no name".into()),
        ];
        for (what, increment) in all.into_iter().zip(3..) {
            let happened = Happened { increment, stamp: Stamp { sec: 1, nanosec: 2 }, what };
            let message = Message::from(&happened);
            assert_eq!(Happened::try_from(message), Ok(happened));
        }
    }

    #[test]
    fn what_is_no_circumstance_is_refused() {
        for (kind, said) in [(SETTINGS, "node.stale_after"), (AGE, "age"), (8, "kind 8")] {
            let message = Message { kind, ..Message::default() };
            let refused = Happened::try_from(message).unwrap_err();
            assert!(refused.contains(said), "{refused}");
        }
    }
}
