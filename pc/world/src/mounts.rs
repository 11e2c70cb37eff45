//! Where simulated cameras truly are.

use plant_file::CameraMount;
use shared::io::{SIDES, SLIDES};
use shared::protocol::Capture;

/// Slide positions at which cameras that are mounted right would see what these see \[mm\].
pub fn mounted(capture: &Capture, mounts: &[CameraMount; SIDES]) -> [f64; SLIDES] {
    let slides = capture.truth_mm.unwrap_or(capture.slides_mm);
    std::array::from_fn(|i| slides[i] + mounts[i / 2].beside_spot_mm[i % 2])
}
