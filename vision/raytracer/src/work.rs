//! What stands before the camera.

use crate::texture::Texture;
use vision::Optics;

/// One side of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side {
    /// Brightness of its plate; 1 is that of the light's level.
    pub brightness: f64,
    /// Leg of a chamfer of 45° \[mm\]; the root edge is where it meets the wall.
    pub chamfer_mm: f64,
    /// What the chamfer multiplies the plate's brightness by.
    pub chamfer_brightness: f64,
    /// Radius of a rolled edge \[mm\].
    pub rounding_mm: f64,
    /// Height of a burr \[mm\].
    pub burr_mm: f64,
    /// Brightness of the gap's wall; it fades with depth.
    pub wall_brightness: f64,
    /// Width \[mm\] and factor of a bright line along the edge.
    pub rim: [f64; 2],
    /// Place along the seam where the plate ends \[mm\].
    pub ends_mm: f64,
}

impl Default for Side {
    fn default() -> Self {
        Self {
            brightness: 1.0,
            chamfer_mm: 0.0,
            chamfer_brightness: 1.0,
            rounding_mm: 0.0,
            burr_mm: 0.0,
            wall_brightness: 0.02,
            rim: [0.0, 1.0],
            ends_mm: f64::INFINITY,
        }
    }
}

/// A mark along the seam: a scratch, a groove, a stain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// Its middle, from the middle of the seam at a = 0 \[mm\].
    pub offset_mm: f64,
    /// Width \[mm\].
    pub width_mm: f64,
    /// What it multiplies the brightness by.
    pub factor: f64,
    /// Slope against the seam: dx/ds.
    pub slope: f64,
}

/// A shadow beside an edge, on one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shadow {
    /// 0 left, 1 right.
    pub side: usize,
    /// Width from the edge \[mm\].
    pub width_mm: f64,
    /// What it multiplies the brightness by.
    pub factor: f64,
}

/// Spatter: a round spot over plate and gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blob {
    /// Along the seam and across it \[mm\].
    pub middle_mm: [f64; 2],
    /// Radius \[mm\].
    pub radius_mm: f64,
    /// How bright it is.
    pub brightness: f64,
}

/// A round brightness in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glare {
    /// Its middle, −1…1 across columns and rows.
    pub middle: [f64; 2],
    /// Its standard deviation on that scale.
    pub radius: f64,
    /// Share of full scale in its middle.
    pub level: f64,
}

/// A plate joint with a gap, and everything about it.
#[derive(Clone, Debug)]
pub struct Work {
    /// h: height of the plate at a = u = 0 \[mm\].
    pub height_mm: f64,
    /// q: slope of the plate across the seam.
    pub roll: f64,
    /// u0: where the middle of the seam crosses a = 0 \[mm\].
    pub lateral_mm: f64,
    /// ψ: angle of the seam against travel, positive towards +u \[rad\].
    pub yaw_rad: f64,
    /// Width between the root edges, square to the seam \[mm\]; 0 of a closed joint.
    pub width_mm: f64,
    /// How much higher the right plate lies \[mm\].
    pub step_mm: f64,
    /// Left and right.
    pub sides: [Side; 2],
    /// Texture left and right.
    pub textures: [Texture; 2],
    /// Standard deviation of the edges from straight lines \[mm\].
    pub roughness_mm: f64,
    /// Marks along the seam.
    pub marks: Vec<Mark>,
    /// Shadows beside the edges.
    pub shadows: Vec<Shadow>,
    /// Spatter.
    pub blobs: Vec<Blob>,
    /// Where along the seam the picture is \[mm\].
    pub along_mm: f64,
    /// Mean of a plate of brightness 1, as a share of full scale.
    pub level: f64,
    /// Slopes of the light across columns and rows, a share from the middle to the border.
    pub shading: [f64; 2],
    /// Share of full scale that lies over everything as a veil.
    pub veil: f64,
    /// Glare of lamp or plume.
    pub glare: Option<Glare>,
}

/// What a measurement should find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// u of the middle between the root edges, where the focal plane meets it \[mm\].
    pub lateral_mm: f64,
    /// n of that point \[mm\].
    pub height_mm: f64,
    /// Width between the root edges \[mm\].
    pub width_mm: f64,
    /// Right plate over the left one \[mm\].
    pub step_mm: f64,
    /// q.
    pub roll: f64,
}

impl Work {
    /// Where the seam's middle meets the focal plane, whose normal is (−sin α, 0, cos α).
    pub fn truth(&self, optics: &Optics) -> Truth {
        let (sin, cos) = optics.tilt_rad.sin_cos();
        // The seam is (a, u0 + a tan ψ, h + q u).
        let slope = self.yaw_rad.tan();
        let at_0 = self.height_mm + self.roll * self.lateral_mm;
        let a = at_0 * cos / (sin - self.roll * slope * cos);
        let u = self.lateral_mm + a * slope;
        Truth {
            lateral_mm: u,
            height_mm: self.height_mm + self.roll * u,
            width_mm: self.width_mm,
            step_mm: self.step_mm,
            roll: self.roll,
        }
    }
}
