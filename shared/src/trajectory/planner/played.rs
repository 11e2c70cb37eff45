//! What was put out along a path, in short.

use crate::io::AXES;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// The references of a path so far, as told by whoever played them: where both agree, every reference was the same to the
/// bit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Played {
    /// Where the axes stood before (mm, rad).
    pub start: [f64; AXES],
    /// Path ticks since.
    pub ticks: u32,
    /// Of the positions of the axes at each of them, by FNV-1a over their bits, a word at a time.
    pub digest: u64,
}

impl Played {
    /// Nothing yet, with the axes at `start`.
    pub(super) const fn from(start: [f64; AXES]) -> Self {
        Self {
            start,
            ticks: 0,
            digest: 0xCBF2_9CE4_8422_2325,
        }
    }

    /// One tick more.
    pub(super) fn add(&mut self, position: &[f64; AXES]) {
        self.ticks = self.ticks.wrapping_add(1);
        for value in position {
            self.digest = (self.digest ^ value.to_bits()).wrapping_mul(0x100_0000_01B3);
        }
    }
}
