//! The real cameras of a machine.

use super::{Camera, CameraError};
use crate::machine::CameraConfig;
use serde::Deserialize;
use shared::io::SIDES;
use std::rc::Rc;
use vision::Optics;

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

/// Opens the camera of a side (0 or 1); the tracker board must not strobe yet.
pub type OpenCamera = Rc<dyn Fn(usize) -> Result<Box<dyn Camera>, CameraError>>;

/// What opens the real cameras of a machine.
///
/// # Errors
/// [`CameraError::NotTold`] and [`CameraError::NotBuilt`], before a board is asked for anything.
pub fn real(config: &CameraConfig) -> Result<OpenCamera, CameraError> {
    let gige = config.gige.clone().ok_or(CameraError::NotTold)?;
    opener(gige, config.optics)
}

#[cfg(feature = "aravis")]
fn opener(gige: GigeConfig, optics: Optics) -> Result<OpenCamera, CameraError> {
    Ok(Rc::new(move |side| {
        let camera = super::GigeCamera::open(&gige.devices[side], &gige, optics.rows, optics.columns)?;
        Ok(Box::new(camera))
    }))
}

#[cfg(not(feature = "aravis"))]
fn opener(gige: GigeConfig, _: Optics) -> Result<OpenCamera, CameraError> {
    let [camera, _] = gige.devices;
    Err(CameraError::NotBuilt { camera })
}

fn one() -> u32 {
    1
}
