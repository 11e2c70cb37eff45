//! Finding the reference marks: Z first, so that the tool is clear, then everything else together; the
//! gantry's two motors move as one, then the beam is squared.

use super::segment::{MotorReference, PATH_PERIOD_S};
use super::servo::{ServoReport, UNIT};
use super::{Fault, MotionConfig};
use crate::control::{ReferenceSearch, SearchInput, SearchProgress, SearchState};
use crate::io::{MOTOR_NAMES, MOTORS};
use crate::parameter::ParameterError;
use crate::trajectory::{SpeedLimits, SpeedProfile};

const X1: usize = 0;
const X2: usize = 1;
/// Motors that search alone, and the axis of each.
const SINGLE: [(usize, usize); 5] = [(2, 1), (3, 2), (4, 3), (5, 4), (6, 5)];
/// Place of Z in [`SINGLE`].
const VERTICAL: usize = 1;

/// Limits with which the gantry is squared: slow, it turns the whole beam.
const SQUARING: SpeedLimits = SpeedLimits {
    velocity: 1.0,
    acceleration: 20.0,
    jerk: 400.0,
};

/// The searches of a machine, ready to start.
#[derive(Clone, Debug, PartialEq)]
pub struct HomingPlan {
    gantry: ReferenceSearch<2>,
    single: [ReferenceSearch<1>; SINGLE.len()],
    square_offset_mm: f64,
    max_skew_mm: f64,
}

impl HomingPlan {
    /// Builds the searches of all motors.
    pub fn build(config: &MotionConfig) -> Result<Self, ParameterError> {
        let (x1, x2) = (&config.motors[X1], &config.motors[X2]);
        let single = |place: usize| {
            let (motor, axis) = SINGLE[place];
            ReferenceSearch::build(
                [MOTOR_NAMES[motor]],
                [&config.motors[motor].home],
                [config.motors[motor].counts_per_unit],
                UNIT[motor],
                config.axes[axis].max_acceleration,
                PATH_PERIOD_S,
            )
        };
        Ok(Self {
            gantry: ReferenceSearch::build(
                [MOTOR_NAMES[X1], MOTOR_NAMES[X2]],
                [&x1.home, &x2.home],
                [x1.counts_per_unit, x2.counts_per_unit],
                UNIT[X1],
                config.axes[0].max_acceleration,
                PATH_PERIOD_S,
            )?,
            single: [single(0)?, single(1)?, single(2)?, single(3)?, single(4)?],
            square_offset_mm: config.gantry.square_offset_mm,
            max_skew_mm: config.gantry.skew_trip_mm,
        })
    }
}

/// X2 on its way to where the beam is square.
#[derive(Clone, Debug, PartialEq)]
struct Squaring {
    profile: SpeedProfile,
    from: f64,
    sign: f64,
    time: f64,
}

impl Squaring {
    /// Moves the reference of X2 on by a millisecond; true when it has arrived.
    fn tick(&mut self, reference: &mut MotorReference) -> bool {
        self.time += PATH_PERIOD_S;
        let state = self.profile.at(self.time);
        reference.position[X2] = self.from + self.sign * state.s;
        reference.velocity[X2] = self.sign * state.v;
        reference.acceleration[X2] = self.sign * state.a;
        self.time >= self.profile.duration()
    }
}

#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "one homing exists at a time")]
enum Stage {
    /// Z looks for its mark, the others stand.
    Vertical,
    /// All others look for theirs.
    Others,
    /// X2 moves until the beam is square.
    Squaring(Squaring),
    /// Every axis has its reference.
    Done,
}

/// A search under way.
#[derive(Clone, Debug, PartialEq)]
pub struct Homing {
    plan: HomingPlan,
    stage: Stage,
    gantry: Option<SearchState<2>>,
    single: [Option<SearchState<1>>; SINGLE.len()],
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
    /// Starts a search.
    pub fn start(plan: HomingPlan) -> Self {
        Self {
            plan,
            stage: Stage::Vertical,
            gantry: None,
            single: [None; SINGLE.len()],
            found: [false; MOTORS],
        }
    }

    /// One path tick: moves `reference` on, from what the servo ticks reported.
    pub fn tick(
        &mut self,
        report: &ServoReport,
        reference: &mut MotorReference,
    ) -> Result<HomingStep, Fault> {
        let mut step = HomingStep::default();
        match &mut self.stage {
            Stage::Vertical => {
                self.search(VERTICAL, report, reference, &mut step)?;
                if self.found[SINGLE[VERTICAL].0] {
                    self.stage = Stage::Others;
                }
            }
            Stage::Others => {
                self.search_gantry(report, reference, &mut step)?;
                for place in (0..SINGLE.len()).filter(|place| *place != VERTICAL) {
                    self.search(place, report, reference, &mut step)?;
                }
                // The new frame holds from the next report on; square only then.
                if self.found.iter().all(|found| *found) && step.offset.iter().all(Option::is_none) {
                    self.stage = self.square(reference)?;
                }
            }
            Stage::Squaring(squaring) => {
                if squaring.tick(reference) {
                    self.stage = Stage::Done;
                }
            }
            Stage::Done => step.done = true,
        }
        Ok(step)
    }

    /// X2 to where the beam is square; marks that ask for more than the skew trip were not the right ones.
    fn square(&self, reference: &MotorReference) -> Result<Stage, Fault> {
        let from = reference.position[X2];
        let distance = reference.position[X1] - self.plan.square_offset_mm - from;
        let length = libm::fabs(distance);
        let skew = Fault::GantrySkew {
            seen_um: (length * 1000.0) as f32,
            limit_um: (self.plan.max_skew_mm * 1000.0) as f32,
        };
        if length > self.plan.max_skew_mm {
            return Err(skew);
        }
        let profile = SpeedProfile::rest_to_rest(0.0, length, &SQUARING).map_err(|_| skew)?;
        Ok(Stage::Squaring(Squaring {
            profile,
            from,
            sign: libm::copysign(1.0, distance),
            time: 0.0,
        }))
    }

    /// One tick of a motor that searches alone.
    fn search(
        &mut self,
        place: usize,
        report: &ServoReport,
        reference: &mut MotorReference,
        step: &mut HomingStep,
    ) -> Result<(), Fault> {
        let motor = SINGLE[place].0;
        if self.found[motor] {
            return Ok(());
        }
        let search = &self.plan.single[place];
        let state = self.single[place].get_or_insert_with(|| search.start(report.counts[motor]));
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
        if self.found[X1] {
            return Ok(());
        }
        let search = &self.plan.gantry;
        let state = self.gantry.get_or_insert_with(|| search.start(report.counts[X1]));
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
