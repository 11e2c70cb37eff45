//! Calibration from pictures with known values; results are listed beside the previous calibration.

use super::ReferencePicture;
use crate::PngError;
use config::calibration::Calibration;
use config::table::TableError;
use thiserror::Error;
use vision::calibrate::{
    CornerError, CornerPair, DepthError, DepthStep, SlideError, SlideReading, TransferError, corner_offset,
    depth_profile, photon_transfer, slide_matrix,
};
use vision::{Detector, DetectorError, ImageError, Joint, Measured, Prior, Walls};

/// Standard deviation of the walls of a coupon that is known.
const WALL_SIGMA: f64 = 0.005;

/// Why a camera was not calibrated. Reads as one sentence.
#[derive(Debug, Error)]
pub enum CalibrateError {
    /// The list of pictures.
    #[error(transparent)]
    List(#[from] TableError),
    /// A file of a picture.
    #[error(transparent)]
    Png(#[from] PngError),
    /// Pixels of a picture.
    #[error("picture {file}: {reason}")]
    Image {
        /// The file.
        file: String,
        /// What is wrong.
        reason: ImageError,
    },
    /// A picture cannot be measured.
    #[error("picture {file}: {reason}")]
    Picture {
        /// The file.
        file: String,
        /// Why.
        reason: DetectorError,
    },
    /// A pair is not of two pictures.
    #[error("pair {pair} has {found} pictures in the list instead of 2")]
    Pair {
        /// Number of the pair.
        pair: f64,
        /// How many.
        found: usize,
    },
    /// Where the corner is remains unknown.
    #[error(
        "the position of the corner is unknown: list pictures of its open end with 0 in the column corner, or say --meets U,V, the slides at which the beam meets it"
    )]
    NoPlace,
    /// The noise is not that of photons.
    #[error(transparent)]
    Transfer(#[from] TransferError),
    /// No profile can be determined from the band.
    #[error(transparent)]
    Depth(#[from] DepthError),
    /// No matrix can be determined from the steps.
    #[error(transparent)]
    Slides(#[from] SlideError),
    /// No offset can be determined from the coupon.
    #[error(transparent)]
    Corner(#[from] CornerError),
}

/// A calibration, and the figures to print with it.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationResult {
    /// The calibration with what was found in it.
    pub calibration: Calibration,
    /// What was found.
    pub figures: Vec<Figure>,
}

/// One line of the printed result.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Name of the figure.
    pub text: &'static str,
    /// The value found, with its unit.
    pub found: String,
    /// The value before, or the permitted range.
    pub beside: String,
}

impl Figure {
    pub(super) fn new(text: &'static str, found: String, beside: String) -> Self {
        Self { text, found, beside }
    }
}

/// What is known of a picture for [`noise`].
pub const NOISE: [&str; 1] = ["pair"];

/// Photon transfer from pairs of equal pictures.
pub fn noise(
    listed: &[ReferencePicture<1>],
    before: &Calibration,
) -> Result<CalibrationResult, CalibrateError> {
    let mut numbers: Vec<f64> = Vec::new();
    for known in listed {
        if !numbers.contains(&known.values[0]) {
            numbers.push(known.values[0]);
        }
    }
    let mut pairs = Vec::new();
    for pair in numbers {
        let of: Vec<_> = listed.iter().filter(|known| known.values[0] == pair).collect();
        let [first, second] = of[..] else {
            let found = of.len();
            return Err(CalibrateError::Pair { pair, found });
        };
        pairs.push([image(first)?, image(second)?]);
    }
    let fit = photon_transfer(&pairs)?;
    let (is, was) = (fit.transfer, before.photon_transfer);
    let levels: Vec<String> = fit
        .levels
        .iter()
        .map(|level| format!("{:.0}", level.mean))
        .collect();
    let figures = vec![
        Figure::new(
            "full well",
            format!("{:.0} e", is.full_well),
            format!("was {:.0} e", was.full_well),
        ),
        Figure::new(
            "read noise",
            format!("{:.1} e", is.read_noise),
            format!("was {:.1} e", was.read_noise),
        ),
        Figure::new("levels of light", levels.join(", "), "at least 3".to_owned()),
        Figure::new(
            "noise off the line",
            format!("{:.1} %", 100.0 * fit.worst),
            "at most 5 %".to_owned(),
        ),
    ];
    let calibration = Calibration {
        photon_transfer: is,
        ..*before
    };
    Ok(CalibrationResult { calibration, figures })
}

/// What is known of a picture for [`profile`]: where the slides are.
pub const PROFILE: [&str; 2] = ["u_mm", "v_mm"];

/// Depth profile from pictures of a plate that the slides stepped through focus.
pub fn profile(
    listed: &[ReferencePicture<2>],
    before: &Calibration,
) -> Result<CalibrationResult, CalibrateError> {
    let mut steps = Vec::new();
    for known in listed {
        let [u, v] = known.values;
        // A camera that goes out sees the plate go down.
        let height_mm = -before.camera_step(u, v)[1];
        let image = image(known)?;
        steps.push(DepthStep { image, height_mm });
    }
    let fit = depth_profile(before.optics, before.photon_transfer, &steps)?;
    let (is, was) = (fit.profile, before.profile);
    let um = |mm: f64| format!("{:.1} µm", 1e3 * mm);
    let figures = vec![
        Figure::new(
            "profile, full resolution",
            um(is.fine_mm),
            format!("was {}", um(was.fine_mm)),
        ),
        Figure::new(
            "profile, half resolution",
            um(is.coarse_mm),
            format!("was {}", um(was.coarse_mm)),
        ),
        Figure::new(
            "scatter from picture to picture",
            format!("{:.1} %", 100.0 * fit.scatter[0].max(fit.scatter[1])),
            "at most 25 %".to_owned(),
        ),
        Figure::new(
            "pictures with a band",
            format!("{} of {}", fit.pictures, steps.len()),
            "at least 5".to_owned(),
        ),
        Figure::new(
            "texture over noise",
            format!("{:.0}", fit.contrast),
            "at least 40".to_owned(),
        ),
        Figure::new(
            "measured over commanded travel",
            format!("{:.3}", fit.way),
            "0.95 to 1.05".to_owned(),
        ),
    ];
    let calibration = Calibration {
        profile: is,
        ..*before
    };
    Ok(CalibrationResult { calibration, figures })
}

/// What is known of a picture for [`slides`]: which place of the seam it shows, where the slides are.
pub const SLIDES: [&str; 3] = ["place", "u_mm", "v_mm"];

/// Camera–slide matrix from pictures of a seam at rest, in the order they were taken; after place and slides stands how far
/// the machine had gone along travel \[mm\]. With `meets_mm`, the slides at which the beam meets that seam, the offset between
/// beam and camera too.
pub fn slides(
    listed: &[ReferencePicture<4>],
    before: &Calibration,
    meets_mm: Option<[f64; 2]>,
) -> Result<CalibrationResult, CalibrateError> {
    let mut seen = Vec::new();
    for known in listed {
        if let Some(measured) = seam(before, known, Joint::Gap)? {
            let [place, u, v, along_mm] = known.values;
            seen.push((place as u32, [u, v], along_mm, measured));
        }
    }
    let readings = on_axis(&seen);
    let fit = slide_matrix(&readings, before.slides.matrix)?;
    let mut calibration = *before;
    calibration.slides.matrix = fit.matrix;
    if let Some(meets) = meets_mm {
        calibration.slides.offset_mm = [0, 1].map(|k| meets[k] - fit.zero_mm[k]);
    }
    let mm_per_m = |share: f64| format!("{:+.1} mm/m", 1e3 * share);
    let um = |mm: f64| format!("{:.1} µm", 1e3 * mm);
    let play =
        |axis: usize| fit.backlash_mm[axis].map_or("not measured: step in both directions".to_owned(), um);
    let [offset_u, offset_v] = calibration.slides.offset_mm;
    let (was_u, was_v) = (before.slides.offset_mm[0], before.slides.offset_mm[1]);
    let as_before = "of the previous calibration".to_owned();
    let figures = vec![
        Figure::new(
            "scale across",
            mm_per_m(fit.scale[0]),
            "at most ±100 mm/m".to_owned(),
        ),
        Figure::new(
            "scale of heights",
            mm_per_m(fit.scale[1]),
            "at most ±100 mm/m".to_owned(),
        ),
        Figure::new(
            "rotation against the previous mount",
            format!("{:+.2}°", fit.rotation_rad.to_degrees()),
            "at most ±10°".to_owned(),
        ),
        Figure::new(
            "out of square",
            format!("{:+.2}°", fit.skew_rad.to_degrees()),
            String::new(),
        ),
        Figure::new(
            "residual in the pictures",
            format!(
                "{} rms, {} in picture {}",
                um(fit.residual_mm),
                um(fit.worst.1),
                fit.worst.0
            ),
            "at most 5 µm rms".to_owned(),
        ),
        Figure::new("play of U", play(0), String::new()),
        Figure::new("play of V", play(1), String::new()),
        Figure::new(
            "pictures with a seam",
            format!("{} of {}", seen.len(), listed.len()),
            "at least 8".to_owned(),
        ),
        Figure::new(
            "beam to camera, U and V",
            format!("{:+.1} {:+.1} µm", 1e3 * offset_u, 1e3 * offset_v),
            match meets_mm {
                Some(_) => format!("was {:+.1} {:+.1} µm", 1e3 * was_u, 1e3 * was_v),
                None => as_before,
            },
        ),
    ];
    Ok(CalibrationResult { calibration, figures })
}

/// What is known of a picture for [`corner`]: 1 where it is closed, 0 where the same line is an open gap; the slides.
pub const CORNER: [&str; 3] = ["corner", "u_mm", "v_mm"];

/// Offset of a corner from pictures of a coupon whose walls have the slopes `walls`. Where the corner is comes from the
/// open pictures, or from `meets_mm`, the slides at which the beam meets it.
pub fn corner(
    listed: &[ReferencePicture<3>],
    before: &Calibration,
    walls: [f64; 2],
    meets_mm: Option<[f64; 2]>,
) -> Result<CalibrationResult, CalibrateError> {
    let closed = Joint::Corner(Walls {
        slopes: walls,
        sigma: WALL_SIGMA,
    });
    let (mut open, mut reads) = (Vec::new(), Vec::new());
    for known in listed {
        let [corner, u, v] = known.values;
        if corner == 0.0 {
            open.extend(seam(before, known, Joint::Gap)?.map(|measured| (0, [u, v], 0.0, measured)));
        } else if let Some(measured) = seam(before, known, closed)? {
            reads.push(([u, v], [measured.lateral_mm, measured.height_mm]));
        }
    }
    let open: Vec<_> = on_axis(&open)
        .iter()
        .map(|reading| {
            let delta = before.slides.deltas(reading.seen_mm[0], reading.seen_mm[1]);
            [0, 1].map(|k| reading.slides_mm[k] + delta[k])
        })
        .collect();
    let mean = |k: usize| open.iter().map(|at| at[k]).sum::<f64>() / open.len() as f64;
    let at = match meets_mm {
        Some(meets) => meets,
        None if open.is_empty() => return Err(CalibrateError::NoPlace),
        None => [mean(0), mean(1)],
    };
    let offset = before.slides.offset_mm;
    let pair = |&([u, v], reads_mm): &([f64; 2], [f64; 2])| CornerPair {
        is_mm: before.camera_step(at[0] - u - offset[0], at[1] - v - offset[1]),
        reads_mm,
    };
    let fit = corner_offset(&reads.iter().map(pair).collect::<Vec<_>>())?;
    let um = |[u, n]: [f64; 2]| format!("{:+.1} {:+.1} µm", 1e3 * u, 1e3 * n);
    let figures = vec![
        Figure::new(
            "added to a corner, across and height",
            um(fit.offset_mm),
            before
                .corner_offset_mm
                .map_or("none was known".to_owned(), |was| format!("was {}", um(was))),
        ),
        Figure::new(
            "scatter of a picture",
            format!("{:.1} µm", 1e3 * fit.scatter_mm[0].max(fit.scatter_mm[1])),
            "at most 10 µm".to_owned(),
        ),
        Figure::new(
            "pictures of the corner",
            fit.places.to_string(),
            "at least 4".to_owned(),
        ),
    ];
    let calibration = Calibration {
        corner_offset_mm: Some(fit.offset_mm),
        ..*before
    };
    Ok(CalibrationResult { calibration, figures })
}

/// A picture taken at a step of the slides: number of the place along the seam, position of the slides,
/// offset of the machine along travel, measurement.
type SlidePicture = (u32, [f64; 2], f64, Measured);

/// The readings of a straight seam: its angle is the mean of each place's pictures, and takes what a height or the machine
/// shifts the place that is seen along it.
fn on_axis(seen: &[SlidePicture]) -> Vec<SlideReading> {
    let yaw = |place: u32| {
        let of = seen
            .iter()
            .filter(|(at, ..)| *at == place)
            .map(|(.., measured)| measured.yaw_rad);
        let (sum, count) = of.fold((0.0, 0.0), |(sum, count), yaw| (sum + yaw, count + 1.0));
        sum / count
    };
    let reading = |&(place, slides_mm, along_mm, measured): &SlidePicture| SlideReading {
        place,
        slides_mm,
        seen_mm: [
            measured.lateral_mm - (along_mm + measured.travel_mm) * f64::tan(yaw(place)),
            measured.height_mm,
        ],
    };
    seen.iter().map(reading).collect()
}

/// The seam in a picture, if it shows one.
fn seam<const N: usize>(
    calibration: &Calibration,
    known: &ReferencePicture<N>,
    joint: Joint,
) -> Result<Option<Measured>, CalibrateError> {
    let picture = |reason| CalibrateError::Picture {
        file: known.file.display().to_string(),
        reason,
    };
    let Calibration {
        optics,
        photon_transfer,
        profile,
        ..
    } = *calibration;
    let mut detector = Detector::new(optics, photon_transfer, profile).map_err(picture)?;
    let prior = Prior {
        joint,
        track: None,
        focus: 0.0,
    };
    let report = detector.measure(&image(known)?, &prior).map_err(picture)?;
    Ok(report.seam().copied())
}

/// The picture as it is measured.
fn image<const N: usize>(known: &ReferencePicture<N>) -> Result<vision::Image<'_>, CalibrateError> {
    known.picture.image().map_err(|reason| CalibrateError::Image {
        file: known.file.display().to_string(),
        reason,
    })
}
