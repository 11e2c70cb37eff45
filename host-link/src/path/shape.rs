//! From the targets of a program path to a smooth or straight curve and its knots.

use super::{PathError, Planner, Tip};
use crate::curve::{Curve, distance};
use crate::nc::{Motion, Target};
use nalgebra::Vector3;
use shared::geometry::{Pose, angle, interpolate};
use shared::io::{AXES, SIDES};
use shared::kinematics::AXIS_UNIT;
use shared::protocol::Knot;
use shared::trajectory::CHANNELS;

/// Largest turn of the head between two knots of a straight move \[rad\].
const STRAIGHT_TURN: f64 = 0.05;
/// Largest angle between two chords of a path \[rad\]: a spline through a sharper corner would swing out.
const MAX_CORNER: f64 = 0.35;
/// Path length of a move that turns or stretches without moving the tip \[mm per degree or mm\].
const LENGTH_PER_TURN: f64 = 1.0;
/// Half a turn \[deg\].
const HALF_TURN: f64 = 180.0;
/// A turn about N that shows whether T is free \[rad\].
const SOME_TURN: f64 = 0.01;
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

    /// A straight line of the tip while the head turns about one axis. Where the tool is a body of revolution the
    /// machine cannot turn it about any axis; there the rotary axes turn evenly from angle to angle. So they come to
    /// what is programmed, and pass a pole without a jump.
    pub(super) fn straight(
        &self,
        motion: Motion,
        from: &Tip,
        tip: &Tip,
        line: u32,
    ) -> Result<Shape, PathError> {
        let (start, end) = (self.pose(from), self.pose(tip));
        let travel = (end.position - start.position).norm();
        if motion == Motion::Feed && travel < SHORTEST {
            return Err(PathError::NoTravel { line });
        }
        let turns: [f64; 3] = std::array::from_fn(|i| (tip.angles_deg[i] - from.angles_deg[i]).abs());
        let evenly = turns.iter().all(|turn| *turn <= HALF_TURN) && self.tangent_is_free(from);
        // Not the angle of the turn, but not smaller than half of it, which is all that counts here.
        let turn = if evenly {
            turns.iter().sum::<f64>().to_radians()
        } else {
            angle(&start.tangent, &end.tangent) + angle(&start.normal, &end.normal)
        };
        let stretch = (0..SIDES)
            .map(|k| (tip.extension_mm[k] - from.extension_mm[k]).abs())
            .fold(0.0, f64::max);
        let length = match motion {
            Motion::Feed => travel,
            Motion::Rapid => travel
                .max(LENGTH_PER_TURN * turn.to_degrees())
                .max(stretch)
                .max(SHORTEST),
        };
        let count = (turn / STRAIGHT_TURN).ceil().max(1.0) as usize;
        let mut points = Vec::new();
        for i in 0..=count {
            let part = i as f64 / count as f64;
            let pose = if evenly {
                self.pose(&between(from, tip, part))
            } else {
                interpolate(&start, &end, part).map_err(|source| PathError::Attitude { line, source })?
            };
            let extension: [f64; SIDES] = std::array::from_fn(|k| {
                from.extension_mm[k] + (tip.extension_mm[k] - from.extension_mm[k]) * part
            });
            points.push(channels(&pose, &extension));
        }
        let s = (0..=count).map(|i| length * i as f64 / count as f64).collect();
        let curve = Curve::through(s, &points).map_err(|source| PathError::Spline { line, source })?;
        Ok(Shape {
            knots: knots_of(&curve),
            speed_error: 0.0,
            targets: vec![Goal::exact(length, line)],
        })
    }

    /// Whether the machine takes another T for the same tool, as one does whose tool is a body of revolution.
    fn tangent_is_free(&self, tip: &Tip) -> bool {
        let pose = self.pose(tip);
        let turned = pose.tangent * libm::cos(SOME_TURN) + pose.lateral() * libm::sin(SOME_TURN);
        let other = Pose {
            tangent: turned,
            ..pose
        };
        let [a, b, c] = tip.angles_deg.map(f64::to_radians);
        let taken = self.kinematics.inverse(&other, &[0.0, 0.0, 0.0, a, b, c]);
        taken.is_ok_and(|axes| angle(&self.kinematics.forward(&axes).tangent, &turned) > SOME_TURN / 2.0)
    }
}

/// A part of the way from `from` to `to`, every number evenly.
fn between(from: &Tip, to: &Tip, part: f64) -> Tip {
    let even = |a: f64, b: f64| a + (b - a) * part;
    Tip {
        position_mm: std::array::from_fn(|i| even(from.position_mm[i], to.position_mm[i])),
        angles_deg: std::array::from_fn(|i| even(from.angles_deg[i], to.angles_deg[i])),
        extension_mm: std::array::from_fn(|i| even(from.extension_mm[i], to.extension_mm[i])),
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
