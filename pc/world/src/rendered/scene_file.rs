//! The scene file: what the seams of a simulated world look like, and what disturbs their pictures.

use super::scene_effects::{
    DirtSpot, Grooves, JointStretch, Plate, SensorFile, StrayLight, Stretch, TackStretch,
};
use config::table::FARTHEST_MM;
use config::toml_file::{self, TomlError};
use config::{RangeError, in_range};
use serde::Deserialize;
use shared::io::SIDES;
use std::path::Path;
use thiserror::Error;
use vision::render::Finish;

/// What messages call the file.
const WHAT: &str = "scene file";

/// What the seams look like, and what disturbs their pictures.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SceneFile {
    /// How the work beside seam 1 and 2 was made.
    pub texture: [SurfaceFinish; SIDES],
    /// How the work right of gap 1 and 2 was made, in place of going on as it is left of it.
    pub right_texture: Option<[SurfaceFinish; SIDES]>,
    /// Mean brightness of the work, 0…1 of full scale.
    pub light: f64,
    /// Standard deviation of the light from picture to picture, a share of it.
    pub flicker_share: f64,
    /// How far the work travels during an exposure: 7.5 µm are 50 µs at 9 m/min.
    pub smear_um: f64,
    /// How much nearer best focus lies in the corners of a picture than in its middle \[µm\].
    pub field_curvature_um: f64,
    /// Width of the gaps \[mm\], and by how much it goes up and down over which length of seam.
    pub gap_mm: f64,
    /// See `gap_mm`.
    pub gap_wave_mm: f64,
    /// See `gap_mm`.
    pub gap_wave_length_mm: f64,
    /// By how much the work rolls to and fro about the seam \[°\], over which length of it \[mm\].
    pub roll_wave_deg: f64,
    /// See `roll_wave_deg`.
    pub roll_wave_length_mm: f64,
    /// By how much the work lies higher or lower than the seam in a picture, standard deviation \[µm\].
    pub height_noise_um: f64,
    /// Share of the pictures with spatter in them.
    pub spatter_share: f64,
    /// Share of the pictures that never arrive.
    pub lost_share: f64,
    /// Share of the pictures that arrive late, by `late_ms`.
    pub late_share: f64,
    /// See `late_share`.
    pub late_ms: f64,
    /// Scratches along the seams.
    pub scratch: Vec<Scratch>,
    /// Lights that fail.
    pub dark: Vec<Dark>,
    /// Plates that look otherwise over a stretch, or end.
    pub plate: Vec<Plate>,
    /// Joints that are closed or stepped over a stretch.
    pub joint: Vec<JointStretch>,
    /// Beads that close a gap.
    pub tack: Vec<TackStretch>,
    /// Regular grooves.
    pub grooves: Vec<Grooves>,
    /// Light that does not come from the work.
    pub stray_light: Vec<StrayLight>,
    /// Spots on the windows.
    pub dirt: Vec<DirtSpot>,
    /// The sensors, where they are not as calibrated.
    pub sensor: SensorFile,
}

/// Finish of the work beside a seam.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SurfaceFinish {
    /// Ground.
    Ground,
    /// Rolled, with streaks along the seam.
    Rolled,
    /// Blasted, with glints.
    Blasted,
    /// Specular.
    Specular,
    /// With hardly any contrast.
    Faint,
    /// Coarse.
    Coarse,
}

impl SurfaceFinish {
    /// What renders it.
    pub fn finish(self) -> Finish {
        match self {
            Self::Ground => Finish::Plain,
            Self::Rolled => Finish::Rolled,
            Self::Blasted => Finish::Blasted,
            Self::Specular => Finish::Specular,
            Self::Faint => Finish::Faint,
            Self::Coarse => Finish::Coarse,
        }
    }
}

/// A scratch along a seam.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scratch {
    /// 1 or 2.
    pub side: u8,
    /// How far beside the middle of the seam \[mm\].
    pub offset_mm: f64,
    /// Its width \[mm\].
    pub width_mm: f64,
    /// How bright it is, the work being 1.
    pub brightness: f64,
    /// Where it begins and ends on the seam, from where the first beam goes on \[mm\].
    pub from_s_mm: Option<f64>,
    /// See `from_s_mm`.
    pub to_s_mm: Option<f64>,
}

/// A light that fails.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dark {
    /// 1 or 2.
    pub side: u8,
    /// When the camera is there on the seam, from where the first beam goes on \[mm\].
    pub from_s_mm: f64,
    /// For how long \[ms\]; without it for good.
    pub for_ms: Option<f64>,
}

impl Default for SceneFile {
    /// Ground plates, gaps of 0.10 to 0.15 mm, nothing that disturbs.
    fn default() -> Self {
        Self {
            texture: [SurfaceFinish::Ground; SIDES],
            right_texture: None,
            light: 0.5,
            flicker_share: 0.0,
            smear_um: 7.5,
            field_curvature_um: 0.0,
            gap_mm: 0.125,
            gap_wave_mm: 0.025,
            gap_wave_length_mm: 90.0,
            roll_wave_deg: 0.0,
            roll_wave_length_mm: 150.0,
            height_noise_um: 0.0,
            spatter_share: 0.0,
            lost_share: 0.0,
            late_share: 0.0,
            late_ms: 0.0,
            scratch: Vec::new(),
            dark: Vec::new(),
            plate: Vec::new(),
            joint: Vec::new(),
            tack: Vec::new(),
            grooves: Vec::new(),
            stray_light: Vec::new(),
            dirt: Vec::new(),
            sensor: SensorFile::default(),
        }
    }
}

/// Why a scene file cannot be used. Reads as one sentence.
#[derive(Debug, Error)]
pub enum SceneError {
    /// It cannot be read, or is no scene.
    #[error(transparent)]
    File(#[from] TomlError),
    /// A value makes no sense.
    #[error("scene file {path}: {source}")]
    Value {
        /// The file.
        path: String,
        /// Which one.
        source: RangeError,
    },
}

impl SceneFile {
    /// Reads the file at `path`.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        Self::parse(&path.display().to_string(), &toml_file::text(WHAT, path)?)
    }

    /// Understands `text`; `path` is used in messages only.
    pub fn parse(path: &str, text: &str) -> Result<Self, SceneError> {
        let scene: Self = toml_file::parse(WHAT, path, text)?;
        for (key, value, range) in scene.values() {
            in_range(key, value, range.holds(value), range.requirement()).map_err(|source| {
                let path = path.to_owned();
                SceneError::Value { path, source }
            })?;
        }
        Ok(scene)
    }

    /// Everything that has a range.
    fn values(&self) -> Vec<(String, f64, Range)> {
        let mut values: Vec<(String, f64, Range)> = [
            ("light", self.light, Range::Light),
            ("flicker_share", self.flicker_share, Range::Share),
            ("field_curvature_um", self.field_curvature_um, Range::Curvature),
            (
                "full_well_factor of sensor",
                self.sensor.full_well_factor,
                Range::Factor,
            ),
            (
                "read_noise_factor of sensor",
                self.sensor.read_noise_factor,
                Range::Factor,
            ),
            ("pattern of sensor", self.sensor.pattern, Range::Share),
            ("smear_um", self.smear_um, Range::Smear),
            ("gap_mm", self.gap_mm, Range::Gap),
            ("gap_wave_mm", self.gap_wave_mm, Range::Gap),
            ("gap_mm - gap_wave_mm", self.gap_mm - self.gap_wave_mm, Range::Gap),
            ("gap_wave_length_mm", self.gap_wave_length_mm, Range::WaveLength),
            ("roll_wave_deg", self.roll_wave_deg, Range::Roll),
            ("roll_wave_length_mm", self.roll_wave_length_mm, Range::WaveLength),
            ("height_noise_um", self.height_noise_um, Range::Noise),
            ("spatter_share", self.spatter_share, Range::Share),
            ("lost_share", self.lost_share, Range::Share),
            ("late_share", self.late_share, Range::Share),
            ("late_ms", self.late_ms, Range::Late),
        ]
        .map(|(key, value, range)| (key.to_owned(), value, range))
        .into();
        for (i, scratch) in self.scratch.iter().enumerate() {
            let key = |name| format!("{name} of scratch {}", i + 1);
            values.extend([
                (key("side"), f64::from(scratch.side), Range::Side),
                (key("offset_mm"), scratch.offset_mm, Range::Beside),
                (key("width_mm"), scratch.width_mm, Range::Width),
                (key("brightness"), scratch.brightness, Range::Brightness),
                (key("from_s_mm"), scratch.from_s_mm.unwrap_or(0.0), Range::Along),
                (key("to_s_mm"), scratch.to_s_mm.unwrap_or(0.0), Range::Along),
            ]);
        }
        for (i, dark) in self.dark.iter().enumerate() {
            let key = |name| format!("{name} of dark {}", i + 1);
            values.extend([
                (key("side"), f64::from(dark.side), Range::Side),
                (key("from_s_mm"), dark.from_s_mm, Range::Along),
                (key("for_ms"), dark.for_ms.unwrap_or(0.0), Range::Dark),
            ]);
        }
        fn checked(all: &[impl Stretch]) -> impl Iterator<Item = (String, f64, Range)> {
            all.iter()
                .enumerate()
                .flat_map(|(i, stretch)| stretch.checked(i + 1))
        }
        values.extend(checked(&self.plate));
        values.extend(checked(&self.joint));
        values.extend(checked(&self.tack));
        values.extend(checked(&self.grooves));
        values.extend(checked(&self.stray_light));
        values.extend(checked(&self.dirt));
        values
    }
}

/// What a value may be.
#[derive(Clone, Copy)]
pub(super) enum Range {
    Along,
    Beside,
    Brightness,
    Curvature,
    Dark,
    Edge,
    Factor,
    Gap,
    Late,
    Length,
    Light,
    Noise,
    Pitch,
    Place,
    Radius,
    Roll,
    Share,
    Side,
    Smear,
    Step,
    WaveLength,
    Width,
}

impl Range {
    fn holds(self, value: f64) -> bool {
        let (from, to) = match self {
            // A seam is no longer than a table can say.
            Self::Along => (-FARTHEST_MM, FARTHEST_MM),
            // A picture shows some millimetres.
            Self::Beside => (-100.0, 100.0),
            Self::Brightness => (0.0, 100.0),
            // As much as the whole picture is deep.
            Self::Curvature => (-500.0, 500.0),
            Self::Dark => (0.0, 1e9),
            // A picture shows some millimetres.
            Self::Edge => (0.0, 1000.0),
            Self::Factor => (0.01, 100.0),
            Self::Gap | Self::Share => (0.0, 1.0),
            // Long after that the tracker has given up.
            Self::Late => (0.0, 1e4),
            Self::Length => (0.0, 2.0 * FARTHEST_MM),
            Self::Light => (0.0, 2.0),
            // Finer ones no camera sees.
            Self::Pitch => (0.01, 10.0),
            Self::Place => (-2.0, 2.0),
            Self::Radius => (0.01, 10.0),
            Self::Step => (-1.0, 1.0),
            // Beyond half a millimetre nothing of the work is in focus.
            Self::Noise => (0.0, 500.0),
            Self::Roll => (0.0, 15.0),
            Self::Side => return value == 1.0 || value == 2.0,
            // 0.3 ms at 9 m/min; of more there is nothing left to see.
            Self::Smear => (0.0, 50.0),
            Self::WaveLength => (1.0, FARTHEST_MM),
            Self::Width => (1e-4, 10.0),
        };
        (from..=to).contains(&value)
    }

    fn requirement(self) -> &'static str {
        match self {
            Self::Along => "from -100000 to 100000 mm",
            Self::Beside => "from -100 to 100 mm",
            Self::Brightness => "from 0 to 100",
            Self::Curvature => "from -500 to 500 µm",
            Self::Dark => "from 0 to 1000000000 ms",
            Self::Edge => "from 0 to 1000 µm",
            Self::Factor => "from 0.01 to 100",
            Self::Gap => "from 0 to 1 mm",
            Self::Late => "from 0 to 10000 ms",
            Self::Length => "0 mm or more",
            Self::Light => "from 0 to 2",
            Self::Pitch => "from 0.01 to 10 mm",
            Self::Place => "from -2 to 2",
            Self::Radius => "from 0.01 to 10",
            Self::Step => "from -1 to 1 mm",
            Self::Noise => "from 0 to 500 µm",
            Self::Roll => "from 0 to 15 degrees",
            Self::Share => "from 0 to 1",
            Self::Side => "1 or 2",
            Self::Smear => "from 0 to 50 µm",
            Self::WaveLength => "from 1 to 100000 mm",
            Self::Width => "from 0.0001 to 10 mm",
        }
    }
}
