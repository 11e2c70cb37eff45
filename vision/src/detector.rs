//! Measures pictures: light, band, seam.

use crate::band::Band;
use crate::cells::Cells;
use crate::coarse::{Coarse, Sides};
use crate::gap::{Candidates, Continuity, Strip};
use crate::image::Image;
use crate::layer::Layer;
use crate::level::Level;
use crate::noise::{LayerNoise, PhotonTransfer};
use crate::optics::{Optics, OpticsError};
use crate::prior::{Joint, Prior};
use crate::profile::Profile;
use crate::report::{Report, Status};
use thiserror::Error;

/// Side of a cell \[mm\].
const CELL_MM: f64 = 0.0138;

/// Smallest picture, in pixels a side.
const SMALLEST: usize = 48;

/// Level that 60 % of the pixels have to reach, else it is dark.
const DARK: (f64, usize) = (0.6, 7);

/// Share of saturated pixels from which a picture is overexposed.
const OVEREXPOSED: f64 = 0.4;

/// Score a band outside the view needs, and what the other side may have of it.
const CLEAR: f64 = 1.0;
const OPPOSITE: f64 = 0.8;

/// Measures pictures of one camera. All room is made here: a measurement allocates nothing.
#[derive(Clone, Debug)]
pub struct Detector {
    pub(crate) optics: Optics,
    /// The camera's picture, then each of half the resolution.
    pub(crate) layers: Vec<Layer>,
    /// The layer that is measured; it is not finer than needed.
    pub(crate) base: usize,
    pub(crate) band: Band,
    pub(crate) coarse: Coarse,
    pub(crate) strip: Strip,
    pub(crate) candidates: Candidates,
    pub(crate) continuity: Continuity,
}

/// Why no detector can be made, or a picture not be measured.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum DetectorError {
    /// The camera's figures make no sense.
    #[error(transparent)]
    Optics(#[from] OpticsError),
    /// The camera's pictures are too small.
    #[error("pictures of {rows} × {columns} pixels are too small to measure; at least 48 × 48 are needed")]
    Small {
        /// Rows.
        rows: usize,
        /// Pixels a row.
        columns: usize,
    },
    /// Photon transfer or profile are not above zero.
    #[error("the camera's calibration has {what} of {value}; it must be above zero")]
    Calibration {
        /// Which figure.
        what: &'static str,
        /// What it is.
        value: f64,
    },
    /// A picture is not of the size the camera has.
    #[error("a picture of {rows} × {columns} pixels came from a camera of {camera_rows} × {camera_columns}")]
    Size {
        /// Rows of the picture.
        rows: usize,
        /// Its pixels a row.
        columns: usize,
        /// Rows of the camera.
        camera_rows: usize,
        /// Its pixels a row.
        camera_columns: usize,
    },
}

impl Detector {
    /// A detector for a camera with this noise and this depth profile.
    pub fn new(optics: Optics, noise: PhotonTransfer, profile: Profile) -> Result<Self, DetectorError> {
        optics.check()?;
        let (rows, columns) = (optics.rows, optics.columns);
        let base = optics.binning().ilog2() as usize;
        if rows.min(columns) >> base < SMALLEST {
            return Err(DetectorError::Small { rows, columns });
        }
        let figures = [
            ("a full well", noise.full_well),
            ("a profile width", profile.fine_mm),
            ("a profile width at half resolution", profile.coarse_mm),
        ];
        for (what, value) in figures {
            if !(value.is_finite() && value > 0.0) {
                return Err(DetectorError::Calibration { what, value });
            }
        }
        let camera = Layer::of_camera(rows, columns, optics.centre(), optics.object_pixel_mm());
        let mut layers = vec![camera];
        while layers.len() < base + 2 {
            layers.push(layers[layers.len() - 1].halved());
        }
        let side = (CELL_MM / layers[base].pitch_mm).round().clamp(2.0, 4.0) as usize;
        let cells = |layer: usize| Cells::new(&layers[layer], side, &noise);
        let tilt = optics.tilt_rad;
        let levels = [
            Level::new(cells(base), profile.fine_mm, tilt),
            Level::new(cells(base + 1), profile.coarse_mm, tilt),
        ];
        let coarse = Coarse::new(&levels[1].cells, profile.coarse_mm, tilt);
        Ok(Self {
            band: Band { levels },
            coarse,
            strip: Strip::new(&layers[base], LayerNoise::new(&noise, &layers[base])),
            candidates: Candidates::default(),
            continuity: Continuity::new(layers[base].columns, tilt, optics.aperture),
            optics,
            layers,
            base,
        })
    }

    /// The camera it measures for.
    pub fn optics(&self) -> &Optics {
        &self.optics
    }

    /// Measures a picture.
    pub fn measure(&mut self, image: &Image, prior: &Prior) -> Result<Report, DetectorError> {
        if (image.rows(), image.columns()) != (self.optics.rows, self.optics.columns) {
            return Err(DetectorError::Size {
                rows: image.rows(),
                columns: image.columns(),
                camera_rows: self.optics.rows,
                camera_columns: self.optics.columns,
            });
        }
        if let Some(status) = light(image) {
            return Ok(Report::without(status));
        }
        self.layers[0].fill(image);
        for layer in 1..self.layers.len() {
            let (finer, coarser) = self.layers.split_at_mut(layer);
            coarser[0].fill_halved(&finer[layer - 1]);
        }
        for level in 0..2 {
            self.band.levels[level]
                .cells
                .fill(&self.layers[self.base + level]);
        }
        Ok(match prior.joint {
            Joint::Gap => self.measure_gap(prior),
            Joint::Corner(walls) => self.measure_corner(prior, &walls, None),
            Joint::GapOrCorner(walls) => {
                // The dark line where walls touch looks like a gap; the band shows which of both it is.
                let gap = self.measure_gap(prior);
                let gain = |report: &Report| report.measured.map_or(0.0, |measured| measured.gain);
                let corner = self.measure_corner(prior, &walls, Some(gain(&gap)));
                let lost = matches!(gap.status, Status::NoBand | Status::NoSeam);
                let directed = matches!(corner.status, Status::TooHigh | Status::TooLow);
                if gain(&corner) > gain(&gap) || lost && directed {
                    corner
                } else {
                    gap
                }
            }
        })
    }

    /// The layer that is measured.
    pub(crate) fn layer(&self) -> &Layer {
        &self.layers[self.base]
    }

    /// Correlates the picture on the coarse grid.
    pub(crate) fn correlate(&mut self) {
        self.coarse.correlate(&self.band.levels[1].cells);
    }

    /// Why there is no band in the view: the work is too high or too low, if that is clear.
    pub(crate) fn missing(&self, sides: &Sides) -> Status {
        let (above, below) = (sides.above.score, sides.below.score);
        let clear = sides.inside.iter().map(|found| found.score).fold(CLEAR, f64::max);
        if above > clear && below < OPPOSITE * above {
            Status::TooHigh
        } else if below > clear && above < OPPOSITE * below {
            Status::TooLow
        } else {
            Status::NoBand
        }
    }
}

/// What is wrong with the light of a picture.
fn light(image: &Image) -> Option<Status> {
    let mut histogram = [0_u32; 256];
    let mut pixels = 0;
    for row in (0..image.rows()).step_by(4) {
        for pixel in image.row(row) {
            histogram[usize::from(*pixel)] += 1;
        }
        pixels += image.columns();
    }
    let dark: u32 = histogram[..DARK.1].iter().sum();
    if f64::from(dark) > DARK.0 * pixels as f64 {
        return Some(Status::Dark);
    }
    (f64::from(histogram[255]) > OVEREXPOSED * pixels as f64).then_some(Status::Overexposed)
}
