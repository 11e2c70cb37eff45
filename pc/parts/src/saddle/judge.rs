//! Figures of a run: the torch as it truly was against the exact saddle and the bisector of its groove.

use super::error::SaddlePartError;
use super::seam::{Deviation, Seam};
use super::{Saddle, SaddleLimits};
use crate::{ALONG, Figure, Judgement, Line, Plot, Run};
use cam::along::Along;
use evaluate::RunSample;
use shared::units::next_to;
use std::collections::{BTreeMap, VecDeque};

/// Arc off for longer than this leaves a gap in the lines of the plots \[µs\].
const GAP_US: u64 = 1500;
/// Speeds are means over so many samples.
const SPEED_WINDOW: usize = 50;
/// Names of the lines in plots; passes after these have the last name.
const PASSES: [&str; 7] = [
    "pass 1",
    "pass 2",
    "pass 3",
    "pass 4",
    "pass 5",
    "pass 6",
    "further passes",
];
/// The beam that is the arc.
const ARC: usize = 0;
/// Slot of C.
const WAIST: usize = 5;

/// Figures of all passes together.
#[derive(Default)]
struct PassFigures {
    along: Along,
    samples: u32,
    max_distance: f64,
    sum_of_squares: f64,
    max_tilt_error_deg: f64,
    max_out_of_plane_deg: f64,
    length: f64,
    speed_fluctuation: f64,
    passes: Vec<Lines>,
}

/// One pass, in plots.
#[derive(Default)]
struct Lines {
    distance: Line,
    tilt_error: Line,
    out_of_plane: Line,
}

pub(super) fn judge(part: &Saddle, seam: &Seam, run: &Run) -> anyhow::Result<Judgement> {
    let welds = run.paths.iter().filter(|(_, path)| path.weld().is_some());
    let welds: Vec<u32> = welds.map(|(id, _)| *id).collect();
    let (paths, passes) = (welds.len(), part.passes.len());
    if paths != passes {
        return Err(SaddlePartError::Passes { paths, passes }.into());
    }
    let numbers: BTreeMap<u32, usize> = welds.into_iter().zip(0..).collect();
    let mut figures = PassFigures {
        along: run.along(),
        passes: part.passes.iter().map(|_| Lines::default()).collect(),
        ..PassFigures::default()
    };
    let mut pass = None;
    let mut window = VecDeque::new();
    for sample in run.samples.iter().filter(|sample| sample.beams[ARC]) {
        let Some(number) = numbers.get(&sample.path_id).copied() else {
            continue;
        };
        if pass.replace(number) != Some(number) {
            window.clear();
        }
        let offset = part.passes[number].offset();
        let deviation = seam.deviation(&sample.pose, &offset)?;
        figures.add(number, &sample, &deviation, &mut window);
    }
    Ok(figures.judgement(&part.limits))
}

impl PassFigures {
    /// Adds the next sample with the arc on; `window` has those of its pass before it.
    fn add(
        &mut self,
        pass: usize,
        sample: &RunSample,
        deviation: &Deviation,
        window: &mut VecDeque<RunSample>,
    ) {
        let lines = &mut self.passes[pass];
        if let Some(before) = window.back() {
            if sample.time_us.saturating_sub(before.time_us) > GAP_US {
                for line in [
                    &mut lines.distance,
                    &mut lines.tilt_error,
                    &mut lines.out_of_plane,
                ] {
                    line.gap();
                }
            }
            self.length += (sample.pose.position - before.pose.position).norm();
        }
        let waist = next_to(deviation.station.waist, sample.axes[WAIST]).to_degrees();
        let along_mm = self.along.at(sample.path_id, sample.s_mm).unwrap_or(f64::NAN);
        lines.distance.push((along_mm, deviation.distance));
        lines.tilt_error.push((waist, deviation.tilt_error.to_degrees()));
        let out_of_plane = deviation.station.out_of_plane.to_degrees();
        lines.out_of_plane.push((waist, out_of_plane));
        self.add_deviation(deviation);
        window.push_back(*sample);
        if window.len() == SPEED_WINDOW {
            self.add_speed(&window[0], sample);
            window.pop_front();
        }
    }

    /// Adds the mean speed between two samples.
    fn add_speed(&mut self, first: &RunSample, last: &RunSample) {
        let time = last.time_us.saturating_sub(first.time_us) as f64 * 1e-6;
        let speed = (last.pose.position - first.pose.position).norm() / time;
        let wanted = (first.speed_mm_s + last.speed_mm_s) / 2.0;
        self.speed_fluctuation = self.speed_fluctuation.max((speed / wanted - 1.0).abs());
    }

    fn add_deviation(&mut self, deviation: &Deviation) {
        let tilt_error = deviation.tilt_error.to_degrees().abs();
        let out_of_plane = deviation.station.out_of_plane.to_degrees().abs();
        self.samples += 1;
        self.max_distance = self.max_distance.max(deviation.distance);
        self.sum_of_squares += deviation.distance * deviation.distance;
        self.max_tilt_error_deg = self.max_tilt_error_deg.max(tilt_error);
        self.max_out_of_plane_deg = self.max_out_of_plane_deg.max(out_of_plane);
    }

    fn judgement(self, limits: &SaddleLimits) -> Judgement {
        let figure = |key, text, value, unit, limit| Figure {
            limit,
            ..Figure::new(key, text, value, unit)
        };
        let length = figure("welded_length_mm", "welded length", self.length, "mm", None);
        if self.samples == 0 {
            return Judgement {
                figures: vec![length],
                ..Judgement::default()
            };
        }
        let rms = libm::sqrt(self.sum_of_squares / f64::from(self.samples));
        let figures = vec![
            figure(
                "max_distance_to_saddle_mm",
                "largest distance to saddle",
                self.max_distance,
                "mm",
                Some(limits.distance_mm.get()),
            ),
            figure(
                "rms_distance_to_saddle_mm",
                "rms distance to saddle",
                rms,
                "mm",
                None,
            ),
            figure(
                "max_bisector_error_deg",
                "off bisector, as B tilts",
                self.max_tilt_error_deg,
                "°",
                Some(limits.bisector_deg.get()),
            ),
            figure(
                "max_out_of_plane_deg",
                "off bisector, across that",
                self.max_out_of_plane_deg,
                "°",
                None,
            ),
            length,
            figure(
                "speed_fluctuation_percent",
                "largest speed deviation",
                100.0 * self.speed_fluctuation,
                "%",
                None,
            ),
        ];
        let plot = |file, title, x, y, lines, limits| Plot {
            file,
            title,
            x,
            y,
            lines,
            limits,
            to_scale: false,
        };
        let tilt = limits.bisector_deg.get();
        let [mut distances, mut tilt_errors, mut out_of_plane] = [const { Vec::new() }; 3];
        for (pass, lines) in self.passes.into_iter().enumerate() {
            let name = PASSES[pass.min(PASSES.len() - 1)];
            distances.push((name, lines.distance.into_points()));
            tilt_errors.push((name, lines.tilt_error.into_points()));
            out_of_plane.push((name, lines.out_of_plane.into_points()));
        }
        let plots = vec![
            plot(
                "saddle-distance",
                "Tip against the exact saddle",
                ALONG,
                "distance [mm]",
                distances,
                vec![limits.distance_mm.get()],
            ),
            plot(
                "saddle-tilt",
                "Torch against the bisector, in the plane of the tilt",
                "waist [°]",
                "angle [°]",
                tilt_errors,
                vec![-tilt, tilt],
            ),
            plot(
                "saddle-out-of-plane",
                "Torch against the bisector, across the plane of the tilt",
                "waist [°]",
                "angle [°]",
                out_of_plane,
                Vec::new(),
            ),
        ];
        Judgement {
            figures,
            plots,
            ..Judgement::default()
        }
    }
}
