//! How large the rounded corners are.

use super::limits::{Bounds, FILTER_SHARE};
use super::track::{Piece, Track, position_norm};
use crate::trajectory::{CHANNELS, Join, SHAPED};

/// A jump of velocity below this share of what the filter takes is none.
const UNNOTICED: f64 = 1e-3;
/// A corner rounded by less \[mm\] is a stop.
const SMALLEST: f64 = 1e-5;
/// Channels of attitude (or axes A B C); after them come the V slides \[mm\].
const ATTITUDE: core::ops::Range<usize> = SHAPED..CHANNELS - 2;

impl<const E: usize> Track<E> {
    /// Shapes one corner, if there is one whose neighbours are known.
    pub fn decide(&mut self, bounds: &Bounds) -> bool {
        let serial = self.decided;
        if serial >= self.end {
            return false;
        }
        self.decided += 1;
        let Some((before, after)) = serial
            .checked_sub(1)
            .and_then(|s| self.get(s))
            .zip(self.get(serial))
        else {
            return true;
        };
        let (half, stop) = size(before, after, bounds);
        self.shape_corner(serial, half, stop);
        true
    }

    /// Path length up to which nothing that is still to come changes the path.
    pub fn settled_s(&self) -> f64 {
        let undecided = self.decided.min(self.end);
        let end = self.get(undecided).map_or(self.end_s(), |piece| piece.start);
        if undecided == self.end && self.closed() {
            return end;
        }
        let before = undecided.checked_sub(1).and_then(|serial| self.get(serial));
        end - before.map_or(0.0, |piece| share(piece, piece.stop))
    }
}

/// What a corner may use of an element; `whole` if the machine comes to rest at its other end.
fn share(piece: &Piece, whole: bool) -> f64 {
    if whole {
        piece.element.length
    } else {
        0.5 * piece.element.length
    }
}

/// Half length of the corner between two elements \[mm\], and whether the machine has to stop there instead.
fn size(before: &Piece, after: &Piece, bounds: &Bounds) -> (f64, bool) {
    let jump = &after.corner.jump;
    let turn = position_norm(jump);
    let largest = |range: core::ops::Range<usize>| {
        jump[range]
            .iter()
            .fold(0.0, |most: f64, x| libm::fmax(most, libm::fabs(*x)))
    };
    let (attitude, slides) = (largest(ATTITUDE), largest(ATTITUDE.end..CHANNELS));
    let feed = libm::fmin(before.element.feed, after.element.feed);
    let noticed = UNNOTICED * bounds.corner * bounds.filter / feed;
    if turn <= noticed && attitude <= super::track::SMOOTH && slides <= noticed {
        return (0.0, false);
    }
    let Join::Blend(tolerance) = before.element.join else {
        return (0.0, true);
    };
    let whole = after.element.join == Join::Stop;
    let mut half = libm::fmin(share(before, before.stop), share(after, whole));
    let rounding = 4.0 * (1.0 - FILTER_SHARE);
    let mut within = |jump: f64, tolerance: f64| {
        if jump > 0.0 {
            half = libm::fmin(half, rounding * tolerance / jump);
        }
    };
    within(libm::fmax(turn, slides), tolerance.position);
    within(attitude, tolerance.attitude);
    // No larger than the feed needs to be kept.
    if attitude <= super::track::SMOOTH && slides <= noticed {
        half = libm::fmin(half, feed * feed * turn / (1.2 * bounds.corner));
    }
    if half < SMALLEST {
        (0.0, true)
    } else {
        (half, false)
    }
}
