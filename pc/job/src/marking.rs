//! Burns short marks into a bare plate and looks back at them: where a camera truly looks beside its spot, and when.
//!
//! Two marks lie on one line along travel: one of the head's own beam, and behind it one of the other head's, for which the
//! machine goes aside by what is between both spots. Then the camera passes over both, beams off, at two speeds, there and back.
//! The slides rest all the time. What is told of it is what the boards measured, never what is true of a simulated machine.

use crate::images::{ImageCameras, SightingLog};
use crate::session::Session;
use crate::{Job, JobError, Weld};
use config::calibration::Calibration;
use host_link::events::Phase;
use nalgebra::Vector3;
use nc::text::tip_words;
use nc::{Options, Program, interpret};
use shared::geometry::Pose;
use shared::io::{AXES, SIDES};
use shared::tracking::frames::{Heads, SpotFrame};
use shared::trajectory::SpeedLimits;
use shared::units::{DEG_PER_RAD, MM_S_PER_M_MIN};
use std::ops::RangeInclusive;
use std::time::Duration;
use vision::calibrate::{BurntMark, MarkSighting};

/// The machine gets up to its speed, and comes to rest, within so many times the way that it takes, and this beside it \[mm\]: as
/// far as pictures show the marks.
const RUN_UP: f64 = 1.25;
const SEEN_MM: f64 = 1.5;
/// Between the two marks \[mm\]: no picture shows ends of both.
const APART_MM: f64 = 5.0;
/// Two speeds of the passes, as parts of the faster one: a delay shows by their difference.
const SPEEDS: [f64; 2] = [0.3, 1.0];
/// Until the last pictures of a pass were measured \[s\].
const LAST_PICTURES_S: f64 = 0.15;
/// Over so long before and after a strobe the speed is taken \[µs\].
const SPEED_US: u64 = 2_000;
/// A tick of the motion board's telemetry \[µs\].
const TICK_US: u64 = 1000;
/// Part of its speed by which the machine may be off that in a picture that counts.
const UNDER_WAY: f64 = 0.1;
/// Longest time for the strobes to begin.
const LIMIT: Duration = Duration::from_secs(10);

/// Which marks to burn, and how to look at them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marking {
    /// Side of the camera, 0 or 1.
    pub side: usize,
    /// Power of the beams \[W\].
    pub power_w: f64,
    /// Speed of the marks \[mm/s\].
    pub mark_speed_mm_s: f64,
    /// Length of a mark \[mm\].
    pub length_mm: f64,
    /// Speed of the faster passes \[mm/s\].
    pub pass_speed_mm_s: f64,
}

impl Marking {
    /// Lengths that a mark may have \[mm\]: the fit needs 8 mm of it well within its ends; and the path of both marks is in the memory
    /// of the tracker, and the plate has to be level over it.
    pub const LENGTHS_MM: RangeInclusive<f64> = 10.0..=100.0;

    /// Dark lines on a thin plate, for the camera of `side`.
    pub const fn of(side: usize) -> Self {
        Self {
            side,
            power_w: 500.0,
            mark_speed_mm_s: MM_S_PER_M_MIN,
            length_mm: 25.0,
            pass_speed_mm_s: 6.0 * MM_S_PER_M_MIN,
        }
    }

    /// Cameras that look back at the marks: as `calibrations` say, but for their spots, for lead and delay are found anew.
    pub fn cameras(&self, mut calibrations: [Calibration; SIDES], noted: &SightingLog) -> ImageCameras {
        for calibration in &mut calibrations {
            calibration.spot = None;
        }
        ImageCameras {
            calibrations,
            kept: None,
            noted: Some((self.side, noted.clone())),
            shown_every: None,
        }
    }

    /// How long the plate has to be \[mm\].
    pub fn plate_mm(&self) -> f64 {
        2.0 * self.length_mm + 30.0
    }
}

/// Marks to burn, and to look back at.
#[derive(Debug)]
pub struct MarkRun<'a> {
    /// Program at the beginning of whose weld the plate lies.
    pub program: &'a Program,
    /// The marks.
    pub marking: Marking,
    /// Where what the pictures show is noted.
    pub noted: SightingLog,
}

/// Marks, and what a camera saw of them.
#[derive(Clone, Debug)]
pub struct SeenMarks {
    /// Of the head's own beam, and of the other head's.
    pub marks: [BurntMark; SIDES],
    /// Pictures of all passes.
    pub sightings: Vec<MarkSighting>,
    /// The lead that was believed \[mm\].
    pub lead_mm: f64,
}

impl Weld {
    /// Burns the marks of `run` and looks back at them.
    pub(super) fn mark(
        &mut self,
        session: &mut Session,
        job: &Job,
        run: &MarkRun,
    ) -> Result<SeenMarks, JobError> {
        let (weld, begin_s) = self.before_weld(session, job, run.program)?;
        let wrong = |what: String| JobError::Calibrate(what);
        let point = weld.knot_path().at(begin_s);
        let point = point.ok_or_else(|| wrong("the weld begins beyond its path".to_owned()))?;
        let pose = point.pose().map_err(|error| wrong(error.to_string()))?;
        let tracking = session.tracking.as_ref();
        let heads = tracking
            .map(|tracking| tracking.heads)
            .ok_or_else(|| wrong("the machine has no cameras".to_owned()))?;
        if heads.sides().len() < SIDES {
            return Err(wrong(
                "the machine has one head, and marks are burnt with two".to_owned(),
            ));
        }
        let spots = [run.marking.side, 1 - run.marking.side].map(|side| (heads.spot(&pose, side), side));
        let [own, other] = spots.map(|(spot, side)| spot.point(0.0, 0.0, point.v_follow()[side]));
        let place = Place {
            heads,
            axes: self.angles(&pose)?,
            pose,
            frame: spots[0].0,
            v_follow: point.v_follow(),
        };
        let lead_mm = heads.camera_lead();
        let run_up_mm = |velocity: f64| {
            let limits = SpeedLimits {
                velocity,
                ..weld.limits
            };
            RUN_UP * limits.ramp() + SEEN_MM
        };
        let passes = 2 * SPEEDS.len() as u32;
        let phase = |step: u32| Phase::Calibrating {
            place: step + 1,
            of: SIDES as u32 + passes,
        };

        let mut marks = Vec::new();
        for (k, (_, side)) in spots.into_iter().enumerate() {
            let aside = if k == 0 { Vector3::zeros() } else { own - other };
            let from = k as f64 * (run.marking.length_mm + APART_MM);
            let text = place.mark_text(run, side, aside, [from, run_up_mm(run.marking.mark_speed_mm_s)]);
            let ends = self.burn(session, run, &place, side, &text, phase(k as u32))?;
            // The beam of that head, in the frame of this one.
            let beam = heads.spot(&place.pose, side).v;
            marks.push(BurntMark {
                ends_mm: ends,
                beam: [beam.dot(&place.frame.u), beam.dot(&place.frame.v)],
            });
        }

        let seen_from = -lead_mm;
        let seen_to = 2.0 * run.marking.length_mm + APART_MM - lead_mm;
        let mut sightings = Vec::new();
        for (k, share) in SPEEDS.into_iter().enumerate() {
            let speed = run.marking.pass_speed_mm_s * share;
            let run_up = run_up_mm(speed);
            let reach = [seen_from - run_up, seen_to + run_up];
            for (back, [from, to]) in [reach, [reach[1], reach[0]]].into_iter().enumerate() {
                let pass = 2 * k as u32 + back as u32;
                let phase = phase(SIDES as u32 + pass);
                self.run_text(session, &place.go_text(from), phase)?;
                let seen = self.pass(session, run, &place, &place.pass_text(speed, to), phase)?;
                let under_way = |seen: &MarkSighting| (seen.speed_mm_s.abs() / speed - 1.0).abs() < UNDER_WAY;
                let of_pass = seen.into_iter().map(|seen| MarkSighting { pass, ..seen });
                sightings.extend(of_pass.filter(under_way));
            }
        }
        let [own, other] = [marks[0], marks[1]];
        Ok(SeenMarks {
            marks: [own, other],
            sightings,
            lead_mm,
        })
    }

    /// A, B and C at a pose \[°\].
    fn angles(&self, pose: &Pose) -> Result<[f64; 3], JobError> {
        let axes = self
            .planner
            .kinematics()
            .inverse(pose, &[0.0; AXES])
            .map_err(|error| JobError::Calibrate(format!("the plate cannot be reached: {error}")))?;
        Ok([axes[3], axes[4], axes[5]].map(|angle| angle * DEG_PER_RAD))
    }

    /// Runs a program of one block after another.
    fn run_text(&mut self, session: &mut Session, text: &str, phase: Phase) -> Result<(), JobError> {
        let program =
            interpret(text, Options::default()).map_err(|error| JobError::Plan(error.to_string()))?;
        for path in self.planner.program(&program, &session.motion.reference, None)? {
            self.path(session, path, phase)?;
        }
        Ok(())
    }

    /// Burns a mark: where the spot of `side` was when its beam went on and off.
    fn burn(
        &mut self,
        session: &mut Session,
        run: &MarkRun,
        place: &Place,
        side: usize,
        text: &str,
        phase: Phase,
    ) -> Result<[[f64; 3]; 2], JobError> {
        let since = session.tick();
        self.run_text(session, text, phase)?;
        session.dwell(LAST_PICTURES_S)?;
        let slides = session.slides_mm();
        let new = |tick: u32| (1..1 << 31).contains(&tick.wrapping_sub(since));
        let mut ends = [None; 2];
        for sample in session.record.motion().iter().filter(|sample| new(sample.tick)) {
            for switched in sample
                .switched
                .iter()
                .filter(|line| usize::from(line.line) == side)
            {
                let time_us = sample.time_us.saturating_sub(TICK_US) + u64::from(switched.at_us);
                let axes = session.record.axes_at(time_us);
                ends[usize::from(!switched.on)] = axes.map(|axes| (switched.on, axes));
            }
        }
        match ends {
            [Some((_, on)), Some((_, off))] => Ok([on, off].map(|axes| {
                let pose = session.machine.kinematics().forward(&axes);
                place.head(&pose, side, [slides[2 * side], slides[2 * side + 1]])
            })),
            _ => Err(JobError::Calibrate(format!(
                "beam {} did not go on and off where mark {} should be ({} W): look at its source and its permits",
                side + 1,
                usize::from(side != run.marking.side) + 1,
                run.marking.power_w
            ))),
        }
    }

    /// Passes over the marks, beams off: what the pictures show.
    fn pass(
        &mut self,
        session: &mut Session,
        run: &MarkRun,
        place: &Place,
        text: &str,
        phase: Phase,
    ) -> Result<Vec<MarkSighting>, JobError> {
        let watch = |session: &mut Session, on: bool| {
            let tracking = session.tracking.as_mut();
            tracking.and_then(|tracking| std::mem::replace(&mut tracking.strobed, on.then(Default::default)))
        };
        watch(session, true);
        run.noted.take();
        let ran = self
            .run_text(session, text, phase)
            .and_then(|()| session.dwell(LAST_PICTURES_S));
        let strobed = watch(session, false).unwrap_or_default();
        ran?;
        let noted = run.noted.take();
        let at = |session: &Session, time_us: u64, slides: [f64; 2]| {
            let axes = session.record.axes_at(time_us)?;
            let pose = session.machine.kinematics().forward(&axes);
            Some(place.head(&pose, run.marking.side, slides))
        };
        let seen = noted.iter().filter_map(|sighting| {
            let strobe = strobed.get(&sighting.capture)?;
            let slides = [
                strobe.slides_mm[2 * run.marking.side],
                strobe.slides_mm[2 * run.marking.side + 1],
            ];
            let [before, here, after] = [
                strobe.time_us.saturating_sub(SPEED_US),
                strobe.time_us,
                strobe.time_us + SPEED_US,
            ]
            .map(|time_us| at(session, time_us, slides));
            Some(MarkSighting {
                pass: 0,
                head_mm: here?,
                speed_mm_s: (after?[0] - before?[0]) / (2e-6 * SPEED_US as f64),
                seen_mm: sighting
                    .measured
                    .map(|seen| [seen.lateral_mm, seen.travel_mm, seen.height_mm]),
                ends_mm: sighting.ends.map(|end| Some(end?.travel_mm)),
            })
        });
        let seen: Vec<_> = seen.collect();
        if seen.is_empty() {
            let (what, seconds) = ("a picture of the marks", LIMIT.as_secs());
            return Err(JobError::TooLong { what, seconds });
        }
        Ok(seen)
    }
}

/// Where the marks are.
struct Place {
    heads: Heads,
    /// A, B, C there \[°\].
    axes: [f64; 3],
    /// Tool where the first mark begins.
    pose: Pose,
    /// The camera's head there, its slides at zero.
    frame: SpotFrame,
    /// V of both sides, at which the beams are in focus on the plate \[mm\].
    v_follow: [f64; SIDES],
}

impl Place {
    /// Words of the tip so far along the marks, and aside of them.
    fn words(&self, along_mm: f64, aside: Vector3<f64>) -> String {
        let position = self.pose.position + self.pose.tangent * along_mm + aside;
        tip_words(&position.into(), &self.axes, &self.v_follow)
    }

    /// A program that burns the mark of a beam, after a run-up.
    fn mark_text(&self, run: &MarkRun, side: usize, aside: Vector3<f64>, [from, run_up]: [f64; 2]) -> String {
        let to = from + run.marking.length_mm;
        let words = [from - run_up, from, to, to + run_up].map(|along| self.words(along, aside));
        let [start, on, off, end] = words;
        let feed = run.marking.mark_speed_mm_s * 60.0;
        format!(
            "G21 G90 G94 G64 G43.4\nM67 E{side} Q{power}\nG0 {start}\nF{feed}\nG1 {on}\nM62 P{side}\nG1 {off}\n\
             M63 P{side}\nG1 {end}\nM2\n",
            power = run.marking.power_w
        )
    }

    /// A program that goes to where a pass begins.
    fn go_text(&self, along_mm: f64) -> String {
        let words = self.words(along_mm, Vector3::zeros());
        format!("G21 G90 G94 G64 G43.4\nG0 {words}\nM2\n")
    }

    /// A program that passes over the marks from there.
    fn pass_text(&self, speed_mm_s: f64, to: f64) -> String {
        let words = self.words(to, Vector3::zeros());
        let feed = speed_mm_s * 60.0;
        format!("G21 G90 G94 G64 G43.4\nF{feed}\nG1 {words}\nM2\n")
    }

    /// Where a head is in the frame of the marks, with its slides so: along travel, U, V \[mm\].
    fn head(&self, pose: &Pose, side: usize, [u, v]: [f64; 2]) -> [f64; 3] {
        let point = self.heads.spot(pose, side).point(0.0, u, v);
        let (along, across, toward) = self.frame.coordinates(&point);
        [along, across, toward]
    }
}
