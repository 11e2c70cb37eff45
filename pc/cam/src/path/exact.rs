//! Single blocks, paths with arcs or NURBS, and those of G61: every block is followed exactly.
//!
//! At a join the tip continues in the same direction, or the path ends there. The rotary axes may begin to
//! turn at once, though, as where an arc follows a line; they cannot, so their rates, and the last hundredths
//! of a degree between two directions, go over from one to the other within a short length around the join,
//! at the acceleration that the axes have.

use super::block::{Block, Jet};
use super::feeds::Feeds;
use super::limits::{CURVATURE_SHARE, DRIVES};
use super::shape::{Goal, Shape};
use super::targets::ROTARY;
use super::{PathError, Planner, Tip};
use nalgebra::Vector3;
use nc::{Motion, Target};
use shared::geometry::angle;
use shared::io::{AXES, SIDES};
use shared::ticks::PATH_PERIOD_S;
use shared::trajectory::{CHANNELS, Knot, PathPoint, SHAPED};

/// Largest change of direction that is gone over without a stop \[rad\], half a degree. The tip then leaves the
/// corner by about a thousandth of the length of the change: nanometres at the feeds of arc and friction
/// stir welding, less than a micrometre at those of a laser. Programs rounded to 0.001 mm stay far below, on arcs
/// above a millimetre; a corner that is meant is far above.
pub(super) const MAX_TURN: f64 = 0.5 / 180.0 * std::f64::consts::PI;
/// Path ticks that a change of rates takes at least.
const LEAST_TICKS: f64 = 4.0;
/// Slopes that differ by less need no change: the digits of the differences that they come from.
const NO_STEP: f64 = 1e-11;

/// Consecutive blocks without a stop between.
pub(super) struct Piece {
    pub(super) shape: Shape,
    /// Index of the first target.
    pub(super) first: usize,
    /// Speed on the way to each target \[mm/s\], 0 for a rapid.
    pub(super) speeds: Vec<f64>,
    /// Change of direction where it begins, if that is why it does \[rad\].
    pub(super) corner: Option<f64>,
    /// The tip stands.
    pub(super) stands: bool,
}

/// Where slopes change from one block to the next, over `half` on both sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Join {
    s: f64,
    pub(super) half: f64,
    step: [f64; CHANNELS],
    /// At the join itself, the slope is that of the block after it.
    after: bool,
    /// By how much the rotary axes are off at `s`, for that \[rad\].
    pub(super) slack: f64,
}

impl Planner {
    /// The pieces of a path from `from` through `tips`, the places of `targets`, at `feeds`.
    pub(super) fn exact(
        &self,
        motion: Motion,
        from: &Tip,
        tips: &[Tip],
        targets: &[Target],
        feeds: &Feeds,
    ) -> Result<Vec<Piece>, PathError> {
        let starts = std::iter::once(from).chain(tips);
        let blocks: Vec<Block> = starts
            .zip(tips)
            .zip(targets)
            .map(|((from, to), target)| Block::build(self, motion, from, to, target))
            .collect::<Result<_, _>>()?;
        let speeds: Vec<f64> = blocks
            .iter()
            .zip(targets)
            .map(|(block, target)| feeds.speed(target, block.length))
            .collect::<Result<_, _>>()?;
        let corners: Vec<f64> = blocks
            .windows(2)
            .map(|pair| angle(&pair[0].direction(pair[0].length), &pair[1].direction(0.0)))
            .collect();
        let mut pieces = Vec::new();
        let mut first = 0;
        for end in 1..=blocks.len() {
            let goes_on = |end: usize| !blocks[end - 1].stands && !blocks[end].stands;
            if end < blocks.len() && corners[end - 1] <= MAX_TURN && goes_on(end) {
                continue;
            }
            pieces.push(Piece {
                shape: self.curve(&blocks[first..end], &tips[first..end], &speeds[first..end]),
                speeds: speeds[first..end].to_vec(),
                first,
                stands: blocks[first].stands,
                corner: first
                    .checked_sub(1)
                    .filter(|_| goes_on(first))
                    .map(|before| corners[before]),
            });
            first = end;
        }
        Ok(pieces)
    }

    /// Knots and targets of blocks that join smoothly.
    fn curve(&self, blocks: &[Block], tips: &[Tip], speeds: &[f64]) -> Shape {
        let mut ends = Vec::with_capacity(blocks.len());
        let mut joins: Vec<Join> = Vec::new();
        let mut knots = Vec::new();
        let mut s = 0.0;
        for (i, block) in blocks.iter().enumerate() {
            let start = s;
            s += block.length;
            let mut goal = Goal::exact(s, block.place);
            if let Some(next) = blocks.get(i + 1) {
                let slowest = speeds[i].min(speeds[i + 1]);
                let join = self.join(s, block, next, &tips[i], slowest);
                goal.slack = join.slack;
                joins.push(join);
            }
            ends.push(goal);
            // Joins at both ends of the block; the first block has none at its start.
            let near = &joins[i.saturating_sub(1)..];
            let changes: Vec<f64> = near.iter().flat_map(|j| [j.s - j.half, j.s + j.half]).collect();
            for at in block.places(start, &changes, i == 0) {
                let mut jet = block.jet(self, at - start);
                for join in near {
                    join.add(at, &mut jet);
                }
                knots.push(Knot {
                    s_mm: at,
                    value: jet.value,
                    slope: jet.slope,
                });
            }
        }
        let moves = blocks.iter().all(|block| !block.stands);
        let speed_error = knots.iter().filter(|_| moves);
        let speed_error = speed_error.map(|knot| (norm(&knot.slope) - 1.0).abs());
        Shape {
            speed_error: speed_error.fold(0.0, f64::max),
            knots,
            targets: ends,
        }
    }

    /// The change from one block to the next at `s`, where the tip is `tip` and the speed at most `speed`.
    pub(super) fn join(&self, s: f64, before: &Block, after: &Block, tip: &Tip, speed: f64) -> Join {
        let (a, b) = (before.jet(self, before.length), after.jet(self, 0.0));
        let step = std::array::from_fn(|c| b.slope[c] - a.slope[c]);
        let mut join = Join {
            s,
            half: 0.0,
            step,
            after: false,
            slack: 0.0,
        };
        if step.iter().all(|step: &f64| step.abs() < NO_STEP) {
            return join;
        }
        let longest = before.length.min(after.length) / 2.0;
        let rates = self.drive_rates(&a, tip).zip(self.drive_rates(&b, tip));
        let speed = rates
            .iter()
            .flat_map(|(a, b)| [a, b])
            .fold(speed, |speed, rates| self.at_most(rates, speed));
        join.half = LEAST_TICKS / 2.0 * PATH_PERIOD_S * speed;
        let change = rates.map(|(from, to)| std::array::from_fn(|i: usize| (to[i] - from[i]).abs()));
        join.half = join.half.max(self.change_length(&change, speed)).min(longest);
        if let Some(change) = change {
            // A quarter of it at the join; a little more, as rates are not quite the same all along.
            let largest = change[ROTARY].iter().fold(0.0, |a: f64, b| a.max(*b));
            join.slack = largest * join.half / 2.0;
        }
        join
    }

    /// `speed` \[mm/s\], or what the axes come to with these derivatives over s, if that is less.
    fn at_most(&self, rates: &[f64; DRIVES], speed: f64) -> f64 {
        let axes = self.drives.iter().zip(rates).take(AXES);
        axes.map(|(limits, rate)| limits.velocity / rate.abs())
            .fold(speed, f64::min)
    }

    /// `speed` \[mm/s\], or the highest that the axes come to on `block`, which leads to `tip`, if that is less. The
    /// planner of the motion board looks as densely as the feed is high.
    pub(super) fn reached_on(&self, block: &Block, tip: &Tip, speed: f64) -> f64 {
        // What the slowest linear axis comes to is not looked at closer.
        let linear = self.drives.iter().zip(self.fitted).take(ROTARY.start);
        let fitted = linear.filter(|(_, fitted)| *fitted);
        let slowest = fitted
            .map(|(limits, _)| limits.velocity)
            .fold(f64::INFINITY, f64::min);
        if speed <= slowest {
            return speed;
        }
        let rates = [0.0, 0.5, 1.0].map(|part| self.drive_rates(&block.jet(self, part * block.length), tip));
        let reached = rates.iter().flatten().map(|rates| self.at_most(rates, speed));
        speed.min(reached.fold(slowest, f64::max))
    }

    /// Half the length that such a change takes at `speed` \[mm/s\], with the share of acceleration for it.
    fn change_length(&self, change: &Option<[f64; DRIVES]>, speed: f64) -> f64 {
        let drives = change.iter().flatten().zip(&self.drives);
        let needed = drives
            .map(|(change, limits)| change * speed * speed / (2.0 * CURVATURE_SHARE * limits.acceleration));
        needed.fold(0.0, f64::max)
    }

    /// Derivatives of all drives over s. What the machine cannot do there is found when the whole path is followed.
    fn drive_rates(&self, jet: &Jet, tip: &Tip) -> Option<[f64; DRIVES]> {
        let point = PathPoint {
            value: jet.value,
            first: jet.slope,
            second: [0.0; CHANNELS],
        };
        let (pose, motion) = point.pose_in_motion().ok()?;
        let [a, b, c] = tip.angles_deg.map(f64::to_radians);
        let near = [0.0, 0.0, 0.0, a, b, c];
        let axes = self.kinematics.inverse_motion(&pose, &motion, &near).ok()?;
        let slides = &jet.slope[CHANNELS - SIDES..];
        Some(std::array::from_fn(|i| {
            axes.velocity.get(i).copied().unwrap_or_else(|| slides[i - AXES])
        }))
    }
}

impl Join {
    /// The same without a change of the tip's own direction.
    pub(super) fn of_attitude(mut self) -> Self {
        self.step[..SHAPED].fill(0.0);
        self
    }

    /// The same for the block after it, counted from there.
    pub(super) fn for_the_next(mut self) -> Self {
        (self.s, self.after) = (0.0, true);
        self
    }

    /// Adds the change to channels that bend sharply at the join: a parabola over both halves.
    pub(super) fn add(&self, s: f64, jet: &mut Jet) {
        let off = s - self.s;
        if off.abs() >= self.half {
            return;
        }
        let y = off / self.half;
        let rest = 1.0 - y.abs();
        let side = if y > 0.0 || (y == 0.0 && self.after) {
            -0.5
        } else {
            0.5
        };
        for (c, step) in self.step.iter().enumerate() {
            jet.value[c] += step * self.half * rest * rest / 4.0;
            jet.slope[c] += step * side * rest;
        }
    }
}

fn norm(slope: &[f64; CHANNELS]) -> f64 {
    Vector3::new(slope[0], slope[1], slope[2]).norm()
}
