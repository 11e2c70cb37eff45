//! What a run made of a bead: true speed against the process window, true tip against the exact NURBS.

use super::figures::{BeadFigures, Laid};
use super::route::Route;
use super::window::ProcessWindow;
use super::{BeadLimits, Layer};
use crate::{Judgement, Run};
use anyhow::ensure;
use curves::nurbs::Curve;
use evaluate::RunSample;
use nalgebra::Vector3;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// The true speed is the length of the true way over this many ticks before and after, 8 ms in all: a grating of
/// 0.1 µm then makes less than 0.02 mm/s of noise.
const HALF: usize = 4;
/// The programmed speed is constant if it changes by less, of itself.
const CONSTANT: f64 = 1e-6;
/// Distance of the places among which the nearest is looked for, and how far around the programmed one \[mm\].
const STEP: f64 = 0.02;
const REACH: f64 = 1.0;
/// A path of another length than the part's, by more than this, is another program \[mm\].
const SAME_LENGTH: f64 = 0.5;

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
    let layers: BTreeMap<u32, Layer> = burnt.into_iter().zip(layers).collect();
    for id in layers.keys() {
        if let Some(length) = run.paths.get(id).map(|path| path.length_mm()) {
            ensure!(
                (length - end).abs() <= SAME_LENGTH,
                "path {id} is {length:.2} mm long, but a layer of the part {end:.2} mm: plan the program anew"
            );
        }
    }
    let near = Near::build(route);
    let path_length = run.along();
    let mut figures = BeadFigures::default();
    // The samples around one, all of its path.
    let mut around: VecDeque<RunSample> = VecDeque::new();
    for sample in run.samples.iter() {
        let Some(layer) = layers.get(&sample.path_id) else {
            continue;
        };
        if around.back().is_some_and(|last| last.path_id != sample.path_id) {
            around.clear();
            figures.begins();
        }
        around.push_back(sample);
        if around.len() == 2 * HALF + 1 {
            let now = &around[HALF];
            if now.beams[0] {
                let (contour, radius) = near.find(now.s_mm, &layer.lower(&now.pose.position));
                let path_mm = path_length.at(now.path_id, now.s_mm).unwrap_or(f64::NAN);
                let laid = Laid::of(&around, path_mm, contour, radius);
                figures.add(&laid, window);
            } else {
                figures.begins();
            }
            around.pop_front();
        }
    }
    ensure!(
        !figures.is_empty(),
        "the arc burnt for too short a time to judge a bead"
    );
    Ok(figures.judgement(layers.len(), window, limits))
}

impl Laid {
    /// At the middle one of samples of a path.
    fn of(around: &VecDeque<RunSample>, path_mm: f64, contour: f64, radius: f64) -> Self {
        let (first, now, last) = (&around[0], &around[HALF], &around[2 * HALF]);
        let seconds = |a: &RunSample, b: &RunSample| (b.time_us - a.time_us) as f64 * 1e-6;
        let step = |k: usize| (around[k + 1].pose.position - around[k].pose.position).norm();
        let programmed = now.speed_mm_s;
        let same = |s: &RunSample| (s.speed_mm_s - programmed).abs() <= CONSTANT * programmed;
        Self {
            path_mm,
            length: step(HALF),
            time: seconds(now, &around[HALF + 1]),
            speed: (0..2 * HALF).map(step).sum::<f64>() / seconds(first, last),
            constant: around.iter().all(same).then_some(programmed),
            programmed,
            contour,
            radius,
        }
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
