//! What a program check needs of a dry run: durations, and where the feed is not kept. It takes no time in proportion to the
//! seconds of the paths: where the feed is kept for certain, by geometry, the planner is not run.

mod calm;
mod part;
mod stretches;
#[cfg(test)]
mod tests;

use super::around::{Around, HeldTo};
use super::run::{PATIENCE, REST};
use super::slowed::{Tick, Watch};
use super::stream::{ARRIVED, Stream, dwell_ticks, ticks_between};
use super::{DryRunError, Slowed};
use crate::path::{PlannedPath, Planner};
use calm::Calm;
use config::machine::MachineFile;
use nc::Motion;
use shared::io::AXES;
use shared::kinematics::{AXIS_UNIT, AxisLimits};
use shared::motion::Machine;
use shared::ticks::PATH_PERIOD_S;
use shared::trajectory::{BoardPlanner, PlanLimits};
use stretches::{Start, Stretches};

/// Where a stretch begins or stops to count the machine has at least this part of its feed.
const KEPT: f64 = 0.998;
/// The first so many seconds of a program are run in any case: short programs are forecast as a dry run does.
const WHOLE_S: f64 = 180.0;

/// Durations, and where the feed is not kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forecast {
    /// From the end of homing to the park position \[s\].
    pub duration_s: f64,
    /// On each path \[s\], those of parking last.
    pub paths_s: Vec<f64>,
    /// Where the feed is not kept.
    pub slowed: Slowed,
}

/// What [`super::run`] says of `paths` at the programmed feed, as far as a [`Forecast`] has it.
///
/// # Errors
/// As [`super::run`].
pub fn forecast(
    machine: &MachineFile,
    planner: &Planner,
    paths: &[PlannedPath],
) -> Result<Forecast, DryRunError> {
    forecast_from(machine, planner, paths, WHOLE_S)
}

/// The same; the first `whole_s` \[s\] are run in any case.
fn forecast_from(
    machine: &MachineFile,
    planner: &Planner,
    paths: &[PlannedPath],
    whole_s: f64,
) -> Result<Forecast, DryRunError> {
    let board = Machine::build(&machine.motion)?.0;
    let axis_limits = AxisLimits::build_all(&machine.motion.axes)?;
    let homed = machine.homed_axes();
    let mut runner = Runner {
        board: &board,
        axis_limits: &axis_limits,
        tracker: machine.tracking.is_some(),
        planner: Box::new(BoardPlanner::new()),
        axes: std::array::from_fn(|axis| homed[axis] * AXIS_UNIT[axis]),
        whole_s,
        ticks: 0.0,
        forecast: Forecast::default(),
    };
    for path in paths {
        runner.run(path)?;
    }
    let stands = std::array::from_fn(|axis| runner.axes[axis] / AXIS_UNIT[axis]);
    for path in planner.park(&stands)? {
        runner.run(&path)?;
    }
    runner.forecast.duration_s = runner.ticks * PATH_PERIOD_S;
    Ok(runner.forecast)
}

struct Runner<'a> {
    board: &'a Machine,
    axis_limits: &'a [AxisLimits; AXES],
    tracker: bool,
    planner: Box<BoardPlanner>,
    /// Where the axes stand (mm, rad).
    axes: [f64; AXES],
    /// So much of the program is run in any case \[s\].
    whole_s: f64,
    /// Ticks so far.
    ticks: f64,
    forecast: Forecast,
}

/// Why a path has no forecast.
enum Failed {
    /// A feed was not kept where it should be for certain.
    Uncertain,
    Error(DryRunError),
}

impl<E: Into<DryRunError>> From<E> for Failed {
    fn from(error: E) -> Self {
        Self::Error(error.into())
    }
}

impl Runner<'_> {
    /// Runs one path from where the axes stand.
    fn run(&mut self, path: &PlannedPath) -> Result<(), DryRunError> {
        let before = (self.axes, self.forecast.slowed.clone());
        let ticks = match self.pass(path, path.motion == Motion::Feed) {
            Err(Failed::Uncertain) => {
                (self.axes, self.forecast.slowed) = before;
                self.pass(path, false)
            }
            passed => passed,
        };
        let (waits, runs) = match ticks {
            Ok(ticks) => ticks,
            Err(Failed::Error(error)) => return Err(error),
            Err(Failed::Uncertain) => unreachable!("nothing was left out"),
        };
        self.ticks += waits as f64 + runs;
        self.forecast.paths_s.push(runs * PATH_PERIOD_S);
        Ok(())
    }

    /// Ticks before a path and on it, of which all is run, or what is not calm only.
    fn pass(&mut self, path: &PlannedPath, leave_out: bool) -> Result<(u64, f64), Failed> {
        let limits = self.board.plan_limits(&path.path_limits());
        let kinematics = &self.board.kinematics;
        let calm = || Calm::new(kinematics, self.axis_limits, path.space, &limits, &self.axes);
        let calm = leave_out.then(calm);
        let mut start = Start {
            s: path.start_s,
            axes: self.axes,
            counts_from: path.start_s,
            left_out_s: 0.0,
        };
        let whole_s = self.whole_s - self.ticks * PATH_PERIOD_S;
        let mut stretches = Stretches::new(path.given_ahead(), calm, path.start_s, whole_s);
        let (mut waits, mut ticks) = (None, 0.0);
        loop {
            self.planner.start(&limits, path.space, start.s, &start.axes);
            let mut stream = Stream::new(&mut stretches);
            let mut around = Around::from(start.s);
            let requests = stream.begin(&mut self.planner, |element| around.add(element))?;
            if waits.is_none() {
                let requests = match stream.legs().counts_to() {
                    None => requests,
                    Some(_) => requests_of(path, &limits)?,
                };
                waits = Some(match self.forecast.paths_s.last() {
                    Some(_) => ticks_between(path, requests, self.tracker),
                    None => dwell_ticks(path),
                });
            }
            let held = HeldTo {
                space: path.space,
                kinematics,
                axes: self.axis_limits,
                filter: (limits.filter_s(), limits.filter_off()),
                near: &start.axes,
            };
            let run = Run {
                path: self.forecast.paths_s.len() + 1,
                planner: &mut self.planner,
                held,
                slowed: (path.motion == Motion::Feed).then_some(&mut self.forecast.slowed),
            };
            let (counted, axes) = run.run(&mut stream, &mut around, &start)?;
            ticks += counted;
            self.axes = axes;
            let Some(next) = stretches.go_on()? else {
                return Ok((waits.unwrap_or_default(), ticks.round()));
            };
            if next.left_out_s < 0.0 {
                return Err(Failed::Uncertain);
            }
            ticks += next.left_out_s / PATH_PERIOD_S;
            start = next;
        }
    }
}

/// Requests that the PC needs until a path begins.
fn requests_of(path: &PlannedPath, limits: &PlanLimits) -> Result<u32, DryRunError> {
    let mut planner = Box::new(BoardPlanner::new());
    planner.start(limits, path.space, path.start_s, &[0.0; AXES]);
    Stream::new(path.given_legs()).begin(&mut planner, |_| ())
}

/// One stretch on its way through the planner.
struct Run<'a> {
    path: usize,
    planner: &'a mut BoardPlanner,
    held: HeldTo<'a>,
    /// Where the feed is not kept, if that is of interest.
    slowed: Option<&'a mut Slowed>,
}

impl Run<'_> {
    /// The ticks that count, and where the axes are then (mm, rad).
    fn run(
        mut self,
        stream: &mut Stream<&mut Stretches>,
        around: &mut Around,
        start: &Start,
    ) -> Result<(f64, [f64; AXES]), Failed> {
        let mut watch = Watch::default();
        let (mut arrived, mut idle, mut last_s, mut tick) = (0, 0, start.s, 0.0);
        let mut near = *self.held.near;
        // The first stretch counts from its beginning, and the last one to its end.
        let mut began = (start.counts_from <= start.s).then_some(0.0);
        while arrived < ARRIVED {
            let output = self.planner.tick(self.held.kinematics)?;
            let s = output.along.s;
            let v = (s - last_s) / PATH_PERIOD_S;
            let feed = around.feed_at(s);
            let passes = |place: f64| match v >= KEPT * feed {
                true => Ok(tick + (place - last_s) / (s - last_s)),
                false => Err(Failed::Uncertain),
            };
            if began.is_none() && s >= start.counts_from {
                began = Some(passes(start.counts_from)?);
            }
            if let (Some(end), Some(began)) = (stream.legs().counts_to(), began)
                && s >= end
            {
                return Ok((passes(end)? - began, output.axes.position));
            }
            tick += 1.0;
            if let (Some(slowed), Some(_)) = (&mut self.slowed, began) {
                let seen = Tick {
                    s,
                    v,
                    feed,
                    line: output.line,
                };
                near = output.axes.position;
                let held = HeldTo {
                    near: &near,
                    ..self.held
                };
                let rests = v.abs() <= REST && around.is_stop(s);
                watch.tick(self.path, &seen, rests, slowed, |low| {
                    around.limit(low.s, low.v, &held)
                });
            }
            stream.tick(self.planner, |element| around.add(element))?;
            arrived = if output.at_rest { arrived + 1 } else { 0 };
            idle = if s > last_s { 0 } else { idle + 1 };
            last_s = s;
            if idle > PATIENCE {
                let (line, path, s_mm) = (output.line, self.path, s);
                return Err(DryRunError::Stuck { line, path, s_mm }.into());
            }
            near = output.axes.position;
        }
        Ok((tick - began.unwrap_or_default(), near))
    }
}
