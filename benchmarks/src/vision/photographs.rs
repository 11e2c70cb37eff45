//! What is believed in photographs of anything but a seam.

use super::seeds::of_seeds;
use super::{NOISE, camera};
use anyhow::{Context, Result, bail, ensure};
use image::imageops::{self, FilterType};
use std::path::{Path, PathBuf};
use vision::render::SplitMix64;
use vision::{Detector, Image, Joint, Optics, Prior, Profile};

/// How much smaller a piece of a photograph may become: photographs are less sharp than pictures of the camera.
const SMALLER: [f64; 2] = [1.0, 4.0];

/// What is looked at.
pub struct Options {
    folder: PathBuf,
    pieces: u64,
    seed: u64,
}

/// A piece of a photograph.
struct Piece {
    photograph: u64,
    /// Column and row of its corner.
    place: [u32; 2],
    smaller: f64,
    /// Quality and width \[mm\] of the seam that was believed in it.
    believed: Option<[f64; 2]>,
}

impl Options {
    /// Understands `FOLDER PIECES [--seed SEED]`.
    pub fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self> {
        let folder = arguments.next().context("which folder of photographs?")?.into();
        let pieces = arguments.next().context("how many pieces of them?")?;
        let mut options = Self {
            folder,
            pieces: pieces.parse().context("how many pieces of them?")?,
            seed: 0,
        };
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--seed" => options.seed = arguments.next().context("which seed?")?.parse()?,
                other => bail!("there is no option {other}; there is --seed"),
            }
        }
        Ok(options)
    }
}

/// Measures pieces of the photographs in a folder and the folders in it, cut out at random and made smaller at random, about as
/// many of each, and prints in which of them a seam was believed.
pub fn run(options: &Options) -> Result<()> {
    let mut photographs = Vec::new();
    collect(&options.folder, &mut photographs)?;
    photographs.sort();
    ensure!(
        !photographs.is_empty(),
        "there is no .jpg, .jpeg or .png in {}",
        options.folder.display()
    );
    let optics = camera(400);
    let count = photographs.len() as u64;
    let share = options.pieces.div_ceil(count);
    let pieces = of_seeds("photographs", count, |number| {
        in_photograph(
            &photographs[number as usize],
            number,
            &optics,
            share,
            options.seed,
        )
    })?;
    let believed = pieces.iter().filter(|piece| piece.believed.is_some()).count();
    println!(
        "{} pieces of {count} photographs: a seam believed in {believed}",
        pieces.len()
    );
    for piece in &pieces {
        let Some([quality, width_mm]) = piece.believed else {
            continue;
        };
        let [x, y] = piece.place;
        println!(
            "{} at {x}, {y}, {:.2} times smaller: quality {quality:.2}, width {width_mm:.3} mm",
            photographs[piece.photograph as usize].display(),
            piece.smaller
        );
    }
    Ok(())
}

fn collect(folder: &Path, photographs: &mut Vec<PathBuf>) -> Result<()> {
    let entries = folder
        .read_dir()
        .with_context(|| format!("cannot read {}", folder.display()))?;
    for entry in entries {
        let path = entry?.path();
        let extension = path.extension().and_then(|extension| extension.to_str());
        if path.is_dir() {
            collect(&path, photographs)?;
        } else if matches!(extension, Some("jpg" | "jpeg" | "png")) {
            photographs.push(path);
        }
    }
    Ok(())
}

/// Measures some pieces of a photograph; none of one that is smaller than a picture of the camera.
fn in_photograph(path: &Path, number: u64, optics: &Optics, pieces: u64, seed: u64) -> Result<Vec<Piece>> {
    let photograph = image::open(path)
        .with_context(|| format!("cannot read {}", path.display()))?
        .into_luma8();
    let [columns, rows] = [optics.columns, optics.rows].map(|size| size as u32);
    let (width, height) = photograph.dimensions();
    let most = (f64::from(width) / f64::from(columns)).min(f64::from(height) / f64::from(rows));
    if most < SMALLER[0] {
        eprintln!("{} is too small: left out", path.display());
        return Ok(Vec::new());
    }
    let mut detector = Detector::new(*optics, NOISE, Profile::expected(optics))?;
    let prior = Prior {
        joint: Joint::Gap,
        track: None,
        focus: 0.0,
    };
    let mut random = SplitMix64::new(seed + number);
    let mut all = Vec::new();
    for _ in 0..pieces {
        let smaller = random.between(SMALLER[0], SMALLER[1].min(most));
        let size = [columns, rows].map(|size| (f64::from(size) * smaller) as u32);
        let mut start = |length: u32, part: u32| (random.uniform() * f64::from(length - part + 1)) as u32;
        let place = [start(width, size[0]), start(height, size[1])];
        let piece = imageops::crop_imm(&photograph, place[0], place[1], size[0], size[1]).to_image();
        let piece = imageops::resize(&piece, columns, rows, FilterType::Triangle);
        let report = detector.measure(&Image::new(piece.as_raw(), optics.rows, optics.columns)?, &prior)?;
        all.push(Piece {
            photograph: number,
            place,
            smaller,
            believed: report.seam().map(|seam| [seam.quality, seam.width_mm]),
        });
    }
    Ok(all)
}
