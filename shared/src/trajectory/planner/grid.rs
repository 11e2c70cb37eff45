//! Where nodes stand: dense where limits change, far apart where they do not.

use super::breaks::{Break, MERGE, Search};
use super::channels::SAME;
use super::horizon::VISIT;
use super::limits::{Bounds, ROWS};
use super::node::{Lanes, Node, Nodes, Side, greater, highest, least, lesser, most};
use super::player::PlayerAccess;
use super::sample::{Ground, Sample};
use crate::io::AXES;
use crate::trajectory::{PathSpace, Unreachable};
use core::array::from_fn;

/// Time between nodes on curves \[s\].
const CURVE_STEP: f64 = 0.004;
/// Largest turn of the path between two nodes \[rad\].
const TURN_STEP: f64 = 0.12;
/// Time between nodes next to a change of limits, at the speed at which it can be passed \[s\].
const BREAK_STEP: f64 = 0.003;
/// Growth of the intervals away from where limits change, and the shrinking towards it.
const GROWTH: f64 = 0.4;
const SHRINK: f64 = 0.286;
/// The last interval before a change is no longer than this many times the way since the one before.
const MOST_OF_GONE: f64 = 1.5;
/// Longest time between nodes at the programmed feed \[s\]: where the machine can stop.
const LONGEST: f64 = 0.03;
/// How far the limits inside an interval may be off a straight line, as a share of the acceleration.
const STRAIGHT: f32 = 0.06;
/// Samples are taken this share of an interval inside its ends, because limits jump there.
const INSET: f64 = 1e-4;
/// Most times that an interval is halved to follow the limits.
const HALVINGS: u32 = 6;
/// Junctions looked at in one go.
const LOOKS: u32 = 6;

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
    /// What the path asks for at the newest node, if it is known.
    from: Option<Sample>,
    /// The next change of limits from there, if it is known.
    next: Option<Break>,
    /// How far the look for it has got.
    search: Option<Search>,
    /// The next interval, as far as it has been tried.
    trial: Option<Trial>,
}

/// An interval that may be too long.
#[derive(Clone, Copy, Debug)]
struct Trial {
    /// Its length \[mm\].
    delta: f64,
    /// How often it has been halved.
    halvings: u32,
    /// What the path asks for at its end, and the axes there, if that is known.
    to: Option<(Sample, [f64; AXES])>,
}

impl Grid {
    pub const NONE: Self = Self {
        direction: 1.0,
        s: 0.0,
        since: 0.0,
        since_speed: 0.0,
        hint: 0,
        near: [0.0; AXES],
        from: None,
        next: None,
        search: None,
        trial: None,
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

    /// Goes on to append an interval, if the path is settled far enough; says how much work that was: none where
    /// there is nothing to do. The plan in force ends at node `in_force`.
    ///
    /// Where the next change of limits is, what the path asks for after one, and an interval that is too long, are
    /// steps of their own.
    pub fn extend<P: PlayerAccess<E, N>, const E: usize, const N: usize>(
        &mut self,
        ground: &mut Ground<P, E, N>,
        nodes: &mut Nodes<N>,
        in_force: u32,
    ) -> Result<u32, Unreachable> {
        let (direction, bounds) = (self.direction, ground.bounds);
        if nodes.is_full() {
            return Ok(0);
        }
        let beyond = self.s + direction * SAME;
        let (end, piece) = ground.player.with(|player| {
            let end = player.track.end_in(direction);
            let piece = player.track.find(beyond, &mut self.hint);
            (
                end,
                piece.map(|piece| (piece.element.feed, piece.bend, piece.straight)),
            )
        });
        let settled = direction * (end - self.s);
        let (Some((feed, bend, is_line)), true) = (piece, settled > SAME) else {
            return Ok(0);
        };
        let mut work = 0;
        // More may be settled than when the end was looked for.
        if self
            .next
            .is_none_or(|next| next.end && next.way(self.s, direction) < settled - SAME)
        {
            self.look(ground);
            work = 2 * VISIT;
        }
        let Some(next) = self.next else {
            return Ok(work);
        };
        let way = next.way(self.s, direction);
        if next.end && !next.real && way < MERGE * feed {
            return Ok(0);
        }
        let Some(from) = self.from else {
            let inset = INSET * lesser(way, feed * CURVE_STEP);
            self.from = Some(self.sample(ground, inset, &mut self.hint.clone())?.0);
            return Ok(work + sampling(ground.space));
        };
        if work > 0 {
            return Ok(work);
        }
        let rests = in_force + 1 == nodes.end;
        let begun = self.trial.take();
        let Trial { delta, halvings, to } = begun.unwrap_or_else(|| Trial {
            delta: step(&next, self, rests, &from, feed, bounds),
            halvings: 0,
            to: None,
        });
        // Nothing changes along a line of axes between two changes of limits.
        let straight = from.is_straight(bounds);
        let known = straight && !next.merged && bend == 0.0 && ground.space == PathSpace::Axes;
        let inside = delta * (1.0 - INSET);
        let sampled = to.is_some();
        let mut hint = self.hint;
        let (to, near) = match to {
            Some(to) => to,
            None if known => {
                let s = self.s + direction * inside;
                (ground.farther(&from, s, self.hint), self.near)
            }
            None => self.sample(ground, inside, &mut hint)?,
        };
        let work = 2 * VISIT + if known { 0 } else { sampling(ground.space) };
        let straight = straight && is_line && to.is_straight(bounds);
        let mut halved = None;
        let mid = if straight {
            to
        } else if !next.merged {
            // What lies between is smooth.
            Sample::between(&from, &to)
        } else if sampled {
            let mid = self.sample(ground, 0.5 * delta, &mut hint)?;
            halved = Some(mid);
            mid.0
        } else {
            self.trial = Some(Trial {
                delta,
                halvings,
                to: Some((to, near)),
            });
            return Ok(work);
        };
        let quickest = most(
            mid.quickest(bounds),
            most(from.quickest(bounds), to.quickest(bounds)),
        );
        let feed_cap = lesser(
            lesser(mid.feed, next.feed * next.feed),
            lesser(from.feed, to.feed),
        );
        let limit = lesser(
            f64::from(1.0 / (quickest * quickest)),
            lesser(mid.limit, lesser(from.limit, to.limit)),
        );
        let short = next.merged && delta <= MERGE * feed;
        if !straight
            && !short
            && halvings < HALVINGS
            && !even(&[from, mid, to], lesser(feed_cap, limit) as f32, bounds)
        {
            self.trial = Some(Trial {
                delta: 0.5 * delta,
                halvings: halvings + 1,
                to: halved,
            });
            return Ok(work);
        }
        let at_break = way - delta < SAME;
        let (delta, end) = match at_break {
            true => (way, next.s),
            false => (delta, self.s + direction * delta),
        };
        let newest = nodes.end - 1;
        let node = nodes.at_mut(newest);
        node.feed = lesser(node.feed, feed_cap);
        node.limit = lesser(node.limit, limit);
        node.delta = delta;
        node.direction = direction;
        let seconds = cover(&from, &mid, &to);
        set(&mut node.sides[0], &from.first, &seconds[0], 0.0, bounds);
        set(&mut node.sides[1], &to.first, &seconds[1], delta, bounds);
        nodes.append(end, feed_cap, if at_break && next.stop { 0.0 } else { limit });
        if at_break && next.real {
            self.since = end;
            self.since_speed = next.speed;
        }
        self.from = (!at_break).then_some(to);
        self.next = (next.real && !next.end && !at_break).then_some(next);
        self.s = end;
        self.hint = hint;
        self.near = near;
        Ok(work)
    }

    /// Looks on for the next change of limits.
    fn look<P: PlayerAccess<E, N>, const E: usize, const N: usize>(&mut self, ground: &mut Ground<P, E, N>) {
        let begun = self.search.take();
        let (s, direction, hint, bounds) = (self.s, self.direction, self.hint, ground.bounds);
        let mut search = begun.unwrap_or_else(|| {
            ground
                .player
                .with(|player| player.track.search_breaks(s, direction, hint))
        });
        for _ in 0..LOOKS {
            self.next = ground
                .player
                .with(|player| player.track.look(&mut search, bounds));
            if self.next.is_some() {
                return;
            }
        }
        self.search = Some(search);
    }

    /// What the path asks for after a `way` from the newest node, and the axes there; `hint` is left at the serial of
    /// the element there.
    fn sample<P: PlayerAccess<E, N>, const E: usize, const N: usize>(
        &self,
        ground: &mut Ground<P, E, N>,
        way: f64,
        hint: &mut u32,
    ) -> Result<(Sample, [f64; AXES]), Unreachable> {
        let s = self.s + self.direction * way;
        ground.sample(s, self.direction, hint, &self.near)
    }
}

/// Work of a sample: through the kinematics as much as five visits to nodes.
fn sampling(space: PathSpace) -> u32 {
    match space {
        PathSpace::Axes => VISIT,
        PathSpace::Tool => 5 * VISIT,
    }
}

/// Length of the next interval \[mm\], on the way to the next change of limits.
fn step(next: &Break, grid: &Grid, rests: bool, from: &Sample, feed: f64, bounds: &Bounds) -> f64 {
    let way = next.way(grid.s, grid.direction);
    let gone = libm::fabs(grid.s - grid.since);
    // From rest, the way of a part of the filter's length.
    let rate = highest(from_fn(|row| {
        from.first[row].abs() * bounds.per_acceleration[row]
    }));
    let finest = 0.09 * bounds.filter * bounds.filter / f64::from(rate);
    let at = |speed: f64| greater(finest, BREAK_STEP * speed);
    let mut delta = lesser(at(grid.since_speed) + GROWTH * gone, LONGEST * feed);
    if next.real {
        delta = lesser(delta, greater(at(next.speed), SHRINK * way));
    }
    if from.bend * way > 1e-4 {
        let speed = lesser(feed, libm::sqrt(bounds.corner / from.bend));
        delta = lesser(delta, lesser(CURVE_STEP * speed, TURN_STEP / from.bend));
    }
    // At least two intervals from one change to the next, or from where the machine may rest, and no sliver before
    // the next one.
    if gone <= 0.0 || rests {
        delta = lesser(delta, 0.5 * way);
    }
    if delta > 0.6 * way {
        // Nor one from a change just passed: where it was slow, and is to be slow again, it would have to creep.
        let one = delta >= way && way <= MOST_OF_GONE * gone;
        delta = if one { way } else { 0.5 * way };
    }
    delta
}

/// Whether the limits between the ends of an interval, where ṡ² is at most `x`, are as a straight line would have them.
fn even([from, mid, to]: &[Sample; 3], x: f32, bounds: &Bounds) -> bool {
    let bent = most(
        mid.most_bent(bounds),
        most(from.most_bent(bounds), to.most_bent(bounds)),
    );
    let off = highest(from_fn(|row| {
        let off = mid.second[row] - 0.5 * (from.second[row] + to.second[row]);
        off.abs() * bounds.per_acceleration[row]
    }));
    off * least(x, 1.0 / bent) <= STRAIGHT
}

/// Second derivatives of the rows at both ends, widened to what lies between them: the highest at the start, the
/// lowest at the end.
fn cover(from: &Sample, mid: &Sample, to: &Sample) -> [Lanes; 2] {
    let (a, b, m) = (&from.second, &to.second, &mid.second);
    let high: Lanes = from_fn(|row| most(a[row], b[row]));
    let low: Lanes = from_fn(|row| least(a[row], b[row]));
    let above: Lanes = from_fn(|row| m[row] - high[row] - 0.05 * high[row].abs());
    let below: Lanes = from_fn(|row| low[row] - 0.05 * low[row].abs() - m[row]);
    let outside: [bool; ROWS] = from_fn(|row| most(above[row], below[row]) > 0.0);
    [
        from_fn(|row| {
            if outside[row] {
                most(high[row], m[row])
            } else {
                a[row]
            }
        }),
        from_fn(|row| {
            if outside[row] {
                least(low[row], m[row])
            } else {
                b[row]
            }
        }),
    ]
}

/// The limits at one end of an interval; `delta` is 0 at its start, its length at its end, where ṡ² is x + 2Δa.
fn set(side: &mut Side, first: &Lanes, second: &Lanes, delta: f64, bounds: &Bounds) {
    for row in 0..ROWS {
        side.set_rates(row, first[row] + 2.0 * delta as f32 * second[row], second[row]);
    }
    side.open(bounds);
}
