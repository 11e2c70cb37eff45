//! The real cameras of a machine.

use crate::by_side::by_side;
use serde::Deserialize;
use shared::io::SIDES;

/// GigE Vision cameras that the tracker board strobes.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GigeConfig {
    /// Name, serial number or address of camera 1 and 2, as Aravis finds them (`arv-tool-0.8` lists all); one name on a machine with one side.
    #[serde(deserialize_with = "by_side")]
    pub devices: [String; SIDES],
    /// How many pixels of the sensor a side make one of the picture; 1 if not given.
    #[serde(default = "one")]
    pub binning: u32,
    /// Exposure \[µs\].
    pub exposure_us: f64,
    /// Input of the camera that is wired to the strobe, such as `"Line1"`; `"Software"` has the PC trigger, to try a camera
    /// without a board.
    pub trigger: String,
}

fn one() -> u32 {
    1
}
