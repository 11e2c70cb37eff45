//! A test of positioning accuracy: an axis goes to targets from both sides and rests at each (ISO 230-2).

use crate::rests::{NotSeen, rests};
use crate::test_program::program_from_home;
use cam::path::{PathError, Planner};
use config::machine::MachineFile;
use host_link::geometry::MachineGeometry;
use host_link::record::{MachinePosition, Recorded};
use nc::{NcError, Program};
use shared::io::{AXES, AXIS_NAMES, MOTOR_AXIS, MOTORS};
use shared::kinematics::AXIS_UNIT;
use shared::protocol::MotionSample;
use std::fmt::Write;
use thiserror::Error;

/// Room between the outer targets and the ends of travel (mm or degrees).
const ROOM: f64 = 5.0;
/// So far beyond the outer targets the axis turns round (mm or degrees).
const BEYOND: f64 = 2.0;
/// At a target, where the board sees the axis so near to it (mm or degrees).
const THERE: f64 = 0.05;

/// What to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositioningTest {
    /// Index of the axis.
    pub axis: usize,
    /// Targets along it.
    pub targets: usize,
    /// How often to go there and back.
    pub runs: usize,
    /// How long to rest at each target \[s\].
    pub dwell_s: f64,
}

/// A test of an axis of a machine.
#[derive(Clone, Debug)]
pub struct PlannedPositioning {
    /// From target to target.
    pub program: Program,
    /// What was asked for.
    pub test: PositioningTest,
    /// Where it rests, in order, and whether it comes there from above (mm or degrees).
    pub rests: Vec<(f64, bool)>,
}

/// Why there is no test.
#[derive(Debug, Error)]
pub enum NoTest {
    /// The axis is missing.
    #[error("the machine has no axis {0}")]
    NoAxis(&'static str),
    /// There is no room.
    #[error("the travel of {axis} is {travel}, too short for targets that are {ROOM} from its ends")]
    NoRoom {
        /// The axis.
        axis: &'static str,
        /// Its travel (mm or degrees).
        travel: f64,
    },
    /// Its program makes no sense.
    #[error(transparent)]
    Program(#[from] NcError),
    /// The machine cannot follow it.
    #[error(transparent)]
    Path(#[from] PathError),
}

impl PositioningTest {
    /// Plans it over the whole travel, with the other axes at their reference marks.
    ///
    /// # Errors
    /// Why the machine cannot do it.
    pub fn plan(self, machine: &MachineFile, planner: &Planner) -> Result<PlannedPositioning, NoTest> {
        let name = AXIS_NAMES[self.axis];
        let limits = machine.motion.axes[self.axis]
            .as_ref()
            .ok_or(NoTest::NoAxis(name))?;
        let (first, last) = (limits.travel_min + ROOM, limits.travel_max - ROOM);
        if first + ROOM > last {
            return Err(NoTest::NoRoom {
                axis: name,
                travel: limits.travel_max - limits.travel_min,
            });
        }
        let step = (last - first) / (self.targets - 1) as f64;
        let there: Vec<_> = (0..self.targets).map(|k| first + step * k as f64).collect();
        let (mut text, mut rests) = ("G21 G90 G94\n".to_owned(), Vec::new());
        // A text is always written.
        let mut go = |place: f64, dwell: f64| {
            let _ = writeln!(text, "G53 G0 {name}{place:.6}");
            if dwell > 0.0 {
                let _ = writeln!(text, "G4 P{dwell}");
            }
        };
        go(first - BEYOND, 0.0);
        for _ in 0..self.runs {
            for target in &there {
                go(*target, self.dwell_s);
                rests.push((*target, false));
            }
            go(last + BEYOND, 0.0);
            for target in there.iter().rev() {
                go(*target, self.dwell_s);
                rests.push((*target, true));
            }
            go(first - BEYOND, 0.0);
        }
        text.push_str("M2\n");
        let program = program_from_home::<NoTest>(&text, machine, planner)?;
        Ok(PlannedPositioning {
            program,
            test: self,
            rests,
        })
    }
}

impl PlannedPositioning {
    /// By how much axes and motors were beside their places at every rest; `None` where the record has no truth, as on a real machine.
    ///
    /// # Errors
    /// A rest is not in the record.
    pub fn seen(&self, geometry: &MachineGeometry, record: &Recorded) -> Result<Option<Vec<Rest>>, NotSeen> {
        let axis = self.test.axis;
        let is_there = |number: usize, told: &[f64; AXES]| {
            (told[axis] / AXIS_UNIT[axis] - self.rests[number].0).abs() < THERE
        };
        let (mut seen, mut has_truth) = (Vec::new(), true);
        rests(record, self.rests.len(), is_there, |number, samples| {
            let all: Option<Vec<Rest>> = samples
                .iter()
                .map(|sample| self.rest(number, geometry, sample))
                .collect();
            match all {
                Some(all) => seen.push(Rest::mean(&all)),
                None => has_truth = false,
            }
        })?;
        Ok(has_truth.then_some(seen))
    }

    /// Of one sample; `None` without truth.
    fn rest(&self, number: usize, geometry: &MachineGeometry, sample: &MotionSample) -> Option<Rest> {
        let (target, backwards) = self.rests[number];
        let position = MachinePosition::of(sample);
        let MachinePosition::Motors(motors) = position else {
            return None;
        };
        let mut aimed = in_units(&sample.axes);
        aimed[self.test.axis] = target;
        let actual = in_units(&geometry.axes(&position));
        Some(Rest {
            target,
            backwards,
            axes: core::array::from_fn(|axis| actual[axis] - aimed[axis]),
            motors: core::array::from_fn(|motor| {
                let axis = MOTOR_AXIS[motor];
                motors[motor] / AXIS_UNIT[axis] - aimed[axis]
            }),
        })
    }
}

/// A rest at a target, in the units of machine files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Where the axis was sent.
    pub target: f64,
    /// It came from above.
    pub backwards: bool,
    /// By how much each axis was beside its place: the one that is tested beside the target, the others beside what the board said.
    pub axes: [f64; AXES],
    /// The same of what each motor moves; of two on an axis, with half of the square offset.
    pub motors: [f64; MOTORS],
}

impl Rest {
    /// Of its samples.
    fn mean(samples: &[Self]) -> Self {
        let count = samples.len() as f64;
        let mean = |of: &dyn Fn(&Self) -> f64| samples.iter().map(of).sum::<f64>() / count;
        Self {
            axes: core::array::from_fn(|axis| mean(&|rest| rest.axes[axis])),
            motors: core::array::from_fn(|motor| mean(&|rest| rest.motors[motor])),
            ..samples[0]
        }
    }
}

/// As machine files have them (mm, degrees).
fn in_units(axes: &[f64; AXES]) -> [f64; AXES] {
    core::array::from_fn(|axis| axes[axis] / AXIS_UNIT[axis])
}
