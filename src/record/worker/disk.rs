//! Whether the disk will do.

use std::path::Path;
use std::time::Duration;

/// Room below which to warn \[bytes\].
const LITTLE: u64 = 256 << 20;

/// Time until the disk is full below which to warn.
const SOON: Duration = Duration::from_secs(60);

/// Over which the present rate is taken: longer than a burst, shorter than a phase of a test.
const WINDOW: Duration = Duration::from_secs(5);

/// Warns once of a disk that fills up.
#[derive(Debug, Default)]
pub(super) struct Watch {
    warned: bool,
    /// When the window began, and the size by then.
    from: (Duration, u64),
    /// Bytes in a second, over the last whole window.
    rate: f64,
}

impl Watch {
    /// What is to be said when the recording has `written` bytes after running for `time`, and
    /// `free` are left.
    pub(super) fn look(&mut self, time: Duration, written: u64, free: u64) -> Option<String> {
        let (since, before) = self.from;
        let window = time.saturating_sub(since);
        if window >= WINDOW {
            self.rate = written.saturating_sub(before) as f64 / window.as_secs_f64();
            self.from = (time, written);
        }
        let left = free as f64 / self.rate;
        let soon = left < SOON.as_secs_f64();
        if self.warned || (free >= LITTLE && !soon) {
            return None;
        }
        self.warned = true;
        let when = if self.rate > 0.0 {
            format!(", {left:.0} s at the present rate")
        } else {
            String::new()
        };
        Some(format!("the disk of the recording has {} MiB left{when}", free >> 20))
    }
}

/// What the file system of `folder` has left for programs like this one.
#[cfg(unix)]
pub(super) fn free_bytes(folder: &Path) -> Option<u64> {
    let found = nix::sys::statvfs::statvfs(folder).ok()?;
    // The width of these numbers differs from system to system.
    #[allow(clippy::unnecessary_cast, clippy::useless_conversion, reason = "it does not on Linux")]
    let (blocks, size) = (u64::from(found.blocks_available()), found.fragment_size() as u64);
    Some(blocks.saturating_mul(size))
}

#[cfg(not(unix))]
pub(super) fn free_bytes(_: &Path) -> Option<u64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_room_is_told_once() {
        let mut watch = Watch::default();
        assert_eq!(watch.look(Duration::from_secs(1), 10, 300 << 20), None);
        let said = watch.look(Duration::from_secs(2), 10, 200 << 20).unwrap();
        assert_eq!(said, "the disk of the recording has 200 MiB left");
        assert_eq!(watch.look(Duration::from_secs(3), 10, 100 << 20), None);
    }

    #[test]
    fn a_disk_that_is_full_within_a_minute_is_told_whatever_its_size() {
        let mut watch = Watch::default();
        // 100 MiB a second: 10 GiB last 102 s, 5 GiB 51 s.
        let written = |seconds: u64| (100 * seconds) << 20;
        assert_eq!(watch.look(Duration::from_secs(5), written(5), 10 << 30), None);
        let said = watch.look(Duration::from_secs(60), written(60), 5 << 30).unwrap();
        assert_eq!(said, "the disk of the recording has 5120 MiB left, 51 s at the present rate");
    }

    #[test]
    fn a_burst_long_ago_does_not_count() {
        let mut watch = Watch::default();
        assert_eq!(watch.look(Duration::from_secs(5), 1 << 30, 100 << 30), None);
        assert_eq!(watch.look(Duration::from_secs(60), (1 << 30) + 1000, 1 << 30), None);
    }
}
