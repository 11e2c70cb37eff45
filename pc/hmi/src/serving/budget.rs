//! Bytes that may go to each viewer.

use std::time::Duration;

/// Bytes a second, but for what a viewer is told at once when it comes: 300 kB/s with what TLS and its like add.
const RATE: f64 = 240e3;
/// What may go beyond it for a moment \[bytes\].
const BURST: f64 = 30e3;

/// See the module.
#[derive(Debug)]
pub(super) struct Budget {
    left: f64,
    at: Duration,
}

impl Default for Budget {
    fn default() -> Self {
        Self {
            left: BURST,
            at: Duration::ZERO,
        }
    }
}

impl Budget {
    /// It is `now`.
    pub fn fill(&mut self, now: Duration) {
        let passed = now.saturating_sub(self.at).as_secs_f64();
        (self.left, self.at) = ((self.left + RATE * passed).min(BURST), now);
    }

    /// Whether there is anything left.
    pub fn is_left(&self) -> bool {
        self.left > 0.0
    }

    /// `bytes` have gone.
    pub fn spend(&mut self, bytes: usize) {
        self.left -= bytes as f64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_sends_whenever_anything_is_left_stays_below_300_kilobytes_in_any_second() {
        // 20 messages a second: of pictures, as far as they may be, and of a tenth of a second in which nothing is sent.
        let mut budget = Budget::default();
        let mut sent = Vec::new();
        for message in 0..400_u64 {
            budget.fill(Duration::from_millis(50 * message));
            let bytes = if budget.is_left() && message % 37 > 1 {
                24_000
            } else {
                0
            };
            budget.spend(bytes);
            sent.push(bytes);
        }
        let second = |second: &[usize]| second.iter().sum::<usize>();
        let most = sent.windows(20).map(second).max();
        assert!(most.is_some_and(|most| most < 300_000), "{most:?}");
        assert!(sent.iter().sum::<usize>() > 20 * 220_000);
    }
}
