//! The frequency response of a drive with what it moves, from captures of its excitation.

use crate::plan::{Planned, SETTLE_PERIODS, way};
use crate::{Complex, spectrum};
use shared::control::MotorConfig;
use shared::io::DacCode;
use shared::motion::Chirp;
use shared::protocol::{CAPTURE_TICKS, CaptureSample};
use std::collections::BTreeMap;
use thiserror::Error;

/// Coherence from which a line is believed,
const BELIEVED: f64 = 0.9;
/// and above [`MOST_BELOW_HZ`], where most lines are noise: of three captures of nothing but noise one line in 100 has 0.9, one in
/// 2500 this.
const BELIEVED_ABOVE: f64 = 0.98;
/// Part of the lines up to this frequency \[Hz\] that have to be. Above it, a machine without a resonance moves by less than
/// its grating resolves.
const MOST: f64 = 0.5;
const MOST_BELOW_HZ: f64 = 200.0;
/// Servo tick of an excitation with which its capture begins.
const FIRST_TICK: u32 = SETTLE_PERIODS as u32 * CAPTURE_TICKS as u32;

/// What was captured of one period of an excitation of the command.
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    /// What was asked for.
    pub planned: Planned,
    /// The way that the motor made meanwhile (mm or °).
    pub way: f64,
    /// One sample each servo tick.
    pub samples: Vec<CaptureSample>,
}

/// From the command of a drive (mm/s or °/s) to the position that its grating reads (mm or °), from one servo tick on.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Lines that were excited and are believed, upwards.
    pub lines: Vec<Line>,
    /// Those up to 200 Hz that are not: what is seen there is noise, at least in part.
    pub doubtful: Vec<Line>,
    /// Part of the lines excited up to 200 Hz that are believed.
    pub believed: f64,
    /// The same of the motor at rest, where friction holds it; empty if that was not captured.
    pub at_rest: Vec<Line>,
}

/// The response at one frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Frequency \[Hz\].
    pub hz: f64,
    /// Position for a command of 1 \[s\].
    pub gain: Complex,
    /// Part of the power of the position that the excitation explains, 0…1.
    pub coherence: f64,
}

/// Why a response is not believed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NoResponse {
    /// There is no capture, or not a whole one.
    #[error("nothing was captured, or not a whole period")]
    Empty,
    /// The position is mostly something else than what was excited.
    #[error(
        "only {percent:.0} % of the lines up to {MOST_BELOW_HZ} Hz have a coherence above {BELIEVED}: something else than the excitation moves it (friction, play, \
         noise); excite it more"
    )]
    Incoherent {
        /// Part of the lines that are believed.
        percent: f64,
    },
}

impl Response {
    /// From captures of a motor: of its [`Line`]s those that are believed. Captures without a way beside others that have one are
    /// those at rest.
    ///
    /// # Errors
    /// Too few lines are believed.
    pub fn of(captures: &[Capture], motor: &MotorConfig) -> Result<Self, NoResponse> {
        let response = Self::measured(captures, motor)?;
        response.check().map(|()| response)
    }

    /// The same, however few lines are believed.
    ///
    /// # Errors
    /// A capture is not whole, or there is none.
    pub(crate) fn measured(captures: &[Capture], motor: &MotorConfig) -> Result<Self, NoResponse> {
        let (resting, going) = by_state(captures)?;
        let believed_of = |all: Vec<Line>| all.into_iter().partition::<Vec<_>, _>(Line::is_believed);
        let (at_rest, _) = believed_of(lines(&resting, motor));
        let (lines, mut doubtful) = believed_of(lines(&going, motor));
        let below = |line: &Line| line.hz <= MOST_BELOW_HZ;
        doubtful.retain(below);
        let believed = lines.iter().filter(|line| below(line)).count();
        Ok(Self {
            believed: believed as f64 / (believed + doubtful.len()) as f64,
            lines,
            doubtful,
            at_rest,
        })
    }

    /// # Errors
    /// Too few lines are believed.
    pub(crate) fn check(&self) -> Result<(), NoResponse> {
        if self.believed < MOST {
            let percent = 100.0 * self.believed;
            return Err(NoResponse::Incoherent { percent });
        }
        Ok(())
    }
}

impl Line {
    /// All that were excited on the way, upwards, from captures of a motor. With R the chirp, U the command and Y the position, the
    /// response is S_ry/S_ru: the feedback, which carries the noise of Y into U, does not bias it (Ljung, System Identification,
    /// 13.5). The coherence is |S_ry|²/(S_rr·S_yy). The sums go over the captures that have excited a line.
    ///
    /// # Errors
    /// A capture is not whole, or there is none.
    pub fn of(captures: &[Capture], motor: &MotorConfig) -> Result<Vec<Self>, NoResponse> {
        let (_, going) = by_state(captures)?;
        Ok(lines(&going, motor))
    }

    /// Whether its coherence is enough.
    pub fn is_believed(&self) -> bool {
        let least = if self.hz <= MOST_BELOW_HZ {
            BELIEVED
        } else {
            BELIEVED_ABOVE
        };
        self.coherence >= least
    }
}

/// Captures at rest, and the others.
fn by_state(captures: &[Capture]) -> Result<(Vec<&Capture>, Vec<&Capture>), NoResponse> {
    let whole = |capture: &Capture| capture.samples.len() == CAPTURE_TICKS;
    if captures.is_empty() || !captures.iter().all(whole) {
        return Err(NoResponse::Empty);
    }
    let goes = captures.iter().any(|capture| capture.way != 0.0);
    Ok(captures.iter().partition(|capture| goes && capture.way == 0.0))
}

/// All lines that the captures have excited.
fn lines(captures: &[&Capture], motor: &MotorConfig) -> Vec<Line> {
    let mut sums = BTreeMap::<u32, Sums>::new();
    for capture in captures {
        let (chirp, amplitude) = (capture.planned.chirp(), capture.planned.amplitude);
        // Its speed is not quite even, and no period of the capture: left in the command it would be in every line.
        let way = way(capture.way);
        let command = |(tick, sample): (u32, &CaptureSample)| {
            DacCode(sample.command).ratio() * motor.velocity_at_10v - way.at(FIRST_TICK + tick).1
        };
        let position = |sample: &CaptureSample| f64::from(sample.counts) / motor.counts_per_unit;
        let asked = spectrum((0..CAPTURE_TICKS as u32).map(|tick| amplitude * chirp.at(tick)));
        let command = spectrum((0..).zip(&capture.samples).map(command));
        let position = spectrum(capture.samples.iter().map(position));
        let (first, last) = chirp.lines();
        for line in first..=last {
            let index = line as usize;
            let sums = sums.entry(line).or_default();
            sums.add(asked[index], command[index], position[index]);
        }
    }
    let line = |(number, sums): (&u32, &Sums)| Line {
        hz: f64::from(*number) * Chirp::LINE_HZ,
        gain: sums.ry / sums.ru,
        coherence: sums.ry.norm_sqr() / (sums.rr * sums.yy),
    };
    sums.iter().map(line).collect()
}

/// Spectra over all captures: of what was asked for with command and position, and of both alone.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    ru: Complex,
    ry: Complex,
    rr: f64,
    yy: f64,
}

impl Sums {
    fn add(&mut self, asked: Complex, command: Complex, position: Complex) {
        self.ru += asked.conj() * command;
        self.ry += asked.conj() * position;
        self.rr += asked.norm_sqr();
        self.yy += position.norm_sqr();
    }
}
