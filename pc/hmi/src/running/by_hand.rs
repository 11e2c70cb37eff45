//! The machine operated by hand, with its cameras.

use super::{Machine, Outcome, Place, bare, connect, surroundings};
use crate::loaded::Loaded;
use config::sentence;
use host_link::events::Event;
use host_link::spool::Spooling;
use host_link::{Control, Remote};
use job::{Job, JobError, Work};
use std::sync::Arc;
use std::time::Duration;
use world::Surroundings;

/// A picture of each camera is shown so often: what an eye follows, and little work for this computer.
const SHOWN_EVERY: Duration = Duration::from_millis(100);

/// Nothing is recorded, however long it lasts. Where the cameras cannot be had it is told, and done without them.
pub(super) fn run(
    machine: &Machine,
    loaded: Option<&Loaded>,
    place: &Place,
    remote: &Remote,
    mut control: Control,
) -> anyhow::Result<Outcome> {
    let with_cameras = around(machine, loaded, place).unwrap_or_else(|error| {
        blind(&control, &sentence(error.as_ref()));
        Surroundings::default()
    });
    let job = |around: Surroundings| Job {
        surroundings: around.into(),
        ..bare(&machine.is, Work::ByHand, Spooling::nothing())
    };
    let mut boards = connect(&machine.is, place, remote)?;
    let record = match job::run(boards.as_mut(), &job(with_cameras), &mut control) {
        // They are opened before anything moves.
        Err(JobError::Camera(error)) => {
            blind(&control, &sentence(&error));
            job::run(boards.as_mut(), &job(Surroundings::default()), &mut control)
        }
        run => run,
    }?;
    Ok(Outcome {
        error: record.error.as_ref().map(ToString::to_string),
        ..Outcome::default()
    })
}

/// What is around the machine. On a simulated one the seams are where the program that is loaded has them.
fn around(machine: &Machine, loaded: Option<&Loaded>, place: &Place) -> anyhow::Result<Surroundings> {
    let loaded = loaded.filter(|_| machine.is.tracking.is_some());
    let seam = loaded.and_then(|loaded| loaded.seam.as_ref());
    let seam = seam.map(|(_, seam)| seam);
    let mut around = surroundings(&machine.is, &machine.file, seam, place, Some(SHOWN_EVERY))?;
    if around.seam.is_some() {
        around.drawing = loaded.map(|loaded| Arc::clone(&loaded.program));
    }
    Ok(around)
}

fn blind(control: &Control, why: &str) {
    control.publish(Event::Message(format!("no pictures by hand: {why}")));
}
