//! A time on the motion board's clock, whose count of milliseconds has 32 bits and starts again after 49
//! days.

/// Milliseconds that are still to go.
#[derive(Clone, Copy, Debug)]
pub struct Countdown {
    /// The count when it was last looked at.
    tick: u32,
    left_ms: u64,
}

impl Countdown {
    /// From the count `tick` on.
    pub fn new(tick: u32, ms: u64) -> Self {
        Self { tick, left_ms: ms }
    }

    /// Whether it is over at the count `tick`; looked at more than once in 49 days.
    pub fn is_over(&mut self, tick: u32) -> bool {
        let gone = u64::from(tick.wrapping_sub(self.tick));
        self.tick = tick;
        self.left_ms = self.left_ms.saturating_sub(gone);
        self.left_ms == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_on_where_the_count_begins_anew() {
        let mut countdown = Countdown::new(u32::MAX - 10, 30);
        assert!(!countdown.is_over(u32::MAX));
        assert!(!countdown.is_over(18));
        assert!(countdown.is_over(19));
    }

    #[test]
    fn it_may_be_longer_than_the_count() {
        let mut countdown = Countdown::new(7, 3 << 32);
        let quarters = (1..=12_u64).map(|k| (7 + (k << 30)) as u32);
        let over: Vec<bool> = quarters.map(|tick| countdown.is_over(tick)).collect();
        assert_eq!(over.iter().position(|over| *over), Some(11));
    }
}
