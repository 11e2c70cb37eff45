//! What a run is judged by, and what comes of it.

use crate::limits::Percent;
use cam::along::Along;
use cam::path::PlannedPath;
use config::machine::MachineFile;
use evaluate::{Evaluation, RunSamples};
use serde::Serialize;
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
    pub samples: &'a dyn RunSamples,
    /// What can be told of any run.
    pub evaluation: &'a Evaluation,
}

impl Run<'_> {
    /// One path length through all paths, for plots.
    pub fn along(&self) -> Along {
        Along::of(self.paths)
    }

    /// How far the speed fell below the feed with a beam on, if one ever was, and how far it may.
    pub(super) fn speed_dip(&self, limit: Percent) -> Option<Figure> {
        let speed = self.evaluation.speed?;
        let dip = (100.0 - speed.lowest_percent).max(0.0);
        let figure = Figure::new("speed_dip_percent", "speed below the feed, beam on", dip, "%");
        Some(figure.limited(limit.get()).at(speed.lowest_at_mm))
    }
}

/// What a run was worth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judgement {
    /// Figures for table and report.
    pub figures: Vec<Figure>,
    /// Plots for the report.
    pub plots: Vec<Plot>,
    /// Limits of the part that nothing was known to judge by: which, and why, a sentence each.
    pub not_judged: Vec<String>,
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
    /// What it may be at least, if there is such a bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least: Option<f64>,
    /// Where that was, as [`Along`] has it \[mm\], if it was somewhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_mm: Option<f64>,
}

impl Figure {
    /// One without a bound.
    pub const fn new(key: &'static str, text: &'static str, value: f64, unit: &'static str) -> Self {
        Self {
            key,
            text,
            value,
            unit,
            limit: None,
            least: None,
            at_mm: None,
        }
    }

    /// It may be `limit` at most.
    pub const fn limited(mut self, limit: f64) -> Self {
        self.limit = Some(limit);
        self
    }

    /// It may be `least` at least.
    pub const fn at_least(mut self, least: f64) -> Self {
        self.least = Some(least);
        self
    }

    /// Whether it is beyond a bound that it has; a figure that is no number keeps none.
    pub fn is_exceeded(&self) -> bool {
        let above = self.limit.is_some_and(|limit| self.value > limit);
        let below = self.least.is_some_and(|least| self.value < least);
        above || below || self.value.is_nan() && (self.limit.is_some() || self.least.is_some())
    }

    /// It was so at `along_mm`.
    pub const fn at(mut self, along_mm: f64) -> Self {
        self.at_mm = Some(along_mm);
        self
    }
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
    /// Lines, each with its name; a point that is not finite leaves a gap in its line.
    pub lines: Vec<(&'static str, Vec<(f64, f64)>)>,
    /// Limits of what the vertical axis shows.
    pub limits: Vec<f64>,
    /// Both axes have one scale: a plan view.
    pub to_scale: bool,
}

/// Label of the horizontal axis of plots over the path, as [`Along`] has it.
pub const ALONG: &str = "path from where the first beam goes on [mm]";

/// A point that leaves a gap in the line of a plot.
pub const GAP: (f64, f64) = (f64::NAN, f64::NAN);
