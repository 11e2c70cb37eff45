//! What of a seam that is known beforehand cannot be followed: said before welding.
//!
//! The slides carry the cameras: with its spot on the seam, a camera sees what the seam does from there to a lead further.
//! That has to be in its picture, no faster than its pictures and the slides follow, and no sharper than the map is.

use crate::{Deviation, TrueSeam};
use cam::path::PlannedPath;
use config::machine::{JointForm, MachineFile, TrackingUnit};
use shared::io::SLIDE_NAMES;
use shared::parameter::ParameterError;
use shared::protocol::{PathAction, PathEvent};
use shared::ticks::TRACKER_PERIOD_S;
use shared::tracking::map::SeamMap;
use shared::tracking::parameters::TrackerParameters;
use shared::units::MM_S_PER_M_MIN;
use std::sync::Arc;
use thiserror::Error;
use vision::ObserverConfig;

/// Distance of the places that are looked at \[mm\].
const STEP: f64 = 0.25;
/// Places of seams are rounded to this \[mm\].
const ROUNDED: f64 = 1e-6;
/// What of a picture a seam must not come nearer to its sides, across and in height, than \[mm\]: a gap of 0.3 mm and its
/// edges; a band, and what is compared above and below it. Of a corner the walls have to be in the picture.
const GAP_MARGIN: [f64; 2] = [0.19, 0.17];
const CORNER_MARGIN: [f64; 2] = [0.33, 0.23];

/// What cannot be followed, where it is worst.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NotFollowed {
    /// Out of the picture.
    #[error(
        "side {side}: with the beam at s = {s:.1} mm the seam is {away:.2} mm {} the middle of its camera's picture, {lead} mm \
         ahead (a slope of {:.1} %); up to {sees:.2} mm are seen: a lens of less magnification, a shorter camera_lead_mm, or a \
         program from taught points would help, going slower would not", if *height { "above or below" } else { "beside" },
        100.0 * away / lead
    )]
    OutOfView {
        /// 1 or 2.
        side: usize,
        /// Path length from where the first beam goes on \[mm\].
        s: f64,
        /// How far off the middle \[mm\].
        away: f64,
        /// In height, not across.
        height: bool,
        /// What is seen \[mm\].
        sees: f64,
        /// Lead of the camera \[mm\].
        lead: f64,
    },
    /// Steeper than a seam is believed to be.
    #[error(
        "side {side}: at s = {s:.1} mm the seam leads away from its plan by {:.1} % along {slide}; up to {:.1} % are believed \
         (max_seam_slope): a program from taught points would help", 100.0 * slope, 100.0 * most
    )]
    Steep {
        /// 1 or 2.
        side: usize,
        /// Path length from where the first beam goes on \[mm\].
        s: f64,
        /// The slide.
        slide: &'static str,
        /// Slope there.
        slope: f64,
        /// The most.
        most: f64,
    },
    /// Faster than slides or pictures are.
    #[error(
        "side {side}: at s = {s:.1} mm the seam leads away by {:.1} % along {slide}, too fast for {} at {speed:.2} m/min: go at \
         {most:.2} m/min at most", 100.0 * slope, if *pictures { "the pictures" } else { "the slide" }
    )]
    Fast {
        /// 1 or 2.
        side: usize,
        /// Path length from where the first beam goes on \[mm\].
        s: f64,
        /// The slide.
        slide: &'static str,
        /// Slope there.
        slope: f64,
        /// It is the pictures that do not follow.
        pictures: bool,
        /// Fastest programmed speed \[m/min\].
        speed: f64,
        /// What would do \[m/min\].
        most: f64,
    },
    /// A jump, or a kink that is too sharp.
    #[error(
        "side {side}: at s = {s:.1} mm the seam jumps or bends so sharply along {slide} that the spot would be {off:.2} mm beside \
         it; a beam goes off from {most:.2} mm on (unlock_mm): mend the joint there, or weld up to it and from it on"
    )]
    Sharp {
        /// 1 or 2.
        side: usize,
        /// Path length from where the first beam goes on \[mm\].
        s: f64,
        /// The slide.
        slide: &'static str,
        /// How far off \[mm\].
        off: f64,
        /// How far it may be \[mm\].
        most: f64,
    },
    /// Out of reach of the search.
    #[error(
        "side {side}: where the weld begins the seam lies {away:.2} mm off its plan along {slide}, and is looked for up to \
         {reach:.2} mm: search farther ({key}), or use a program from taught points"
    )]
    Beside {
        /// 1 or 2.
        side: usize,
        /// The slide.
        slide: &'static str,
        /// How far off \[mm\].
        away: f64,
        /// How far is looked for \[mm\].
        reach: f64,
        /// The key of the machine file.
        key: &'static str,
    },
}

/// What of a seam that deviates from the plan like `seam`, or lies as planned, cannot be followed on `paths`; of every kind
/// and slide the worst.
///
/// # Errors
/// A machine parameter that is out of range.
pub fn not_followed(
    paths: &[PlannedPath],
    machine: &MachineFile,
    seam: Option<&Deviation>,
) -> Result<Vec<NotFollowed>, ParameterError> {
    let Some(unit) = &machine.tracking else {
        return Ok(Vec::new());
    };
    let parameters = unit.board.build()?;
    let longest = paths.iter().map(PlannedPath::length_mm).fold(1.0, f64::max);
    let seam = Arc::new(seam.cloned().unwrap_or_else(|| Deviation::none(longest)));
    let tracks = |path: &&PlannedPath| {
        let on = |event: &PathEvent| event.action == PathAction::Tracking { on: true };
        path.events.iter().any(on)
    };
    let mut found = Vec::new();
    for path in paths.iter().filter(tracks) {
        let Some((start, end)) = path.weld() else {
            continue;
        };
        let look = Look {
            unit,
            parameters: &parameters,
            seam: TrueSeam::new(parameters.heads, path.knot_path(), start, seam.clone()),
            weld: (start, end),
            speed: path.speeds().fastest_mm_s,
        };
        for side in unit.board.sides() {
            found.extend(look.beside(side));
            found.extend(look.out_of_view(side));
            for slide in [2 * side, 2 * side + 1] {
                // A jump is steep too.
                found.extend(look.sharp(slide).or_else(|| look.steep_or_fast(slide)));
            }
        }
    }
    Ok(found)
}

/// A weld of a path.
struct Look<'a> {
    unit: &'a TrackingUnit,
    parameters: &'a TrackerParameters,
    seam: TrueSeam,
    weld: (f64, f64),
    speed: f64,
}

impl Look<'_> {
    fn places(&self) -> impl Iterator<Item = f64> {
        let (start, end) = self.weld;
        let count = ((end - start) / STEP).ceil().max(1.0) as usize;
        (0..=count).map(move |i| start + (end - start) * i as f64 / count as f64)
    }

    /// U, V at which the slides of `side` meet the seam `along` \[mm\] ahead of path position `s`.
    fn meets(&self, side: usize, s: f64, along: f64) -> Option<[f64; 2]> {
        let (pose, _) = self.seam.planned(s)?;
        let frame = self.parameters.heads.spot(&pose, side);
        let crossing = self.seam.crossing(side, &frame, along)?;
        Some([crossing.u, crossing.v])
    }

    fn out_of_view(&self, side: usize) -> Option<NotFollowed> {
        let cameras = &self.unit.cameras;
        let optics = &cameras.optics;
        let (pixel, tilt) = (optics.object_pixel_mm(), optics.tilt_rad);
        let margin = match cameras.joint {
            JointForm::Gap => GAP_MARGIN,
            JointForm::Corner => CORNER_MARGIN,
        };
        let sees = [
            optics.columns as f64 * pixel / 2.0 - margin[0],
            optics.rows as f64 * pixel * tilt.sin() / 2.0 - margin[1],
        ];
        let lead = self.parameters.heads.camera_lead();
        let camera = cameras.nominal(side);
        let mut worst: Option<(f64, NotFollowed)> = None;
        for s in self.places() {
            let Some((here, ahead)) = self.meets(side, s, 0.0).zip(self.meets(side, s, lead)) else {
                continue;
            };
            let seen = camera.camera_step(ahead[0] - here[0], ahead[1] - here[1]);
            for axis in 0..2 {
                let (away, sees) = (seen[axis].abs(), sees[axis].max(0.0));
                if away - sees > worst.as_ref().map_or(0.0, |(beyond, _)| *beyond) {
                    let height = axis == 1;
                    let s = self.seam.along(s);
                    let side = side + 1;
                    let found = NotFollowed::OutOfView {
                        side,
                        s,
                        away,
                        height,
                        sees,
                        lead,
                    };
                    worst = Some((away - sees, found));
                }
            }
        }
        worst.map(|(_, found)| found)
    }

    fn steep_or_fast(&self, slide: usize) -> Option<NotFollowed> {
        let (side, axis) = (slide / 2, slide % 2);
        let at = |s: f64| Some((s, self.meets(side, s, 0.0)?[axis]));
        let places: Vec<(f64, f64)> = self.places().filter_map(at).collect();
        let slopes = places.windows(2).map(|pair| {
            let way = pair[1].0 - pair[0].0;
            (pair[0].0, ((pair[1].1 - pair[0].1) / way).abs())
        });
        let (s, slope) = slopes.max_by(|a, b| a.1.total_cmp(&b.1))?;
        let tracking = &self.unit.board.tracking;
        let frame = f64::from(tracking.frame_period_ms) * TRACKER_PERIOD_S;
        let slide_most = self.unit.board.slides[slide].max_velocity_mm_s / slope;
        let pictures_most = ObserverConfig::default().gate_mm / frame / slope;
        let (s, side, name) = (self.seam.along(s), side + 1, SLIDE_NAMES[slide]);
        if slope > tracking.max_seam_slope {
            return Some(NotFollowed::Steep {
                side,
                s,
                slide: name,
                slope,
                most: tracking.max_seam_slope,
            });
        }
        let most = slide_most.min(pictures_most);
        (self.speed > most).then(|| NotFollowed::Fast {
            side,
            s,
            slide: name,
            slope,
            pictures: pictures_most < slide_most,
            speed: self.speed / MM_S_PER_M_MIN,
            most: most / MM_S_PER_M_MIN,
        })
    }

    /// What the map of the tracker makes of it, at this speed.
    fn sharp(&self, slide: usize) -> Option<NotFollowed> {
        let (side, axis) = (slide / 2, slide % 2);
        let frame = f64::from(self.unit.board.tracking.frame_period_ms) * TRACKER_PERIOD_S;
        let law = &self.parameters.map;
        let spacing = (self.speed * frame).max(law.spacing);
        let seam = |s: f64| Some(self.meets(side, s, 0.0)?[axis]);
        let half = law.window + law.hold + spacing;
        let mut worst: Option<(f64, f64)> = None;
        // A map holds a stretch of the way.
        let mut seen = self.weld.0 - half;
        let mut map = SeamMap::new();
        for s in self.places() {
            while seen < s + half {
                if let Some(y) = seam(seen) {
                    map.add(law, seen, y);
                }
                seen += spacing;
            }
            let Some((now, estimate)) = seam(s).zip(map.estimate(law, s)) else {
                continue;
            };
            let off = (now - estimate.value).abs();
            if off > worst.map_or(self.parameters.unlock, |(most, _)| most) {
                worst = Some((off, s));
            }
        }
        worst.map(|(off, s)| NotFollowed::Sharp {
            side: side + 1,
            s: self.seam.along(s),
            slide: SLIDE_NAMES[slide],
            off,
            most: self.parameters.unlock,
        })
    }

    /// Where the weld begins.
    fn beside(&self, side: usize) -> Vec<NotFollowed> {
        let tracking = &self.unit.board.tracking;
        let reach = [
            (tracking.search_mm, "search_mm"),
            (tracking.search_height_mm, "search_height_mm"),
        ];
        let (start, _) = self.weld;
        let Some((meets, (_, follow))) = self.meets(side, start, 0.0).zip(self.seam.planned(start)) else {
            return Vec::new();
        };
        let off = [meets[0], meets[1] - follow[side]];
        let far = |axis: usize| {
            let ((reach, key), away) = (reach[axis], off[axis].abs());
            (away > reach.max(tracking.view_mm[axis]) + ROUNDED).then_some(NotFollowed::Beside {
                side: side + 1,
                slide: SLIDE_NAMES[2 * side + axis],
                away,
                reach,
                key,
            })
        };
        [0, 1].into_iter().filter_map(far).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cam::path::Planner;
    use nc::{Options, interpret};

    /// What is found of a seam along a straight weld of 100 mm, at 9 m/min.
    fn found(deviation: impl Fn(f64) -> [f64; 4]) -> Vec<NotFollowed> {
        let text = include_str!("../../../machines/dual-beam-gantry.toml");
        let machine = MachineFile::parse("m.toml", text).unwrap();
        let planner = Planner::build(&machine).unwrap();
        let program =
            "G43.4\nG0 X900 Y900 Z100 A0 B0 C0\nF9000\nM62 P2\nG1 X960\nM62 P0\nX1060\nM63 P0\nX1100\nM2";
        let program = interpret(program, Options::default()).unwrap();
        let from = [100.0, 100.0, 900.0, 0.0, 0.0, 0.0];
        let paths = planner.program(&program, &from, None).unwrap();
        let mut rows = "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n".to_owned();
        for half in 0..=220 {
            let s = f64::from(half) / 2.0;
            let [u1, v1, u2, v2] = deviation(s);
            rows += &format!("{s},{u1},{v1},{u2},{v2}\n");
        }
        let seam = Deviation::parse("seam.csv", &rows).unwrap();
        not_followed(&paths, &machine, Some(&seam)).unwrap()
    }

    #[test]
    fn what_can_be_followed_is_not_complained_about() {
        let sine = |s: f64, size: f64| size * (std::f64::consts::TAU * s / 100.0).sin();
        assert_eq!(found(|_| [0.0; 4]), []);
        assert_eq!(
            found(|s| [sine(s, 1.0), sine(s, -0.3), 0.05 * s - 2.0, 0.02 * s - 1.0]),
            []
        );
        assert_eq!(found(|_| [3.0, -2.0, -3.0, 2.0]), []);
        assert_eq!(found(|s| [0.01 * (s - 50.0).abs(), 0.0, 0.0, 0.0]), []);
    }

    #[test]
    fn what_cannot_is_named_by_its_side_place_and_reason() {
        use NotFollowed::{Beside, Fast, OutOfView, Sharp, Steep};
        let all = found(|s| [0.0, 0.0, 0.14 * s - 2.0, 0.0]);
        assert!(
            all.iter()
                .any(|found| matches!(found, OutOfView { side: 2, height: true, s, .. } if (0.0..=100.0).contains(s))),
            "{all:?}"
        );
        let all = found(|s| [0.0, 0.0, 0.0, if s < 40.0 { 0.0 } else { 0.3 }]);
        let [
            Sharp {
                side: 2,
                s,
                slide: "V2",
                off,
                ..
            },
        ] = all[..]
        else {
            panic!("{all:?}");
        };
        assert!((s - 40.0).abs() < 1.0 && (0.1..0.3).contains(&off), "{s} {off}");
        // 0.14 on the way of a picture is more than its gate.
        let all = found(|s| [0.18 * s - 2.0, 0.0, 0.0, 0.0]);
        assert!(
            all.iter().any(|found| matches!(found, Fast { side: 1, pictures: true, most, .. } if (most - 6.667).abs() < 0.01)),
            "{all:?}"
        );
        let all = found(|s| [0.0, 0.0, 0.25 * s - 3.0, 0.0]);
        assert!(
            all.iter().any(|found| matches!(
                found,
                Steep {
                    side: 2,
                    slide: "U2",
                    ..
                }
            )),
            "{all:?}"
        );
        let all = found(|_| [3.2, 0.0, 0.0, -2.3]);
        assert!(
            matches!(all[..], [Beside { slide: "U1", .. }, Beside { slide: "V2", .. }]),
            "{all:?}"
        );
    }
}
