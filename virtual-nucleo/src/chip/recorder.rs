//! What leaves the pins, and when.

use super::pins::{Mode, PORTS, Pin, Pins};
use crate::time::Time;

/// What the chip does with a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Nothing: an input, analog, or an open drain that is off.
    Floating,
    /// It drives the line low.
    Low,
    /// It drives the line high.
    High,
    /// A peripheral has the pin: its level is not modelled.
    Peripheral,
}

/// A pin changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// Time since power-up.
    pub at: Time,
    /// The pin.
    pub pin: Pin,
    /// What it does from then on.
    pub level: Level,
}

/// Writes down every change of every pin, if it is on.
#[derive(Debug, Default)]
pub struct Recorder {
    levels: Option<[[Level; 16]; PORTS]>,
    changes: Vec<Change>,
}

impl Recorder {
    /// Begins to record.
    pub fn start(&mut self, pins: &Pins) {
        self.levels = Some(std::array::from_fn(|port| levels(pins, port)));
    }

    /// The registers of a port were written.
    pub fn note(&mut self, pins: &Pins, port: usize, at: Time) {
        let Some(known) = &mut self.levels else { return };
        for (number, level) in (0..).zip(levels(pins, port)) {
            let before = std::mem::replace(&mut known[port][usize::from(number)], level);
            if before != level {
                let pin = Pin {
                    port: port as u8,
                    number,
                };
                self.changes.push(Change { at, pin, level });
            }
        }
    }

    /// What is known of a pin; floating as long as nothing is recorded.
    pub fn level(&self, pin: Pin) -> Level {
        self.levels.as_ref().map_or(Level::Floating, |levels| {
            levels[usize::from(pin.port)][usize::from(pin.number)]
        })
    }

    /// Changes since they were taken last, in their order.
    pub fn take(&mut self) -> Vec<Change> {
        std::mem::take(&mut self.changes)
    }
}

fn levels(pins: &Pins, port: usize) -> [Level; 16] {
    let (drives, output) = pins.driven(port);
    std::array::from_fn(|number| {
        let pin = Pin {
            port: port as u8,
            number: number as u8,
        };
        match pins.mode(pin) {
            Mode::Alternate(_) => Level::Peripheral,
            _ if drives & 1 << number == 0 => Level::Floating,
            _ if output & 1 << number == 0 => Level::Low,
            _ => Level::High,
        }
    })
}
