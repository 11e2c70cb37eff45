//! Jobs that commission a machine: motors are measured, or a circle is made.

use super::{Machine, Outcome, Place, bare, connect, next_folder};
use crate::commissioning::keep;
use anyhow::Context;
use commission::{CapturedMotion, excitations, softened, swinging};
use config::machine::MachineFile;
use host_link::spool::Spooling;
use host_link::{Control, Remote};
use job::{ExcitationRun, JobError, PlannedCircle, Work};
use report::write_circle;
use shared::config::MotionConfig;
use std::path::Path;

/// Measures motors, by their indices; those that swing by themselves again, in slower loops. Each that was measured whole is kept,
/// also where a later one could not be.
pub(super) fn measure(
    machine: &Machine,
    motors: &[usize],
    place: &Place,
    remote: &Remote,
    mut control: Control,
) -> anyhow::Result<Outcome> {
    let soft = softened(&machine.is.motion);
    let mut excite = |motion: MotionConfig, motors: &[usize]| {
        let softened = MachineFile {
            motion,
            ..machine.is.clone()
        };
        let told = motors.iter().map(|motor| excitations(&machine.is.motion, *motor));
        let run = ExcitationRun {
            excitations: told.flatten().collect(),
        };
        let job = bare(&softened, Work::Excite(&run), Spooling::nothing());
        let mut boards = connect(&softened, place, remote)?;
        let record = job::run(boards.as_mut(), &job, &mut control)?;
        keep_whole(machine, motors, &record.taught.captured)?;
        anyhow::Ok((record.error, record.taught.captured))
    };
    let (mut error, captured) = excite(soft.clone(), motors)?;
    let again = swinging(&machine.is.motion, motors, &captured);
    if error.is_none() && !again.is_empty() {
        (error, _) = excite(softened(&soft), &again)?;
    }
    Ok(Outcome {
        error: error.as_ref().map(JobError::to_string),
        ..Outcome::default()
    })
}

/// Keeps what was captured of those motors that were measured whole.
fn keep_whole(machine: &Machine, motors: &[usize], captured: &[CapturedMotion]) -> anyhow::Result<()> {
    for index in motors {
        let own: Vec<_> = captured
            .iter()
            .filter(|captured| usize::from(captured.excitation.motor) == *index)
            .collect();
        if let Some(motor) = &machine.is.motion.motors[*index]
            && own.len() == excitations(&machine.is.motion, *index).len()
        {
            keep(&machine.file, *index, motor, &own)?;
        }
    }
    Ok(())
}

/// Goes round, and draws that into a folder of its own among the reports.
pub(super) fn circle(
    machine: &Machine,
    circle: &PlannedCircle,
    place: &Place,
    remote: &Remote,
    mut control: Control,
) -> anyhow::Result<Outcome> {
    let job = bare(&machine.is, Work::Program(&circle.program), Spooling::default());
    let mut boards = connect(&machine.is, place, remote)?;
    let record = job::run(boards.as_mut(), &job, &mut control)?;
    if let Some(error) = &record.error {
        return Ok(Outcome::failed(error));
    }
    let seen = circle.seen(&record.machine, &record.record)?;
    let folder = next_folder(&place.reports, Path::new("circular-test"))?;
    let title = format!("{}: {}", circle.test, machine.file.display());
    write_circle(&folder.join("circle.svg"), &title, &seen.turns)
        .with_context(|| format!("the circle is not drawn in {}", folder.display()))?;
    Ok(Outcome {
        circle: Some((circle.test, seen)),
        folder: Some(folder),
        ..Outcome::default()
    })
}
