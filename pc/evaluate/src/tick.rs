//! One tick on a path that works.

use crate::Followed;
use crate::nearest::nearest;
use cam::along::Along;
use cam::path::{Course, PlannedPath, Programmed};
use host_link::geometry::MachineGeometry;
use host_link::record::{MachinePosition, SlidePositions};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use shared::io::{MOTORS, SIDES, SLIDES};
use shared::protocol::MotionSample;
use std::collections::BTreeMap;

/// A tick of the motion board on a path that works: one of G1, or with a beam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorkTick {
    /// Path tick.
    pub tick: u32,
    /// Number of the path.
    pub path_id: u32,
    /// Place of the path nearest to the true tip; where that is not known, the programmed one \[mm\].
    pub s_mm: f64,
    /// Programmed position as a length through all such paths: see [`Along`] \[mm\].
    pub along_mm: f64,
    /// Path speed, as the motion board planned it \[mm/s\].
    pub speed_mm_s: f64,
    /// Programmed feed at that place \[mm/s\].
    pub feed_mm_s: f64,
    /// True speed of the tip \[mm/s\]; `None` if its path has no other tick.
    pub true_speed_mm_s: Option<f64>,
    /// Gates that are open.
    pub beams: [bool; SIDES],
    /// Slides at that time (the truth if there is one) \[mm\]; `None` in a gap of the telemetry.
    pub slides_mm: Option<[f64; SLIDES]>,
    /// Spot minus seam, u1 v1 u2 v2, in the plane through the spot perpendicular to T \[mm\].
    pub deviation_mm: [Option<f64>; SLIDES],
    /// Distance of the tip from the programmed path \[mm\].
    pub contour_error_mm: Option<f64>,
    /// Largest |following error| of each motor in the tick (mm, rad).
    pub following_error: [f32; MOTORS],
}

/// A path that works.
pub(super) struct Work {
    path: Course,
    programmed: Programmed,
    /// `along_mm` at its beginning.
    along_mm: f64,
}

pub(super) fn working(paths: &BTreeMap<u32, PlannedPath>, along: &Along) -> BTreeMap<u32, Work> {
    let work = |(id, path): (&u32, &PlannedPath)| {
        let work = Work {
            path: path.path(),
            programmed: path.programmed(),
            along_mm: along.at(*id, 0.0)?,
        };
        Some((*id, work))
    };
    paths.iter().filter_map(work).collect()
}

/// A tick, and where the tip was; its true speed is not known yet. `slides` are those of the run.
pub(super) fn work_tick(
    sample: &MotionSample,
    slides: &mut SlidePositions,
    machine: &MachineGeometry,
    work: &Work,
    followed: Option<Followed>,
) -> (WorkTick, Vector3<f64>) {
    let pose = machine.pose(&MachinePosition::of(sample));
    let slides_mm =
        followed.and_then(|f| slides.at(sample.time_us.checked_add_signed(f.tracker_ahead_us)?));
    let mut deviation_mm = [None; SLIDES];
    if let (Some(slides), Some(followed)) = (slides_mm, followed) {
        for side in 0..SIDES {
            if let Some([u, v]) = followed.seams.on_seam(side, &pose) {
                deviation_mm[2 * side] = Some(slides[2 * side] - u);
                deviation_mm[2 * side + 1] = Some(slides[2 * side + 1] - v);
            }
        }
    }
    let tip = pose.position;
    let nearest = nearest(&work.path, &tip, sample.s_mm);
    let tick = WorkTick {
        tick: sample.tick,
        path_id: sample.path_id,
        s_mm: nearest.map_or(sample.s_mm, |nearest| nearest.s_mm),
        along_mm: work.along_mm + sample.s_mm,
        speed_mm_s: sample.speed_mm_s,
        feed_mm_s: work.programmed.feed_at(sample.s_mm),
        true_speed_mm_s: None,
        beams: sample.beams,
        slides_mm,
        deviation_mm,
        contour_error_mm: nearest.map(|nearest| nearest.distance_mm),
        following_error: sample.following_error,
    };
    (tick, tip)
}
