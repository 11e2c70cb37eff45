//! Rounded corners, as terms that are added to the path.

use super::channels::{ATTITUDE, attitude_norm, position_norm};
use crate::trajectory::{CHANNELS, PathPoint, SHAPED};
use nalgebra::Vector3;

/// A corner that turns by this or more is sharp: it has a place where the acceleration turns, and is in no chain \[rad\].
pub(super) const SHARP: f64 = 0.5;

/// A corner: a jump of the direction, spread over `half` \[mm\] of path length on both sides.
///
/// It adds jump·h·(1−|y|)²/4 with y = (s − s₀)/h, so the direction changes evenly: the curve of least peak
/// acceleration. Terms that overlap simply add.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Change of the first derivatives over s.
    pub jump: [f64; CHANNELS],
    /// By how much the direction of the first channels changes \[rad\], if that is little.
    pub turn: f64,
    /// Largest jump of the attitude and the other channels.
    pub others: f64,
    /// Half the length \[mm\]; 0 where nothing is rounded.
    pub half: f64,
    /// Share of the output filter's tolerance for each unit of acceleration along the path, within so far \[mm\].
    pub strain: f64,
    /// So far; 0 where it needs no care.
    pub strained: f64,
}

impl Corner {
    pub const NONE: Self = Self {
        jump: [0.0; CHANNELS],
        turn: 0.0,
        others: 0.0,
        half: 0.0,
        strain: 0.0,
        strained: 0.0,
    };

    /// The jump from one direction to another.
    pub fn set_jump(&mut self, from: &[f64; CHANNELS], to: &[f64; CHANNELS]) {
        self.jump = core::array::from_fn(|i| to[i] - from[i]);
        self.turn = position_norm(&self.jump);
        self.others = self.jump[ATTITUDE.end..]
            .iter()
            .fold(attitude_norm(&self.jump), |most, jump| {
                libm::fmax(most, libm::fabs(*jump))
            });
    }

    /// The direction of the first channels changes by so much more.
    pub fn turn_by(&mut self, more: Vector3<f64>) {
        for i in 0..SHAPED {
            self.jump[i] += more[i];
        }
        self.turn = position_norm(&self.jump);
    }

    /// Adds the corner to `point`, `s` \[mm\] after it.
    pub fn add_to<const N: usize>(&self, point: &mut PathPoint<N>, s: f64) {
        let away = libm::fabs(s);
        if away >= self.half {
            return;
        }
        let per_half = 1.0 / self.half;
        let rest = 1.0 - away * per_half;
        let value = 0.25 * self.half * rest * rest;
        let first = -libm::copysign(0.5 * rest, s);
        let second = 0.5 * per_half;
        for i in 0..N {
            point.value[i] += self.jump[i] * value;
            point.first[i] += self.jump[i] * first;
            point.second[i] += self.jump[i] * second;
        }
    }
}
