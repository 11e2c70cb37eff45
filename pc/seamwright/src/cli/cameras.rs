//! Which cameras a command uses.

use crate::console::{errln, outln};
use anyhow::bail;
use camera::{CameraError, PictureQueue, PictureWriter};
use clap::{Args, ValueEnum};
use config::machine::{CameraConfig, MachineFile};
use job::ImageCameras;
use std::path::{Path, PathBuf};
use world::{BoardChoice, CameraChoice, PictureChoice, SceneFile};

/// Cameras of a machine that follows seams.
#[derive(Debug, Args)]
pub struct CameraArgs {
    /// What the cameras measure from: pictures (of real cameras on real boards, else rendered), or geometry without pictures
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Camera::Images)]
    camera: Camera,
    /// What the seams look like in rendered pictures, and what disturbs them (TOML) [default: ground plates]
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Keep every picture: a folder of PNG files for each side, and when they were taken
    #[arg(long, value_name = "DIR")]
    keep_pictures: Option<PathBuf>,
}

/// What cameras measure from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Camera {
    Images,
    Geometric,
}

impl CameraArgs {
    /// Whether they measure in pictures.
    pub fn pictures(&self) -> bool {
        self.camera == Camera::Images
    }

    /// The first option that has no meaning without pictures, if one is given.
    pub fn of_pictures(&self) -> Option<&'static str> {
        let told = [
            (self.scene.is_some(), "--scene"),
            (self.keep_pictures.is_some(), "--keep-pictures"),
        ];
        told.into_iter().find_map(|(told, name)| told.then_some(name))
    }

    /// The cameras of `machine`, whose file is at `path`, on these boards.
    pub fn choose(
        &self,
        machine: &MachineFile,
        path: &Path,
        boards: &BoardChoice,
    ) -> anyhow::Result<CameraChoice> {
        let Some(unit) = &machine.tracking else {
            if let Some(told) = self.of_pictures() {
                bail!("this machine has no cameras: omit {told}");
            }
            return Ok(CameraChoice::Geometric);
        };
        match (self.camera, self.of_pictures()) {
            (Camera::Geometric, Some(told)) => {
                bail!("--camera geometric has no pictures: omit {told}, or use --camera images")
            }
            (Camera::Geometric, None) => Ok(CameraChoice::Geometric),
            (Camera::Images, _) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                // The time of simulated boards stands still meanwhile.
                let queue = || match boards {
                    BoardChoice::Simulated => PictureQueue::blocking(),
                    BoardChoice::Emulated | BoardChoice::At { .. } => PictureQueue::default(),
                };
                let kept = self.keep_pictures.is_some().then(|| [queue(), queue()]);
                let images = ImageCameras {
                    calibrations: unit.cameras.calibrations(folder)?,
                    kept,
                    noted: None,
                    shown_every: None,
                };
                let source = source(boards, &unit.cameras, self.scene.as_deref())?;
                Ok(CameraChoice::Images(Box::new(images), source))
            }
        }
    }

    /// Begins to keep the pictures of `cameras`, where that is asked for.
    pub fn keep(&self, cameras: &CameraChoice) -> Result<PictureWriters, CameraError> {
        let (Some(folder), CameraChoice::Images(images, _)) = (&self.keep_pictures, cameras) else {
            return Ok(PictureWriters::default());
        };
        let mut writers = Vec::new();
        for (side, queue) in (1..).zip(images.kept.iter().flatten()) {
            let folder = folder.join(format!("side-{side}"));
            writers.push((PictureWriter::start(&folder, queue.clone())?, folder));
        }
        Ok(PictureWriters(writers))
    }
}

/// What keeps the pictures of both sides, and where.
#[derive(Default)]
pub struct PictureWriters(Vec<(PictureWriter, PathBuf)>);

impl PictureWriters {
    /// Waits until all queued pictures are written, and prints the result.
    pub fn end(self) {
        for (writer, folder) in self.0 {
            let kept = writer.end();
            let dropped = match (kept.dropped, &kept.error) {
                (0, _) => String::new(),
                (dropped, Some(_)) => format!(", {dropped} dropped"),
                (dropped, None) => format!(", {dropped} dropped: writing them was too slow"),
            };
            outln!(
                "  {} pictures kept in {}{dropped}",
                kept.pictures,
                folder.display()
            );
            if let Some(error) = kept.error {
                errln!("seamwright: {error}");
            }
        }
    }
}

/// Where pictures come from: from real cameras beside boards in the network, else rendered of the simulated machine.
pub fn source(
    boards: &BoardChoice,
    cameras: &CameraConfig,
    scene: Option<&Path>,
) -> anyhow::Result<PictureChoice> {
    match (boards, scene) {
        (BoardChoice::At { .. }, Some(_)) => {
            bail!("a scene is for rendered pictures only: omit --scene with real cameras")
        }
        (BoardChoice::At { .. }, None) => Ok(PictureChoice::Real(camera::real(cameras)?)),
        (BoardChoice::Emulated | BoardChoice::Simulated, scene) => {
            let scene = scene.map(SceneFile::read).transpose()?;
            Ok(PictureChoice::Rendered(Box::new(scene.unwrap_or_default())))
        }
    }
}
