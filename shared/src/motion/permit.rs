//! The tracker's permits, as the motion board takes them: what each beam may do where the path tracks, and until when.

use crate::io::SIDES;
use crate::protocol::{BeamPermit, PERMIT_US, Permit};
use crate::state::NoPermit;
use crate::ticks::SERVO_PERIOD_S;

/// Servo tick \[µs\].
const SERVO_US: u64 = (SERVO_PERIOD_S * 1e6) as u64;
/// Path tick \[µs\].
const PATH_US: u64 = 1000;

/// For how many servo ticks each gate may stay open unless it is told again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BeamLease(pub [u16; SIDES]);

impl BeamLease {
    /// As long as the references ask for it.
    pub const ALWAYS: u16 = u16::MAX;

    /// Counts `elapsed` servo ticks.
    pub fn count(&mut self, elapsed: u32) {
        for left in self.0.iter_mut().filter(|left| **left != Self::ALWAYS) {
            *left = left.saturating_sub(u16::try_from(elapsed).unwrap_or(u16::MAX));
        }
    }
}

/// The newest permit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Permits {
    /// How long each is valid after the tick of the path state that it answers \[µs\].
    valid_us: u32,
    newest: Option<Newest>,
    /// Path tick after which the last came, whatever it answered \[µs\].
    heard_us: Option<u64>,
    /// What was refused since the last [`Permits::take_refused`].
    refused: [bool; SIDES],
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Newest {
    permit: Permit,
    /// When it ends, by this board's clock \[µs\].
    ends_us: u64,
}

impl Permits {
    /// None came yet.
    pub const NONE: Self = Self {
        valid_us: PERMIT_US,
        newest: None,
        heard_us: None,
        refused: [false; SIDES],
    };

    /// From now on each is valid for so long \[µs\].
    pub fn set_valid(&mut self, valid_us: u32) {
        self.valid_us = valid_us;
    }

    /// Forgets the newest.
    pub fn forget(&mut self) {
        self.newest = None;
        self.heard_us = None;
        self.refused = [false; SIDES];
    }

    /// Takes a permit that has arrived after path tick `tick`, which was at `tick_us` of this board's clock. One
    /// that answers an older path state than the last one, or a tick that has not been, is left.
    pub fn take(&mut self, permit: &Permit, tick: u32, tick_us: u64) {
        self.heard_us = Some(tick_us);
        let age = tick.wrapping_sub(permit.tick);
        let overtaken = self.newest.is_some_and(|newest| {
            let step = permit.tick.wrapping_sub(newest.permit.tick);
            step > u32::MAX / 2
        });
        if age > u32::MAX / 2 || overtaken {
            return;
        }
        let answers_us = tick_us.saturating_sub(u64::from(age) * PATH_US);
        self.newest = Some(Newest {
            permit: *permit,
            ends_us: answers_us + u64::from(self.valid_us),
        });
        for (refused, side) in self.refused.iter_mut().zip(permit.sides) {
            *refused |= side == BeamPermit::No;
        }
    }

    /// Sides that were refused since the last call, even if a later permit allows them again.
    pub fn take_refused(&mut self) -> [bool; SIDES] {
        core::mem::take(&mut self.refused)
    }

    /// Whether the beam of `side` may go on at `now_us` on path `path_id`, or, if it `is_on`, stay on: for how many
    /// servo ticks.
    pub fn lease(&self, path_id: u32, side: usize, is_on: bool, now_us: u64) -> Result<u16, NoPermit> {
        let newest = self.newest.filter(|newest| newest.ends_us > now_us);
        let newest = newest.ok_or_else(|| self.none_valid(now_us))?;
        let side = newest.permit.sides[side];
        match side {
            _ if newest.permit.path_id != path_id => Err(NoPermit::Refused),
            BeamPermit::No => Err(NoPermit::Refused),
            BeamPermit::Keep if !is_on => Err(NoPermit::NotOnSeam),
            BeamPermit::Keep | BeamPermit::Open => Ok(((newest.ends_us - now_us) / SERVO_US) as u16),
        }
    }

    /// Why no permit is valid at `now_us`.
    fn none_valid(&self, now_us: u64) -> NoPermit {
        // One that fell silent was heard before that: the last that it said was valid until now.
        let lately_us = u64::from(self.valid_us / 2);
        match self.heard_us {
            Some(heard_us) if now_us < heard_us + lately_us => NoPermit::Outdated,
            _ => NoPermit::Silent,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn permit(tick: u32, side: BeamPermit) -> Permit {
        Permit {
            tick,
            path_id: 7,
            sides: [side, BeamPermit::No],
        }
    }

    #[test]
    fn a_permit_is_as_old_as_the_path_state_that_it_answers() {
        let mut permits = Permits::NONE;
        assert_eq!(permits.lease(7, 0, true, 0), Err(NoPermit::Silent));
        permits.take(&permit(98, BeamPermit::Open), 100, 1_000_000);
        // Tick 98 was at 998 ms.
        assert_eq!(permits.lease(7, 0, false, 1_000_300), Ok(10));
        assert_eq!(permits.lease(7, 0, false, 1_002_751), Ok(0));
        assert_eq!(permits.lease(7, 0, true, 1_003_000), Err(NoPermit::Silent));
        // The same answer again is no newer for that.
        permits.take(&permit(98, BeamPermit::Open), 103, 1_003_000);
        assert_eq!(permits.lease(7, 0, true, 1_005_499), Err(NoPermit::Outdated));
        assert_eq!(permits.lease(7, 0, true, 1_005_500), Err(NoPermit::Silent));
        permits.take(&permit(101, BeamPermit::Open), 103, 1_003_000);
        assert_eq!(permits.lease(7, 1, true, 1_000_300), Err(NoPermit::Refused));
        assert_eq!(permits.lease(8, 0, true, 1_000_300), Err(NoPermit::Refused));
    }

    #[test]
    fn what_answers_an_older_tick_or_one_to_come_changes_nothing() {
        let mut permits = Permits::NONE;
        permits.take(&permit(100, BeamPermit::No), 101, 1_000_000);
        permits.take(&permit(99, BeamPermit::Open), 101, 1_000_000);
        permits.take(&permit(500, BeamPermit::Open), 101, 1_000_000);
        assert_eq!(permits.lease(7, 0, true, 1_000_000), Err(NoPermit::Refused));
        // Of the same tick the later word counts.
        permits.take(&permit(100, BeamPermit::Keep), 101, 1_000_000);
        assert_eq!(permits.lease(7, 0, true, 1_000_000), Ok(16));
        assert_eq!(permits.lease(7, 0, false, 1_000_000), Err(NoPermit::NotOnSeam));
    }

    #[test]
    fn ticks_are_counted_over_the_wrap() {
        let mut permits = Permits::NONE;
        permits.take(&permit(u32::MAX, BeamPermit::Open), 1, 1_000_000);
        assert_eq!(permits.lease(7, 0, false, 1_000_000), Ok(12));
        permits.take(&permit(0, BeamPermit::No), 1, 1_000_000);
        assert_eq!(permits.lease(7, 0, true, 1_000_000), Err(NoPermit::Refused));
    }

    #[test]
    fn a_lease_runs_out_by_the_tick_unless_it_is_for_always() {
        let mut lease = BeamLease([3, BeamLease::ALWAYS]);
        lease.count(1);
        lease.count(1);
        assert_eq!(lease, BeamLease([1, BeamLease::ALWAYS]));
        lease.count(4);
        assert_eq!(lease, BeamLease([0, BeamLease::ALWAYS]));
    }
}
