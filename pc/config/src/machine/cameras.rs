//! The cameras of a machine: what the drawing says of them, and where their calibrations are.

use crate::by_side::{by_side, some_by_side};
use crate::calibration::{Calibration, CalibrationError, OpticsTable, PhotonTransferTable};
use crate::gige::GigeConfig;
use serde::{Deserialize, Deserializer};
use shared::io::SIDES;
use std::path::{Path, PathBuf};
use vision::{Optics, PhotonTransfer};

/// The cameras; lead and frame period are parameters of the tracker board. Of lists in the file one value stands for both sides.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraConfig {
    /// From the strobe to the measurement, of simulated cameras \[ms\].
    pub processing_ms: f64,
    /// Noise of a measurement of cameras without pictures, three standard deviations \[mm\].
    pub noise_3sigma_mm: f64,
    /// What the joint looks like to them.
    pub joint: JointForm,
    /// How each camera is turned about T against its head: n = Rot(T, mount)·N_k \[°\].
    #[serde(deserialize_with = "by_side")]
    pub mount_deg: [f64; SIDES],
    /// See [`CameraConfig::focus_above_mm`].
    focus_above_mm: Option<f64>,
    /// Lens and sensor by the drawing.
    #[serde(deserialize_with = "optics")]
    pub optics: Optics,
    /// Noise of the sensor by its data sheet.
    #[serde(deserialize_with = "photon_transfer")]
    pub photon_transfer: PhotonTransfer,
    /// Calibration files of camera 1 and 2, beside the machine file; without them both are as drawn.
    #[serde(default, deserialize_with = "some_by_side")]
    pub calibration: Option<[PathBuf; SIDES]>,
    /// The real cameras, if they are GigE Vision.
    pub gige: Option<GigeConfig>,
}

/// What a joint looks like to a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum JointForm {
    /// An open gap in a plate, seen along the plate's normal.
    Gap,
    /// The closed corner of two walls.
    Corner,
}

/// Where the root of a corner stands below the focal point \[mm\]: walls rise from it, so that it may stray about as far
/// up, until too little of them is in the picture, as down, where the picture ends.
const ROOT_BELOW_MM: f64 = 0.15;

impl CameraConfig {
    /// How far the point at which the axis of a camera meets its focal plane stands above the seam, along the camera's n,
    /// when the beam meets the seam \[mm\]: as the machine file says, else what suits the joint.
    pub fn focus_above_mm(&self) -> f64 {
        self.focus_above_mm.unwrap_or(match self.joint {
            JointForm::Gap => 0.0,
            JointForm::Corner => ROOT_BELOW_MM,
        })
    }

    /// What is known of camera 1 and 2: their calibration files, whose names are relative to the machine file's
    /// `folder`, or what the drawing says.
    pub fn calibrations(&self, folder: &Path) -> Result<[Calibration; SIDES], CalibrationError> {
        match &self.calibration {
            Some([first, second]) => {
                let read = |file: &PathBuf| Calibration::read(&folder.join(file));
                Ok([read(first)?, read(second)?])
            }
            None => Ok(std::array::from_fn(|side| self.nominal(side))),
        }
    }

    /// What the drawing says of the camera of `side` (0 or 1).
    pub fn nominal(&self, side: usize) -> Calibration {
        let mount_rad = self.mount_deg[side].to_radians();
        let mut calibration = Calibration::nominal(self.optics, self.photon_transfer, mount_rad);
        calibration.slides.offset_mm = calibration.slides.deltas(0.0, self.focus_above_mm());
        calibration
    }
}

fn optics<'de, D: Deserializer<'de>>(table: D) -> Result<Optics, D::Error> {
    OpticsTable::deserialize(table).map(Optics::from)
}

fn photon_transfer<'de, D: Deserializer<'de>>(table: D) -> Result<PhotonTransfer, D::Error> {
    PhotonTransferTable::deserialize(table).map(PhotonTransfer::from)
}
