//! Finding the reference marks, in the sequence of the machine file; the two motors of a gantry move as one,
//! and in the end the beam is squared.

use super::segment::MotorReference;
use super::servo::{ServoReport, UNIT};
use crate::config::MotionConfig;
use crate::control::{ReferenceSearch, SearchInput, SearchProgress, SearchState};
use crate::io::{MOTOR_AXIS, MOTOR_NAMES, MOTORS};
use crate::parameter::ParameterError;
use crate::state::Fault;
use crate::ticks::PATH_PERIOD_S;
use crate::trajectory::{RestToRest, SpeedLimits};

const X1: usize = 0;
const X2: usize = 1;

/// Limits with which the gantry is squared: slow, it turns the whole beam.
const SQUARING: SpeedLimits = SpeedLimits {
    velocity: 1.0,
    acceleration: 20.0,
    jerk: 400.0,
};

/// X1 and X2, which search as one.
#[derive(Clone, Debug, PartialEq)]
struct GantryPlan {
    search: ReferenceSearch<2>,
    max_skew_mm: f64,
}

/// The searches of a machine, ready to start.
#[derive(Clone, Debug, PartialEq)]
pub struct HomingPlan {
    gantry: Option<GantryPlan>,
    /// Motors that search alone.
    single: [Option<ReferenceSearch<1>>; MOTORS],
    /// Place of each motor in the sequence; of a gantry X1's.
    sequence: [u8; MOTORS],
}

impl HomingPlan {
    /// Builds the searches of all motors.
    pub fn build(config: &MotionConfig) -> Result<Self, ParameterError> {
        let acceleration = |motor: usize| {
            let axis = config.axes[MOTOR_AXIS[motor]].as_ref();
            axis.map_or(0.0, |axis| axis.max_acceleration)
        };
        let mut plan = Self {
            gantry: None,
            single: [const { None }; MOTORS],
            sequence: [0; MOTORS],
        };
        let coupled = match (&config.gantry, &config.motors) {
            (Some(gantry), [Some(x1), Some(x2), ..]) => {
                if x1.home_sequence != x2.home_sequence {
                    let sequence = f64::from(x2.home_sequence);
                    return Err(ParameterError::new(MOTOR_NAMES[X2], "home_sequence", sequence));
                }
                plan.gantry = Some(GantryPlan {
                    search: ReferenceSearch::build(
                        [MOTOR_NAMES[X1], MOTOR_NAMES[X2]],
                        [&x1.home, &x2.home],
                        [x1.counts_per_unit, x2.counts_per_unit],
                        UNIT[X1],
                        acceleration(X1),
                        PATH_PERIOD_S,
                    )?,
                    max_skew_mm: gantry.skew_trip_mm,
                });
                2
            }
            _ => 0,
        };
        for (index, motor) in config.motors.iter().enumerate() {
            let Some(motor) = motor else { continue };
            plan.sequence[index] = motor.home_sequence;
            if index >= coupled {
                plan.single[index] = Some(ReferenceSearch::build(
                    [MOTOR_NAMES[index]],
                    [&motor.home],
                    [motor.counts_per_unit],
                    UNIT[index],
                    acceleration(index),
                    PATH_PERIOD_S,
                )?);
            }
        }
        Ok(plan)
    }

    /// Those that the machine has, one bit a motor.
    pub fn motors(&self) -> u8 {
        bits(|motor| self.fitted(motor))
    }

    /// Whether the machine has `motor`.
    fn fitted(&self, motor: usize) -> bool {
        self.single[motor].is_some() || (motor <= X2 && self.gantry.is_some())
    }
}

/// X2 on its way to where the beam is square.
#[derive(Clone, Debug, PartialEq)]
struct Squaring {
    way: RestToRest,
    from: f64,
    sign: f64,
    time: f64,
}

impl Squaring {
    /// Moves the reference of X2 on by a millisecond; true when it has arrived.
    fn tick(&mut self, reference: &mut MotorReference) -> bool {
        self.time += PATH_PERIOD_S;
        let state = self.way.at(self.time);
        reference.position[X2] = self.from + self.sign * state.s;
        reference.velocity[X2] = self.sign * state.v;
        reference.acceleration[X2] = self.sign * state.a;
        self.time >= self.way.duration()
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Stage {
    /// Motors look for their marks.
    Searching,
    /// X2 moves until the beam is square.
    Squaring(Squaring),
    /// Every axis has its reference.
    Done,
}

/// A search under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Homing {
    plan: HomingPlan,
    seen: [Option<i64>; MOTORS],
    stage: Stage,
    gantry: Option<SearchState<2>>,
    single: [Option<SearchState<1>>; MOTORS],
    found: [bool; MOTORS],
}

/// What homing asks for in one millisecond.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HomingStep {
    /// Position at count 0 of the motors whose reference was just found (mm or rad).
    pub offset: [Option<f64>; MOTORS],
    /// Every axis has its reference and the gantry is square.
    pub done: bool,
}

impl Homing {
    /// Starts a search; marks were `seen` at these counts before.
    pub fn start(plan: HomingPlan, seen: [Option<i64>; MOTORS]) -> Self {
        Self {
            found: core::array::from_fn(|motor| !plan.fitted(motor)),
            plan,
            seen,
            stage: Stage::Searching,
            gantry: None,
            single: [None; MOTORS],
        }
    }

    /// Motors that have their reference, one bit each.
    pub fn found(&self) -> u8 {
        bits(|motor| self.found[motor] && self.plan.fitted(motor))
    }

    /// Motors that look for it now, one bit each.
    pub fn searching(&self) -> u8 {
        let now = self.turn();
        bits(|motor| !self.found[motor] && now == Some(self.plan.sequence[motor]))
    }

    /// Whose turn it is: the lowest place in the sequence that is left.
    fn turn(&self) -> Option<u8> {
        let missing = (0..MOTORS).filter(|motor| !self.found[*motor]);
        missing.map(|motor| self.plan.sequence[motor]).min()
    }

    /// One path tick: moves `reference` on, from what the servo ticks reported. `skew` is by how much X1 leads X2 beyond what a
    /// square beam has, with the motors somewhere \[mm\].
    pub fn tick(
        &mut self,
        report: &ServoReport,
        reference: &mut MotorReference,
        skew: impl Fn(&[f64; MOTORS]) -> f64,
    ) -> Result<HomingStep, Fault> {
        let mut step = HomingStep::default();
        match &mut self.stage {
            Stage::Searching => match self.turn() {
                Some(now) => self.search_all(now, report, reference, &mut step)?,
                // The new frame holds from this report on; square only now.
                None => self.stage = self.square(reference, skew(&reference.position))?,
            },
            Stage::Squaring(squaring) => {
                if squaring.tick(reference) {
                    self.stage = Stage::Done;
                }
            }
            Stage::Done => step.done = true,
        }
        Ok(step)
    }

    /// One tick of all motors whose turn it is.
    fn search_all(
        &mut self,
        sequence: u8,
        report: &ServoReport,
        reference: &mut MotorReference,
        step: &mut HomingStep,
    ) -> Result<(), Fault> {
        let turn: [bool; MOTORS] =
            core::array::from_fn(|motor| !self.found[motor] && self.plan.sequence[motor] == sequence);
        if self.plan.gantry.is_some() && turn[X1] {
            self.search_gantry(report, reference, step)?;
        }
        for motor in 0..MOTORS {
            if turn[motor] {
                self.search(motor, report, reference, step)?;
            }
        }
        Ok(())
    }

    /// X2 on by `distance` to where the beam is square; marks that ask for more than the skew trip were not the right ones.
    fn square(&self, reference: &MotorReference, distance: f64) -> Result<Stage, Fault> {
        let Some(gantry) = &self.plan.gantry else {
            return Ok(Stage::Done);
        };
        let from = reference.position[X2];
        let length = libm::fabs(distance);
        let skew = Fault::GantrySkew {
            seen_um: (length * 1000.0) as f32,
            limit_um: (gantry.max_skew_mm * 1000.0) as f32,
        };
        let small = length <= gantry.max_skew_mm;
        if !small {
            return Err(skew);
        }
        Ok(Stage::Squaring(Squaring {
            way: RestToRest::new(length, &SQUARING),
            from,
            sign: libm::copysign(1.0, distance),
            time: 0.0,
        }))
    }

    /// One tick of a motor that searches alone.
    fn search(
        &mut self,
        motor: usize,
        report: &ServoReport,
        reference: &mut MotorReference,
        step: &mut HomingStep,
    ) -> Result<(), Fault> {
        let Some(search) = &self.plan.single[motor] else {
            return Ok(());
        };
        let seen = self.seen[motor];
        let state = self.single[motor].get_or_insert_with(|| search.start([report.counts[motor]], [seen]));
        let progress = search.step(state, &[input(report, motor)]);
        follow(reference, motor, state.velocity());
        match progress {
            SearchProgress::Moving => {}
            SearchProgress::Done { offset: [offset] } => {
                step.offset[motor] = Some(offset);
                self.found[motor] = true;
            }
            SearchProgress::Failed { .. } => return Err(Fault::MarkNotFound { motor: motor as u8 }),
        }
        Ok(())
    }

    /// One tick of X1 and X2 together.
    fn search_gantry(
        &mut self,
        report: &ServoReport,
        reference: &mut MotorReference,
        step: &mut HomingStep,
    ) -> Result<(), Fault> {
        let Some(GantryPlan { search, .. }) = &self.plan.gantry else {
            return Ok(());
        };
        let seen = [X1, X2].map(|motor| self.seen[motor]);
        let state = self
            .gantry
            .get_or_insert_with(|| search.start([X1, X2].map(|motor| report.counts[motor]), seen));
        let progress = search.step(state, &[input(report, X1), input(report, X2)]);
        for motor in [X1, X2] {
            follow(reference, motor, state.velocity());
        }
        match progress {
            SearchProgress::Moving => {}
            SearchProgress::Done { offset } => {
                for (motor, offset) in [X1, X2].into_iter().zip(offset) {
                    step.offset[motor] = Some(offset);
                    self.found[motor] = true;
                }
            }
            SearchProgress::Failed { grating } => {
                return Err(Fault::MarkNotFound {
                    motor: [X1, X2][grating] as u8,
                });
            }
        }
        Ok(())
    }
}

/// One bit each for those of which `is` holds.
fn bits(is: impl Fn(usize) -> bool) -> u8 {
    (0..MOTORS).fold(0, |bits, motor| bits | u8::from(is(motor)) << motor)
}

fn input(report: &ServoReport, motor: usize) -> SearchInput {
    SearchInput {
        counts: report.counts[motor],
        mark: report.mark[motor],
        limit_plus: report.limit_plus.get(motor),
        limit_minus: report.limit_minus.get(motor),
    }
}

/// Moves one motor's reference on by a millisecond, to `velocity` at its end.
fn follow(reference: &mut MotorReference, motor: usize, velocity: f64) {
    let before = reference.velocity[motor];
    reference.position[motor] += 0.5 * (before + velocity) * PATH_PERIOD_S;
    reference.acceleration[motor] = (velocity - before) / PATH_PERIOD_S;
    reference.velocity[motor] = velocity;
}
