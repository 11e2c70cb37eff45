//! Paths one after the other through the planner, a millisecond at a time.

use super::around::{Around, HeldTo};
use super::differences::{Differences, Rates};
use super::figures::{Rulers, row_unit};
use super::slowed::{Tick, Watch};
use super::stream::{ARRIVED, Stream, dwell_ticks, ticks_between};
use super::{DryRun, DryRunError, Highest, PATH, PathFigures, ROWS, Slowed, Stop, Trace};
use crate::path::PlannedPath;
use config::machine::MachineFile;
use nc::Motion;
use shared::io::AXES;
use shared::kinematics::{AXIS_UNIT, AxisLimits};
use shared::motion::Machine;
use shared::ticks::PATH_PERIOD_S;
use shared::trajectory::{BoardPlanner, Output};

/// A planner that goes nowhere for so many ticks never will.
pub(super) const PATIENCE: u32 = 60_000;
/// What moves less is at rest [units of people per second].
pub(super) const REST: f64 = 1e-6;

/// Extremes of speed, acceleration and jerk on one path.
#[derive(Default)]
struct PathExtremes {
    highest: Highest,
    rulers: Rulers,
}

/// A machine that runs paths without boards.
pub struct Runner {
    board: Machine,
    axis_limits: [AxisLimits; AXES],
    tracker: bool,
    factor: f64,
    planner: Box<BoardPlanner>,
    /// Where the axes stand (mm, rad).
    axes: [f64; AXES],
    differences: Differences,
    /// Ticks so far.
    ticks: u64,
    /// Ticks at rest, and the line of the last motion.
    resting: u64,
    line: u32,
    result: DryRun,
}

impl Runner {
    /// With the axes of `machine` at rest at `from` (mm, degrees), at the feed override `factor`.
    pub fn new(machine: &MachineFile, from: &[f64; AXES], factor: f64) -> Result<Self, DryRunError> {
        let axes: [f64; AXES] = std::array::from_fn(|axis| from[axis] * AXIS_UNIT[axis]);
        let axis_limits = AxisLimits::build_all(&machine.motion.axes)?;
        let fitted = machine.motion.kinematics.fitted();
        let for_people = |axis: usize| {
            let AxisLimits {
                velocity,
                acceleration,
                jerk,
                ..
            } = axis_limits[axis];
            let limits = [velocity, acceleration, jerk];
            limits.map(|limit| {
                if fitted[axis] {
                    limit / AXIS_UNIT[axis]
                } else {
                    0.0
                }
            })
        };
        Ok(Self {
            board: Machine::build(&machine.motion)?.0,
            tracker: machine.tracking.is_some(),
            factor,
            planner: Box::new(BoardPlanner::new()),
            axes,
            differences: Differences::at_rest(positions(0.0, &axes)),
            ticks: 0,
            resting: 0,
            line: 0,
            result: DryRun {
                duration_s: 0.0,
                motion_s: 0.0,
                feed_override: factor,
                length_mm: 0.0,
                longest_stop: None,
                highest: Highest::default(),
                slowed: Slowed::default(),
                fitted,
                axis_limits: std::array::from_fn(for_people),
                paths: Vec::new(),
                trace: Trace::default(),
            },
            axis_limits,
        })
    }

    /// Where the axes stand (mm, degrees).
    pub fn axes(&self) -> [f64; AXES] {
        std::array::from_fn(|axis| self.axes[axis] / AXIS_UNIT[axis])
    }

    /// Runs one path from where the axes stand.
    pub fn run(&mut self, path: &PlannedPath, parking: bool) -> Result<(), DryRunError> {
        let (acceleration, jerk) = (path.limits.acceleration, path.limits.jerk);
        let limits = self.board.plan_limits(&path.path_limits());
        self.planner.start(&limits, path.space, path.start_s, &self.axes);
        self.planner
            .set_override(if path.fixed_feed { 1.0 } else { self.factor });
        let mut stream = Stream::new(path.given_legs());
        let mut around = Around::from(path.start_s);
        let requests = stream.begin(&mut self.planner, |element| around.add(element))?;
        self.wait(match self.result.paths.last() {
            Some(_) => ticks_between(path, requests, self.tracker),
            None => dwell_ticks(path),
        });
        let start = self.ticks;
        let mut extremes = PathExtremes::default();
        let mut watch = (path.motion == Motion::Feed).then(Watch::default);
        let filter = (limits.filter_s(), limits.filter_off());
        self.differences.count_from(PATH, path.start_s);
        let (mut arrived, mut idle, mut last_s) = (0, 0, path.start_s);
        while arrived < ARRIVED {
            let output = self.planner.tick(&self.board.kinematics)?;
            let feed = around.feed_at(output.along.s) * self.factor;
            let v = self.tick(&output, [feed, acceleration, jerk], &mut extremes);
            if let Some(watch) = &mut watch {
                let tick = Tick {
                    s: output.along.s,
                    v,
                    feed,
                    line: output.line,
                };
                let held = HeldTo {
                    space: path.space,
                    kinematics: &self.board.kinematics,
                    axes: &self.axis_limits,
                    filter,
                    near: &self.axes,
                };
                let why = |low: &Tick| around.limit(low.s, low.v, &held);
                let number = self.result.paths.len() + 1;
                let rests = v.abs() <= REST && around.is_stop(tick.s);
                watch.tick(number, &tick, rests, &mut self.result.slowed, why);
            }
            stream.tick(&mut self.planner, |element| around.add(element))?;
            arrived = if output.at_rest { arrived + 1 } else { 0 };
            idle = if output.along.s > last_s { 0 } else { idle + 1 };
            last_s = output.along.s;
            if idle > PATIENCE {
                return Err(DryRunError::Stuck {
                    line: output.line,
                    path: self.result.paths.len() + 1,
                    s_mm: last_s,
                });
            }
        }
        self.result.highest.take(&extremes.highest);
        let lines = path.first_and_last_line();
        self.result.paths.push(PathFigures {
            motion: path.motion,
            parking,
            lines,
            length_mm: path.length_mm() - path.start_s,
            dwell_s: path.dwell_before_s,
            start_s: start as f64 * PATH_PERIOD_S,
            duration_s: (self.ticks - start) as f64 * PATH_PERIOD_S,
            corner_deg: path.corner_deg,
            highest: extremes.highest,
            ruled: extremes.rulers.of(self.ticks - start),
        });
        Ok(())
    }

    /// One tick of a path, whose speed, acceleration and jerk may be `path`; the speed along it \[mm/s\].
    fn tick(&mut self, output: &Output, path: Rates, extremes: &mut PathExtremes) -> f64 {
        self.axes = output.axes.position;
        let rates = self.differences.push(&positions(output.along.s, &self.axes));
        let limits: [Rates; ROWS] = std::array::from_fn(|row| match row {
            PATH => path,
            axis => {
                let limits = &self.axis_limits[axis - 1];
                [limits.velocity, limits.acceleration, limits.jerk]
            }
        });
        let time_s = self.ticks as f64 * PATH_PERIOD_S;
        let ruler = extremes.highest.tick(&rates, &limits, output.line, time_s);
        extremes.rulers.count(ruler);
        let moves = (0..ROWS).any(|row| rates[row][0].abs() > REST * row_unit(row));
        if moves {
            self.end_stop();
            self.line = output.line;
        } else {
            self.resting += 1;
        }
        self.record(&rates, path);
        rates[PATH][0]
    }

    /// Stands for so many ticks.
    fn wait(&mut self, ticks: u64) {
        self.resting += ticks;
        let trace = &mut self.result.trace;
        let envelopes = trace.rows.iter_mut().flatten().chain(&mut trace.path_limits);
        envelopes.for_each(|envelope| envelope.push_times(0.0, ticks));
        self.ticks += ticks;
    }

    fn record(&mut self, rates: &[Rates; ROWS], path: Rates) {
        let trace = &mut self.result.trace;
        for (row, envelopes) in trace.rows.iter_mut().enumerate() {
            for (envelope, value) in envelopes.iter_mut().zip(rates[row]) {
                envelope.push(value / row_unit(row));
            }
        }
        for (envelope, value) in trace.path_limits.iter_mut().zip(path) {
            envelope.push(value);
        }
        self.ticks += 1;
    }

    fn end_stop(&mut self) {
        let resting = std::mem::take(&mut self.resting);
        let stop = Stop {
            start_s: (self.ticks - resting) as f64 * PATH_PERIOD_S,
            duration_s: resting as f64 * PATH_PERIOD_S,
            after_line: self.line,
        };
        // Before the first motion is not between two.
        let longest = self.result.longest_stop.map_or(0.0, |stop| stop.duration_s);
        if stop.start_s > 0.0 && stop.duration_s > longest {
            self.result.longest_stop = Some(stop);
        }
    }

    /// All that was seen.
    pub fn finish(mut self) -> DryRun {
        self.result.duration_s = self.ticks as f64 * PATH_PERIOD_S;
        self.result.motion_s = self.result.paths.iter().map(|path| path.duration_s).sum();
        self.result.length_mm = self.result.paths.iter().map(|path| path.length_mm).sum();
        self.result
    }
}

fn positions(s: f64, axes: &[f64; AXES]) -> [f64; ROWS] {
    std::array::from_fn(|row| match row {
        PATH => s,
        axis => axes[axis - 1],
    })
}
