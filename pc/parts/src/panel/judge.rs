//! What a cut on a panel was worth: by where the focus truly was, and in a simulated world by the panel itself.

use super::{Panel, PanelLimits};
use crate::CurvedPanel;
use crate::{ALONG, Figure, GAP, Judgement, Line, Plot, Run};
use cam::path::{Course, PlannedPath};
use evaluate::RunSample;
use nalgebra::Vector3;
use shared::geometry::angle;
use shared::trajectory::PathSpace;
use std::collections::BTreeMap;
use teach::TaughtPoint;

/// Turning A and C with the focus held: the tip of the plan moves less than this \[mm\], the tool turns more \[rad\].
const HELD: f64 = 1e-3;
const TURNED: f64 = 1e-3;
/// Steps of the search for the nearest place of a path, and when it is found \[mm\].
const STEPS: usize = 20;
const FOUND: f64 = 1e-7;
/// Every so many samples make a point of a plot.
const THIN: usize = 10;

impl Panel {
    pub(super) fn figures(&self, run: &Run, points: &[TaughtPoint]) -> Judgement {
        let mut judgement = Judgement::default();
        focus(run, &self.limits, &mut judgement);
        if let Some(surface) = &self.simulated_surface {
            tool(run, surface, &self.limits, &mut judgement);
            normals(points, surface, &self.limits, &mut judgement);
        }
        pace(points, &mut judgement);
        judgement
    }
}

/// Where the focus should be on a path.
enum Aim {
    /// On the path, cutting.
    Cut(Course),
    /// Here, while A and C turn.
    Held(Vector3<f64>),
}

impl Aim {
    fn of(path: &PlannedPath) -> Option<Self> {
        match path.weld() {
            Some(_) => Some(Self::Cut(path.path())),
            None => held_tip(path).map(Self::Held),
        }
    }
}

/// Distances of the focus from where it should be, over the length of the cut; and while it is held.
fn focus(run: &Run, limits: &PanelLimits, judgement: &mut Judgement) {
    let along = run.along();
    let tool_paths = run.paths.iter().filter(|(_, path)| path.space == PathSpace::Tool);
    let aims: BTreeMap<u32, Aim> = tool_paths
        .filter_map(|(id, path)| Some((*id, Aim::of(path)?)))
        .collect();
    let (mut cut, mut held) = (Largest::default(), Largest::default());
    let mut line = Line::default();
    // Path of the last sample, and its samples so far.
    let (mut path_id, mut count) = (None, 0);
    for sample in run.samples.iter() {
        if path_id.replace(sample.path_id) != Some(sample.path_id) {
            count = 0;
        }
        count += 1;
        match aims.get(&sample.path_id) {
            Some(Aim::Cut(course)) => {
                let off = beside(course, &sample).filter(|_| sample.beams[0]);
                let Some((off, along_mm)) = off.zip(along.at(sample.path_id, sample.s_mm)) else {
                    // Nothing is drawn where nothing is cut.
                    line.push(GAP);
                    continue;
                };
                cut.add(off);
                if count % THIN == 1 {
                    line.push((along_mm, off));
                }
            }
            Some(Aim::Held(tip)) => held.add((sample.pose.position - tip).norm()),
            None => {}
        }
    }
    let figures = [
        (
            "max_focus_error_cut_mm",
            "focus beside the path while cutting",
            cut,
        ),
        (
            "max_focus_error_turn_mm",
            "focus off its place while A, C turn",
            held,
        ),
    ];
    for (key, text, largest) in figures {
        let figure = |value| Figure::new(key, text, value, "mm").limited(limits.focus_mm.get());
        judgement.figures.extend(largest.0.map(figure));
    }
    judgement.plots.push(Plot {
        file: "focus-error",
        title: "Focus beside the programmed path while A and C turn",
        x: ALONG,
        y: "distance [mm]",
        lines: vec![("focus", line.into_points())],
        limits: vec![limits.focus_mm.get()],
        to_scale: false,
    });
}

/// The focus and the axis of the tool against the true panel while cutting.
fn tool(run: &Run, surface: &CurvedPanel, limits: &PanelLimits, judgement: &mut Judgement) {
    let (mut distance, mut off) = (Largest::default(), Largest::default());
    for sample in run.samples.iter().filter(|sample| sample.beams[0]) {
        if let Some((foot, normal)) = surface.nearest(&sample.pose.position) {
            distance.add((sample.pose.position - foot).norm());
            off.add(angle(&normal, &sample.pose.normal).to_degrees());
        }
    }
    let text = "focus off the true surface while cutting";
    let distance = distance
        .0
        .map(|value| Figure::new("max_focus_off_surface_mm", text, value, "mm"));
    let text = "tool off the true normal while cutting";
    let off = off
        .0
        .map(|value| Figure::new("max_tool_off_normal_deg", text, value, "°"));
    let off = off.map(|figure| figure.limited(limits.tool_off_normal_deg.get()));
    judgement.figures.extend([distance, off].into_iter().flatten());
}

/// Taught normals against the true ones.
fn normals(points: &[TaughtPoint], surface: &CurvedPanel, limits: &PanelLimits, judgement: &mut Judgement) {
    let seen: Vec<(f64, f64)> = points
        .iter()
        .filter_map(|point| {
            let (_, normal) = surface.nearest(&point.position)?;
            let inclination = angle(&normal, &Vector3::z()).to_degrees();
            Some((inclination, angle(&normal, &point.normal).to_degrees()))
        })
        .collect();
    if seen.is_empty() {
        return;
    }
    let largest = |of: fn(&(f64, f64)) -> f64| seen.iter().map(of).fold(0.0, f64::max);
    let squares: f64 = seen.iter().map(|(_, error)| error * error).sum();
    let figure = |key, text, value| Figure::new(key, text, value, "°");
    let limit = limits.normal_deg.get();
    judgement.figures.extend([
        figure(
            "max_normal_error_deg",
            "taught normal off the true one",
            largest(|seen| seen.1),
        )
        .limited(limit),
        figure(
            "rms_normal_error_deg",
            "taught normal off the true one, rms",
            libm::sqrt(squares / seen.len() as f64),
        ),
        figure(
            "max_inclination_deg",
            "steepest taught point",
            largest(|seen| seen.0),
        ),
    ]);
    let mut over_inclination = seen;
    over_inclination.sort_by(|a, b| a.0.total_cmp(&b.0));
    judgement.plots.push(Plot {
        file: "normal-error",
        title: "Error of the taught normals over the inclination of the surface",
        x: "inclination [deg]",
        y: "error [deg]",
        lines: vec![("taught", over_inclination)],
        limits: vec![limit],
        to_scale: false,
    });
}

/// How fast it was taught, by the machine's clock.
fn pace(points: &[TaughtPoint], judgement: &mut Judgement) {
    let time: f64 = points.iter().map(|point| point.time_s).sum();
    if time > 0.0 {
        let value = points.len() as f64 * 60.0 / time;
        let text = "taught points a minute";
        let figure = Figure::new("taught_points_per_min", text, value, "/min");
        judgement.figures.push(figure);
    }
}

/// The largest of some values.
#[derive(Clone, Copy, Debug, Default)]
struct Largest(Option<f64>);

impl Largest {
    fn add(&mut self, value: f64) {
        self.0 = Some(self.0.map_or(value, |before| before.max(value)));
    }
}

/// Distance of the focus from the nearest place of the path \[mm\].
fn beside(path: &Course, sample: &RunSample) -> Option<f64> {
    let mut s = sample.s_mm;
    for _ in 0..STEPS {
        let point = path.at(s)?;
        let place = |of: &[f64]| Vector3::new(of[0], of[1], of[2]);
        let (apart, along) = (sample.pose.position - place(&point.value), place(&point.first));
        let step = apart.dot(&along) / along.norm_squared();
        if step.abs() < FOUND {
            return Some(apart.norm());
        }
        s += step;
    }
    None
}

/// The place of the tip of a path that only turns the tool \[mm\].
fn held_tip(path: &PlannedPath) -> Option<Vector3<f64>> {
    let (first, last) = (path.knots.first()?, path.knots.last()?);
    let vector = |values: &[f64], from: usize| Vector3::new(values[from], values[from + 1], values[from + 2]);
    let tip = vector(&first.value, 0);
    let held = path
        .knots
        .iter()
        .all(|knot| (vector(&knot.value, 0) - tip).norm() < HELD);
    let turned = angle(&vector(&first.value, 6), &vector(&last.value, 6)) > TURNED;
    (held && turned).then_some(tip)
}
