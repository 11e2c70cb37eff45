//! The path: where the tool is at path length s.

use super::CHANNELS;
use crate::geometry::{Moving, Pose, PoseError, PoseMotion, pose_in_motion};
use crate::io::SIDES;
use crate::kinematics::AxisMotion;
use heapless::Vec;
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What the first channels of a path are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum PathSpace {
    /// Position, T and N of the tool in the frame of the work.
    #[default]
    Tool,
    /// The six axes (mm, rad); channels 6 to 8 mean nothing. The beams stay off.
    Axes,
}

/// A knot of the path: between two of them every channel is a cubic Hermite span over s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Knot {
    /// Path length \[mm\].
    pub s_mm: f64,
    /// Position of D (3) \[mm\], T (3), N (3), or the axes (6) and nothing (3), by the path's space; extension of the V slides that keeps the defocus (2) \[mm\].
    pub value: [f64; CHANNELS],
    /// Derivative of each channel over s.
    pub slope: [f64; CHANNELS],
}

/// Up to `N` knots; between two of them every channel is a cubic Hermite span over s, outside it continues in
/// a straight line.
#[derive(Clone, Debug)]
pub struct Path<const N: usize> {
    id: u32,
    space: PathSpace,
    knots: Vec<Knot, N>,
}

/// Why a knot was not taken; the path is as before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum PathError {
    /// No room for another knot.
    #[error("the path has more than {capacity} knots")]
    Full {
        /// What fits.
        capacity: u16,
    },
    /// s does not increase, or a value is not finite.
    #[error("knot {index} of the path is out of order or not finite")]
    BadKnot {
        /// Number of the knot.
        index: u16,
    },
}

/// All channels at one place of the path, or the first `N` of them, with their derivatives over s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint<const N: usize = CHANNELS> {
    /// Values: D (3) \[mm\], T (3), N (3), or the axes (6); extension of the V slides (2) \[mm\].
    pub value: [f64; N],
    /// First derivatives over s.
    pub first: [f64; N],
    /// Second derivatives over s.
    pub second: [f64; N],
}

impl<const N: usize> Path<N> {
    /// A path without knots, number 0.
    pub const fn new() -> Self {
        Self {
            id: 0,
            space: PathSpace::Tool,
            knots: Vec::new(),
        }
    }

    /// Forgets all knots and starts path number `id`.
    pub fn clear(&mut self, id: u32, space: PathSpace) {
        self.id = id;
        self.space = space;
        self.knots.clear();
    }

    /// Appends a knot, which must be finite and beyond the last one.
    pub fn push(&mut self, knot: Knot) -> Result<(), PathError> {
        let index = self.knots.len();
        let finite = knot.s_mm.is_finite()
            && knot
                .value
                .iter()
                .chain(&knot.slope)
                .all(|channel| channel.is_finite());
        if !finite || self.knots.last().is_some_and(|last| last.s_mm >= knot.s_mm) {
            return Err(PathError::BadKnot { index: index as u16 });
        }
        self.knots
            .push(knot)
            .map_err(|_| PathError::Full { capacity: N as u16 })
    }

    /// Appends all of `knots`, or none.
    pub fn append(&mut self, knots: &[Knot]) -> Result<(), PathError> {
        let before = self.knots.len();
        let done = knots.iter().try_for_each(|knot| self.push(*knot));
        if done.is_err() {
            self.knots.truncate(before);
        }
        done
    }

    /// Number of the path.
    pub fn id(&self) -> u32 {
        self.id
    }

    /// What its first channels are.
    pub fn space(&self) -> PathSpace {
        self.space
    }

    /// Number of knots.
    pub fn len(&self) -> usize {
        self.knots.len()
    }

    /// No knots yet.
    pub fn is_empty(&self) -> bool {
        self.knots.is_empty()
    }

    /// Path length of the first knot \[mm\].
    pub fn start_s(&self) -> Option<f64> {
        self.knots.first().map(|knot| knot.s_mm)
    }

    /// Path length of the last knot \[mm\].
    pub fn end_s(&self) -> Option<f64> {
        self.knots.last().map(|knot| knot.s_mm)
    }

    /// All channels at path length `s` \[mm\]; `None` without knots.
    ///
    /// A bisection costs a hundred instructions in a thousand knots, so nothing is remembered from tick to
    /// tick and any number of readers may ask anywhere.
    pub fn at(&self, s: f64) -> Option<PathPoint> {
        let above = self.knots.partition_point(|knot| knot.s_mm <= s);
        match (
            above.checked_sub(1).map(|i| &self.knots[i]),
            self.knots.get(above),
        ) {
            (Some(from), Some(to)) => Some(PathPoint::between(from, to, s)),
            (Some(end), None) | (None, Some(end)) => Some(PathPoint::beyond(end, s)),
            (None, None) => None,
        }
    }
}

impl<const N: usize> Default for Path<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl PathPoint {
    fn between(from: &Knot, to: &Knot, s: f64) -> Self {
        let h = to.s_mm - from.s_mm;
        let per_h = 1.0 / h;
        let x = s - from.s_mm;
        let t = x * per_h;
        let mut point = Self::ZERO;
        for i in 0..CHANNELS {
            let (d0, d1) = (from.slope[i], to.slope[i]);
            let chord = (to.value[i] - from.value[i]) * per_h;
            let b = 3.0 * chord - 2.0 * d0 - d1;
            let c = d0 + d1 - 2.0 * chord;
            point.value[i] = from.value[i] + x * (d0 + t * (b + t * c));
            point.first[i] = d0 + t * (2.0 * b + 3.0 * t * c);
            point.second[i] = (2.0 * b + 6.0 * t * c) * per_h;
        }
        point
    }

    fn beyond(end: &Knot, s: f64) -> Self {
        let x = s - end.s_mm;
        let mut point = Self::ZERO;
        for i in 0..CHANNELS {
            point.value[i] = end.value[i] + end.slope[i] * x;
        }
        point.first = end.slope;
        point
    }

    /// Extension of the V slide of each side that keeps the defocus \[mm\] (mathematics 0.6).
    pub fn v_follow(&self) -> [f64; SIDES] {
        [self.value[9], self.value[10]]
    }

    /// Derivative of [`Self::v_follow`] over s.
    pub fn v_follow_slope(&self) -> [f64; SIDES] {
        [self.first[9], self.first[10]]
    }
}

impl<const N: usize> PathPoint<N> {
    pub(super) const ZERO: Self = Self {
        value: [0.0; N],
        first: [0.0; N],
        second: [0.0; N],
    };

    /// The pose here, T and N orthonormal (mathematics 0.4).
    pub fn pose(&self) -> Result<Pose, PoseError> {
        Pose::new(self.moving(0).value, self.moving(3).value, self.moving(6).value)
    }

    /// The pose here and its derivatives over s, exact for the orthonormal frame.
    pub fn pose_in_motion(&self) -> Result<(Pose, PoseMotion), PoseError> {
        pose_in_motion(&self.moving(0), &self.moving(3), &self.moving(6))
    }

    /// The axes here, and their derivatives over s; of a path in [`PathSpace::Axes`].
    pub fn axes(&self) -> AxisMotion {
        let six = |c: &[f64; N]| core::array::from_fn(|axis| c[axis]);
        AxisMotion {
            position: six(&self.value),
            velocity: six(&self.first),
            acceleration: six(&self.second),
        }
    }

    fn moving(&self, channel: usize) -> Moving {
        let vector = |c: &[f64; N]| Vector3::new(c[channel], c[channel + 1], c[channel + 2]);
        Moving {
            value: vector(&self.value),
            first: vector(&self.first),
            second: vector(&self.second),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knot(s_mm: f64, value: f64, slope: f64) -> Knot {
        Knot {
            s_mm,
            value: [value; CHANNELS],
            slope: [slope; CHANNELS],
        }
    }

    fn cubic(s: f64) -> [f64; 3] {
        [s * s * s - 2.0 * s, 3.0 * s * s - 2.0, 6.0 * s]
    }

    /// Knots cut from one cubic give that cubic back, in and between all spans, and its tangents outside.
    #[test]
    fn a_cubic_is_reproduced_with_its_derivatives() {
        let mut path = Path::<8>::new();
        for s in [-1.0, 0.5, 0.75, 3.0] {
            let [value, slope, _] = cubic(s);
            path.push(knot(s, value, slope)).unwrap();
        }
        for k in 0..=400 {
            let s = -1.0 + f64::from(k) * 0.01;
            let point = path.at(s).unwrap();
            let [value, first, second] = cubic(s);
            for i in 0..CHANNELS {
                assert!((point.value[i] - value).abs() < 1e-12, "value at {s}");
                assert!((point.first[i] - first).abs() < 1e-12, "first at {s}");
                // Beyond the last knot, to which the last s belongs, the line has no curvature.
                assert!(
                    k == 400 || (point.second[i] - second).abs() < 1e-11,
                    "second at {s}"
                );
            }
        }
        for (s, end) in [(-3.0, -1.0), (5.0, 3.0)] {
            let point = path.at(s).unwrap();
            let [value, first, _] = cubic(end);
            assert!((point.value[0] - (value + first * (s - end))).abs() < 1e-12);
            assert_eq!((point.first[0], point.second[0]), (first, 0.0));
        }
    }

    #[test]
    fn a_knot_out_of_order_not_finite_or_too_many_is_refused() {
        let mut path = Path::<2>::new();
        assert_eq!((path.at(0.0), path.start_s(), path.end_s()), (None, None, None));
        path.push(knot(0.0, 1.0, 0.0)).unwrap();
        assert_eq!(
            path.push(knot(0.0, 1.0, 0.0)),
            Err(PathError::BadKnot { index: 1 })
        );
        assert_eq!(
            path.push(knot(1.0, f64::NAN, 0.0)),
            Err(PathError::BadKnot { index: 1 })
        );
        assert_eq!(
            path.push(knot(f64::INFINITY, 0.0, 0.0)),
            Err(PathError::BadKnot { index: 1 })
        );
        path.push(knot(1.0, 1.0, 0.0)).unwrap();
        assert_eq!(
            path.push(knot(2.0, 1.0, 0.0)),
            Err(PathError::Full { capacity: 2 })
        );
        assert_eq!(
            (path.len(), path.start_s(), path.end_s()),
            (2, Some(0.0), Some(1.0))
        );
        path.clear(7, PathSpace::Axes);
        assert!(path.is_empty() && path.id() == 7 && path.space() == PathSpace::Axes);
    }
}
