//! Where a camera looks beside its spot, from marks of the beams: listed beside the previous calibration.

use super::procedure::{CalibrationResult, Figure};
use config::calibration::{Calibration, SpotCalibration};
use thiserror::Error;
use vision::calibrate::{BurntMark, Found, MarkSighting, SpotError, SpotFit, spot_offset};

/// Uncertainties are told as two standard deviations.
const SIGMAS: f64 = 2.0;
/// Largest uncertainty of the offset, of the lead \[mm\] and of the delay \[s\]: what a weld within 0.05 mm leaves them.
const OFFSET_MM: f64 = 0.006;
const LEAD_MM: f64 = 0.1;
const DELAY_S: f64 = 0.2e-3;
const MS_PER_S: f64 = 1e3;

/// Why the spot was not found. Reads as one sentence.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SpotCalibrationError {
    /// The pictures do not tell.
    #[error(transparent)]
    Fit(#[from] SpotError),
    /// They tell it too roughly.
    #[error(
        "{what} is uncertain by {by} (2 σ; may be {most}): burn a longer mark, or look for what is loose"
    )]
    Uncertain {
        /// What.
        what: &'static str,
        /// By how much.
        by: String,
        /// And what is permitted.
        most: String,
    },
}

/// A camera's spot, and how far it is from where it was before.
#[derive(Clone, Debug, PartialEq)]
pub struct SpotResult {
    /// The calibration and its figures.
    pub found: CalibrationResult,
    /// Offset in U and V now less that before \[mm\].
    pub moved_mm: [f64; 2],
    /// What that may be without a drift: both uncertainties \[mm\].
    pub uncertain_mm: [f64; 2],
}

impl SpotResult {
    /// Whether the offset has moved by more than both uncertainties and `limit_mm`.
    pub fn has_drifted(&self, limit_mm: f64) -> bool {
        let mut moved = self.moved_mm.iter().zip(self.uncertain_mm);
        moved.any(|(moved, uncertain)| moved.abs() > limit_mm + uncertain)
    }
}

/// The calibration after looking at marks of the camera's own beam and of the other head's, where `lead_mm` was believed.
pub fn spot(
    marks: &[BurntMark; 2],
    sightings: &[MarkSighting],
    lead_mm: f64,
    before: &Calibration,
) -> Result<SpotResult, SpotCalibrationError> {
    let fit = spot_offset(marks, sightings, before.slides.matrix, lead_mm)?;
    let um = |mm: f64| format!("{:.1} µm", 1e3 * mm);
    let held = |what: &'static str, by: f64, most: f64, unit: fn(f64) -> String| {
        let (by, most) = (SIGMAS * by, most);
        if by > most {
            let (by, most) = (unit(by), unit(most));
            return Err(SpotCalibrationError::Uncertain { what, by, most });
        }
        Ok(by)
    };
    let in_um = |mm: f64| format!("{:.1} µm", 1e3 * mm);
    let in_mm = |mm: f64| format!("{mm:.3} mm");
    let in_ms = |s: f64| format!("{:.3} ms", MS_PER_S * s);
    let u = held("the offset in U", fit.offset_u_mm.sigma, OFFSET_MM, in_um)?;
    let v = match fit.offset_v_mm {
        Some(found) => held("the offset in V", found.sigma, OFFSET_MM, in_um)?,
        None => before.spot.map_or(0.0, |spot| spot.uncertainty_mm[1]),
    };
    let lead = held("the lead", fit.lead_mm.sigma, LEAD_MM, in_mm)?;
    let delay = held("the strobe delay", fit.delay_s.sigma, DELAY_S, in_ms)?;

    let was = before.slides.offset_mm;
    let is = [
        fit.offset_u_mm.value,
        fit.offset_v_mm.map_or(was[1], |found| found.value),
    ];
    let mut calibration = *before;
    calibration.slides.offset_mm = is;
    calibration.spot = Some(SpotCalibration {
        lead_mm: fit.lead_mm.value,
        delay_s: fit.delay_s.value,
        uncertainty_mm: [u, v],
    });
    let offset = |text, found: Option<Found>, was: f64, by: f64| {
        let value = found.map_or("not found: the beams are parallel".to_owned(), |found| {
            format!("{:+.1} ± {:.1} µm", 1e3 * found.value, 1e3 * by)
        });
        Figure::new(text, value, format!("was {:+.1} µm", 1e3 * was))
    };
    let SpotFit {
        scatter_mm,
        bent_mm,
        longer_mm,
        seen_mm,
        pictures,
        ends,
        ..
    } = fit;
    let figures = vec![
        offset("beam to camera in U", Some(fit.offset_u_mm), was[0], u),
        offset("beam to camera in V", fit.offset_v_mm, was[1], v),
        Figure::new(
            "lead",
            format!("{:.3} ± {:.3} mm", fit.lead_mm.value, lead),
            match before.spot {
                Some(spot) => format!("was {:.3} mm", spot.lead_mm),
                None => format!("{lead_mm:.3} mm by the machine file"),
            },
        ),
        Figure::new(
            "strobe delay",
            format!("{:.3} ± {:.3} ms", MS_PER_S * fit.delay_s.value, MS_PER_S * delay),
            format!("was {:.3} ms", MS_PER_S * before.delay_s()),
        ),
        Figure::new(
            "pictures of the marks, their ends",
            format!("{pictures}, {ends}"),
            String::new(),
        ),
        Figure::new(
            "mark in the picture, across and up",
            format!("{:+.3} {:+.3} mm", seen_mm[0], seen_mm[1]),
            String::new(),
        ),
        Figure::new("scatter of a picture", um(scatter_mm), "at most 12 µm".to_owned()),
        Figure::new("marks off a line", um(bent_mm), "at most 6 µm".to_owned()),
        Figure::new("marks longer at each end by", um(longer_mm), String::new()),
    ];
    let before_mm = before.spot.map_or([0.0; 2], |spot| spot.uncertainty_mm);
    Ok(SpotResult {
        found: CalibrationResult { calibration, figures },
        moved_mm: [0, 1].map(|k| is[k] - was[k]),
        uncertain_mm: [u.hypot(before_mm[0]), v.hypot(before_mm[1])],
    })
}
