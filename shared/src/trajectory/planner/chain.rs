//! Chains of short lines that stand for a curve: their corners are moved outward a little, so that the rounded path
//! lies on both sides of the programmed one, and may be rounded more.
//!
//! Rounding and the output filter both cut corners on the inside. Moved outward by half of what they cut, a corner
//! is off by that much inside, and the middle of a line by as much outside.

use super::corner::SHARP;
use super::limits::{Bounds, FILTER_SHARE};
use super::room::{plain, room};
use super::track::Track;
use crate::trajectory::{Cubic, Join, SHAPED, Shape};
use nalgebra::Vector3;

/// Cosine of the angle between the changes of direction at two neighbouring corners: at most 30°.
const SAME_SENSE: f64 = 0.866;
/// Largest ratio of the lengths of neighbouring lines.
const RATIO: f64 = 2.5;
/// Share of the tolerance that is used.
const USED: f64 = 0.95;

impl<const E: usize> Track<E> {
    /// Looks at the next corner, and moves it if it belongs to a chain; says whether there was one to look at.
    pub fn straighten(&mut self, bounds: &Bounds) -> bool {
        let serial = self.moved;
        if serial >= self.end || (serial + 1 == self.end && !self.closed()) {
            return false;
        }
        self.moved += 1;
        if let Some(shift) = self.shift(serial, bounds) {
            self.move_corner(serial, shift);
        }
        true
    }

    /// Whether the end of element `serial` can still move.
    pub fn may_move(&self, serial: u32) -> bool {
        let next = serial + 1;
        if next < self.moved || (next == self.end && self.closed()) {
            return false;
        }
        let straight = self
            .get(serial)
            .is_some_and(|piece| piece.straight && !piece.stop);
        straight
            && self
                .turn(serial)
                .is_some_and(|turn| turn.norm_squared() < SHARP * SHARP && turn.norm_squared() > 0.0)
    }

    /// Change of the programmed direction at the start of element `serial`.
    fn turn(&self, serial: u32) -> Option<Vector3<f64>> {
        self.get(serial).map(|piece| piece.turn)
    }

    /// How far the corner at the start of element `serial` is to be moved.
    fn shift(&self, serial: u32, bounds: &Bounds) -> Option<Vector3<f64>> {
        let (before, after) = (self.get(serial.checked_sub(1)?)?, self.get(serial)?);
        let Join::Blend(tolerance) = before.element.join else {
            return None;
        };
        let turn = after.turn.norm();
        let lengths = [before.element.length, after.element.length];
        let even = lengths[0] < RATIO * lengths[1] && lengths[1] < RATIO * lengths[0];
        let others_turn = after.corner.jump[SHAPED..].iter().any(|jump| *jump != 0.0);
        if !(before.straight && after.straight && even && turn > 0.0 && turn < SHARP)
            || after.stop
            || others_turn
        {
            return None;
        }
        let alike = |serial: u32| {
            let other = self.turn(serial).unwrap_or_default();
            let (along, square) = (other.dot(&after.turn), other.norm_squared());
            along > 0.0
                && along * along > SAME_SENSE * SAME_SENSE * turn * turn * square
                && square < SHARP * SHARP
        };
        let wanted = room(before, after, turn, bounds);
        if plain(turn, tolerance.position) >= wanted || !(alike(serial - 1) && alike(serial + 1)) {
            return None;
        }
        let half = libm::fmin(wanted, chained(turn, tolerance.position));
        let inside = 0.5 * FILTER_SHARE * tolerance.position + turn * half / 8.0;
        Some(after.turn * (-inside / turn))
    }

    /// Moves the point where element `serial` begins, the end of a line and the start of another.
    fn move_corner(&mut self, serial: u32, shift: Vector3<f64>) {
        let [start, middle, end] = [serial - 1, serial, serial + 1].map(|serial| self.junction(serial));
        let middle = middle + shift;
        let mut turned = [Vector3::zeros(); 2];
        for (i, from, to, shift) in [(0, start, middle, shift), (1, middle, end, -shift)] {
            let Some(piece) = self.get_mut(serial - 1 + i) else {
                return;
            };
            let length = piece.element.length;
            piece.place = from;
            piece.element.shape =
                Shape::Span(core::array::from_fn(|i| Cubic::linear(from[i], to[i], length)));
            turned[i as usize] = shift / length;
        }
        let [before, after] = turned;
        let jumps = [before, after - before, -after];
        for (serial, more) in (serial - 1..).zip(jumps) {
            match self.get_mut(serial) {
                Some(piece) => piece.corner.turn_by(more),
                None => self.end_turned += after,
            }
        }
        if let Some(piece) = self.get_mut(serial) {
            piece.chained = true;
        }
    }
}

/// Half length of a moved corner that turns by `turn` \[mm\].
pub(super) fn chained(turn: f64, tolerance: f64) -> f64 {
    8.0 * (USED - 0.5 * FILTER_SHARE) * tolerance / turn
}
