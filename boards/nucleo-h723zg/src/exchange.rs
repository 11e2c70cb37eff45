//! A frame over a serial bus, out and in at once, in bounded time.
//!
//! The servo tick waits for the converters' bus. A controller whose clock or state is lost never raises the flag
//! that is waited for; then the frame is given up, which is a fault of the converters, and not a tick that hangs.

use core::fmt::{self, Display, Formatter};

/// A controller that shifts bytes.
pub trait Shifter {
    /// Drops what an earlier frame may have left, and makes ready for a new one.
    fn begin(&mut self);
    /// Whether it reports a byte lost or a frame torn.
    fn failed(&mut self) -> bool;
    /// Whether there is room for a byte to be sent.
    fn has_room(&mut self) -> bool;
    /// Sends a byte.
    fn send(&mut self, byte: u8);
    /// The byte that came in, if one did.
    fn received(&mut self) -> Option<u8>;
    /// A count of time, which wraps.
    fn cycles(&mut self) -> u32;
}

/// Why a frame was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The controller did not get on in time.
    TimedOut,
    /// The controller reports a byte lost or a frame torn.
    Torn,
}

impl Display for Failure {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TimedOut => "the bus does not get on",
            Self::Torn => "the bus lost a byte",
        })
    }
}

/// Sends `bytes` and puts what comes in meanwhile in their place; takes `limit` cycles at most, and one look at the
/// controller.
pub fn exchange(bus: &mut impl Shifter, bytes: &mut [u8], limit: u32) -> Result<(), Failure> {
    let begin = bus.cycles();
    bus.begin();
    for byte in bytes {
        wait(bus, begin, limit, |bus| bus.has_room().then_some(()))?;
        bus.send(*byte);
        *byte = wait(bus, begin, limit, Shifter::received)?;
    }
    Ok(())
}

/// What `ready` gives, once it does.
fn wait<B: Shifter, T>(
    bus: &mut B,
    begin: u32,
    limit: u32,
    ready: impl Fn(&mut B) -> Option<T>,
) -> Result<T, Failure> {
    loop {
        if bus.failed() {
            return Err(Failure::Torn);
        }
        if let Some(value) = ready(bus) {
            return Ok(value);
        }
        if bus.cycles().wrapping_sub(begin) > limit {
            return Err(Failure::TimedOut);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: u32 = 1000;
    /// Cycles that a look at the controller takes, and a byte on the wire.
    const LOOK: u32 = 7;
    const BYTE: u32 = 60;

    /// Answers every byte with its complement.
    struct Bus {
        now: u32,
        looks: u32,
        sent: Vec<u8>,
        /// The byte on the wire, and when it will be through.
        moving: Option<(u8, u32)>,
        /// Bytes that get through before the controller stops, or loses one.
        good: usize,
        torn: bool,
    }

    impl Bus {
        fn new(good: usize, torn: bool) -> Self {
            Self {
                // The count wraps during the frame.
                now: u32::MAX - 100,
                looks: 0,
                sent: Vec::new(),
                moving: Some((0xee, 0)),
                good,
                torn,
            }
        }

        fn look(&mut self) {
            self.now = self.now.wrapping_add(LOOK);
            self.looks += 1;
            assert!(self.looks < 10_000, "it waits without end");
        }

        fn stopped(&self) -> bool {
            self.sent.len() > self.good
        }
    }

    impl Shifter for Bus {
        fn begin(&mut self) {
            self.moving = None;
        }

        fn failed(&mut self) -> bool {
            self.look();
            self.torn && self.stopped()
        }

        fn has_room(&mut self) -> bool {
            self.moving.is_none()
        }

        fn send(&mut self, byte: u8) {
            self.sent.push(byte);
            self.moving = Some((!byte, self.now.wrapping_add(BYTE)));
        }

        fn received(&mut self) -> Option<u8> {
            let (byte, due) = self.moving?;
            if self.stopped() || (self.now.wrapping_sub(due) as i32) < 0 {
                return None;
            }
            self.moving = None;
            Some(byte)
        }

        fn cycles(&mut self) -> u32 {
            self.now
        }
    }

    #[test]
    fn every_byte_is_exchanged_and_an_older_answer_dropped() {
        let mut bus = Bus::new(3, false);
        let mut frame = [0x10, 0x7f, 0xff];
        assert_eq!(exchange(&mut bus, &mut frame, LIMIT), Ok(()));
        assert_eq!(bus.sent, [0x10, 0x7f, 0xff]);
        assert_eq!(frame, [0xef, 0x80, 0x00]);
    }

    #[test]
    fn a_controller_that_stops_at_any_byte_is_given_up_in_time() {
        for good in 0..3 {
            let mut bus = Bus::new(good, false);
            let begin = bus.now;
            let result = exchange(&mut bus, &mut [1, 2, 3], LIMIT);
            assert_eq!(result, Err(Failure::TimedOut), "after {good} bytes");
            assert!(bus.now.wrapping_sub(begin) <= LIMIT + LOOK, "after {good} bytes");
        }
    }

    #[test]
    fn a_controller_that_never_has_room_is_given_up_in_time() {
        struct Full(u32);
        impl Shifter for Full {
            fn begin(&mut self) {}
            fn failed(&mut self) -> bool {
                false
            }
            fn has_room(&mut self) -> bool {
                false
            }
            fn send(&mut self, _: u8) {
                panic!("there is no room")
            }
            fn received(&mut self) -> Option<u8> {
                None
            }
            fn cycles(&mut self) -> u32 {
                self.0 += LOOK;
                self.0
            }
        }
        let mut bus = Full(0);
        assert_eq!(exchange(&mut bus, &mut [0], LIMIT), Err(Failure::TimedOut));
        assert!(bus.0 <= LIMIT + 3 * LOOK);
    }

    #[test]
    fn a_byte_that_is_lost_fails_at_once() {
        let mut bus = Bus::new(1, true);
        assert_eq!(exchange(&mut bus, &mut [1, 2, 3], LIMIT), Err(Failure::Torn));
        assert_eq!(bus.sent, [1, 2]);
    }
}
