//! The result of a measured picture, for JSON.

use super::{Outcome, Verdict, words};
use serde::Serialize;
use vision::{Form, Measured, Observation};

/// A measured picture; mm in the frame of the camera (mathematics 0.12), unknown figures are `null`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Record {
    /// The file.
    pub file: String,
    /// How it ended: `seam`, or why not, in a word or two.
    pub status: &'static str,
    /// What is to be thought of it: `seam`, `doubtful` or `refused`.
    pub verdict: &'static str,
    /// Why it is of no use, in words.
    pub why: Option<String>,
    /// What was measured, also where it is not trusted.
    pub measured: Option<MeasuredRecord>,
    /// What an observer makes of it, of a sequence of pictures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observed: Option<ObservedRecord>,
}

/// A figure and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// The figure.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// A measured band and the seam on it; see [`Measured`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeasuredRecord {
    /// `gap` or `corner`.
    pub joint: &'static str,
    /// How far it can be trusted, 0 to 1; used from 0.5.
    pub quality: f64,
    /// u of the middle of the seam on the band \[mm\].
    pub lateral_mm: Figure,
    /// a of that point \[mm\].
    pub travel_mm: f64,
    /// n of that point \[mm\].
    pub height_mm: Figure,
    /// Width of a gap \[mm\].
    pub width_mm: Figure,
    /// How much higher the right side of a gap lies \[mm\].
    pub step_mm: f64,
    /// Slope of the plate across the seam \[°\].
    pub roll_deg: Figure,
    /// Slopes left and right of the seam \[°\].
    pub wall_deg: [Figure; 2],
    /// Angle of the seam against travel \[°\].
    pub angle_deg: Figure,
    /// Logarithm of the width of the sharp band over the calibrated one.
    pub focus: f64,
    /// Energy of the sharp texture over the noise.
    pub contrast: f64,
    /// How much of the picture the band explains.
    pub gain: f64,
    /// The next best thing that may be the seam.
    pub second: Option<SecondRecord>,
}

/// The next best thing that may be the seam.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SecondRecord {
    /// u of its middle \[mm\].
    pub lateral_mm: f64,
    /// Width \[mm\].
    pub width_mm: f64,
    /// Its rank over that of the best, 0 to 1.
    pub rank: f64,
}

/// What an observer makes of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ObservedRecord {
    /// `acquiring`, `tracking` or `lost`.
    pub state: &'static str,
    /// Whether the seam is accepted.
    pub believed: bool,
    /// Why it is not, where one was seen.
    pub doubt: Option<&'static str>,
    /// Mean place of the last pictures: travel, lateral, height \[mm\].
    pub mean_mm: Option<[f64; 3]>,
}

impl Record {
    /// Of a measured picture.
    pub fn of(outcome: &Outcome) -> Self {
        Self {
            file: outcome.file.display().to_string(),
            status: words::status(outcome.report.status),
            verdict: Verdict::of(outcome).name(),
            why: words::why(&outcome.report),
            measured: outcome.report.measured.as_ref().map(MeasuredRecord::of),
            observed: outcome.observation.as_ref().map(ObservedRecord::of),
        }
    }
}

impl MeasuredRecord {
    fn of(measured: &Measured) -> Self {
        let sigma = &measured.sigma;
        let degrees = |slope: f64, sigma: f64| Figure {
            value: slope.atan().to_degrees(),
            sigma: (sigma / (1.0 + slope * slope)).to_degrees(),
        };
        let figure = |value, sigma| Figure { value, sigma };
        let [left, right] = measured.walls;
        Self {
            joint: match measured.form {
                Form::Gap => "gap",
                Form::Corner => "corner",
            },
            quality: measured.quality,
            lateral_mm: figure(measured.lateral_mm, sigma.lateral_mm),
            travel_mm: measured.travel_mm,
            height_mm: figure(measured.height_mm, sigma.height_mm),
            width_mm: figure(measured.width_mm, sigma.width_mm),
            step_mm: measured.step_mm,
            roll_deg: degrees(measured.roll, sigma.roll),
            wall_deg: [degrees(left, sigma.walls[0]), degrees(right, sigma.walls[1])],
            angle_deg: figure(measured.yaw_rad.to_degrees(), sigma.yaw_rad.to_degrees()),
            focus: measured.focus,
            contrast: measured.contrast,
            gain: measured.gain,
            second: measured.second.map(|second| SecondRecord {
                lateral_mm: second.lateral_mm,
                width_mm: second.width_mm,
                rank: second.rank,
            }),
        }
    }
}

impl ObservedRecord {
    fn of(observation: &Observation) -> Self {
        let mean = observation.seam.and_then(|seam| seam.mean);
        Self {
            state: words::state(observation.state),
            believed: observation.seam.is_some(),
            doubt: observation.doubt.map(words::doubt),
            mean_mm: mean.map(|mean| [mean.travel_mm, mean.lateral_mm, mean.height_mm]),
        }
    }
}
