//! The true speed of the tip.

use crate::WorkTick;
use nalgebra::Vector3;
use shared::ticks::PATH_PERIOD_S;

/// The true speed is that of the way over so many ticks before and after, 8 ms in all: a grating of 0.1 µm then makes
/// less than 0.02 mm/s of noise.
const HALF: usize = 4;
/// Slow processes are looked at over at least so much before and after \[mm\]: what is shorter does not show in a seam,
/// and a drive that sticks for a micrometre is no change of speed.
pub(crate) const HALF_MM: f64 = 0.05;

/// Gives each tick the true speed, from where the tips were before and after it on the same path.
pub(super) fn add_true_speeds(ticks: &mut [WorkTick], tips: &[Option<Vector3<f64>>]) {
    // Way from the beginning, and ticks without a known tip; a path goes on from tick to tick.
    let (mut way, mut unknown) = (vec![0.0; ticks.len()], vec![0_u32; ticks.len()]);
    let mut path = vec![0..0; ticks.len()];
    for i in 1..ticks.len() {
        let step = tips[i]
            .zip(tips[i - 1])
            .map(|(tip, before)| (tip - before).norm());
        way[i] = way[i - 1] + step.unwrap_or(0.0);
        unknown[i] = unknown[i - 1] + u32::from(step.is_none());
    }
    let mut start = 0;
    for chunk in ticks.chunk_by(|a, b| a.path_id == b.path_id) {
        let end = start + chunk.len();
        path[start..end].fill(start..end);
        start = end;
    }
    for i in 0..ticks.len() {
        let slow = HALF_MM / (ticks[i].feed_mm_s * PATH_PERIOD_S);
        let half = HALF.max(if slow.is_finite() { slow.ceil() as usize } else { 0 });
        let from = i.saturating_sub(half).max(path[i].start);
        let to = (i + half).min(path[i].end - 1);
        let time = f64::from(ticks[to].tick - ticks[from].tick) * PATH_PERIOD_S;
        let known = unknown[to] == unknown[from] && time > 0.0;
        ticks[i].true_speed_mm_s = known.then_some((way[to] - way[from]) / time);
    }
}
