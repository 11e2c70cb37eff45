//! Jobs that commission a machine: motors are measured, or a circle is made.

use super::{Machine, Outcome, Place, bare, connect, next_folder};
use crate::commissioning::keep;
use anyhow::Context;
use commission::{excitations, softened};
use config::machine::MachineFile;
use host_link::spool::Spooling;
use host_link::{Control, Remote};
use job::{ExcitationRun, PlannedCircle, Work};
use report::write_circle;
use std::path::Path;

/// Measures motors, by their indices. Each that was measured whole is kept, also where a later one could not be.
pub(super) fn measure(
    machine: &Machine,
    motors: &[usize],
    place: &Place,
    remote: &Remote,
    mut control: Control,
) -> anyhow::Result<Outcome> {
    let softened = MachineFile {
        motion: softened(&machine.is.motion),
        ..machine.is.clone()
    };
    let told = |motor: usize| excitations(&machine.is.motion, motor);
    let run = ExcitationRun {
        excitations: motors.iter().flat_map(|motor| told(*motor)).collect(),
    };
    let job = bare(&softened, Work::Excite(&run), Spooling::nothing());
    let mut boards = connect(&softened, place, remote)?;
    let record = job::run(boards.as_mut(), &job, &mut control)?;
    for index in motors {
        let captured = record.taught.captured.iter();
        let own: Vec<_> = captured
            .filter(|captured| usize::from(captured.excitation.motor) == *index)
            .collect();
        if let Some(motor) = &machine.is.motion.motors[*index]
            && own.len() == told(*index).len()
        {
            keep(&machine.file, *index, motor, &own)?;
        }
    }
    Ok(Outcome {
        error: record.error.as_ref().map(ToString::to_string),
        ..Outcome::default()
    })
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
