//! The true speed of the tip.

use crate::WorkTick;
use host_link::spool::Spool;
use nalgebra::Vector3;
use shared::ticks::PATH_PERIOD_S;
use std::collections::VecDeque;

/// The true speed is that of the way over so many ticks before and after, 8 ms in all: a grating of 0.1 µm then makes
/// less than 0.02 mm/s of noise.
const HALF: usize = 4;
/// Slow processes are looked at over at least so much before and after \[mm\]: what is shorter does not show in a seam,
/// and a drive that sticks for a micrometre is no change of speed.
pub(crate) const HALF_MM: f64 = 0.05;
/// But over no more ticks than these, a minute, at a feed below 0.05 mm/min: so many are in memory.
const MOST_HALF: usize = 60_000;

/// Gives each tick the true speed, from where the tips were before and after it on the same path.
#[derive(Default)]
pub(super) struct TrueSpeeds {
    /// Of this path, from where the first tick that waits looks back to.
    ways: VecDeque<Way>,
    /// The last of them, whose speed is not known before the tip has gone on.
    waiting: VecDeque<WorkTick>,
    /// Where the tip was last, and its way there \[mm\].
    tip: Option<Vector3<f64>>,
    way_mm: f64,
}

/// How far the tip had come at a tick.
struct Way {
    tick: u32,
    mm: f64,
}

impl TrueSpeeds {
    /// Takes the next tick with its `tip`, and puts those into `done` whose speed is known by it.
    pub(super) fn push(&mut self, tick: WorkTick, tip: Vector3<f64>, done: &mut Spool<WorkTick>) {
        if self
            .waiting
            .back()
            .is_some_and(|last| last.path_id != tick.path_id)
        {
            self.end_path(done);
        }
        if let Some(before) = self.tip.replace(tip) {
            self.way_mm += (tip - before).norm();
        }
        self.ways.push_back(Way {
            tick: tick.tick,
            mm: self.way_mm,
        });
        self.waiting.push_back(tick);
        while self.ways.len() > self.first() + half(&self.waiting[0]) {
            self.give(done);
        }
    }

    /// Nothing comes any more on this path.
    pub(super) fn end_path(&mut self, done: &mut Spool<WorkTick>) {
        while !self.waiting.is_empty() {
            self.give(done);
        }
        self.ways.clear();
    }

    /// Place of the first tick that waits among the ways.
    fn first(&self) -> usize {
        self.ways.len() - self.waiting.len()
    }

    /// Gives its speed to the first tick that waits.
    fn give(&mut self, done: &mut Spool<WorkTick>) {
        let here = self.first();
        let Some(mut tick) = self.waiting.pop_front() else {
            return;
        };
        let half = half(&tick);
        let from = &self.ways[here.saturating_sub(half)];
        let to = &self.ways[(here + half).min(self.ways.len() - 1)];
        let time = f64::from(to.tick.wrapping_sub(from.tick)) * PATH_PERIOD_S;
        tick.true_speed_mm_s = (time > 0.0).then_some((to.mm - from.mm) / time);
        done.push(tick);
        if here == MOST_HALF {
            self.ways.pop_front();
        }
    }
}

/// Ticks before and after one that its speed is told from.
fn half(tick: &WorkTick) -> usize {
    let slow = HALF_MM / (tick.feed_mm_s * PATH_PERIOD_S);
    let half = if slow.is_finite() { slow.ceil() as usize } else { 0 };
    half.clamp(HALF, MOST_HALF)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::io::{MOTORS, SLIDES};

    fn tick(tick: u32, path_id: u32, feed_mm_s: f64) -> WorkTick {
        WorkTick {
            tick,
            path_id,
            s_mm: 0.0,
            along_mm: 0.0,
            speed_mm_s: feed_mm_s,
            feed_mm_s,
            true_speed_mm_s: None,
            beams: [true; 2],
            slides_mm: None,
            deviation_mm: [None; SLIDES],
            contour_error_mm: None,
            following_error: [0.0; MOTORS],
        }
    }

    fn speeds(ticks: &[(WorkTick, Vector3<f64>)]) -> Spool<WorkTick> {
        let (mut speeds, mut done) = (TrueSpeeds::default(), Spool::default());
        for (tick, tip) in ticks {
            speeds.push(*tick, *tip, &mut done);
            assert!(speeds.ways.len() <= 2 * MOST_HALF + 1);
        }
        speeds.end_path(&mut done);
        done
    }

    /// By all ticks at once.
    fn expected(ticks: &[(WorkTick, Vector3<f64>)]) -> Vec<Option<f64>> {
        let mut way = vec![0.0];
        for pair in ticks.windows(2) {
            way.push(way[way.len() - 1] + (pair[1].1 - pair[0].1).norm());
        }
        let mut speeds = Vec::new();
        for path in ticks.chunk_by(|a, b| a.0.path_id == b.0.path_id) {
            let first = speeds.len();
            for (i, (tick, _)) in path.iter().enumerate() {
                let half = HALF.max((HALF_MM / (tick.feed_mm_s * PATH_PERIOD_S)).ceil() as usize);
                let (from, to) = (i.saturating_sub(half), (i + half).min(path.len() - 1));
                let time = f64::from(path[to].0.tick - path[from].0.tick) * PATH_PERIOD_S;
                speeds.push((time > 0.0).then(|| (way[first + to] - way[first + from]) / time));
            }
        }
        speeds
    }

    #[test]
    fn speeds_are_told_from_both_sides_within_a_path_whatever_the_feeds() {
        let mut ticks = Vec::new();
        let mut place = 0.0;
        // Paths of one tick, of fewer than the look, and of many; the feed changes within them; a gap of telemetry.
        for (path, length) in [(1, 1), (2, 5), (4, 3000), (5, 2), (6, 900)] {
            for k in 0..length {
                let feed = [100.0, 2.0, 0.2, 20.0][k / 37 % 4];
                let number = ticks.len() as u32 + if ticks.len() > 2000 { 40 } else { 0 };
                place += 1e-3 * feed * (1.0 + 0.1 * f64::from(number).sin());
                ticks.push((
                    tick(number, path, feed),
                    Vector3::new(place, 0.3 * place.sin(), 0.0),
                ));
            }
        }
        let told: Vec<Option<f64>> = speeds(&ticks).iter().map(|tick| tick.true_speed_mm_s).collect();
        assert_eq!(told[0], None, "one tick has no speed");
        assert!(told[1..].iter().all(Option::is_some));
        assert!(told == expected(&ticks), "to the bit");
    }

    #[test]
    fn at_a_feed_that_never_gets_anywhere_memory_is_bounded() {
        let ticks: Vec<_> = (0..200_000)
            .map(|k| (tick(k, 1, 1e-9), Vector3::x() * 1e-12 * f64::from(k)))
            .collect();
        let done = speeds(&ticks);
        assert_eq!(done.len(), 200_000);
        assert!(
            done.iter()
                .all(|tick| (tick.true_speed_mm_s.unwrap() - 1e-9).abs() < 1e-12)
        );
    }
}
