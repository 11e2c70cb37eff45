//! The seam of both sides: from measurements to where the slides should be.

use super::frames::{Heads, SpotFrame, meet};
use super::history::PathSnapshot;
use super::law::SlideTarget;
use super::map::{Added, Off, SeamMap};
use super::parameters::TrackerParameters;
use crate::geometry::{Pose, PoseOffset};
use crate::io::{SIDES, SLIDES};
use crate::protocol::SideMeasurement;
use crate::ticks::TRACKER_PERIOD_S;
use crate::trajectory::Path;

/// Index of the U slide of a side; its V slide is the next.
const fn u_slide(side: usize) -> usize {
    2 * side
}

/// Maps of the four channels, and counts of accepted and rejected measurements.
#[derive(Clone, Debug, Default)]
pub struct Seam {
    maps: [SeamMap; SLIDES],
    /// What the maps held before they locked on to the seam again: the spot has yet to pass that.
    before: [SeamMap; SLIDES],
    /// Where each slide last met the seam since tracking began \[mm\].
    met: [Option<f64>; SLIDES],
    accepted: [u32; SIDES],
    rejected: [u32; SIDES],
    implausible: [u32; SIDES],
}

/// Where a slide should be, as far as it is known from the seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SeamTarget {
    /// The seam, in the frame of the planned path.
    Seam(SlideTarget),
    /// The same, where the seam has just jumped to.
    Jump(SlideTarget),
    /// The seam was seen further ahead only: be where that is, so that the camera keeps it in sight.
    Ahead(SlideTarget),
    /// The seam was not seen, here or ahead: stay where it was met last, or follow the plan if it never was.
    Nowhere(Option<SlideTarget>),
    /// The beam is on, and the seam was seen, but for longer than the map reaches not any more.
    Lost,
}

impl Seam {
    /// Knows nothing.
    pub const fn new() -> Self {
        Self {
            maps: [const { SeamMap::new() }; SLIDES],
            before: [const { SeamMap::new() }; SLIDES],
            met: [None; SLIDES],
            accepted: [0; SIDES],
            rejected: [0; SIDES],
            implausible: [0; SIDES],
        }
    }

    /// Forgets the seam, for another path or a new run of the same.
    pub fn forget(&mut self) {
        let all = self.maps.iter_mut().chain(&mut self.before);
        all.for_each(SeamMap::clear);
        self.begin();
    }

    /// Tracking begins: until the seam comes into sight the plan is followed.
    pub fn begin(&mut self) {
        self.met = [None; SLIDES];
    }

    /// Measurements used and refused as outliers, per side.
    pub fn counters(&self) -> ([u32; SIDES], [u32; SIDES]) {
        (self.accepted, self.rejected)
    }

    /// Measurements that cannot be, per side.
    pub fn implausible(&self) -> [u32; SIDES] {
        self.implausible
    }

    /// Counts a measurement of `side` that cannot be.
    pub fn disbelieve(&mut self, side: usize) {
        self.implausible[side] = self.implausible[side].saturating_add(1);
    }

    /// Enters what the camera of `side` saw when the machine was in the state `snapshot` and the slides at
    /// `slides` \[mm\].
    pub fn add<const N: usize>(
        &mut self,
        parameters: &TrackerParameters,
        path: &Path<N>,
        side: usize,
        snapshot: &PathSnapshot,
        slides: &[f64; SLIDES],
        seen: &SideMeasurement,
    ) {
        let heads = &parameters.heads;
        let (u, v) = (u_slide(side), u_slide(side) + 1);
        if !parameters.accepts(side, slides, snapshot.speed, seen) {
            return self.disbelieve(side);
        }
        let spot = heads.spot(&snapshot.pose, side);
        let point = heads.seam_point(&spot, slides[u], slides[v], seen);
        let start = snapshot.s + heads.camera_lead() + seen.along_mm;
        let Some(meeting) = meet(&point, start, |s| planned_spot(heads, path, side, s)) else {
            self.rejected[side] = self.rejected[side].saturating_add(1);
            return;
        };
        // U is planned at zero.
        let planned = plan(parameters, path, meeting.sigma, 0.0).map_or(0.0, |plan| plan[v].position);
        if libm::fabs(meeting.u).max(libm::fabs(meeting.v - planned)) > parameters.plausible.deviation {
            return self.disbelieve(side);
        }
        let add = if snapshot.speed < 0.0 {
            SeamMap::add_going_back
        } else {
            SeamMap::add
        };
        let added = [(u, meeting.u), (v, meeting.v)].map(|(slide, y)| {
            let map = &mut self.maps[slide];
            let before = map.relocks().then(|| map.clone());
            let added = add(map, &parameters.map, meeting.sigma, y);
            if let (Added::Relocked, Some(before)) = (added, before) {
                self.before[slide] = before;
            }
            added
        });
        if added.contains(&Added::Outlier) {
            self.rejected[side] = self.rejected[side].saturating_add(1);
        } else if added != [Added::TooClose; 2] {
            self.accepted[side] = self.accepted[side].saturating_add(1);
        }
    }

    /// How far the spot of `slide`, which will be at `position` \[mm\] in the frame of the planned path, may be off the seam
    /// at path position `s` \[mm\], going there at `speed` \[mm/s\], by what was seen next to it. `None` where the seam begins ahead.
    pub fn off(
        &self,
        parameters: &TrackerParameters,
        slide: usize,
        (s, speed): (f64, f64),
        position: f64,
    ) -> Option<Off> {
        let usual = libm::fabs(speed) * f64::from(parameters.frame_ticks) * TRACKER_PERIOD_S;
        let (map, before) = (&self.maps[slide], &self.before[slide]);
        if map.begins_after(s) && !before.is_empty() {
            before.off(map, &parameters.map, usual, s, position)
        } else {
            map.off(&SeamMap::new(), &parameters.map, usual, s, position)
        }
    }

    /// Where `slide` should be when the machine is in the state `snapshot`.
    pub fn sight(
        &mut self,
        parameters: &TrackerParameters,
        slide: usize,
        snapshot: &PathSnapshot,
    ) -> SeamTarget {
        let (law, s, speed) = (&parameters.map, snapshot.s, snapshot.speed);
        let before = &mut self.before[slide];
        // It has jumped ahead, but not where the spot is.
        let behind = self.maps[slide].begins_after(s) && before.estimate(law, s).is_some();
        let jumps = !behind && !before.is_empty();
        if jumps {
            before.clear();
        }
        let map = if behind { before } else { &self.maps[slide] };
        if let Some(now) = map.estimate(law, s) {
            self.met[slide] = Some(now.value);
            let ahead = map.estimate(law, s + speed * parameters.preview);
            let target = SlideTarget::seam(now, ahead, speed);
            return if jumps {
                SeamTarget::Jump(target)
            } else {
                SeamTarget::Seam(target)
            };
        }
        // Back along the path after a hold, the map begins ahead.
        if snapshot.beams[slide / 2] && self.met[slide].is_some() && !map.begins_after(s) {
            return SeamTarget::Lost;
        }
        match map.next_after(law, s) {
            Some(position) => SeamTarget::Ahead(SlideTarget::rest(position)),
            None => SeamTarget::Nowhere(self.met[slide].map(SlideTarget::rest)),
        }
    }
}

/// Frame of the head of `side` on the planned path.
fn planned_spot<const N: usize>(heads: &Heads, path: &Path<N>, side: usize, s: f64) -> Option<SpotFrame> {
    let pose = path.at(s)?.pose().ok()?;
    Some(heads.spot(&pose, side))
}

/// Where the plan puts the slides at path position `s` \[mm\], moving at `speed` \[mm/s\]: U at zero, V where it
/// keeps the defocus (mathematics 0.6). Beyond its ends the path stands still.
pub fn plan<const N: usize>(
    parameters: &TrackerParameters,
    path: &Path<N>,
    s: f64,
    speed: f64,
) -> Option<[SlideTarget; SLIDES]> {
    let (start, end) = (path.start_s()?, path.end_s()?);
    let now = path.at(s.clamp(start, end))?.v_follow();
    let ahead = path.at((s + speed * parameters.preview).clamp(start, end))?;
    let slope = ahead.v_follow_slope();
    let mut targets = [SlideTarget::rest(0.0); SLIDES];
    for side in 0..SIDES {
        targets[u_slide(side) + 1] = SlideTarget {
            position: now[side],
            velocity: speed * slope[side],
        };
    }
    Some(targets)
}

/// A head where it really is, beside where the planned path would have it: every six-axis deviation is fed forward to
/// both trackers (mathematics 0.7).
#[derive(Clone, Copy, Debug)]
pub struct RealHead {
    planned: SpotFrame,
    real: SpotFrame,
    pose: Pose,
    /// How fast the pose moves beside the planned one on purpose.
    superimposed_rate: PoseOffset,
}

impl RealHead {
    /// Of `side`, with the machine in the state `snapshot`.
    pub fn new<const N: usize>(
        heads: &Heads,
        path: &Path<N>,
        snapshot: &PathSnapshot,
        side: usize,
    ) -> Option<Self> {
        Some(Self {
            planned: planned_spot(heads, path, side, snapshot.s)?,
            real: heads.spot(&snapshot.pose, side),
            pose: snapshot.pose,
            superimposed_rate: snapshot.superimposed_rate,
        })
    }

    /// How far the spot is off its planned place, along U and V \[mm\].
    pub fn off(&self) -> [f64; 2] {
        let (_, u, v) = self.planned.coordinates(&self.real.origin);
        [u, v]
    }

    /// Targets of U and V in the frame of the plan, for the head as it is.
    pub fn targets(&self, in_plan: [SlideTarget; 2]) -> [SlideTarget; 2] {
        let point = self.planned.point(0.0, in_plan[0].position, in_plan[1].position);
        let (_, u, v) = self.real.coordinates(&point);
        let moves = self
            .superimposed_rate
            .velocity_at(&self.pose, &(point - self.pose.position));
        [
            SlideTarget {
                position: u,
                velocity: in_plan[0].velocity - moves.dot(&self.real.u),
            },
            SlideTarget {
                position: v,
                velocity: in_plan[1].velocity - moves.dot(&self.real.v),
            },
        ]
    }
}
