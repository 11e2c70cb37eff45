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
    /// Keys to type with come up where something is typed into.
    pub keys_on_screen: bool,
    /// Size of everything; 1 is for a panel of 1280 × 800.
    pub zoom: f32,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            language: Language::default(),
            high_contrast: false,
            left_handed: false,
            keys_on_screen: false,
            zoom: 1.0,
        }
    }
}
