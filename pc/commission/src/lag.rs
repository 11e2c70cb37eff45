//! Gain and delay of a drive, for its feed-forward.

use crate::response::Response;
use nalgebra::{Matrix4, Vector4};
use std::f64::consts::TAU;

/// Up to here a drive with what it moves is a fraction of low order \[Hz\]: resonances lie above.
const SLOW_HZ: f64 = 20.0;
/// Fewest lines for both.
const FEWEST: usize = 6;

/// A slow command comes out as `gain` times itself, `delay_s` later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Speed for a command of 1.
    pub gain: f64,
    /// From a servo tick to the position of one \[s\].
    pub delay_s: f64,
}

impl Lag {
    /// Of the slow lines, where |jω·P|² = K²·(1 + a₁ω²)/(1 + b₁ω² + b₂ω⁴), which a PI loop on the speed of a rigid body is, and
    /// arg(jω·P) = −(τω + c₃ω³ + c₅ω⁵ + c₇ω⁷): K and τ are what a constant speed and a constant acceleration see. None if there
    /// are too few lines.
    pub fn of(response: &Response) -> Option<Self> {
        let slow = response.lines.iter().filter(|line| line.hz <= SLOW_HZ);
        // In units of the highest, so that all powers are of one size.
        let speeds: Vec<_> = slow
            .map(|line| {
                // j·P turns it by a quarter turn.
                let speed = TAU * line.hz * crate::Complex::i() * line.gain;
                (line.hz / SLOW_HZ, speed)
            })
            .collect();
        if speeds.len() < FEWEST {
            return None;
        }
        let square = least_squares(speeds.iter().map(|(part, speed)| {
            let (x, square) = (part * part, speed.norm_sqr());
            (Vector4::new(1.0, x, -square * x, -square * x * x), square)
        }))?;
        let phase = least_squares(speeds.iter().map(|(part, speed)| {
            let odd = |term: usize, _| part.powi(2 * term as i32 + 1);
            (Vector4::from_fn(odd), -speed.arg())
        }))?;
        (square > 0.0).then(|| Self {
            gain: square.sqrt(),
            delay_s: phase / (TAU * SLOW_HZ),
        })
    }
}

/// The first of the factors c in y = c·x with the least squares of the differences.
fn least_squares(pairs: impl Iterator<Item = (Vector4<f64>, f64)>) -> Option<f64> {
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for (x, y) in pairs {
        normal += x * x.transpose();
        right += x * y;
    }
    normal.lu().solve(&right).map(|found: Vector4<f64>| found.x)
}
