//! Where limits change along the path.

use super::channels::{SAME, SMOOTH};
use super::corner::SHARP;
use super::limits::Bounds;
use super::node::{greater, lesser};
use super::track::{Piece, Track};
use crate::trajectory::SHAPED;
use nalgebra::Vector3;

/// Most junctions that are looked at.
pub(super) const MOST_LOOKS: u32 = 16;
/// Nodes are no nearer than this where only what nothing feels is between them, and another feed for a shorter time is as good as
/// the lower one \[s\].
pub(super) const MERGE: f64 = 0.0005;

/// Where limits change next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Break {
    /// Path length there \[mm\], to the bit: a way that is counted down would be off by more than [`SAME`] after
    /// thousands of nodes, and the machine would have to stop twice there.
    pub s: f64,
    /// Limits change there; else nothing changes so far.
    pub real: bool,
    /// The machine stops there.
    pub stop: bool,
    /// It is the end of what is settled.
    pub end: bool,
    /// Changes that nothing feels were passed over on the way.
    pub merged: bool,
    /// Highest speed at which it can be passed \[mm/s\].
    pub speed: f64,
    /// Lowest feed on the way \[mm/s\].
    pub feed: f64,
}

/// A look along the path for the next change of limits, a few junctions at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search {
    s: f64,
    direction: f64,
    /// Serial of the element at `s`.
    hint: u32,
    /// Junctions looked at.
    seen: u32,
    /// Path length where the elements seen end \[mm\].
    seen_s: f64,
    door: DirectionRange,
    /// What is found if nothing comes before.
    next: Break,
}

impl Break {
    /// Way to there from `s` on in a `direction` \[mm\].
    pub fn way(&self, s: f64, direction: f64) -> f64 {
        direction * (self.s - s)
    }
}

impl<const E: usize> Track<E> {
    /// Begins to look for the next change of limits from `s` on in a `direction`; `hint` is the serial of the element
    /// there.
    pub fn search_breaks(&self, s: f64, direction: f64, hint: u32) -> Search {
        let end = self.end_in(direction);
        let stop = direction <= 0.0 || (self.closed() && end >= self.end_s() - SAME);
        Search {
            s,
            direction,
            hint,
            seen: 0,
            seen_s: s,
            door: DirectionRange::open(self.along(hint, s)),
            next: Break {
                s: end,
                real: stop,
                stop,
                end: true,
                merged: false,
                speed: 0.0,
                feed: f64::INFINITY,
            },
        }
    }

    /// Goes on with a `search`, over one junction and the element beyond; gives what is found.
    ///
    /// Junctions, corners and whole elements are passed over where the path is straight but for what nothing feels;
    /// so is the end of a corner inside which the search begins: intervals are halved until they follow it.
    pub fn look(&self, search: &mut Search, bounds: &Bounds) -> Option<Break> {
        let (hint, k, direction) = (search.hint, search.seen, search.direction);
        let way_to = |s: f64| direction * (s - search.s);
        let forward = direction > 0.0;
        let next = &mut search.next;
        if k == MOST_LOOKS {
            if way_to(search.seen_s) < way_to(next.s) {
                (next.s, next.real, next.stop, next.end) = (search.seen_s, false, false, false);
            }
            return Some(*next);
        }
        search.seen += 1;
        let beyond = if forward {
            self.get(hint + k)
        } else {
            hint.checked_sub(k).and_then(|serial| self.get(serial))
        };
        let Some(element) = beyond else {
            return Some(*next);
        };
        let (length, feed) = (element.element.length, element.element.feed);
        let (near_s, far_s, corner, far) = if forward {
            let far = self.junction(hint + k + 1);
            (element.start, element.end(), Some(element), far)
        } else {
            let corner = self.get(hint + 1 - k);
            (element.end(), element.start, corner, element.place)
        };
        let seen = way_to(far_s);
        let slower = lesser(feed, next.feed);
        let alike = feed == next.feed || k == 0 || seen <= MERGE * slower;
        search.seen_s = far_s;
        let smooth = corner.is_none_or(|piece| !piece.stop && piece.corner.others <= SMOOTH);
        let near = bounds.unfelt_way;
        let on =
            alike && smooth && element.bend * length <= 8.0 * near && search.door.passes(seen, far, near);
        if let Some(piece) = corner {
            let half = piece.corner.half;
            // A rounded corner bends evenly; a sharp one needs a place to turn the acceleration.
            let even = piece.even && smooth && half > 0.0 && piece.corner.turn < SHARP;
            for side in [-half, 0.0, half] {
                let at = near_s + direction * side;
                let way = way_to(at);
                // Where a corner ends with the next junction, that is the change.
                if (side == 0.0 && even) || way <= SAME || (side > 0.0 && way >= seen - SAME) {
                    continue;
                }
                if way > way_to(next.s) + SAME {
                    return Some(*next);
                }
                if !on {
                    let ends = way >= way_to(next.s) - SAME;
                    let stop = piece.stop && side == 0.0 || next.stop && ends;
                    return Some(change(piece, at, stop, *next, bounds));
                }
                next.merged = true;
            }
        }
        next.feed = slower;
        if !on {
            search.door.shut();
        }
        None
    }

    /// Path length where what is settled ends.
    pub fn end_in(&self, direction: f64) -> f64 {
        if direction > 0.0 {
            self.settled_s()
        } else {
            self.kept_s()
        }
    }
}

/// The change of limits at `s` in the corner where `piece` begins, and whether it is a stop; `end` is the one where all
/// ends.
fn change(piece: &Piece, s: f64, stop: bool, end: Break, bounds: &Bounds) -> Break {
    let corner = &piece.corner;
    // ṡ² at which the acceleration is all used.
    let passing = |acceleration: f64, jump: f64| match corner.half * jump > 0.0 {
        true => 2.0 * acceleration * corner.half / jump,
        false => f64::INFINITY,
    };
    let x = lesser(
        passing(bounds.corner, corner.turn),
        passing(bounds.spin, corner.others),
    );
    Break {
        s,
        real: true,
        stop,
        end: false,
        speed: if stop {
            0.0
        } else {
            lesser(libm::sqrt(x), piece.element.feed)
        },
        ..end
    }
}

/// Directions in which a straight line through the start passes all points so far.
#[derive(Clone, Copy, Debug)]
struct DirectionRange {
    start: Vector3<f64>,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl DirectionRange {
    fn open(start: Vector3<f64>) -> Self {
        Self {
            start,
            low: Vector3::repeat(f64::NEG_INFINITY),
            high: Vector3::repeat(f64::INFINITY),
        }
    }

    fn shut(&mut self) {
        self.low = Vector3::repeat(f64::INFINITY);
    }

    /// Whether there is one that passes `point` too, `way` \[mm\] on, no farther away than `near`.
    fn passes(&mut self, way: f64, point: Vector3<f64>, near: f64) -> bool {
        let per_way = 1.0 / way;
        (0..SHAPED).all(|i| {
            let moved = point[i] - self.start[i];
            self.low[i] = greater(self.low[i], (moved - near) * per_way);
            self.high[i] = lesser(self.high[i], (moved + near) * per_way);
            self.low[i] <= self.high[i]
        })
    }
}
