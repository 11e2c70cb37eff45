//! What calibrations with the machine have alike: the program at whose beginning it stands, and the job on its boards.

use super::super::boards::{BoardArgs, exit_code};
use super::super::{read_program, waits};
use super::coupon::Coupon;
use crate::terminal::Operator;
use anyhow::bail;
use config::machine::MachineFile;
use job::{ImageCameras, Job, Names, Work};
use nc::{Options, Program};
use report::Ended;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use world::{CameraChoice, PictureChoice, Surroundings, Workpiece};

/// A machine before the beginning of a program's weld.
pub struct OnMachine<'a> {
    pub machine: &'a MachineFile,
    /// Its file.
    pub file: &'a Path,
    /// The program.
    pub at: &'a Path,
    pub boards: &'a BoardArgs,
    pub coupon: &'a Coupon,
}

impl OnMachine<'_> {
    /// Reads the program, which must not wait for anybody.
    pub fn program(&self) -> anyhow::Result<Program> {
        let program = read_program(self.at, self.machine, Options::default())?;
        if let Some(waits) = waits::told(&program, 0) {
            bail!(
                "program {} {waits}, which a calibration does not: leave that out",
                self.at.display()
            );
        }
        Ok(program)
    }

    /// Does `work` with cameras that measure in pictures of `source`, before a simulated workpiece of this kind; an exit code if
    /// it was interrupted.
    pub fn run(
        &self,
        work: Work,
        images: ImageCameras,
        source: PictureChoice,
        workpiece: Workpiece,
    ) -> anyhow::Result<Result<Ended, ExitCode>> {
        let seam = self.coupon.deviation(&source)?;
        let name = |path: &Path| path.display().to_string();
        let job = Job {
            machine: self.machine,
            work,
            part: None,
            speed_m_per_min: None,
            from_line: None,
            surroundings: Surroundings {
                seam: seam.map(Arc::new),
                drawing: None,
                cameras: CameraChoice::Images(Box::new(images), source),
                seed: self.coupon.seed,
                truth: self.boards.truth(self.machine)?,
                work: workpiece,
            }
            .into(),
            spooling: Default::default(),
            names: Names {
                program: name(self.at),
                machine: name(self.file),
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
        Ok(Ok(ended))
    }
}
