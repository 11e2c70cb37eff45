//! A bead of deposited wire along a NURBS, as even as the process wants it (mathematics 3).
//!
//! The torch stands upright and the positioner lies flat. The bead is laid at one speed inside the process window
//! if curve and machine allow one; otherwise at the lowest speed of the window, and slower only in the corners
//! where the machine cannot do that. It begins and ends at speed: see [`route::Route`].

mod curve_file;
mod error;
mod figures;
mod judge;
mod length_table;
mod notes;
mod points;
mod program;
mod route;
mod speed;
mod stations;
#[cfg(test)]
mod tests;
pub mod window;

use crate::limits::SPEED_DIP;
use crate::{Judgement, Kind, Limit, PartContext, Percent, Plan, Run};
use cam::path::{PlannedPath, Planner};
use config::in_range;
use curve_file::CurveFile;
pub use curve_file::check_curve;
use curves::nurbs::Curve;
use error::BeadError;
use nalgebra::Vector3;
use nc::{Motion, Options, interpret};
use points::LONGEST;
use program::Pass;
use route::Route;
use serde::Deserialize;
use shared::kinematics::Kinematics;
use speed::FeedStep;
use std::borrow::Cow;
use std::path::PathBuf;
use window::ProcessWindow;

/// Room between a bead and a torch that travels \[mm\].
const CLEARANCE: f64 = 10.0;
/// The path of the boards is this near to the NURBS \[mm\], or there is no program.
const EXACT: f64 = 2e-3;
/// Most layers of one program.
const MOST_LAYERS: u32 = 1000;
/// A feed that any machine can follow, to see what a path asks of it \[mm/min\].
const CREEP: f64 = 0.1;

/// A curve and how to lay wire along it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bead {
    /// The curve in a JSON file: degree, control_points_mm, weights, knots.
    nurbs_file: Option<PathBuf>,
    /// Or the same as a table.
    nurbs: Option<CurveFile>,
    /// Lowest and highest speed at which the process works \[mm/s\]; that of the machine if it is left out.
    window_mm_s: Option<[f64; 2]>,
    /// Power of the arc \[W\].
    power_w: f64,
    /// Layers upon each other.
    #[serde(default = "Bead::one_layer")]
    layers: u32,
    /// What each layer adds to the height \[mm\].
    #[serde(default)]
    layer_height_mm: f64,
    /// Way without arc on which the tip gets up to speed, and to rest again \[mm\].
    lead_mm: f64,
    /// A closed bead continues over its beginning for this long \[mm\].
    #[serde(default)]
    overlap_mm: f64,
    /// What the turntable does.
    #[serde(default)]
    attitude: Attitude,
    /// What the bead is judged by.
    #[serde(default)]
    limits: BeadLimits,
}

/// What a run is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct BeadLimits {
    /// What the tip may be off the curve \[mm\].
    contour_mm: Limit,
    /// How much of the length may be laid outside the process window \[%\].
    outside_window_percent: Percent,
    /// Most that the speed may fall below the feed with the beam on \[%\].
    speed_dip_percent: Percent,
}

impl Default for BeadLimits {
    fn default() -> Self {
        Self {
            contour_mm: Limit::new(0.05),
            outside_window_percent: Percent::new(1.0),
            speed_dip_percent: SPEED_DIP,
        }
    }
}

/// What the turntable does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Attitude {
    /// It stands still at 0°.
    #[default]
    Constant,
    /// It turns the direction of travel into the machine's X.
    Tangent,
}

/// One layer.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layer {
    /// Height above the curve \[mm\].
    height: f64,
}

impl Layer {
    /// A point of the curve in this layer.
    fn lift(&self, p: &Vector3<f64>) -> Vector3<f64> {
        p + Vector3::z() * self.height
    }

    /// A point of this layer on the curve.
    fn lower(&self, p: &Vector3<f64>) -> Vector3<f64> {
        p - Vector3::z() * self.height
    }
}

impl Bead {
    fn one_layer() -> u32 {
        1
    }

    fn curve(&self, context: &PartContext) -> Result<(Cow<'_, CurveFile>, String), BeadError> {
        match (&self.nurbs_file, &self.nurbs) {
            (Some(file), None) => {
                let path = context.directory.join(file);
                Ok((Cow::Owned(CurveFile::read(&path)?), path.display().to_string()))
            }
            (None, Some(table)) => Ok((Cow::Borrowed(table), "[bead.nurbs]".to_owned())),
            _ => Err(BeadError::OneCurve),
        }
    }

    fn window(&self, context: &PartContext) -> Result<ProcessWindow, BeadError> {
        let of_machine = context
            .machine
            .process
            .map(|process| [process.min_speed_mm_s, process.max_speed_mm_s]);
        let [low, high] = self.window_mm_s.or(of_machine).ok_or(BeadError::NoWindow)?;
        let window = ProcessWindow { low, high };
        window.apply(&mut [high]).map_err(BeadError::Window)?;
        Ok(window)
    }

    fn layers(&self) -> impl Iterator<Item = Layer> {
        let height = self.layer_height_mm;
        (0..self.layers).map(move |i| Layer {
            height: f64::from(i) * height,
        })
    }

    fn check(&self) -> Result<(), BeadError> {
        let several = self.layers > 1;
        let checks = [
            ("power_w", self.power_w, self.power_w > 0.0, "above 0"),
            (
                "layers",
                f64::from(self.layers),
                (1..=MOST_LAYERS).contains(&self.layers),
                "at least 1, and at most 1000 in one program",
            ),
            (
                "layer_height_mm",
                self.layer_height_mm,
                !several || self.layer_height_mm > 0.0,
                "above 0 where there are several layers",
            ),
            (
                "lead_mm",
                self.lead_mm,
                self.lead_mm > 0.0 && self.lead_mm <= LONGEST,
                "above 0, and no longer than a bead can be",
            ),
            ("overlap_mm", self.overlap_mm, self.overlap_mm >= 0.0, "0 or more"),
        ];
        for (key, value, ok, requirement) in checks {
            in_range(key, value, ok, requirement)?;
        }
        Ok(())
    }
}

impl Kind for Bead {
    fn plan(&self, context: &PartContext) -> anyhow::Result<Plan> {
        self.check()?;
        let window = self.window(context)?;
        let (curve, name) = self.curve(context)?;
        let route = Route::build(curve.nurbs(&name)?, &name, self.lead_mm, self.overlap_mm)?;
        let planner = Planner::build(context.machine)?;
        let places = points::choose(&route, self.attitude)?;
        let creep = FeedStep {
            target: 0,
            mm_min: CREEP,
        };
        let mut passes = Vec::new();
        for layer in self.layers() {
            passes.push(Pass {
                stations: stations::stations(&route, &places, &layer, self.attitude, context, &planner)?,
                feeds: vec![creep],
            });
        }
        self.check_height(&passes, context)?;

        // The path that the boards run shows its error, and what it requires of the drives.
        let draft = program::write(self, &passes, route.bead(), context, &[]);
        let drafts = feed_paths(&planner, context, &draft)?;
        let mut plans = Vec::new();
        let mut deviation = 0.0_f64;
        for (((pass, path), layer), number) in passes.iter_mut().zip(&drafts).zip(self.layers()).zip(1..) {
            if path.knots.is_empty() {
                let points = pass.stations.len();
                return Err(BeadError::NotSmooth {
                    layer: number,
                    points,
                }
                .into());
            }
            deviation = deviation.max(deviation_of(path, &route, &layer)?);
            let limits = speed::limits(path, context.machine, planner.kinematics(), window.high)?;
            let targets: Vec<f64> = path.knots[1..].iter().map(|knot| knot.s_mm).collect();
            let plan = speed::plan(&limits, &targets, &window)?;
            pass.feeds.clone_from(&plan.feeds);
            plans.push(plan);
        }
        let mut notes = notes::of_route(self, &route, places.len());
        notes.push(format!(
            "the path through them is within {deviation:.1e} mm of the NURBS"
        ));
        notes.extend(notes::of_speeds(&plans, &window, &context.machine.planning));
        let program = program::write(self, &passes, route.bead(), context, &notes);
        for path in feed_paths(&planner, context, &program)? {
            self.check_lead(&path)?;
        }
        Ok(Plan { program, notes })
    }

    fn check_judging(&self, context: &PartContext, _: &Kinematics) -> anyhow::Result<()> {
        self.with_route(context, |_, _| Ok(()))
    }

    fn judge(&self, context: &PartContext, run: &Run) -> anyhow::Result<Judgement> {
        self.with_route(context, |window, route| {
            judge::judge(route, self.layers(), window, &self.limits, run)
        })
    }

    fn speed_dip(&self) -> Option<Percent> {
        Some(self.limits.speed_dip_percent)
    }
}

impl Bead {
    /// Does `with` by speeds and route that a run is judged by.
    fn with_route<T>(
        &self,
        context: &PartContext,
        with: impl FnOnce(&ProcessWindow, &Route) -> anyhow::Result<T>,
    ) -> anyhow::Result<T> {
        let window = self.window(context)?;
        let (curve, name) = self.curve(context)?;
        let route = Route::build(curve.nurbs(&name)?, &name, self.lead_mm, self.overlap_mm)?;
        with(&window, &route)
    }
}

/// The paths of the layers, as the boards will run them.
fn feed_paths(planner: &Planner, context: &PartContext, program: &str) -> anyhow::Result<Vec<PlannedPath>> {
    let program = interpret(program, Options::default())?;
    let paths = planner.program(&program, &context.machine.planning.park_axes(), None)?;
    Ok(paths
        .into_iter()
        .filter(|path| path.motion == Motion::Feed)
        .collect())
}

/// Largest distance of a path from the NURBS of its layer \[mm\].
fn deviation_of(planned: &PlannedPath, route: &Route, layer: &Layer) -> Result<f64, BeadError> {
    /// Places in each span.
    const LOOKS: usize = 6;
    let path = planned.path();
    let mut largest = 0.0_f64;
    for span in planned.knots.windows(2) {
        for i in 0..LOOKS {
            let part = (i as f64 + 0.5) / LOOKS as f64;
            let s = span[0].s_mm + (span[1].s_mm - span[0].s_mm) * part;
            let Some(point) = path.at(s) else { continue };
            let [x, y, z, ..] = point.value;
            let p = layer.lower(&Vector3::new(x, y, z));
            let distance = (route.point(route.nearest(&p, s)) - p).norm();
            if distance > EXACT {
                return Err(BeadError::Inexact { distance, x, y, z });
            }
            largest = largest.max(distance);
        }
    }
    Ok(largest)
}

impl Bead {
    fn check_height(&self, passes: &[Pass], context: &PartContext) -> Result<(), BeadError> {
        let tips = passes.iter().flat_map(|pass| &pass.stations);
        let top = tips
            .map(|station| station.tip.z)
            .fold(f64::NEG_INFINITY, f64::max);
        if context.machine.planning.safe_height_mm < top + CLEARANCE {
            let clearance = CLEARANCE;
            return Err(BeadError::SafeHeight { top, clearance });
        }
        Ok(())
    }

    fn check_lead(&self, path: &PlannedPath) -> Result<(), BeadError> {
        let (lead, speed, needed) = (self.lead_mm, path.limits.velocity, path.limits.ramp());
        if lead < needed {
            return Err(BeadError::LeadTooShort { lead, needed, speed });
        }
        Ok(())
    }
}
