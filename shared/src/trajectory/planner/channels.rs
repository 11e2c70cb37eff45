//! The channels of a point in their groups, and when two points or directions are the same.

use crate::trajectory::{CHANNELS, SHAPED};

/// Channels that make a pose: position, T and N.
pub(super) const POSE_CHANNELS: usize = 9;
/// Channels of attitude (or axes A B C); after them come the V slides \[mm\].
pub(super) const ATTITUDE: core::ops::Range<usize> = SHAPED..CHANNELS - 2;
/// Places nearer than this are one \[mm\].
pub(super) const SAME: f64 = 1e-9;
/// Smaller changes of direction do not count.
pub(super) const SMOOTH: f64 = 1e-9;

/// Length of the change of the first channels.
pub(super) fn position_norm(jump: &[f64]) -> f64 {
    libm::sqrt(jump[..SHAPED].iter().map(|x| x * x).sum())
}

/// Length of the change of the attitude: of A B C together, or of T or N, whichever is more.
pub(super) fn attitude_norm(jump: &[f64]) -> f64 {
    let square = |range: core::ops::Range<usize>| jump[range].iter().map(|x| x * x).sum::<f64>();
    let (middle, end) = (SHAPED + 3, ATTITUDE.end.min(jump.len()));
    libm::sqrt(libm::fmax(square(SHAPED..middle), square(middle..end)))
}
