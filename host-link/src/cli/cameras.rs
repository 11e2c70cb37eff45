//! Which cameras a command uses.

use super::boards::BoardChoice;
use crate::machine::MachineFile;
use crate::weld::{CameraChoice, ImageCameras, PictureSource};
use crate::world::SceneFile;
use anyhow::bail;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};

/// Cameras of a machine that follows seams.
#[derive(Debug, Args)]
pub struct CameraArgs {
    /// What the cameras measure from: rendered pictures of the seams, or geometry without pictures
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Camera::Images)]
    camera: Camera,
    /// What the seams look like in rendered pictures, and what disturbs them (TOML) [default: ground plates]
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
}

/// What cameras measure from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Camera {
    Images,
    Geometric,
}

impl CameraArgs {
    /// Whether a scene is told.
    pub fn scene(&self) -> bool {
        self.scene.is_some()
    }

    /// The cameras of `machine`, whose file is at `path`, on these boards.
    pub fn choose(
        &self,
        machine: &MachineFile,
        path: &Path,
        boards: &BoardChoice,
    ) -> anyhow::Result<CameraChoice> {
        let Some(unit) = &machine.tracking else {
            if self.scene.is_some() {
                bail!("this machine has no cameras: leave --scene out");
            }
            return Ok(CameraChoice::Geometric);
        };
        match (self.camera, boards) {
            (Camera::Geometric, _) if self.scene.is_some() => {
                bail!("--camera geometric has no pictures: leave --scene out, or say --camera images")
            }
            (Camera::Geometric, _) => Ok(CameraChoice::Geometric),
            (Camera::Images, BoardChoice::At { .. }) => bail!(
                "pictures are rendered where the machine is simulated, and no real cameras are configured: say \
                 --camera geometric to try the boards without pictures"
            ),
            (Camera::Images, BoardChoice::Emulated | BoardChoice::Simulated) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                let scene = self.scene.as_deref().map(SceneFile::read).transpose()?;
                Ok(CameraChoice::Images(Box::new(ImageCameras {
                    calibrations: unit.cameras.calibrations(folder)?,
                    source: PictureSource::Rendered(scene.unwrap_or_default()),
                    kept: None,
                })))
            }
        }
    }
}
