//! Paths with arcs: every block is followed exactly, straight or round.
//!
//! At a join the tip goes on in the same direction, or the path ends there. The rotary axes may begin to turn
//! at once, though, as where an arc follows a line; they cannot, so their rates, and the last hundredths of a
//! degree between two directions, go over from one to the other within a short length around the join, at the
//! acceleration that the axes have.

use super::limits::{CURVATURE_SHARE, DRIVES};
use super::shape::{Goal, SHORTEST, Shape, channels};
use super::targets::{ROTARY, arc};
use super::{PathError, Planner, Tip};
use crate::nc::{Target, Way};
use nalgebra::Vector3;
use shared::geometry::{Arc, Moving, Pose, angle, interpolate};
use shared::io::{AXES, SIDES};
use shared::motion::PATH_PERIOD_S;
use shared::protocol::Knot;
use shared::trajectory::{CHANNELS, PathPoint};

/// Largest change of direction that is gone over without a stop \[rad\], half a degree. The tip then leaves the
/// corner by about a thousandth of the length of the change: nanometres at the feeds of arc and friction
/// stir welding, less than a micrometre at those of a laser. Programs rounded to 0.001 mm stay far below, on arcs
/// above a millimetre; a corner that is meant is far above.
const MAX_TURN: f64 = 0.5 / 180.0 * std::f64::consts::PI;
/// A cubic span may be off an arc by this much: in position \[mm\] and direction.
const MAX_ERROR: [f64; 2] = [1e-5, 1e-6];
/// Path ticks that a change of rates takes at least.
const LEAST_TICKS: f64 = 4.0;
/// Slopes that differ by less need no change: the digits of the differences that they come from.
const NO_STEP: f64 = 1e-11;
/// Step of differences \[rad\].
const DIFFERENCE: f64 = 1e-3;

/// Consecutive blocks without a stop between.
pub(super) struct Piece {
    pub(super) shape: Shape,
    /// Index of the first target.
    pub(super) first: usize,
    /// Change of direction where it begins, if that is why it does \[rad\].
    pub(super) corner: Option<f64>,
}

/// The motion of one block over its length.
struct Block {
    way: BlockWay,
    attitude: Attitude,
    extension: [[f64; SIDES]; 2],
    length: f64,
    /// Sum of the rates at which rotary axes turn \[rad/mm\].
    turning: f64,
    line: u32,
}

enum BlockWay {
    Straight(Vector3<f64>, Vector3<f64>),
    Round(Arc),
}

enum Attitude {
    /// About one axis, by the smaller angle.
    Geodesic(Pose, Pose),
    /// Each rotary axis evenly \[deg\].
    Axes([f64; 3], [f64; 3]),
}

/// Values and slopes of all channels.
struct Jet {
    value: [f64; CHANNELS],
    slope: [f64; CHANNELS],
}

/// Where slopes change from one block to the next, over `half` on both sides.
struct Join {
    s: f64,
    half: f64,
    step: [f64; CHANNELS],
    /// By how much the rotary axes are off at `s`, for that \[rad\].
    slack: f64,
}

impl Planner {
    /// The pieces of a path from `from` through `tips`, the places of `targets`; `speeds` are those on the way to
    /// each of them \[mm/s\].
    pub(super) fn exact(
        &self,
        from: &Tip,
        tips: &[Tip],
        targets: &[Target],
        speeds: &[f64],
    ) -> Result<Vec<Piece>, PathError> {
        let starts = std::iter::once(from).chain(tips);
        let blocks: Vec<Block> = starts
            .zip(tips)
            .zip(targets)
            .map(|((from, to), target)| self.block(from, to, target))
            .collect::<Result<_, _>>()?;
        let corners: Vec<f64> = blocks
            .windows(2)
            .map(|pair| angle(&pair[0].direction(pair[0].length), &pair[1].direction(0.0)))
            .collect();
        let mut pieces = Vec::new();
        let mut first = 0;
        for end in 1..=blocks.len() {
            if end < blocks.len() && corners[end - 1] <= MAX_TURN {
                continue;
            }
            pieces.push(Piece {
                shape: self.curve(&blocks[first..end], &tips[first..end], &speeds[first..end]),
                first,
                corner: first.checked_sub(1).map(|before| corners[before]),
            });
            first = end;
        }
        Ok(pieces)
    }

    fn block(&self, from: &Tip, to: &Tip, target: &Target) -> Result<Block, PathError> {
        let line = target.line;
        let [start, end] = [self.pose(from), self.pose(to)];
        let (way, attitude, length, turn) = match target.way {
            Way::Arc(turn, form) => {
                let arc = arc(from, to, turn, form, line)?;
                let angles = Attitude::Axes(from.angles_deg, to.angles_deg);
                let turned = (0..3).map(|i| (to.angles_deg[i] - from.angles_deg[i]).abs().to_radians());
                (BlockWay::Round(arc), angles, arc.length(), turned.sum())
            }
            Way::Line | Way::Axes => {
                interpolate(&start, &end, 0.5).map_err(|source| PathError::Attitude { line, source })?;
                // Not the angle of the turn, but not smaller.
                let turn = angle(&start.tangent, &end.tangent) + angle(&start.normal, &end.normal);
                let (p, q) = (start.position, end.position);
                let way = BlockWay::Straight(p, q);
                (way, Attitude::Geodesic(start, end), (q - p).norm(), turn)
            }
        };
        if length < SHORTEST {
            return Err(PathError::NoTravel { line });
        }
        Ok(Block {
            way,
            attitude,
            extension: [from.extension_mm, to.extension_mm],
            length,
            turning: turn / length,
            line,
        })
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
            let mut goal = Goal::exact(s, block.line);
            if let Some(next) = blocks.get(i + 1) {
                let slowest = speeds[i].min(speeds[i + 1]);
                let join = self.join(s, block, next, &tips[i], slowest);
                goal.slack = join.slack;
                joins.push(join);
            }
            ends.push(goal);
            // Joins at both ends of the block; the first block has none at its start.
            let near = &joins[i.saturating_sub(1)..];
            for at in block.places(start, near, i == 0) {
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
        let speed_error = knots.iter().map(|knot| (norm(&knot.slope) - 1.0).abs());
        Shape {
            speed_error: speed_error.fold(0.0, f64::max),
            knots,
            targets: ends,
        }
    }

    /// The change from one block to the next at `s`, where the tip is `tip` and the speed at most `speed`.
    fn join(&self, s: f64, before: &Block, after: &Block, tip: &Tip, speed: f64) -> Join {
        let (a, b) = (before.jet(self, before.length), after.jet(self, 0.0));
        let step = std::array::from_fn(|c| b.slope[c] - a.slope[c]);
        let mut join = Join {
            s,
            half: 0.0,
            step,
            slack: 0.0,
        };
        if step.iter().all(|step: &f64| step.abs() < NO_STEP) {
            return join;
        }
        let longest = before.length.min(after.length) / 2.0;
        join.half = LEAST_TICKS / 2.0 * PATH_PERIOD_S * speed;
        // What the machine cannot do there is found when the whole path is followed.
        let rates = self.drive_rates(&a, tip).zip(self.drive_rates(&b, tip));
        let change = rates.map(|(from, to)| std::array::from_fn::<_, DRIVES, _>(|i| (to[i] - from[i]).abs()));
        for (change, limits) in change.iter().flatten().zip(&self.drives) {
            let needed = change * speed * speed / (2.0 * CURVATURE_SHARE * limits.acceleration);
            join.half = join.half.max(needed);
        }
        join.half = join.half.min(longest);
        if let Some(change) = change {
            // A quarter of it at the join; a little more, as rates are not quite the same all along.
            let largest = change[ROTARY].iter().fold(0.0, |a: f64, b| a.max(*b));
            join.slack = largest * join.half / 2.0;
        }
        join
    }

    /// Derivatives of all drives over s.
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

impl Block {
    fn position(&self, u: f64) -> Moving {
        match &self.way {
            BlockWay::Straight(start, end) => Moving {
                value: start + (end - start) * (u / self.length),
                first: (end - start) / self.length,
                second: Vector3::zeros(),
            },
            BlockWay::Round(arc) => arc.at(u),
        }
    }

    fn direction(&self, u: f64) -> Vector3<f64> {
        self.position(u).first
    }

    /// Pose and extensions as channels, a length `u` from the start.
    fn channels(&self, planner: &Planner, u: f64) -> [f64; CHANNELS] {
        let part = u / self.length;
        let attitude = match &self.attitude {
            // Whether there is a shortest way was asked when the block was made.
            Attitude::Geodesic(start, end) => interpolate(start, end, part).unwrap_or(*start),
            Attitude::Axes(start, end) => planner.pose(&Tip {
                angles_deg: std::array::from_fn(|i| start[i] + (end[i] - start[i]) * part),
                ..Tip::default()
            }),
        };
        let [from, to] = &self.extension;
        let extension = std::array::from_fn(|k| from[k] + (to[k] - from[k]) * part);
        let position = self.position(u).value;
        channels(&Pose { position, ..attitude }, &extension)
    }

    fn jet(&self, planner: &Planner, u: f64) -> Jet {
        let mut slope = [0.0; CHANNELS];
        if self.turning > 0.0 {
            // Five points: exact to the last digits for turns this small.
            let h = DIFFERENCE / self.turning;
            let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| self.channels(planner, u + k * h));
            slope = std::array::from_fn(|i| (a[i] - d[i] + 8.0 * (c[i] - b[i])) / (12.0 * h));
        }
        slope[..3].copy_from_slice(self.direction(u).as_slice());
        for k in 0..SIDES {
            slope[CHANNELS - SIDES + k] = (self.extension[1][k] - self.extension[0][k]) / self.length;
        }
        Jet {
            value: self.channels(planner, u),
            slope,
        }
    }

    /// Where knots stand on this block, which begins at `start`: at its end, where changes begin and end, and in
    /// between so near that cubic spans are exact; also at its start if it is the first one.
    fn places(&self, start: f64, joins: &[Join], first: bool) -> Vec<f64> {
        let end = start + self.length;
        let mut fixed: Vec<f64> = joins.iter().flat_map(|j| [j.s - j.half, j.s + j.half]).collect();
        fixed.retain(|s| *s > start && *s < end);
        fixed.extend([start, end]);
        fixed.sort_by(f64::total_cmp);
        fixed.dedup_by(|a, b| *a - *b < 1e-9 * self.length);
        let mut places = Vec::new();
        for pair in fixed.windows(2) {
            let count = ((pair[1] - pair[0]) / self.spacing()).ceil().max(1.0) as usize;
            places.extend((1..=count).map(|i| pair[0] + (pair[1] - pair[0]) * i as f64 / count as f64));
        }
        // The end, to the bit.
        if let Some(last) = places.last_mut() {
            *last = end;
        }
        if first {
            places.insert(0, start);
        }
        places
    }

    /// Distance of knots: a cubic span of length h is off by h⁴/384 times the fourth derivative.
    fn spacing(&self) -> f64 {
        let fourth = match &self.way {
            BlockWay::Straight(..) => 0.0,
            BlockWay::Round(arc) => {
                let turn = arc.sweep() / arc.length();
                arc.radius() * turn * turn * turn * turn
            }
        };
        let turning = self.turning * self.turning;
        let spans = [MAX_ERROR[0] / fourth, MAX_ERROR[1] / (turning * turning)];
        libm::sqrt(libm::sqrt(384.0 * spans[0].min(spans[1])))
    }
}

impl Join {
    /// Adds the change to channels that bend sharply at the join: a parabola over both halves.
    fn add(&self, s: f64, jet: &mut Jet) {
        let off = s - self.s;
        if off.abs() >= self.half {
            return;
        }
        let y = off / self.half;
        let rest = 1.0 - y.abs();
        // At the join itself the slope is still that of the block before.
        let side = if y > 0.0 { -0.5 } else { 0.5 };
        for (c, step) in self.step.iter().enumerate() {
            jet.value[c] += step * self.half * rest * rest / 4.0;
            jet.slope[c] += step * side * rest;
        }
    }
}

fn norm(slope: &[f64; CHANNELS]) -> f64 {
    Vector3::new(slope[0], slope[1], slope[2]).norm()
}
