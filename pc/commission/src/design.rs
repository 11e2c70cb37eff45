//! Gains and notches with stated margins, on a response as it was measured.

use crate::Complex;
use crate::controller::{filters, pid};
use crate::four_digits;
use crate::lag::Lag;
use crate::margins::Margins;
use crate::response::{Line, Response};
use shared::control::{MotorConfig, NOTCHES, NotchConfig};
use shared::motion::{Chirp, check_coupling, check_gains};
use shared::parameter::ParameterError;
use thiserror::Error;

/// Gains that are tried, each so much above the one before \[1/s\].
const LEAST_KP: f64 = 2.0;
const MOST_KP: f64 = 1000.0;
const STEP: f64 = 1.03;
/// A notch is worth its lag if the gain grows by this factor at least.
const WORTH: f64 = 1.15;
/// Dampings of a notch that are tried: a wide one forgives a resonance that moves, a narrow one lags less.
const DAMPINGS: [f64; 4] = [0.15, 0.3, 0.5, 0.8];
/// How far below what is around it a resonance is pushed at most: one that moves must not be pushed down twice.
const LEAST_DEPTH: f64 = 0.05;
/// A resonance stands out by this factor from what is around it,
const PROMINENT: f64 = 1.4;
/// which begins at this ratio of frequencies to either side.
const AROUND: f64 = 1.6;

/// Margins that are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Requirements {
    /// Gain margin \[dB\].
    pub gain_db: f64,
    /// Phase margin \[°\].
    pub phase_deg: f64,
    /// Largest peak of the sensitivity.
    pub peak: f64,
    /// Cross-coupling of a gantry to a partner of the same kind, as a part of the proportional gain, with which it grows. The
    /// margins are kept with both motors going the same way and against each other.
    pub coupling: f64,
}

impl Default for Requirements {
    /// 6 dB, 45° and 2: what textbooks ask for (Åström and Murray, Feedback Systems, 10.3).
    fn default() -> Self {
        Self {
            gain_db: 6.0,
            phase_deg: 45.0,
            peak: 2.0,
            coupling: 0.0,
        }
    }
}

impl Requirements {
    /// Whether `margins` are enough.
    pub fn are_kept(&self, margins: &Margins) -> bool {
        margins.gain_db >= self.gain_db && margins.phase_deg >= self.phase_deg && margins.peak <= self.peak
    }
}

/// A loop that was designed.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// The motor with its gains and notches, and feed-forward by the lag.
    pub motor: MotorConfig,
    /// What is left of the way to swinging.
    pub margins: Margins,
    /// The same with the parameters of before.
    pub before: Margins,
    /// Gain and delay of the drive.
    pub lag: Lag,
    /// What a machine file may not have, if that and not the margins keeps the gain from being higher.
    pub held: Option<ParameterError>,
}

impl Loop {
    /// What the loop leaves of a disturbance of the position at a line of a capture, by its number and the response there, which was
    /// measured with the parameters `before`.
    ///
    /// # Errors
    /// A parameter of a filter is out of range.
    pub(crate) fn sensitivity(
        &self,
        before: &MotorConfig,
    ) -> Result<impl Fn(usize, Complex) -> Complex, ParameterError> {
        let filters = filters(&self.motor)?;
        // The response is that to commands as the machine file has them.
        let gain = self.motor.velocity_at_10v / before.velocity_at_10v;
        Ok(move |number, response: Complex| {
            let hz = number as f64 * Chirp::LINE_HZ;
            1.0 / (1.0 + pid(&self.motor, hz) * filters[number] * response / gain)
        })
    }
}

/// Why no loop was designed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NoDesign {
    /// Not even the least gain has margins.
    #[error("no proportional gain above {LEAST_KP} 1/s has the margins: look at the plot of the response")]
    NoGain,
    /// The drive's gain or delay is not seen.
    #[error("too few slow lines are believed: begin the excitation at a lower frequency")]
    NoLag,
    /// The parameters of before are out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

/// The loop of the motor `name` with the highest proportional gain that keeps the margins and that a machine file may have; the
/// integral and derivative gain go with it, and notches are added where they raise it.
///
/// # Errors
/// There is none.
pub fn design(
    response: &Response,
    name: &str,
    motor: &MotorConfig,
    requirements: &Requirements,
) -> Result<Loop, NoDesign> {
    let before = margins_of(&open_loops(response, motor, requirements.coupling)?, 1.0);
    let lag = Lag::of(response).ok_or(NoDesign::NoLag)?;
    // Commands are those of a drive whose gain is right from here on.
    let mut bare = motor.clone();
    bare.notches.clear();
    bare.velocity_at_10v = four_digits(motor.velocity_at_10v * lag.gain);
    bare.velocity_feed_forward = 1.0;
    bare.acceleration_feed_forward_s = four_digits(lag.delay_s.max(0.0));
    let response = response.of_gain(1.0 / lag.gain);
    let highest = |motor: &MotorConfig| with_highest_gain(&response, name, motor, requirements);
    let mut best = highest(&bare)?;
    for _ in 0..NOTCHES {
        let base = best.as_ref().map_or(&bare, |best| &best.motor).clone();
        let Some((_, resonance)) = Resonance::highest(&response, &base)? else {
            break;
        };
        let mut better = None;
        for damping in DAMPINGS {
            let mut with = base.clone();
            let notch = resonance.notch(damping);
            if with.notches.push(notch).is_err() {
                continue;
            }
            better = higher(better, highest(&with)?);
        }
        let gain = |found: &Option<Highest>| found.as_ref().map_or(0.0, |found| found.motor.kp);
        if gain(&better) < WORTH * gain(&best) {
            break;
        }
        best = better;
    }
    let Highest {
        mut motor,
        margins,
        held,
    } = best.ok_or(NoDesign::NoGain)?;
    // No drive can be told more than its 10 V.
    motor.max_command = motor.max_command.min(motor.velocity_at_10v.abs());
    Ok(Loop {
        motor,
        margins,
        before,
        lag,
        held,
    })
}

/// Where what moves swings so that not even a proportional gain of `kp` keeps a gain margin of 6 dB \[Hz\], without notches; none if
/// it is not that.
///
/// # Errors
/// A parameter of the motor is out of range.
pub fn least_gain(response: &Response, motor: &MotorConfig, kp: f64) -> Result<Option<f64>, ParameterError> {
    let mut bare = motor.with_gain(kp);
    bare.notches.clear();
    let least = 10_f64.powf(-Requirements::default().gain_db / 20.0);
    let highest = Resonance::highest(response, &bare)?;
    Ok(highest
        .filter(|(gain, _)| *gain >= least)
        .map(|(_, resonance)| resonance.hz))
}

impl Response {
    /// The same of a drive whose commands count for so much more.
    pub(crate) fn of_gain(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        let lines = scaled.lines.iter_mut().chain(&mut scaled.doubtful);
        let lines = lines.chain(&mut scaled.at_rest);
        lines.for_each(|line| line.gain *= factor);
        scaled
    }

    /// Whether the lines that are not believed could not cost the loop its margins, were they as they were seen: noise makes them
    /// larger than they are.
    pub(crate) fn doubts_are_small(&self, designed: &Loop, requirements: &Requirements) -> bool {
        let doubtful = Self {
            lines: self.doubtful.clone(),
            at_rest: Vec::new(),
            ..self.clone()
        };
        // Commands count for what the drive makes of them.
        let doubtful = doubtful.of_gain(1.0 / designed.lag.gain);
        let least = 10_f64.powf(-requirements.gain_db / 20.0);
        open_loops(&doubtful, &designed.motor, requirements.coupling)
            .is_ok_and(|loops| loops.iter().flatten().all(|(_, value)| value.norm() <= least))
    }

    /// Lines of the motor under way, and at rest if they are known.
    fn states(&self) -> impl Iterator<Item = &[Line]> {
        let at_rest = Some(&*self.at_rest).filter(|lines| !lines.is_empty());
        std::iter::once(&*self.lines).chain(at_rest)
    }
}

/// A motor with the highest gain.
struct Highest {
    motor: MotorConfig,
    margins: Margins,
    /// See [`Loop::held`].
    held: Option<ParameterError>,
}

fn higher(first: Option<Highest>, second: Option<Highest>) -> Option<Highest> {
    match (first, second) {
        (Some(first), Some(second)) if second.motor.kp > first.motor.kp => Some(second),
        (None, second) => second,
        (first, _) => first,
    }
}

/// The open loops of `motor` that have to keep the margins, that under way first.
fn open_loops(
    response: &Response,
    motor: &MotorConfig,
    coupling: f64,
) -> Result<Vec<Vec<(f64, Complex)>>, ParameterError> {
    let filters = filters(motor)?;
    // Motors that go against each other see the coupling twice.
    let couplings = [0.0, 2.0 * coupling * motor.kp];
    let couplings = couplings.iter().take(if coupling > 0.0 { 2 } else { 1 });
    Ok(response
        .states()
        .flat_map(|lines| couplings.clone().map(move |coupling| (lines, coupling)))
        .map(|(lines, coupling)| open_loop(lines, |hz| (pid(motor, hz) + coupling) * filters[number(hz)]))
        .collect())
}

/// The worst margins of open loops with so much more gain.
fn margins_of(open_loops: &[Vec<(f64, Complex)>], gain: f64) -> Margins {
    let margins = open_loops.iter().map(|open_loop| {
        let scaled: Vec<_> = open_loop.iter().map(|(hz, value)| (*hz, value * gain)).collect();
        Margins::of(&scaled)
    });
    margins
        .reduce(|worst, margins| worst.or_worse(&margins))
        .unwrap_or_else(|| Margins::of(&[]))
}

/// Of the open loops of `motor` that have to keep the margins, at their lines \[Hz\], the one with the highest peak of the sensitivity.
pub(crate) fn worst_loop(
    response: &Response,
    motor: &MotorConfig,
    coupling: f64,
) -> Result<Vec<(f64, Complex)>, ParameterError> {
    let loops = open_loops(response, motor, coupling)?;
    let peak = |open_loop: &Vec<(f64, Complex)>| Margins::of(open_loop).peak;
    let worst = loops.into_iter().max_by(|a, b| peak(a).total_cmp(&peak(b)));
    Ok(worst.unwrap_or_default())
}

fn open_loop(lines: &[Line], controller: impl Fn(f64) -> Complex) -> Vec<(f64, Complex)> {
    lines
        .iter()
        .map(|line| (line.hz, controller(line.hz) * line.gain))
        .collect()
}

/// Number of the line at a frequency.
fn number(hz: f64) -> usize {
    (hz / Chirp::LINE_HZ).round() as usize
}

/// The motor `name` with the highest gain up to which the margins are kept and that a machine file may have.
fn with_highest_gain(
    response: &Response,
    name: &str,
    motor: &MotorConfig,
    requirements: &Requirements,
) -> Result<Option<Highest>, ParameterError> {
    // All parts of the controller grow with the proportional gain.
    let shapes = open_loops(response, &motor.with_gain(1.0), requirements.coupling)?;
    let mut best: Option<Highest> = None;
    let mut kp = LEAST_KP;
    while kp <= MOST_KP {
        let motor = motor.with_gain(four_digits(kp));
        let margins = margins_of(&shapes, motor.kp);
        let kept = requirements.are_kept(&margins);
        let may_be = check_gains(name, &motor)
            .and_then(|()| check_coupling(four_digits(requirements.coupling * motor.kp), &motor));
        // With a small gain the integral part is fast against the loop.
        match (may_be, &mut best) {
            (Ok(()), best) if kept => {
                *best = Some(Highest {
                    motor,
                    margins,
                    held: None,
                });
            }
            (Err(error), Some(best)) if kept => {
                best.held = Some(error);
                break;
            }
            (_, Some(_)) => break,
            (_, None) => {}
        }
        kp *= STEP;
    }
    Ok(best)
}

trait WithGain {
    fn with_gain(&self, kp: f64) -> Self;
}

impl WithGain for MotorConfig {
    /// With another proportional gain, and the others in the same proportion to it.
    fn with_gain(&self, kp: f64) -> Self {
        let factor = kp / self.kp;
        Self {
            kp,
            ki: four_digits(self.ki * factor),
            kd: four_digits(self.kd * factor),
            ..self.clone()
        }
    }
}

/// A frequency at which the machine answers more than around it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Resonance {
    hz: f64,
    /// So many times what is around it.
    prominence: f64,
}

impl Resonance {
    /// That with the highest open-loop gain of those that stand out, behind the notches of `motor`, and that gain.
    fn highest(response: &Response, motor: &MotorConfig) -> Result<Option<(f64, Self)>, ParameterError> {
        let filters = filters(motor)?;
        let found = response
            .states()
            .filter_map(|lines| Self::of(&open_loop(lines, |hz| pid(motor, hz) * filters[number(hz)])));
        Ok(found.max_by(|(a, _), (b, _)| a.total_cmp(b)))
    }

    /// The highest of one open loop, with its gain.
    fn of(gains: &[(f64, Complex)]) -> Option<(f64, Self)> {
        let near = |hz: f64, ratio: f64| {
            let found = gains.iter().min_by(|(a, _), (b, _)| {
                let off = |at: f64| (at - hz * ratio).abs();
                off(*a).total_cmp(&off(*b))
            });
            found.map_or(f64::INFINITY, |(_, value)| value.norm())
        };
        let peaks = gains.windows(3).filter_map(|three| {
            let [before, (hz, value), after] = three else {
                return None;
            };
            let gain = value.norm();
            let around = (near(*hz, 1.0 / AROUND) * near(*hz, AROUND)).sqrt();
            let stands_out = gain > before.1.norm() && gain >= after.1.norm() && gain > PROMINENT * around;
            stands_out.then_some((
                gain,
                Self {
                    hz: *hz,
                    prominence: gain / around,
                },
            ))
        });
        peaks.max_by(|(a, _), (b, _)| a.total_cmp(b))
    }

    fn notch(&self, damping: f64) -> NotchConfig {
        NotchConfig {
            frequency_hz: four_digits(self.hz),
            damping,
            depth: four_digits((1.0 / self.prominence).max(LEAST_DEPTH)),
        }
    }
}
