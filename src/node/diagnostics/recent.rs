//! Counts that rose a short while ago.

/// Looks, a second apart, for which a rise is recent.
const LOOKS: u32 = 5;

/// A count as it was at the last look.
#[derive(Debug, Default)]
pub(super) struct Recent {
    last: u64,
    left: u32,
}

impl Recent {
    /// Takes what the count is now; whether it rose in this look or the few before.
    pub(super) fn rose(&mut self, now: u64) -> bool {
        self.left = if now > self.last { LOOKS } else { self.left.saturating_sub(1) };
        self.last = now;
        self.left > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rise_is_recent_for_five_looks() {
        let mut recent = Recent::default();
        assert!(!recent.rose(0));
        let seen: Vec<bool> = [2, 2, 2, 2, 2, 2, 2, 3].map(|now| recent.rose(now)).into();
        assert_eq!(seen, [true, true, true, true, true, false, false, true]);
    }
}
