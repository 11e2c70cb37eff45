//! Beams after a hold: where they went off, and from where on they may be open again.
//!
//! A seam has a gap where a beam goes off and on again at the same place. So the machine goes back before it goes
//! on, and the beam opens somewhat before the place where it went off, once the machine is at speed again. A beam that
//! waits for its place continues waiting through further holds, until it has been open there.

use super::beams::{BeamLimits, Beams};
use crate::io::SIDES;
use crate::ticks::PATH_PERIOD_S;
use crate::trajectory::{SpeedLimits, SpeedState};

/// Part of its speed that a beam needs to go on again.
const AT_SPEED: f64 = 0.95;
/// How much longer the run-up is than the way that the machine needs at least.
const AMPLE: f64 = 1.25;

/// A hold, and the beams that wait for their place after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Where and how fast the machine was: events up to there have happened.
    held: SpeedState,
    waits: [Option<Wait>; SIDES],
}

/// A beam that waits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wait {
    /// Where it was open last, and how fast the machine was.
    off: SpeedState,
    /// Where it may open again \[mm\].
    reopen: f64,
}

/// Time that the planner and its output filter take at most before the machine begins to slow down \[s\].
const REACTION_S: f64 = 0.1;

/// How far the machine may have to go back after a hold at the speed of `limits` \[mm\].
pub fn way_back(limits: &SpeedLimits, beams: &BeamLimits) -> f64 {
    let overlap = (0..SIDES).filter_map(|side| beams.overlap(side));
    let slowing = limits.ramp() + REACTION_S * limits.velocity;
    overlap.fold(0.0, libm::fmax) + (1.0 + AMPLE) * slowing
}

impl Overlap {
    /// For a hold at `held`: the beams that are on and do not stay on at rest wait, and those that waited `before`.
    /// None reopens before it went on at all.
    pub fn at(held: SpeedState, before: Option<&Self>, beams: &Beams, limits: &BeamLimits) -> Self {
        let waits = core::array::from_fn(|side| {
            let since = beams.on_since(side)?;
            let overlap = limits.overlap(side)?;
            let waited = before.and_then(|before| before.waits[side]);
            waited.or_else(|| {
                let off = beams.open_last(side).unwrap_or(SpeedState { s: since, ..held });
                let reopen = libm::fmax(off.s - overlap, since);
                Some(Wait { off, reopen })
            })
        });
        Self { held, waits }
    }

    /// Where to begin from, so that the machine is at speed in time for every beam that waits, and for what happens at
    /// `next_event` \[mm\]; it stands at `stands` \[mm\], and `limits` are those along the path. `None` if it can
    /// continue from where it stands.
    pub fn run_up_from(&self, stands: f64, next_event: Option<f64>, limits: &SpeedLimits) -> Option<f64> {
        // It took so long to stop, and takes about that long to start.
        let before = |place: f64, off: &SpeedState| {
            let limits = SpeedLimits {
                velocity: off.v,
                ..*limits
            };
            place - AMPLE * libm::fmax(stands - off.s, limits.ramp())
        };
        let waits = self.waits.iter().flatten();
        let waits = waits.map(|wait| before(wait.reopen, &wait.off));
        // What lies between the hold and the place of rest has not happened yet, and must happen at its path
        // position.
        let event = next_event
            .filter(|event| *event <= stands)
            .map(|event| before(event, &self.held));
        waits.chain(event).reduce(libm::fmin)
    }

    /// Takes the next position and speed, and the one that is asked for there \[mm/s\]; which beams are still to be
    /// kept off. One that may open and is too slow to continues waiting.
    pub fn pass(
        &mut self,
        now: &SpeedState,
        asked: f64,
        beams: &Beams,
        limits: &BeamLimits,
    ) -> [bool; SIDES] {
        for (side, wait) in self.waits.iter_mut().enumerate() {
            let on = beams.on_since(side).is_some();
            *wait = wait.filter(|wait| on && !(wait.is_over(now, asked) && limits.fast_enough(side, now.v)));
        }
        self.waits.map(|wait| wait.is_some())
    }

    /// Whether the beam of `side` still has to come to where it was open last, with the machine at `now`.
    pub fn is_before(&self, side: usize, now: &SpeedState) -> bool {
        self.waits[side].is_some_and(|wait| !wait.reaches(now))
    }

    /// No beam waits any more.
    pub fn is_over(&self) -> bool {
        self.waits == [None; SIDES]
    }
}

impl Wait {
    fn is_over(&self, now: &SpeedState, asked: f64) -> bool {
        let at_speed = now.v >= AT_SPEED * libm::fmin(self.off.v, asked);
        now.s >= self.reopen && (at_speed || self.reaches(now))
    }

    /// It is there before the next millisecond is over.
    fn reaches(&self, now: &SpeedState) -> bool {
        now.s + now.v * PATH_PERIOD_S >= self.off.s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{BeamConfig, ProcessIo};

    /// The planner keeps so much of the path that was gone, that the longest run-up after a hold is in it, and hardly more.
    #[test]
    fn the_way_back_is_as_long_as_the_longest_run_up() {
        let limits = SpeedLimits {
            velocity: 150.0,
            acceleration: 1000.0,
            jerk: 20_000.0,
        };
        let beam = BeamConfig {
            power_at_10v_w: 4000.0,
            min_speed_mm_s: 5.0,
            overlap_mm: 2.0,
            stays_on_at_rest: false,
            readback: None,
        };
        let beams = BeamLimits::build(&[Some(beam), None], &ProcessIo::default()).unwrap();
        let off = SpeedState {
            s: 200.0,
            v: 150.0,
            ..SpeedState::default()
        };
        let wait = Wait {
            off,
            reopen: off.s - 2.0,
        };
        let overlap = Overlap {
            held: off,
            waits: [Some(wait), None],
        };
        // On for the time of the reaction, then v/2·(v/a + a/j) to rest.
        let stands = off.s + 15.0 + 75.0 * (0.15 + 0.05);
        let from = overlap.run_up_from(stands, None, &limits).unwrap();
        let kept = way_back(&limits, &beams);
        assert!(
            (stands - from - kept).abs() < 1e-9,
            "{} of {kept} mm",
            stands - from
        );
    }
}
