//! A quantity along the seam, and where it steps from one value to another.

use super::{APART, BEFORE_MM, MOST, SHARP, SHARP_MM};

/// What is seen along the seam, from one end of the picture to the other: sums of a quantity times its weight, and of weights.
pub(super) struct Course {
    pub(super) sums: [[f64; 2]; MOST + 1],
    pub(super) squares: [f64; MOST + 1],
    pub(super) count: usize,
}

/// Places along the seam.
#[derive(Clone, Copy)]
pub(super) struct Rule {
    /// Bin in which the band is.
    pub(super) band: usize,
    /// Bins a mm along travel.
    pub(super) per_mm: f64,
    /// Bins of blur for each bin from the band.
    pub(super) blur: f64,
}

/// A step of a course.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// Bins from the beginning of the course.
    pub(super) place: f64,
    pub(super) sigma: f64,
}

impl Course {
    pub(super) fn new(values: &[[f32; 2]]) -> Self {
        let mut course = Self {
            sums: [[0.0; 2]; MOST + 1],
            squares: [0.0; MOST + 1],
            count: values.len(),
        };
        for (k, [value, weight]) in values.iter().enumerate() {
            let [value, weight] = [f64::from(*value), f64::from(*weight)];
            let [sum, weights] = course.sums[k];
            course.sums[k + 1] = [sum + value * weight, weights + weight];
            course.squares[k + 1] = course.squares[k] + value * value * weight;
        }
        course
    }

    /// Mean and variance in bins `from..to`. None if most of them are unknown.
    pub(super) fn mean(&self, from: usize, to: usize) -> Option<[f64; 2]> {
        let [sum, weights] = [0, 1].map(|i| self.sums[to][i] - self.sums[from][i]);
        if to <= from || weights <= 0.0 {
            return None;
        }
        let mean = sum / weights;
        let squares = (self.squares[to] - self.squares[from]) / weights;
        Some([mean, (squares - mean * mean).max(0.0)])
    }

    /// Mean as far on the other side of the band, as far as that is in the picture.
    pub(super) fn mirrored(&self, rule: &Rule, from: usize, to: usize) -> Option<f64> {
        let [first, last] = [to, from].map(|k| (2 * rule.band + 1).checked_sub(k));
        let (first, last) = (first.unwrap_or(0), last?);
        (2 * (last - first) > to - from).then(|| self.mean(first, last).map(|[mean, _]| mean))?
    }

    /// The first place after the band where it goes from what `is_there` to what `is_gone`, for `lasts` mm.
    pub(super) fn step(
        &self,
        rule: &Rule,
        lasts_mm: f64,
        is_there: impl Fn(f64) -> bool,
        is_gone: impl Fn(f64) -> bool,
        mirrored: bool,
    ) -> Option<Step> {
        let bins = |mm: f64| (mm * rule.per_mm).round().max(3.0) as usize;
        let (before, lasts, sharp) = (bins(BEFORE_MM), bins(lasts_mm), bins(SHARP_MM));
        let mut best: Option<(f64, usize, Step)> = None;
        for k in rule.band..self.count {
            let reach = (rule.blur * (k - rule.band) as f64).ceil() as usize + 1;
            let (last, first) = (k.saturating_sub(reach), k + reach);
            if first + lasts > self.count || best.is_some_and(|(_, at, _)| k > at + lasts / 2) {
                break;
            }
            let (Some([there, v_there]), Some([gone, v_gone])) = (
                self.mean(last.saturating_sub(before), last),
                self.mean(first, first + lasts),
            ) else {
                continue;
            };
            // All of it, not only most.
            let half = first + lasts / 2;
            let whole = [(first, half), (half, first + lasts)]
                .into_iter()
                .all(|(from, to)| self.mean(from, to).is_some_and(|[mean, _]| is_gone(mean)));
            if !(is_there(there) && whole) {
                continue;
            }
            let contrast = (there - gone).abs();
            let (Some([near_there, _]), Some([near_gone, _])) = (
                self.mean(last.saturating_sub(sharp), last),
                self.mean(first, first + sharp),
            ) else {
                continue;
            };
            if (near_gone - near_there) * (gone - there).signum() < SHARP * contrast {
                continue;
            }
            if best.is_some_and(|(most, ..)| contrast <= most) {
                continue;
            }
            if mirrored
                && self
                    .mirrored(rule, first, first + lasts)
                    .is_some_and(|same| (same - gone).abs() < APART * contrast)
            {
                continue;
            }
            let [from, to] = [last.saturating_sub(1), (first + 1).min(self.count)];
            let Some([mean, _]) = self.mean(from, to) else {
                continue;
            };
            let length = (to - from) as f64;
            let place = from as f64 + length * ((mean - gone) / (there - gone)).clamp(0.0, 1.0);
            // Texture is alike in neighbouring bins, blurred texture farther.
            let alike = 2.0 + 2.0 * reach as f64;
            let sigma = ((v_there + v_gone) / 2.0 * length.min(alike) * length).sqrt() / contrast;
            best = Some((contrast, k, Step { place, sigma }));
        }
        best.map(|(.., step)| step)
    }
}
