//! How a screen looks.

use crate::texts::Language;
use std::ops::RangeInclusive;

/// Sizes that can be chosen.
pub const SIZES: RangeInclusive<f32> = 0.75..=2.5;

/// How the screen looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// The language.
    pub language: Language,
    /// Black, white and few colours.
    pub high_contrast: bool,
    /// Stop and controls on the left.
    pub left_handed: bool,
    /// Size of everything; 1 is for a panel of 1280 × 800.
    pub zoom: f32,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            language: Language::default(),
            high_contrast: false,
            left_handed: false,
            zoom: 1.0,
        }
    }
}
