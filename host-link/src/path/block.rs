//! The motion of one block of a path that is followed exactly.

use super::shape::{SHORTEST, channels};
use super::targets::arc;
use super::{PathError, Planner, Tip};
use crate::nc::{Target, Way};
use nalgebra::Vector3;
use shared::geometry::{Arc, Moving, Pose, angle, interpolate};
use shared::io::SIDES;
use shared::trajectory::CHANNELS;

/// A cubic span may be off an arc by this much: in position \[mm\] and direction.
const MAX_ERROR: [f64; 2] = [1e-5, 1e-6];
/// Step of differences \[rad\].
const DIFFERENCE: f64 = 1e-3;

/// The motion of one block over its length.
pub(super) struct Block {
    way: BlockWay,
    attitude: Attitude,
    extension: [[f64; SIDES]; 2],
    pub(super) length: f64,
    /// Sum of the rates at which rotary axes turn \[rad/mm\].
    turning: f64,
    pub(super) line: u32,
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
pub(super) struct Jet {
    pub(super) value: [f64; CHANNELS],
    pub(super) slope: [f64; CHANNELS],
}

impl Block {
    /// The motion of `target` between two tips.
    pub(super) fn build(planner: &Planner, from: &Tip, to: &Tip, target: &Target) -> Result<Self, PathError> {
        let line = target.line;
        let [start, end] = [planner.pose(from), planner.pose(to)];
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
        Ok(Self {
            way,
            attitude,
            extension: [from.extension_mm, to.extension_mm],
            length,
            turning: turn / length,
            line,
        })
    }

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

    /// Direction of travel.
    pub(super) fn direction(&self, u: f64) -> Vector3<f64> {
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

    /// Channels and their slopes, a length `u` from the start.
    pub(super) fn jet(&self, planner: &Planner, u: f64) -> Jet {
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

    /// Where knots stand on this block, which begins at `start`: at its end, where the `changes` at its joins begin and end, and in
    /// between so near that cubic spans are exact; also at its start if it is the first one.
    pub(super) fn places(&self, start: f64, changes: &[f64], first: bool) -> Vec<f64> {
        let end = start + self.length;
        let mut fixed = changes.to_vec();
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
