//! The calibration file as it is written: degrees and µm.

use super::{Calibration, CalibrationError, SlideMap, SpotCalibration};
use crate::toml_file;
use serde::{Deserialize, Serialize};
use vision::{Optics, PhotonTransfer, Profile};

/// µm in a mm.
const UM_PER_MM: f64 = 1e3;

/// µs in a s.
const US_PER_S: f64 = 1e6;

/// Longest delay of an exposure \[s\]: some frames; what is more belongs to another strobe.
const MOST_DELAY_S: f64 = 0.02;

/// Decimals of what is written: 10⁻⁹ of a mm or of a whole.
const DECIMALS: f64 = 1e9;

/// Says at the head of a file what it is.
const HEAD: &str = "# Calibration of one camera. Written by `seamwright calibrate`; what it cannot measure \
comes from the machine file.\n\n";

/// Lens and sensor of a camera, as files have them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OpticsTable {
    /// Magnification of the lens.
    pub magnification: f64,
    /// Pitch of the pixels of a picture on the sensor, binned as they are \[µm\].
    pub pixel_um: f64,
    /// α: angle between focal plane and plate \[°\].
    pub tilt_deg: f64,
    /// Numerical aperture.
    pub aperture: f64,
    /// Wavelength of the light \[µm\].
    pub wavelength_um: f64,
    /// Pixels a row.
    pub columns: usize,
    /// Rows of a picture.
    pub rows: usize,
}

/// Noise of a camera, as files have it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhotonTransferTable {
    /// Electrons of a pixel of the picture at 255.
    pub full_well: f64,
    /// Read noise of such a pixel, standard deviation in electrons.
    pub read_noise: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ProfileTable {
    fine_um: f64,
    coarse_um: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SlidesTable {
    matrix: [[f64; 2]; 2],
    offset_um: [f64; 2],
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CornerTable {
    offset_um: [f64; 2],
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SpotTable {
    lead_mm: f64,
    delay_us: f64,
    uncertainty_um: [f64; 2],
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    optics: OpticsTable,
    photon_transfer: PhotonTransferTable,
    profile: ProfileTable,
    slides: SlidesTable,
    corner: Option<CornerTable>,
    spot: Option<SpotTable>,
}

impl From<OpticsTable> for Optics {
    fn from(table: OpticsTable) -> Self {
        Self {
            magnification: table.magnification,
            pixel_mm: table.pixel_um / UM_PER_MM,
            tilt_rad: table.tilt_deg.to_radians(),
            aperture: table.aperture,
            wavelength_mm: table.wavelength_um / UM_PER_MM,
            rows: table.rows,
            columns: table.columns,
        }
    }
}

impl From<Optics> for OpticsTable {
    fn from(optics: Optics) -> Self {
        Self {
            magnification: rounded(optics.magnification),
            pixel_um: rounded(optics.pixel_mm * UM_PER_MM),
            tilt_deg: rounded(optics.tilt_rad.to_degrees()),
            aperture: rounded(optics.aperture),
            wavelength_um: rounded(optics.wavelength_mm * UM_PER_MM),
            rows: optics.rows,
            columns: optics.columns,
        }
    }
}

impl From<PhotonTransferTable> for PhotonTransfer {
    fn from(table: PhotonTransferTable) -> Self {
        let PhotonTransferTable {
            full_well,
            read_noise,
        } = table;
        Self {
            full_well,
            read_noise,
        }
    }
}

impl From<PhotonTransfer> for PhotonTransferTable {
    fn from(transfer: PhotonTransfer) -> Self {
        Self {
            full_well: rounded(transfer.full_well),
            read_noise: rounded(transfer.read_noise),
        }
    }
}

/// Understands the text of a file.
pub(super) fn parse(name: &str, text: &str) -> Result<Calibration, CalibrationError> {
    let document: Document = toml_file::parse("calibration", name, text)?;
    let wrong = |table: &str, reason: String| CalibrationError::Value {
        path: name.to_owned(),
        line: line_of_table(text, table),
        reason,
    };
    let optics = Optics::from(document.optics);
    optics
        .check()
        .map_err(|error| wrong("optics", error.to_string()))?;
    let profile = &document.profile;
    let above_0 = [
        ("photon_transfer", "full_well", document.photon_transfer.full_well),
        ("profile", "fine_um", profile.fine_um),
        ("profile", "coarse_um", profile.coarse_um),
    ];
    for (table, key, value) in above_0 {
        if !(value.is_finite() && value > 0.0) {
            return Err(wrong(table, format!("{key} is {value}, but must be above 0")));
        }
    }
    let read_noise = document.photon_transfer.read_noise;
    if !(read_noise.is_finite() && read_noise >= 0.0) {
        let reason = format!("read_noise is {read_noise}, but must be 0 or more");
        return Err(wrong("photon_transfer", reason));
    }
    let slides = SlideMap {
        matrix: document.slides.matrix,
        offset_mm: document.slides.offset_um.map(|um| um / UM_PER_MM),
    };
    if !slides.is_regular() {
        let reason = format!(
            "matrix has a determinant of {:.3}, that of a camera that sees both slides move is about 1: calibrate the \
             slides again",
            slides.determinant()
        );
        return Err(wrong("slides", reason));
    }
    let corner = document.corner.map(|corner| corner.offset_um);
    let offsets = [("slides", Some(document.slides.offset_um)), ("corner", corner)];
    for (table, offset) in offsets {
        if let Some(value) = offset.into_iter().flatten().find(|value| !value.is_finite()) {
            return Err(wrong(
                table,
                format!("offset_um is {value}, but must be a finite number"),
            ));
        }
    }
    let spot = document.spot.map(|spot| SpotCalibration {
        lead_mm: spot.lead_mm,
        delay_s: spot.delay_us / US_PER_S,
        uncertainty_mm: spot.uncertainty_um.map(|um| um / UM_PER_MM),
    });
    if let Some(found) = &spot {
        check_spot(found).map_err(|reason| wrong("spot", reason))?;
    }
    Ok(Calibration {
        optics,
        photon_transfer: document.photon_transfer.into(),
        profile: Profile {
            fine_mm: profile.fine_um / UM_PER_MM,
            coarse_mm: profile.coarse_um / UM_PER_MM,
        },
        slides,
        corner_offset_mm: corner.map(|offset| offset.map(|um| um / UM_PER_MM)),
        spot,
    })
}

/// What is wrong with what was found of a spot.
fn check_spot(spot: &SpotCalibration) -> Result<(), String> {
    let most_delay = MOST_DELAY_S * US_PER_S;
    if !(spot.lead_mm.is_finite() && spot.lead_mm > 0.0) {
        return Err(format!("lead_mm is {}, but must be above 0", spot.lead_mm));
    }
    let delay = spot.delay_s * US_PER_S;
    if !(spot.delay_s.is_finite() && spot.delay_s.abs() <= MOST_DELAY_S) {
        return Err(format!(
            "delay_us is {delay:.0}, but must be within ±{most_delay:.0}: look at the trigger and the exposure of the camera"
        ));
    }
    let wrong = |um: &f64| !(um.is_finite() && *um >= 0.0);
    match spot.uncertainty_mm.iter().find(|um| wrong(um)) {
        Some(mm) => Err(format!(
            "uncertainty_um is {}, but must be 0 or more",
            mm * UM_PER_MM
        )),
        None => Ok(()),
    }
}

/// The text of a file.
pub(super) fn write(calibration: &Calibration) -> String {
    let um = |mm: f64| rounded(mm * UM_PER_MM);
    let document = Document {
        optics: calibration.optics.into(),
        photon_transfer: calibration.photon_transfer.into(),
        profile: ProfileTable {
            fine_um: um(calibration.profile.fine_mm),
            coarse_um: um(calibration.profile.coarse_mm),
        },
        slides: SlidesTable {
            matrix: calibration.slides.matrix.map(|row| row.map(rounded)),
            offset_um: calibration.slides.offset_mm.map(um),
        },
        corner: calibration.corner_offset_mm.map(|offset| CornerTable {
            offset_um: offset.map(um),
        }),
        spot: calibration.spot.map(|spot| SpotTable {
            lead_mm: rounded(spot.lead_mm),
            delay_us: rounded(spot.delay_s * US_PER_S),
            uncertainty_um: spot.uncertainty_mm.map(um),
        }),
    };
    let text = toml::to_string(&document).expect("numbers in tables are TOML");
    format!("{HEAD}{text}")
}

/// As many decimals as are read again.
fn rounded(value: f64) -> f64 {
    (value * DECIMALS).round() / DECIMALS
}

/// Line of a table's head; the first line if it is not written as one.
fn line_of_table(text: &str, table: &str) -> usize {
    let head = format!("[{table}]");
    1 + text.lines().position(|line| line.trim() == head).unwrap_or(0)
}
