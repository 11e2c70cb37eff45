//! What stands before the camera.

use super::film::{Film, Sensor};
use super::marks::{Mark, Tack};
use super::side::Side;
use super::texture::Texture;
use crate::geometry::{Corner, PlateSeam};
use crate::optics::Optics;

/// Work, marks on it, and light. Directions are those of mathematics 0.12: a along travel, u across, n out
/// of the plate, origin where the optical axis meets the focal plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The joint.
    pub joint: Joint,
    /// How the work's surface looks close up.
    pub texture: Texture,
    /// How it looks right of a gap, if not the same.
    pub right_texture: Option<Texture>,
    /// The two sides of a gap.
    pub sides: [Side; 2],
    /// Where on the work the frame's origin is: along travel and across \[mm\]. The texture and the blobs keep their
    /// place on the work when this changes from frame to frame.
    pub position_mm: [f64; 2],
    /// Lines and strips parallel to the seam.
    pub stripes: Vec<Stripe>,
    /// Scratches and grooves with a place on the work.
    pub marks: Vec<Mark>,
    /// Beads that close the gap.
    pub tacks: Vec<Tack>,
    /// Spatter.
    pub blobs: Vec<Blob>,
    /// The light.
    pub light: Light,
    /// What lies over the picture.
    pub film: Film,
    /// How far the work travels during the exposure \[mm\].
    pub smear_mm: f64,
    /// Curvature of the field: how much nearer to the camera than in the middle best focus lies in the picture's corners
    /// \[mm\]; between it goes with the square of the distance from the middle.
    pub curvature_mm: f64,
    /// The sensor, where it is not as calibrated.
    pub sensor: Sensor,
}

/// The two forms of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint {
    /// A plate with a visible gap.
    Gap(Gap),
    /// The closed corner of a T joint.
    Corner(Root),
}

/// A plate with a gap in it; a width of 0 is a closed one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Plate and seam.
    pub plate: PlateSeam,
    /// t: how much higher the plate is right of the seam than left; its height is the mean of both \[mm\].
    pub step_mm: f64,
    /// Standard deviation of the edges from straight lines \[mm\].
    pub roughness_mm: f64,
    /// How bright the gap is, the plate being 1.
    pub brightness: f64,
}

/// The corner where two walls meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// The walls.
    pub corner: Corner,
    /// Radius of the rounding at the root \[mm\].
    pub rounding_mm: f64,
    /// How bright the walls are, left and right.
    pub brightness: [f64; 2],
    /// By how much light from wall to wall brightens them at the root; it fades over 0.1 mm.
    pub interreflection: f64,
}

/// A line or strip parallel to the seam: a scratch, the rim of an edge, a stain beside the gap, the dark line where
/// walls touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stripe {
    /// Its middle, from the middle of the seam and square to it \[mm\].
    pub offset_mm: f64,
    /// Width \[mm\].
    pub width_mm: f64,
    /// What it multiplies the surface's brightness by.
    pub factor: f64,
}

/// A round spot that covers surface and gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blob {
    /// Its middle on the work: along travel and across \[mm\].
    pub middle_mm: [f64; 2],
    /// Radius \[mm\].
    pub radius_mm: f64,
    /// How bright it is, the plate being 1.
    pub brightness: f64,
}

/// Light and lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Mean of the plate in the middle of the picture, as a share of full scale: 0 is off, above 1 saturates.
    pub level: f64,
    /// Shading (1 + s₀x + s₁y)·(1 − s₂(x² + y²)/2), x, y −1…1 over columns and rows (mathematics 0.12).
    pub shading: [f64; 3],
    /// Share of the plate's mean that lies over everything as a veil.
    pub haze: f64,
}

impl Light {
    /// Even light that makes the plate's mean `level` of full scale.
    pub fn even(level: f64) -> Self {
        Self {
            level,
            shading: [0.0; 3],
            haze: 0.0,
        }
    }

    /// Illumination at `x`, `y` (−1…1 across columns and rows), as a share of full scale.
    pub(super) fn at(&self, x: f64, y: f64) -> f64 {
        let [s0, s1, s2] = self.shading;
        self.level * (1.0 + s0 * x + s1 * y) * (1.0 - s2 * (x * x + y * y) / 2.0)
    }
}

impl Scene {
    /// A bare joint in even light, half of full scale, at rest.
    pub fn new(joint: Joint, texture: Texture) -> Self {
        Self {
            joint,
            texture,
            position_mm: [0.0; 2],
            right_texture: None,
            sides: [Side::default(); 2],
            stripes: Vec::new(),
            marks: Vec::new(),
            tacks: Vec::new(),
            blobs: Vec::new(),
            light: Light::even(0.5),
            film: Film::default(),
            smear_mm: 0.0,
            curvature_mm: 0.0,
            sensor: Sensor::default(),
        }
    }

    /// Textures left and right of the seam.
    pub fn textures(&self) -> [Texture; 2] {
        [self.texture, self.right_texture.unwrap_or(self.texture)]
    }

    /// What the curvature of the field adds to the depth of a point of the picture, from its middle \[mm\].
    pub(super) fn curved(&self, r: f64, u: f64, optics: &Optics) -> f64 {
        if self.curvature_mm == 0.0 {
            return 0.0;
        }
        let half = [optics.rows, optics.columns].map(|count| count as f64 * optics.object_pixel_mm() / 2.0);
        self.curvature_mm * ((r / half[0]).powi(2) + (u / half[1]).powi(2)) / 2.0
    }

    /// Whether sides, marks or tacks are to be rendered: a bare gap is quicker.
    pub(super) fn has_effects(&self) -> bool {
        !self.marks.is_empty() || !self.tacks.is_empty() || self.sides != [Side::default(); 2]
    }
}

impl Gap {
    /// A plate with a dark gap and straight edges, both sides level.
    pub fn new(plate: PlateSeam) -> Self {
        Self {
            plate,
            step_mm: 0.0,
            roughness_mm: 0.0,
            brightness: 0.03,
        }
    }
}

impl Root {
    /// A sharp root between walls of the same brightness.
    pub fn new(corner: Corner) -> Self {
        Self {
            corner,
            rounding_mm: 0.0,
            brightness: [1.0; 2],
            interreflection: 0.0,
        }
    }
}
