//! The PC's own relation to a board's clock, from two-way exchanges.

use shared::protocol::ClockReply;
use std::collections::VecDeque;

/// Exchanges that count; older ones are forgotten.
const WINDOW: usize = 100;
/// Exchanges before the relation is used.
const ENOUGH: usize = 10;

/// Offset of a board's clock from the PC's.
///
/// Each exchange gives half the sum of both ways; the error of one is half the difference of its two ways.
/// The half of the exchanges with the shortest round trip is kept, since a stall lengthens one way only, and
/// their median is taken, since an emulated board that stalled and catches up answers quickly but wrongly.
#[derive(Clone, Debug, Default)]
pub struct ClockRelation {
    /// Round trip without the time spent on the board, offset board − PC \[µs\].
    exchanges: VecDeque<(i64, i64)>,
}

impl ClockRelation {
    /// Takes a reply that arrived at `arrived_us` of the PC's clock.
    pub fn add(&mut self, reply: &ClockReply, arrived_us: u64) {
        let [asked, received, replied, arrived] =
            [reply.asked_us, reply.received_us, reply.replied_us, arrived_us].map(|t| t as i64);
        let round_trip = (arrived - asked) - (replied - received);
        let offset = ((received - asked) + (replied - arrived)).div_euclid(2);
        if self.exchanges.len() == WINDOW {
            self.exchanges.pop_front();
        }
        self.exchanges.push_back((round_trip, offset));
    }

    /// Board − PC \[µs\]; `None` until there were enough exchanges.
    pub fn offset_us(&self) -> Option<i64> {
        if self.exchanges.len() < ENOUGH {
            return None;
        }
        let mut by_round_trip: Vec<_> = self.exchanges.iter().copied().collect();
        by_round_trip.sort_unstable();
        let mut offsets: Vec<i64> = by_round_trip[..by_round_trip.len().div_ceil(2)]
            .iter()
            .map(|e| e.1)
            .collect();
        offsets.sort_unstable();
        Some(offsets[offsets.len() / 2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reply of a board whose clock is `offset` ahead, after `there` and `back` µs on the way.
    fn exchange(relation: &mut ClockRelation, asked: u64, offset: u64, there: u64, back: u64) {
        let received_us = asked + there + offset;
        let replied_us = received_us + 30;
        let reply = ClockReply {
            asked_us: asked,
            received_us,
            replied_us,
        };
        relation.add(&reply, replied_us - offset + back);
    }

    #[test]
    fn stalls_on_one_way_do_not_move_the_relation() {
        let mut relation = ClockRelation::default();
        for k in 0..60 {
            let stall = if k % 3 == 0 { 90_000 } else { 0 };
            exchange(&mut relation, k * 50_000, 7_000_000, 250 + k % 7, 250 + stall);
        }
        let offset = relation.offset_us().unwrap();
        assert!((offset - 7_000_000).abs() <= 5, "{offset}");
    }

    #[test]
    fn a_board_that_lags_for_a_while_does_not_move_the_relation() {
        let mut relation = ClockRelation::default();
        for k in 0..40 {
            let lag = if k % 4 == 0 { 3_000 } else { 0 };
            exchange(&mut relation, k * 50_000, 7_000_000 - lag, 250 + k % 5, 250);
        }
        let offset = relation.offset_us().unwrap();
        assert!((offset - 7_000_000).abs() <= 5, "{offset}");
    }

    #[test]
    fn a_few_exchanges_are_no_relation() {
        let mut relation = ClockRelation::default();
        exchange(&mut relation, 0, 5, 1, 1);
        assert_eq!(relation.offset_us(), None);
    }
}
