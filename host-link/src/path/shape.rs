//! Curves with their knots: smooth through many points, and straight in axis space.

use super::{PathError, Planner, Tip};
use crate::curve::{Curve, distance};
use crate::nc::Target;
use nalgebra::Vector3;
use shared::geometry::{Pose, angle};
use shared::io::{AXES, SIDES};
use shared::kinematics::AXIS_UNIT;
use shared::protocol::Knot;
use shared::trajectory::CHANNELS;

/// Largest angle between two chords of a path \[rad\]: a spline through a sharper corner would swing out.
const MAX_CORNER: f64 = 0.35;
/// Shortest path \[mm\], for moves that need next to no motion.
pub(super) const SHORTEST: f64 = 1e-3;

/// A path before it is timed.
pub(super) struct Shape {
    pub(super) knots: Vec<Knot>,
    pub(super) speed_error: f64,
    /// Where the motion to each target ends.
    pub(super) targets: Vec<Goal>,
}

/// Where the motion to a target ends.
#[derive(Clone, Copy)]
pub(super) struct Goal {
    pub(super) s: f64,
    /// Line of the program.
    pub(super) line: u32,
    /// By how much the rotary axes may be off their words there, as they change their rates \[rad\].
    pub(super) slack: f64,
}

impl Goal {
    /// The place is met exactly.
    pub(super) fn exact(s: f64, line: u32) -> Self {
        Self { s, line, slack: 0.0 }
    }
}

impl Shape {
    /// The straight line of axis space between two places (mm, rad), V slides standing at `extension`.
    pub(super) fn of_axes(from: &[f64; AXES], to: &[f64; AXES], extension: &[f64; SIDES], line: u32) -> Self {
        let way = |i: usize| (to[i] - from[i]) / AXIS_UNIT[i];
        let longest = (0..AXES).map(|i| way(i).abs()).fold(SHORTEST, f64::max);
        let knot = |axes: &[f64; AXES], s_mm: f64| {
            let mut knot = Knot {
                s_mm,
                value: [0.0; CHANNELS],
                slope: [0.0; CHANNELS],
            };
            knot.value[..AXES].copy_from_slice(axes);
            knot.value[CHANNELS - SIDES..].copy_from_slice(extension);
            for (i, slope) in knot.slope[..AXES].iter_mut().enumerate() {
                *slope = (to[i] - from[i]) / longest;
            }
            knot
        };
        Self {
            knots: vec![knot(from, 0.0), knot(to, longest)],
            speed_error: 0.0,
            targets: vec![Goal::exact(longest, line)],
        }
    }

    /// Where the motion to each target starts \[mm\].
    pub(super) fn starts(&self) -> Vec<f64> {
        let ends = self.targets.iter().map(|goal| goal.s);
        std::iter::once(0.0)
            .chain(ends)
            .take(self.targets.len())
            .collect()
    }

    /// Index of the target to which the motion at `s` leads.
    pub(super) fn target(&self, s: f64) -> usize {
        let index = self.targets.partition_point(|goal| goal.s < s);
        index.min(self.targets.len() - 1)
    }

    /// Program line of the motion at `s`.
    pub(super) fn line(&self, s: f64) -> u32 {
        self.targets[self.target(s)].line
    }
}

impl Planner {
    /// The smooth curve from `from` through `tips`, the places of `targets`.
    pub(super) fn smooth(&self, from: &Tip, tips: &[Tip], targets: &[Target]) -> Result<Shape, PathError> {
        let points: Vec<_> = std::iter::once(from)
            .chain(tips)
            .map(|tip| channels(&self.pose(tip), &tip.extension_mm))
            .collect();
        for (pair, target) in points.windows(2).zip(targets) {
            if distance(&pair[0], &pair[1]) < SHORTEST {
                return Err(PathError::NoTravel { line: target.line });
            }
        }
        for (three, target) in points.windows(3).zip(&targets[1..]) {
            let chord = |i: usize| position(&three[i + 1]) - position(&three[i]);
            let turn = angle(&chord(0), &chord(1));
            if turn > MAX_CORNER {
                return Err(PathError::Corner {
                    line: target.line,
                    degrees: turn.to_degrees(),
                });
            }
        }
        let line = targets[0].line;
        let curve = Curve::by_length(&points).map_err(|source| PathError::Spline { line, source })?;
        let ends = curve.parameters()[1..].iter();
        Ok(Shape {
            speed_error: curve.speed_error(),
            targets: ends.zip(targets).map(|(s, t)| Goal::exact(*s, t.line)).collect(),
            knots: knots_of(&curve),
        })
    }
}

fn position(channels: &[f64; CHANNELS]) -> Vector3<f64> {
    Vector3::new(channels[0], channels[1], channels[2])
}

pub(super) fn channels(pose: &Pose, extension: &[f64; SIDES]) -> [f64; CHANNELS] {
    let [d, t, n] = [pose.position, pose.tangent, pose.normal];
    [
        d.x,
        d.y,
        d.z,
        t.x,
        t.y,
        t.z,
        n.x,
        n.y,
        n.z,
        extension[0],
        extension[1],
    ]
}

fn knots_of(curve: &Curve<CHANNELS>) -> Vec<Knot> {
    let knot = |&s_mm: &f64| {
        let [value, slope, _] = curve.at(s_mm);
        Knot { s_mm, value, slope }
    };
    curve.parameters().iter().map(knot).collect()
}
