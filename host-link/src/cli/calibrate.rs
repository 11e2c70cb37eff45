//! `host-link calibrate`: what a camera is, from pictures of which something is known.

use crate::calibration::procedure::{self, Found};
use crate::calibration::{CalibrateError, Calibration, PICTURES, read_pictures};
use crate::machine::MachineFile;
use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Calibrate a camera from pictures in a folder
///
/// The folder holds PNG files and calibration.csv, a row for each of them: file,pair of noise; file,u_mm,v_mm of profile;
/// file,place,u_mm,v_mm of slides; file,corner,u_mm,v_mm of corner (U and V are the slides). What was found is told beside
/// what was believed before. A poor fit is refused with the reason, and the file is then left as it was.
#[derive(Debug, Args)]
pub struct Calibrate {
    /// What to find
    #[arg(value_enum)]
    what: What,
    /// Folder of the pictures
    #[arg(long)]
    pictures: PathBuf,
    /// Calibration to begin with; without it the machine file says what the camera is
    #[arg(long, conflicts_with_all = ["machine", "side"])]
    calibration: Option<PathBuf>,
    /// Machine file
    #[arg(long, requires = "side")]
    machine: Option<PathBuf>,
    /// Side of the camera, 1 or 2
    #[arg(long, requires = "machine", value_parser = clap::value_parser!(u8).range(1..=2))]
    side: Option<u8>,
    /// Where the calibration goes (TOML); it may be the one it begins with
    #[arg(short, long)]
    output: PathBuf,
    /// U,V of the slides at which the beam meets the seam in the pictures (slides, corner)
    #[arg(long, value_parser = two, allow_hyphen_values = true)]
    meets: Option<[f64; 2]>,
    /// Angles of the walls left and right of a coupon's corner against level, in degrees (corner)
    #[arg(long, value_parser = two, allow_hyphen_values = true, required_if_eq("what", "corner"))]
    walls: Option<[f64; 2]>,
}

/// What to find.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum What {
    /// Full well and read noise, from pairs of equal pictures at several levels of light
    Noise,
    /// Width of the sharp band, from a textured plate that the slides stepped through focus
    Profile,
    /// How the picture lies to the slides, from a seam at rest while the slides step there and back
    Slides,
    /// What a closed corner reads beside where it is, from a coupon
    Corner,
}

/// Two numbers, separated by a comma.
fn two(text: &str) -> Result<[f64; 2], &'static str> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|x| x.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[a, b]) if a.is_finite() && b.is_finite() => Ok([a, b]),
        _ => Err("say two numbers with a comma between them"),
    }
}

impl Calibrate {
    /// Finds it, tells it and writes the file.
    pub fn run(self) -> anyhow::Result<()> {
        if self.meets.is_some() && !matches!(self.what, What::Slides | What::Corner) {
            bail!("--meets belongs to slides and corner");
        }
        if self.walls.is_some() && self.what != What::Corner {
            bail!("--walls belongs to corner");
        }
        let before = self.before()?;
        let folder = self.pictures.as_path();
        let found = self.find(folder, &before);
        let found = found.with_context(|| format!("{} is not written", self.output.display()))?;
        print!("{}", table(&found));
        write_whole(&self.output, &found.calibration.to_toml())?;
        println!(
            "{}: written from {}",
            self.output.display(),
            folder.join(PICTURES).display()
        );
        Ok(())
    }

    fn find(&self, folder: &Path, before: &Calibration) -> Result<Found, CalibrateError> {
        match self.what {
            What::Noise => procedure::noise(&read_pictures(folder, procedure::NOISE)?, before),
            What::Profile => procedure::profile(&read_pictures(folder, procedure::PROFILE)?, before),
            What::Slides => {
                let listed = read_pictures(folder, procedure::SLIDES)?;
                procedure::slides(&listed, before, self.meets)
            }
            What::Corner => {
                let walls = self
                    .walls
                    .unwrap_or_default()
                    .map(|angle| angle.to_radians().tan());
                let listed = read_pictures(folder, procedure::CORNER)?;
                procedure::corner(&listed, before, walls, self.meets)
            }
        }
    }

    /// What is known before.
    fn before(&self) -> anyhow::Result<Calibration> {
        if let Some(file) = &self.calibration {
            return Ok(Calibration::read(file)?);
        }
        let (Some(machine), Some(side)) = (&self.machine, self.side) else {
            bail!("say what the camera was: --calibration FILE, or --machine FILE --side 1|2");
        };
        let Some(unit) = MachineFile::read(machine)?.tracking else {
            bail!("machine file {}: it has no cameras", machine.display());
        };
        Ok(unit.cameras.nominal(usize::from(side) - 1))
    }
}

/// What was found, a line each.
fn table(found: &Found) -> String {
    let mut text = String::new();
    for figure in &found.figures {
        let line = format!("  {:<36} {:<28} {}", figure.text, figure.found, figure.beside);
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Writes a file whole or not at all: beside it first, then in its place.
fn write_whole(file: &Path, text: &str) -> anyhow::Result<()> {
    let mut beside = file.as_os_str().to_owned();
    beside.push(".new");
    let beside = PathBuf::from(beside);
    std::fs::write(&beside, text).with_context(|| format!("cannot write {}", beside.display()))?;
    std::fs::rename(&beside, file).with_context(|| format!("cannot write {}", file.display()))
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
