//! What the captures of a motor tell of its loop.

use crate::Complex;
use crate::design::{Loop, NoDesign, Requirements, design, worst_loop};
use crate::excitations::{CapturedMotion, coupling};
use crate::friction::{NoFriction, friction};
use crate::plan::Planned;
use crate::refusal::{Measured, Refusal};
use crate::response::{Capture, Line, NoResponse, Response};
use shared::config::MotionConfig;
use shared::control::{FrictionConfig, MotorConfig};
use shared::io::{MOTOR_AXIS, MOTOR_NAMES};
use shared::kinematics::AXIS_UNIT;
use shared::parameter::ParameterError;
use shared::protocol::Excited;
use thiserror::Error;

/// How far the tool is from a rotary axis \[mm\], for what a motor costs it.
const ARM_MM: f64 = 500.0;

/// What was found of a motor.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Its loop, with friction where that was found.
    pub of_loop: Loop,
    /// Its friction, or why that stays as it was.
    pub friction: Result<FrictionConfig, NoFriction>,
    /// Its open loop at the lines that are believed \[Hz\], with the parameters of before, and now: of those that have to keep the
    /// margins (under way, at rest, with the gantry's motors against each other) the one with the highest peak of the sensitivity.
    pub open_loops: [Vec<(f64, Complex)>; 2],
}

/// Why a motor is left as it is.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NotFound {
    /// The machine has no such motor.
    #[error("the machine has none")]
    NoMotor,
    /// Its response is not believed.
    #[error(transparent)]
    Response(#[from] NoResponse),
    /// It has to be seen to first.
    #[error(transparent)]
    Refused(#[from] Refusal),
    /// No loop has the margins on it.
    #[error(transparent)]
    Design(#[from] NoDesign),
}

impl From<ParameterError> for NotFound {
    fn from(error: ParameterError) -> Self {
        Self::Design(error.into())
    }
}

impl Found {
    /// Of the motor with this `index` of `machine`, whose parameters are those of `motor`; what was captured of others is left aside.
    ///
    /// # Errors
    /// Why it is left as it is.
    pub fn of(
        machine: &MotionConfig,
        motor: Option<&MotorConfig>,
        index: usize,
        captured: &[CapturedMotion],
    ) -> Result<Self, NotFound> {
        let motor = motor.ok_or(NotFound::NoMotor)?;
        let requirements = Requirements {
            coupling: coupling(machine, index),
            ..Requirements::default()
        };
        let captures = chirps(index, captured);
        let turning = own(index, captured).find(|captured| captured.excitation.excited == Excited::Reference);
        let turning = turning.map_or(&[][..], |captured| &captured.samples);
        let swung = own(index, captured).find(|captured| is_sine(captured));
        let believed = believed(&captures, MOTOR_NAMES[index], motor, &requirements);
        let response = believed.as_ref().ok().map(|(response, _)| response);
        let designed = believed.as_ref().ok().map(|(_, designed)| designed);
        let found = designed.and_then(|designed| designed.as_ref().ok());
        let friction = match response {
            Some(response) => friction(response, turning, motor, found),
            None => Err(NoFriction::NoResponse),
        };
        let resting = captures.iter().find(|capture| capture.way == 0.0);
        let unit = AXIS_UNIT[MOTOR_AXIS[index]];
        let measured = Measured {
            motor,
            response,
            designed: found,
            turning,
            friction: friction.as_ref().ok(),
            swung: swung.map(|captured| (captured.excitation.from_hz, &*captured.samples)),
            resting: resting.map_or(&[], |capture| &capture.samples),
            // A degree of a rotary axis, seen at the end of its arm.
            tool_mm: if unit == 1.0 { 1.0 } else { unit * ARM_MM },
        };
        if let Some(refusal) = measured.refusal()? {
            return Err(refusal.into());
        }
        let (response, designed) = believed?;
        let mut of_loop = designed?;
        // Commands count for what the drive makes of them.
        let now = response.of_gain(1.0 / of_loop.lag.gain);
        let open_loops = [
            worst_loop(&response, motor, requirements.coupling)?,
            worst_loop(&now, &of_loop.motor, requirements.coupling)?,
        ];
        if let Ok(found) = &friction {
            of_loop.motor.friction = Some(*found);
        }
        Ok(Self {
            of_loop,
            friction,
            open_loops,
        })
    }
}

/// What is measured of a motor, and the loop on that. Few lines are believed in vain, unless the others could not cost that loop its
/// margins.
fn believed(
    captures: &[Capture],
    name: &str,
    motor: &MotorConfig,
    requirements: &Requirements,
) -> Result<(Response, Result<Loop, NoDesign>), NoResponse> {
    let response = Response::measured(captures, motor)?;
    let designed = design(&response, name, motor, requirements);
    let small = |designed: &Loop| response.doubts_are_small(designed, requirements);
    if !designed.as_ref().is_ok_and(small) {
        response.check()?;
    }
    Ok((response, designed))
}

/// Those of `motors` that swung by themselves while they were captured: in slower loops they may not.
pub fn swinging(machine: &MotionConfig, motors: &[usize], captured: &[CapturedMotion]) -> Vec<usize> {
    let swings = |index: &&usize| {
        let found = Found::of(machine, machine.motors[**index].as_ref(), **index, captured);
        matches!(found, Err(NotFound::Refused(Refusal::Swings { .. })))
    };
    motors.iter().filter(swings).copied().collect()
}

/// The response of the motor with this `index`, whether or not it is believed: all lines that were excited on its way.
///
/// # Errors
/// Nothing of it was captured, or not whole periods.
pub fn measured(
    motor: &MotorConfig,
    index: usize,
    captured: &[CapturedMotion],
) -> Result<Vec<Line>, NoResponse> {
    Line::of(&chirps(index, captured), motor)
}

fn own(index: usize, captured: &[CapturedMotion]) -> impl Iterator<Item = &CapturedMotion> {
    let is_own = move |captured: &&CapturedMotion| usize::from(captured.excitation.motor) == index;
    captured.iter().filter(is_own)
}

/// Whether the command was a sine. A single line is no response.
fn is_sine(captured: &CapturedMotion) -> bool {
    let told = &captured.excitation;
    told.excited == Excited::Command && told.from_hz == told.to_hz
}

/// Captures of the motor with this `index` whose commands were chirps.
fn chirps(index: usize, captured: &[CapturedMotion]) -> Vec<Capture> {
    own(index, captured)
        .filter(|captured| captured.excitation.excited == Excited::Command && !is_sine(captured))
        .map(capture)
        .collect()
}

fn capture(captured: &CapturedMotion) -> Capture {
    Capture {
        planned: Planned {
            from_hz: captured.excitation.from_hz,
            to_hz: captured.excitation.to_hz,
            amplitude: captured.excitation.amplitude,
        },
        way: captured.excitation.way,
        samples: captured.samples.clone(),
    }
}
