//! Gain and delay of a drive, for its feed-forward.

use crate::response::Response;
use std::f64::consts::TAU;

/// Up to here a drive is its gain and its delay \[Hz\]: resonances lie above.
const SLOW_HZ: f64 = 20.0;
/// Fewest lines for both.
const FEWEST: usize = 4;

/// A slow command comes out as `gain` times itself, `delay_s` later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Speed for a command of 1.
    pub gain: f64,
    /// From a servo tick to the position of one \[s\].
    pub delay_s: f64,
}

impl Lag {
    /// Of the slow lines: jω·P = K·exp(−jωτ). None if there are too few of them.
    pub fn of(response: &Response) -> Option<Self> {
        let slow = response.lines.iter().filter(|line| line.hz <= SLOW_HZ);
        let speeds: Vec<_> = slow
            .map(|line| {
                let omega = TAU * line.hz;
                // j·P turns it by a quarter turn.
                (omega, omega * crate::Complex::i() * line.gain)
            })
            .collect();
        if speeds.len() < FEWEST {
            return None;
        }
        let gain = speeds.iter().map(|(_, speed)| speed.norm()).sum::<f64>() / speeds.len() as f64;
        let (above, below) = speeds.iter().fold((0.0, 0.0), |(above, below), (omega, speed)| {
            (above - omega * speed.arg(), below + omega * omega)
        });
        Some(Self {
            gain,
            delay_s: above / below,
        })
    }
}
