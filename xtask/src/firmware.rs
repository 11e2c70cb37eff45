//! Builds the firmwares, the pace plugin and the PC's program.

use crate::cargo::{self, cargo, run_command, target_directory};
use anyhow::{Context, Result};
use clap::ValueEnum;
use emulator::PROGRAM_VARIABLES;
use std::env;
use std::fmt;
use std::fs;
use std::path::PathBuf;

/// The boards' processor.
pub const TARGET: &str = "thumbv7em-none-eabihf";
/// How firmware is optimised.
pub const PROFILE: &str = "firmware";

/// The two firmwares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Firmware {
    /// Motion board.
    Motion,
    /// Tracker board.
    Tracker,
}

/// The boards they are built for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Board {
    /// Emulated.
    Mps2An500,
    /// Real.
    NucleoH723zg,
}

impl Firmware {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Motion, Self::Tracker];

    /// Name of the package.
    pub fn package(self) -> &'static str {
        match self {
            Self::Motion => "firmware-motion",
            Self::Tracker => "firmware-tracker",
        }
    }
}

impl Board {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Mps2An500, Self::NucleoH723zg];
}

impl fmt::Display for Board {
    /// Also the name of the feature that selects it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mps2An500 => "mps2-an500",
            Self::NucleoH723zg => "nucleo-h723zg",
        })
    }
}

/// Builds firmwares for a board, beside each other; returns the images. Both boards' images have the same name in the
/// target folder, so each is kept under a name of its own.
pub fn build<const N: usize>(firmwares: [Firmware; N], board: Board) -> Result<[PathBuf; N]> {
    let board = board.to_string();
    let mut command = cargo(&["build", "--quiet", "--target", TARGET, "--profile", PROFILE])?;
    command.args(["--features", &board]);
    for firmware in firmwares {
        command.args(["--package", firmware.package()]);
    }
    if env::var_os("DEFMT_LOG").is_none() {
        command.env("DEFMT_LOG", "info");
    }
    let what = format!(
        "building {} for {board}",
        firmwares.map(Firmware::package).join(" and ")
    );
    eprintln!("{what}");
    run_command(command, &what)?;

    let target = target_directory()?;
    let images = target.join("images");
    fs::create_dir_all(&images).with_context(|| format!("cannot make {}", images.display()))?;
    let image = |firmware: Firmware| images.join(format!("{}-{board}", firmware.package()));
    for firmware in firmwares {
        let built = target.join(TARGET).join(PROFILE).join(firmware.package());
        let image = image(firmware);
        fs::copy(&built, &image)
            .with_context(|| format!("cannot copy {} to {}", built.display(), image.display()))?;
    }
    Ok(firmwares.map(image))
}

/// Builds the plugin that keeps emulated boards on the wall clock; returns the library.
pub fn build_pace() -> Result<PathBuf> {
    eprintln!("building the pace plugin");
    cargo::run(&["build", "--quiet", "--package", "seamwright-pace", "--release"])?;
    Ok(target_directory()?.join("release").join("libpace.so"))
}

/// Builds the PC's program, unless a test names one that is built; returns it.
pub fn build_seamwright() -> Result<PathBuf> {
    if let Some(built) = env::var_os(PROGRAM_VARIABLES[0]) {
        return Ok(built.into());
    }
    eprintln!("building seamwright");
    cargo::run(&["build", "--quiet", "--package", "seamwright", "--release"])?;
    Ok(target_directory()?.join("release").join("seamwright"))
}
