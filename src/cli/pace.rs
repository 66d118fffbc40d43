//! How fast a recording is shown.

use std::str::FromStr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// How often a wait looks at the stop flag.
const LOOK: Duration = Duration::from_millis(20);

/// A pace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rate {
    /// This multiple of the recorded one, above 0.
    Times(f64),
    /// As fast as it goes.
    Full,
}

impl Rate {
    /// That of the recording.
    pub(super) const RECORDED: Self = Self::Times(1.0);
}

impl FromStr for Rate {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            Ok(rate) if rate > 0.0 && rate.is_finite() => Ok(Self::Times(rate)),
            _ if text == "full" => Ok(Self::Full),
            _ => Err("allowed: a number above 0, or `full`".into()),
        }
    }
}

/// Waits until it is time for what was recorded at some time.
pub(super) struct Pace {
    rate: Rate,
    stop: Arc<AtomicBool>,
    /// When the first came here, and when it was recorded \[ns\].
    first: Option<(Instant, u64)>,
}

impl Pace {
    pub(super) fn new(rate: Rate, stop: Arc<AtomicBool>) -> Self {
        Self { rate, stop, first: None }
    }

    /// Whether somebody asked to stop.
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    /// Waits for what was recorded at `time` \[ns\]; false when somebody asked to stop.
    pub(super) fn wait(&mut self, time: u64) -> bool {
        let Rate::Times(rate) = self.rate else { return !self.is_stopped() };
        let (start, first) = *self.first.get_or_insert_with(|| (Instant::now(), time));
        let after = Duration::from_nanos(time.saturating_sub(first)).as_secs_f64() / rate;
        // What is too far away to be a time is waited for until somebody asks to stop.
        let after = Duration::try_from_secs_f64(after).unwrap_or(Duration::MAX);
        while !self.is_stopped() {
            let left = after.saturating_sub(start.elapsed());
            if left.is_zero() {
                return true;
            }
            sleep(left.min(LOOK));
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_is_a_positive_number_or_full() {
        assert_eq!("0.5".parse(), Ok(Rate::Times(0.5)));
        assert_eq!("full".parse(), Ok(Rate::Full));
        for wrong in ["0", "-1", "nan", "inf", "", "fast"] {
            assert!(wrong.parse::<Rate>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_was_recorded_later_comes_later_by_the_rate() {
        let mut pace = Pace::new(Rate::Times(4.0), Arc::default());
        let start = Instant::now();
        assert!(pace.wait(5_000_000_000));
        assert!(pace.wait(5_400_000_000));
        assert!(start.elapsed() >= Duration::from_millis(100));
    }

    #[test]
    fn a_stop_ends_the_wait() {
        let stop = Arc::new(AtomicBool::new(true));
        let mut pace = Pace::new(Rate::RECORDED, Arc::clone(&stop));
        assert!(!pace.wait(0));
        assert!(!pace.wait(u64::MAX));
    }
}
