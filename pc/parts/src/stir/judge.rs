//! Figures of a run: true tip and heading of the tool against the exact contour (mathematics 4.4).
//!
//! Distance to the contour and heading tell how good the weld is. The errors of X and Y alone are against the
//! programmed position at the same time, so they contain timing; with them stand the published bounds. Of these the
//! percentage error MAPE depends on where the origin of the work lies, as each error is divided by its coordinate:
//! the error relative to the extent of the contour (NMAE) does not.

use super::error::StirError;
use super::{B, C, Job, SPINDLE, Stir, StirLimits};
use crate::{ALONG, Figure, Judgement, Line, Plot, Run};
use cam::metrics::Comparison;
use cam::path::{Course, PlannedPath};
use evaluate::RunSample;
use nc::Motion;
use shared::units::{DEG_PER_RAD, wrap};
use std::collections::BTreeMap;

/// The program may stir more or less than the contour by this much \[mm\].
const SAME_LENGTH: f64 = 0.01;
/// The nearest place of the contour is looked for so far around the programmed one \[mm\].
const REACH: f64 = 10.0;
/// A path leads along the plate if this much of its direction does.
const LEVEL: f64 = 0.5;

/// A path along the contour.
struct Stirring {
    id: u32,
    path: Course,
    /// Length of the contour before it \[mm\].
    start_s: f64,
}

/// Errors of the pin while it stirs, against contour and program.
#[derive(Default)]
struct StirErrors {
    /// Of the last sample.
    path_id: u32,
    /// Ticks in which the pin travelled, and those of them with the spindle off.
    travelled: usize,
    off: usize,
    /// The next sample begins a part of the lines.
    begins: bool,
    /// True tip against the programmed one, X and Y \[mm\].
    tip: [Comparison; 2],
    /// Distance from the contour \[mm\].
    distance: Comparison,
    /// C against the heading there, and B \[°\].
    heading: Comparison,
    tilt: Comparison,
    lines: Lines,
}

/// What is plotted of them.
#[derive(Default)]
struct Lines {
    tip: [Line; 2],
    heading: Line,
    /// In plan view.
    programmed: Line,
    true_tip: Line,
}

pub(super) fn judge(part: &Stir, job: &Job, run: &Run) -> anyhow::Result<Judgement> {
    let stirring = stirring(run);
    let run_mm = stirring
        .last()
        .map_or(0.0, |last| last.start_s + run.paths[&last.id].length_mm());
    let part_mm = job.contour.length();
    if (run_mm - part_mm).abs() > SAME_LENGTH {
        return Err(StirError::OtherProgram { run_mm, part_mm }.into());
    }
    let mut errors = StirErrors::default();
    let along = run.along();
    // Of each path with samples, how long the pin stood before it.
    let mut stood: BTreeMap<u32, f64> = BTreeMap::new();
    let mut before: Option<RunSample> = None;
    for sample in run.samples.iter() {
        let before = before.replace(sample);
        stood
            .entry(sample.path_id)
            .or_insert_with(|| before.map_or(0.0, |before| preheat(&before, &sample)));
        if sample.speed_mm_s > 0.0
            && let Some(stirring) = stirring.iter().find(|path| path.id == sample.path_id)
        {
            let path_mm = along.at(stirring.id, sample.s_mm);
            errors.add(job, stirring, &sample, path_mm.unwrap_or(f64::NAN))?;
        }
    }
    if errors.distance.count() == 0 {
        return Err(StirError::NothingWelded.into());
    }
    let preheat = stirring
        .iter()
        .map(|path| stood.get(&path.id).copied().unwrap_or(0.0));
    let preheat_s = preheat.fold(f64::INFINITY, f64::min);
    let mut figures = errors.figures(&part.limits)?;
    figures.extend([
        figure("preheat_s", "preheat", preheat_s, "s", None),
        figure(
            "preheat_short_s",
            "preheat too short by",
            (part.preheat_s - preheat_s).max(0.0),
            "s",
            Some(part.limits.preheat_short_s.get()),
        ),
    ]);
    Ok(Judgement {
        figures,
        plots: errors.lines.plots(&part.limits),
        ..Judgement::default()
    })
}

/// The paths along the contour, in the order of the program.
fn stirring(run: &Run) -> Vec<Stirring> {
    let level = |path: &PlannedPath| {
        let start = path.path().at(0.0);
        start.is_some_and(|start| libm::hypot(start.first[0], start.first[1]) > LEVEL)
    };
    let mut start_s = 0.0;
    let paths = run.paths.iter();
    paths
        .filter(|(_, path)| path.motion == Motion::Feed && level(path))
        .map(|(id, path)| {
            let stirring = Stirring {
                id: *id,
                path: path.path(),
                start_s,
            };
            start_s += path.length_mm();
            stirring
        })
        .collect()
}

/// How long the pin stood between the last sample before a path and the first one on it, the spindle on in both \[s\].
fn preheat(before: &RunSample, first: &RunSample) -> f64 {
    if before.beams[SPINDLE] && first.beams[SPINDLE] {
        (first.time_us - before.time_us) as f64 * 1e-6
    } else {
        0.0
    }
}

impl StirErrors {
    fn add(
        &mut self,
        job: &Job,
        stirring: &Stirring,
        sample: &RunSample,
        path_mm: f64,
    ) -> anyhow::Result<()> {
        self.travelled += 1;
        if !sample.beams[SPINDLE] {
            self.off += 1;
            self.begins = true;
            return Ok(());
        }
        if sample.path_id != std::mem::replace(&mut self.path_id, sample.path_id) {
            self.begins = true;
        }
        let Some(point) = stirring.path.at(sample.s_mm) else {
            return Ok(());
        };
        let programmed = point.pose()?.position;
        let tip = sample.pose.position;
        let along = job.contour.nearest(&tip, stirring.start_s + sample.s_mm, REACH);
        let (place, heading) = job.contour.at(along);
        // All passes have the same offset, but for whole turns.
        let offset = job.passes[0].offset;
        let heading = wrap(sample.axes[C] - heading - offset) * DEG_PER_RAD;
        if std::mem::take(&mut self.begins) {
            self.lines.gap();
        }
        let lines = &mut self.lines;
        for i in 0..2 {
            self.tip[i].add(tip[i], programmed[i]);
            lines.tip[i].push((path_mm, tip[i] - programmed[i]));
        }
        self.distance.add((tip - place).norm(), 0.0);
        self.heading.add(heading, 0.0);
        self.tilt.add((sample.axes[B] - job.b) * DEG_PER_RAD, 0.0);
        lines.heading.push((path_mm, heading));
        lines.programmed.push((programmed[0], programmed[1]));
        lines.true_tip.push((tip[0], tip[1]));
        Ok(())
    }

    fn figures(&self, limits: &StirLimits) -> anyhow::Result<Vec<Figure>> {
        let (distance, heading, tilt) = (
            self.distance.figures()?,
            self.heading.figures()?,
            self.tilt.figures()?,
        );
        let mut figures = vec![
            figure(
                "max_heading_error_deg",
                "heading error",
                heading.max,
                "°",
                Some(limits.heading_deg.get()),
            ),
            figure(
                "rms_heading_error_deg",
                "heading error, rms",
                heading.rmse,
                "°",
                None,
            ),
            figure(
                "max_tilt_error_deg",
                "tilt error",
                tilt.max,
                "°",
                Some(limits.tilt_deg.get()),
            ),
            figure(
                "max_contour_distance_mm",
                "tip beside the contour",
                distance.max,
                "mm",
                None,
            ),
            figure(
                "rms_contour_distance_mm",
                "tip beside the contour, rms",
                distance.rmse,
                "mm",
                None,
            ),
        ];
        let texts = [
            [
                ("mae_x_mm", "X error and timing, mean"),
                ("max_error_x_mm", "X error and timing"),
                ("mape_x_percent", "X MAPE (by the origin)"),
                ("nmae_x_percent", "X NMAE (by the extent)"),
            ],
            [
                ("mae_y_mm", "Y error and timing, mean"),
                ("max_error_y_mm", "Y error and timing"),
                ("mape_y_percent", "Y MAPE (by the origin)"),
                ("nmae_y_percent", "Y NMAE (by the extent)"),
            ],
        ];
        for (i, [mae, max, mape, nmae]) in texts.into_iter().enumerate() {
            let errors = self.tip[i].figures()?;
            let of = |(key, text), value, unit, limit| figure(key, text, value, unit, limit);
            figures.push(of(mae, errors.mae, "mm", Some(limits.axis_mm.get())));
            figures.push(of(max, errors.max, "mm", Some(limits.axis_mm.get())));
            // Neither is there where the weld lies on an axis of the work, or along one.
            let mape = errors
                .mape_percent
                .map(|value| of(mape, value, "%", Some(limits.axis_mape_percent.get())));
            let nmae = errors.nmae_percent.map(|value| of(nmae, value, "%", None));
            figures.extend([mape, nmae].into_iter().flatten());
        }
        figures.push(figure(
            "spindle_off_percent",
            "travel with the spindle off",
            100.0 * self.off as f64 / self.travelled as f64,
            "%",
            Some(0.0),
        ));
        Ok(figures)
    }
}

impl Lines {
    /// All of them are open here.
    fn gap(&mut self) {
        let [x, y] = &mut self.tip;
        for line in [x, y, &mut self.heading, &mut self.programmed, &mut self.true_tip] {
            line.gap();
        }
    }

    fn plots(self, limits: &StirLimits) -> Vec<Plot> {
        let both = |limit: f64| vec![-limit, limit];
        let [x, y] = self.tip.map(Line::into_points);
        vec![
            Plot {
                file: "stir-error",
                title: "Tip of the pin against the programmed one at the same time",
                x: ALONG,
                y: "error [mm]",
                lines: vec![("X", x), ("Y", y)],
                limits: both(limits.axis_mm.get()),
                to_scale: false,
            },
            Plot {
                file: "stir-heading",
                title: "Heading of the tool against the contour",
                x: ALONG,
                y: "error [°]",
                lines: vec![("C", self.heading.into_points())],
                limits: both(limits.heading_deg.get()),
                to_scale: false,
            },
            Plot {
                file: "stir-contour",
                title: "Contour in plan view",
                x: "X [mm]",
                y: "Y [mm]",
                lines: vec![
                    ("programmed", self.programmed.into_points()),
                    ("true tip", self.true_tip.into_points()),
                ],
                limits: Vec::new(),
                to_scale: true,
            },
        ]
    }
}

fn figure(
    key: &'static str,
    text: &'static str,
    value: f64,
    unit: &'static str,
    limit: Option<f64>,
) -> Figure {
    Figure {
        limit,
        ..Figure::new(key, text, value, unit)
    }
}
