//! Following a seam: centre, take down, step along the tangent, to the end of the seam.

use super::course::Local;
use super::search::places;
use super::{Cameras, Drawing, Foot, Rig, SeamPoint, SeamTeaching, Stance, View};
use crate::teach::TeachParameterError;
use nalgebra::Vector3;
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
    #[error(
        "no seam is seen within {search_mm} mm of X{x:.1} Y{y:.1} Z{z:.1}{other}: begin nearer to it (--from), or look \
         whether lights and cameras work"
    )]
    NotFound {
        /// How far was searched \[mm\].
        search_mm: f64,
        /// Tip \[mm\].
        x: f64,
        /// Tip \[mm\].
        y: f64,
        /// Tip \[mm\].
        z: f64,
        /// What is seen of the other side.
        other: &'static str,
    },
}

/// A place where both seams are seen, in the middle of their bands as far as it goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Centred {
    /// Where the machine stood.
    pub stance: Stance,
    /// What it saw there.
    pub feet: [Foot; SIDES],
}

/// Takes down what is seen `here`.
pub(super) fn take<R: Rig>(rig: &mut R, points: &mut Vec<SeamPoint>, here: &Centred) -> Result<(), R::Error> {
    let point = SeamPoint::after(points.last(), here.feet);
    rig.taught(&point)?;
    points.push(point);
    Ok(())
}

/// Teaches by following.
#[derive(Clone, Copy, Debug)]
pub struct Follower<'a> {
    cameras: &'a Cameras,
    config: &'a SeamTeaching,
    drawing: Option<Drawing>,
}

impl<'a> Follower<'a> {
    /// Checks the settings.
    pub fn build(
        cameras: &'a Cameras,
        config: &'a SeamTeaching,
        drawing: Option<Drawing>,
    ) -> Result<Self, TeachParameterError> {
        config.check()?;
        Ok(Self {
            cameras,
            config,
            drawing,
        })
    }

    /// Teaches from `start` on, or goes on after the `points` that are taught already. New points are given to the
    /// rig one by one; the machine stands at the last of them.
    pub fn teach<R: Rig>(
        &self,
        rig: &mut R,
        start: &Stance,
        points: &[SeamPoint],
    ) -> Result<Ended, SeamTeachError<R::Error>> {
        let mut points = points.to_vec();
        let start = self.start(start, &points);
        rig.approach(&start)?;
        let mut here = self.find(rig, &start)?;
        if points.is_empty() {
            here = self.begin_as_drawn(rig, here)?;
            take(rig, &mut points, &here)?;
        }
        let mut before: Option<f64> = None;
        loop {
            if rig.enough() {
                return Ok(Ended::Operator);
            }
            let missing_mm = self.missing(&points);
            if missing_mm.is_some_and(|missing| missing <= SAME_PLACE) {
                return Ok(Ended::Drawn);
            }
            let at = points.last().map_or(0.0, |last| last.s_mm);
            let Some(next) = self.advance(rig, &here.stance, &points, before, missing_mm)? else {
                return Ok(Ended::SeamEnds { s_mm: at, missing_mm });
            };
            here = next;
            take(rig, &mut points, &here)?;
            before = points.last().map(|last| last.s_mm - at);
        }
    }

    /// Looks until both sides are seen, a few times.
    pub(super) fn look<R: Rig>(&self, rig: &mut R) -> Result<View, R::Error> {
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
    fn sure(&self, mut view: View) -> View {
        for side in &mut view.sides {
            *side = side.filter(|seen| seen.quality >= self.config.least_quality);
        }
        view
    }

    pub(super) fn feet(&self, view: &View) -> [Option<Foot>; SIDES] {
        std::array::from_fn(|k| view.sides[k].map(|seen| self.cameras.foot(view, k, &seen)))
    }

    /// Whether both seams are in the middle of their bands.
    fn is_centred(&self, view: &View) -> bool {
        let far = |offset: &f64| offset.abs() > self.config.centred_mm;
        view.sides
            .iter()
            .all(|side| side.is_some_and(|seen| !seen.offset_mm.iter().any(far)))
    }

    /// Centres what is seen until both seams are in the middle; `None` if one side is never seen.
    pub(super) fn centre<R: Rig>(&self, rig: &mut R, stance: &Stance) -> Result<Option<Centred>, R::Error> {
        let mut stance = *stance;
        let mut centred = None;
        for _ in 0..MOVES {
            let view = self.look(rig)?;
            let feet = self.feet(&view);
            if let [Some(first), Some(second)] = feet {
                let feet = [first, second];
                centred = Some(Centred { stance, feet });
            }
            if self.is_centred(&view) || feet.iter().all(Option::is_none) {
                break;
            }
            let normal = feet.iter().flatten().map(|foot| foot.normal).sum();
            let places = feet.map(|foot| foot.map(|foot| foot.position));
            stance = self.cameras.centred(&stance, &normal, places);
            rig.go(&stance)?;
        }
        Ok(centred)
    }

    /// Centres the seams at `stance`, where the machine stands, after a search if they are not seen.
    pub(super) fn find<R: Rig>(
        &self,
        rig: &mut R,
        stance: &Stance,
    ) -> Result<Centred, SeamTeachError<R::Error>> {
        if let Some(centred) = self.centre(rig, stance)? {
            return Ok(centred);
        }
        let Pose {
            position,
            tangent,
            normal,
        } = stance.pose;
        let across = normal.cross(&tangent);
        let mut found = [None; SIDES];
        for [x, y] in places(self.config) {
            let mut there = *stance;
            there.pose.position = position + across * x + normal * y;
            rig.go(&there)?;
            let view = self.sure(rig.look(self.config.pictures)?);
            for (known, seen) in found.iter_mut().zip(self.feet(&view)) {
                *known = known.or(seen.map(|foot| foot.position));
            }
            if found.iter().all(Option::is_some) {
                let stance = self.cameras.centred(stance, &normal, found);
                rig.go(&stance)?;
                if let Some(centred) = self.centre(rig, &stance)? {
                    return Ok(centred);
                }
            }
        }
        Err(SeamTeachError::NotFound {
            search_mm: self.config.search_mm,
            x: position.x,
            y: position.y,
            z: position.z,
            other: match found {
                [Some(_), None] => ", on side 2 (side 1 is seen)",
                [None, Some(_)] => ", on side 1 (side 2 is seen)",
                _ => "",
            },
        })
    }

    /// Goes along the seam to where the drawing begins, if that is near.
    fn begin_as_drawn<R: Rig>(
        &self,
        rig: &mut R,
        here: Centred,
    ) -> Result<Centred, SeamTeachError<R::Error>> {
        let Some(Drawing {
            begin: (at, along), ..
        }) = self.drawing
        else {
            return Ok(here);
        };
        let stance = here.stance;
        let tangent = stance.pose.tangent;
        let looks_at = stance.pose.position + tangent * self.cameras.heads.camera_lead();
        let away = (at - looks_at).dot(&along) / tangent.dot(&along);
        if away.abs() < SAME_PLACE || away.abs() > self.config.search_mm {
            return Ok(here);
        }
        let mut there = stance;
        there.pose.position += tangent * away;
        rig.go(&there)?;
        self.find(rig, &there)
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

    fn local(points: &[SeamPoint], stance: &Stance) -> Option<Local> {
        let middles: Vec<Vector3<f64>> = points.iter().map(SeamPoint::middle).collect();
        Local::of(&middles, &stance.pose.tangent)
    }

    /// Goes on to the next point, as far as the course so far allows and nearer if the seam bends more than was
    /// foreseen. `None` where the seam ends.
    fn advance<R: Rig>(
        &self,
        rig: &mut R,
        stance: &Stance,
        points: &[SeamPoint],
        before: Option<f64>,
        missing_mm: Option<f64>,
    ) -> Result<Option<Centred>, R::Error> {
        let Some(local) = Self::local(points, stance) else {
            return Ok(None);
        };
        let smallest = self.config.smallest_step_mm;
        let mut step = local.step(self.config, before);
        if let Some(missing) = missing_mm {
            if step >= missing {
                step = missing;
            } else if step + smallest > missing {
                step = missing / 2.0;
            }
        }
        loop {
            let there = self.ahead(stance, &local, step);
            rig.go(&there)?;
            let Some(centred) = self.centre(rig, &there)? else {
                if step <= smallest {
                    return Ok(None);
                }
                step = (step / 2.0).max(smallest);
                continue;
            };
            let [first, second] = centred.feet.map(|foot| foot.position);
            let distance = local.chord_distance(step, &((first + second) / 2.0));
            if distance > self.config.chord_mm && step > smallest {
                let factor = 0.9 * libm::sqrt(self.config.chord_mm / distance);
                step = (step * factor.clamp(SHORTER[0], SHORTER[1])).max(smallest);
                continue;
            }
            return Ok(Some(centred));
        }
    }

    /// Where a step from the last of the `points` leads, `by` so much or by the spacing rule; `None` if there is no
    /// point yet.
    pub(super) fn stepped(&self, stance: &Stance, points: &[SeamPoint], by: Option<f64>) -> Option<Stance> {
        let local = Self::local(points, stance)?;
        let last = points.windows(2).last().map(|pair| pair[1].s_mm - pair[0].s_mm);
        let step = by.unwrap_or_else(|| local.step(self.config, last));
        Some(self.ahead(&self.start(stance, points), &local, step))
    }

    /// `stance`, which looks at the end of the course, moved to look `step` further on.
    fn ahead(&self, stance: &Stance, local: &Local, step: f64) -> Stance {
        let (at, tangent) = local.ahead(step);
        let old = stance.pose;
        // A course does not turn so much that the head would lie along it.
        let turned = Pose::new(old.position, tangent, old.normal).unwrap_or(old);
        // The tip stands beside the seams as before, and a lead behind.
        let beside = old.position - local.at;
        let (across, up) = (
            beside.dot(&old.normal.cross(&old.tangent)),
            beside.dot(&old.normal),
        );
        let position = at - turned.tangent * self.cameras.heads.camera_lead()
            + turned.normal.cross(&turned.tangent) * across
            + turned.normal * up;
        Stance {
            pose: Pose { position, ..turned },
            extension_mm: stance.extension_mm,
        }
    }

    /// The stance that looks at the last of the `points`; `start` if there is none.
    pub(super) fn start(&self, start: &Stance, points: &[SeamPoint]) -> Stance {
        let (Some(local), Some(last)) = (Self::local(points, start), points.last()) else {
            return *start;
        };
        let normal = last.feet[0].normal + last.feet[1].normal;
        let position = last.middle() - local.tangent * self.cameras.heads.camera_lead();
        let there = Stance {
            pose: Pose::new(position, local.tangent, normal).unwrap_or(start.pose),
            extension_mm: [0.0; SIDES],
        };
        let places = last.feet.map(|foot| Some(foot.position));
        self.cameras.centred(&there, &normal, places)
    }
}
