//! Opens the real cameras of a machine.

use crate::{Camera, CameraError};
pub use config::gige::GigeConfig;
use config::machine::CameraConfig;
use std::sync::Arc;
use vision::Optics;

/// Opens the camera of a side (0 or 1); the tracker board must not strobe yet.
pub type OpenCamera = Arc<dyn Fn(usize) -> Result<Box<dyn Camera>, CameraError> + Send + Sync>;

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
    Ok(Arc::new(move |side| {
        let camera = crate::GigeCamera::open(&gige.devices[side], &gige, optics.rows, optics.columns)?;
        Ok(Box::new(camera))
    }))
}

#[cfg(not(feature = "aravis"))]
fn opener(gige: GigeConfig, _: Optics) -> Result<OpenCamera, CameraError> {
    let [camera, _] = gige.devices;
    Err(CameraError::NotBuilt { camera })
}
