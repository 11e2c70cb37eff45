//! What is known of a camera: its lens and noise, its depth profile, and how its picture lies to the slides.

mod error;
mod file;

pub use error::CalibrationError;
pub use file::{OpticsTable, PhotonTransferTable};

use shared::protocol::SideMeasurement;
use std::path::Path;
use vision::{Optics, PhotonTransfer, Profile};

/// Smallest determinant of a camera–slide matrix; that of a camera square to its slides is 1.
const SMALLEST_DETERMINANT: f64 = 0.1;

/// The calibration of one camera, in the units of the computer: mm and rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Lens and sensor.
    pub optics: Optics,
    /// Noise of the sensor.
    pub photon_transfer: PhotonTransfer,
    /// Width of the sharp band.
    pub profile: Profile,
    /// From the picture to the slides.
    pub slides: SlideMap,
    /// What is added to u and n of a measured corner so that they agree with the same seam's as a gap \[mm\]: a rounded
    /// root looks higher than it is. `None` if it was not measured.
    pub corner_offset_mm: Option<[f64; 2]>,
    /// Where and when the camera truly looks, if that was measured against the spot.
    pub spot: Option<SpotCalibration>,
}

/// What a mark of the beam tells of a camera, beside the offset of [`SlideMap`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpotCalibration {
    /// How far ahead of the spot the camera is \[mm\].
    pub lead_mm: f64,
    /// From the strobe to the exposure \[s\].
    pub delay_s: f64,
    /// Of the offset in U and V, two standard deviations \[mm\].
    pub uncertainty_mm: [f64; 2],
}

/// How the camera's frame (u across, n out of the work, mathematics 0.12) lies to the slides that carry it:
/// \[ΔU ΔV\] = matrix · \[u n\] + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlideMap {
    /// Rows ΔU and ΔV, columns u and n.
    pub matrix: [[f64; 2]; 2],
    /// ΔU, ΔV of the frame's origin: where it lies beside the spot \[mm\].
    pub offset_mm: [f64; 2],
}

impl SlideMap {
    /// Of a camera whose frame is the head's turned by `mount_rad` about T: n = Rot(T, mount)·N_k, the origin on the
    /// spot. The head is then turned by −mount from n (mathematics 0.7).
    pub fn nominal(mount_rad: f64) -> Self {
        let (sin, cos) = (-mount_rad).sin_cos();
        Self {
            matrix: [[-cos, -sin], [sin, -cos]],
            offset_mm: [0.0; 2],
        }
    }

    /// How the camera is turned about T against its head, as [`SlideMap::nominal`] has it \[rad\]; the turn that is
    /// nearest to the matrix.
    pub fn mount_rad(&self) -> f64 {
        let [[a, b], [c, d]] = self.matrix;
        (b - c).atan2(-a - d)
    }

    /// ΔU, ΔV of a place in the camera's frame \[mm\].
    pub fn deltas(&self, lateral_mm: f64, height_mm: f64) -> [f64; 2] {
        let [u, v] = self.matrix;
        [
            u[0] * lateral_mm + u[1] * height_mm + self.offset_mm[0],
            v[0] * lateral_mm + v[1] * height_mm + self.offset_mm[1],
        ]
    }

    /// Determinant of the matrix: 1 of a camera without errors of scale, below 0 of a mirrored picture.
    pub fn determinant(&self) -> f64 {
        let [[a, b], [c, d]] = self.matrix;
        a * d - b * c
    }

    /// Whether the matrix is invertible, so that it shows every motion of the slides, and the picture is not
    /// mirrored.
    pub fn is_regular(&self) -> bool {
        let finite = |row: &[f64; 2]| row.iter().all(|x| x.is_finite());
        self.matrix.iter().all(finite) && self.determinant() >= SMALLEST_DETERMINANT
    }
}

impl Calibration {
    /// What the drawing says of a camera: a lens without faults, turned by `mount_rad` about T against its head, its
    /// axis through the point a lead ahead of the spot.
    pub fn nominal(optics: Optics, photon_transfer: PhotonTransfer, mount_rad: f64) -> Self {
        Self {
            optics,
            photon_transfer,
            profile: Profile::expected(&optics),
            slides: SlideMap::nominal(mount_rad),
            corner_offset_mm: None,
            spot: None,
        }
    }

    /// From the strobe to the exposure, as far as that is known \[s\].
    pub fn delay_s(&self) -> f64 {
        self.spot.map_or(0.0, |spot| spot.delay_s)
    }

    /// Reads the file at `path`.
    pub fn read(path: &Path) -> Result<Self, CalibrationError> {
        let name = path.display().to_string();
        match std::fs::read_to_string(path) {
            Ok(text) => Self::parse(&name, &text),
            Err(source) => Err(CalibrationError::Read { path: name, source }),
        }
    }

    /// Understands `text`; `name` of the file is used in messages only.
    pub fn parse(name: &str, text: &str) -> Result<Self, CalibrationError> {
        file::parse(name, text)
    }

    /// The text of its file.
    pub fn to_toml(&self) -> String {
        file::write(self)
    }

    /// The measurement for the tracker of a seam seen at `lateral_mm` (u), `travel_mm` (a) and `height_mm`
    /// (n) of the camera's frame.
    pub fn side_measurement(&self, lateral_mm: f64, travel_mm: f64, height_mm: f64) -> SideMeasurement {
        let [delta_u_mm, delta_v_mm] = self.slides.deltas(lateral_mm, height_mm);
        SideMeasurement {
            along_mm: travel_mm,
            delta_u_mm,
            delta_v_mm,
        }
    }

    /// How far the camera moves in its own frame, \[u, n\], when the slides move by `delta_u_mm` and `delta_v_mm`.
    pub fn camera_step(&self, delta_u_mm: f64, delta_v_mm: f64) -> [f64; 2] {
        let [[a, b], [c, d]] = self.slides.matrix;
        let one = 1.0 / self.slides.determinant();
        [
            (d * delta_u_mm - b * delta_v_mm) * one,
            (a * delta_v_mm - c * delta_u_mm) * one,
        ]
    }
}

#[cfg(test)]
mod tests;
