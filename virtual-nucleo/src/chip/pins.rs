//! The ports' registers, and what they connect (RM0468, 11).

use super::map::alternate_function;
use crate::finding::Findings;
use crate::outside::Outside;
use crate::time::Time;
use std::fmt::{self, Display, Formatter};

/// Ports A to K.
pub const PORTS: usize = 11;

/// A pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pin {
    /// Port, A = 0.
    pub port: u8,
    /// Number in the port, 0 to 15.
    pub number: u8,
}

/// The pin with this port's letter and number.
pub const fn pin(port: char, number: u8) -> Pin {
    Pin {
        port: port as u8 - b'A',
        number,
    }
}

impl Display for Pin {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "P{}{}", char::from(b'A' + self.port), self.number)
    }
}

/// What a pin is set to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Input.
    Input,
    /// Output.
    Output,
    /// Connected to a peripheral by this alternate function.
    Alternate(u8),
    /// Analog: not connected.
    Analog,
}

/// Registers of a port.
#[derive(Clone, Copy, Debug)]
struct Port {
    mode: u32,
    open_drain: u32,
    speed: u32,
    pulls: u32,
    output: u32,
    alternate: [u32; 2],
}

const MODER: u32 = 0x00;
const OTYPER: u32 = 0x04;
const OSPEEDR: u32 = 0x08;
const PUPDR: u32 = 0x0c;
const IDR: u32 = 0x10;
const ODR: u32 = 0x14;
const BSRR: u32 = 0x18;
const AFRL: u32 = 0x20;
const AFRH: u32 = 0x24;

/// All ports.
#[derive(Clone, Debug)]
pub struct Pins([Port; PORTS]);

impl Default for Pins {
    /// As after a reset: analog, but for the pins of the debugger.
    fn default() -> Self {
        let port = |index: usize| Port {
            mode: [0xabff_ffff, 0xffff_febf].get(index).copied().unwrap_or(u32::MAX),
            open_drain: 0,
            speed: [0x0c00_0000, 0x0000_00c0].get(index).copied().unwrap_or(0),
            pulls: [0x6400_0000, 0x0000_0100].get(index).copied().unwrap_or(0),
            output: 0,
            alternate: [0; 2],
        };
        Self(std::array::from_fn(port))
    }
}

impl Pins {
    /// What a pin is set to.
    pub fn mode(&self, pin: Pin) -> Mode {
        let (port, n) = (&self.0[usize::from(pin.port)], u32::from(pin.number));
        match port.mode >> (2 * n) & 3 {
            0 => Mode::Input,
            1 => Mode::Output,
            2 => Mode::Alternate((port.alternate[n as usize / 8] >> (4 * (n % 8)) & 0xf) as u8),
            _ => Mode::Analog,
        }
    }

    /// Bits of a port's pins that drive their line, and the levels.
    pub fn driven(&self, port: usize) -> (u16, u16) {
        let Port {
            mode,
            open_drain,
            output,
            ..
        } = self.0[port];
        let mut drives = 0_u16;
        for n in 0..16 {
            let pulls_up = open_drain & output & 1 << n != 0;
            if mode >> (2 * n) & 3 == 1 && !pulls_up {
                drives |= 1 << n;
            }
        }
        (drives, output as u16)
    }

    fn inputs(&self, port: usize, outside: &Outside) -> u32 {
        let Port { mode, pulls, .. } = self.0[port];
        let (drives, output) = self.driven(port);
        let (wired, levels) = outside.inputs(port);
        (0..16)
            .filter(|n| {
                let bit = 1 << n;
                let pulled_up = pulls >> (2 * n) & 3 == 1;
                match mode >> (2 * n) & 3 {
                    3 => false,
                    _ if drives & bit != 0 => output & bit != 0,
                    _ if wired & bit != 0 => levels & bit != 0,
                    _ => pulled_up,
                }
            })
            .fold(0, |word, n| word | 1 << n)
    }

    /// Reads the register at `offset` of a port.
    pub fn read(&self, port: usize, offset: u32, outside: &Outside) -> u32 {
        let registers = &self.0[port];
        match offset {
            MODER => registers.mode,
            OTYPER => registers.open_drain,
            OSPEEDR => registers.speed,
            PUPDR => registers.pulls,
            IDR => self.inputs(port, outside),
            ODR => registers.output,
            AFRL => registers.alternate[0],
            AFRH => registers.alternate[1],
            _ => 0,
        }
    }

    /// Writes the register at `offset` of a port, and passes on what changes outside.
    pub fn write(
        &mut self,
        port: usize,
        offset: u32,
        value: u32,
        now: Time,
        outside: &mut Outside,
        findings: &mut Findings,
    ) {
        let registers = &mut self.0[port];
        match offset {
            MODER => registers.mode = value,
            OTYPER => registers.open_drain = value,
            OSPEEDR => registers.speed = value,
            PUPDR => registers.pulls = value,
            ODR => registers.output = value & 0xffff,
            BSRR => registers.output = registers.output & !(value >> 16) | value & 0xffff,
            AFRL => registers.alternate[0] = value,
            AFRH => registers.alternate[1] = value,
            _ => findings.report("locking the setting of pins is not modelled"),
        }
        let (drives, levels) = self.driven(port);
        outside.drive(port, drives, levels, now, findings);
    }

    /// The pin that is connected to a signal, out of all that can be.
    pub fn connected(&self, signal: &Signal) -> Option<Pin> {
        let set = |(pin, function): &&(Pin, u8)| self.mode(*pin) == Mode::Alternate(*function);
        signal.pins.iter().find(set).map(|(pin, _)| *pin)
    }
}

/// A signal of a peripheral, and all pins that it can be connected to.
#[derive(Clone, Debug)]
pub struct Signal {
    /// Its name, `TIM2_CH1`.
    pub name: String,
    pins: Vec<(Pin, u8)>,
}

impl Signal {
    /// `signal` of `peripheral`, by the manufacturer's description.
    pub fn of(peripheral: &str, signal: &str) -> Self {
        let all = (0..PORTS as u8).flat_map(|port| (0..16).map(move |number| Pin { port, number }));
        let pins = all
            .filter_map(|pin| Some((pin, alternate_function(peripheral, signal, &pin.to_string())?)))
            .collect();
        Self {
            name: format!("{peripheral}_{signal}"),
            pins,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Symbols;
    use std::rc::Rc;

    #[test]
    fn a_signal_passes_only_through_a_pin_that_is_set_for_it() {
        let clock = Signal::of("SPI3", "SCK");
        let (mut pins, mut outside) = (Pins::default(), Outside::nothing());
        let mut findings = Findings::new(Rc::new(Symbols::default()));
        let mut write = |pins: &mut Pins, offset, value| {
            pins.write(2, offset, value, Time::default(), &mut outside, &mut findings);
        };
        assert_eq!(pins.connected(&clock), None);
        write(&mut pins, MODER, 0b10 << 20);
        write(&mut pins, AFRH, 5 << 8);
        assert_eq!(pins.connected(&clock), None, "another function");
        write(&mut pins, AFRH, 6 << 8);
        assert_eq!(pins.connected(&clock), Some(pin('C', 10)));
    }

    #[test]
    fn an_analog_pin_reads_low_and_an_open_one_what_its_pull_says() {
        let (mut pins, mut outside) = (Pins::default(), Outside::nothing());
        let mut findings = Findings::new(Rc::new(Symbols::default()));
        pins.write(2, PUPDR, 1, Time::default(), &mut outside, &mut findings);
        assert_eq!(pins.read(2, IDR, &outside), 0);
        pins.write(2, MODER, 0, Time::default(), &mut outside, &mut findings);
        assert_eq!(pins.read(2, IDR, &outside), 1);
    }
}
