//! The visible gap: found in a strip along the sharp band, and distinguished from what is only dark.

mod candidate;
mod continuity;
mod edges;
mod ends;
mod interior;
mod levels;
mod roughness;
mod strip;

pub(crate) use candidate::{Candidate, Candidates};
pub(crate) use continuity::Continuity;
pub(crate) use edges::{Edges, fit_edges};
pub use ends::{EndKind, GapEnd};
pub(crate) use interior::Interior;
pub(crate) use levels::{softness, unevenness, without_shadow};
pub use strip::EDGE_ROWS_MM;
pub(crate) use strip::{BandLine, Strip};

/// Value between the two of `ends` where `share` of the way is gone.
fn between(ends: [f32; 2], share: f32) -> f32 {
    ends[0] + (ends[1] - ends[0]) * share
}

/// Median of the values, which are put into another order; of an even number the upper one of the middle.
fn median(values: &mut [f32]) -> Option<f32> {
    quantile(values, 0.5)
}

/// The value that `share` of the values do not reach, which are put into another order.
fn quantile(values: &mut [f32], share: f64) -> Option<f32> {
    if values.is_empty() {
        return None;
    }
    let place = ((values.len() as f64 * share) as usize).min(values.len() - 1);
    Some(*values.select_nth_unstable_by(place, f32::total_cmp).1)
}
