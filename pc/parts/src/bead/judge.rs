//! What a run made of a bead: true speed against the process window, true tip against the exact NURBS.

use super::route::Route;
use super::window::ProcessWindow;
use super::{BeadLimits, Layer};
use crate::{ALONG, Figure, GAP, Judgement, Plot, Run};
use anyhow::ensure;
use curves::nurbs::Curve;
use evaluate::RunSample;
use nalgebra::Vector3;
use std::collections::BTreeSet;

/// The true speed is the length of the true way over this many ticks before and after, 8 ms in all: a grating of
/// 0.1 µm then makes less than 0.02 mm/s of noise.
const HALF: usize = 4;
/// The window counts as kept up to this part beyond it: what is programmed at its edge is not outside by noise.
const EDGE: f64 = 0.01;
/// The programmed speed is constant if it changes by less, of itself.
const CONSTANT: f64 = 1e-6;
/// A corner is sharp below this radius \[mm\].
const SHARP: f64 = 1.0;
/// Distance of the places among which the nearest is looked for, and how far around the programmed one \[mm\].
const STEP: f64 = 0.02;
const REACH: f64 = 1.0;
/// A path of another length than the part's, by more than this, is another program \[mm\].
const SAME_LENGTH: f64 = 0.5;

/// The tip at one tick with the arc burning.
#[derive(Clone, Copy, Debug)]
struct BeadSample {
    /// Bead laid before, all layers together \[mm\].
    along: f64,
    /// Path length through all paths, for the plots \[mm\].
    path_mm: f64,
    /// The arc went on here: nothing is laid between this tick and the one before.
    begins: bool,
    /// Bead laid in this tick \[mm\], and the time for it \[s\].
    length: f64,
    time: f64,
    /// True speed, and the programmed one if that is constant \[mm/s\].
    speed: f64,
    constant: Option<f64>,
    programmed: f64,
    /// Distance from the curve \[mm\].
    contour: f64,
    /// Radius of the curve there \[mm\].
    radius: f64,
}

pub(super) fn judge(
    route: &Route,
    layers: impl Iterator<Item = Layer>,
    window: &ProcessWindow,
    limits: &BeadLimits,
    run: &Run,
) -> anyhow::Result<Judgement> {
    let burnt: BTreeSet<u32> = run
        .samples
        .iter()
        .filter(|s| s.beams[0])
        .map(|s| s.path_id)
        .collect();
    ensure!(
        !burnt.is_empty(),
        "the arc never burnt, so there is no bead to judge"
    );
    let [_, end] = route.domain();
    let near = Near::build(route);
    let mut laid: Vec<BeadSample> = Vec::new();
    let mut count = 0.0;
    for (id, layer) in burnt.into_iter().zip(layers) {
        if let Some(length) = run.paths.get(&id).map(|path| path.length_mm()) {
            ensure!(
                (length - end).abs() <= SAME_LENGTH,
                "path {id} is {length:.2} mm long, but a layer of the part {end:.2} mm: plan the program anew"
            );
        }
        let samples: Vec<&RunSample> = run.samples.iter().filter(|s| s.path_id == id).collect();
        let before = laid.last().map_or(0.0, |last| last.along + last.length);
        let along = |s| run.along().at(id, s).unwrap_or(f64::NAN);
        let nearest = |s: f64, p: &Vector3<f64>| near.find(s, &layer.lower(p));
        add_layer(&mut laid, &samples, before, along, nearest);
        count += 1.0;
    }
    ensure!(
        !laid.is_empty(),
        "the arc burnt for too short a time to judge a bead"
    );
    Ok(Judgement {
        figures: figures(&laid, count, window, limits),
        plots: plots(&laid, window, limits),
    })
}

/// Adds what was laid on one path; `path_mm` gives the length through all paths, `nearest` the distance from the curve,
/// and its radius.
fn add_layer(
    laid: &mut Vec<BeadSample>,
    samples: &[&RunSample],
    before: f64,
    path_mm: impl Fn(f64) -> f64,
    nearest: impl Fn(f64, &Vector3<f64>) -> (f64, f64),
) {
    let mut along = before;
    let mut begins = true;
    for i in HALF..samples.len().saturating_sub(HALF) {
        let around = &samples[i - HALF..=i + HALF];
        let now = samples[i];
        if !now.beams[0] {
            begins = true;
            continue;
        }
        let seconds = |a: &RunSample, b: &RunSample| (b.time_us - a.time_us) as f64 * 1e-6;
        let step = |pair: &[&RunSample]| (pair[1].pose.position - pair[0].pose.position).norm();
        let programmed = now.speed_mm_s;
        let same = |s: &&RunSample| (s.speed_mm_s - programmed).abs() <= CONSTANT * programmed;
        let next = &around[HALF..=HALF + 1];
        let (contour, radius) = nearest(now.s_mm, &now.pose.position);
        let entry = BeadSample {
            along,
            path_mm: path_mm(now.s_mm),
            begins: std::mem::take(&mut begins),
            length: step(next),
            time: seconds(next[0], next[1]),
            speed: around.windows(2).map(step).sum::<f64>() / seconds(around[0], around[2 * HALF]),
            constant: around.iter().all(same).then_some(programmed),
            programmed,
            contour,
            radius,
        };
        along += entry.length;
        laid.push(entry);
    }
}

/// Finds what is nearest on a route.
struct Near<'a> {
    route: &'a Route<'a>,
    points: Vec<Vector3<f64>>,
}

impl<'a> Near<'a> {
    fn build(route: &'a Route<'a>) -> Self {
        let [_, end] = route.domain();
        let count = (end / STEP).ceil() as usize;
        let points = (0..=count).map(|i| route.point(i as f64 * STEP)).collect();
        Self { route, points }
    }

    /// Distance of `p` from the curve around `s`, and the radius of the curve there.
    fn find(&self, s: f64, p: &Vector3<f64>) -> (f64, f64) {
        let last = self.points.len() - 1;
        let from = (((s - REACH) / STEP).max(0.0) as usize).min(last);
        let to = (((s + REACH) / STEP).max(0.0) as usize).min(last);
        let distance = |i: &usize| (self.points[*i] - p).norm_squared();
        let best = (from..=to).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let t = self.route.nearest(p, best.unwrap_or(from) as f64 * STEP);
        let at = self.route.at(t);
        ((at.value - p).norm(), 1.0 / at.second.norm())
    }
}

fn figures(laid: &[BeadSample], layers: f64, window: &ProcessWindow, limits: &BeadLimits) -> Vec<Figure> {
    let outside = |laid: &&BeadSample| {
        laid.speed < window.low * (1.0 - EDGE) || laid.speed > window.high * (1.0 + EDGE)
    };
    let sum = |value: fn(&BeadSample) -> f64| laid.iter().map(value).sum::<f64>();
    let sum_outside = |value: fn(&BeadSample) -> f64| laid.iter().filter(outside).map(value).sum::<f64>();
    let (length, time) = (sum(|l| l.length), sum(|l| l.time));
    let off: Vec<f64> = laid
        .iter()
        .filter_map(|l| l.constant.map(|programmed| 100.0 * (l.speed / programmed - 1.0)))
        .collect();
    let squares = |values: &mut dyn Iterator<Item = f64>| {
        let (count, sum) = values.fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + x * x));
        libm::sqrt(sum / f64::max(count, 1.0))
    };
    let figure = |key, text, value, unit, limit| Figure {
        limit,
        ..Figure::new(key, text, value, unit)
    };
    let mut figures = vec![
        figure("bead_length_mm", "bead, each layer", length / layers, "mm", None),
        figure(
            "length_outside_window_percent",
            "length laid outside the process window",
            100.0 * sum_outside(|l| l.length) / length,
            "%",
            Some(limits.outside_window_percent.get()),
        ),
        figure(
            "time_outside_window_percent",
            "time outside the process window",
            100.0 * sum_outside(|l| l.time) / time,
            "%",
            None,
        ),
    ];
    if !off.is_empty() {
        figures.push(figure(
            "speed_fluctuation_rms_percent",
            "speed error where the speed is constant, rms",
            squares(&mut off.iter().copied()),
            "%",
            None,
        ));
        figures.push(figure(
            "speed_fluctuation_max_percent",
            "speed error where the speed is constant, largest",
            off.iter().map(|x| x.abs()).fold(0.0, f64::max),
            "%",
            None,
        ));
    }
    let sharp = laid.iter().filter(|l| l.radius < SHARP);
    if let Some(slowest) = sharp.min_by(|a, b| a.speed.total_cmp(&b.speed)) {
        figures.push(figure(
            "slowest_in_corners_mm_s",
            "slowest in the sharp corners",
            slowest.speed,
            "mm/s",
            None,
        ));
        figures.push(figure(
            "slowest_in_corners_at_mm",
            "which is, along the bead, at",
            slowest.along,
            "mm",
            None,
        ));
    }
    figures.push(figure(
        "contour_error_max_mm",
        "distance of the tip from the NURBS, largest",
        laid.iter().map(|l| l.contour).fold(0.0, f64::max),
        "mm",
        Some(limits.contour_mm.get()),
    ));
    figures.push(figure(
        "contour_error_rms_mm",
        "distance of the tip from the NURBS, rms",
        squares(&mut laid.iter().map(|l| l.contour)),
        "mm",
        None,
    ));
    figures
}

fn plots(laid: &[BeadSample], window: &ProcessWindow, limits: &BeadLimits) -> Vec<Plot> {
    let line = |value: &dyn Fn(&BeadSample) -> f64| {
        let mut line = Vec::with_capacity(laid.len());
        for l in laid {
            line.extend(l.begins.then_some(GAP));
            line.push((l.path_mm, value(l)));
        }
        line
    };
    vec![
        Plot {
            file: "bead-speed",
            title: "Speed of the tip over the part (dashed: the process window)",
            x: ALONG,
            y: "mm/s",
            lines: vec![
                ("true", line(&|l| l.speed)),
                ("programmed", line(&|l| l.programmed)),
            ],
            limits: vec![window.low, window.high],
            to_scale: false,
        },
        Plot {
            file: "bead-contour",
            title: "Distance of the tip from the NURBS",
            x: ALONG,
            y: "µm",
            lines: vec![("contour error", line(&|l| l.contour * 1e3))],
            limits: vec![1e3 * limits.contour_mm.get()],
            to_scale: false,
        },
    ]
}
