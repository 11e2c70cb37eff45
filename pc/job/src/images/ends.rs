//! What the tracker is told where a seam begins and ends under a camera that goes on.
//!
//! A mean of pictures lies behind the last of them, a seam is believed at its third picture, and no beam is permitted where nothing was
//! seen next to its spot. So a seam that ends could be welded only to some mm before that. But pictures show it up to its ends, out of
//! focus. Of a seam that comes into sight the tracker is first told its beginning, of one that ends its end: each on the line on which
//! the gap was seen there, and a little beyond, so that a permit is still there when the program ends the beam.

use vision::{Detector, GapEnd, Moved, Observation};

/// A camera that goes less between two pictures stands \[mm\].
const GOES_MM: f64 = 0.02;
/// Pictures show no seam any more that ends so near to the band, or nearer \[mm\].
const NEAR_MM: f64 = 0.25;
/// The line goes on beyond the end for so many pictures: a permit lasts for less than two, on emulated boards for less than three.
const BEYOND_PICTURES: f64 = 3.0;
/// An end that lies so far ahead has to be seen in a picture \[mm\].
const SURELY_SEEN_MM: [f64; 2] = [0.2, 0.8];
/// What lies further behind is forgotten \[mm\].
const BEHIND_MM: f64 = 3.5;

/// A place of the seam: u, a and n in the frame of the camera \[mm\].
pub(super) type Place = (f64, f64, f64);

/// An end of the seam, and the line that leads there.
#[derive(Clone, Copy, Debug)]
struct Line {
    lateral_mm: f64,
    travel_mm: f64,
    height_mm: f64,
    /// Slopes of u and n along a.
    slopes: [f64; 2],
}

impl Line {
    /// A place of it, so far beyond the end.
    fn beyond(&self, way_mm: f64) -> Place {
        (
            self.lateral_mm + self.slopes[0] * way_mm,
            self.travel_mm + way_mm,
            self.height_mm + self.slopes[1] * way_mm,
        )
    }

    fn follow(&mut self, moved: &Moved) {
        self.lateral_mm -= moved.lateral_mm;
        self.travel_mm -= moved.travel_mm;
        self.height_mm -= moved.height_mm;
    }
}

/// Ends of the seam of one camera, where it is now.
#[derive(Clone, Debug)]
pub(super) struct SeamEnds {
    /// How far ahead of the camera the tracker believes what it is told \[mm\].
    reach_mm: f64,
    begin: Option<Line>,
    end: Option<Line>,
    /// All of the end was told.
    told: bool,
}

impl SeamEnds {
    /// For a tracker that believes what lies `reach_mm` ahead of a camera.
    pub fn new(reach_mm: f64) -> Self {
        Self {
            reach_mm,
            begin: None,
            end: None,
            told: false,
        }
    }

    /// Knows of none.
    pub fn forget(&mut self) {
        *self = Self::new(self.reach_mm);
    }

    /// Looks for ends in the picture that was observed last, before which the camera moved; behind and ahead.
    pub fn look(
        &mut self,
        detector: &Detector,
        observation: &Observation,
        moved: &Moved,
    ) -> [Option<GapEnd>; 2] {
        for line in self.begin.iter_mut().chain(&mut self.end) {
            line.follow(moved);
        }
        let far = |line: &mut Line| line.travel_mm < -BEHIND_MM;
        self.begin.take_if(far);
        if self.end.take_if(far).is_some() {
            self.told = false;
        }
        let Some(measured) = observation.report.seam() else {
            return [None; 2];
        };
        let ends = detector.gap_ends(measured);
        let pitch = observation.seam.and_then(|seam| seam.pitch).unwrap_or(0.0);
        let line = |end: GapEnd| Line {
            lateral_mm: end.lateral_mm,
            travel_mm: end.travel_mm,
            height_mm: end.height_mm + pitch * (end.travel_mm - measured.travel_mm),
            slopes: [measured.yaw_rad.tan(), pitch],
        };
        if observation.seam.is_none() {
            self.begin = ends[0].map(line).or(self.begin);
        }
        let [least, most] = SURELY_SEEN_MM;
        let is_none = |end: &mut Line| {
            let way = end.travel_mm - measured.travel_mm;
            way < 0.0 || (least..most).contains(&way)
        };
        match ends[1] {
            Some(end) => self.end = Some(line(end)),
            // It was none.
            None if observation.seam.is_some() && self.end.take_if(is_none).is_some() => self.told = false,
            None => {}
        }
        ends
    }

    /// What the tracker is told of this picture, in which the seam was seen at `seen`, before which the camera moved.
    pub fn told(&mut self, seen: Option<Place>, accepted: bool, moved: &Moved) -> Option<Place> {
        let step = moved.travel_mm;
        if step < GOES_MM {
            return seen;
        }
        if accepted && let Some(begin) = self.begin.take() {
            return Some(begin.beyond(-step));
        }
        let Some(end) = self.end.filter(|end| end.travel_mm < step + NEAR_MM) else {
            return seen;
        };
        if self.told {
            return None;
        }
        let beyond = BEYOND_PICTURES * step;
        let reach = self.reach_mm - end.travel_mm;
        self.told = beyond <= reach;
        Some(end.beyond(beyond.min(reach)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(travel_mm: f64) -> Line {
        Line {
            lateral_mm: 0.1,
            travel_mm,
            height_mm: 0.0,
            slopes: [0.02, -0.01],
        }
    }

    fn step(travel_mm: f64) -> Moved {
        Moved {
            travel_mm,
            ..Moved::default()
        }
    }

    /// What is told of pictures 0.4 mm apart, the mean of which lies 0.6 mm behind the camera.
    fn told(ends: &mut SeamEnds, pictures: usize) -> Vec<Option<f64>> {
        let each = (0..pictures).map(|_| {
            for line in ends.begin.iter_mut().chain(&mut ends.end) {
                line.follow(&step(0.4));
            }
            let (lateral, travel, height) = ends.told(Some((0.1, -0.6, 0.0)), true, &step(0.4))?;
            if travel > 0.0 {
                let beyond = travel - ends.end.unwrap().travel_mm;
                assert!(
                    (lateral - 0.1 - 0.02 * beyond).abs() < 1e-9 && (height + 0.01 * beyond).abs() < 1e-9
                );
            }
            Some(travel)
        });
        each.collect()
    }

    #[test]
    fn an_end_is_told_once_no_later_picture_shows_it_and_as_far_beyond_as_is_believed() {
        let mut ends = SeamEnds::new(0.9);
        ends.end = Some(line(1.5));
        let wanted = [-0.6, -0.6, 0.9, 0.9, 0.7];
        let seen = told(&mut ends, 7);
        for (seen, wanted) in seen.iter().zip(wanted) {
            assert!((seen.unwrap() - wanted).abs() < 1e-9, "{seen:?}");
        }
        // All was told: what is seen after that is no seam.
        assert_eq!(seen[5..], [None; 2]);
    }

    #[test]
    fn a_beginning_is_told_before_anything_else_and_nothing_of_either_to_a_camera_at_rest() {
        let mut ends = SeamEnds::new(0.9);
        ends.begin = Some(line(-0.8));
        ends.end = Some(line(0.1));
        assert_eq!(
            ends.told(Some((0.1, 0.0, 0.0)), true, &step(0.0)),
            Some((0.1, 0.0, 0.0))
        );
        ends.end = None;
        let seen = told(&mut ends, 2);
        assert!((seen[0].unwrap() + 1.6).abs() < 1e-9, "{seen:?}");
        assert_eq!(seen[1], Some(-0.6));
    }
}
