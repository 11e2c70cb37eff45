//! `seamwright calibrate camera`: with the machine.

use super::super::boards::{BoardArgs, exit_code};
use super::super::cameras::source;
use super::super::{read_program, waits};
use super::coupon::Coupon;
use super::{Camera, Meets};
use crate::terminal::Operator;
use anyhow::{Context, bail};
use camera::PictureQueue;
use camera::calibrate::procedure;
use camera::calibrate::procedure::CalibrationResult;
use clap::Args;
use config::machine::{JointForm, MachineFile};
use job::{ImageCameras, Job, Names, PictureRun, Work};
use nc::Options;
use shared::io::SIDES;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use world::{CameraChoice, PictureChoice, Surroundings, Workpiece};

/// The machine homes, goes to where PROGRAM begins to weld and looks at the seam before it, with the beams off: a straight
/// gap along travel, level, in sight of the camera. Its slides step through focus, then there and back at every place along
/// it. With --calibration the camera is what that file says, else what the machine file says.
#[derive(Debug, Args)]
pub struct Live {
    #[command(flatten)]
    camera: Camera,
    #[command(flatten)]
    meets: Meets,
    /// Program that begins to weld where the seam is
    #[arg(long, value_name = "PROGRAM")]
    at: PathBuf,
    /// Places along the seam; more of them even out its texture
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=9))]
    places: u32,
    #[command(flatten)]
    boards: BoardArgs,
    #[command(flatten)]
    coupon: Coupon,
}

impl Live {
    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Takes the pictures and calibrates from them; an exit code if it was interrupted.
    pub fn find(&self) -> anyhow::Result<Result<CalibrationResult, ExitCode>> {
        let (Some(machine_file), Some(side)) = (&self.camera.which.machine, self.camera.which.side) else {
            bail!("which camera? give --machine FILE --side 1|2");
        };
        let machine = MachineFile::read(machine_file)?;
        self.boards.check(&machine)?;
        let Some(unit) = &machine.tracking else {
            bail!("machine file {}: it has no cameras", machine_file.display());
        };
        let cameras = &unit.cameras;
        let before = self.camera.which.before()?;
        let mut calibrations = cameras.calibrations(machine_file.parent().unwrap_or(Path::new("")))?;
        let side = usize::from(side) - 1;
        calibrations[side] = before;
        let source = source(&self.boards.choice, cameras, self.coupon.scene.as_deref())?;
        if let (PictureChoice::Rendered(_), JointForm::Corner) = (&source, cameras.joint) {
            bail!(
                "machine file {}: its simulated seams are closed corners, and a coupon is a gap; calibrate a machine with \
                 joint = \"gap\" here, or the real camera",
                machine_file.display()
            );
        }
        let program = read_program(&self.at, &machine, Options::default())?;
        if let Some(waits) = waits::told(&program, 0) {
            bail!(
                "program {} {waits}, which a calibration does not: leave that out",
                self.at.display()
            );
        }
        let seam = self.coupon.deviation(&source)?;
        let queues = <[PictureQueue; SIDES]>::default();
        let picture_run = PictureRun {
            program: &program,
            side,
            before,
            places: self.places,
            queue: queues[side].clone(),
        };
        let images = ImageCameras {
            calibrations,
            kept: Some(queues),
            noted: None,
        };
        let name = |path: &Path| path.display().to_string();
        let job = Job {
            machine: &machine,
            work: Work::Pictures(&picture_run),
            part: None,
            speed_m_per_min: None,
            from_line: None,
            surroundings: Surroundings {
                seam: seam.map(Arc::new),
                drawing: None,
                cameras: CameraChoice::Images(Box::new(images), source),
                seed: self.coupon.seed,
                mounts: self.boards.mounts(&machine)?,
                work: Workpiece::Seams,
            }
            .into(),
            spooling: Default::default(),
            names: Names {
                program: name(&self.at),
                machine: name(machine_file),
                seam: self.coupon.seam.as_deref().map(name),
                boards: self.boards.name(),
            },
        };
        let ended = match self.boards.run(&job, Operator::LooksOn, None)? {
            Ok(ended) => ended,
            Err(code) => return Ok(Err(code)),
        };
        if ended.error.is_some() {
            return exit_code(ended.error).map(Err);
        }
        let pictures = &ended.taught.pictures;
        let not_written = || self.camera.not_written();
        let profile = procedure::profile(&pictures.profile, &before).with_context(not_written)?;
        let slides = procedure::slides(&pictures.slides, &profile.calibration, self.meets.meets)
            .with_context(not_written)?;
        Ok(Ok(CalibrationResult {
            calibration: slides.calibration,
            figures: [profile.figures, slides.figures].concat(),
        }))
    }
}
