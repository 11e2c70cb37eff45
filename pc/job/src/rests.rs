//! Where a machine rested, one place after another, by a record of its job.

use host_link::record::Recorded;
use shared::io::AXES;
use shared::protocol::MotionSample;
use thiserror::Error;

/// Part of a rest that is not counted, in which the machine settles.
const SETTLING: f64 = 0.5;

/// A test whose rests are not all in the record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("the machine was seen at rest at {seen} of {wanted} places: telemetry is missing; repeat the test")]
pub struct NotSeen {
    /// Rests that were seen.
    seen: usize,
    /// All.
    wanted: usize,
}

/// Tells `rest` of each of the `wanted` rests, in their order, its number and its samples, once settled. The machine rests at a place where
/// it is on no path after the first one, and `is_there`, with what the board says of its axes (mm, rad).
///
/// # Errors
/// A rest is not in the record.
pub(crate) fn rests(
    record: &Recorded,
    wanted: usize,
    is_there: impl Fn(usize, &[f64; AXES]) -> bool,
    mut rest: impl FnMut(usize, &[MotionSample]),
) -> Result<(), NotSeen> {
    let (mut seen, mut begun) = (0, false);
    let mut resting: Vec<MotionSample> = Vec::new();
    let mut ends = |seen: &mut usize, resting: &mut Vec<MotionSample>| {
        if !resting.is_empty() {
            rest(*seen, &resting[(SETTLING * resting.len() as f64) as usize..]);
            *seen += 1;
            resting.clear();
        }
    };
    for sample in record.motion().iter() {
        begun |= sample.state.on_path();
        if begun && !sample.state.on_path() && seen < wanted && is_there(seen, &sample.axes) {
            resting.push(sample);
        } else {
            ends(&mut seen, &mut resting);
        }
    }
    ends(&mut seen, &mut resting);
    match seen < wanted {
        true => Err(NotSeen { seen, wanted }),
        false => Ok(()),
    }
}
