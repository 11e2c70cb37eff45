//! What a measurement should find in the picture of a scene.

use super::marks::Tack;
use super::scene::{Joint, Scene};
use crate::optics::Optics;

/// What there is to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The seam, in the sharp band.
    Seam,
    /// A plate without a gap.
    NoGap,
    /// A plate is missing on one side of the seam or on both.
    NoPlate,
    /// Too little light.
    Dark,
    /// Too much light.
    Overexposed,
    /// Nothing sharp: the work is above what the picture shows sharply.
    TooHigh,
    /// Nothing sharp: the work is below that.
    TooLow,
}

/// The truth about a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// What there is to be seen.
    pub shown: Shown,
    /// Row and column where the middle of the seam crosses the band.
    pub seam: [f64; 2],
    /// u of that point, from the optical axis \[mm\].
    pub centre_mm: f64,
    /// h \[mm\].
    pub height_mm: f64,
    /// w; 0 of a corner \[mm\].
    pub width_mm: f64,
    /// q; 0 of a corner.
    pub roll: f64,
    /// ψ; 0 of a corner \[rad\].
    pub yaw_rad: f64,
    /// Slopes of the walls of a corner; q of a plate.
    pub walls: [f64; 2],
}

/// Below this share of full scale there is no picture (7 of 255).
const DARK: f64 = 7.0 / 255.0;

/// From this share on most of a picture is saturated.
const BRIGHT: f64 = 1.02;

impl Scene {
    /// What there is of a gap of that width at a place along travel on the work.
    fn shown_at(&self, place: f64, width_mm: f64) -> Shown {
        let closes = |tack: &Tack| (tack.reaches_mm[0]..=tack.reaches_mm[1]).contains(&place);
        if !self.sides.iter().all(|side| side.is_at(place)) {
            Shown::NoPlate
        } else if width_mm <= 0.0 || self.tacks.iter().any(closes) {
            Shown::NoGap
        } else {
            Shown::Seam
        }
    }

    /// What a camera's picture of it holds. None if no picture can show a plate tilted like that.
    pub fn truth(&self, optics: &Optics) -> Option<Truth> {
        let middle = optics.centre()[1];
        let mut truth = match &self.joint {
            Joint::Gap(gap) => {
                let seam = gap.plate.features(optics).ok()?.seam;
                // Where the seam meets the focal plane.
                let r = (seam[0] - optics.centre()[0]) * optics.object_pixel_mm();
                let place = self.position_mm[0] + r * optics.tilt_rad.cos();
                Truth {
                    shown: self.shown_at(place, gap.plate.width_mm),
                    seam,
                    centre_mm: (seam[1] - middle) * optics.object_pixel_mm(),
                    height_mm: gap.plate.height_mm,
                    width_mm: gap.plate.width_mm,
                    roll: gap.plate.roll,
                    yaw_rad: gap.plate.yaw_rad,
                    walls: [gap.plate.roll; 2],
                }
            }
            Joint::Corner(root) => Truth {
                shown: Shown::Seam,
                seam: root.corner.features(optics).vertex,
                centre_mm: root.corner.lateral_mm,
                height_mm: root.corner.height_mm,
                width_mm: 0.0,
                roll: 0.0,
                yaw_rad: 0.0,
                walls: root.corner.walls,
            },
        };
        if self.light.level < DARK {
            truth.shown = Shown::Dark;
        } else if self.light.level > BRIGHT {
            truth.shown = Shown::Overexposed;
        } else if truth.seam[0] < 0.0 {
            truth.shown = Shown::TooLow;
        } else if truth.seam[0] > optics.rows as f64 - 1.0 {
            truth.shown = Shown::TooHigh;
        }
        Some(truth)
    }
}
