//! Error of a search that found nothing.

use shared::io::SIDES;
use std::fmt::{Display, Formatter, Result as FmtResult};
use thiserror::Error;

/// There is no seam where one should be. Reads as one sentence.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub struct NotFound {
    /// How far was searched across the seam and in height \[mm\].
    pub search_mm: f64,
    /// Where the seam of each side should be \[mm\].
    pub expected: [[f64; 3]; SIDES],
    /// Where it was seen \[mm\].
    pub found: [Option<[f64; 3]>; SIDES],
}

impl Display for NotFound {
    fn fmt(&self, f: &mut Formatter) -> FmtResult {
        let place = |[x, y, z]: [f64; 3]| format!("X{x:.1} Y{y:.1} Z{z:.1}");
        let reach = self.search_mm;
        let missing = (0..SIDES).find(|k| self.found[*k].is_none()).unwrap_or(0);
        let other = 1 - missing;
        let at = place(self.expected[missing]);
        match self.found[other] {
            None => write!(
                f,
                "no seam is seen on either side: camera 1 looked for it within {reach} mm of {at}, camera 2 of {}, \
                 across and in height; begin nearer to the seams (--from), search farther (search_mm in \
                 [t-seam.teaching]), or check lights and cameras",
                place(self.expected[other])
            ),
            Some(seen) => write!(
                f,
                "no seam is seen on side {}: its camera looked for it within {reach} mm of {at}, across and in height, \
                 while side {} is seen at {}; check what covers the seam there and whether the camera's light works, \
                 begin elsewhere (--from), or search farther (search_mm in [t-seam.teaching])",
                missing + 1,
                other + 1,
                place(seen)
            ),
        }
    }
}
