//! What a picture says.

use crate::geometry::PlateSeam;

/// How a picture ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// A seam was measured and may be used.
    Seam,
    /// Too little light.
    Dark,
    /// Too much light: no texture is left.
    Overexposed,
    /// The work is higher than what the picture shows (n too large).
    TooHigh,
    /// The work is lower than what the picture shows (n too small).
    TooLow,
    /// No sharp band anywhere.
    NoBand,
    /// A sharp band without a seam that could be trusted.
    NoSeam,
    /// Several things that may be the seam.
    Ambiguous,
}

/// Form of the joint in a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// An open gap in a plate.
    Gap,
    /// The closed corner of two walls.
    Corner,
}

/// What one picture says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// How it ended.
    pub status: Status,
    /// What was measured, also where it is not trusted; nothing without a band.
    pub measured: Option<Measured>,
}

/// A measured band and the seam on it.
///
/// Camera frame (mathematics 0.12): a along travel, u across, n out of the work, from where its axis cuts the
/// focal plane. The plate's pitch counts as 0: with a pitch p heights are h·sin α / (sin α − p·cos α).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Form of the joint.
    pub form: Form,
    /// u of the seam's middle on the band; 0 with an infinite error if no seam was seen \[mm\].
    pub lateral_mm: f64,
    /// a of that point: the band lies ahead of the axis (a > 0) if the work is high \[mm\].
    pub travel_mm: f64,
    /// n of that point: the mean of both sides of a gap, the corner of two walls \[mm\].
    pub height_mm: f64,
    /// Width of the gap square to the seam, 0 of a corner \[mm\].
    pub width_mm: f64,
    /// t: how much higher the right side of a gap lies \[mm\].
    pub step_mm: f64,
    /// q = dn/du: slope of the plate, or of the middle between two walls.
    pub roll: f64,
    /// dn/du left and right of the seam.
    pub walls: [f64; 2],
    /// ψ: angle of the seam against travel, positive towards +u; 0 of a corner \[rad\].
    pub yaw_rad: f64,
    /// l: logarithm of the depth profile's width over the calibrated one.
    pub focus: f64,
    /// How far it can be trusted: 0 to 1, used from 0.5.
    pub quality: f64,
    /// What holds the quality down most; nothing if it is 1, or if there is no seam to judge.
    pub weakest: Option<Criterion>,
    /// Gain of the band: logarithm of the likelihood a cell over a picture that is equally sharp everywhere.
    pub gain: f64,
    /// Energy of the sharp texture over the noise; low values make heights uncertain.
    pub contrast: f64,
    /// Standard deviations.
    pub sigma: Sigma,
    /// The next best thing that may be the seam.
    pub second: Option<Second>,
}

/// By what a measured seam is judged; each gives 0 to 1, and the least of them is the quality.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// How dark the gap is against the plate.
    Depth,
    /// How many readings of the edges lie on straight lines.
    Straightness,
    /// How far the readings scatter about those lines.
    Scatter,
    /// Whether the dark line continues, blurred, outside the sharp band.
    Continuity,
    /// How well the height is known.
    Height,
    /// Whether it is wide enough.
    Width,
    /// Distance from the left and right border of the picture.
    Border,
    /// Distance of the band from the upper and lower border of the picture.
    Band,
    /// How much better it is than the next best.
    Ambiguity,
    /// How well the lateral position is known.
    Lateral,
    /// How much of the picture the band explains.
    Gain,
    /// How much of each wall is in the picture.
    Walls,
    /// Whether there is a plate on both sides: the darker one over the brighter one.
    Sides,
    /// Whether it is empty: scratches, grooves and shadows have the texture of the plate.
    Emptiness,
    /// Whether the gap is equally dark over its whole width: beside a shadow or spatter it is not.
    Interior,
}

/// Standard deviations of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigma {
    /// Of the lateral position \[mm\].
    pub lateral_mm: f64,
    /// Of the height \[mm\].
    pub height_mm: f64,
    /// Of the width \[mm\].
    pub width_mm: f64,
    /// Of the step between the sides \[mm\].
    pub step_mm: f64,
    /// Of the roll slope.
    pub roll: f64,
    /// Of the slopes left and right.
    pub walls: [f64; 2],
    /// Of the seam's angle \[rad\].
    pub yaw_rad: f64,
}

/// Another thing that may be the seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Second {
    /// u of its middle on the band \[mm\].
    pub lateral_mm: f64,
    /// Width \[mm\].
    pub width_mm: f64,
    /// Its rank over that of the best, 0 to 1.
    pub rank: f64,
}

impl Report {
    /// A picture without a band.
    pub(crate) fn without(status: Status) -> Self {
        Self {
            status,
            measured: None,
        }
    }

    /// The measurement, if it may be used.
    pub fn seam(&self) -> Option<&Measured> {
        self.measured.as_ref().filter(|_| self.status == Status::Seam)
    }
}

impl Measured {
    /// h of mathematics 0.12: height of the plate at u = 0 \[mm\].
    pub fn plate_height_mm(&self) -> f64 {
        self.height_mm - self.roll * self.lateral_mm
    }

    /// u0 of mathematics 0.12: u of the seam at a = 0, along its angle \[mm\].
    pub fn lateral_on_axis_mm(&self) -> f64 {
        self.lateral_mm - self.travel_mm * self.yaw_rad.tan()
    }

    /// The plate and the gap in it, which a picture of this shows.
    pub fn plate_seam(&self) -> PlateSeam {
        PlateSeam {
            height_mm: self.plate_height_mm(),
            pitch: 0.0,
            roll: self.roll,
            lateral_mm: self.lateral_on_axis_mm(),
            yaw_rad: self.yaw_rad,
            width_mm: self.width_mm,
        }
    }
}

/// The least of what the criteria give, and which it is unless it is 1.
pub(crate) fn least(judged: &[(Criterion, f64)]) -> (f64, Option<Criterion>) {
    let mut least = (1.0, None);
    for &(criterion, value) in judged {
        if value < least.0 {
            least = (value, Some(criterion));
        }
    }
    least
}

/// 0 at `from` and before, 1 at `to` and beyond.
pub(crate) fn ramp(x: f64, from: f64, to: f64) -> f64 {
    ((x - from) / (to - from)).clamp(0.0, 1.0)
}
