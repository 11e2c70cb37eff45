//! Marks that beams have truly burnt into a bare plate: along the true spots, where gates were truly open.

use crate::TrueSeams;
use camera::CameraFrame;
use host_link::geometry::MachineGeometry;
use host_link::record::MachinePosition;
use nalgebra::Vector3;
use shared::io::{SIDES, SLIDES};
use shared::protocol::{Capture, MotionSample};
use std::collections::VecDeque;

/// Width of a mark \[mm\], a groove or a kerf: about the diameter of a beam that is focused to weld sheets.
pub const WIDTH_MM: f64 = 0.15;
/// How far from the middle of a picture marks are looked for \[mm\]: more than it shows.
const REACH_MM: f64 = 3.0;
/// How far to either side the direction of a mark is taken \[mm\].
const STEP_MM: f64 = 0.5;
/// A tick of the motion board's telemetry \[µs\].
const TICK_US: u64 = 1000;

/// All marks on the plate.
#[derive(Clone, Debug, Default)]
pub struct Marks {
    /// The latest sample of the motion board, and pairs of samples between which a beam burnt, until the slides are known.
    last: Option<MotionSample>,
    waiting: VecDeque<[MotionSample; 2]>,
    /// Slides at the latest strobe, and when that was by the motion board's clock \[µs, mm\].
    slides: Option<(u64, [f64; SLIDES])>,
    burning: [bool; SIDES],
    /// Places on the plate in the order in which they were burnt, those that belong together in one.
    lines: Vec<(usize, Vec<Vector3<f64>>)>,
}

/// A mark in the frame of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenMark {
    /// u of its middle at a = 0 \[mm\].
    pub lateral_mm: f64,
    /// Its angle against travel \[rad\].
    pub yaw_rad: f64,
    /// a of its ends \[mm\].
    pub ends_mm: [f64; 2],
}

impl Marks {
    /// Takes what the motion board told; ticks may come twice.
    pub fn motion(&mut self, samples: &[MotionSample]) {
        for sample in samples {
            if let Some(last) = self.last.filter(|last| sample.time_us > last.time_us) {
                let burns = |sample: &MotionSample| sample.beams.contains(&true);
                if burns(&last) || burns(sample) || sample.switched.iter().next().is_some() {
                    self.waiting.push_back([last, *sample]);
                }
            }
            self.last = Some(*sample);
        }
    }

    /// Takes a capture, which says where the slides were: what was burnt before it lies on the plate from now on.
    pub fn strobed(&mut self, capture: &Capture, machine: &MachineGeometry, seams: &TrueSeams) {
        let now = (
            capture.motion_time_us,
            capture.truth_mm.unwrap_or(capture.slides_mm),
        );
        if self.slides.is_some_and(|(before, _)| before >= now.0) {
            return;
        }
        let before = self.slides.replace(now).unwrap_or(now);
        let slides_at = |time_us: u64| -> [f64; SLIDES] {
            let share = (time_us as f64 - before.0 as f64) / (now.0 as f64 - before.0 as f64).max(1.0);
            let share = share.clamp(0.0, 1.0);
            std::array::from_fn(|i| before.1[i] + (now.1[i] - before.1[i]) * share)
        };
        while let Some(&[from, to]) = self.waiting.front() {
            if to.time_us > now.0 {
                break;
            }
            self.waiting.pop_front();
            for side in 0..SIDES {
                let hit = |sample: &MotionSample| {
                    let slides = slides_at(sample.time_us);
                    hit(machine, seams, &MachinePosition::of(sample), &slides, side)
                };
                match (hit(&from), hit(&to)) {
                    (Some(a), Some(b)) => self.burn(side, [from, to], [a, b]),
                    // No plate there.
                    _ => self.burning[side] = false,
                }
            }
        }
    }

    /// What the beam of `side` does between two samples, on the way from one place of the plate to another.
    fn burn(&mut self, side: usize, [from, to]: [MotionSample; 2], [a, b]: [Vector3<f64>; 2]) {
        if from.beams[side] && !self.burning[side] {
            self.lines.push((side, vec![a]));
        }
        self.burning[side] = from.beams[side];
        let began_us = to.time_us.saturating_sub(TICK_US);
        for switched in to.switched.iter().filter(|line| usize::from(line.line) == side) {
            let time_us = began_us + u64::from(switched.at_us);
            let share = (time_us as f64 - from.time_us as f64) / (to.time_us - from.time_us) as f64;
            let place = a + (b - a) * share.clamp(0.0, 1.0);
            if switched.on && !self.burning[side] {
                self.lines.push((side, vec![place]));
            } else if !switched.on && self.burning[side] {
                self.add(side, place);
            }
            self.burning[side] = switched.on;
        }
        if self.burning[side] {
            self.add(side, b);
        }
    }

    fn add(&mut self, side: usize, place: Vector3<f64>) {
        let line = self.lines.iter_mut().rev().find(|(of, _)| *of == side);
        if let Some((_, places)) = line {
            places.push(place);
        }
    }

    /// The mark before the camera in `frame` that is nearest to the middle of its picture, if one is near.
    pub fn seen(&self, frame: &CameraFrame) -> Option<SeenMark> {
        let seen = self
            .lines
            .iter()
            .filter_map(|(_, places)| Some((places, ends(places, frame)?)));
        let far = |[from, to]: &[f64; 2]| from.max(-to).max(0.0);
        let (places, [from, to]) = seen.min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)))?;
        if far(&[from, to]) > REACH_MM {
            return None;
        }
        // Where its direction is taken: about the middle of the picture, or as near to that as the mark reaches.
        let step = STEP_MM.min((to - from) / 2.0);
        let middle = 0.0_f64.clamp(from + step, to - step);
        let [before, after] = [middle - step, middle + step].map(|a| across(places, frame, a));
        let slope = (after - before) / (2.0 * step);
        Some(SeenMark {
            lateral_mm: (before + after) / 2.0 - slope * middle,
            yaw_rad: slope.atan(),
            // Its ends are round: a beam burns half of its width beyond where it goes.
            ends_mm: [from - WIDTH_MM / 2.0, to + WIDTH_MM / 2.0],
        })
    }
}

/// a of the ends of a line; `None` of one that is none.
fn ends(places: &[Vector3<f64>], frame: &CameraFrame) -> Option<[f64; 2]> {
    let along = places.iter().map(|place| frame.coordinates(place)[0]);
    let (from, to) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), a| {
        (from.min(a), to.max(a))
    });
    (to - from > 2.0 * f64::EPSILON).then_some([from, to])
}

/// u of a line where its a is `along`.
fn across(places: &[Vector3<f64>], frame: &CameraFrame, along: f64) -> f64 {
    let [first, last] = [places.first(), places.last()].map(|place| place.map(|p| frame.coordinates(p)));
    let forward = first.zip(last).is_some_and(|(first, last)| last[0] > first[0]);
    let before = |place: &Vector3<f64>| (frame.coordinates(place)[0] < along) == forward;
    let next = places
        .partition_point(before)
        .clamp(1, places.len().saturating_sub(1).max(1));
    match (places.get(next - 1), places.get(next)) {
        (Some(a), Some(b)) => {
            let [a, b] = [a, b].map(|place| frame.coordinates(place));
            let share = if a[0] == b[0] {
                0.0
            } else {
                (along - a[0]) / (b[0] - a[0])
            };
            a[1] + (b[1] - a[1]) * share
        }
        _ => 0.0,
    }
}

/// Where the beam of `side` meets the plate.
fn hit(
    machine: &MachineGeometry,
    seams: &TrueSeams,
    position: &MachinePosition,
    slides: &[f64; SLIDES],
    side: usize,
) -> Option<Vector3<f64>> {
    let spot = seams.heads().spot(&machine.pose(position), side);
    let (seam, crossing) = seams.facing(side, &spot, 0.0)?;
    let (planned, _) = seam.planned(crossing.s)?;
    let on_plate = seam.point(side, crossing.s)?;
    let from = spot.point(0.0, slides[2 * side], slides[2 * side + 1]);
    let way = (on_plate - from).dot(&planned.normal) / spot.v.dot(&planned.normal);
    way.is_finite().then(|| from + spot.v * way)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seams::tests::{heads, wavy_seam};
    use crate::tests::{axes_at, machine, motion_sample};
    use shared::io::{Switched, SwitchedLines};

    /// A beam goes on half a millisecond after tick 20 and off a quarter after tick 80, at 0.05 mm a tick: the mark is as long,
    /// and a width more.
    #[test]
    fn a_mark_lies_where_the_spot_was_while_its_gate_was_open() {
        const PLACE: f64 = 200.0;
        let (machine, seams) = (machine(), TrueSeams::of([wavy_seam()]));
        let pose_at = |s: f64| wavy_seam().planned(s).unwrap().0;
        let sample = |tick: u32| {
            let mut switched = SwitchedLines::NONE;
            let mut switch = |on, at_us| switched.push(Switched { line: 0, on, at_us });
            match tick {
                21 => switch(true, 500),
                81 => switch(false, 250),
                _ => {}
            }
            MotionSample {
                beams: [(21..81).contains(&tick), false],
                switched,
                axes: axes_at(&pose_at(PLACE + 0.05 * f64::from(tick))),
                truth: None,
                ..motion_sample(tick)
            }
        };
        let mut marks = Marks::default();
        let capture = |number: u32| Capture {
            number,
            time_us: 0,
            motion_time_us: u64::from(number) * 5_000,
            s_mm: 0.0,
            path_id: 1,
            slides_mm: [0.0; SLIDES],
            truth_mm: Some([0.1, 0.0, 0.0, 0.0]),
        };
        for tick in 0..=100 {
            marks.motion(&[sample(tick)]);
            if tick % 5 == 0 {
                marks.strobed(&capture(tick / 5), &machine, &seams);
            }
        }
        let middle = (0.05 * 20.5 + 0.05 * 80.25) / 2.0;
        let seen = |s: f64, u: f64| {
            let spot = heads().spot(&pose_at(s), 0);
            marks.seen(&CameraFrame::new(&spot, 0.0, [0.0; 2], u, 0.0))
        };
        let at = seen(PLACE + middle, 0.1).expect("a mark");
        let [from, to] = at.ends_mm;
        // The path bends: the spot goes a little more or less than the tip.
        assert!((to - from - 0.05 * 59.75 - WIDTH_MM).abs() < 0.03, "{at:?}");
        assert!((from + to).abs() < 0.03 && at.lateral_mm.abs() < 0.005, "{at:?}");
        let beside = seen(PLACE + middle, 0.3).expect("a mark");
        assert!((beside.lateral_mm.abs() - 0.2).abs() < 0.005, "{beside:?}");
        assert_eq!(seen(PLACE + 30.0, 0.1), None);
    }
}
