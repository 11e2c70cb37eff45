//! Gain and delay of a drive, for its feed-forward.

use crate::response::Response;
use std::f64::consts::TAU;

/// Up to here a drive is its gain and its delay \[Hz\]: resonances lie above.
const SLOW_HZ: f64 = 16.0;
/// Fewest lines for both.
const FEWEST: usize = 5;

/// A slow command comes out as `gain` times itself, `delay_s` later.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Speed for a command of 1.
    pub gain: f64,
    /// From a servo tick to the position of one \[s\].
    pub delay_s: f64,
}

impl Lag {
    /// Of the slow lines, where jω·P = K·(1 + aω²)·exp(−jω·(τ + bω²)): K and τ are what a constant speed sees, the other two are
    /// the beginning of what the drive does to a fast one. None if there are too few lines.
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
        let of = |value: &dyn Fn(&(f64, crate::Complex)) -> [f64; 3]| least_squares(speeds.iter().map(value));
        Some(Self {
            gain: of(&|(omega, speed)| [1.0, omega * omega, speed.norm()])?,
            delay_s: of(&|(omega, speed)| [*omega, omega * omega * omega, -speed.arg()])?,
        })
    }
}

/// The factor of `x` in y = c·x + d·z with the least squares of the differences, of triples x, z, y.
fn least_squares(triples: impl Iterator<Item = [f64; 3]>) -> Option<f64> {
    let [mut xx, mut xz, mut zz, mut xy, mut zy] = [0.0; 5];
    for [x, z, y] in triples {
        xx += x * x;
        xz += x * z;
        zz += z * z;
        xy += x * y;
        zy += z * y;
    }
    let determinant = xx * zz - xz * xz;
    (determinant > 0.0).then(|| (xy * zz - zy * xz) / determinant)
}
