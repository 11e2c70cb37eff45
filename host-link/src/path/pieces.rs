//! From one path of a program to what the boards run: its curves, timed and checked, and where the machine then
//! stands.

use super::exact::Piece;
use super::limits::{Demand, axes_at};
use super::shape::Shape;
use super::targets::{ROTARY, Stand};
use super::{CAPACITY, PathError, PlannedPath, Planner, Tip, outputs};
use crate::nc::{Motion, ProgramPath, Way};
use shared::io::{AXES, SIDES};
use shared::kinematics::AXIS_UNIT;
use shared::motion::MAX_EVENTS;
use shared::protocol::{PathAction, PathEvent};
use shared::trajectory::PathSpace;

/// A rotary axis stands where it should, to this much \[rad\]: below what anything resolves, and above what the
/// figures of a program are rounded to, where its tip decides how an axis stands.
const SAME_ANGLE: f64 = 1e-5;
/// An axis that follows a change of its neighbourhood by this much is free \[rad\].
const FREE: f64 = 1e-3;

impl Planner {
    /// What the boards run for one path of the program, which starts where the machine stands.
    pub(super) fn path(
        &self,
        path: &ProgramPath,
        stand: &mut Stand,
        speed_mm_s: Option<f64>,
    ) -> Result<Vec<PlannedPath>, PathError> {
        self.check_outputs(&path.events)?;
        let mut planned = if path.targets[0].way == Way::Axes {
            vec![self.axes_motion(path, stand)?]
        } else {
            self.tip_motion(path, stand, speed_mm_s)?
        };
        planned[0].dwell_before_s = path.dwell_before_s;
        Ok(planned)
    }

    /// A rapid on the straight line of axis space (mm, rad), V slides standing at `extension`.
    pub(super) fn axes_path(
        &self,
        from: &[f64; AXES],
        to: &[f64; AXES],
        extension: &[f64; SIDES],
        line: u32,
    ) -> Result<PlannedPath, PathError> {
        let shape = Shape::of_axes(from, to, extension, line);
        let mut planned = PlannedPath::untimed(&shape, PathSpace::Axes, Motion::Rapid);
        let demands = self.demands(&planned, &shape, from)?;
        self.check_travel(&demands, &shape)?;
        planned.limits = self.rapid_limits(&demands);
        Ok(planned)
    }

    /// G53 G0.
    fn axes_motion(&self, path: &ProgramPath, stand: &mut Stand) -> Result<PlannedPath, PathError> {
        let target = &path.targets[0];
        let to = self.axes_target(target, stand)?;
        let extension_mm = stand.tip.extension_mm;
        let mut planned = self.axes_path(&stand.axes, &to, &extension_mm, target.line)?;
        planned.events = events(path, 0, &[0.0], &[], target.line)?;
        let people = std::array::from_fn(|i| to[i] / AXIS_UNIT[i]);
        stand.axes = to;
        stand.tip = Tip {
            extension_mm,
            ..self.tip(&people)
        };
        Ok(planned)
    }

    fn tip_motion(
        &self,
        path: &ProgramPath,
        stand: &mut Stand,
        speed_mm_s: Option<f64>,
    ) -> Result<Vec<PlannedPath>, PathError> {
        let tips = self.tips(path, stand)?;
        let speeds = speeds(path, speed_mm_s)?;
        let pieces = self.pieces(path, &tips, &stand.tip, &speeds)?;
        let mut paths = Vec::with_capacity(pieces.len());
        for piece in &pieces {
            paths.push(self.piece(path, piece, &tips, &speeds, stand)?);
        }
        Ok(paths)
    }

    /// The curves of a path of the tip.
    fn pieces(
        &self,
        path: &ProgramPath,
        tips: &[Tip],
        from: &Tip,
        speeds: &[f64],
    ) -> Result<Vec<Piece>, PathError> {
        let targets = &path.targets;
        let arcs = targets.iter().any(|t| matches!(t.way, Way::Arc(..)));
        if arcs || targets.len() == 1 {
            return self.exact(path.motion, from, tips, targets, speeds);
        }
        let shape = self.smooth(from, tips, targets)?;
        Ok(vec![Piece {
            shape,
            first: 0,
            corner: None,
        }])
    }

    /// One curve, timed and checked; the machine then stands at its end.
    fn piece(
        &self,
        path: &ProgramPath,
        piece: &Piece,
        tips: &[Tip],
        speeds: &[f64],
        stand: &mut Stand,
    ) -> Result<PlannedPath, PathError> {
        let (shape, first) = (&piece.shape, piece.first);
        let here = first..first + shape.targets.len();
        let line = shape.targets[0].line;
        if shape.knots.len() > CAPACITY {
            return Err(PathError::TooLong {
                line,
                knots: shape.knots.len(),
            });
        }
        let mut planned = PlannedPath::untimed(shape, PathSpace::Tool, path.motion);
        if path.motion == Motion::Rapid {
            planned.speed_error = 0.0;
        }
        planned.corner_deg = piece.corner.map(f64::to_degrees);
        planned.events = events(path, first, &shape.starts(), &speeds[here.clone()], line)?;
        let demands = self.demands(&planned, shape, &stand.axes)?;
        let reached = self.reached(&demands, shape, &tips[here.clone()])?;
        self.check_travel(&demands, shape)?;
        planned.limits = match path.motion {
            Motion::Rapid => self.rapid_limits(&demands),
            Motion::Feed => self.feed_limits(&demands, shape, &speeds[here])?,
        };
        planned.bound = match path.motion {
            Motion::Rapid => None,
            Motion::Feed => self.bound(&demands),
        };
        *stand = reached;
        Ok(planned)
    }

    /// Where the machine stands at the end. At every target the rotary axes must stand as it says, not a turn away;
    /// where its pose leaves an axis free, that stands as it was.
    fn reached(&self, demands: &[Demand], shape: &Shape, tips: &[Tip]) -> Result<Stand, PathError> {
        let mut stand = Stand {
            tip: Tip::default(),
            axes: [0.0; AXES],
            placed: true,
        };
        for (tip, goal) in tips.iter().zip(&shape.targets) {
            let axes = axes_at(demands, goal.s);
            stand = Stand {
                tip: *tip,
                axes,
                ..stand
            };
            // Where the tip forces one axis, others may follow; the largest difference is the cause.
            let mut worst = None;
            for axis in ROTARY.filter(|&axis| self.fitted[axis]) {
                let angle = &mut stand.tip.angles_deg[axis - ROTARY.start];
                let reached = axes[axis].to_degrees();
                let off = (reached - *angle).abs();
                if off <= (SAME_ANGLE + goal.slack).to_degrees() {
                    continue;
                }
                if self.leaves_free(tip, &axes, axis) {
                    *angle = reached;
                } else if worst.as_ref().is_none_or(|(largest, _)| off > *largest) {
                    worst = Some((off, PathError::turned(goal.line, axis, *angle, reached)));
                }
            }
            if let Some((_, error)) = worst {
                return Err(error);
            }
        }
        Ok(stand)
    }

    /// Whether the pose of `tip`, at which the axes stand at `axes`, leaves `axis` where it happens to be.
    fn leaves_free(&self, tip: &Tip, axes: &[f64; AXES], axis: usize) -> bool {
        let mut near = *axes;
        near[axis] += FREE;
        let seen = self.kinematics.inverse(&self.pose(tip), &near);
        seen.is_ok_and(|seen| (seen[axis] - axes[axis]).abs() > FREE / 2.0)
    }
}

/// Speed on the way to each target \[mm/s\], 0 for a rapid; `replaced` takes the place of the programmed one.
fn speeds(path: &ProgramPath, replaced: Option<f64>) -> Result<Vec<f64>, PathError> {
    if replaced.is_some() && path.feeds.len() > 1 {
        let line = path.targets[0].line;
        return Err(PathError::SeveralFeeds { line });
    }
    let mut speeds = vec![0.0; path.targets.len()];
    for feed in &path.feeds {
        let speed = replaced.unwrap_or(feed.mm_min / 60.0);
        if !(speed.is_finite() && speed > 0.0) {
            return Err(PathError::NoFeed(speed * 60.0));
        }
        speeds[feed.with_target..].fill(speed);
    }
    Ok(speeds)
}

/// What happens on the part of `path` that begins with target `first`, whose motions start at `starts` \[mm\] and go
/// at `speeds` \[mm/s\]. What was on before is switched on again.
fn events(
    path: &ProgramPath,
    first: usize,
    starts: &[f64],
    speeds: &[f64],
    line: u32,
) -> Result<Vec<PathEvent>, PathError> {
    let mut events = outputs::carried(&path.events, first);
    for event in &path.events {
        let index = event.with_target.checked_sub(first);
        events.extend(index.and_then(|i| starts.get(i)).map(|s_mm| PathEvent {
            s_mm: *s_mm,
            action: event.action,
        }));
    }
    for (pair, s_mm) in speeds.windows(2).zip(&starts[1..]) {
        if pair[0] != pair[1] {
            let action = PathAction::Speed { mm_s: pair[1] };
            events.push(PathEvent { s_mm: *s_mm, action });
        }
    }
    events.sort_by(|a, b| a.s_mm.total_cmp(&b.s_mm));
    if events.len() > MAX_EVENTS {
        return Err(PathError::TooManyEvents {
            line,
            events: events.len(),
        });
    }
    Ok(events)
}
