//! Jobs in which the cameras are taught seams.

use super::{Machine, Outcome, Place, bare, connect, surroundings};
use host_link::spool::Spooling;
use host_link::{Control, Remote};
use job::{Job, SeamLesson, Work};
use nc::Program;
use std::sync::Arc;
use world::{Deviation, Workpiece};

/// What such a job needs.
#[derive(Debug)]
pub struct Lesson {
    /// The machine.
    pub machine: Arc<Machine>,
    /// What is to be taught.
    pub lesson: SeamLesson,
    /// The program of the drawing, where there is one, and how simulated seams deviate from it.
    pub drawn: Option<Arc<Program>>,
    /// See [`Self::drawn`].
    pub seam: Option<Arc<Deviation>>,
}

/// Homes, and teaches the seams; each point is on the disk at once.
pub(super) fn teach(
    lesson: &Lesson,
    place: &Place,
    remote: &Remote,
    mut control: Control,
) -> anyhow::Result<Outcome> {
    let machine = &lesson.machine;
    let mut around = surroundings(&machine.is, &machine.file, lesson.seam.as_ref(), place, None)?;
    around.drawing.clone_from(&lesson.drawn);
    around.work = Workpiece::Seams;
    let job = Job {
        surroundings: around.into(),
        ..bare(&machine.is, Work::TeachSeam(&lesson.lesson), Spooling::nothing())
    };
    let mut boards = connect(&machine.is, place, remote)?;
    let record = job::run(boards.as_mut(), &job, &mut control)?;
    let lost = record.taught.seam.as_ref().and_then(|taught| taught.told().err());
    Ok(Outcome {
        error: record.error.or(lost).map(|error| error.to_string()),
        taught: record.taught.seam,
        ..Outcome::default()
    })
}
