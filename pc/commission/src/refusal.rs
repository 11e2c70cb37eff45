//! Why a motor is not commissioned, by what was measured of it.

use crate::design::{Loop, least_gain};
use crate::friction::{left, over_time};
use crate::plan::{COUNTS_AT_REST, TURNS_HZ};
use crate::response::Response;
use crate::{Complex, spectrum};
use shared::control::{FrictionConfig, MotorConfig};
use shared::io::DacCode;
use shared::motion::Chirp;
use shared::parameter::ParameterError;
use shared::protocol::{CAPTURE_TICKS, CaptureSample};
use std::f64::consts::TAU;
use thiserror::Error;

/// Least proportional gain \[1/s\]: 1 m/min for each mm, to which controllers of machine tools are set as they come.
const LEAST_KP: f64 = 1000.0 / 60.0;
/// Part of the acceleration of the axis that a drive has to reach.
const REACHED: f64 = 0.8;
/// What a motor at rest swings by at most, as a multiple of what it is shaken by.
const OWN_SWING: f64 = 10.0;
/// What a motor may cost the tool where it turns round \[mm\]: all that a spot may be beside its seam as machines are shipped.
const MOST_LOST_MM: f64 = 0.05;
/// Part of what a drive is told that may be lost where it turns round: gain and delay of the drive are not known much more exactly,
/// and friction takes some hundredths.
const MOST_LOST: f64 = 0.1;

/// What is wrong with a motor, its drive or what it moves.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum Refusal {
    /// It does not reach the acceleration of its axis.
    #[error(
        "acceleration: its drive reaches {:.0} % of the max_acceleration of its axis: the current limit of the drive is too low, or \
         friction too large; or lower max_acceleration", 100.0 * .part
    )]
    Acceleration {
        /// Part of it that is reached.
        part: f64,
    },
    /// Friction or play.
    #[error(
        "friction or play: where it turns round the tool would be {lost_mm:.3} mm off (at most {MOST_LOST_MM} mm): look at guides, \
         covers, bearings, gears and couplings, and at the scale's mount"
    )]
    Lost {
        /// How far the tool would be off, in the loop with the margins and what feed-forward of friction does \[mm\].
        lost_mm: f64,
    },
    /// Its grating goes less far than its drive is told.
    #[error(
        "friction or play: where it turns round {lost_mm:.3} mm of what its drive is told do not come to its grating (at most {MOST_LOST_MM} mm): \
         look at bearings, gears and couplings, and at the scale's mount"
    )]
    Play {
        /// How far the tool is off without the position loop \[mm\].
        lost_mm: f64,
    },
    /// Its mechanics swing at a low frequency.
    #[error(
        "resonance: what it moves swings at {hz:.1} Hz, which allows a kp of {kp:.1} 1/s (at least {LEAST_KP:.1} 1/s): stiffen or lighten \
         it, or look for what is loose"
    )]
    Resonance {
        /// Where \[Hz\].
        hz: f64,
        /// Highest proportional gain with the margins \[1/s\]; 0 if there is none.
        kp: f64,
    },
    /// It swings by itself in the loop that it was measured in, so its response is not known.
    #[error(
        "resonance: what it moves swings at {hz:.1} Hz by itself, also in slow loops, so nothing can be measured: stiffen or lighten it, \
         or look for what is loose"
    )]
    Swings {
        /// Where \[Hz\].
        hz: f64,
    },
    /// Its drive follows slowly or late.
    #[error(
        "slow drive: it follows commands so late that a kp of {kp:.1} 1/s is the highest (at least {LEAST_KP:.1} 1/s): raise the gains \
         of the drive's velocity loop, and take filters out of its command"
    )]
    SlowDrive {
        /// Highest proportional gain with the margins \[1/s\]; 0 if there is none.
        kp: f64,
    },
}

/// What was measured of a motor.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// As the machine file has it.
    pub motor: &'a MotorConfig,
    /// Its response, if that is believed.
    pub response: Option<&'a Response>,
    /// The loop with the margins, if there is one.
    pub designed: Option<&'a Loop>,
    /// A period in which it turned round.
    pub turning: &'a [CaptureSample],
    /// The friction that was found in it.
    pub friction: Option<&'a FrictionConfig>,
    /// A period on its way in which its command was a sine that asks for the acceleration of its axis, whose frequency \[Hz\] is a line of the capture.
    pub swung: Option<(f64, &'a [CaptureSample])>,
    /// A period at rest, shaken by some counts.
    pub resting: &'a [CaptureSample],
    /// How far the tool moves with it \[mm for each mm or °\].
    pub tool_mm: f64,
}

impl Measured<'_> {
    /// Why this motor has to be seen to before it is commissioned; none if nothing speaks against it.
    ///
    /// # Errors
    /// A parameter of the motor is out of range.
    pub fn refusal(&self) -> Result<Option<Refusal>, ParameterError> {
        let acceleration = self.reached().filter(|part| *part < REACHED);
        let acceleration = acceleration.map(|part| Refusal::Acceleration { part });
        // One that swings by itself tells little of what it answers, also where the lines that are not believed are small.
        let enough = self.response.is_some_and(|response| response.check().is_ok());
        if !enough && let Some(hz) = self.swings_at() {
            return Ok(Some(Refusal::Swings { hz }));
        }
        let (None, Some(response)) = (&acceleration, self.response) else {
            return Ok(acceleration);
        };
        let kp = self.designed.map_or(0.0, |designed| designed.motor.kp);
        if kp < LEAST_KP {
            let swings = self.swings_at().map(|hz| Refusal::Resonance { hz, kp });
            let limits = least_gain(response, self.motor, LEAST_KP)?;
            let limits = limits.map_or(Refusal::SlowDrive { kp }, |hz| Refusal::Resonance { hz, kp });
            return Ok(Some(swings.unwrap_or(limits)));
        }
        let Some(designed) = self.designed else {
            return Ok(None);
        };
        let lost_mm = self.undone(designed) * self.tool_mm;
        if lost_mm > MOST_LOST_MM {
            return Ok(Some(Refusal::Play { lost_mm }));
        }
        let lost_mm = self.lost(response, designed)? * self.tool_mm;
        Ok((lost_mm > MOST_LOST_MM).then_some(Refusal::Lost { lost_mm }))
    }

    /// Where it swings by itself at rest \[Hz\]; none if it does not.
    fn swings_at(&self) -> Option<f64> {
        let whole = Some(self.resting).filter(|samples| samples.len() == CAPTURE_TICKS)?;
        let counts = spectrum(whole.iter().map(|sample| f64::from(sample.counts)));
        let lines = (1..CAPTURE_TICKS / 2).map(|line| (line, amplitude(&counts[line])));
        let (line, highest) = lines.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
        (highest > OWN_SWING * COUNTS_AT_REST).then_some(line as f64 * Chirp::LINE_HZ)
    }

    /// Part of the acceleration of the axis that is reached while its command asks for that much; none if the response is not
    /// known at that frequency.
    fn reached(&self) -> Option<f64> {
        let (hz, samples) = self.swung.filter(|(_, samples)| samples.len() == CAPTURE_TICKS)?;
        let gain = match self.response {
            None => 1.0,
            Some(response) => {
                let line = response.lines.iter().find(|line| line.hz == hz)?;
                line.gain.norm() * TAU * hz
            }
        };
        let line = (hz / Chirp::LINE_HZ).round() as usize;
        let counts = spectrum(samples.iter().map(|sample| f64::from(sample.counts)));
        let position = amplitude(&counts[line]) / self.motor.counts_per_unit.abs();
        let codes = spectrum(samples.iter().map(|sample| DacCode(sample.command).ratio()));
        let command = amplitude(&codes[line]) * self.motor.velocity_at_10v.abs();
        // The loop takes some of what is asked for back.
        let asked = command * gain * TAU * hz;
        (asked > 0.0).then(|| position * (TAU * hz) * (TAU * hz) / asked)
    }

    /// How much less far than its drive is told the motor goes where it turns round (mm or °); 0 if that may be what is not known
    /// of the drive. Behind play that is larger than its way, the grating hardly moves, and in the loop that costs little.
    fn undone(&self, designed: &Loop) -> f64 {
        if self.turning.len() != CAPTURE_TICKS {
            return 0.0;
        }
        let line = (TURNS_HZ / Chirp::LINE_HZ).round() as usize;
        let omega = TAU * TURNS_HZ;
        let counts = spectrum(self.turning.iter().map(|sample| f64::from(sample.counts)))[line];
        let codes = spectrum(self.turning.iter().map(|sample| DacCode(sample.command).ratio()))[line];
        // So slow that the drive is a gain and a delay.
        let drive = Complex::from_polar(
            designed.lag.gain / omega,
            -TAU / 4.0 - omega * designed.lag.delay_s,
        );
        let told = codes * self.motor.velocity_at_10v * drive;
        let off = told - counts / self.motor.counts_per_unit;
        if off.norm() > MOST_LOST * told.norm() {
            amplitude(&off)
        } else {
            0.0
        }
    }

    /// How far the motor would be off where it turns round as in the capture, in the loop with the margins and its feed-forward of friction (mm or °).
    fn lost(&self, response: &Response, designed: &Loop) -> Result<f64, ParameterError> {
        if self.turning.len() != CAPTURE_TICKS {
            return Ok(0.0);
        }
        let sensitivity = designed.sensitivity(self.motor)?;
        let left = left(response, self.turning, self.motor, self.friction)?;
        let closed = left.iter().filter_map(|(number, left)| {
            let hz = *number as f64 * Chirp::LINE_HZ;
            let line = response.lines.iter().find(|line| line.hz == hz)?;
            Some((*number, left * sensitivity(*number, line.gain)))
        });
        Ok(over_time(closed)
            .into_iter()
            .fold(0.0, |most, off| most.max(off.abs())))
    }
}

/// Of a line of a spectrum.
fn amplitude(line: &Complex) -> f64 {
    line.norm() * 2.0 / CAPTURE_TICKS as f64
}
