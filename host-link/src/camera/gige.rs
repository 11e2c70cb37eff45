//! The real cameras of a machine.

use super::{Camera, CameraError};
use crate::machine::CameraConfig;
use serde::Deserialize;
use shared::io::SIDES;

/// GigE Vision cameras that the tracker board strobes.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GigeConfig {
    /// Name, serial number or address of camera 1 and 2, as Aravis finds them (`arv-tool-0.8` lists all).
    pub devices: [String; SIDES],
    /// How many pixels of the sensor a side make one of the picture; 1 if not told.
    #[serde(default = "one")]
    pub binning: u32,
    /// Exposure \[µs\].
    pub exposure_us: f64,
    /// Input of the camera that is wired to the strobe, such as `"Line1"`; `"Software"` has the PC trigger, to try a camera
    /// without a board.
    pub trigger: String,
}

/// Opens the cameras of a machine; the tracker board must not strobe yet.
pub fn open(config: &CameraConfig) -> Result<[Box<dyn Camera>; SIDES], CameraError> {
    let gige = config.gige.as_ref().ok_or(CameraError::NotTold)?;
    let [first, second] = &gige.devices;
    Ok([one_of(config, gige, first)?, one_of(config, gige, second)?])
}

#[cfg(feature = "aravis")]
fn one_of(config: &CameraConfig, gige: &GigeConfig, device: &str) -> Result<Box<dyn Camera>, CameraError> {
    let camera = super::GigeCamera::open(device, gige, config.optics.rows, config.optics.columns)?;
    Ok(Box::new(camera))
}

#[cfg(not(feature = "aravis"))]
fn one_of(_: &CameraConfig, _: &GigeConfig, device: &str) -> Result<Box<dyn Camera>, CameraError> {
    Err(CameraError::NotBuilt {
        camera: device.to_owned(),
    })
}

fn one() -> u32 {
    1
}
