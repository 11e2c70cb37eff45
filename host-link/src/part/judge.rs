//! What a run is judged by, and what comes of it.

use crate::machine::MachineFile;
use crate::path::PlannedPath;
use serde::Serialize;
use shared::geometry::Pose;
use shared::io::{AXES, SIDES};
use shared::kinematics::Kinematics;
use std::collections::BTreeMap;

/// A run, as it truly was.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// The machine.
    pub machine: &'a MachineFile,
    /// Its kinematics.
    pub kinematics: &'a Kinematics,
    /// What was run, by path number.
    pub paths: &'a BTreeMap<u32, PlannedPath>,
    /// Every tick of the motion board on a path, in order of time.
    pub samples: &'a [RunSample],
}

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

/// What a run was worth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// Figures for table and report.
    pub figures: Vec<Figure>,
    /// Plots for the report.
    pub plots: Vec<Plot>,
}

/// A figure of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Key in the report, unit at its end: `max_distance_to_saddle_mm`.
    pub key: &'static str,
    /// What it is, for the table.
    pub text: &'static str,
    /// The figure.
    pub value: f64,
    /// Its unit, for the table.
    pub unit: &'static str,
    /// What it may be at most, if there is a bound.
    pub limit: Option<f64>,
}

/// A plot of something over something.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Name of its file, without extension.
    pub file: &'static str,
    /// Title.
    pub title: &'static str,
    /// Label of the horizontal axis, with unit.
    pub x: &'static str,
    /// Label of the vertical axis, with unit.
    pub y: &'static str,
    /// Lines, each with its name.
    pub lines: Vec<(&'static str, Vec<(f64, f64)>)>,
}
