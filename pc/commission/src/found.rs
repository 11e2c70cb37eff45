//! What the captures of a motor tell of its loop.

use crate::Complex;
use crate::design::{Loop, NoDesign, Requirements, design, open_loop};
use crate::excitations::CapturedMotion;
use crate::friction::{NoFriction, friction};
use crate::plan::Planned;
use crate::response::{Capture, Line, NoResponse, Response};
use shared::control::{FrictionConfig, MotorConfig};
use shared::protocol::Excited;
use thiserror::Error;

/// What was found of a motor.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Its loop, with friction where that was found.
    pub of_loop: Loop,
    /// Its friction, or why that stays as it was.
    pub friction: Result<FrictionConfig, NoFriction>,
    /// Its open loop at the lines that are believed \[Hz\], with the parameters of before, and now.
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
    /// No loop has the margins on it.
    #[error(transparent)]
    Design(#[from] NoDesign),
}

impl Found {
    /// Of the motor with this `index`, whose parameters are those of `motor`; what was captured of others is left aside.
    ///
    /// # Errors
    /// Why it is left as it is.
    pub fn of(
        motor: Option<&MotorConfig>,
        index: usize,
        captured: &[CapturedMotion],
    ) -> Result<Self, NotFound> {
        let motor = motor.ok_or(NotFound::NoMotor)?;
        let response = Response::of(&on_the_way(index, captured), motor)?;
        let mut of_loop = design(&response, motor, &Requirements::default())?;
        // Commands count for what the drive makes of them.
        let now = response.of_gain(1.0 / of_loop.lag.gain);
        let open_loops = [
            open_loop(&response, motor).map_err(NoDesign::from)?,
            open_loop(&now, &of_loop.motor).map_err(NoDesign::from)?,
        ];
        let turning = own(index, captured).find(|captured| captured.excitation.excited == Excited::Reference);
        let samples = turning.map_or(&[][..], |captured| &captured.samples);
        let friction = friction(&response, samples, motor, of_loop.lag.delay_s);
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

/// The response of the motor with this `index`, whether or not it is believed: all lines that were excited.
///
/// # Errors
/// There is none.
pub fn measured(
    motor: &MotorConfig,
    index: usize,
    captured: &[CapturedMotion],
) -> Result<Vec<Line>, NoResponse> {
    Line::of(&on_the_way(index, captured), motor)
}

fn own(index: usize, captured: &[CapturedMotion]) -> impl Iterator<Item = &CapturedMotion> {
    let is_own = move |captured: &&CapturedMotion| usize::from(captured.excitation.motor) == index;
    captured.iter().filter(is_own)
}

/// Captures of the motor with this `index` on its way.
fn on_the_way(index: usize, captured: &[CapturedMotion]) -> Vec<Capture> {
    own(index, captured)
        .filter(|captured| captured.excitation.excited == Excited::Command)
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
