//! The boards' clocks as the PC sees them: how far they are apart, and what the motion board's shows now.
//!
//! Boards that are emulated on a busy computer run slower than the PC's clock, both by the same. So nothing
//! here holds a board's clock against the PC's for longer than it takes a datagram to arrive.

use shared::protocol::{ClockReply, Role};
use std::collections::VecDeque;

/// Pairs of exchanges that count; older ones are forgotten.
const WINDOW: usize = 100;
/// Pairs before the relation is used.
const ENOUGH: usize = 10;
/// The motion clock is carried on for at most so long after it was last seen \[µs\].
const CARRY_ON_US: u64 = 20_000;

/// One question for a board's time.
#[derive(Clone, Copy, Debug)]
struct Exchange {
    asked_us: i64,
    /// Without the time spent on the board \[µs\].
    round_trip_us: i64,
    /// Board − PC \[µs\].
    offset_us: i64,
}

/// What the PC knows of both clocks.
///
/// Both boards are asked at the same time; a pair of answers gives the difference of the clocks. Each exchange
/// gives half the sum of both ways, its error is half the difference of its two ways. The half of the pairs
/// with the shortest round trips is kept, since a stall lengthens one way only, and of these the median.
#[derive(Clone, Debug, Default)]
pub struct BoardClocks {
    unpaired: [Option<Exchange>; 2],
    /// Round trips of both, tracker − motion \[µs\].
    pairs: VecDeque<(i64, i64)>,
    /// Newest time of the motion board, and the PC's when it arrived \[µs\].
    newest: Option<(u64, u64)>,
}

impl BoardClocks {
    /// Takes a reply that arrived at `arrived_us` of the PC's clock.
    pub fn add(&mut self, role: Role, reply: &ClockReply, arrived_us: u64) {
        let [asked_us, received, replied, arrived] =
            [reply.asked_us, reply.received_us, reply.replied_us, arrived_us].map(|t| t as i64);
        self.unpaired[role as usize] = Some(Exchange {
            asked_us,
            round_trip_us: (arrived - asked_us) - (replied - received),
            offset_us: ((received - asked_us) + (replied - arrived)).div_euclid(2),
        });
        if let [Some(motion), Some(tracker)] = self.unpaired
            && motion.asked_us == tracker.asked_us
        {
            if self.pairs.len() == WINDOW {
                self.pairs.pop_front();
            }
            let round_trips = motion.round_trip_us + tracker.round_trip_us;
            self.pairs
                .push_back((round_trips, tracker.offset_us - motion.offset_us));
        }
    }

    /// Takes a time of the motion clock that arrived just now.
    pub fn saw_motion(&mut self, time_us: u64, arrived_us: u64) {
        if self.newest.is_none_or(|(newest, _)| time_us > newest) {
            self.newest = Some((time_us, arrived_us));
        }
    }

    /// How far the tracker's clock is ahead of the motion board's \[µs\]; `None` until there were enough pairs.
    pub fn tracker_ahead_us(&self) -> Option<i64> {
        if self.pairs.len() < ENOUGH {
            return None;
        }
        let mut by_round_trip: Vec<_> = self.pairs.iter().copied().collect();
        by_round_trip.sort_unstable();
        let best = &by_round_trip[..by_round_trip.len().div_ceil(2)];
        let mut differences: Vec<i64> = best.iter().map(|pair| pair.1).collect();
        differences.sort_unstable();
        Some(differences[differences.len() / 2])
    }

    /// What the motion board's clock shows at `now_us` of the PC's \[µs\]; `None` if it was never seen.
    pub fn motion_now_us(&self, now_us: u64) -> Option<u64> {
        let (time_us, arrived_us) = self.newest?;
        Some(time_us + now_us.saturating_sub(arrived_us).min(CARRY_ON_US))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AHEAD: u64 = 7_000_000;

    /// A question to a board whose clock is `offset` ahead of the PC's, `there` and `back` µs on the way.
    fn exchange(clocks: &mut BoardClocks, role: Role, asked_us: u64, offset: u64, [there, back]: [u64; 2]) {
        let received_us = asked_us + there + offset;
        let replied_us = received_us + 30;
        let reply = ClockReply {
            asked_us,
            received_us,
            replied_us,
        };
        clocks.add(role, &reply, replied_us - offset + back);
    }

    #[test]
    fn stalls_on_one_way_do_not_move_the_relation() {
        let mut clocks = BoardClocks::default();
        for k in 0..60 {
            let stall = if k % 3 == 0 { 90_000 } else { 0 };
            exchange(&mut clocks, Role::Motion, k * 50_000, 1_000, [250, 250 + k % 3]);
            exchange(
                &mut clocks,
                Role::Tracker,
                k * 50_000,
                1_000 + AHEAD,
                [250 + k % 7, 250 + stall],
            );
        }
        let ahead = clocks.tracker_ahead_us().unwrap();
        assert!((ahead - AHEAD as i64).abs() <= 5, "{ahead}");
    }

    #[test]
    fn boards_that_run_slow_together_do_not_move_the_relation() {
        let mut clocks = BoardClocks::default();
        for k in 0..60 {
            let behind = 2_000 * k;
            exchange(
                &mut clocks,
                Role::Tracker,
                k * 50_000,
                1_000_000 + AHEAD - behind,
                [250, 250],
            );
            exchange(
                &mut clocks,
                Role::Motion,
                k * 50_000,
                1_000_000 - behind,
                [250, 250],
            );
        }
        let ahead = clocks.tracker_ahead_us().unwrap();
        assert!((ahead - AHEAD as i64).abs() <= 5, "{ahead}");
    }

    #[test]
    fn answers_to_different_questions_are_no_pair() {
        let mut clocks = BoardClocks::default();
        for k in 0..60 {
            exchange(&mut clocks, Role::Motion, k * 50_000, 0, [250, 250]);
            exchange(&mut clocks, Role::Tracker, k * 50_000 + 1, AHEAD, [250, 250]);
        }
        assert_eq!(clocks.tracker_ahead_us(), None);
    }

    #[test]
    fn the_motion_clock_is_carried_on_from_its_newest_time_but_not_for_long() {
        let mut clocks = BoardClocks::default();
        assert_eq!(clocks.motion_now_us(5), None);
        clocks.saw_motion(1_000, 50_000);
        clocks.saw_motion(900, 60_000);
        assert_eq!(clocks.motion_now_us(52_000), Some(3_000));
        assert_eq!(clocks.motion_now_us(9_000_000), Some(1_000 + CARRY_ON_US));
    }
}
