//! When a board may run on.
//!
//! Each board has come to a point of one common time, its own time plus a constant. It waits until the wall
//! clock has come there, until its peer is at most [`LEAD_NS`] behind, until a program on the PC that
//! takes part is at most [`PC_LEAD_NS`] behind, and until frames that wait for it have been received: a PC whose
//! processor is busy elsewhere is not what is to be tried here. Who comes late by more than [`LATE_NS`] moves the common epoch, for both: the delay of one is
//! a delay of the pair, and neither races to catch up. A peer without a sign of life for [`PATIENCE_NS`]
//! (stopped, ended) is not waited for; when it comes back it joins where the other is by then.

use crate::network::Network;
use crate::shared::Shared;

/// Board time between two looks at the clock \[ns\].
pub const QUANTUM_NS: u64 = 250_000;
/// Common time a board may be ahead of its peer \[ns\].
const LEAD_NS: i64 = 250_000;
/// Common time a board may be ahead of what the PC has handled \[ns\]: a program that waits for the boards says every
/// millisecond that it keeps up, and is late by another one where its thread is woken late.
const PC_LEAD_NS: i64 = 3_000_000;
/// Delay against the wall clock that is caught up; more is forgiven \[ns\]: a board that races meanwhile lets the datagrams
/// under way to it grow old.
const LATE_NS: i64 = 250_000;
/// Common time behind the peer that only a stopped board shows \[ns\].
const REJOIN_NS: i64 = 10_000_000;
/// Wall time after which a silent peer is not waited for \[ns\].
const PATIENCE_NS: i64 = 1_000_000_000;
/// Longest sleep between two looks at what is waited for \[ns\].
const STEP_NS: i64 = 50_000;

/// A board's place in common time.
pub struct Clock {
    shared: Shared,
    network: Network,
    /// Wall time per board time.
    stretch: f64,
    /// Common time minus the board's own \[ns\]; known from its first wait on.
    offset: Option<i64>,
}

impl Clock {
    /// `rate` is board time per wall time.
    pub fn start(shared: Shared, network: Network, rate: f64) -> Self {
        Self {
            shared,
            network,
            stretch: 1.0 / rate,
            offset: None,
        }
    }

    /// Returns when a board that has come to `own` ns may run on.
    pub fn wait(&mut self, own: u64) {
        let own = own as i64;
        let mut now = wall();
        let offset = match self.offset {
            Some(offset) => offset,
            None => self.join(own, now),
        };
        let mut reached = own + offset;
        if let Some(peer) = self.shared.peer(now, PATIENCE_NS)
            && peer - reached > REJOIN_NS
        {
            reached = peer;
        }
        self.offset = Some(reached - own);
        self.shared.publish(reached, now);

        let since_epoch = (reached as f64 * self.stretch) as i64;
        if now - self.shared.epoch(now) > since_epoch + LATE_NS {
            self.shared.delay_epoch(now - since_epoch);
        }
        loop {
            let due = self.shared.epoch(now) + since_epoch;
            if now < due {
                sleep(due - now);
            } else if self.is_ahead(reached, now) {
                sleep(STEP_NS);
            } else {
                return;
            }
            now = wall();
        }
    }

    /// Somebody, or what has arrived for the board, is further behind than a busy host explains.
    fn is_ahead(&mut self, reached: i64, now: i64) -> bool {
        let behind = |other: Option<i64>, lead| other.is_some_and(|other| reached - other > lead);
        behind(self.shared.peer(now, PATIENCE_NS), LEAD_NS)
            || behind(self.shared.pc(now, PATIENCE_NS), PC_LEAD_NS)
            || self.network.is_behind(now)
    }

    /// The board starts: where its peer is, or where the wall clock is.
    fn join(&self, own: i64, now: i64) -> i64 {
        timer_slack();
        let epoch = self.shared.epoch(now);
        let common = self
            .shared
            .peer(now, PATIENCE_NS)
            .unwrap_or(((now - epoch) as f64 / self.stretch) as i64);
        common - own
    }
}

/// Time of the monotonic clock \[ns\], the same in every process.
fn wall() -> i64 {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: writes the struct it is given.
    unsafe { libc::clock_gettime(libc::CLOCK_MONOTONIC, &mut time) };
    time.tv_sec * 1_000_000_000 + time.tv_nsec
}

fn sleep(ns: i64) {
    std::thread::sleep(std::time::Duration::from_nanos(ns.unsigned_abs()));
}

/// Lets this thread wake within a nanosecond of the time it asked for instead of 50 µs.
fn timer_slack() {
    // SAFETY: sets an attribute of the calling thread, with no pointer.
    unsafe { libc::prctl(libc::PR_SET_TIMERSLACK, 1_u64, 0_u64, 0_u64, 0_u64) };
}
