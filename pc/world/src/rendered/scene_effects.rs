//! What a scene file says of stretches of a seam: plates, joint, tacks, grooves, and what lies over the pictures.

use super::scene_file::Range;
use serde::Deserialize;
use vision::render::{Dirt, Glare};

/// From where to where on a seam something is there.
pub(super) trait Stretch {
    /// Number of the seam (1 or 2), and from and to where on it \[mm\]; none is without end.
    fn stretch(&self) -> (u8, Option<f64>, Option<f64>);

    /// What the file calls it, its keys, their values and what those may be.
    fn values(&self) -> (&'static str, Vec<(&'static str, f64, Range)>);

    /// Whether it is there, in a picture of a seam (0 or 1).
    fn is_at(&self, side: usize, along_mm: f64) -> bool {
        let (number, from, to) = self.stretch();
        let from = from.is_none_or(|from| along_mm >= from);
        usize::from(number) == side + 1 && from && to.is_none_or(|to| along_mm <= to)
    }

    /// From where to where on the seam \[mm\].
    fn reaches_mm(&self) -> [f64; 2] {
        let (_, from, to) = self.stretch();
        [from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY)]
    }

    /// All that has a range, with the stretch.
    fn checked(&self, number: usize) -> Vec<(String, f64, Range)> {
        let (side, from, to) = self.stretch();
        let (name, mut values) = self.values();
        values.push(("side", f64::from(side), Range::Side));
        let ends = [("from_s_mm", from), ("to_s_mm", to)];
        values.extend(ends.map(|(key, end)| (key, end.unwrap_or(0.0), Range::Along)));
        if let (Some(from), Some(to)) = (from, to) {
            values.push(("to_s_mm - from_s_mm", to - from, Range::Length));
        }
        let named = |(key, value, range)| (format!("{key} of {name} {number}"), value, range);
        values.into_iter().map(named).collect()
    }
}

/// Has [`Stretch::stretch`] return the keys that every table has.
macro_rules! stretch {
    () => {
        fn stretch(&self) -> (u8, Option<f64>, Option<f64>) {
            (self.side, self.from_s_mm, self.to_s_mm)
        }
    };
}

/// Which plates of a seam.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Plates {
    /// Left of the seam in the picture.
    Left,
    /// Right of it.
    Right,
    /// Both.
    #[default]
    Both,
}

/// How a mark runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Direction {
    /// Along the seam.
    #[default]
    Along,
    /// Across it.
    Across,
}

/// A stretch of the plates beside a gap.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Plate {
    /// 1 or 2.
    pub side: u8,
    /// Which of its plates.
    pub plate: Plates,
    /// How bright it is, the work being 1.
    pub brightness: f64,
    /// Leg of a chamfer \[µm\].
    pub chamfer_um: f64,
    /// Radius of a rolled edge \[µm\].
    pub rounding_um: f64,
    /// Height of a burr \[µm\].
    pub burr_um: f64,
    /// What chamfer, rolled edge or burr multiplies the brightness by.
    pub edge_factor: f64,
    /// Brightness of the gap's wall.
    pub wall_brightness: f64,
    /// Width of a line along the edge \[µm\], and what it multiplies the brightness by.
    pub line_um: f64,
    /// See `line_um`.
    pub line_factor: f64,
    /// Whether there is no plate.
    pub missing: bool,
    /// Where it begins and ends on the seam, from where the first beam goes on \[mm\].
    pub from_s_mm: Option<f64>,
    /// See `from_s_mm`.
    pub to_s_mm: Option<f64>,
}

impl Default for Plate {
    fn default() -> Self {
        Self {
            // None: it has to be given.
            side: 0,
            plate: Plates::Both,
            brightness: 1.0,
            chamfer_um: 0.0,
            rounding_um: 0.0,
            burr_um: 0.0,
            edge_factor: 1.0,
            wall_brightness: 0.0,
            line_um: 0.0,
            line_factor: 1.0,
            missing: false,
            from_s_mm: None,
            to_s_mm: None,
        }
    }
}

impl Stretch for Plate {
    stretch!();

    fn values(&self) -> (&'static str, Vec<(&'static str, f64, Range)>) {
        let values = vec![
            ("brightness", self.brightness, Range::Brightness),
            ("chamfer_um", self.chamfer_um, Range::Edge),
            ("rounding_um", self.rounding_um, Range::Edge),
            ("burr_um", self.burr_um, Range::Edge),
            ("edge_factor", self.edge_factor, Range::Brightness),
            ("wall_brightness", self.wall_brightness, Range::Brightness),
            ("line_um", self.line_um, Range::Edge),
            ("line_factor", self.line_factor, Range::Brightness),
        ];
        ("plate", values)
    }
}

/// A stretch of the joint.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointStretch {
    /// 1 or 2.
    pub side: u8,
    /// Width of the gap in place of the file's, 0 of a closed joint \[mm\].
    pub gap_mm: Option<f64>,
    /// How much higher the right plate lies \[mm\].
    #[serde(default)]
    pub step_mm: f64,
    /// Width of the shadow on the lower plate \[µm\], and what it multiplies the brightness by.
    #[serde(default)]
    pub shadow_um: f64,
    /// See `shadow_um`.
    #[serde(default = "dark_shadow")]
    pub shadow_factor: f64,
    /// Where it begins and ends on the seam, from where the first beam goes on \[mm\].
    pub from_s_mm: Option<f64>,
    /// See `from_s_mm`.
    pub to_s_mm: Option<f64>,
}

/// Brightness in the shadow of a plate.
fn dark_shadow() -> f64 {
    0.2
}

impl Stretch for JointStretch {
    stretch!();

    fn values(&self) -> (&'static str, Vec<(&'static str, f64, Range)>) {
        let values = vec![
            ("gap_mm", self.gap_mm.unwrap_or(0.0), Range::Gap),
            ("step_mm", self.step_mm, Range::Step),
            ("shadow_um", self.shadow_um, Range::Edge),
            ("shadow_factor", self.shadow_factor, Range::Brightness),
        ];
        ("joint", values)
    }
}

/// A bead that closes the gap.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TackStretch {
    /// 1 or 2.
    pub side: u8,
    /// Width across the seam \[mm\].
    pub width_mm: f64,
    /// How bright it is, the work being 1.
    pub brightness: f64,
    /// Where it begins and ends on the seam, from where the first beam goes on \[mm\].
    pub from_s_mm: Option<f64>,
    /// See `from_s_mm`.
    pub to_s_mm: Option<f64>,
}

impl Stretch for TackStretch {
    stretch!();

    fn values(&self) -> (&'static str, Vec<(&'static str, f64, Range)>) {
        let values = vec![
            ("width_mm", self.width_mm, Range::Width),
            ("brightness", self.brightness, Range::Brightness),
        ];
        ("tack", values)
    }
}

/// Regular grooves in the plates.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grooves {
    /// 1 or 2.
    pub side: u8,
    /// How they run.
    #[serde(default)]
    pub run: Direction,
    /// From one to the next \[mm\].
    pub pitch_mm: f64,
    /// Width of each \[mm\].
    pub width_mm: f64,
    /// How bright they are, the work being 1.
    pub brightness: f64,
    /// Where they begin and end on the seam, from where the first beam goes on \[mm\].
    pub from_s_mm: Option<f64>,
    /// See `from_s_mm`.
    pub to_s_mm: Option<f64>,
}

impl Stretch for Grooves {
    stretch!();

    fn values(&self) -> (&'static str, Vec<(&'static str, f64, Range)>) {
        let values = vec![
            ("pitch_mm", self.pitch_mm, Range::Pitch),
            ("width_mm", self.width_mm, Range::Width),
            (
                "pitch_mm - width_mm",
                self.pitch_mm - self.width_mm,
                Range::Length,
            ),
            ("brightness", self.brightness, Range::Brightness),
        ];
        ("grooves", values)
    }
}

/// Light that does not come from the work: a veil over the picture, and a spot in it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StrayLight {
    /// 1 or 2.
    pub side: u8,
    /// Share of full scale that lies over everything.
    #[serde(default)]
    pub veil: f64,
    /// Share of full scale in the middle of a spot.
    #[serde(default)]
    pub glare: f64,
    /// Where in the picture that is, −1…1 over columns and rows.
    #[serde(default)]
    pub at: [f64; 2],
    /// Standard deviation of the spot on that scale.
    #[serde(default = "wide_spot")]
    pub radius: f64,
    /// Where it begins and ends on the seam, from where the first beam goes on \[mm\].
    pub from_s_mm: Option<f64>,
    /// See `from_s_mm`.
    pub to_s_mm: Option<f64>,
}

fn wide_spot() -> f64 {
    0.5
}

impl Stretch for StrayLight {
    stretch!();

    fn values(&self) -> (&'static str, Vec<(&'static str, f64, Range)>) {
        let values = vec![
            ("veil", self.veil, Range::Light),
            ("glare", self.glare, Range::Light),
            ("at column", self.at[0], Range::Place),
            ("at row", self.at[1], Range::Place),
            ("radius", self.radius, Range::Radius),
        ];
        ("stray_light", values)
    }
}

impl StrayLight {
    /// The spot, if there is one.
    pub(super) fn spot(&self) -> Option<Glare> {
        let glare = Glare {
            middle: self.at,
            radius: self.radius,
            level: self.glare,
        };
        (self.glare > 0.0).then_some(glare)
    }
}

/// A spot on the window.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DirtSpot {
    /// 1 or 2.
    pub side: u8,
    /// Where in the picture, −1…1 over columns and rows.
    pub at: [f64; 2],
    /// Its standard deviation on that scale.
    pub radius: f64,
    /// What it multiplies the light by in its middle.
    pub factor: f64,
    /// Where it begins and ends on the seam, from where the first beam goes on \[mm\].
    pub from_s_mm: Option<f64>,
    /// See `from_s_mm`.
    pub to_s_mm: Option<f64>,
}

impl Stretch for DirtSpot {
    stretch!();

    fn values(&self) -> (&'static str, Vec<(&'static str, f64, Range)>) {
        let values = vec![
            ("at column", self.at[0], Range::Place),
            ("at row", self.at[1], Range::Place),
            ("radius", self.radius, Range::Radius),
            ("factor", self.factor, Range::Share),
        ];
        ("dirt", values)
    }
}

impl DirtSpot {
    pub(super) fn spot(&self) -> Dirt {
        Dirt {
            middle: self.at,
            radius: self.radius,
            factor: self.factor,
        }
    }
}

/// How the cameras' sensors differ from what is calibrated.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SensorFile {
    /// Electrons at full scale over the calibrated ones.
    pub full_well_factor: f64,
    /// Read noise over the calibrated one.
    pub read_noise_factor: f64,
    /// Standard deviation of the pixels' gain.
    pub pattern: f64,
}

impl Default for SensorFile {
    fn default() -> Self {
        Self {
            full_well_factor: 1.0,
            read_noise_factor: 1.0,
            pattern: 0.0,
        }
    }
}
