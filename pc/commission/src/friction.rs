//! Feed-forward of friction, from a capture in which the motor turns round.

use crate::design::Loop;
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
/// Times that are tried by which friction has to be told before the motor turns round, beside the delay of its drive \[s\].
const LEADS_S: [f64; 8] = [0.0, 0.0005, 0.001, 0.0015, 0.002, 0.0025, 0.003, 0.004];
/// So many steps of the decay, and so much of the friction, are not given up for a smaller error in the loop: what fits one motion only
/// leads far from both.
const NEAR: i32 = 3;
const OF_COULOMB: f64 = 0.5;
/// Times at which the error of the loop is looked at: four and more in a period of the highest of [`LINES`].
const PEAK_POINTS: usize = 256;
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
/// the speed that would do the same at the command, −P·exp(jωτ)·C, where C is what [`Friction`] would add for the motor's speed, and τ
/// how much earlier it is told: the delay of the drive, or some more. First come those constants of C that leave the least of D; near
/// them are those, with τ, that leave the smallest peak of the error in the loop that was `designed`, which is S times as much.
///
/// # Errors
/// Nothing like friction is seen.
pub fn friction(
    response: &Response,
    samples: &[CaptureSample],
    motor: &MotorConfig,
    designed: Option<&Loop>,
) -> Result<FrictionConfig, NoFriction> {
    if samples.len() != CAPTURE_TICKS {
        return Err(NoFriction::Empty);
    }
    let delay_s = designed.map_or(0.0, |designed| designed.lag.delay_s.max(0.0));
    let (mut seen, position) = seen(response, samples, motor, delay_s);
    if seen.len() < FEWEST {
        return Err(NoFriction::NoResponse);
    }
    if let Some(designed) = designed {
        let sensitivity = designed.sensitivity(motor)?;
        for line in &mut seen {
            line.in_loop = sensitivity(line.number, line.gain);
        }
    }
    let turning = Turning::new(seen, &position);
    let (explained, alone) = turning.alone()?;
    if explained < EXPLAINED {
        let percent = 100.0 * explained;
        return Err(NoFriction::Unlike { percent });
    }
    Ok(turning.in_loop(alone, delay_s)?)
}

/// A capture of a motor that turns round.
struct Turning {
    seen: Vec<Seen>,
    speed: Vec<f64>,
    fastest: f64,
}

impl Turning {
    fn new(seen: Vec<Seen>, position: &[Complex]) -> Self {
        let speed = speed(position);
        let fastest = speed.iter().fold(0.0, |most: f64, speed| most.max(speed.abs()));
        Self { seen, speed, fastest }
    }

    /// Friction that has turned round at this part of the largest speed.
    fn friction(&self, coulomb: f64, part: f64, decay_s: f64) -> FrictionConfig {
        FrictionConfig {
            coulomb,
            viscous: 0.0,
            reversal_speed: part * self.fastest,
            lead_s: 0.0,
            decay_s,
        }
    }

    /// What explains it by itself, and the part of it that it explains.
    fn alone(&self) -> Result<(f64, FrictionConfig), ParameterError> {
        let mut least: f64 = self.seen.iter().map(|seen| seen.unexplained.norm_sqr()).sum();
        let all = least;
        let mut found = self.friction(0.0, REVERSALS[0], 0.0);
        for decay_s in steps(DECAYS_S).chain([0.0]) {
            for part in steps(REVERSALS) {
                let added = added(&self.friction(1.0, part, decay_s), &self.speed)?;
                let made = Made::of(&self.seen, &added, 0.0, |_| Complex::from(1.0));
                let left = made.squares_left();
                if made.factor > 0.0 && left < least {
                    (least, found) = (left, self.friction(made.factor, part, decay_s));
                }
            }
        }
        Ok((1.0 - least / all, found))
    }

    /// What is near `alone` and leaves the smallest peak of the error in the loop, of a drive with this delay.
    fn in_loop(&self, alone: FrictionConfig, delay_s: f64) -> Result<FrictionConfig, ParameterError> {
        let mut smallest = f64::INFINITY;
        let mut found = FrictionConfig {
            lead_s: delay_s,
            ..alone
        };
        for decay_s in (-NEAR..=NEAR).map(|count| alone.decay_s * STEP.powi(count)) {
            for part in steps(REVERSALS) {
                let added = added(&self.friction(1.0, part, decay_s), &self.speed)?;
                for more_s in LEADS_S {
                    let made = Made::of(&self.seen, &added, more_s, |line| line.in_loop);
                    let peak = made.peak_left();
                    if made.factor >= OF_COULOMB * alone.coulomb && peak < smallest {
                        smallest = peak;
                        found = FrictionConfig {
                            lead_s: delay_s + more_s,
                            ..self.friction(made.factor, part, decay_s)
                        };
                    }
                }
            }
        }
        Ok(found)
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
            gain,
            in_loop: Complex::from(1.0),
            early: gain * Complex::from_polar(1.0, omega(number) * delay_s.max(0.0)),
            unexplained: position[number] - gain * command[number],
        })
        .collect();
    (seen, position)
}

/// A line of the capture.
struct Seen {
    number: usize,
    /// The response.
    gain: Complex,
    /// The response to a command that was told early by the delay of the drive.
    early: Complex,
    /// What the position has beside the response to the command.
    unexplained: Complex,
    /// What the loop leaves of that.
    in_loop: Complex,
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
    sampled(lines, CAPTURE_TICKS)
}

/// So many of them, evenly over its time.
fn sampled(lines: impl Iterator<Item = (usize, Complex)>, count: usize) -> Vec<f64> {
    let mut values = vec![Complex::default(); count];
    for (number, value) in lines {
        values[number] = value;
        values[count - number] = value.conj();
    }
    Radix4::new(count, FftDirection::Inverse).process(&mut values);
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

/// What a friction makes of the lines of a capture, so large that the least of their squares is left.
struct Made {
    factor: f64,
    /// Number and what is left of each.
    left: Vec<(usize, Complex)>,
}

impl Made {
    /// Of what is `added`, told earlier by `more_s`, where each line counts so much as `seen_as` has of it.
    fn of(seen: &[Seen], added: &[Complex], more_s: f64, seen_as: impl Fn(&Seen) -> Complex) -> Self {
        let lines: Vec<_> = seen
            .iter()
            .map(|line| {
                let early = line.early * Complex::from_polar(1.0, omega(line.number) * more_s);
                let seen_as = seen_as(line);
                (
                    line.number,
                    -early * added[line.number] * seen_as,
                    line.unexplained * seen_as,
                )
            })
            .collect();
        let (both, own) = lines
            .iter()
            .fold((0.0, 0.0), |(both, own), (_, made, unexplained)| {
                (both + (made.conj() * unexplained).re, own + made.norm_sqr())
            });
        let factor = if own > 0.0 { both / own } else { 0.0 };
        let left = |(number, made, unexplained)| (number, unexplained - factor * made);
        Self {
            factor,
            left: lines.into_iter().map(left).collect(),
        }
    }

    fn squares_left(&self) -> f64 {
        self.left.iter().map(|(_, left)| left.norm_sqr()).sum()
    }

    /// Its largest value over time.
    fn peak_left(&self) -> f64 {
        sampled(self.left.iter().copied(), PEAK_POINTS)
            .into_iter()
            .fold(0.0, |most, value| most.max(value.abs()))
    }
}
