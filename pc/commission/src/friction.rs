//! Feed-forward of friction, from a capture in which the motor turns round.

use crate::response::Response;
use crate::{Complex, spectrum};
use rustfft::algorithm::Radix4;
use rustfft::{Fft, FftDirection};
use shared::control::{Friction, FrictionConfig, FrictionState, MotorConfig, Setpoint};
use shared::io::DacCode;
use shared::motion::Chirp;
use shared::parameter::ParameterError;
use shared::protocol::{CAPTURE_TICKS, CaptureSample};
use shared::ticks::SERVO_PERIOD_S;
use std::f64::consts::TAU;
use thiserror::Error;

/// Lines that are looked at, by their number: below, the motion itself is seen, above, the response is not known well.
const LINES: std::ops::RangeInclusive<usize> = 3..=60;
/// Lines of the position that are the motion: what its speed is computed from.
const MOTION_LINES: usize = 24;
/// Constants that are tried: time in which the drive takes friction over \[s\], and speed at which it has turned round, as a part
/// of the largest one.
const DECAYS_S: [f64; 2] = [0.001, 0.2];
const REVERSALS: [f64; 2] = [0.005, 0.5];
const STEP: f64 = 1.2;
/// Part of what is not the response that friction has to explain.
const EXPLAINED: f64 = 0.5;
/// Lines of both that have to be there.
const FEWEST: usize = 10;

/// Why no friction was found.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NoFriction {
    /// There is no capture, or not a whole one.
    #[error("nothing was captured where the motor turns round, or not a whole period")]
    Empty,
    /// The response is not known where it is needed.
    #[error("too few lines of its response are believed")]
    NoResponse,
    /// What is seen has another shape.
    #[error("where it turns round it does not behave as friction does ({percent:.0} % explained)")]
    Unlike {
        /// Part of what is not the response that friction explains.
        percent: f64,
    },
    /// The parameters of the motor are out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

/// The friction of `motor`, whose response is known, from `samples` of one period in which its reference is a sine of
/// [`TURNS_HZ`](crate::TURNS_HZ).
///
/// What the position has beside what the response makes of the command is what friction does: D = Y − P·U. Friction is told as
/// the speed that would do the same at the command, −P·exp(jωτ)·C, where C is what [`Friction`] would add for the motor's speed
/// and τ = `delay_s` that of the drive. Of C's constants those are taken that leave the least of D.
///
/// # Errors
/// Nothing like friction is seen.
pub fn friction(
    response: &Response,
    samples: &[CaptureSample],
    motor: &MotorConfig,
    delay_s: f64,
) -> Result<FrictionConfig, NoFriction> {
    if samples.len() != CAPTURE_TICKS {
        return Err(NoFriction::Empty);
    }
    let (seen, position) = seen(response, samples, motor, delay_s);
    if seen.len() < FEWEST {
        return Err(NoFriction::NoResponse);
    }
    let speed = speed(&position);
    let fastest = speed.iter().fold(0.0, |most: f64, speed| most.max(speed.abs()));
    let mut best: Option<(f64, FrictionConfig)> = None;
    for decay_s in steps(DECAYS_S).chain([0.0]) {
        for part in steps(REVERSALS) {
            let unit = FrictionConfig {
                coulomb: 1.0,
                viscous: 0.0,
                reversal_speed: part * fastest,
                lead_s: 0.0,
                decay_s,
            };
            let added = added(&unit, &speed)?;
            let (coulomb, left) = fitted(&seen, &added);
            if coulomb > 0.0 && best.as_ref().is_none_or(|(least, _)| left < *least) {
                let lead_s = delay_s.max(0.0);
                let found = FrictionConfig {
                    coulomb,
                    lead_s,
                    ..unit
                };
                best = Some((left, found));
            }
        }
    }
    let all: f64 = seen.iter().map(|seen| seen.unexplained.norm_sqr()).sum();
    match best {
        Some((left, found)) if left <= (1.0 - EXPLAINED) * all => Ok(found),
        best => {
            let percent = best.map_or(0.0, |(left, _)| 100.0 * (1.0 - left / all));
            Err(NoFriction::Unlike { percent })
        }
    }
}

/// What is left of what a capture shows beside the response when `friction` is told beside the command, by the number of the line.
///
/// # Errors
/// A parameter is out of range.
pub fn left(
    response: &Response,
    samples: &[CaptureSample],
    motor: &MotorConfig,
    friction: Option<&FrictionConfig>,
) -> Result<Vec<(usize, Complex)>, ParameterError> {
    let delay_s = friction.map_or(0.0, |friction| friction.lead_s);
    let (seen, position) = seen(response, samples, motor, delay_s);
    let told = friction.map(|friction| {
        let late = FrictionConfig {
            lead_s: 0.0,
            ..*friction
        };
        added(&late, &speed(&position))
    });
    let told = told.transpose()?;
    let made = |seen: &Seen| {
        told.as_ref()
            .map_or(Complex::default(), |told| seen.early * told[seen.number])
    };
    Ok(seen
        .iter()
        .map(|seen| (seen.number, seen.unexplained + made(seen)))
        .collect())
}

/// What a whole capture shows at the lines of the response, and the spectrum of its position.
fn seen(
    response: &Response,
    samples: &[CaptureSample],
    motor: &MotorConfig,
    delay_s: f64,
) -> (Vec<Seen>, Vec<Complex>) {
    let command = samples
        .iter()
        .map(|sample| DacCode(sample.command).ratio() * motor.velocity_at_10v);
    let position = samples
        .iter()
        .map(|sample| f64::from(sample.counts) / motor.counts_per_unit);
    let (command, position) = (spectrum(command), spectrum(position));
    let number = |hz: f64| (hz / Chirp::LINE_HZ).round() as usize;
    let seen = response
        .lines
        .iter()
        .map(|line| (number(line.hz), line.gain))
        .filter(|(number, _)| LINES.contains(number))
        .map(|(number, gain)| Seen {
            number,
            early: gain * Complex::from_polar(1.0, omega(number) * delay_s.max(0.0)),
            unexplained: position[number] - gain * command[number],
        })
        .collect();
    (seen, position)
}

/// A line of the capture.
struct Seen {
    number: usize,
    /// The response to a command that was told early by the delay of the drive.
    early: Complex,
    /// What the position has beside the response to the command.
    unexplained: Complex,
}

fn omega(number: usize) -> f64 {
    TAU * Chirp::LINE_HZ * number as f64
}

/// Values that each are so much above the one before.
fn steps([least, most]: [f64; 2]) -> impl Iterator<Item = f64> {
    std::iter::successors(Some(least), |value| Some(value * STEP)).take_while(move |value| *value <= most)
}

/// The speed of the motor, of the first lines of its position.
fn speed(position: &[Complex]) -> Vec<f64> {
    over_time((1..=MOTION_LINES).map(|number| (number, position[number] * Complex::i() * omega(number))))
}

/// The values of a capture with these lines.
pub fn over_time(lines: impl Iterator<Item = (usize, Complex)>) -> Vec<f64> {
    let mut values = vec![Complex::default(); CAPTURE_TICKS];
    for (number, value) in lines {
        values[number] = value;
        values[CAPTURE_TICKS - number] = value.conj();
    }
    Radix4::new(CAPTURE_TICKS, FftDirection::Inverse).process(&mut values);
    values
        .iter()
        .map(|value| value.re / CAPTURE_TICKS as f64)
        .collect()
}

/// The spectrum of what `friction` adds for a motor of this speed, once that repeats itself.
fn added(friction: &FrictionConfig, speed: &[f64]) -> Result<Vec<Complex>, ParameterError> {
    let friction = Friction::build("motor", friction, 1.0, SERVO_PERIOD_S)?;
    let mut state = FrictionState::default();
    let mut step = |velocity: &f64| {
        let setpoint = Setpoint {
            velocity: *velocity,
            ..Setpoint::default()
        };
        friction.step(&mut state, &setpoint)
    };
    speed.iter().for_each(|velocity| _ = step(velocity));
    Ok(spectrum(speed.iter().map(step)))
}

/// The factor of `added` with the least squares of what is left, and these.
fn fitted(seen: &[Seen], added: &[Complex]) -> (f64, f64) {
    let made = |seen: &Seen| -seen.early * added[seen.number];
    let pairs = || seen.iter().map(|seen| (made(seen), seen.unexplained));
    let (mut both, mut own) = (0.0, 0.0);
    for (made, unexplained) in pairs() {
        both += (made.conj() * unexplained).re;
        own += made.norm_sqr();
    }
    let factor = if own > 0.0 { both / own } else { 0.0 };
    let left = pairs()
        .map(|(made, unexplained)| (unexplained - factor * made).norm_sqr())
        .sum();
    (factor, left)
}
