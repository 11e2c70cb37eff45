//! The power that a beam's source gives, where it is measured, against the one that is commanded.

use crate::config::ReadbackConfig;
use crate::io::DacCode;
use crate::parameter::{ParameterError, positive};
use crate::state::Fault;
use crate::ticks::SERVO_PERIOD_S;

/// A source whose gate is closed may read as so much of full power: 0.2 V of 10 V, for the offsets of its output and of
/// the converter, and noise on the cable.
pub const DARK: f64 = 0.02;

/// What is wrong with a beam's power.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Deviation {
    /// Nothing is measured.
    Unknown,
    /// There is power, and the gate is closed.
    NotOff,
    TooLow,
    TooHigh,
}

/// Compares one beam's measured power with its command, ready for the servo tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadbackCheck {
    /// Codes by which they may differ.
    tolerance: i32,
    /// Ticks for which they may differ by more.
    ticks: u32,
    /// Power at full code \[W\].
    full_w: f32,
}

/// Memory of a [`ReadbackCheck`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadbackState {
    deviation: Option<Deviation>,
    /// For so long.
    ticks: u32,
    /// The command of the last tick, `None` with the gate closed.
    commanded: Option<DacCode>,
}

impl ReadbackState {
    /// Takes note of what is commanded until the next tick.
    pub fn command(&mut self, gate: bool, power: DacCode) {
        self.commanded = gate.then_some(power);
    }
}

/// A part of full power in codes.
fn code(part: f64) -> i32 {
    i32::from(DacCode::from_ratio(part, 1.0).0)
}

impl ReadbackCheck {
    /// Checks the parameters of the beam called `owner`, whose full power is `full_w`.
    pub fn build(owner: &str, config: &ReadbackConfig, full_w: f64) -> Result<Self, ParameterError> {
        let tolerance = positive(owner, "readback.tolerance", config.tolerance)?;
        let time_s = positive(owner, "readback.time_ms", f64::from(config.time_ms))? * 1e-3;
        Ok(Self {
            tolerance: code(tolerance),
            ticks: (time_s / SERVO_PERIOD_S) as u32,
            full_w: full_w as f32,
        })
    }

    /// One look, `elapsed` ticks after the last one: the fault of beam `side` once it was wrong in the same way for
    /// longer than it may be. With the drives off no power need be measured.
    pub fn step(
        &self,
        state: &mut ReadbackState,
        side: usize,
        measured: Option<DacCode>,
        enabled: bool,
        elapsed: u32,
    ) -> Option<Fault> {
        let now = match measured {
            Some(measured) => self.compare(i32::from(measured.0), state.commanded),
            None => enabled.then_some(Deviation::Unknown),
        };
        if now.is_none() || now != state.deviation {
            state.deviation = now;
            state.ticks = 0;
        }
        state.ticks = state.ticks.saturating_add(elapsed);
        now.filter(|_| state.ticks > self.ticks)
            .map(|deviation| self.fault(deviation, side as u8, measured, state.commanded))
    }

    fn compare(&self, measured: i32, commanded: Option<DacCode>) -> Option<Deviation> {
        let dark = code(DARK);
        let Some(commanded) = commanded else {
            return (measured > dark).then_some(Deviation::NotOff);
        };
        let commanded = i32::from(commanded.0);
        let mut least = commanded - self.tolerance;
        if commanded >= 2 * dark {
            // Off is detected however small the power is, as long as it can be distinguished from zero.
            least = least.max(commanded / 2);
        }
        if measured < least {
            Some(Deviation::TooLow)
        } else {
            (measured > commanded + self.tolerance).then_some(Deviation::TooHigh)
        }
    }

    fn fault(
        &self,
        deviation: Deviation,
        side: u8,
        measured: Option<DacCode>,
        commanded: Option<DacCode>,
    ) -> Fault {
        let watt = |code: Option<DacCode>| self.full_w * code.unwrap_or_default().ratio() as f32;
        match deviation {
            Deviation::Unknown => Fault::BeamPowerUnknown { side },
            Deviation::NotOff => Fault::BeamNotOff {
                side,
                measured_w: watt(measured),
            },
            Deviation::TooLow | Deviation::TooHigh => Fault::BeamPower {
                side,
                commanded_w: watt(commanded),
                measured_w: watt(measured),
            },
        }
    }
}
