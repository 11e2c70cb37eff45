//! The job that finds where a camera looks beside its spot.

use super::{Machine, Outcome, Place, bare, connect, surroundings};
use crate::loaded::Loaded;
use anyhow::{Context, ensure};
use camera::calibrate::spot;
use config::machine::JointForm;
use host_link::spool::Spooling;
use host_link::{Control, Remote};
use job::{Job, MarkRun, Marking, SightingLog, Work};
use std::path::Path;
use std::sync::Arc;
use world::{CameraChoice, Deviation, Workpiece};

/// Length of a simulated plate: more than any machine goes along \[mm\].
const LENGTH_MM: f64 = 100_000.0;

/// Burns the marks, looks back at them, and tells where the camera looks.
pub(super) fn find(
    machine: &Machine,
    loaded: &Loaded,
    marking: Marking,
    place: &Place,
    remote: &Remote,
    mut control: Control,
) -> anyhow::Result<Outcome> {
    let unit = machine
        .is
        .tracking
        .as_ref()
        .context("the machine has no cameras")?;
    ensure!(
        unit.cameras.joint != JointForm::Corner,
        "its cameras look for closed corners, and a mark is a dark line in a plate: have joint = \"gap\" in the machine file for this"
    );
    let folder = machine.file.parent().unwrap_or(Path::new(""));
    let mut calibrations = unit.cameras.calibrations(folder)?;
    let before = calibrations[marking.side];
    // Lead and delay are found anew.
    for calibration in &mut calibrations {
        calibration.spot = None;
    }
    let noted = SightingLog::default();
    let plate = Arc::new(Deviation::none(LENGTH_MM));
    let mut around = surroundings(&machine.is, &machine.file, Some(&plate), place, None)?;
    around.work = Workpiece::BarePlate;
    if let CameraChoice::Images(images, _) = &mut around.cameras {
        images.calibrations = calibrations;
        images.noted = Some((marking.side, noted.clone()));
    }
    let run = MarkRun {
        program: &loaded.program,
        marking,
        noted,
    };
    let job = Job {
        surroundings: around.into(),
        ..bare(&machine.is, Work::Mark(&run), Spooling::default())
    };
    let mut boards = connect(&machine.is, place, remote)?;
    let record = job::run(boards.as_mut(), &job, &mut control)?;
    if let Some(error) = &record.error {
        return Ok(Outcome::failed(error));
    }
    let seen = record.taught.marks.context("no marks were burnt")?;
    let found = spot::spot(&seen.marks, &seen.sightings, seen.lead_mm, &before);
    Ok(Outcome {
        spot: Some((marking.side, found.context("the spot was not found")?)),
        ..Outcome::default()
    })
}
