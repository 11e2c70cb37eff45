//! One camera's seam from picture to picture: acquired, tracked, lost.

mod followed;
mod gate;
mod places;
mod running;
mod seam;

use crate::detector::{Detector, DetectorError};
use crate::image::Image;
use crate::prior::{Joint, Prior, Track, Walls};
use crate::report::{Form, Measured, Sigma, Status};
use gate::{Gate, Verdict};
use places::Places;
use running::Running;
use serde::{Deserialize, Serialize};

pub use gate::Doubt;
pub use seam::{MeanPoint, Moved, Observation, Seam};

/// Fewest pictures of which a point is the mean.
const FEWEST_PLACES: usize = 4;

/// Pictures over which the pitch is taken.
const PITCH_FRAMES: usize = 16;

/// Share of a picture's focus that goes into the running one.
const FOCUS_SHARE: f64 = 0.05;

/// How well the slopes of walls are known at best: then they are means of some hundred pictures, and follow a bend.
const WALL_SIGMA: f64 = 0.003;

/// Equal votes for "too high" or "too low" before it is said.
const VOTES: u32 = 3;

/// How an observer judges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObserverConfig {
    /// How far a new seam may lie from where it was in the last picture, and a followed one from where it has to be, at
    /// most \[mm\].
    pub gate_mm: f64,
    /// How far something else has to be seen in place of the followed seam before it is believed to be the seam \[mm of
    /// travel\]: as far as the camera looks ahead of the spot. To wait so long costs nothing: the spot is not yet past what was believed.
    pub jump_mm: f64,
    /// Pictures without an accepted seam after which it is lost.
    pub hold_frames: u32,
    /// Pictures of which the mean point and roll are means; at least 4 count.
    pub mean_frames: usize,
    /// What is added to a corner's lateral position and height so that they agree with a gap's \[mm\]. Without it the
    /// form that was acquired is kept until the seam is lost.
    pub corner_offset_mm: Option<[f64; 2]>,
}

impl Default for ObserverConfig {
    fn default() -> Self {
        Self {
            gate_mm: 0.1,
            jump_mm: 10.0,
            hold_frames: 20,
            mean_frames: FEWEST_PLACES,
            corner_offset_mm: None,
        }
    }
}

/// What an observer is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Looking for the seam in whole pictures, until 3 in a row agree.
    Acquiring,
    /// Following it.
    Tracking,
    /// It was followed and is lost; it is looked for again.
    Lost,
}

/// Follows the seam of one camera.
#[derive(Clone, Debug)]
pub struct Observer {
    detector: Detector,
    config: ObserverConfig,
    joint: Joint,
    state: State,
    /// Form of the seam that is followed.
    form: Option<Form>,
    track: Option<Track>,
    gate: Gate,
    missed: u32,
    focus: f64,
    /// Where the camera is, as the sum of its moves \[mm\].
    place: Moved,
    /// Where the seam was seen, of a camera that stays; roll slopes and steps of the same pictures.
    places: Places,
    rolls: Running,
    steps: Running,
    /// The same of more pictures, for the pitch.
    way: Places,
    /// What the last pictures without a band said, and how often.
    votes: (Status, u32),
}

impl Observer {
    /// An observer of a joint; the walls of a corner are those of the programmed pose.
    pub fn new(detector: Detector, config: ObserverConfig, joint: Joint) -> Self {
        let frames = config.mean_frames.max(FEWEST_PLACES);
        let optics = detector.optics();
        let [rows, columns] = [optics.rows, optics.columns].map(|count| count as f64 / 2.0);
        let pixel = optics.object_pixel_mm();
        let view_mm = [columns * pixel, rows * pixel * optics.tilt_rad.sin()];
        Self {
            detector,
            config,
            joint,
            state: State::Acquiring,
            form: None,
            track: None,
            gate: Gate::new(config.gate_mm, config.jump_mm, view_mm),
            missed: 0,
            focus: 0.0,
            place: Moved::default(),
            places: Places::new(frames),
            rolls: Running::new(frames),
            steps: Running::new(frames),
            way: Places::new(PITCH_FRAMES),
            votes: (Status::NoBand, 0),
        }
    }

    /// Its detector.
    pub fn detector(&self) -> &Detector {
        &self.detector
    }

    /// What it is doing.
    pub fn state(&self) -> State {
        self.state
    }

    /// The joint it looks for, with the slopes of the walls as it has learnt them.
    pub fn joint(&self) -> Joint {
        self.joint
    }

    /// Forgets where the seam was, and acquires it again.
    pub fn forget(&mut self) {
        self.lose(State::Acquiring);
        self.gate.forget();
    }

    /// Measures a picture; the camera has moved since the last one.
    pub fn observe(&mut self, image: &Image, moved: Moved) -> Result<Observation, DetectorError> {
        self.follow(moved);
        let prior = Prior {
            joint: self.expected_joint(),
            track: self.track.filter(|_| self.state == State::Tracking),
            focus: self.focus,
        };
        let report = self.detector.measure(image, &prior)?;
        self.vote(report.status);
        let measured = report.measured.map(|measured| self.as_gap(&measured));
        let verdict = self.gate.judge(&report, measured.as_ref(), &self.place);
        let (mut seam, mut doubt, mut relocked) = (None, None, false);
        match (verdict, measured) {
            (Verdict::Accept { new, jumped }, Some(measured)) => {
                relocked = jumped;
                if new {
                    self.restart();
                }
                seam = Some(self.accept(&measured));
            }
            (Verdict::Doubt(why), _) => {
                doubt = Some(why);
                self.miss();
            }
            _ => self.miss(),
        }
        Ok(Observation {
            report,
            state: self.state,
            seam,
            doubt,
            relocked,
            out_of_view: (self.votes.1 >= VOTES).then_some(self.votes.0),
        })
    }

    /// Sees what is known from where the camera is now.
    fn follow(&mut self, moved: Moved) {
        self.place.travel_mm += moved.travel_mm;
        self.place.lateral_mm += moved.lateral_mm;
        self.place.height_mm += moved.height_mm;
        let expected = self.gate.expected_mm(&self.place);
        let of_gap = self.form == Some(Form::Gap);
        self.track = self.track.zip(expected).map(|(track, expected)| {
            // Of a corner where it was seen last is the better guess: its heights scatter more than they turn.
            let last = [
                track.lateral_mm - moved.lateral_mm,
                track.height_mm - moved.height_mm,
            ];
            let [lateral_mm, height_mm] = if of_gap { expected } else { last };
            Track {
                lateral_mm,
                height_mm,
                ..track
            }
        });
    }

    /// What the next picture may show: both forms only if their places can be compared.
    fn expected_joint(&self) -> Joint {
        match (self.joint, self.form, self.config.corner_offset_mm) {
            (Joint::GapOrCorner(_), Some(Form::Gap), None) => Joint::Gap,
            (Joint::GapOrCorner(walls), Some(Form::Corner), None) => Joint::Corner(walls),
            (joint, ..) => joint,
        }
    }

    /// A measurement as one of a gap.
    fn as_gap(&self, measured: &Measured) -> Measured {
        let offset = self.config.corner_offset_mm;
        let [lateral, height] = offset
            .filter(|_| measured.form == Form::Corner)
            .unwrap_or_default();
        Measured {
            lateral_mm: measured.lateral_mm + lateral,
            height_mm: measured.height_mm + height,
            ..*measured
        }
    }

    /// Takes an accepted measurement.
    fn accept(&mut self, measured: &Measured) -> Seam {
        self.state = State::Tracking;
        self.missed = 0;
        self.form = Some(measured.form);
        self.focus += FOCUS_SHARE * (measured.focus - self.focus);
        self.learn_walls(measured);
        self.places.push(measured, &self.place);
        self.way.push(measured, &self.place);
        self.rolls.push(measured.roll);
        self.steps.push(measured.step_mm);
        self.track = Some(Track {
            lateral_mm: measured.lateral_mm,
            height_mm: measured.height_mm,
            roll: self.rolls.mean(1).unwrap_or(measured.roll),
            width_mm: self.gate.width_mm(),
        });
        let averaged = 1.0 / (self.places.len() as f64).sqrt();
        Seam {
            form: measured.form,
            lateral_mm: measured.lateral_mm,
            travel_mm: measured.travel_mm,
            mean: self.places.mean(FEWEST_PLACES, &self.place),
            width_mm: measured.width_mm,
            step_mm: self.steps.mean(1).unwrap_or(measured.step_mm),
            roll: self.rolls.mean(1).unwrap_or(measured.roll),
            pitch: self.way.pitch(PITCH_FRAMES),
            yaw_rad: measured.yaw_rad,
            quality: measured.quality,
            sigma: Sigma {
                height_mm: measured.sigma.height_mm * averaged,
                step_mm: measured.sigma.step_mm * averaged,
                roll: measured.sigma.roll * averaged,
                ..measured.sigma
            },
        }
    }
}

/// What pictures do to what is remembered.
impl Observer {
    /// What a corner showed of the walls, with what was known before, is known from now on.
    fn learn_walls(&mut self, measured: &Measured) {
        let (Joint::Corner(walls) | Joint::GapOrCorner(walls)) = &mut self.joint else {
            return;
        };
        if measured.form == Form::Corner {
            let [left, right] = measured.sigma.walls;
            *walls = Walls {
                slopes: measured.walls,
                sigma: left.max(right).clamp(WALL_SIGMA.min(walls.sigma), walls.sigma),
            };
        }
    }

    /// A picture without an accepted seam.
    fn miss(&mut self) {
        self.missed += 1;
        if self.state == State::Tracking && self.missed > self.config.hold_frames {
            self.lose(State::Lost);
            self.gate.lose();
        } else if self.missed as usize >= self.places.room() {
            self.restart();
        }
    }

    /// Forgets the seam.
    fn lose(&mut self, state: State) {
        self.state = state;
        self.form = None;
        self.track = None;
        self.missed = 0;
        self.restart();
    }

    /// Begins all means again.
    fn restart(&mut self) {
        self.places.clear();
        self.rolls.clear();
        self.steps.clear();
        self.way.clear();
    }

    /// Counts equal answers without a band.
    fn vote(&mut self, status: Status) {
        let count = match status {
            Status::TooHigh | Status::TooLow if status == self.votes.0 => self.votes.1 + 1,
            Status::TooHigh | Status::TooLow => 1,
            _ => 0,
        };
        self.votes = (status, count);
    }
}
