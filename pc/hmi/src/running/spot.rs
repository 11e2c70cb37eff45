//! The job that finds where a camera looks beside its spot.

use super::{Machine, Outcome, Place, bare, connect, surroundings};
use crate::loaded::Loaded;
use anyhow::{Context, ensure};
use camera::calibrate::spot;
use camera::calibrate::spot::SpotResult;
use config::machine::JointForm;
use host_link::spool::Spooling;
use host_link::{Control, Remote};
use job::{Job, MarkRun, Marking, SightingLog, Work};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use world::{CameraChoice, Deviation, Workpiece};

/// Where a camera was found to look.
#[derive(Clone, Debug)]
pub struct FoundSpot {
    /// The camera, 0 or 1.
    pub side: usize,
    /// What was found.
    pub result: SpotResult,
    /// The file of its calibration.
    pub file: PathBuf,
    /// Whether the machine file names it.
    pub is_named: bool,
}

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
    let calibrations = unit.cameras.calibrations(folder)?;
    let noted = SightingLog::default();
    let plate = Arc::new(Deviation::straight());
    let mut around = surroundings(&machine.is, &machine.file, Some(&plate), place, None)?;
    around.work = Workpiece::BarePlate;
    if let CameraChoice::Images(images, _) = &mut around.cameras {
        **images = marking.cameras(calibrations, &noted);
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
    let side = marking.side;
    let found = spot::spot(&seen.marks, &seen.sightings, seen.lead_mm, &calibrations[side]);
    let named = unit.cameras.calibration.as_ref().map(|files| files[side].clone());
    let is_named = named.is_some();
    let name = named.unwrap_or_else(|| format!("camera-{}.toml", side + 1).into());
    Ok(Outcome {
        spot: Some(FoundSpot {
            side,
            result: found.context("the spot was not found")?,
            file: folder.join(name),
            is_named,
        }),
        ..Outcome::default()
    })
}
