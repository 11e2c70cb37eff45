//! What the peripherals of a chip share.

use super::clocks::{Clocks, Settings};
use super::pins::Pins;
use super::recorder::Recorder;
use crate::armv7m::System;
use crate::finding::Findings;
use crate::outside::Outside;
use crate::time::{CoreClock, Time};

/// Why the chip resets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reset {
    /// The independent watchdog was not fed.
    Watchdog,
    /// By software.
    Software,
}

/// State that more than one peripheral looks at.
#[derive(Debug)]
pub struct Shared {
    /// Time.
    pub clock: CoreClock,
    /// The core's own registers.
    pub system: System,
    /// What is wrong.
    pub findings: Findings,
    /// What makes the clock tree.
    pub settings: Settings,
    /// The clock tree.
    pub clocks: Clocks,
    /// Whether the internal oscillator of 4 MHz runs.
    pub csi: bool,
    /// The interface to the PHY that SYSCFG selects (EPIS), and that its reset takes over.
    pub ethernet_interface: u32,
    /// Whether the Ethernet controller's three clocks are on.
    pub ethernet_clocks: bool,
    /// The pins.
    pub pins: Pins,
    /// What leaves them.
    pub recorder: Recorder,
    /// What the board is wired to.
    pub outside: Outside,
    /// Voltage of the supply [mV].
    pub supply_mv: u32,
    /// The 8 MHz of the ST-LINK have failed.
    pub hse_failed: bool,
    /// The core has lost its clock.
    pub stopped: bool,
    /// A reset is due.
    pub reset: Option<Reset>,
    /// The core polls for something that will not come before: time may pass to there, or to the next event.
    pub polls_until: Option<Time>,
}

impl Shared {
    /// Time since power-up.
    pub fn now(&self) -> Time {
        self.clock.now()
    }

    /// Something is wrong.
    pub fn report(&mut self, cause: impl Into<String>) {
        self.findings.now = self.clock.now();
        self.findings.report(cause);
    }

    /// Works the clock tree out again, and reports the limits that are broken now and were not `before`. After a reset
    /// the chip runs with 64 MHz on each APB, more than the data sheet allows at its voltage scaling then.
    pub fn clocks_changed(&mut self, before: &Settings) {
        let known = self.clocks.violations(before);
        self.clocks = Clocks::of(&self.settings);
        for violation in self.clocks.violations(&self.settings) {
            if !known.contains(&violation) {
                self.report(violation);
            }
        }
        if self.clocks.core == 0 {
            self.report("the core is left without clock");
        } else if self.clocks.core != self.clock.hz() {
            self.clock.change(self.clocks.core);
        }
    }
}

/// A peripheral's registers and what they do.
pub trait Peripheral {
    /// Reads the word at `offset`.
    fn read(&mut self, offset: u32, shared: &mut Shared) -> u32;
    /// Writes `size` bytes at `offset`.
    fn write(&mut self, offset: u32, value: u32, size: u32, shared: &mut Shared);
    /// When it has to be looked at next.
    fn due(&self) -> Time {
        Time::NEVER
    }
    /// Comes to the present.
    fn advance(&mut self, _: &mut Shared) {}
    /// The exception that it asks for, for as long as it does.
    fn asks_for(&self) -> Option<u16> {
        None
    }
}
