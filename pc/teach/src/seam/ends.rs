//! Where the seams begin and end: seen by the cameras beside the last place where both seams are, and come near to until it is
//! seen well.

use super::follow::{Centred, Follower, SAME_PLACE};
use super::{CameraMachine, MachinePose, SeamEnd, SeamPoint, SeamTeachError, View};
use nalgebra::Vector3;
use shared::io::SIDES;

/// How far along the drawing a seam that is not seen where it is drawn to begin is looked for, before it is searched beside it
/// \[mm\].
const AHEAD: [f64; 5] = [1.0, 2.0, 4.0, 8.0, 16.0];
/// An end is looked for until the machine stands so near to it \[mm\]: then the smallest picture shows it.
const NEAR: f64 = 0.2;
/// The machine stands so far before an end to see it well, and so much nearer or farther \[mm\]: plates that end within 0.2 mm of the
/// band make its height uncertain.
const STAND_OFF: f64 = 0.25;
const STAND_OFF_WITHIN: f64 = 0.1;
/// Moves to stand there.
const MOVES: usize = 4;
/// An end that is seen from two places is at one \[mm\]; what is seen elsewhere moves with the camera.
const STAYS: f64 = 0.1;

/// Which end of a seam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Behind,
    Ahead,
}

impl Way {
    fn sign(self) -> f64 {
        match self {
            Self::Behind => -1.0,
            Self::Ahead => 1.0,
        }
    }
}

/// An end of a seam in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SeenEnd {
    /// What it is.
    pub end: SeamEnd,
    /// Where \[mm\].
    pub position: Vector3<f64>,
}

impl Centred {
    /// Ends of both seams.
    fn ends(&self, way: Way) -> [Option<SeenEnd>; SIDES] {
        self.ends.map(|ends| ends[way as usize])
    }

    /// How far the nearest end is from where the cameras look, along the way \[mm\].
    fn end_distance(&self, way: Way) -> Option<f64> {
        let tangent = self.machine_pose.pose.tangent;
        let ends = self.ends(way).into_iter().zip(self.feet);
        let distances =
            ends.filter_map(|(end, foot)| Some((end?.position - foot.position).dot(&tangent) * way.sign()));
        distances.min_by(f64::total_cmp)
    }

    /// Both seams where the first of them ends: each in its own end, if that is seen, or beside that of the other.
    fn at_end(&self, way: Way) -> Option<Self> {
        let tangent = self.machine_pose.pose.tangent;
        let distance = self.end_distance(way)? * way.sign();
        let mut there = *self;
        for (foot, end) in there.feet.iter_mut().zip(self.ends(way)) {
            match end {
                Some(end) => (foot.position, foot.end) = (end.position, Some(end.end)),
                None => foot.position += tangent * distance,
            }
        }
        Some(there)
    }
}

impl Follower<'_> {
    /// Ends of the seams in a view.
    pub(super) fn ends(&self, view: &View) -> [[Option<SeenEnd>; 2]; SIDES] {
        std::array::from_fn(|side| {
            let ends = view.sides[side].map_or([None; 2], |seen| seen.ends);
            ends.map(|seen| {
                let seen = seen?;
                Some(SeenEnd {
                    end: seen.end,
                    position: self.cameras.end(view, side, &seen),
                })
            })
        })
    }

    /// Centres both seams at `start`. Where they are not seen it is looked for them along the drawing, as they may begin later, and
    /// after that around the start.
    pub(super) fn find_ahead<R: CameraMachine>(
        &self,
        rig: &mut R,
        start: &MachinePose,
    ) -> Result<Centred, SeamTeachError<R::Error>> {
        if let Some(here) = self.centre(rig, start)?.both() {
            return Ok(here);
        }
        let ahead: &[f64] = if self.drawing.is_some() { &AHEAD } else { &[] };
        for way in ahead {
            let there = moved(start, *way);
            rig.go(&there)?;
            if let Some(here) = self.centre(rig, &there)?.both() {
                return Ok(here);
            }
        }
        rig.go(start)?;
        self.find(rig, start)
    }

    /// Goes along the seam to where the drawing begins, if that is near, or to where the seams begin after that: then they are taken
    /// down there.
    pub(super) fn begin<R: CameraMachine>(
        &self,
        rig: &mut R,
        here: Centred,
    ) -> Result<Centred, SeamTeachError<R::Error>> {
        let Some((at, along)) = self.drawing.map(|drawing| drawing.begin) else {
            return Ok(here);
        };
        let machine_pose = here.machine_pose;
        let tangent = machine_pose.pose.tangent;
        let [first, second] = [0, 1].map(|side| self.cameras.looks_at(&machine_pose, side));
        let away = (at - (first + second) / 2.0).dot(&along) / tangent.dot(&along);
        let reach = self.config.search_mm.max(AHEAD[AHEAD.len() - 1] + SAME_PLACE);
        if away.abs() < SAME_PLACE || away.abs() > reach {
            return Ok(here);
        }
        let there = moved(&machine_pose, away);
        rig.go(&there)?;
        if let Some(begin) = self.centre(rig, &there)?.both() {
            return Ok(begin);
        }
        if away < 0.0 {
            let near = self.bisect(rig, here, -away, Way::Behind)?;
            if let Some(begin) = self.stand_at_end(rig, near, Way::Behind)? {
                return Ok(begin);
            }
            rig.go(&there)?;
        }
        self.find(rig, &there)
    }

    /// Both seams where they end, beyond `here` by no more than the smallest step; none if no end is seen there, or the last of the
    /// `points` is at it.
    pub(super) fn last<R: CameraMachine>(
        &self,
        rig: &mut R,
        here: Centred,
        points: &[SeamPoint],
    ) -> Result<Option<Centred>, R::Error> {
        rig.go(&here.machine_pose)?;
        let Some(here) = self.centre(rig, &here.machine_pose)?.both() else {
            return Ok(None);
        };
        let near = self.bisect(rig, here, self.config.smallest_step_mm, Way::Ahead)?;
        let last = self.stand_at_end(rig, near, Way::Ahead)?;
        Ok(last.filter(|last| {
            let tangent = last.machine_pose.pose.tangent;
            points.last().is_none_or(|before| {
                let ahead = |k: usize| (last.feet[k].position - before.feet[k].position).dot(&tangent);
                ahead(0) > SAME_PLACE && ahead(1) > SAME_PLACE
            })
        }))
    }

    /// Goes on to where an end is seen, between `here`, where both seams are seen, and `beyond` mm further, where they are not.
    fn bisect<R: CameraMachine>(
        &self,
        rig: &mut R,
        mut here: Centred,
        mut beyond: f64,
        way: Way,
    ) -> Result<Centred, R::Error> {
        while here.end_distance(way).is_none() && beyond > NEAR {
            beyond /= 2.0;
            let there = moved(&here.machine_pose, way.sign() * beyond);
            rig.go(&there)?;
            if let Some(nearer) = self.centre(rig, &there)?.both() {
                here = nearer;
            }
        }
        if here.end_distance(way).is_some() {
            return Ok(here);
        }
        // Perhaps it is too near.
        let there = moved(&here.machine_pose, -way.sign() * STAND_OFF);
        rig.go(&there)?;
        Ok(self.centre(rig, &there)?.both().unwrap_or(here))
    }

    /// Stands before the end that is seen from `near`, where it is seen best; both seams at that end. None if there it is not where it
    /// was seen before.
    fn stand_at_end<R: CameraMachine>(
        &self,
        rig: &mut R,
        near: Centred,
        way: Way,
    ) -> Result<Option<Centred>, R::Error> {
        let mut here = near;
        for _ in 0..MOVES {
            let Some(distance) = here.end_distance(way) else {
                return Ok(None);
            };
            let off = distance - STAND_OFF;
            let there = moved(&here.machine_pose, way.sign() * off);
            let before = here.ends(way);
            rig.go(&there)?;
            let Some(now) = self.centre(rig, &there)?.both() else {
                return Ok(None);
            };
            here = now;
            let tangent = here.machine_pose.pose.tangent;
            let stays = |(before, now): (Option<SeenEnd>, Option<SeenEnd>)| match (before, now) {
                (Some(before), Some(now)) => {
                    before.end == now.end && (now.position - before.position).dot(&tangent).abs() < STAYS
                }
                _ => false,
            };
            let confirmed = before.into_iter().zip(here.ends(way)).any(stays);
            if confirmed && off.abs() < STAND_OFF_WITHIN {
                return Ok(here.at_end(way));
            }
        }
        Ok(None)
    }
}

/// The machine `by` mm further along its tangent.
fn moved(machine_pose: &MachinePose, by: f64) -> MachinePose {
    let mut there = *machine_pose;
    there.pose.position += there.pose.tangent * by;
    there
}
