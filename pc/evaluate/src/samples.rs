//! The machine tick by tick, as judges of parts look at it.

use crate::on_paths;
use cam::path::PlannedPath;
use host_link::geometry::MachineGeometry;
use host_link::record::{MachinePosition, Recorded};
use shared::geometry::Pose;
use shared::io::{AXES, SIDES};
use std::collections::BTreeMap;
use std::fmt;

/// The machine at one tick of the motion board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunSample {
    /// Time on the motion board's clock \[µs\].
    pub time_us: u64,
    /// Number of the path.
    pub path_id: u32,
    /// Programmed position on it \[mm\].
    pub s_mm: f64,
    /// Programmed speed along it \[mm/s\].
    pub speed_mm_s: f64,
    /// Gates that are open.
    pub beams: [bool; SIDES],
    /// Where the axes truly stood (mm, rad); by the gratings on a real machine.
    pub axes: [f64; AXES],
    /// Where the tool truly was, in the frame of the work.
    pub pose: Pose,
}

/// Every tick of a run, in order of time. They may be millions: whoever looks keeps no more of them than it has to.
pub trait RunSamples: fmt::Debug {
    /// Goes through all of them, as often as this is called.
    fn iter(&self) -> Box<dyn Iterator<Item = RunSample> + '_>;
}

impl RunSamples for Vec<RunSample> {
    fn iter(&self) -> Box<dyn Iterator<Item = RunSample> + '_> {
        Box::new(self.as_slice().iter().copied())
    }
}

/// The ticks of a record that are on one of some paths.
#[derive(Clone, Copy, Debug)]
pub struct RecordedRun<'a> {
    /// What the boards told.
    pub record: &'a Recorded,
    /// The machine.
    pub machine: &'a MachineGeometry,
    /// What was run, by path number.
    pub paths: &'a BTreeMap<u32, PlannedPath>,
}

impl RunSamples for RecordedRun<'_> {
    fn iter(&self) -> Box<dyn Iterator<Item = RunSample> + '_> {
        let on_these = on_paths(self.record).filter(|sample| self.paths.contains_key(&sample.path_id));
        Box::new(on_these.map(|sample| {
            let axes = self.machine.axes(&MachinePosition::of(&sample));
            RunSample {
                time_us: sample.time_us,
                path_id: sample.path_id,
                s_mm: sample.s_mm,
                speed_mm_s: sample.speed_mm_s,
                beams: sample.beams,
                axes,
                pose: self.machine.tool(&axes),
            }
        }))
    }
}
