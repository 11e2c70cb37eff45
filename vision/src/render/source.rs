//! Where a row of a picture takes its texture from.

use super::tile::{Level, Tile};
use std::ops::Range;

/// A row of a tile.
pub(super) struct Source<'a> {
    levels: &'a [Level],
    row: usize,
    /// Its column that the picture begins at.
    begin: usize,
}

impl<'a> Source<'a> {
    pub fn new(tile: &'a Tile, row: usize, begin: usize) -> Self {
        let levels = tile.levels();
        Self { levels, row, begin }
    }

    /// The texture in `columns` of the picture: in each a blend of the two levels between which its blur lies.
    pub fn blend(&self, radii_squared: &[f32], columns: Range<usize>, out: &mut [f32]) {
        let radii_squared = &radii_squared[columns.clone()];
        let last = self.levels.len() - 2;
        let (mut at, mut k) = (0, 0);
        while at < out.len() {
            let squared = radii_squared[at];
            while k > 0 && squared < self.levels[k].radius_squared {
                k -= 1;
            }
            while k < last && squared >= self.levels[k + 1].radius_squared {
                k += 1;
            }
            let low = self.levels[k].radius_squared;
            let high = if k < last {
                self.levels[k + 1].radius_squared
            } else {
                f32::INFINITY
            };
            let rest = &radii_squared[at..];
            let count = rest
                .iter()
                .position(|&x| x < low || x >= high)
                .unwrap_or(rest.len());
            let from = self.begin + columns.start + at;
            self.blend_levels(k, from, &radii_squared[at..][..count], &mut out[at..][..count]);
            at += count;
        }
    }

    /// Blends level `k` with the next, the more the larger the blur; beyond the last one there is only that.
    fn blend_levels(&self, k: usize, from: usize, radii_squared: &[f32], out: &mut [f32]) {
        let (sharp, soft) = (&self.levels[k], &self.levels[k + 1]);
        let scale = 1.0 / (soft.radius_squared - sharp.radius_squared);
        let codes = sharp.row(self.row, from).iter().zip(soft.row(self.row, from));
        for ((out, squared), (&a, &b)) in out.iter_mut().zip(radii_squared).zip(codes) {
            let share = ((squared - sharp.radius_squared) * scale).min(1.0);
            let a = sharp.low + sharp.step * f32::from(a);
            let b = soft.low + soft.step * f32::from(b);
            *out = a + (b - a) * share;
        }
    }
}
