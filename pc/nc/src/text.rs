//! NC text: numbered blocks with fixed decimals (mathematics 2.6).

use shared::io::{AXES, AXIS_NAMES};
use shared::kinematics::{AXIS_UNIT, AxisLimits};
use shared::units::round_half_away;
use std::fmt::Write;
use thiserror::Error;

/// Decimals of lengths \[mm\] and of angles \[deg\].
const LENGTH_DECIMALS: i32 = 5;
const ANGLE_DECIMALS: i32 = 6;

/// Decimals of a block in machine coordinates: X Y Z \[mm\], A B C \[deg\], and feed \[mm/min\].
const AXIS_DECIMALS: [i32; AXES] = [3, 3, 3, 4, 4, 4];
const FEED_DECIMALS: i32 = 1;

/// Why a block is not written.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum BlockError {
    /// The number as it would be written is outside the travel of its axis, or not a number (mm, degrees).
    #[error("{axis}{value} is outside the travel of the axis, {min} to {max}: move or turn the work")]
    Outside {
        /// Letter of the axis.
        axis: &'static str,
        /// What would be written.
        value: f64,
        /// Lowest position.
        min: f64,
        /// Highest position.
        max: f64,
    },
    /// The feed as it would be written is zero, negative or not a number \[mm/min\].
    #[error("F{0} is not a feed: it must be above zero")]
    Feed(f64),
}

/// An NC program while it is written.
#[derive(Debug, Default)]
pub struct NcText {
    text: String,
    number: u32,
}

impl NcText {
    /// A comment on a line of its own; parentheses become brackets.
    pub fn comment(&mut self, comment: &str) {
        let comment = comment.replace('(', "[").replace(')', "]");
        self.line(&format!("({comment})"));
    }

    /// A line without a number.
    pub fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// A block with the next number.
    pub fn block(&mut self, words: &str) {
        self.number += 10;
        let number = self.number;
        self.line(&format!("N{number} {words}"));
    }

    /// The whole text.
    pub fn finish(self) -> String {
        self.text
    }
}

/// A tip as words: X Y Z A B C V1= V2=.
pub fn tip_words(position: &[f64; 3], angles_deg: &[f64; 3], extension: &[f64; 2]) -> String {
    let addresses = ["X", "Y", "Z", "A", "B", "C", "V1=", "V2="];
    let values = position.iter().chain(angles_deg).chain(extension).copied();
    words(addresses.into_iter().zip(values))
}

/// Words of a block: addresses and values (mm, degrees at A B C).
pub fn words<'a>(words: impl IntoIterator<Item = (&'a str, f64)>) -> String {
    let words = words.into_iter().map(|(address, value)| {
        let angle = matches!(address, "A" | "B" | "C");
        let decimals = if angle { ANGLE_DECIMALS } else { LENGTH_DECIMALS };
        format!("{address}{}", decimal(value, decimals))
    });
    words.collect::<Vec<_>>().join(" ")
}

/// Block number `number` that moves the axes of a machine to `axes` (X Y Z A B C; mm, rad) in machine coordinates,
/// at `feed` \[mm/min\] (mathematics 2.6). For controllers without tool-centre-point control: solved pose by
/// pose, it keeps the focus in place while the rotary axes turn, as far as the poses are close together.
///
/// Only the `fitted` axes get a word, and what is written is within `limits`, rounding included.
pub fn machine_block(
    number: u32,
    axes: &[f64; AXES],
    fitted: &[bool; AXES],
    limits: &[AxisLimits; AXES],
    feed: f64,
) -> Result<String, BlockError> {
    let mut block = format!("N{number} G01");
    for axis in (0..AXES).filter(|&axis| fitted[axis]) {
        let (unit, decimals, limit) = (AXIS_UNIT[axis], AXIS_DECIMALS[axis], &limits[axis]);
        let value = rounded(axes[axis] / unit, decimals);
        if !limit.contains(value * unit) {
            return Err(BlockError::Outside {
                axis: AXIS_NAMES[axis],
                value,
                min: limit.min / unit,
                max: limit.max / unit,
            });
        }
        // Writing to a String cannot fail.
        let _ = write!(block, " {}{}", AXIS_NAMES[axis], decimal(value, decimals));
    }
    let written = rounded(feed, FEED_DECIMALS);
    if !(written > 0.0 && written.is_finite()) {
        return Err(BlockError::Feed(feed));
    }
    let _ = write!(block, " F{}", decimal(written, FEED_DECIMALS));
    Ok(block)
}

/// `x` with fixed decimals, halves away from zero, never "-0". There is always a decimal point: some controllers
/// read a number without one in increments.
pub fn decimal(x: f64, decimals: i32) -> String {
    format!("{:.*}", decimals.max(1) as usize, rounded(x, decimals))
}

/// `x` to so many decimals, halves away from zero, never −0.
fn rounded(x: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    // Adding zero turns −0 into 0.
    round_half_away(x * scale) / scale + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::kinematics::AxisConfig;

    #[test]
    fn decimals_round_away_from_zero_and_know_no_negative_zero() {
        assert_eq!(decimal(0.125, 2), "0.13");
        assert_eq!(decimal(-0.125, 2), "-0.13");
        assert_eq!(decimal(-0.001, 2), "0.00");
        assert_eq!(decimal(4999.999995, 5), "5000.00000");
        assert_eq!(decimal(-2.5, 0), "-3.0");
    }

    /// Limits of all axes: ±`travel` (mm, degrees).
    fn limits(travel: f64) -> [AxisLimits; AXES] {
        let config = AxisConfig {
            travel_min: -travel,
            travel_max: travel,
            max_velocity: 1.0,
            max_acceleration: 1.0,
            max_jerk: 1.0,
        };
        AxisLimits::build_all(&[(); AXES].map(|()| Some(config.clone()))).unwrap()
    }

    #[test]
    fn a_machine_block_has_the_fitted_axes_only() {
        let axes = [-0.0004, 2.0005, 3.0, 0.5, 0.5, std::f64::consts::FRAC_PI_2];
        let fitted = [true, true, true, false, true, true];
        assert_eq!(
            machine_block(20, &axes, &fitted, &limits(90.0), 60.0).unwrap(),
            "N20 G01 X0.000 Y2.001 Z3.000 B28.6479 C90.0000 F60.0"
        );
    }

    #[test]
    fn nothing_outside_the_travel_is_written_not_even_by_rounding() {
        let block = |x, travel, feed| {
            machine_block(
                1,
                &[x, 0.0, 0.0, 0.0, 0.0, 0.0],
                &[true; AXES],
                &limits(travel),
                feed,
            )
        };
        assert!(block(9.9994, 9.9995, 1.0).is_ok());
        let error = block(9.9995, 9.9995, 1.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "X10 is outside the travel of the axis, -9.9995 to 9.9995: move or turn the work"
        );
        assert!(block(-11.0, 10.0, 1.0).is_err() && block(f64::NAN, 10.0, 1.0).is_err());
        for feed in [0.0, 0.04, -1.0, f64::NAN, f64::INFINITY] {
            assert!(
                matches!(block(0.0, 10.0, feed), Err(BlockError::Feed(_))),
                "{feed}"
            );
        }
    }
}
