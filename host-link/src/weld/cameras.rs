//! The cameras of a session, whatever they are: captures in, measurements out.

use super::images::{Images, ImagesError};
use super::{JobError, Surroundings};
use crate::report::CameraFigures;
use crate::world::{GeometricCameras, Moment, SceneFile};
use camera::{OpenCamera, Shelf};
use config::calibration::Calibration;
use config::machine::TrackingUnit;
use shared::geometry::Pose;
use shared::io::SIDES;
use shared::protocol::{Capture, Measurement};
use shared::tracking::frames::Heads;
use vision::Seam;

/// Standard deviations in the noise of the machine file.
const SIGMAS: f64 = 3.0;

/// How the seams are seen.
#[derive(Clone, Default)]
pub enum CameraChoice {
    /// By geometry, without pictures.
    #[default]
    Geometric,
    /// In pictures.
    Images(Box<ImageCameras>),
}

impl CameraChoice {
    /// Whether they are real ones.
    pub fn real(&self) -> bool {
        matches!(self, Self::Images(images) if matches!(images.source, PictureSource::Real(_)))
    }
}

/// Cameras that give pictures.
#[derive(Clone)]
pub struct ImageCameras {
    /// What is known of camera 1 and 2.
    pub calibrations: [Calibration; SIDES],
    /// Where their pictures come from.
    pub source: PictureSource,
    /// Where copies of the pictures of each side go, if anywhere.
    pub kept: Option<[Shelf; SIDES]>,
}

/// Where pictures come from.
#[derive(Clone)]
pub enum PictureSource {
    /// Rendered, of seams that look like this.
    Rendered(SceneFile),
    /// From real cameras.
    Real(OpenCamera),
}

/// Both cameras of a machine.
pub(super) enum Cameras {
    /// Without pictures.
    Geometric(GeometricCameras),
    /// With pictures.
    Images(Box<Images>),
}

/// What came of a capture.
#[derive(Clone, Debug)]
pub(super) struct Answer {
    /// For the tracker.
    pub measurement: Measurement,
    /// What the pictures show, where there are any.
    pub seams: [Option<Seam>; SIDES],
}

impl From<Measurement> for Answer {
    fn from(measurement: Measurement) -> Self {
        let seams = [None; SIDES];
        Self { measurement, seams }
    }
}

impl Cameras {
    /// Those that `around` chooses.
    pub fn begin(unit: &TrackingUnit, heads: Heads, around: &Surroundings) -> Result<Self, JobError> {
        Ok(match &around.cameras {
            CameraChoice::Geometric => Self::Geometric(GeometricCameras::new(
                (unit.cameras.processing_ms * 1e3) as u64,
                unit.cameras.noise_3sigma_mm / SIGMAS,
                around.seed,
            )),
            CameraChoice::Images(images) => {
                Self::Images(Box::new(Images::begin(images, unit, heads, around.seed)?))
            }
        })
    }

    /// Takes a capture that was strobed at `strobe_us` of the motion clock; `pose` is the planned one there, if it is
    /// known.
    pub fn strobe(&mut self, capture: Capture, strobe_us: u64, pose: Option<Pose>) {
        match self {
            Self::Geometric(cameras) => cameras.strobe(capture, strobe_us),
            Self::Images(images) => images.strobe(capture, strobe_us, pose),
        }
    }

    /// When the next answer is due on the motion clock \[µs\], if that is known.
    pub fn next_due_us(&self) -> Option<u64> {
        match self {
            Self::Geometric(cameras) => cameras.next_due_us(),
            Self::Images(images) => images.next_due_us(),
        }
    }

    /// The next answer that is there.
    pub fn answer(&mut self, at: Moment) -> Result<Option<Answer>, ImagesError> {
        match self {
            Self::Geometric(cameras) => Ok(cameras.answer(at).map(Answer::from)),
            Self::Images(images) => images.answer(at),
        }
    }

    /// Captures that got no answer since nothing was known of their time.
    pub fn given_up(&self) -> u32 {
        match self {
            Self::Geometric(cameras) => cameras.given_up(),
            Self::Images(images) => images.given_up(),
        }
    }

    /// What became of the pictures of each side, if there are any.
    pub fn figures(&self) -> Option<[CameraFigures; SIDES]> {
        match self {
            Self::Geometric(_) => None,
            Self::Images(images) => Some(images.figures()),
        }
    }
}
