//! What was welded of what is programmed, and how fast: by where the tip truly was while a gate was open.

use crate::WorkTick;
use crate::speeds::HALF_MM;
use cam::along::Along;
use cam::path::{PlannedPath, Programmed};
use nc::Motion;
use serde::Serialize;
use shared::config::BeamConfig;
use shared::io::SIDES;
use shared::trajectory::SpeedLimits;
use std::collections::BTreeMap;

/// Between two ticks further apart than this much telemetry is missing: nobody knows what the beam did there.
const LONGEST_GAP_TICKS: u32 = 10;

/// Speeds with a beam on, as shares of the programmed feed at the same place, and where they were.
///
/// Places that a beam goes over again after a hold count as they were the first time. A beam that stays on at rest, as
/// a spindle does, is not counted where the path leaves rest or comes to it. Where the feed changes, what lies between both
/// is neither low nor high.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SpeedShares {
    /// Lowest \[%\].
    pub lowest_percent: f64,
    /// Where that was, as [`Along`] has it.
    pub lowest_at_mm: f64,
    /// Highest \[%\].
    pub highest_percent: f64,
    /// Where that was.
    pub highest_at_mm: f64,
}

impl SpeedShares {
    /// Of the ticks on `paths`; `None` if there are none with a beam on.
    pub fn of(
        ticks: impl IntoIterator<Item = WorkTick>,
        paths: &BTreeMap<u32, PlannedPath>,
        beams: &[Option<BeamConfig>; SIDES],
    ) -> Option<Self> {
        let rests = beams
            .each_ref()
            .map(|beam| beam.as_ref().is_some_and(|beam| beam.stays_on_at_rest));
        let mut shares: Option<Self> = None;
        // How far each beam has come on the path.
        let (mut path_id, mut farthest) = (0, [f64::NEG_INFINITY; SIDES]);
        let mut programmed = Programmed::default();
        for tick in ticks {
            if tick.path_id != path_id {
                (path_id, farthest) = (tick.path_id, [f64::NEG_INFINITY; SIDES]);
                programmed = paths[&path_id].programmed();
            }
            let mut counts = false;
            for side in (0..SIDES).filter(|side| tick.beams[*side]) {
                let path = &paths[&path_id];
                let new = tick.s_mm > farthest[side];
                farthest[side] = farthest[side].max(tick.s_mm);
                counts |= new && path.motion == Motion::Feed && !(rests[side] && near_rest(path, &tick));
            }
            if let (true, Some(speed)) = (counts && tick.feed_mm_s > 0.0, tick.true_speed_mm_s) {
                let (slow, fast) = programmed.feeds_around(tick.s_mm, transition(&paths[&path_id], &tick));
                if slow <= 0.0 {
                    // From rest, or to it.
                    continue;
                }
                let (low, high) = (100.0 * speed / slow, 100.0 * speed / fast);
                let shares = shares.get_or_insert(Self {
                    lowest_percent: low,
                    lowest_at_mm: tick.along_mm,
                    highest_percent: high,
                    highest_at_mm: tick.along_mm,
                });
                if low < shares.lowest_percent {
                    (shares.lowest_percent, shares.lowest_at_mm) = (low, tick.along_mm);
                }
                if high > shares.highest_percent {
                    (shares.highest_percent, shares.highest_at_mm) = (high, tick.along_mm);
                }
            }
        }
        shares
    }
}

/// Whether a path gets up to the feed at the place of a tick, or comes to rest from it.
fn near_rest(path: &PlannedPath, tick: &WorkTick) -> bool {
    let from_end = (tick.s_mm - path.start_s).min(path.length_mm() - tick.s_mm);
    from_end < transition(path, tick)
}

/// Length of path that a change of the feed may take \[mm\].
fn transition(path: &PlannedPath, tick: &WorkTick) -> f64 {
    let ramp = SpeedLimits {
        velocity: tick.feed_mm_s,
        ..path.limits
    };
    RAMPS * ramp.ramp() + 2.0 * HALF_MM
}

/// So many times the length of the way from rest to the feed: the planner's output filter, and drives that lag behind. What
/// the true speed is told from reaches a little further.
const RAMPS: f64 = 2.0;

/// What one side welded of the stretches where its gate is programmed to be open.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Welded {
    /// Programmed \[mm\].
    pub programmed_mm: f64,
    /// Of it not welded \[mm\].
    pub unwelded_mm: f64,
    /// The longest of the gaps in it \[mm\].
    pub gap_mm: f64,
    /// Where that begins, as [`Along`] has it \[mm\].
    pub gap_at_mm: f64,
}

impl Welded {
    /// By `side` on those of `paths` that were begun.
    ///
    /// Only the way between two ticks that both have the gate open counts as welded, so a gap appears longer than it is
    /// by up to the way of two ticks.
    pub fn of(
        ticks: impl IntoIterator<Item = WorkTick>,
        paths: &BTreeMap<u32, PlannedPath>,
        side: usize,
    ) -> Self {
        let along = Along::of(paths);
        let burnt = burnt(ticks, side);
        let mut welded = Self::default();
        for (id, path) in paths {
            let ways = burnt.get(id).map_or(&[][..], |ways| &ways.pieces);
            for (start, end) in &path.programmed().beams[side] {
                welded.programmed_mm += end - start;
                for (from, to) in gaps((*start, *end), ways) {
                    welded.unwelded_mm += to - from;
                    if to - from > welded.gap_mm {
                        welded.gap_mm = to - from;
                        welded.gap_at_mm = along.at(*id, from).unwrap_or(f64::NAN);
                    }
                }
            }
        }
        welded
    }
}

/// Ways along a path \[mm\].
#[derive(Debug, Default)]
struct Ways {
    /// Not touching and in order, once they are merged.
    pieces: Vec<(f64, f64)>,
    /// How many there were when that was done last.
    merged: usize,
}

impl Ways {
    fn add(&mut self, a: f64, b: f64) {
        let (from, to) = (a.min(b), a.max(b));
        match self.pieces.last_mut() {
            Some(last) if from <= last.1 && last.0 <= to => *last = (last.0.min(from), last.1.max(to)),
            _ => self.pieces.push((from, to)),
        }
        if self.pieces.len() > 2 * self.merged + 1000 {
            self.merge();
        }
    }

    fn merge(&mut self) {
        self.pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
        self.pieces.dedup_by(|next, last| {
            let touches = next.0 <= last.1;
            if touches {
                last.1 = last.1.max(next.1);
            }
            touches
        });
        self.merged = self.pieces.len();
    }
}

/// The ways of `side` between two ticks with its gate open, by path.
fn burnt(ticks: impl IntoIterator<Item = WorkTick>, side: usize) -> BTreeMap<u32, Ways> {
    let mut ways: BTreeMap<u32, Ways> = BTreeMap::new();
    let mut before: Option<WorkTick> = None;
    for tick in ticks {
        if let Some(before) = before.replace(tick) {
            let near = tick.tick.wrapping_sub(before.tick) <= LONGEST_GAP_TICKS;
            if near && before.path_id == tick.path_id && before.beams[side] && tick.beams[side] {
                ways.entry(tick.path_id).or_default().add(before.s_mm, tick.s_mm);
            }
        }
    }
    ways.values_mut().for_each(Ways::merge);
    ways
}

/// What is left of a stretch without `ways`, which are in the order of their beginnings.
fn gaps((start, end): (f64, f64), ways: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut gaps = Vec::new();
    let mut welded_to = start;
    for (from, to) in ways {
        let from = from.min(end);
        if from > welded_to {
            gaps.push((welded_to, from));
        }
        welded_to = welded_to.max(*to);
    }
    if end > welded_to {
        gaps.push((welded_to, end));
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_what_no_way_covers() {
        let ways = [(-1.0, 2.0), (1.0, 3.0), (5.0, 6.0), (5.5, 5.8), (9.0, 12.0)];
        assert_eq!(gaps((0.0, 10.0), &ways), [(3.0, 5.0), (6.0, 9.0)]);
        assert_eq!(gaps((20.0, 30.0), &ways), [(20.0, 30.0)]);
        assert_eq!(gaps((9.0, 10.0), &ways), []);
        assert_eq!(gaps((4.0, 4.5), &[]), [(4.0, 4.5)]);
    }

    fn tick(tick: u32, s_mm: f64, beam: bool) -> WorkTick {
        WorkTick {
            tick,
            path_id: 3,
            s_mm,
            along_mm: s_mm,
            speed_mm_s: 100.0,
            feed_mm_s: 100.0,
            true_speed_mm_s: Some(100.0),
            beams: [beam, false],
            slides_mm: None,
            deviation_mm: [None; 4],
            contour_error_mm: None,
            following_error: [0.0; 7],
        }
    }

    #[test]
    fn where_telemetry_is_missing_nothing_counts_as_welded() {
        let at = |k: u32| tick(k, 0.1 * f64::from(k), true);
        let ticks = [at(0), at(1), at(2), at(30), at(31)];
        let ways = burnt(ticks, 0);
        let pieces = [(0.0, ticks[2].s_mm), (ticks[3].s_mm, ticks[4].s_mm)];
        assert_eq!(ways[&3].pieces, pieces, "{ways:?}");
        assert_eq!(ways.len(), 1, "{ways:?}");
        assert!(burnt(ticks, 1).is_empty());
    }

    #[test]
    fn a_gate_that_is_shut_leaves_a_gap_and_what_is_gone_over_again_does_not() {
        // Shut at 0.5 mm, back to 0.3 mm, and open again from 0.4 mm on.
        let places = [
            (0.0, true),
            (0.3, true),
            (0.5, true),
            (0.6, false),
            (0.3, false),
            (0.4, true),
            (0.9, true),
        ];
        let ticks = (0..).zip(places).map(|(k, (s, beam))| tick(k, s, beam));
        assert_eq!(gaps((0.0, 1.0), &burnt(ticks, 0)[&3].pieces), [(0.9, 1.0)]);
    }

    /// As a pin with gratings that are noisy, or a beam that goes over a hatch again and again.
    #[test]
    fn ways_to_and_fro_are_few_pieces_and_cover_the_same() {
        let mut ways = Ways::default();
        // 100 places apart from each other, each gone over thousands of times in no order.
        for k in 0..500_000_u64 {
            let place = k * 7919 % 100;
            let from = place as f64 + 0.3 * (k % 13) as f64 / 13.0;
            ways.add(from, from - 0.1);
            assert!(ways.pieces.len() <= 1200, "{}", ways.pieces.len());
        }
        ways.merge();
        assert_eq!(ways.pieces.len(), 100);
        let covered: f64 = ways.pieces.iter().map(|(from, to)| to - from).sum();
        assert!(
            (covered - 100.0 * (0.1 + 0.3 * 12.0 / 13.0)).abs() < 1e-9,
            "{covered}"
        );
    }
}
