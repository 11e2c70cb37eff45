//! Following a seam: centre, record the point, step along the tangent, to the end of the seam.

use super::course::Course;
use super::ends::SeenEnd;
use super::{
    CameraMachine, Cameras, Drawing, MachinePose, MeasuredSeam, NotFound, SeamEnd, SeamPoint, SeamTeaching,
    View,
};
use config::RangeError;
use shared::geometry::Pose;
use shared::io::SIDES;
use std::error::Error as StdError;
use thiserror::Error;

/// Looks at a place before it counts as one where nothing is seen: pictures get lost.
const LOOKS: usize = 3;
/// Moves to bring both seams to the middle of their bands.
const MOVES: usize = 6;
/// A step is shortened to between these parts of it.
const SHORTER: [f64; 2] = [0.25, 0.75];
/// What is nearer is the same place \[mm\].
pub(super) const SAME_PLACE: f64 = 0.05;

/// Why there are no more points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ended {
    /// The seam is taught as far as it is drawn.
    Drawn,
    /// Neither seam, or only one, is seen any more.
    SeamEnds {
        /// Taught so far \[mm\].
        s_mm: f64,
        /// Still to come by the drawing \[mm\].
        missing_mm: Option<f64>,
        /// Which side is seen further on, if one is.
        seen: [bool; SIDES],
        /// What is seen to end each of them there; the last point is that end then.
        ends: [Option<SeamEnd>; SIDES],
    },
    /// The operator said so.
    Operator,
}

/// Why nothing can be taught. Reads as one sentence.
#[derive(Debug, Error)]
pub enum SeamTeachError<E: StdError + 'static> {
    /// The machine does not do what it is asked.
    #[error(transparent)]
    Machine(#[from] E),
    /// There is no seam where there should be one.
    #[error(transparent)]
    NotFound(NotFound),
}

/// A place where both seams are seen, in the middle of their bands as far as it goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Centred {
    /// Where the machine stood.
    pub machine_pose: MachinePose,
    /// What it saw there.
    pub feet: [MeasuredSeam; SIDES],
    /// Where each of them ends in the pictures, behind that place and ahead of it.
    pub ends: [[Option<SeenEnd>; 2]; SIDES],
}

/// What both cameras measure at one pose of the machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeamView {
    /// Where it stands.
    pub machine_pose: MachinePose,
    /// What it sees there.
    pub feet: [Option<MeasuredSeam>; SIDES],
    /// Where each seam ends in the pictures, behind that place and ahead of it.
    pub ends: [[Option<SeenEnd>; 2]; SIDES],
}

impl SeamView {
    /// If it is both seams.
    pub fn both(&self) -> Option<Centred> {
        let [Some(first), Some(second)] = self.feet else {
            return None;
        };
        Some(Centred {
            machine_pose: self.machine_pose,
            feet: [first, second],
            ends: self.ends,
        })
    }
}

/// Takes down what is seen `here`.
pub(super) fn take<R: CameraMachine>(
    rig: &mut R,
    points: &mut Vec<SeamPoint>,
    here: &Centred,
) -> Result<(), R::Error> {
    let point = SeamPoint::after(points.last(), here.feet);
    rig.taught(&point)?;
    points.push(point);
    Ok(())
}

/// Distance of the last two points \[mm\].
fn last_step(points: &[SeamPoint]) -> Option<f64> {
    let pair = points.windows(2).last()?;
    Some(pair[1].s_mm - pair[0].s_mm)
}

/// Teaches by following.
#[derive(Clone, Copy, Debug)]
pub struct Follower<'a> {
    pub(super) cameras: &'a Cameras,
    pub(super) config: &'a SeamTeaching,
    pub(super) drawing: Option<Drawing>,
}

impl<'a> Follower<'a> {
    /// Checks the settings.
    pub fn build(
        cameras: &'a Cameras,
        config: &'a SeamTeaching,
        drawing: Option<Drawing>,
    ) -> Result<Self, RangeError> {
        config.check()?;
        Ok(Self {
            cameras,
            config,
            drawing,
        })
    }

    /// Teaches from `start` on, or continues after the `points` that are taught already. New points are given
    /// to the rig one by one; the machine stands at the last of them.
    pub fn teach<R: CameraMachine>(
        &self,
        rig: &mut R,
        start: &MachinePose,
        points: &[SeamPoint],
    ) -> Result<Ended, SeamTeachError<R::Error>> {
        let mut points = points.to_vec();
        let start = self.start(start, &points);
        rig.approach(&start)?;
        let mut here = if points.is_empty() {
            let here = self.find_ahead(rig, &start)?;
            let begin = self.begin(rig, here)?;
            take(rig, &mut points, &begin)?;
            begin
        } else {
            self.find(rig, &start)?
        };
        let mut before = last_step(&points);
        loop {
            if rig.enough() {
                return Ok(Ended::Operator);
            }
            let missing_mm = self.missing(&points);
            if missing_mm.is_some_and(|missing| missing <= SAME_PLACE) {
                return Ok(Ended::Drawn);
            }
            let at = points.last().map_or(0.0, |last| last.s_mm);
            here = match self.advance(rig, &here.machine_pose, &points, before, missing_mm)? {
                Ok(next) => next,
                Err(seen) => {
                    let last = self.last(rig, here, &points)?;
                    if let Some(last) = &last {
                        take(rig, &mut points, last)?;
                    }
                    return Ok(Ended::SeamEnds {
                        s_mm: points.last().map_or(at, |last| last.s_mm),
                        missing_mm: self.missing(&points),
                        seen,
                        ends: last.map_or([None; SIDES], |last| last.feet.map(|foot| foot.end)),
                    });
                }
            };
            take(rig, &mut points, &here)?;
            before = last_step(&points);
        }
    }

    /// Looks until both sides are seen, a few times.
    pub(super) fn look<R: CameraMachine>(&self, rig: &mut R) -> Result<View, R::Error> {
        let mut view = self.sure(rig.look(self.config.pictures)?);
        for _ in 1..LOOKS {
            if view.sides.iter().all(Option::is_some) {
                break;
            }
            let again = self.sure(rig.look(self.config.pictures)?);
            if again.sides.iter().flatten().count() >= view.sides.iter().flatten().count() {
                view = again;
            }
        }
        Ok(view)
    }

    /// What is seen surely.
    pub(super) fn sure(&self, mut view: View) -> View {
        for side in &mut view.sides {
            *side = side.filter(|seen| seen.quality >= self.config.least_quality);
        }
        view
    }

    pub(super) fn feet(&self, view: &View) -> [Option<MeasuredSeam>; SIDES] {
        std::array::from_fn(|k| view.sides[k].map(|seen| self.cameras.foot(view, k, &seen)))
    }

    /// Whether both seams are in the middle of their bands.
    fn is_centred(&self, view: &View) -> bool {
        let far = |offset: &f64| offset.abs() > self.config.centred_mm;
        view.sides
            .iter()
            .all(|side| side.is_some_and(|seen| !seen.offset_mm.iter().any(far)))
    }

    /// Brings both seams to the middle of their bands, as long as both are seen; what is seen at last.
    pub(super) fn centre<R: CameraMachine>(
        &self,
        rig: &mut R,
        machine_pose: &MachinePose,
    ) -> Result<SeamView, R::Error> {
        let mut machine_pose = *machine_pose;
        let mut before: Option<SeamView> = None;
        for _ in 0..MOVES {
            let view = self.look(rig)?;
            let sight = SeamView {
                machine_pose,
                feet: self.feet(&view),
                ends: self.ends(&view),
            };
            let Some(Centred { feet, .. }) = sight.both() else {
                return Ok(before.unwrap_or(sight));
            };
            before = Some(sight);
            if self.is_centred(&view) {
                break;
            }
            let normal = feet[0].normal + feet[1].normal;
            machine_pose = self
                .cameras
                .aimed(&machine_pose, &normal, feet.map(|foot| foot.position));
            rig.go(&machine_pose)?;
        }
        let nothing = SeamView {
            machine_pose,
            feet: [None; SIDES],
            ends: [[None; 2]; SIDES],
        };
        Ok(before.unwrap_or(nothing))
    }

    /// Length that the drawing has after the last of the `points` \[mm\].
    fn missing(&self, points: &[SeamPoint]) -> Option<f64> {
        let (drawing, last) = (self.drawing?, points.last()?);
        let (at, along) = drawing.end;
        // Far from its end a bent seam may lead in any direction.
        Some(if last.s_mm < drawing.length_mm / 2.0 {
            drawing.length_mm - last.s_mm
        } else {
            (at - last.middle()).dot(&along)
        })
    }

    fn course(points: &[SeamPoint], machine_pose: &MachinePose) -> Option<Course> {
        Course::of(points, &machine_pose.pose.tangent)
    }

    /// Goes on to the next point, as far as the course so far allows and nearer if the seam bends more than was
    /// foreseen. Where the seams end: which of them is seen further on.
    fn advance<R: CameraMachine>(
        &self,
        rig: &mut R,
        machine_pose: &MachinePose,
        points: &[SeamPoint],
        before: Option<f64>,
        missing_mm: Option<f64>,
    ) -> Result<Result<Centred, [bool; SIDES]>, R::Error> {
        let (Some(course), Some(last)) = (Self::course(points, machine_pose), points.last()) else {
            return Ok(Err([false; SIDES]));
        };
        let smallest = self.config.smallest_step_mm;
        let mut step = course.step(self.config, before);
        if let Some(missing) = missing_mm {
            if step >= missing {
                step = missing;
            } else if 2.0 * step > missing {
                // The last two of the same length: short ones show the direction badly.
                step = missing / 2.0;
            }
        }
        loop {
            let there = self.ahead(machine_pose, &course, last, step);
            rig.go(&there)?;
            let sight = self.centre(rig, &there)?;
            let Some(centred) = sight.both() else {
                if step <= smallest {
                    return Ok(Err(sight.feet.map(|foot| foot.is_some())));
                }
                step = (step / 2.0).max(smallest);
                continue;
            };
            let distance = course.chord_distance(step, &centred.feet);
            if distance > self.config.chord_mm && step > smallest {
                let factor = 0.9 * libm::sqrt(self.config.chord_mm / distance);
                step = (step * factor.clamp(SHORTER[0], SHORTER[1])).max(smallest);
                continue;
            }
            return Ok(Ok(centred));
        }
    }

    /// Where a step from the last of the `points` leads, `by` so much or by the spacing rule; `None` if there is no
    /// point yet.
    pub(super) fn stepped(
        &self,
        machine_pose: &MachinePose,
        points: &[SeamPoint],
        by: Option<f64>,
    ) -> Option<MachinePose> {
        let course = Self::course(points, machine_pose)?;
        let step = by.unwrap_or_else(|| course.step(self.config, last_step(points)));
        Some(self.ahead(machine_pose, &course, points.last()?, step))
    }

    /// The pose of the machine that looks where the course leads, `step` \[mm\] after its `last` point, with
    /// the head along the skin there; it stands as `machine_pose` does where that is not possible.
    fn ahead(&self, machine_pose: &MachinePose, course: &Course, last: &SeamPoint, step: f64) -> MachinePose {
        let (points, tangent) = course.ahead(step);
        let old = machine_pose.pose;
        let position = (points[0] + points[1]) / 2.0 - tangent * self.cameras.heads.camera_lead();
        // A course does not turn so much that the head would lie along it.
        let pose = Pose::new(position, tangent, old.normal).unwrap_or(old);
        let normal = last.feet[0].normal + last.feet[1].normal;
        self.cameras.centred(&pose, &normal, points)
    }

    /// The pose of the machine that looks at the last of the `points`; `start` if there is none.
    pub(super) fn start(&self, start: &MachinePose, points: &[SeamPoint]) -> MachinePose {
        match (Self::course(points, start), points.last()) {
            (Some(course), Some(last)) => self.ahead(start, &course, last, 0.0),
            _ => *start,
        }
    }
}
