//! Cameras whose truth is known, calibrated from their pictures.

#[path = "../common/mod.rs"]
mod common;
mod corner;
mod depth;
mod slides;
mod spot;
mod transfer;

use common::OPTICS;
use vision::render::{Gap, Joint, Scene, Texture};
use vision::{Image, PlateSeam};

/// A picture of the tests' camera.
fn image(pixels: &[u8]) -> Image<'_> {
    Image::new(pixels, OPTICS.rows, OPTICS.columns).expect("a picture")
}

/// A plate at rest under the camera.
fn plate(height_mm: f64, width_mm: f64, texture: Texture) -> Scene {
    let plate = PlateSeam {
        height_mm,
        pitch: 0.0,
        roll: 0.03,
        lateral_mm: 0.05,
        yaw_rad: 0.0,
        width_mm,
    };
    Scene::new(Joint::Gap(Gap::new(plate)), texture)
}
