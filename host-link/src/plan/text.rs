//! NC text: numbered blocks with fixed decimals (SPEC 2.6).

use shared::units::round_half_away;
use std::fmt::Write;

/// Decimals of lengths \[mm\] and of angles \[deg\].
const LENGTH_DECIMALS: i32 = 5;
const ANGLE_DECIMALS: i32 = 6;

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
    let mut words = String::new();
    let lengths = ["X", "Y", "Z"]
        .into_iter()
        .zip(position)
        .map(|p| (p, LENGTH_DECIMALS));
    let angles = ["A", "B", "C"]
        .into_iter()
        .zip(angles_deg)
        .map(|p| (p, ANGLE_DECIMALS));
    let slides = ["V1=", "V2="]
        .into_iter()
        .zip(extension)
        .map(|p| (p, LENGTH_DECIMALS));
    for ((address, value), decimals) in lengths.chain(angles).chain(slides) {
        let gap = if words.is_empty() { "" } else { " " };
        // Writing to a String cannot fail.
        let _ = write!(words, "{gap}{address}{}", decimal(*value, decimals));
    }
    words
}

/// `x` with fixed decimals, halves away from zero, never "-0".
pub fn decimal(x: f64, decimals: i32) -> String {
    let scale = 10f64.powi(decimals);
    // Adding zero turns −0 into 0.
    let rounded = round_half_away(x * scale) / scale + 0.0;
    format!("{rounded:.*}", decimals as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_round_away_from_zero_and_know_no_negative_zero() {
        assert_eq!(decimal(0.125, 2), "0.13");
        assert_eq!(decimal(-0.125, 2), "-0.13");
        assert_eq!(decimal(-0.001, 2), "0.00");
        assert_eq!(decimal(4999.999995, 5), "5000.00000");
    }
}
