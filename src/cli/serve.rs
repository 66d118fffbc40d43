//! The loop of `run`: commands in, answers to every sink.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::anyhow;

use graintwin::command::request::Intake;
use graintwin::command::{Command, Disposition};
use graintwin::report::{Demand, Report};
use graintwin::scene::{ModuliKind, Outputs, When};
use graintwin::sink::{Served, Sink};
use graintwin::twin::Twin;

use super::Failure;

/// Relaxes the pack and serves `intakes` until they end or `stop` is set.
pub(super) fn serve(
    twin: &mut Twin,
    outputs: Outputs,
    intakes: impl Iterator<Item = Intake>,
    sinks: &mut [Box<dyn Sink + '_>],
    stop: &AtomicBool,
) -> Result<(), Failure> {
    let first = timed(|| twin.start(demand(outputs, sinks)));
    let failed = first.disposition == Disposition::NotConverged;
    let why = failed.then(|| first.text.clone());
    hand_over(None, first, sinks);
    if let Some(why) = why {
        return Err(Failure::Other(anyhow!("no equilibrium to start from: {why}")));
    }
    for intake in intakes {
        if stop.load(Ordering::SeqCst) {
            break;
        }
        match intake {
            Intake::Command(command) => {
                let report = timed(|| twin.apply(&command, demand(outputs, sinks)));
                hand_over(Some(command), report, sinks);
            }
            Intake::Request(asked) => {
                asked.answer(Err("this version serves commands only".into()));
            }
        }
    }
    Ok(())
}

/// What the scene orders and what the sinks want of the next increment.
fn demand(outputs: Outputs, sinks: &[Box<dyn Sink + '_>]) -> Demand {
    let wanted =
        sinks.iter().map(|sink| sink.demand()).fold(Demand::default(), |all, one| Demand {
            state: all.state || one.state,
            moduli: all.moduli || one.moduli,
            contact_network: all.contact_network || one.contact_network,
        });
    Demand {
        state: wanted.state,
        moduli: match outputs.moduli {
            ModuliKind::Secant => wanted.moduli,
            ModuliKind::None => false,
        },
        contact_network: match outputs.contact_network {
            When::Always => true,
            When::OnDemand => wanted.contact_network,
            When::Never => false,
        },
    }
}

/// The twin has no clock: the time an answer took is filled in here.
fn timed(answer: impl FnOnce() -> Report) -> Report {
    let start = Instant::now();
    let mut report = answer();
    if let Some(state) = report.measures.as_mut().and_then(|measures| measures.state.as_mut()) {
        state.solve_seconds = start.elapsed().as_secs_f64();
    }
    report
}

fn hand_over(command: Option<Command>, report: Report, sinks: &mut [Box<dyn Sink + '_>]) {
    let served = Arc::new(Served { command, report });
    for sink in sinks {
        sink.served(&served);
    }
}
