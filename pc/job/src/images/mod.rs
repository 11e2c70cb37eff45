//! Cameras that give pictures: from the strobe to the measurement.
//!
//! A thread a side takes the pictures of its camera and measures them. Rendered pictures are told what stands before
//! their camera as soon as the boards have told where the machine was; the answer is due after the time that a real
//! camera and computer would take, and is then waited for: meanwhile the time of simulated boards stands still, and
//! emulated boards wait for the PC. Pictures of real cameras are answered when they come, and never waited for.

mod ends;
mod shown;
mod sightings;
mod worker;

pub use sightings::{Sighting, SightingLog};
pub use worker::{MeasuredStrobe, WorkerError};

use crate::cameras::{Answer, CameraFigures, Moment, PictureSource, SeamCameras};
use camera::{CameraFrame, nominal_slopes};
use camera::{PictureQueue, RecordingCamera};
use config::calibration::Calibration;
use config::machine::{CameraConfig, JointForm, TrackingUnit};
use host_link::boards::Waker;
use host_link::events::Events;
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::io::SIDES;
use shared::protocol::{Capture, Measurement, MotionSample};
use shared::tracking::frames::Heads;
use std::collections::VecDeque;
use std::time::Duration;
use vision::{Detector, Joint, Moved, Observer, ObserverConfig, Walls};
use worker::{Geometry, Looks, Strobe, Worker};

/// A capture whose place is still unknown this long after its answer was due is given up \[µs\].
const GIVE_UP_US: u64 = 200_000;
/// Longest time that a rendered picture is waited for; tiles have to be made first.
const PATIENCE: Duration = Duration::from_secs(60);
/// A camera that went further between two pictures has another place before it \[mm\].
const FURTHEST_MM: f64 = 5.0;
/// Share of what the tracker believes of places ahead of a camera that is used.
const REACH: f64 = 0.9;
/// Share of it by which a camera may be beside the lead that the tracker was told: the rest is for where in the picture the seam is.
const AHEAD: f64 = 0.5;
/// What the walls of a corner are off their nominal slopes, standard deviation.
const WALL_SIGMA: f64 = 0.01;

/// Cameras with pictures.
#[derive(Clone)]
pub struct ImageCameras {
    /// What is known of camera 1 and 2.
    pub calibrations: [Calibration; SIDES],
    /// Where every picture is kept, if it is.
    pub kept: Option<[PictureQueue; SIDES]>,
    /// A camera (0 or 1) whose pictures are noted, and where. Nothing else is wanted then: those of the other one are not
    /// measured, nor are its own while nobody asks for ends.
    pub noted: Option<(usize, SightingLog)>,
    /// Where pictures are only shown to somebody: at most one is looked at in so long, and none is waited for, be it of a simulated
    /// camera.
    pub shown_every: Option<Duration>,
}

/// The cameras of all sides.
pub struct Images {
    sides: Vec<Side>,
    cameras: CameraConfig,
    heads: Heads,
    calibrations: [Calibration; SIDES],
    source: Box<dyn PictureSource>,
    /// Of the last capture, and when it was strobed by the motion board's clock \[µs\].
    last: Option<(Pose, Capture, u64)>,
    given_up: u32,
    /// Whether it is asked where the seams end.
    ends: bool,
    /// Time goes on while pictures are waited for.
    in_real_time: bool,
    shown: Option<Shown>,
}

/// One camera.
struct Side {
    worker: Worker,
    waiting: VecDeque<Waiting>,
    figures: CameraFigures,
    /// An answer that is ready for the tracker.
    held: Option<Held>,
}

/// An answer, and when it was due by the motion board's clock \[µs\].
struct Held {
    seen: MeasuredStrobe,
    due_us: u64,
}

/// A capture without an answer.
struct Waiting {
    capture: Capture,
    /// By the motion board's clock \[µs\].
    strobe_us: u64,
    due_us: u64,
    /// Whether its camera was told what stands before it.
    told: bool,
    /// Whether anybody looks at its picture.
    wanted: bool,
}

/// Trouble with a camera.
#[derive(Debug, thiserror::Error)]
#[error("camera {}: {source}", side + 1)]
pub struct ImagesError {
    /// 0 or 1.
    pub side: usize,
    /// What it is.
    pub source: WorkerError,
}

impl Images {
    /// Opens the cameras of a machine and starts their threads.
    ///
    /// # Errors
    /// [`ImagesError`].
    pub fn begin(
        of: &ImageCameras,
        mut source: Box<dyn PictureSource>,
        unit: &TrackingUnit,
        heads: Heads,
    ) -> Result<Self, ImagesError> {
        let cameras = &unit.cameras;
        let believes_mm = unit.board.tracking.gate_mm.min(unit.board.head.camera_lead_mm);
        let mut begin = |side: usize| -> Result<Side, WorkerError> {
            let calibration = of.calibrations[side];
            let lead_mm = heads.camera_lead();
            let ahead_mm = calibration.spot.map_or(0.0, |spot| spot.lead_mm - lead_mm);
            if ahead_mm.abs() > AHEAD * believes_mm {
                return Err(WorkerError::Lead {
                    is_mm: lead_mm + ahead_mm,
                    told_mm: lead_mm,
                });
            }
            let camera = source.open(side)?;
            let camera = match &of.kept {
                Some(queues) => Box::new(RecordingCamera::new(camera, queues[side].clone())),
                None => camera,
            };
            let (optics, noise) = (calibration.optics, calibration.photon_transfer);
            let detector = Detector::new(optics, noise, calibration.profile)?;
            let config = ObserverConfig {
                jump_mm: heads.camera_lead(),
                corner_offset_mm: calibration.corner_offset_mm,
                ..ObserverConfig::default()
            };
            let joint = match cameras.joint {
                JointForm::Gap => Joint::Gap,
                JointForm::Corner => Joint::Corner(Walls {
                    slopes: nominal_slopes(cameras.joint, calibration.slides.mount_rad(), &heads, side),
                    sigma: WALL_SIGMA,
                }),
            };
            let (looks, noted) = match &of.noted {
                None => (Looks::Always, None),
                Some((noted, log)) if *noted == side => (Looks::ForEnds, Some(log.clone())),
                Some(_) => (Looks::Never, None),
            };
            Ok(Side {
                worker: Worker::start(
                    side,
                    camera,
                    Observer::new(detector, config, joint),
                    Geometry {
                        calibration,
                        ahead_mm,
                        reach_mm: REACH * believes_mm - ahead_mm,
                    },
                    looks,
                    noted,
                ),
                waiting: VecDeque::new(),
                figures: CameraFigures::default(),
                held: None,
            })
        };
        let mut begin = |side| begin(side).map_err(|source| ImagesError { side, source });
        Ok(Self {
            sides: heads.sides().map(&mut begin).collect::<Result<_, _>>()?,
            cameras: cameras.clone(),
            heads,
            calibrations: of.calibrations,
            source,
            last: None,
            given_up: 0,
            ends: false,
            in_real_time: false,
            shown: of.shown_every.map(Shown::every),
        })
    }

    /// Whether answers are waited for, as they are due.
    fn waits(&self) -> bool {
        self.source.is_simulated() && self.shown.is_none()
    }

    /// Whether nobody looks at the pictures of a strobe at this time \[µs\].
    fn passes_over(&mut self, strobe_us: u64) -> bool {
        let is_busy = self.sides.iter().any(Side::is_looking);
        self.shown
            .as_mut()
            .is_some_and(|shown| is_busy || !shown.is_due(strobe_us))
    }

    /// How far a camera moved since the last capture; `None` if that is not known, or too far to see the same place.
    fn moved(&self, side: usize, pose: &Pose, capture: &Capture) -> Option<Moved> {
        let (last_pose, last, _) = self.last.as_ref()?;
        let (u, v) = (2 * side, 2 * side + 1);
        let ahead = [self.heads.camera_lead(), self.cameras.focus_above_mm()];
        let mount = self.calibrations[side].slides.mount_rad();
        let frame = |pose: &Pose| {
            let slides = capture.slides_mm;
            CameraFrame::new(&self.heads.spot(pose, side), mount, ahead, slides[u], slides[v])
        };
        let now = frame(pose);
        let way: Vector3<f64> = now.origin - frame(last_pose).origin;
        let [along, across, up] = now.turned(&way);
        let slide = |i: usize| capture.slides_mm[i] - last.slides_mm[i];
        let [lateral, height] = self.calibrations[side].camera_step(slide(u), slide(v));
        let moved = Moved {
            travel_mm: along,
            lateral_mm: across + lateral,
            height_mm: up + height,
        };
        let far = Vector3::new(moved.travel_mm, moved.lateral_mm, moved.height_mm).norm();
        (far < FURTHEST_MM).then_some(moved)
    }

    /// Tells simulated cameras where the machine truly was at the strobes that the boards have told about by now.
    fn tell(&mut self, at: Moment) {
        for (k, side) in self.sides.iter_mut().enumerate() {
            for waiting in side.waiting.iter_mut().filter(|waiting| !waiting.told) {
                let position =
                    (at.position)(waiting.strobe_us + self.source.delay_us(waiting.capture.number, k));
                if position.is_none() {
                    if at.now_us <= waiting.due_us + GIVE_UP_US {
                        break;
                    }
                    self.given_up += 1;
                }
                waiting.told = true;
                let known = position.as_ref().map(|position| (at.machine, position));
                self.source.tell(k, &waiting.capture, known, waiting.wanted);
            }
        }
    }
}

impl Images {
    /// When the picture of an answer was here, by the motion board's clock, which is at `now_us`.
    fn arrived_us(&self, held: &Held, now_us: u64) -> u64 {
        let arrived = now_us.saturating_sub(held.seen.arrived.elapsed().as_micros() as u64);
        if self.source.is_simulated() {
            arrived.max(held.due_us)
        } else {
            arrived
        }
    }
}

impl SeamCameras for Images {
    fn attach(&mut self, waker: Option<Waker>, events: &Events) {
        self.in_real_time = waker.is_some();
        for side in &self.sides {
            side.worker.attach(waker.clone(), events);
        }
    }

    fn strobe(&mut self, capture: Capture, strobe_us: u64, pose: Option<Pose>) {
        let delay_s = self.calibrations.map(|calibration| calibration.delay_s());
        let before_us = self.last.as_ref().map(|(.., us)| *us);
        let passed_over = self.passes_over(strobe_us);
        for side in self.heads.sides() {
            let moved = pose.and_then(|pose| self.moved(side, &pose, &capture));
            let late = self.source.late_us(capture.number, side);
            let this = &mut self.sides[side];
            let before = this.waiting.back().map_or(0, |before| before.due_us);
            let due_us = strobe_us + (self.cameras.processing_ms * 1e3) as u64 + late;
            this.figures.pictures += 1;
            this.figures.late += u32::from(late > 0);
            this.waiting.push_back(Waiting {
                capture,
                strobe_us,
                // One after the other.
                due_us: due_us.max(before),
                told: false,
                wanted: this.worker.wants(self.ends) && !passed_over,
            });
            let goes_on = moved.and_then(|moved| {
                let period_us = strobe_us.checked_sub(before_us?).filter(|us| *us > 0)?;
                let period_s = 1e-6 * period_us as f64;
                Some(times(&moved, delay_s[side] / period_s))
            });
            this.worker.strobe(Strobe {
                capture: capture.number,
                time_us: strobe_us,
                goes_on: goes_on.unwrap_or_default(),
                moved,
                ends: self.ends,
                passed_over,
            });
        }
        self.last = pose.map(|pose| (pose, capture, strobe_us));
    }

    fn motion(&mut self, samples: &[MotionSample]) {
        self.source.motion(samples);
    }

    fn look_for_ends(&mut self, wanted: bool) {
        self.ends = wanted;
    }

    fn next_due_us(&self) -> Option<u64> {
        if !self.waits() {
            return None;
        }
        let due = |side: &Side| Some(side.waiting.front()?.due_us);
        self.sides.iter().filter_map(due).min()
    }

    fn answer(&mut self, at: Moment) -> Result<Option<Answer>, ImagesError> {
        if self.source.is_simulated() {
            self.tell(at);
        }
        let waits = self.waits();
        loop {
            for (side, camera) in self.sides.iter_mut().enumerate() {
                let got = if waits {
                    camera.wait(at.now_us)
                } else {
                    camera.poll()
                };
                got.map_err(|source| ImagesError { side, source })?;
            }
            let numbers = self
                .sides
                .iter()
                .filter_map(|side| Some(side.held.as_ref()?.seen.capture));
            // Numbers begin anew after 2³².
            let first = numbers.reduce(|a, b| if (a.wrapping_sub(b) as i32) < 0 { a } else { b });
            let Some(capture) = first else {
                return Ok(None);
            };
            let held: [_; SIDES] = std::array::from_fn(|k| self.sides.get_mut(k)?.give(capture));
            let seen = held.each_ref().map(|held| Some(held.as_ref()?.seen));
            let sides = seen.map(|seen| seen?.measurement);
            if sides != [None; SIDES] {
                let arrived = held.iter().flatten().map(|held| self.arrived_us(held, at.now_us));
                return Ok(Some(Answer {
                    measurement: Measurement { capture, sides },
                    seams: seen.map(|seen| seen?.seen),
                    arrived_us: arrived.max().filter(|_| self.in_real_time),
                }));
            }
        }
    }

    fn given_up(&self) -> u32 {
        self.given_up
    }

    fn figures(&self) -> Option<[CameraFigures; SIDES]> {
        let of = |side: &Side| side.figures;
        Some(std::array::from_fn(|k| {
            self.sides.get(k).map(of).unwrap_or_default()
        }))
    }
}

/// Pictures that are only shown.
struct Shown {
    every_us: u64,
    /// When the next one is looked at, by the motion board's clock \[µs\].
    next_us: u64,
}

impl Shown {
    fn every(period: Duration) -> Self {
        Self {
            every_us: period.as_micros() as u64,
            next_us: 0,
        }
    }

    fn is_due(&mut self, now_us: u64) -> bool {
        let is_due = now_us >= self.next_us;
        if is_due {
            self.next_us = now_us + self.every_us;
        }
        is_due
    }
}

impl Side {
    /// Whether a picture that somebody looks at has no answer yet.
    fn is_looking(&self) -> bool {
        self.waiting.iter().any(|waiting| waiting.wanted)
    }

    /// Holds the next answer if it is due, and waits for it then.
    fn wait(&mut self, now_us: u64) -> Result<(), WorkerError> {
        let due = |waiting: &Waiting| waiting.told && waiting.due_us <= now_us;
        if self.held.is_none() && self.waiting.front().is_some_and(due) {
            let seen = self.worker.wait(PATIENCE)?;
            self.hold(seen);
        }
        Ok(())
    }

    /// Holds the next answer if there is one.
    fn poll(&mut self) -> Result<(), WorkerError> {
        if self.held.is_none()
            && let Some(seen) = self.worker.poll()?
        {
            self.hold(seen);
        }
        Ok(())
    }

    fn hold(&mut self, seen: MeasuredStrobe) {
        count(&mut self.figures, &seen);
        let due_us = self.waiting.pop_front().map_or(0, |waiting| waiting.due_us);
        self.held = Some(Held { seen, due_us });
    }

    /// The answer to a capture, if it is held.
    fn give(&mut self, capture: u32) -> Option<Held> {
        self.held.take_if(|held| held.seen.capture == capture)
    }
}

/// So many times as far.
fn times(moved: &Moved, factor: f64) -> Moved {
    Moved {
        travel_mm: factor * moved.travel_mm,
        lateral_mm: factor * moved.lateral_mm,
        height_mm: factor * moved.height_mm,
    }
}

fn count(figures: &mut CameraFigures, seen: &MeasuredStrobe) {
    let Some(observation) = &seen.observation else {
        figures.lost += 1;
        return;
    };
    figures.measured += u32::from(observation.seam.is_some());
    figures.refused += u32::from(observation.doubt.is_some());
    let shows = observation.seam.is_some() || observation.doubt.is_some();
    figures.without_seam += u32::from(!shows);
    figures.relocked += u32::from(observation.relocked);
}

#[cfg(test)]
mod tests;
