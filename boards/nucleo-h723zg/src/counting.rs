//! From a timer's counter to a count, or a time, that never wraps.

/// How many bits of a timer count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// 16 bits.
    Bits16,
    /// 32 bits.
    Bits32,
}

impl Width {
    /// Counts from reading `from` to reading `to`, the shorter way round: exact as long as fewer than half the
    /// counter's range lie between them (32 767 counts a servo tick: 131 million a second).
    pub fn step(self, from: u32, to: u32) -> i64 {
        let difference = to.wrapping_sub(from);
        match self {
            Self::Bits16 => i64::from(difference as i16),
            Self::Bits32 => i64::from(difference as i32),
        }
    }

    /// Highest reading, the timer's reload value.
    pub fn highest(self) -> u32 {
        match self {
            Self::Bits16 => u32::from(u16::MAX),
            Self::Bits32 => u32::MAX,
        }
    }
}

/// Half ranges (2³¹ counts) that a 32-bit counter at `count` has begun, when it had begun `seen` at some time
/// less than half a range ago. The lowest bit of the one is the highest bit of the other.
pub fn halves_begun(seen: u32, count: u32) -> u32 {
    if seen & 1 == count >> 31 { seen } else { seen + 1 }
}

/// The 64-bit count of a counter at `count` in its half range number `halves`.
pub fn join(halves: u32, count: u32) -> u64 {
    u64::from(halves) << 31 | u64::from(count & (u32::MAX >> 1))
}

#[cfg(test)]
mod tests {
    use super::{Width, halves_begun, join};

    #[test]
    fn time_runs_on_through_wraps_however_seldom_it_is_asked() {
        for stride in [1u64 << 20, (1 << 31) - 1] {
            let (mut halves, mut truth) = (0, 0);
            while truth < 1 << 36 {
                let count = truth as u32;
                halves = halves_begun(halves, count);
                assert_eq!(join(halves, count), truth, "stride {stride}");
                truth += stride;
            }
        }
    }

    #[test]
    fn a_count_runs_through_wraps_of_the_counter_both_ways() {
        for (width, stride) in [(Width::Bits16, 32_767), (Width::Bits32, i64::from(i32::MAX))] {
            for direction in [1, -1] {
                let (mut total, mut reading, mut truth) = (0, 0, 0);
                for _ in 0..100 {
                    truth += direction * stride;
                    let next = truth as u32 & width.highest();
                    total += width.step(reading, next);
                    reading = next;
                }
                assert_eq!(total, truth, "{width:?} by {stride} in direction {direction}");
            }
        }
    }

    #[test]
    fn a_mark_latched_before_a_wrap_lies_behind_the_count() {
        assert_eq!(Width::Bits16.step(3, 65_530), -9);
        assert_eq!(Width::Bits32.step(3, u32::MAX - 5), -9);
    }
}
