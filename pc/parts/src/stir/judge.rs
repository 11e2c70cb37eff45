//! Figures of a run: true tip and heading of the tool against the exact contour (mathematics 4.4).
//!
//! Distance to the contour and heading tell how good the weld is. The errors of X and Y alone are against the
//! programmed position at the same time, so they contain timing; with them stand the published bounds. Of these the
//! percentage error MAPE depends on where the origin of the work lies, as each error is divided by its coordinate:
//! the error relative to the extent of the contour (NMAE) does not.

use super::error::StirError;
use super::{B, C, Job, SPINDLE, Stir, StirLimits};
use crate::{ALONG, Figure, GAP, Judgement, Plot, Run};
use cam::metrics::compare;
use cam::path::{Course, PlannedPath};
use evaluate::RunSample;
use nc::Motion;
use shared::units::{DEG_PER_RAD, wrap};

/// The program may stir more or less than the contour by this much \[mm\].
const SAME_LENGTH: f64 = 0.01;
/// The nearest place of the contour is looked for so far around the programmed one \[mm\].
const REACH: f64 = 10.0;
/// Points of a plot, at most.
const PLOTTED: usize = 2000;
/// A path leads along the plate if this much of its direction does.
const LEVEL: f64 = 0.5;

/// A path along the contour.
struct Stirring {
    id: u32,
    path: Course,
    /// Length of the contour before it \[mm\].
    start_s: f64,
}

/// What the samples tell.
#[derive(Default)]
struct Traces {
    /// Of the last sample.
    path_id: u32,
    /// Ticks in which the pin travelled, and those of them with the spindle off.
    travelled: usize,
    off: usize,
    /// Path length through all paths, for the plots \[mm\].
    path_mm: Vec<f64>,
    /// Numbers of samples of which nothing was seen right before: a gap in the plots.
    begins: Vec<usize>,
    /// True and programmed tip, X and Y \[mm\].
    tip: [Vec<f64>; 2],
    programmed: [Vec<f64>; 2],
    /// Distance from the contour \[mm\].
    distance: Vec<f64>,
    /// C against the heading there, and B \[°\].
    heading: Vec<f64>,
    tilt: Vec<f64>,
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
    let mut seen = Traces::default();
    let along = run.along();
    for sample in run.samples.iter().filter(|sample| sample.speed_mm_s > 0.0) {
        if let Some(stirring) = stirring.iter().find(|path| path.id == sample.path_id) {
            let path_mm = along.at(stirring.id, sample.s_mm);
            seen.add(job, stirring, sample, path_mm.unwrap_or(f64::NAN))?;
        }
    }
    if seen.path_mm.is_empty() {
        return Err(StirError::NothingWelded.into());
    }
    let preheat = stirring.iter().map(|path| preheat(run.samples, path.id));
    let preheat_s = preheat.fold(f64::INFINITY, f64::min);
    let mut figures = seen.figures(&part.limits)?;
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
        plots: seen.plots(&part.limits),
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

/// How long the pin stood before path `id`, the spindle on before and after \[s\].
fn preheat(samples: &[RunSample], id: u32) -> f64 {
    let Some(first) = samples.iter().position(|sample| sample.path_id == id) else {
        return 0.0;
    };
    match (
        first.checked_sub(1).map(|before| &samples[before]),
        &samples[first],
    ) {
        (Some(before), after) if before.beams[SPINDLE] && after.beams[SPINDLE] => {
            (after.time_us - before.time_us) as f64 * 1e-6
        }
        _ => 0.0,
    }
}

impl Traces {
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
            self.begins.push(self.path_mm.len());
            return Ok(());
        }
        if sample.path_id != std::mem::replace(&mut self.path_id, sample.path_id) {
            self.begins.push(self.path_mm.len());
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
        self.path_mm.push(path_mm);
        for i in 0..2 {
            self.tip[i].push(tip[i]);
            self.programmed[i].push(programmed[i]);
        }
        self.distance.push((tip - place).norm());
        self.heading
            .push(wrap(sample.axes[C] - heading - offset) * DEG_PER_RAD);
        self.tilt.push((sample.axes[B] - job.b) * DEG_PER_RAD);
        Ok(())
    }

    fn figures(&self, limits: &StirLimits) -> anyhow::Result<Vec<Figure>> {
        let zeros = vec![0.0; self.path_mm.len()];
        let [distance, heading, tilt] =
            [&self.distance, &self.heading, &self.tilt].map(|errors| compare(errors, &zeros));
        let (distance, heading, tilt) = (distance?, heading?, tilt?);
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
            let errors = compare(&self.tip[i], &self.programmed[i])?;
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

    fn plots(&self, limits: &StirLimits) -> Vec<Plot> {
        let over_path = |values: Vec<f64>| {
            let line: Vec<_> = self.path_mm.iter().copied().zip(values).collect();
            self.broken(worst_of_each, &line)
        };
        let error = |i: usize| {
            let pairs = self.tip[i].iter().zip(&self.programmed[i]);
            over_path(pairs.map(|(tip, programmed)| tip - programmed).collect())
        };
        let plan = |points: &[Vec<f64>; 2]| {
            let line: Vec<_> = points[0].iter().copied().zip(points[1].iter().copied()).collect();
            let every = |part: &[(f64, f64)], all: usize| {
                let step = all.div_ceil(PLOTTED).max(1);
                part.iter().copied().step_by(step).collect()
            };
            self.broken(every, &line)
        };
        let both = |limit: f64| vec![-limit, limit];
        vec![
            Plot {
                file: "stir-error",
                title: "Tip of the pin against the programmed one at the same time",
                x: ALONG,
                y: "error [mm]",
                lines: vec![("X", error(0)), ("Y", error(1))],
                limits: both(limits.axis_mm.get()),
                to_scale: false,
            },
            Plot {
                file: "stir-heading",
                title: "Heading of the tool against the contour",
                x: ALONG,
                y: "error [°]",
                lines: vec![("C", over_path(self.heading.clone()))],
                limits: both(limits.heading_deg.get()),
                to_scale: false,
            },
            Plot {
                file: "stir-contour",
                title: "Contour in plan view",
                x: "X [mm]",
                y: "Y [mm]",
                lines: vec![
                    ("programmed", plan(&self.programmed)),
                    ("true tip", plan(&self.tip)),
                ],
                limits: Vec::new(),
                to_scale: true,
            },
        ]
    }

    /// A line that is open where nothing was seen; each of its parts becomes what `few` makes of it, told how many
    /// points there are in all.
    fn broken(
        &self,
        few: impl Fn(&[(f64, f64)], usize) -> Vec<(f64, f64)>,
        line: &[(f64, f64)],
    ) -> Vec<(f64, f64)> {
        let mut parts = Vec::new();
        let ends = self.begins.iter().copied().chain([line.len()]);
        let mut from = 0;
        for to in ends.filter(|to| *to > 0) {
            if to > from {
                parts.extend((!parts.is_empty()).then_some(GAP));
                parts.extend(few(&line[from..to], line.len()));
                from = to;
            }
        }
        parts
    }
}

/// So few points that a plot can hold `all`: of each bunch the one with the largest value, whatever its sign.
fn worst_of_each(points: &[(f64, f64)], all: usize) -> Vec<(f64, f64)> {
    let bunch = all.div_ceil(PLOTTED).max(1);
    let worst = points
        .chunks(bunch)
        .filter_map(|bunch| bunch.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())));
    worst.copied().collect()
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
