//! Where limits change along the path.

use super::grid::{Ground, SAME};
use super::track::{Piece, SMOOTH};
use crate::trajectory::{CHANNELS, SHAPED};

/// Most junctions that are looked at.
const LOOK: u32 = 32;
/// A turn of a sharp corner \[rad\].
const SHARP: f64 = 0.5;
/// Another feed for a shorter time than this is as good as the lower one \[s\].
const SHORT: f64 = 0.0005;

/// Where limits change next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Break {
    /// Way to there \[mm\].
    pub way: f64,
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
    /// Junctions that were looked at.
    pub looks: u32,
}

impl<const E: usize> Ground<'_, E> {
    /// The next change of limits from `s` on in a `direction`; `hint` is the serial of the element there.
    ///
    /// Junctions, corners and whole elements are passed over where the path is straight but for what nothing feels.
    pub fn next_break(&self, s: f64, direction: f64, hint: u32) -> Break {
        let forward = direction > 0.0;
        let end = self.end(direction);
        let stop = !forward || (self.track.closed() && end >= self.track.end_s() - SAME);
        let mut next = Break {
            way: direction * (end - s),
            real: stop,
            stop,
            end: true,
            merged: false,
            speed: 0.0,
            looks: 0,
        };
        let Some(start) = self.track.at(s, &mut hint.clone()) else {
            return next;
        };
        let mut door = Door::open(&start.value);
        let (mut lowest, mut seen) = (f64::INFINITY, 0.0);
        for k in 0..LOOK {
            // A junction, and the element beyond it.
            let (junction, beyond) = match forward {
                true => (Some(hint + k), Some(hint + k)),
                false => ((hint + 1).checked_sub(k), hint.checked_sub(k)),
            };
            let Some(element) = beyond.and_then(|serial| self.track.get(serial)) else {
                return next;
            };
            next.looks += 1;
            let length = element.element.length;
            let (way, far) = match forward {
                true => (element.start - s, length),
                false => (s - element.start - length, 0.0),
            };
            seen = way + length;
            let slower = libm::fmin(element.element.feed, lowest);
            let alike = element.element.feed == lowest || k == 0 || seen <= SHORT * slower;
            lowest = slower;
            let corner = junction.and_then(|serial| self.track.get(serial));
            let smooth = corner.is_none_or(|piece| !piece.stop && piece.corner.others <= SMOOTH);
            let on = alike
                && smooth
                && element.bend * length <= 8.0 * self.bounds.unfelt_way
                && door.passes(seen, &element.element.at(far).value, self.bounds.unfelt_way);
            let half = corner.map_or(0.0, |piece| piece.corner.half);
            for (piece, side) in corner
                .iter()
                .flat_map(|piece| [-half, 0.0, half].map(|side| (piece, side)))
            {
                // A rounded corner bends evenly; a sharp one needs a place to turn the acceleration.
                let even = piece.even && smooth && piece.corner.turn < SHARP;
                if side == 0.0 && half > 0.0 && even {
                    continue;
                }
                let way = way + side;
                // Where a corner ends with the next junction, that is the change.
                if way <= SAME || (side > 0.0 && way >= seen - SAME) {
                    continue;
                }
                if way > next.way + SAME {
                    return next;
                }
                if !on {
                    return self.at(piece, way, piece.stop && side == 0.0, next);
                }
                next.merged = true;
            }
            if !on {
                door.shut();
            }
        }
        if seen < next.way {
            (next.way, next.real, next.stop, next.end) = (seen, false, false, false);
        }
        next
    }

    /// The change of limits at the corner where `piece` begins; `end` is the one where all ends.
    fn at(&self, piece: &Piece, way: f64, stop: bool, end: Break) -> Break {
        let corner = &piece.corner;
        let stop = stop || (end.stop && way >= end.way - SAME);
        let passing = |acceleration: f64, jump: f64| match corner.half * jump > 0.0 {
            true => libm::sqrt(2.0 * acceleration * corner.half / jump),
            false => f64::INFINITY,
        };
        let speed = passing(self.bounds.corner, corner.turn).min(passing(self.bounds.spin, corner.others));
        Break {
            way,
            real: true,
            stop,
            end: false,
            speed: if stop {
                0.0
            } else {
                libm::fmin(speed, piece.element.feed)
            },
            ..end
        }
    }
}

/// Directions in which a straight line through the start passes all points so far.
struct Door {
    start: [f64; SHAPED],
    low: [f64; SHAPED],
    high: [f64; SHAPED],
}

impl Door {
    fn open(start: &[f64; CHANNELS]) -> Self {
        Self {
            start: core::array::from_fn(|i| start[i]),
            low: [f64::NEG_INFINITY; SHAPED],
            high: [f64::INFINITY; SHAPED],
        }
    }

    fn shut(&mut self) {
        self.low = [f64::INFINITY; SHAPED];
    }

    /// Whether there is one that passes `point` too, `way` \[mm\] on, no farther away than `near`.
    fn passes(&mut self, way: f64, point: &[f64; CHANNELS], near: f64) -> bool {
        let per_way = 1.0 / way;
        (0..SHAPED).all(|i| {
            let moved = point[i] - self.start[i];
            self.low[i] = libm::fmax(self.low[i], (moved - near) * per_way);
            self.high[i] = libm::fmin(self.high[i], (moved + near) * per_way);
            self.low[i] <= self.high[i]
        })
    }
}
