//! Permitted ranges of the parameters of drives, derived from their meaning.

use super::HomeConfig;
use crate::parameter::{ParameterError, within, within_either_sign};
use core::ops::RangeInclusive;

/// Shortest travel (mm or °).
pub const SHORTEST_TRAVEL: f64 = 0.1;
/// Counts in one mm or °: from one to ten million, a tenth of a nanometre.
pub const SCALES: RangeInclusive<f64> = 1.0..=1e7;
/// Counters of 16 bits must not go half their way round between two readings, or the direction is ambiguous.
pub const MOST_COUNTS: f64 = 32_767.0;
/// Reference marks may stand beside the travel by this part of it.
const BESIDE: f64 = 0.1;
/// A search goes over the travel there, back, and over the mark again.
const SEARCHES: f64 = 3.0;

/// Drives with holding brakes take tenths of a second until they follow commands \[ms\].
const ENABLES_MS: RangeInclusive<f64> = 0.0..=2000.0;

/// Time from the enable of the drives until they follow commands.
pub fn check_enable(drive_enable_ms: u32) -> Result<(), ParameterError> {
    within(
        "drives",
        "drive_enable_ms",
        f64::from(drive_enable_ms),
        ENABLES_MS,
    )
    .map(|_| ())
}

/// A search inside `travel`, no faster than `fastest`.
pub fn check_home(
    owner: &str,
    home: &HomeConfig,
    (min, max): (f64, f64),
    fastest: f64,
) -> Result<(), ParameterError> {
    let travel = max - min;
    let beside = BESIDE * travel;
    within_either_sign(owner, "home.velocity", home.velocity, 1e-3..=fastest)?;
    within(
        owner,
        "home.mark_position",
        home.mark_position,
        min - beside..=max + beside,
    )?;
    within(
        owner,
        "home.max_travel",
        home.max_travel,
        SHORTEST_TRAVEL..=SEARCHES * travel,
    )?;
    Ok(())
}
