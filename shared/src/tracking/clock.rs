//! How the clock of another board relates to this one's.
//!
//! Each board's clock runs evenly, and between two of them lies nearly a constant. Every datagram of the other
//! board carries the time it was sent; received minus sent is that constant plus the transit. Its filter is a
//! slow loop with a clamped error: bursts and stalls of the network move it by microseconds, where minimum-delay
//! filters and regressions lock on to them. The transit itself, which no one-way datagram can show, comes from
//! round trips.
//!
//! *Local* is the clock of this board, *remote* that of the other; all times are µs since boot.

use core::f64::consts::PI;
use heapless::{HistoryBuf, Vec};

/// Samples of which the median starts the filter.
const SEED: usize = 200;
/// Round trips of which the median is the transit.
const ROUND_TRIPS: usize = 15;
/// Bandwidth \[Hz\] and damping of the filter.
const BANDWIDTH: f64 = 0.1;
const DAMPING: f64 = 0.7;
/// The filter sees no larger error than this \[µs\].
const ERROR_CLAMP: f64 = 50.0;
/// Off by more than this \[µs\] for [`FAR_SAMPLES`] in a row, the other board was restarted: seed again. Until
/// that is done the old relation stands.
const FAR: f64 = 5000.0;
const FAR_SAMPLES: u32 = 500;
/// Longest step the filter takes at once \[s\].
const MAX_STEP: f64 = 0.1;
/// Time constant of the published residual \[s\].
const RESIDUAL_TIME: f64 = 1.0;
/// Slower round trips say nothing about the transit \[µs\].
const SLOWEST_ROUND_TRIP: i64 = 50_000;
/// What the filter may wander by while round trips are remembered \[µs\].
const WANDER: f64 = 200.0;
/// Questions that may be under way.
const ASKED: usize = 4;
/// Samples and round trips after which the relation is settled.
const SETTLED_SAMPLES: u32 = 1000;
const SETTLED_ROUND_TRIPS: usize = 5;

/// Relation of two clocks; see the module.
#[derive(Clone, Debug)]
pub struct ClockRelation {
    /// Received − sent, until there are enough to start, or to start again.
    seed: Vec<i64, SEED>,
    filter: Option<Filter>,
    /// Transits found by round trips, and by how much they may be wrong \[µs\].
    transits: HistoryBuf<(f64, f64), ROUND_TRIPS>,
    transit: f64,
    /// Questions that were not answered yet, by the local time they were asked at, oldest first.
    asked: Vec<u64, ASKED>,
}

#[derive(Clone, Copy, Debug)]
struct Filter {
    /// Received − sent at the start \[µs\].
    base: i64,
    /// Filtered change since then \[µs\].
    offset: f64,
    /// Its rate \[µs/s\].
    rate: f64,
    last_sent_us: u64,
    residual: f64,
    samples: u32,
    /// Samples in a row that were far off.
    far: u32,
}

impl Default for ClockRelation {
    fn default() -> Self {
        Self::new()
    }
}

impl ClockRelation {
    /// Nothing is known yet.
    pub const fn new() -> Self {
        Self {
            seed: Vec::new(),
            filter: None,
            transits: HistoryBuf::new(),
            transit: 0.0,
            asked: Vec::new(),
        }
    }

    /// How much later than usual a datagram arrived \[µs\] that the other board sent at `sent_us` of its clock, at
    /// `received_us` of this one's; `None` until enough have arrived.
    pub fn lateness_us(&self, sent_us: u64, received_us: u64) -> Option<f64> {
        let filter = self.filter.as_ref()?;
        Some(filter.error(received_us.wrapping_sub(sent_us) as i64))
    }

    /// A datagram the other board sent at `sent_us` of its clock arrived at `received_us` of this one's.
    pub fn add(&mut self, sent_us: u64, received_us: u64) {
        let difference = received_us.wrapping_sub(sent_us) as i64;
        let seeding = match &mut self.filter {
            Some(filter) => {
                filter.add(difference, sent_us);
                filter.far >= FAR_SAMPLES
            }
            None => true,
        };
        if !seeding {
            self.seed.clear();
        } else if self.seed.push(difference).is_err() || self.seed.is_full() {
            let (_, median, _) = self.seed.select_nth_unstable(SEED / 2);
            self.filter = Some(Filter::start(*median, sent_us));
            self.seed.clear();
            // Found with the clock as it was before; the median of them stays until there are others.
            self.transits = HistoryBuf::new();
        }
    }

    /// This board asks the other for its clock at `asked_us` of its own: only what was asked is answered.
    pub fn ask(&mut self, asked_us: u64) {
        if self.asked.is_full() {
            self.asked.remove(0);
        }
        // There is room: the oldest was just removed if there was none.
        let stored = self.asked.push(asked_us).is_ok();
        debug_assert!(stored);
    }

    /// This board asked at `asked_us` of its clock, the other received it at `received_us` and replied at
    /// `replied_us` of its own, and the reply was back at `back_us`. False if that cannot be: no request was
    /// open, it took too long or less than no time, or the two ways took longer than both together, which is
    /// how far a round trip may be wrong.
    pub fn add_round_trip(&mut self, asked_us: u64, received_us: u64, replied_us: u64, back_us: u64) -> bool {
        let Some(question) = self.asked.iter().position(|asked| *asked == asked_us) else {
            return false;
        };
        self.asked.remove(question);
        // What was asked before the relation is known is answered in vain.
        let Some(filter) = &self.filter else { return true };
        let there = received_us.wrapping_sub(asked_us) as i64;
        let back = back_us.wrapping_sub(replied_us) as i64;
        let travelled = there.wrapping_add(back);
        if !(0..=SLOWEST_ROUND_TRIP).contains(&travelled) {
            return false;
        }
        // Local − remote by the round trip, which takes both ways for equally long.
        let two_way = 0.5 * (back.wrapping_sub(filter.base) as f64 - there.wrapping_add(filter.base) as f64);
        let transit = filter.offset - two_way;
        let wrong_by = 0.5 * travelled as f64;
        // Nothing arrives before it was sent, and other datagrams come the way that this one came.
        if transit < -wrong_by - WANDER || transit > 2.0 * wrong_by + FAR {
            return false;
        }
        if self.transits.len() >= SETTLED_ROUND_TRIPS {
            let others = self.transits.as_slice().iter().map(|(_, wrong_by)| *wrong_by);
            let most = others.fold(wrong_by, f64::max);
            if libm::fabs(transit - self.transit) > wrong_by + most + WANDER {
                return false;
            }
        }
        self.transits.write((transit, wrong_by));
        let mut sorted: Vec<f64, ROUND_TRIPS> = self.transits.oldest_ordered().map(|(t, _)| *t).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        self.transit = sorted[sorted.len() / 2];
        true
    }

    /// Remote time at the local time `local_us`; `None` until enough datagrams have arrived.
    pub fn to_remote(&self, local_us: u64) -> Option<u64> {
        let filter = self.filter.as_ref()?;
        let fine = crate::units::round_half_away(self.transit - filter.offset) as i64;
        Some(
            local_us
                .wrapping_sub(filter.base as u64)
                .wrapping_add(fine as u64),
        )
    }

    /// Mean size of the filter's error \[µs\], 0 before it runs; it saturates at the clamp of 50 µs.
    pub fn residual_us(&self) -> f64 {
        self.filter.as_ref().map_or(0.0, |f| f.residual)
    }

    /// Enough datagrams and round trips were seen.
    pub fn settled(&self) -> bool {
        self.filter.as_ref().is_some_and(|f| f.samples >= SETTLED_SAMPLES)
            && self.transits.len() >= SETTLED_ROUND_TRIPS
    }
}

impl Filter {
    fn start(base: i64, sent_us: u64) -> Self {
        Self {
            base,
            offset: 0.0,
            rate: 0.0,
            last_sent_us: sent_us,
            residual: 0.0,
            samples: 0,
            far: 0,
        }
    }

    /// How far `difference`, received − sent, is from what it should be \[µs\].
    fn error(&self, difference: i64) -> f64 {
        difference.wrapping_sub(self.base) as f64 - self.offset
    }

    fn add(&mut self, difference: i64, sent_us: u64) {
        if libm::fabs(self.error(difference)) > FAR {
            self.far += 1;
            return;
        }
        self.far = 0;
        // A datagram that was overtaken says nothing new about the time passed.
        let dt = (sent_us.saturating_sub(self.last_sent_us) as f64 * 1e-6).min(MAX_STEP);
        self.last_sent_us = self.last_sent_us.max(sent_us);
        self.offset += self.rate * dt;
        let error = self.error(difference).clamp(-ERROR_CLAMP, ERROR_CLAMP);
        let omega = 2.0 * PI * BANDWIDTH;
        self.offset += 2.0 * DAMPING * omega * error * dt;
        self.rate += omega * omega * error * dt;
        self.residual += (libm::fabs(error) - self.residual) * (dt / RESIDUAL_TIME);
        self.samples = self.samples.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A remote clock that was started `OFFSET` earlier and runs 20 ppm fast.
    const OFFSET: u64 = 5_000_000_000;

    fn remote(local_us: u64) -> u64 {
        local_us + OFFSET + local_us / 50_000
    }

    /// Pseudo-random transit: 250 µs and a tail, sometimes a stall of up to 40 ms.
    struct Network(u64);

    impl Network {
        fn transit(&mut self) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let r = self.0 >> 33;
            let stall = if r.is_multiple_of(997) { r % 40_000 } else { 0 };
            250 + r % 60 + stall
        }
    }

    fn run(clock: &mut ClockRelation, network: &mut Network, from_ms: u64, to_ms: u64) -> f64 {
        let mut worst = 0.0;
        for ms in from_ms..to_ms {
            let now = ms * 1000;
            clock.add(remote(now), now + network.transit());
            if ms % 100 == 50 {
                let there = now + network.transit();
                let back = there + 30 + network.transit();
                clock.ask(now);
                assert!(clock.add_round_trip(now, remote(there), remote(there + 30), back));
            }
            if let Some(seen) = clock.to_remote(now) {
                worst = f64::max(worst, seen.abs_diff(remote(now)) as f64);
            }
        }
        worst
    }

    #[test]
    fn through_jitter_and_stalls_the_relation_holds_within_80_us() {
        let (mut clock, mut network) = (ClockRelation::new(), Network(1));
        run(&mut clock, &mut network, 0, 3000);
        assert!(clock.settled());
        let worst = run(&mut clock, &mut network, 3000, 30_000);
        assert!(worst <= 80.0, "{worst} µs");
        assert!(clock.residual_us() > 0.0 && clock.residual_us() <= 50.0);
    }

    #[test]
    fn without_round_trips_the_transit_remains_and_it_is_not_settled() {
        let mut clock = ClockRelation::new();
        assert_eq!(clock.to_remote(0), None);
        for ms in 0..2000 {
            clock.add(ms * 1000 + 77, ms * 1000 + 300);
        }
        assert_eq!(clock.to_remote(10_000_000), Some(10_000_000 + 77 - 300));
        assert!(!clock.settled());
        // A round trip that took as long there as back shows the transit of 300 µs.
        clock.ask(0);
        assert!(clock.add_round_trip(0, 377, 377, 600));
        assert_eq!(clock.to_remote(10_000_000), Some(10_000_077));
    }

    #[test]
    fn a_restarted_board_is_followed_within_a_second_and_a_stall_is_not() {
        let (mut clock, mut network) = (ClockRelation::new(), Network(2));
        run(&mut clock, &mut network, 0, 3000);
        for ms in 3000..3100 {
            clock.add(remote(ms * 1000), ms * 1000 + 90_000);
        }
        let off = clock.to_remote(3_100_000).unwrap().abs_diff(remote(3_100_000));
        assert!(off <= 100, "{off} µs after a stall of 100 ms");
        for ms in 3100..4100 {
            assert!(clock.to_remote(ms * 1000).is_some());
            clock.add(ms * 1000 - 3_100_000, ms * 1000 + clock.transit as u64);
        }
        assert!(clock.to_remote(4_100_000).unwrap().abs_diff(1_000_000) <= 1);
        assert!(!clock.settled());
    }

    #[test]
    fn replies_that_nobody_asked_for_or_that_jump_are_not_believed() {
        let (mut clock, mut network) = (ClockRelation::new(), Network(3));
        run(&mut clock, &mut network, 0, 3000);
        let before = clock.to_remote(3_000_000).unwrap();
        for k in 0..20 {
            let now = 3_000_000 + k;
            // Asked by another.
            assert!(!clock.add_round_trip(now, remote(now + 250), remote(now + 280), now + 530));
            // 30 ms off, in either direction, and one that takes two ways for 2 ms.
            for off in [30_000, -30_000i64, 2_000] {
                clock.ask(now);
                let at = |us: u64| remote(us).wrapping_add_signed(off);
                assert!(
                    !clock.add_round_trip(now, at(now + 250), at(now + 280), now + 530),
                    "{off}"
                );
            }
            clock.ask(now);
            assert!(clock.add_round_trip(now, remote(now + 250), remote(now + 280), now + 530));
            assert!(
                !clock.add_round_trip(now, remote(now + 250), remote(now + 280), now + 530),
                "once"
            );
        }
        assert!(clock.to_remote(3_000_000).unwrap().abs_diff(before) <= 40);
    }

    #[test]
    fn one_datagram_from_the_future_changes_nothing() {
        let (mut clock, mut network) = (ClockRelation::new(), Network(4));
        run(&mut clock, &mut network, 0, 3000);
        let before = clock.to_remote(3_000_000).unwrap();
        clock.add(remote(100_000_000), 3_000_000);
        assert_eq!(clock.to_remote(3_000_000), Some(before));
        assert!(clock.lateness_us(remote(100_000_000), 3_000_000).unwrap() < -1e7);
        let worst = run(&mut clock, &mut network, 3000, 10_000);
        assert!(worst <= 80.0, "{worst} µs");
    }
}
