//! From one path of a program to what the boards run: its curves, timed and checked, and where the machine then
//! stands.

use super::blocks::Moves;
use super::exact::Piece;
use super::feeds::Feeds;
use super::limits::{Demand, axes_at};
use super::outputs::{Switched, Switching, on_the_way};
use super::shape::{Goal, Shape, channels};
use super::targets::{ROTARY, RestState};
use super::too_fast::unit;
use super::{CAPACITY, NOWHERE, PathError, PlannedPath, Planner, Tip, TooFast};
use nc::{Blend, Motion, PathControl, ProgramPath, SourcePosition, Target, Way};
use shared::io::{AXES, SIDES};
use shared::kinematics::AXIS_UNIT;
use shared::protocol::{PathAction, PathEvent};
use shared::trajectory::PathSpace;
use std::sync::Arc;

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
        stand: &mut RestState,
        speed_mm_s: Option<f64>,
    ) -> Result<Vec<PlannedPath>, PathError> {
        // What an operator wants of a weld is nothing for a probe or a tap.
        let speed_mm_s = speed_mm_s.filter(|_| path.probe.is_none() && !path.fixed_feed);
        let joined;
        let path = if path.motion == Motion::Feed && (self.tracks || path.rest.is_none()) {
            joined = self.without_short_blocks(path.whole()?, stand)?;
            &joined
        } else {
            path
        };
        let events = self.switchings(&path.events)?;
        let axes = path.targets.first().filter(|target| target.way == Way::Axes);
        let mut planned = match (path.motion, axes) {
            (Motion::Stand, _) => vec![self.stand(path, &events, stand)?],
            (_, Some(target)) => vec![self.axes_motion(target, &events, stand)?],
            _ => self.tip_motion(path, &events, stand, speed_mm_s)?,
        };
        self.check_inputs(&path.waits_before)?;
        planned[0].probe = path.probe;
        planned
            .iter_mut()
            .for_each(|planned| planned.fixed_feed = path.fixed_feed);
        planned[0].waits_before = path.waits_before.clone();
        planned[0].dwell_before_s = path.dwell_before_s;
        Ok(planned)
    }

    /// A rapid on the straight line of axis space (mm, rad), V slides standing at `extension`.
    pub(super) fn axes_path(
        &self,
        from: &[f64; AXES],
        to: &[f64; AXES],
        extension: &[f64; SIDES],
        place: SourcePosition,
    ) -> Result<PlannedPath, PathError> {
        let shape = Shape::of_axes(from, to, extension, place);
        let mut planned = PlannedPath::untimed(&shape, PathSpace::Axes, Motion::Rapid);
        let demands = self.demands(&planned, &shape, from)?;
        self.check_travel(&demands, &shape)?;
        planned.limits = self.rapid_limits(&demands);
        Ok(planned)
    }

    /// No motion: what is switched takes effect as the machine stands.
    fn stand(
        &self,
        path: &ProgramPath,
        events: &[Switching],
        stand: &mut RestState,
    ) -> Result<PlannedPath, PathError> {
        let switched = path.events.first().map(|event| event.place);
        let place = switched.or(path.waits_before.first().map(|wait| wait.place));
        let place = place.unwrap_or(NOWHERE);
        let (events, steps) = on_the_way(&stand.switched, events, 0, &[0.0], &[], place)?;
        // In axis space boards open no gates; in that of the tool they do not stand where axes have led it beyond a pole.
        let opens = |event: &PathEvent| {
            matches!(
                event.action,
                PathAction::Beam { on: true, .. } | PathAction::Tracking { on: true }
            )
        };
        let extension_mm = &stand.tip.extension_mm;
        let (shape, space) = if events.iter().any(opens) {
            let pose = self.kinematics.forward(&stand.axes);
            (
                Shape::standing(channels(&pose, extension_mm), place),
                PathSpace::Tool,
            )
        } else {
            (
                Shape::of_axes(&stand.axes, &stand.axes, extension_mm, place),
                PathSpace::Axes,
            )
        };
        let mut planned = PlannedPath::untimed(&shape, space, Motion::Stand);
        let demands = self.demands(&planned, &shape, &stand.axes)?;
        planned.limits = self.rapid_limits(&demands);
        (planned.events, planned.steps) = (events, steps);
        stand.switched.take_up(&planned.events);
        Ok(planned)
    }

    /// G53 G0.
    fn axes_motion(
        &self,
        target: &Target,
        events: &[Switching],
        stand: &mut RestState,
    ) -> Result<PlannedPath, PathError> {
        let to = self.axes_target(target, stand)?;
        let extension_mm = stand.tip.extension_mm;
        let mut planned = self.axes_path(&stand.axes, &to, &extension_mm, target.place)?;
        (planned.events, planned.steps) =
            on_the_way(&Switched::default(), events, 0, &[0.0], &[], target.place)?;
        stand.switched.take_up(&planned.events);
        stand.switched.rapid();
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
        events: &[Switching],
        stand: &mut RestState,
        speed_mm_s: Option<f64>,
    ) -> Result<Vec<PlannedPath>, PathError> {
        if path.motion == Motion::Feed && !self.tracks && !self.is_smooth(path, stand)? {
            let path = Arc::new(path.clone());
            let again = move || -> Moves { Box::new(path.moves().map(|next| next.map_err(PathError::from))) };
            return Ok(vec![self.exact_path(Arc::new(again), stand, speed_mm_s)?]);
        }
        let tips = self.tips(path, stand)?;
        let feeds = Feeds::of(path, speed_mm_s)?;
        let pieces = self.pieces(path, &tips, &stand.tip, &feeds)?;
        let mut paths = Vec::with_capacity(pieces.len());
        for piece in &pieces {
            paths.push(self.piece(path.motion, events, piece, &tips, stand)?);
        }
        Ok(paths)
    }

    /// Whether a path is one smooth curve through its points: straight blocks with G64 alone, no more of them than a
    /// board holds knots, and no corner.
    pub(super) fn is_smooth(&self, path: &ProgramPath, from: &RestState) -> Result<bool, PathError> {
        let targets = &path.targets;
        let asked = |target: &Target| {
            target.way == Way::Line && target.control == PathControl::Blend(Blend::default())
        };
        if path.rest.is_some() || targets.len() < 2 || targets.len() >= CAPACITY || !targets.iter().all(asked)
        {
            return Ok(false);
        }
        let tips = self.tips(path, from)?;
        match self.smooth(&from.tip, &tips, targets) {
            Ok(_) => Ok(true),
            Err(PathError::Corner { .. } | PathError::NoTravel { .. }) => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// The curves of a path of the tip. It stops where the program says so with G61.1.
    fn pieces(
        &self,
        path: &ProgramPath,
        tips: &[Tip],
        from: &Tip,
        feeds: &Feeds,
    ) -> Result<Vec<Piece>, PathError> {
        let mut pieces = Vec::new();
        let mut first: usize = 0;
        for targets in path
            .targets
            .split_inclusive(|target| target.control == PathControl::ExactStop)
        {
            let from = first.checked_sub(1).map_or(from, |before| &tips[before]);
            let tips = &tips[first..first + targets.len()];
            let more = self.without_stop(path.motion, from, tips, targets, feeds)?;
            pieces.extend(more.into_iter().map(|piece| Piece {
                first: first + piece.first,
                ..piece
            }));
            first += targets.len();
        }
        Ok(pieces)
    }

    /// The curves of targets that need no stop but for corners: a spline through many straight blocks, where G64 allows it,
    /// or every block exactly.
    fn without_stop(
        &self,
        motion: Motion,
        from: &Tip,
        tips: &[Tip],
        targets: &[Target],
        feeds: &Feeds,
    ) -> Result<Vec<Piece>, PathError> {
        let straight = targets.iter().all(|target| target.way == Way::Line);
        let tolerance = blend_tolerance(targets);
        if !straight || targets.len() == 1 || tolerance == Some(0.0) {
            return self.exact(motion, from, tips, targets, feeds);
        }
        let shape = match (self.smooth(from, tips, targets), tolerance) {
            (Ok((_, off)), Some(tolerance)) if off > tolerance => None,
            (Err(PathError::Corner { .. }), Some(_)) | (Err(PathError::NoTravel { .. }), _) => None,
            (smooth, _) => Some(smooth?.0),
        };
        let Some(shape) = shape else {
            return self.exact(motion, from, tips, targets, feeds);
        };
        let ends = shape.targets.iter().map(|goal| goal.s);
        let lengths = shape
            .starts()
            .into_iter()
            .zip(ends)
            .map(|(start, end)| end - start);
        let speeds = targets
            .iter()
            .zip(lengths)
            .map(|(target, length)| feeds.speed(target, length))
            .collect::<Result<_, _>>()?;
        Ok(vec![Piece {
            shape,
            first: 0,
            speeds,
            corner: None,
            stands: false,
        }])
    }

    /// One curve, timed and checked; the machine then stands at its end.
    fn piece(
        &self,
        motion: Motion,
        events: &[Switching],
        piece: &Piece,
        tips: &[Tip],
        stand: &mut RestState,
    ) -> Result<PlannedPath, PathError> {
        let (shape, first) = (&piece.shape, piece.first);
        let place = shape.targets[0].place;
        if shape.knots.len() > CAPACITY {
            return Err(PathError::TooLong {
                place,
                knots: shape.knots.len(),
            });
        }
        let mut planned = PlannedPath::untimed(shape, PathSpace::Tool, motion);
        if motion == Motion::Rapid {
            planned.speed_error = 0.0;
        }
        planned.corner_deg = piece.corner.map(f64::to_degrees);
        let rapid = motion == Motion::Rapid;
        let on = if rapid {
            Switched::default()
        } else {
            stand.switched
        };
        let demands = self.demands(&planned, shape, &stand.axes)?;
        let speeds = match motion {
            Motion::Rapid | Motion::Stand => piece.speeds.clone(),
            Motion::Feed => self.reached(&demands, &piece.speeds),
        };
        (planned.events, planned.steps) = on_the_way(&on, events, first, &shape.starts(), &speeds, place)?;
        let mut stands = self.stands(&demands, shape, &tips[first..first + shape.targets.len()])?;
        self.check_travel(&demands, shape)?;
        planned.limits = match motion {
            Motion::Rapid | Motion::Stand => self.rapid_limits(&demands),
            Motion::Feed => self.feed_limits(&demands, shape, &speeds),
        };
        if motion == Motion::Feed {
            planned.too_fast = self.too_fast(&demands, piece, &planned.events)?;
        }
        planned.bound = match motion {
            Motion::Rapid | Motion::Stand => None,
            Motion::Feed => self.bound(&demands).filter(|_| !piece.stands),
        };
        stands.switched = stand.switched;
        stands.switched.take_up(&planned.events);
        if rapid {
            stands.switched.rapid();
        }
        *stand = stands;
        Ok(planned)
    }

    /// `speeds`, but none that the axes come to nowhere on the path \[mm/s\].
    fn reached(&self, demands: &[Demand], speeds: &[f64]) -> Vec<f64> {
        let fastest = demands.iter().map(|demand| self.fastest(demand));
        let fastest = fastest.fold(0.0, f64::max);
        speeds.iter().map(|speed| speed.min(fastest)).collect()
    }

    /// Where the axes do not allow the programmed speeds of `piece`, `events` switching beams on the way.
    fn too_fast(
        &self,
        demands: &[Demand],
        piece: &Piece,
        events: &[PathEvent],
    ) -> Result<TooFast, PathError> {
        let shape = &piece.shape;
        let unit = unit(piece.stands);
        let mut too_fast = TooFast::default();
        let mut switched = Switched::default();
        let mut events = events.iter().peekable();
        for demand in demands {
            while let Some(event) = events.next_if(|event| event.s_mm <= demand.s) {
                switched.switch(&event.action);
            }
            let target = shape.target(demand.s);
            let (feed, place) = ((piece.speeds[target], unit), shape.targets[target].place);
            self.see_feed(demand, feed, place, switched.works(), &mut too_fast);
        }
        too_fast.found()
    }

    /// Where the machine stands at the end. At every target the rotary axes must stand as it says, not a turn away;
    /// where its pose leaves an axis free, that stands as it was.
    fn stands(&self, demands: &[Demand], shape: &Shape, tips: &[Tip]) -> Result<RestState, PathError> {
        let mut stand = RestState {
            tip: Tip::default(),
            axes: [0.0; AXES],
            switched: Switched::default(),
        };
        for (tip, goal) in tips.iter().zip(&shape.targets) {
            let axes = axes_at(demands, goal.s);
            stand = RestState {
                tip: self.settled(tip, &axes, goal)?,
                axes,
                ..stand
            };
        }
        Ok(stand)
    }

    /// `tip` with its rotary axes where they come to stand, the axes standing at `axes`: as it says, but where its
    /// pose leaves an axis free.
    pub(super) fn settled(&self, tip: &Tip, axes: &[f64; AXES], goal: &Goal) -> Result<Tip, PathError> {
        let mut settled = *tip;
        // Where the tip forces one axis, others may follow; the largest difference is the cause.
        let mut worst = None;
        for axis in ROTARY.filter(|&axis| self.fitted[axis]) {
            let angle = &mut settled.angles_deg[axis - ROTARY.start];
            let reached = axes[axis].to_degrees();
            let off = (reached - *angle).abs();
            if off <= (SAME_ANGLE + goal.slack).to_degrees() {
                continue;
            }
            if self.leaves_free(tip, axes, axis) {
                *angle = reached;
            } else if worst.as_ref().is_none_or(|(largest, _)| off > *largest) {
                worst = Some((off, PathError::turned(goal.place, axis, *angle, reached)));
            }
        }
        worst.map_or(Ok(settled), |(_, error)| Err(error))
    }

    /// Whether the pose of `tip`, at which the axes stand at `axes`, leaves `axis` where it happens to be.
    fn leaves_free(&self, tip: &Tip, axes: &[f64; AXES], axis: usize) -> bool {
        let mut near = *axes;
        near[axis] += FREE;
        let seen = self.kinematics.inverse(&self.pose(tip), &near);
        seen.is_ok_and(|seen| (seen[axis] - axes[axis]).abs() > FREE / 2.0)
    }
}

/// The closest tolerance that the blocks ask for, 0 with G61; none where the best speed is all.
fn blend_tolerance(targets: &[Target]) -> Option<f64> {
    let tolerances = targets.iter().filter_map(|target| match target.control {
        PathControl::ExactPath => Some(0.0),
        PathControl::Blend(blend) => blend.tolerance,
        PathControl::ExactStop => None,
    });
    tolerances.min_by(f64::total_cmp)
}
