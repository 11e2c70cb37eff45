//! Switches, ready lines and emergency stop: all closed loops that read high when all is well, so that a broken
//! wire reads as pressed, faulty or stopped.

use crate::gpio;
use crate::pins::{Drives, EMERGENCY_STOP, Pin};
use shared::io::{Bits, Feedback};

/// Ports that carry inputs: A to G.
const PORTS: usize = 7;

/// Makes the inputs of `drives`, the emergency stop and `others` inputs.
pub(crate) fn start<const N: usize>(drives: &Drives<N>, others: &[Pin]) {
    let groups = [
        &drives.limit_plus[..],
        &drives.limit_minus,
        &drives.ready,
        &EMERGENCY_STOP,
        others,
    ];
    for &pin in groups.into_iter().flatten() {
        gpio::input(pin);
    }
}

/// All inputs, read together.
pub(crate) struct Snapshot([u32; PORTS]);

impl Snapshot {
    /// Reads every port once.
    pub(crate) fn take() -> Self {
        Self(core::array::from_fn(|port| gpio::port(port as u8).idr().read().0))
    }

    /// Which of the lines at `pins` are high.
    pub(crate) fn high<const N: usize>(&self, pins: &[Pin; N]) -> Bits {
        Bits(!self.all_open(pins).0 & ((1 << N) - 1))
    }

    /// Whether the loop at `pin` is open.
    pub(crate) fn open(&self, pin: Pin) -> bool {
        self.0[usize::from(pin.port)] & 1 << pin.number == 0
    }

    /// Which of the loops at `pins` are open.
    fn all_open<const N: usize>(&self, pins: &[Pin; N]) -> Bits {
        let mut bits = Bits::NONE;
        for (index, &pin) in pins.iter().enumerate() {
            bits.set(index, self.open(pin));
        }
        bits
    }

    /// Puts limit switches, drive faults and emergency stop into `feedback`.
    pub(crate) fn fill<const N: usize>(&self, drives: &Drives<N>, feedback: &mut Feedback<N>) {
        feedback.limit_plus = self.all_open(&drives.limit_plus);
        feedback.limit_minus = self.all_open(&drives.limit_minus);
        feedback.drive_fault = self.all_open(&drives.ready);
        feedback.estop = EMERGENCY_STOP.map(|channel| self.open(channel));
    }
}
