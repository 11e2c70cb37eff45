//! `seamwright calibrate camera`: with the machine.

use super::super::boards::BoardArgs;
use super::super::cameras::source;
use super::coupon::Coupon;
use super::on_machine::OnMachine;
use super::{Camera, Meets};
use anyhow::{Context, bail};
use camera::PictureQueue;
use camera::calibrate::procedure;
use camera::calibrate::procedure::CalibrationResult;
use clap::Args;
use config::machine::{JointForm, MachineFile};
use job::{ImageCameras, PictureRun, Work};
use shared::io::SIDES;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use world::{PictureChoice, Workpiece};

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
        let on_machine = OnMachine {
            machine: &machine,
            file: machine_file,
            at: &self.at,
            boards: &self.boards,
            coupon: &self.coupon,
        };
        let program = on_machine.program()?;
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
            shown_every: None,
        };
        let work = Work::Pictures(&picture_run);
        let ended = match on_machine.run(work, images, source, Workpiece::Seams)? {
            Ok(ended) => ended,
            Err(code) => return Ok(Err(code)),
        };
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
