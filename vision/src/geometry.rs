//! From plate, seam and corner to what the picture shows of them, and back (mathematics 0.12).
//!
//! Frame: a along travel, u across the seam, n out of the plate; its origin is where the optical axis meets the focal
//! plane. Rows and columns count pixel centres from 0.

use crate::optics::Optics;
use nalgebra::Vector3;
use thiserror::Error;

/// Smallest sin α − p cos α: below it the optical axis runs along the plate.
const SMALLEST_TILT: f64 = 1e-6;

/// A plate with a seam in it: n = h + p·a + q·u, seam along u = u0 + a·tan ψ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlateSeam {
    /// h: height of the plate at a = u = 0 \[mm\].
    pub height_mm: f64,
    /// p: slope of the plate along travel. One picture does not show it; it comes from heights along the path.
    pub pitch: f64,
    /// q: slope of the plate across the seam, the tangent of the roll.
    pub roll: f64,
    /// u0: where the middle of the seam crosses a = 0 \[mm\].
    pub lateral_mm: f64,
    /// ψ: angle of the seam against travel, positive towards +u \[rad\].
    pub yaw_rad: f64,
    /// w: width of the gap in the plate, square to the seam \[mm\].
    pub width_mm: f64,
}

/// What a picture shows of a [`PlateSeam`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlateFeatures {
    /// Row of the sharp band at the column of the optical axis.
    pub band_row: f64,
    /// Rows the band gains a column: q / (sin α − p cos α).
    pub band_slope: f64,
    /// Row and column where the middle of the seam crosses the band.
    pub seam: [f64; 2],
    /// Columns of the left and right edge on the band.
    pub edges: [f64; 2],
    /// Columns an edge gains a row: tan ψ / (cos α + p sin α).
    pub edge_slope: f64,
    /// Defocus a row of the focal plane: (sin α − p cos α) / (cos α + p sin α).
    pub depth_slope: f64,
}

impl PlateFeatures {
    /// Row of the band at a column.
    pub fn row_on(&self, optics: &Optics, column: f64) -> f64 {
        self.band_row + self.band_slope * (column - optics.centre()[1])
    }

    /// A line along the seam through the band at `column`, from `reach` rows above to as many below: rows and columns.
    pub fn line_at(&self, optics: &Optics, column: f64, reach: f64) -> [[f64; 2]; 2] {
        let row = self.row_on(optics, column);
        [-reach, reach].map(|rows| [row + rows, column + self.edge_slope * rows])
    }
}

/// Two walls that meet in a corner: n = h + b·(u − u0), with b of the wall on that side of u0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// h: height of the corner \[mm\].
    pub height_mm: f64,
    /// u0: where the walls meet \[mm\].
    pub lateral_mm: f64,
    /// b: slopes dn/du of the walls left (u < u0) and right.
    pub walls: [f64; 2],
}

/// What a picture shows of a [`Corner`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerFeatures {
    /// Row and column of the vertex of the band.
    pub vertex: [f64; 2],
    /// Rows the band gains a column, left and right of it.
    pub band_slopes: [f64; 2],
}

/// A surface that no picture can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum GeometryError {
    /// sin α − p cos α is not above zero.
    #[error("plate parallel to the optical axis plane")]
    AlongTheAxis,
}

/// sin α − p cos α.
fn steepness(optics: &Optics, pitch: f64) -> Result<f64, GeometryError> {
    let steepness = optics.tilt_rad.sin() - pitch * optics.tilt_rad.cos();
    if steepness > SMALLEST_TILT {
        Ok(steepness)
    } else {
        Err(GeometryError::AlongTheAxis)
    }
}

impl PlateSeam {
    /// What a camera sees of it.
    pub fn features(&self, optics: &Optics) -> Result<PlateFeatures, GeometryError> {
        let steepness = steepness(optics, self.pitch)?;
        let (sin, cos) = optics.tilt_rad.sin_cos();
        let g = optics.object_pixel_mm();
        let [row, column] = optics.centre();
        let band_slope = self.roll / steepness;
        let band_row = row + self.height_mm / (steepness * g);
        let half_width = self.width_mm / self.squareness() / 2.0;
        let on_band = |lateral: f64| column + self.on_band(optics, steepness, lateral) / g;
        let seam = on_band(self.lateral_mm);
        Ok(PlateFeatures {
            band_row,
            band_slope,
            seam: [band_row + band_slope * (seam - column), seam],
            edges: [
                on_band(self.lateral_mm - half_width),
                on_band(self.lateral_mm + half_width),
            ],
            edge_slope: self.yaw_rad.tan() / (cos + self.pitch * sin),
            depth_slope: steepness / (cos + self.pitch * sin),
        })
    }

    /// The plate and seam that show `features`; the pitch is known from elsewhere.
    pub fn from_features(
        features: &PlateFeatures,
        pitch: f64,
        optics: &Optics,
    ) -> Result<Self, GeometryError> {
        let steepness = steepness(optics, pitch)?;
        let (sin, cos) = optics.tilt_rad.sin_cos();
        let g = optics.object_pixel_mm();
        let [row, column] = optics.centre();
        let tangent = features.edge_slope * (cos + pitch * sin);
        let mut plate = Self {
            height_mm: (features.band_row - row) * g * steepness,
            pitch,
            roll: features.band_slope * steepness,
            lateral_mm: 0.0,
            yaw_rad: tangent.atan(),
            width_mm: 0.0,
        };
        let stretch = 1.0 - cos * tangent * features.band_slope;
        let seam = (features.seam[1] - column) * g;
        plate.lateral_mm = seam * stretch - cos * tangent * plate.height_mm / steepness;
        let wide = (features.edges[1] - features.edges[0]) * g;
        plate.width_mm = wide * stretch * plate.squareness();
        Ok(plate)
    }

    /// Normal of the plate: unit (−p, −q, 1).
    pub fn normal(&self) -> Vector3<f64> {
        Vector3::new(-self.pitch, -self.roll, 1.0).normalize()
    }

    /// Where on the band a line parallel to the seam lies that crosses a = 0 at `lateral` \[mm\].
    fn on_band(&self, optics: &Optics, steepness: f64, lateral: f64) -> f64 {
        let shift = optics.tilt_rad.cos() * self.yaw_rad.tan() / steepness;
        (lateral + shift * self.height_mm) / (1.0 - shift * self.roll)
    }

    /// Share of the gap's extent along u that counts square to the seam: |S × l| / |S|, S along the seam and
    /// l = (0, 1, q) across it, both in the plate.
    pub(crate) fn squareness(&self) -> f64 {
        let tangent = self.yaw_rad.tan();
        let along = Vector3::new(1.0, tangent, self.pitch + self.roll * tangent);
        let across = Vector3::new(0.0, 1.0, self.roll);
        along.cross(&across).norm() / along.norm()
    }
}

impl Corner {
    /// What a camera sees of it.
    pub fn features(&self, optics: &Optics) -> CornerFeatures {
        let g = optics.object_pixel_mm();
        let [row, column] = optics.centre();
        let sin = optics.tilt_rad.sin();
        CornerFeatures {
            vertex: [row + self.height_mm / (g * sin), column + self.lateral_mm / g],
            band_slopes: self.walls.map(|b| b / sin),
        }
    }

    /// The corner that shows `features`.
    pub fn from_features(features: &CornerFeatures, optics: &Optics) -> Self {
        let g = optics.object_pixel_mm();
        let [row, column] = optics.centre();
        let sin = optics.tilt_rad.sin();
        Self {
            height_mm: (features.vertex[0] - row) * g * sin,
            lateral_mm: (features.vertex[1] - column) * g,
            walls: features.band_slopes.map(|k| k * sin),
        }
    }
}
