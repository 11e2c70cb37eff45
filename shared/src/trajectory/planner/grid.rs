//! Where nodes stand: dense where limits change, far apart where they do not.

use super::breaks::Break;
use super::limits::{Bounds, PATH_ROW, ROWS};
use super::node::{Lanes, Node, Nodes, Side};
use super::track::{Track, position_norm};
use crate::io::AXES;
use crate::kinematics::{AxisMotion, Kinematics};
use crate::trajectory::reference::at_unit_speed;
use crate::trajectory::{PathSpace, ReferenceError, Unreachable};

/// Places nearer than this are one \[mm\].
pub(super) const SAME: f64 = 1e-9;
/// Time between nodes on curves \[s\].
const CURVE_STEP: f64 = 0.004;
/// Largest turn of the path between two nodes \[rad\].
const TURN_STEP: f64 = 0.12;
/// Time between nodes next to a change of limits, at the speed at which it can be passed \[s\].
const BREAK_STEP: f64 = 0.003;
/// Growth of the intervals away from where limits change, and the shrinking towards it.
const GROWTH: f64 = 0.4;
const SHRINK: f64 = 0.286;
/// Nodes are no nearer than this where only what nothing feels is between them \[s\].
const MERGE: f64 = 0.0005;
/// Longest time between nodes at the programmed feed \[s\]: where the machine can stop.
const LONGEST: f64 = 0.03;
/// How far the limits inside an interval may be off a straight line, as a share of the acceleration.
const STRAIGHT: f64 = 0.06;
/// Samples are taken this share of an interval inside its ends, because limits jump there.
const INSET: f64 = 1e-4;
/// Acceleration by a bend that is none, as a share of the limit.
const NO_BEND: f32 = 1e-6;
/// Most times that an interval is halved to follow the limits.
const HALVINGS: u32 = 6;
/// Work to append a node, and for each sample.
const EXTEND: u32 = 20;
const SAMPLE: u32 = 11;
const SAMPLE_OF_TOOL: u32 = 20;
/// Junctions looked at for a unit of work.
const LOOKS_FOR_ONE: u32 = 2;

/// What the path asks of the rows at one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Derivatives of the rows over s.
    pub first: Lanes,
    second: Lanes,
    /// ṡ² of the feed, and the highest one for all other reasons.
    feed: f64,
    pub limit: f64,
    /// Curvature \[1/mm\].
    pub bend: f64,
}

/// Where the grid has got to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    /// +1 on along the path, −1 back.
    direction: f64,
    /// Path length of the newest node.
    s: f64,
    /// Path length of the last change of limits.
    since: f64,
    /// Speed at which that can be passed \[mm/s\].
    since_speed: f64,
    hint: u32,
    /// Axes at the newest node.
    near: [f64; AXES],
    /// What the path asks for just before the newest node, if limits do not change there.
    before: Option<Sample>,
    /// The next change of limits from there, if it is known.
    next: Option<Break>,
}

/// What the grid is made of.
pub(super) struct Ground<'a, const E: usize> {
    pub track: &'a Track<E>,
    pub space: PathSpace,
    pub kinematics: &'a Kinematics,
    pub bounds: &'a Bounds,
}

impl<const E: usize> Ground<'_, E> {
    fn sample(
        &self,
        s: f64,
        direction: f64,
        hint: &mut u32,
        near: &[f64; AXES],
    ) -> Result<(Sample, AxisMotion), Unreachable> {
        let nowhere = |line| move |source| Unreachable { line, s, source };
        let empty = ReferenceError::EmptyPath;
        let piece = self.track.find(s, hint).ok_or(empty).map_err(nowhere(0))?;
        let (feed, line) = (piece.element.feed, piece.element.line);
        let point = self.track.at(s, hint).ok_or(empty).map_err(nowhere(line))?;
        let axes = at_unit_speed(self.kinematics, &point, self.space, near).map_err(nowhere(line))?;
        let mut sample = Sample {
            first: [0.0; ROWS],
            second: [0.0; ROWS],
            feed: feed * feed,
            limit: f64::INFINITY,
            bend: position_norm(&point.second),
        };
        sample.first[PATH_ROW] = 1.0;
        for axis in 0..AXES {
            let rate = axes.velocity[axis];
            sample.first[PATH_ROW + 1 + axis] = (direction * rate) as f32;
            sample.second[PATH_ROW + 1 + axis] = axes.acceleration[axis] as f32;
            let speed = self.bounds.velocity[axis] / rate;
            sample.limit = libm::fmin(sample.limit, speed * speed);
        }
        self.keep_accurate(&mut sample, &point, s, *hint);
        Ok((sample, axes))
    }

    /// Path length where what is settled ends.
    pub fn end(&self, direction: f64) -> f64 {
        if direction > 0.0 {
            self.track.settled_s()
        } else {
            self.track.kept_s()
        }
    }
}

impl Sample {
    /// No row feels a bend at the feed.
    fn is_straight(&self, bounds: &Bounds) -> bool {
        let x = self.feed as f32;
        (0..ROWS).all(|row| self.second[row].abs() * x <= NO_BEND * bounds.acceleration[row])
    }
}

impl Grid {
    pub const NONE: Self = Self {
        direction: 1.0,
        s: 0.0,
        since: 0.0,
        since_speed: 0.0,
        hint: 0,
        near: [0.0; AXES],
        before: None,
        next: None,
    };

    /// The first node, at rest at `s` with the axes at `axes`.
    pub fn start<const N: usize>(&mut self, s: f64, axes: &[f64; AXES], nodes: &mut Nodes<N>) {
        *self = Self {
            s,
            since: s,
            near: *axes,
            ..Self::NONE
        };
        nodes.clear();
        nodes.push(Node { s, ..Node::ZERO });
    }

    /// +1 if nodes lead on along the path, −1 if back.
    pub fn direction(&self) -> f64 {
        self.direction
    }

    /// Leads in a `direction` from node `serial` on, where the machine stands with its axes at `axes`.
    pub fn again<const N: usize>(
        &mut self,
        serial: u32,
        direction: f64,
        axes: &[f64; AXES],
        nodes: &mut Nodes<N>,
    ) {
        nodes.cut(serial);
        let node = nodes.at_mut(serial);
        node.limit = 0.0;
        *self = Self {
            direction,
            s: node.s,
            since: node.s,
            near: *axes,
            hint: self.hint,
            ..Self::NONE
        };
    }

    /// Appends an interval, if the path is settled far enough; says how much work that was. The plan in force ends
    /// at node `in_force`.
    pub fn extend<const E: usize, const N: usize>(
        &mut self,
        ground: &Ground<E>,
        nodes: &mut Nodes<N>,
        in_force: u32,
    ) -> Result<u32, Unreachable> {
        let bounds = ground.bounds;
        let direction = self.direction;
        if nodes.room() == 0 || direction * (ground.end(direction) - self.s) <= SAME {
            return Ok(0);
        }
        let (start, near) = (self.s, self.near);
        let Some(piece) = ground.track.find(start + direction * SAME, &mut self.hint) else {
            return Ok(0);
        };
        let (feed, line) = (piece.element.feed, piece.straight);
        let gap = MERGE * feed;
        let next = match self.next.take() {
            Some(next) => next,
            None => ground.next_break(start, direction, self.hint),
        };
        if next.end && !next.real && next.way < gap {
            return Ok(0);
        }
        let mut hint = self.hint;
        let mut sample = |way: f64| ground.sample(start + direction * way, direction, &mut hint, &near);
        let mut samples = 2;
        let mut from = match self.before {
            Some(sample) => sample,
            None => {
                samples += 1;
                sample(INSET * libm::fmin(next.way, feed * CURVE_STEP))?.0
            }
        };
        let rests = in_force + 1 == nodes.end;
        let mut delta = step(&next, self, rests, &from, feed, bounds);
        let mut to = sample(delta * (1.0 - INSET))?;
        let mut halvings = 0;
        let mid = loop {
            if line
                && [&from, &to.0]
                    .into_iter()
                    .all(|sample| sample.is_straight(bounds))
            {
                samples -= 1;
                break to.0;
            }
            let mid = sample(0.5 * delta)?;
            let short = next.merged && delta <= gap;
            if halvings == HALVINGS || short || straight(&from, &mid.0, &to.0, bounds) {
                break mid.0;
            }
            halvings += 1;
            delta *= 0.5;
            to = mid;
        };
        let (mut to, axes) = to;
        let before = to;
        let at_break = next.way - delta < SAME;
        let delta = if at_break { next.way } else { delta };
        let end = start + direction * delta;
        cover(&mut from, &mid, &mut to);
        let least = |value: fn(&Sample) -> f64| libm::fmin(libm::fmin(value(&from), value(&to)), value(&mid));
        let (feed_cap, limit) = (least(|sample| sample.feed), least(|sample| sample.limit));
        let newest = nodes.end - 1;
        let node = nodes.at_mut(newest);
        node.feed = libm::fmin(node.feed, feed_cap);
        node.limit = libm::fmin(node.limit, limit);
        node.delta = delta;
        node.direction = direction;
        node.sides = [side(&from, 0.0, bounds), side(&to, delta, bounds)];
        nodes.push(Node {
            s: end,
            feed: feed_cap,
            limit: if at_break && next.stop { 0.0 } else { limit },
            ..Node::ZERO
        });
        if at_break && next.real {
            self.since = end;
            self.since_speed = next.speed;
        }
        self.before = (!at_break).then_some(before);
        self.next = (next.real && !next.end && !at_break).then_some(Break {
            way: next.way - delta,
            looks: 0,
            ..next
        });
        self.s = end;
        self.near = axes.position;
        Ok(EXTEND + next.looks / LOOKS_FOR_ONE + (samples + halvings) * sampling(ground.space))
    }
}

/// Work of an interval, as most are.
pub(super) fn usual_work(space: PathSpace) -> u32 {
    EXTEND + 3 * sampling(space)
}

fn sampling(space: PathSpace) -> u32 {
    match space {
        PathSpace::Axes => SAMPLE,
        PathSpace::Tool => SAMPLE_OF_TOOL,
    }
}

/// Length of the next interval \[mm\], on the way to the next change of limits.
fn step(next: &Break, grid: &Grid, rests: bool, from: &Sample, feed: f64, bounds: &Bounds) -> f64 {
    let (way, gone) = (next.way, libm::fabs(grid.s - grid.since));
    // From rest, the way of a part of the filter's length.
    let mut acceleration = f32::INFINITY;
    for row in 0..ROWS {
        acceleration = acceleration.min(bounds.acceleration[row] / from.first[row].abs());
    }
    let finest = 0.09 * f64::from(acceleration) * bounds.filter * bounds.filter;
    let at = |speed: f64| libm::fmax(finest, BREAK_STEP * speed);
    let mut delta = libm::fmin(at(grid.since_speed) + GROWTH * gone, LONGEST * feed);
    if next.real {
        delta = libm::fmin(delta, libm::fmax(at(next.speed), SHRINK * way));
    }
    if from.bend * way > 1e-4 {
        let speed = libm::fmin(feed, libm::sqrt(bounds.corner / from.bend));
        delta = libm::fmin(delta, libm::fmin(CURVE_STEP * speed, TURN_STEP / from.bend));
    }
    // At least two intervals from one change to the next, or from where the machine may rest, and no sliver before
    // the next one.
    if gone <= 0.0 || rests {
        delta = libm::fmin(delta, 0.5 * way);
    }
    if delta > 0.6 * way {
        delta = if delta < way { 0.5 * way } else { way };
    }
    delta
}

/// Whether the limits between the ends of an interval are as a straight line would have them.
fn straight(from: &Sample, mid: &Sample, to: &Sample, bounds: &Bounds) -> bool {
    let mut x = f32::INFINITY;
    for sample in [from, mid, to] {
        x = x.min(libm::fmin(sample.feed, sample.limit) as f32);
    }
    for row in 0..ROWS {
        let most = from.second[row]
            .abs()
            .max(to.second[row].abs())
            .max(mid.second[row].abs());
        if most * x > bounds.acceleration[row] {
            x = bounds.acceleration[row] / most;
        }
    }
    (0..ROWS).all(|row| {
        let off = mid.second[row] - 0.5 * (from.second[row] + to.second[row]);
        off.abs() * x <= STRAIGHT as f32 * bounds.acceleration[row]
    })
}

/// Widens the ends to what lies between them: the highest at the start, the lowest at the end.
fn cover(from: &mut Sample, mid: &Sample, to: &mut Sample) {
    for row in 0..ROWS {
        let (a, b, m) = (from.second[row], to.second[row], mid.second[row]);
        let (low, high) = (a.min(b), a.max(b));
        if m > high + 0.05 * high.abs() || m < low - 0.05 * low.abs() {
            from.second[row] = high.max(m);
            to.second[row] = low.min(m);
        }
    }
}

/// The limits at one end of an interval; `delta` is 0 at its start, its length at its end, where ṡ² is x + 2Δa.
fn side(sample: &Sample, delta: f64, bounds: &Bounds) -> Side {
    let mut side = Side::ZERO;
    for row in 0..ROWS {
        let alpha = sample.first[row] + 2.0 * delta as f32 * sample.second[row];
        side.set_rates(row, alpha, sample.second[row]);
    }
    side.open(bounds);
    side
}
