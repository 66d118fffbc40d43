//! The progress bar: increment, stress, residual, time left.

use std::sync::Arc;
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use graintwin::report::Demand;
use graintwin::sink::{Served, Sink};

/// A bar over the commands of a run. It shows on a terminal only.
pub(super) struct Progress(ProgressBar);

impl Progress {
    /// A bar for `length` commands; without a length, a count.
    pub(super) fn new(length: Option<usize>, bars: &MultiProgress) -> Self {
        let (bar, template) = match length {
            Some(length) => (
                ProgressBar::new(length as u64),
                "{bar:20} increment {pos}/{len} {msg} | {eta} left",
            ),
            None => (ProgressBar::no_length(), "{spinner} increment {pos} {msg}"),
        };
        Self(with_style(bars.add(bar), template))
    }
}

impl Sink for Progress {
    fn demand(&self) -> Demand {
        Demand { state: !self.0.is_hidden(), ..Demand::default() }
    }

    fn served(&mut self, served: &Arc<Served>) {
        let measures = served.report.measures.as_ref();
        if let Some(state) = measures.and_then(|measures| measures.state.as_ref()) {
            self.0.set_message(format!(
                "| {:.3} MPa confining, {:+.3} MPa deviatoric | residual {:.1e}",
                state.confining_stress * 1e-6,
                state.deviatoric_stress * 1e-6,
                state.residual,
            ));
        }
        if served.command.is_some() {
            self.0.inc(1);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// Shows that something takes its time until it is done; `work` may change the words.
pub(super) fn waiting<T>(
    what: String,
    bars: &MultiProgress,
    work: impl FnOnce(&ProgressBar) -> T,
) -> T {
    let bar = with_style(bars.add(ProgressBar::new_spinner()), "{spinner} {msg} {elapsed}");
    bar.set_message(what);
    bar.enable_steady_tick(Duration::from_millis(100));
    let done = work(&bar);
    bar.finish_and_clear();
    done
}

fn with_style(bar: ProgressBar, template: &str) -> ProgressBar {
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
