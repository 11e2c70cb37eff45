//! Measures pictures by themselves, away from a machine: what `seamwright measure` does.

mod canvas;
mod overlay;
mod record;
mod sheet;
mod summary;
mod table;
mod text;
mod verdict;
mod words;

pub use canvas::{Canvas, Colour, Pen};
pub use overlay::{draw, draw_plain};
pub use record::{Figure, MeasuredRecord, ObservedRecord, Record, SecondRecord};
pub use sheet::Sheet;
pub use summary::Summary;
pub use table::Table;
pub use text::{Font, wrapped};
pub use verdict::Verdict;

use crate::{Arrival, Camera, CameraError, Folder, Picture, read_grey};
use config::calibration::Calibration;
use std::path::{Path, PathBuf};
use std::time::Duration;
use thiserror::Error;
use vision::{
    Detector, DetectorError, ImageError, Joint, Moved, Observation, Observer, ObserverConfig, Prior, Report,
};

/// Why a picture is not measured. Reads as one sentence.
#[derive(Debug, Error)]
pub enum MeasureError {
    /// There is no picture.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// Its pixels make no picture.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The detector cannot measure it.
    #[error("{file}: {source}; take the calibration of the camera it comes from")]
    Detector {
        /// The file.
        file: String,
        /// What is wrong.
        source: DetectorError,
    },
}

/// A picture and what was measured in it.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The file.
    pub file: PathBuf,
    /// What the picture says by itself.
    pub report: Report,
    /// What an observer makes of it, if it is one of a sequence.
    pub observation: Option<Observation>,
}

/// Measures pictures of one camera.
#[derive(Clone, Debug)]
pub struct Measuring {
    detector: Detector,
    calibration: Calibration,
    joint: Joint,
}

impl Measuring {
    /// Measures pictures that show a joint.
    pub fn new(calibration: Calibration, joint: Joint) -> Result<Self, DetectorError> {
        let Calibration {
            optics,
            photon_transfer,
            profile,
            ..
        } = calibration;
        Ok(Self {
            detector: Detector::new(optics, photon_transfer, profile)?,
            calibration,
            joint,
        })
    }

    /// The calibration it measures with.
    pub fn calibration(&self) -> &Calibration {
        &self.calibration
    }

    /// Measures the picture in a file, of which nothing is known before; `picture` takes its pixels.
    pub fn file(&mut self, file: &Path, picture: &mut Picture) -> Result<Outcome, MeasureError> {
        read_grey(file, picture).map_err(CameraError::from)?;
        let prior = Prior {
            joint: self.joint,
            track: None,
            focus: 0.0,
        };
        let report = self
            .detector
            .measure(&picture.image()?, &prior)
            .map_err(|source| MeasureError::Detector {
                file: file.display().to_string(),
                source,
            })?;
        Ok(Outcome {
            file: file.to_owned(),
            report,
            observation: None,
        })
    }

    /// Measures the pictures of a folder of captures one after the other, as a camera's that stays where it is. `each` is
    /// told of every one.
    pub fn folder(
        &self,
        folder: &Path,
        mut each: impl FnMut(Result<Outcome, MeasureError>, &Picture),
    ) -> Result<(), MeasureError> {
        let mut folder = Folder::open(folder)?;
        let config = ObserverConfig {
            corner_offset_mm: self.calibration.corner_offset_mm,
            ..ObserverConfig::default()
        };
        let mut observer = Observer::new(self.detector.clone(), config, self.joint);
        let mut picture = Picture::default();
        for recorded in folder.recorded().to_vec() {
            folder.strobed(recorded.capture, recorded.time_us);
            let outcome = match folder.next(Duration::ZERO, &mut picture) {
                Err(error) => Err(error.into()),
                // The folder holds every capture it lists.
                Ok(Arrival::Lost { .. } | Arrival::Nothing) => continue,
                Ok(Arrival::Picture) => observe(&mut observer, &picture, recorded.file),
            };
            each(outcome, &picture);
        }
        Ok(())
    }
}

/// Hands a picture to the observer.
fn observe(observer: &mut Observer, picture: &Picture, file: PathBuf) -> Result<Outcome, MeasureError> {
    let observation = observer
        .observe(&picture.image()?, Moved::default())
        .map_err(|source| MeasureError::Detector {
            file: file.display().to_string(),
            source,
        })?;
    Ok(Outcome {
        file,
        report: observation.report,
        observation: Some(observation),
    })
}
