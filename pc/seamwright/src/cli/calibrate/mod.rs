//! `seamwright calibrate`: calibration of a camera, with the machine or from pictures with known values.

mod coupon;
mod live;
mod on_machine;
mod spot;

use crate::console::{out, outln};
use anyhow::{Context, bail};
use camera::calibrate::procedure;
use camera::calibrate::procedure::CalibrationResult;
use camera::calibrate::{CalibrateError, ReferencePicture, read_pictures};
use clap::{Args, Subcommand};
use config::calibration::Calibration;
use config::machine::MachineFile;
use emulator::MACHINE_VARIABLE;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Calibrate a camera, with the machine or from pictures in a folder
///
/// Results are printed beside the previous values. A poor fit is refused with the reason, and the file is
/// then left as it was.
#[derive(Debug, Args)]
pub struct Calibrate {
    #[command(subcommand)]
    what: What,
}

/// What to find.
#[derive(Debug, Subcommand)]
enum What {
    /// Profile and slides in one go, with the machine before a straight seam
    Camera(Box<live::Live>),
    /// Beam to camera, lead and strobe delay, with the machine, from marks of its beams
    Spot(Box<spot::Spot>),
    /// Full well and read noise, from pairs of equal pictures at several levels of light: file,pair
    Noise(Folder),
    /// Width of the sharp band, from a textured plate that the slides step through focus: file,u_mm,v_mm
    Profile(Folder),
    /// How the picture lies to the slides, from a seam at rest while they step there and back: file,place,u_mm,v_mm
    Slides {
        #[command(flatten)]
        folder: Folder,
        #[command(flatten)]
        meets: Meets,
    },
    /// What a closed corner reads beside where it is, from a coupon: file,corner,u_mm,v_mm
    Corner {
        #[command(flatten)]
        folder: Folder,
        #[command(flatten)]
        meets: Meets,
        /// Angles of the coupon's walls left and right against level, in degrees
        #[arg(long, value_parser = two, allow_hyphen_values = true)]
        walls: [f64; 2],
    },
}

/// Pictures in a folder.
#[derive(Debug, Args)]
struct Folder {
    /// Folder of PNG files and calibration.csv, whose columns stand above
    #[arg(long)]
    pictures: PathBuf,
    #[command(flatten)]
    camera: Camera,
}

/// The camera, and where its calibration goes.
#[derive(Debug, Args)]
struct Camera {
    #[command(flatten)]
    which: WhichCamera,
    /// Where the calibration goes (TOML); it may be the one it begins with
    #[arg(short, long)]
    output: PathBuf,
}

/// The camera.
#[derive(Debug, Args)]
struct WhichCamera {
    /// Calibration to begin with; without it the machine file says what the camera is
    #[arg(long)]
    calibration: Option<PathBuf>,
    /// Machine file
    #[arg(long, env = MACHINE_VARIABLE, hide_env = true)]
    machine: Option<PathBuf>,
    /// Side of the camera, 1 or 2
    #[arg(long, value_parser = clap::value_parser!(u8).range(1..=2))]
    side: Option<u8>,
}

/// The offset between beam and camera.
#[derive(Debug, Args)]
struct Meets {
    /// U,V of the slides at which the beam meets the seam in the pictures
    #[arg(long, value_parser = two, allow_hyphen_values = true)]
    meets: Option<[f64; 2]>,
}

/// Two numbers, separated by a comma.
fn two(text: &str) -> Result<[f64; 2], &'static str> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|x| x.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[a, b]) if a.is_finite() && b.is_finite() => Ok([a, b]),
        _ => Err("must be two numbers with a comma between them"),
    }
}

impl Calibrate {
    /// Calibrates, prints the result and writes the file.
    pub fn run(self) -> anyhow::Result<ExitCode> {
        let (camera, found) = match &self.what {
            What::Camera(live) => match live.find()? {
                Ok(found) => (live.camera(), found),
                Err(code) => return Ok(code),
            },
            What::Spot(spot) => return spot.run(),
            What::Noise(folder) => folder.find(|pictures, before| {
                procedure::noise(&read_pictures(pictures, procedure::NOISE)?, before)
            })?,
            What::Profile(folder) => folder.find(|pictures, before| {
                procedure::profile(&read_pictures(pictures, procedure::PROFILE)?, before)
            })?,
            What::Slides { folder, meets } => folder.find(|pictures, before| {
                let listed = read_pictures(pictures, procedure::SLIDES)?.into_iter();
                let listed: Vec<_> = listed.map(ReferencePicture::at_rest).collect();
                procedure::slides(&listed, before, meets.meets)
            })?,
            What::Corner { folder, meets, walls } => folder.find(|pictures, before| {
                let listed = read_pictures(pictures, procedure::CORNER)?;
                let walls = walls.map(|angle| angle.to_radians().tan());
                procedure::corner(&listed, before, walls, meets.meets)
            })?,
        };
        out!("{}", table(&found));
        write_whole(&camera.output, &found.calibration.to_toml())?;
        outln!("{}: written", camera.output.display());
        Ok(ExitCode::SUCCESS)
    }
}

impl Folder {
    fn find(
        &self,
        procedure: impl Fn(&Path, &Calibration) -> Result<CalibrationResult, CalibrateError>,
    ) -> anyhow::Result<(&Camera, CalibrationResult)> {
        let found = procedure(&self.pictures, &self.camera.which.before()?);
        Ok((&self.camera, found.with_context(|| self.camera.not_written())?))
    }
}

impl WhichCamera {
    /// What is known before.
    fn before(&self) -> anyhow::Result<Calibration> {
        if let Some(file) = &self.calibration {
            return Ok(Calibration::read(file)?);
        }
        let (Some(machine), Some(side)) = (&self.machine, self.side) else {
            bail!("which camera was it? give --calibration FILE, or --machine FILE --side 1|2");
        };
        let Some(unit) = MachineFile::read(machine)?.tracking else {
            bail!("machine file {}: it has no cameras", machine.display());
        };
        Ok(unit.cameras.nominal(usize::from(side) - 1))
    }
}

impl Camera {
    fn not_written(&self) -> String {
        format!("{} is not written", self.output.display())
    }
}

/// What was found, a line each.
fn table(found: &CalibrationResult) -> String {
    let mut text = String::new();
    for figure in &found.figures {
        let line = format!("  {:<36} {:<28} {}", figure.text, figure.found, figure.beside);
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Writes a file whole or not at all: beside it first, then in its place.
fn write_whole(file: &Path, text: &str) -> anyhow::Result<()> {
    config::kept::replace(file, text).with_context(|| format!("cannot write {}", file.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_numbers_are_two_numbers() {
        assert_eq!(two("-0.1, 2"), Ok([-0.1, 2.0]));
        for wrong in ["", "1", "1,2,3", "a,2", "1,a,2", "nan,1"] {
            assert!(two(wrong).is_err(), "{wrong}");
        }
    }
}
