//! How large the rounded corners are.

use super::chain::chained;
use super::channels::{ATTITUDE, SMOOTH, attitude_norm};
use super::limits::Bounds;
use super::room::{between, plain, room, share};
use super::track::{Piece, Track};
use crate::trajectory::Join;

/// A corner rounded by less \[mm\] is a stop.
const SMALLEST: f64 = 1e-5;

impl<const E: usize> Track<E> {
    /// Moves or shapes one corner, if there is one whose neighbours are known.
    pub fn decide(&mut self, bounds: &Bounds) -> bool {
        let serial = self.decided;
        if self.moved <= serial + 1 && self.straighten(bounds) {
            return true;
        }
        // Where the element ends that begins there has to be known.
        if serial >= self.end || self.may_move(serial) {
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
        let strain = after.strain(before.element.join, half, bounds);
        self.shape_corner(serial, half, stop);
        if let (Some(piece), false) = (self.get_mut(serial), stop) {
            (piece.corner.strain, piece.corner.strained) = strain;
        }
        true
    }

    /// Path length up to which nothing that is still to come changes the path.
    pub fn settled_s(&self) -> f64 {
        let undecided = self.decided.min(self.end);
        let end = self.get(undecided).map_or(self.end_s(), |piece| piece.start);
        if undecided == self.end && self.closed() {
            return end;
        }
        let Some(last) = undecided.checked_sub(1) else {
            return end;
        };
        let part = self.get(last).map_or(0.0, |piece| {
            let whole = piece.stop || self.may_move(last);
            share(piece, whole)
        });
        end - part
    }
}

/// Half length of the corner between two elements \[mm\], and whether the machine has to stop there instead.
fn size(before: &Piece, after: &Piece, bounds: &Bounds) -> (f64, bool) {
    let jump = &after.corner.jump;
    let turn = after.corner.turn;
    let attitude = attitude_norm(jump);
    let slides = jump[ATTITUDE.end..]
        .iter()
        .fold(0.0, |most: f64, x| libm::fmax(most, libm::fabs(*x)));
    let feed = libm::fmin(before.element.feed, after.element.feed);
    let noticed = bounds.unfelt / feed;
    if turn <= noticed && attitude <= SMOOTH && slides <= noticed {
        return (0.0, false);
    }
    let Join::Blend(tolerance) = before.element.join else {
        return (0.0, true);
    };
    let mut half = room(before, after, turn, bounds);
    if attitude > SMOOTH || slides > noticed {
        half = between(before, after);
    }
    if after.chained {
        half = libm::fmin(half, chained(turn, tolerance.position));
        return (half, false);
    }
    let mut within = |jump: f64, tolerance: f64| {
        if jump > 0.0 {
            half = libm::fmin(half, plain(jump, tolerance));
        }
    };
    within(libm::fmax(turn, slides), tolerance.position);
    within(attitude, tolerance.attitude);
    if half < SMALLEST {
        (0.0, true)
    } else {
        (half, false)
    }
}
