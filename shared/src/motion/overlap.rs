//! Beams after a hold: where they went off, and from where on they may be open again.
//!
//! A seam has a gap where a beam goes off and on again at the same place. So the machine goes back before it goes
//! on, and the beam opens somewhat before the place where it went off, once the machine is at speed again.

use super::beams::{BeamLimits, Beams};
use crate::io::SIDES;
use crate::trajectory::{SpeedLimits, SpeedState};

/// Part of the speed at which a beam went off that it needs to go on again.
const AT_SPEED: f64 = 0.95;
/// How much longer the run-up is than the way that the machine needs at least.
const AMPLE: f64 = 1.25;

/// Beams that wait for their place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Where and how fast the machine was when they went off.
    off: SpeedState,
    /// Where each that waits may open again \[mm\].
    reopen: [Option<f64>; SIDES],
}

impl Overlap {
    /// For the beams that are on at `off` and do not stay on at rest, if there are any. None reopens before it
    /// went on at all.
    pub fn at(off: SpeedState, beams: &Beams, limits: &BeamLimits) -> Option<Self> {
        let reopen = core::array::from_fn(|side| {
            let since = beams.on_since(side)?;
            Some(libm::fmax(off.s - limits.overlap(side)?, since))
        });
        let some = reopen.iter().any(Option::is_some);
        some.then_some(Self { off, reopen })
    }

    /// Where to begin from, so that the machine is at speed in time; it stands at `stands` \[mm\], and `limits` are
    /// those along the path.
    pub fn run_up_from(&self, stands: f64, limits: &SpeedLimits) -> f64 {
        let limits = SpeedLimits {
            velocity: self.off.v,
            ..*limits
        };
        // It took so long to stop, and takes about that long to start.
        let way = libm::fmax(stands - self.off.s, limits.ramp());
        let reopen = self.reopen.iter().flatten();
        reopen.fold(self.off.s, |first, s| libm::fmin(first, *s)) - AMPLE * way
    }

    /// Takes the next position and speed; which beams are still to be kept off.
    pub fn pass(&mut self, now: &SpeedState) -> [bool; SIDES] {
        let at_speed = now.v >= AT_SPEED * self.off.v;
        for reopen in &mut self.reopen {
            *reopen = reopen.filter(|s| now.s < *s || (!at_speed && now.s < self.off.s));
        }
        self.reopen.map(|reopen| reopen.is_some())
    }

    /// No beam waits any more.
    pub fn is_over(&self) -> bool {
        self.reopen == [None; SIDES]
    }
}
