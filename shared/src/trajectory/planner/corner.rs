//! Rounded corners, as terms that are added to the path.

use crate::trajectory::{CHANNELS, PathPoint};

/// A corner: a jump of the direction, spread over `half` \[mm\] of path length on both sides.
///
/// It adds jump·h·(1−|y|)²/4 with y = (s − s₀)/h, so the direction changes evenly: the curve of least peak
/// acceleration. Terms that overlap simply add.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Change of the first derivatives over s.
    pub jump: [f64; CHANNELS],
    /// Half the length \[mm\]; 0 where nothing is rounded.
    pub half: f64,
}

impl Corner {
    pub const NONE: Self = Self {
        jump: [0.0; CHANNELS],
        half: 0.0,
    };

    /// Adds the corner to `point`, `s` \[mm\] after it.
    pub fn add_to(&self, point: &mut PathPoint, s: f64) {
        let away = libm::fabs(s);
        if away >= self.half {
            return;
        }
        let per_half = 1.0 / self.half;
        let rest = 1.0 - away * per_half;
        let value = 0.25 * self.half * rest * rest;
        let first = -libm::copysign(0.5 * rest, s);
        let second = 0.5 * per_half;
        for i in 0..CHANNELS {
            point.value[i] += self.jump[i] * value;
            point.first[i] += self.jump[i] * first;
            point.second[i] += self.jump[i] * second;
        }
    }
}
