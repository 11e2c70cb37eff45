//! Curves with their knots: smooth through many points, and straight in axis space.

use super::{PathError, Planner, Tip};
use crate::curve::{Curve, distance};
use nalgebra::Vector3;
use nc::{SourcePosition, Target};
use shared::geometry::{Pose, angle};
use shared::io::{AXES, SIDES};
use shared::kinematics::AXIS_UNIT;
use shared::trajectory::{CHANNELS, Knot};

/// Largest angle between two chords of a path \[rad\]: a spline through a sharper corner would swing out.
const MAX_CORNER: f64 = 0.35;
/// Parts of a span at which its distance from the chord is taken.
const CHORD_CHECKS: u32 = 16;
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
    /// Where in the program.
    pub(super) place: SourcePosition,
    /// By how much the rotary axes may be off their words there, as they change their rates \[rad\].
    pub(super) slack: f64,
}

impl Goal {
    /// The place is met exactly.
    pub(super) fn exact(s: f64, place: SourcePosition) -> Self {
        Self { s, place, slack: 0.0 }
    }
}

impl Shape {
    /// The straight line of axis space between two places (mm, rad), V slides standing at `extension`.
    pub(super) fn of_axes(
        from: &[f64; AXES],
        to: &[f64; AXES],
        extension: &[f64; SIDES],
        place: SourcePosition,
    ) -> Self {
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
            targets: vec![Goal::exact(longest, place)],
        }
    }

    /// No way at all, in which the tool stands at `value`.
    pub(super) fn standing(value: [f64; CHANNELS], place: SourcePosition) -> Self {
        let slope = [0.0; CHANNELS];
        let knot = |s_mm| Knot { s_mm, value, slope };
        Self {
            knots: vec![knot(0.0), knot(SHORTEST)],
            speed_error: 0.0,
            targets: vec![Goal::exact(SHORTEST, place)],
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

    /// Place in the program of the motion at `s`.
    pub(super) fn place(&self, s: f64) -> SourcePosition {
        self.targets[self.target(s)].place
    }
}

impl Planner {
    /// The smooth curve from `from` through `tips`, the places of `targets`, and how far it is off the straight lines
    /// between them \[mm\].
    pub(super) fn smooth(
        &self,
        from: &Tip,
        tips: &[Tip],
        targets: &[Target],
    ) -> Result<(Shape, f64), PathError> {
        let points: Vec<_> = std::iter::once(from)
            .chain(tips)
            .map(|tip| channels(&self.pose(tip), &tip.extension_mm))
            .collect();
        for (pair, target) in points.windows(2).zip(targets) {
            if distance(&pair[0], &pair[1]) < SHORTEST {
                return Err(PathError::NoTravel { place: target.place });
            }
        }
        for (three, target) in points.windows(3).zip(&targets[1..]) {
            let chord = |i: usize| position(&three[i + 1]) - position(&three[i]);
            let turn = angle(&chord(0), &chord(1));
            if turn > MAX_CORNER {
                return Err(PathError::Corner {
                    place: target.place,
                    degrees: turn.to_degrees(),
                });
            }
        }
        let place = targets[0].place;
        let curve = Curve::by_length(&points).map_err(|source| PathError::Spline { place, source })?;
        let ends = curve.parameters()[1..].iter();
        let shape = Shape {
            speed_error: curve.speed_error(),
            targets: ends.zip(targets).map(|(s, t)| Goal::exact(*s, t.place)).collect(),
            knots: knots_of(&curve),
        };
        Ok((shape, off_chords(&curve, &points)))
    }
}

/// How far `curve` is off the lines between its points, the first three channels of `points` \[mm\].
fn off_chords(curve: &Curve<CHANNELS>, points: &[[f64; CHANNELS]]) -> f64 {
    let mut largest: f64 = 0.0;
    for (pair, ends) in points.windows(2).zip(curve.parameters().windows(2)) {
        let (from, chord) = (position(&pair[0]), position(&pair[1]) - position(&pair[0]));
        for i in 1..CHORD_CHECKS {
            let part = f64::from(i) / f64::from(CHORD_CHECKS);
            let [value, ..] = curve.at(ends[0] + (ends[1] - ends[0]) * part);
            let off = position(&value) - from;
            let along = off.dot(&chord) / chord.norm_squared();
            largest = largest.max((off - chord * along.clamp(0.0, 1.0)).norm());
        }
    }
    largest
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
