//! Depth profile: how fast texture fades out of focus, from a plate that is stepped through it.

use super::fading::Fading;
use super::least_squares::LeastSquares;
use crate::detector::{Detector, DetectorError};
use crate::height_field::{HeightField, Plate};
use crate::image::Image;
use crate::noise::PhotonTransfer;
use crate::optics::Optics;
use crate::prior::{Joint, Prior};
use crate::profile::Profile;
use crate::report::Measured;
use thiserror::Error;

/// Fewest pictures that show a band.
const FEWEST: usize = 5;

/// How far the plate has to be stepped, in widths of the profile: every row of the middle then saw the plate in and out
/// of focus.
const WIDTHS: f64 = 2.0;

/// Least energy of the sharp texture over the noise; below, noise decides how wide the band looks.
const FAINTEST: f64 = 40.0;

/// Largest scatter of a width from picture to picture, as a share.
const SCATTER: f64 = 0.25;

/// Largest relative deviation of the measured travel from the commanded one.
const WAY: f64 = 0.05;

/// How many times wider or narrower than by the drawing a band may be.
const FACTOR: f64 = 1.5;

/// Part of the plate beside a gap that is left out \[mm\].
const BESIDE_GAP_MM: f64 = 0.06;

/// A picture of a textured plate at rest.
#[derive(Clone, Copy, Debug)]
pub struct DepthStep<'a> {
    /// The picture.
    pub image: Image<'a>,
    /// How high the plate lies in the camera's frame, from anywhere: what the slides moved the camera down by \[mm\].
    pub height_mm: f64,
}

/// A depth profile and how well it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthFit {
    /// The profile.
    pub profile: Profile,
    /// Standard deviation of the width from picture to picture, as a share, at full and half resolution.
    pub scatter: [f64; 2],
    /// Pictures that showed a band.
    pub pictures: usize,
    /// Energy of the sharp texture over the noise, mean of the pictures.
    pub contrast: f64,
    /// Travel of the plate measured in the pictures, over the commanded travel: 1 if the tilt is right.
    pub way: f64,
}

/// Why pictures give no depth profile. Pictures count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum DepthError {
    /// A picture cannot be measured.
    #[error("picture {picture}: {reason}")]
    Picture {
        /// Which.
        picture: usize,
        /// Why.
        reason: DetectorError,
    },
    /// The camera makes no sense.
    #[error(transparent)]
    Camera(#[from] DetectorError),
    /// Too few pictures show a band.
    #[error("{found} of {pictures} pictures show a sharp band; at least 5 are needed: step through focus")]
    Few {
        /// Pictures with a band.
        found: usize,
        /// All of them.
        pictures: usize,
    },
    /// The steps do not span the band.
    #[error(
        "the plate was stepped over {way_mm:.3} mm where it is sharp; at least {needed_mm:.3} mm are needed: step farther"
    )]
    Short {
        /// From the lowest to the highest picture with a band \[mm\].
        way_mm: f64,
        /// What is needed \[mm\].
        needed_mm: f64,
    },
    /// The texture is too faint.
    #[error(
        "the texture is too faint: its energy is {contrast:.1} times the noise, at least 40 times are needed; give more light, or take a plate that is ground or blasted"
    )]
    Faint {
        /// Energy over noise.
        contrast: f64,
    },
    /// The pictures disagree.
    #[error(
        "the width of the sharp band scatters by {percent:.0} % from picture to picture (may be 25 %): take a plate of finer, even texture, or more pictures"
    )]
    Scatter {
        /// Of the width \[%\].
        percent: f64,
    },
    /// The band is not as wide as the lens makes it.
    #[error(
        "the sharp band is {factor:.2} times as wide as the lens should make it (may be 0.67 to 1.5 times): take a plate with texture as fine as the pixels; if it is, check aperture, magnification and pixel"
    )]
    Width {
        /// Found over expected.
        factor: f64,
    },
    /// The plate did not move as commanded.
    #[error(
        "the pictures show {percent:.1} % of the commanded travel of the slides (at most 5 % off is possible): is tilt_deg right, and was it this camera's slide V?"
    )]
    Way {
        /// Measured over commanded travel \[%\].
        percent: f64,
    },
}

/// What one picture says.
struct Shown {
    told_mm: f64,
    height_mm: f64,
    contrast: f64,
    /// Energies over depth, at both resolutions.
    fading: [Fading; 2],
}

/// Width of the depth profile at both resolutions: mean energy of the texture over depth, of all pictures together. Each
/// depth was then in many rows, so that what the texture has there is evened out.
pub fn depth_profile(
    optics: Optics,
    noise: PhotonTransfer,
    steps: &[DepthStep],
) -> Result<DepthFit, DepthError> {
    let expected = Profile::expected(&optics);
    let mut detector = Detector::new(optics, noise, expected)?;
    let mut shown = Vec::new();
    for (k, step) in steps.iter().enumerate() {
        let picture = |reason| DepthError::Picture {
            picture: k + 1,
            reason,
        };
        shown.extend(show(&mut detector, step, &expected).map_err(picture)?);
    }
    judge(&shown, steps.len(), &optics)
}

/// Band and energies of one picture; nothing if it shows no band.
fn show(
    detector: &mut Detector,
    step: &DepthStep,
    expected: &Profile,
) -> Result<Option<Shown>, DetectorError> {
    let prior = Prior {
        joint: Joint::Gap,
        track: None,
        focus: 0.0,
    };
    let report = detector.measure(&step.image, &prior)?;
    let widths = [expected.fine_mm, expected.coarse_mm];
    Ok(report.measured.map(|measured| Shown {
        told_mm: step.height_mm,
        height_mm: measured.plate_height_mm(),
        contrast: measured.contrast,
        fading: [0, 1].map(|k| fading(detector, k, widths[k], &measured)),
    }))
}

/// Energies of one resolution over depth, from the band as it was found.
fn fading(detector: &Detector, level: usize, expected_mm: f64, measured: &Measured) -> Fading {
    let beside = measured.width_mm / 2.0 + BESIDE_GAP_MM;
    let gap = (measured.width_mm > 0.0).then_some([measured.lateral_mm, beside]);
    let (plate, cells) = (Plate { gap }, &detector.band.levels[level].cells);
    let (sin, cos) = detector.optics.tilt_rad.sin_cos();
    let at = [
        measured.plate_height_mm(),
        measured.roll,
        measured.step_mm,
        measured.focus,
    ];
    let mut fading = Fading::new(expected_mm);
    for column in 0..cells.columns {
        let lateral = f64::from(cells.lateral(column));
        if plate.weight(&at, lateral, f64::from(cells.pitch_mm)) < 1.0 {
            continue;
        }
        let (height, _) = plate.height(&at, lateral);
        let (energy, noise) = cells.column(column);
        for row in 0..cells.rows {
            let r = f64::from(cells.origin_mm[0]) + row as f64 * f64::from(cells.pitch_mm);
            fading.add((r * sin - height) / cos, energy[row], noise[row]);
        }
    }
    fading
}

/// The mean of all pictures, if it can be trusted.
fn judge(shown: &[Shown], pictures: usize, optics: &Optics) -> Result<DepthFit, DepthError> {
    let found = shown.len();
    if found < FEWEST {
        return Err(DepthError::Few { found, pictures });
    }
    let count = found as f64;
    let mean = |value: &dyn Fn(&Shown) -> f64| shown.iter().map(value).sum::<f64>() / count;
    let contrast = mean(&|picture| picture.contrast);
    if contrast < FAINTEST {
        return Err(DepthError::Faint { contrast });
    }
    let together = |k: usize| {
        shown
            .iter()
            .map(|picture| &picture.fading[k])
            .sum::<Fading>()
            .width_mm()
    };
    let profile = Profile {
        fine_mm: together(0),
        coarse_mm: together(1),
    };
    let scatter = [profile.fine_mm, profile.coarse_mm];
    let scatter = [0, 1].map(|k| {
        let off = |picture: &Shown| (picture.fading[k].width_mm() / scatter[k] - 1.0).powi(2);
        mean(&off).sqrt()
    });
    let told = shown.iter().map(|picture| picture.told_mm);
    let (low, high) = told.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| {
        (low.min(height), high.max(height))
    });
    let needed_mm = WIDTHS * profile.fine_mm * optics.tilt_rad.cos();
    if high - low < needed_mm {
        let way_mm = high - low;
        return Err(DepthError::Short { way_mm, needed_mm });
    }
    let mut line = LeastSquares::<2, 1>::new();
    for picture in shown {
        line.add([picture.told_mm, 1.0], [picture.height_mm], 1.0);
    }
    let way = line.solve().map_or(0.0, |line| line[0]);
    if (way - 1.0).abs() > WAY {
        return Err(DepthError::Way { percent: 100.0 * way });
    }
    let factor = profile.fine_mm / Profile::expected(optics).fine_mm;
    if !(1.0 / FACTOR..=FACTOR).contains(&factor) {
        return Err(DepthError::Width { factor });
    }
    let worst = scatter[0].max(scatter[1]);
    if worst > SCATTER {
        let percent = 100.0 * worst;
        return Err(DepthError::Scatter { percent });
    }
    Ok(DepthFit {
        profile,
        scatter,
        pictures: found,
        contrast,
        way,
    })
}
