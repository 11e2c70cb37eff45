//! What the path asks of the axes at one place.

use super::channels::{POSE_CHANNELS, attitude_norm, position_norm};
use super::limits::{Bounds, PATH_ROW, ROWS};
use super::node::{Lanes, highest};
use super::player::PlayerAccess;
use crate::io::AXES;
use crate::kinematics::Kinematics;
use crate::trajectory::reference::at_unit_speed;
use crate::trajectory::{PathSpace, ReferenceError, Unreachable};
use core::array::from_fn;

/// Acceleration by a bend that does not count, as a share of the limit.
const NO_BEND: f32 = 1e-6;

/// What the grid is made of.
pub(super) struct Ground<'a, P: PlayerAccess<E, N>, const E: usize, const N: usize> {
    pub player: &'a mut P,
    pub space: PathSpace,
    pub kinematics: &'a Kinematics,
    pub bounds: &'a Bounds,
}

/// What the path asks of the rows at one place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Path length there \[mm\].
    pub s: f64,
    /// Derivatives of the rows over the way along the nodes.
    pub first: Lanes,
    /// Second derivatives.
    pub second: Lanes,
    /// ṡ² of the feed, and the highest one that is accurate.
    pub feed: f64,
    pub limit: f64,
    /// Curvature \[1/mm\].
    pub bend: f64,
}

impl<P: PlayerAccess<E, N>, const E: usize, const N: usize> Ground<'_, P, E, N> {
    /// What the path asks for at `s`, where nodes lead in a `direction`, and the axes there, nearest to `near`.
    /// The element is looked for from `hint`, which is left there.
    pub fn sample(
        &mut self,
        s: f64,
        direction: f64,
        hint: &mut u32,
        near: &[f64; AXES],
    ) -> Result<(Sample, [f64; AXES]), Unreachable> {
        match self.space {
            PathSpace::Axes => self.sample_of::<AXES>(s, direction, hint, near),
            PathSpace::Tool => self.sample_of::<POSE_CHANNELS>(s, direction, hint, near),
        }
    }

    /// The same by the first `C` channels.
    fn sample_of<const C: usize>(
        &mut self,
        s: f64,
        direction: f64,
        hint: &mut u32,
        near: &[f64; AXES],
    ) -> Result<(Sample, [f64; AXES]), Unreachable> {
        let bounds = self.bounds;
        let seen = self.player.with(|player| {
            let track = &player.track;
            let piece = track.find(s, hint)?;
            let (feed, line) = (piece.element.feed, piece.element.line);
            let point = track.at::<C>(s, hint)?;
            let mut sample = Sample {
                s,
                first: [0.0; ROWS],
                second: [0.0; ROWS],
                feed: feed * feed,
                limit: f64::INFINITY,
                bend: position_norm(&point.second),
            };
            track.keep_accurate(&mut sample, attitude_norm(&point.second), *hint, bounds);
            Some((sample, point, line))
        });
        let nowhere = |line| move |source| Unreachable { line, s, source };
        let (mut sample, point, line) = seen.ok_or(ReferenceError::EmptyPath).map_err(nowhere(0))?;
        let axes = at_unit_speed(self.kinematics, &point, self.space, near).map_err(nowhere(line))?;
        sample.first[PATH_ROW] = 1.0;
        for axis in 0..AXES {
            sample.first[PATH_ROW + 1 + axis] = (direction * axes.velocity[axis]) as f32;
            sample.second[PATH_ROW + 1 + axis] = axes.acceleration[axis] as f32;
        }
        Ok((sample, axes.position))
    }

    /// The same at `s`, not far from the place of `from`, where only corners make a difference; `serial` is the element
    /// there.
    pub fn farther(&mut self, from: &Sample, s: f64, serial: u32) -> Sample {
        let mut sample = Sample { s, ..*from };
        let bounds = self.bounds;
        self.player
            .with(|player| player.track.keep_accurate(&mut sample, 0.0, serial, bounds));
        sample
    }
}

impl Sample {
    /// The largest bend of a row, as a share of its acceleration at unit speed.
    pub fn most_bent(&self, bounds: &Bounds) -> f32 {
        highest(from_fn(|row| {
            self.second[row].abs() * bounds.per_acceleration[row]
        }))
    }

    /// No row feels a bend at the feed.
    pub fn is_straight(&self, bounds: &Bounds) -> bool {
        self.most_bent(bounds) * self.feed as f32 <= NO_BEND
    }

    /// The largest rate of a row, as a share of its highest speed at unit speed.
    pub fn quickest(&self, bounds: &Bounds) -> f32 {
        highest(from_fn(|row| self.first[row].abs() * bounds.per_velocity[row]))
    }

    /// The rows in the middle between two samples: what lies between is as a cubic, which the rates at both ends and
    /// their derivatives say.
    pub fn between(from: &Self, to: &Self) -> Self {
        let way = libm::fabs(to.s - from.s) as f32;
        let per_way = 1.0 / way;
        let mut middle = *from;
        for row in 0..ROWS {
            let (first, second) = (
                [from.first[row], to.first[row]],
                [from.second[row], to.second[row]],
            );
            middle.first[row] = 0.5 * (first[0] + first[1]) + 0.125 * way * (second[0] - second[1]);
            let even = 0.5 * (second[0] + second[1]);
            let off = 1.5 * (per_way * (first[1] - first[0]) - even);
            // Less is rounding of the rates.
            let sure = f32::EPSILON * (first[0].abs() + first[1].abs()) * per_way;
            middle.second[row] = if off.abs() > sure { even + off } else { even };
        }
        middle
    }
}
