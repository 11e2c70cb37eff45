//! What is wrong with a bad machine: one motor of a usual one, so that no commissioning can make up for it.

use super::{DEGREES, Draw, ROTARY};
use plant::{ModeConfig, MotorConfig};
use std::fmt;

/// A defect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Defect {
    /// The drive is connected the wrong way round.
    Reversed,
    /// The grating counts nothing.
    DeadGrating,
    /// The drive is limited to hardly more than what friction takes.
    CurrentLimit,
    /// Play between motor and grating.
    Play,
    /// Friction that takes nearly all of the drive's current.
    Friction,
    /// Most of the load swings at some Hz.
    Resonance,
    /// The velocity loop of the drive is slow, and late.
    SlowDrive,
}

impl Defect {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Reversed,
        Self::DeadGrating,
        Self::CurrentLimit,
        Self::Play,
        Self::Friction,
        Self::Resonance,
        Self::SlowDrive,
    ];
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Reversed => "reversed drive",
            Self::DeadGrating => "dead grating",
            Self::CurrentLimit => "current limit",
            Self::Play => "play",
            Self::Friction => "friction",
            Self::Resonance => "low resonance",
            Self::SlowDrive => "slow drive",
        })
    }
}

impl Draw {
    /// Chooses one.
    pub(super) fn defect(&mut self) -> Defect {
        Defect::ALL[self.one_of(Defect::ALL.len())]
    }

    /// A whole number below `count`.
    pub(super) fn one_of(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }

    /// Gives `defect` to motor `number`.
    pub(super) fn spoil(&mut self, motor: &mut MotorConfig, number: usize, defect: Defect) {
        let unit = if number < ROTARY { 1.0 } else { DEGREES };
        let held = motor.mechanics.friction + motor.mechanics.stiction;
        match defect {
            Defect::Reversed => motor.drive.velocity_at_10v *= -1.0,
            Defect::DeadGrating => motor.grating.counts_per_unit = 0.0,
            Defect::CurrentLimit => motor.drive.max_acceleration = held * self.between(1.1, 1.4),
            Defect::Play => motor.mechanics.backlash = self.between(0.3, 0.8) * unit,
            Defect::Friction => {
                motor.mechanics.friction = motor.drive.max_acceleration * self.between(0.92, 0.97);
                motor.mechanics.stiction = 0.0;
            }
            Defect::Resonance => {
                let mode = ModeConfig {
                    frequency_hz: self.between(5.0, 12.0),
                    damping: self.between(0.02, 0.05),
                    motor: 1.0,
                    grating: -1.0,
                    tool: -1.0,
                };
                motor.mechanics.modes = [mode].into_iter().collect();
            }
            Defect::SlowDrive => {
                motor.drive.bandwidth_hz = self.between(1.0, 1.5);
                motor.drive.dead_time_s = 2e-3;
            }
        }
    }
}
