//! Inputs and results of an observer.

use super::{Doubt, State};
use crate::report::{Form, Report, Sigma, Status};

/// How far a camera moved since its last picture \[mm\], in the frame of the camera: along travel, across, up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moved {
    /// Along a.
    pub travel_mm: f64,
    /// Along u: a seam that stays appears at smaller u.
    pub lateral_mm: f64,
    /// Along n: work that stays appears lower.
    pub height_mm: f64,
}

/// What an observer makes of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// What the picture says by itself.
    pub report: Report,
    /// What the observer is doing, this picture included.
    pub state: State,
    /// The seam, if it is accepted.
    pub seam: Option<Seam>,
    /// Why it is not, where the picture shows one.
    pub doubt: Option<Doubt>,
    /// Whether the seam jumped and is accepted at its new place or width from now on.
    pub relocked: bool,
    /// Too high or too low, after three pictures in a row that say so.
    pub out_of_view: Option<Status>,
}

/// A seam that is accepted, in the camera's frame (see [`Measured`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// Form it was seen in.
    pub form: Form,
    /// u of its middle on the band, in this picture \[mm\].
    pub lateral_mm: f64,
    /// a of that point \[mm\].
    pub travel_mm: f64,
    /// Where the seam was in the latest pictures, on the mean; none before there are 4.
    pub mean: Option<MeanPoint>,
    /// Width of the gap in this picture, 0 of a corner \[mm\].
    pub width_mm: f64,
    /// t: how much higher the right side of a gap lies, the mean of the same pictures; 0 of a corner \[mm\].
    pub step_mm: f64,
    /// q: slope across the seam, the mean of the same pictures.
    pub roll: f64,
    /// p: slope along travel, from the heights of 16 pictures; none before there are so many or without travel.
    pub pitch: Option<f64>,
    /// ψ: angle against travel \[rad\].
    pub yaw_rad: f64,
    /// Quality of this picture, 0.5 to 1.
    pub quality: f64,
    /// Standard deviations in this picture, but of height, step and roll those of the means.
    pub sigma: Sigma,
}

/// A point of the seam: the mean of where the last `mean_frames` accepted pictures saw it.
///
/// In the camera's frame where the camera is now: each picture's (a, u, n) is carried along by what the camera has moved
/// since ([`Moved`]). The three are means over the same pictures and therefore belong together: on a seam that climbs,
/// slants or bends the point lies on the seam, somewhat behind what the last picture shows. After a jump of the seam, a
/// loss, or as many pictures in a row without the seam as a mean has, means start again.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeanPoint {
    /// a \[mm\].
    pub travel_mm: f64,
    /// u \[mm\].
    pub lateral_mm: f64,
    /// n \[mm\].
    pub height_mm: f64,
}
