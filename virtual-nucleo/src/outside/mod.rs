//! What a board is wired to, as docs/wiring.md says: converters, drives, encoders, switches.

mod ad5764r;
mod machine;
mod outputs;
mod safe_state;
mod wiring;

pub use machine::{Machine, Seen, Step};
pub use outputs::{Output, Role};

use crate::chip::pins::{PORTS, Pin};
use crate::finding::Findings;
use crate::time::Time;
use ad5764r::Ad5764r;
use wiring::{CLEAR, LOAD, PULLED_UP, SYNC, Wiring};

/// A signal of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Track {
    /// Leads B by a quarter of a line when the count rises.
    A,
    /// See A.
    B,
    /// Reference mark.
    Z,
}

/// What an encoder has shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Encoder {
    /// Quarter lines since power-up.
    pub counts: i64,
    /// Reference marks passed.
    pub marks: u64,
    /// Count at the last one.
    pub mark: i64,
}

/// How a byte comes over the serial bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SpiClock {
    /// Its frequency \[Hz\].
    pub hz: u64,
    /// CPOL.
    pub idles_high: bool,
    /// CPHA: data is taken at the second edge.
    pub second_edge: bool,
}

/// Everything outside the chip.
#[derive(Debug)]
pub struct Outside {
    wiring: Wiring,
    /// Lines that the board drives.
    outputs: Vec<Output>,
    shown: safe_state::Shown,
    machine: Machine,
    encoders: Vec<Encoder>,
    converters: Vec<Ad5764r>,
    /// Levels of the lines of each port, driven or pulled.
    lines: [u16; PORTS],
    /// Lines of each port that something outside drives, and how.
    driven: [(u16, u16); PORTS],
    /// When the machine takes its next step, from the first tick of the board on.
    next_step: Time,
    /// How many steps it has taken.
    pub steps: u64,
    /// The steps, if they are recorded.
    record: Option<Vec<Step>>,
}

impl Outside {
    /// A board with nothing wired to it.
    pub fn nothing() -> Self {
        Self::new(Machine::None)
    }

    /// A board wired to `machine`.
    pub fn new(machine: Machine) -> Self {
        let wiring = Wiring::of(&machine);
        let mut outside = Self {
            outputs: outputs::outputs(&machine, &wiring),
            shown: safe_state::Shown::default(),
            encoders: vec![Encoder::default(); wiring.encoders.len()],
            converters: (0..wiring.converters).map(Ad5764r::new).collect(),
            lines: [0; PORTS],
            driven: [(0, 0); PORTS],
            next_step: Time::NEVER,
            steps: 0,
            record: None,
            machine,
            wiring,
        };
        for pin in PULLED_UP {
            outside.lines[usize::from(pin.port)] |= 1 << pin.number;
        }
        let wiring = outside.wiring.clone();
        for pin in wiring
            .closed_loops
            .iter()
            .chain(&wiring.emergency_stop)
            .chain(&wiring.high)
            .chain(wiring.limits())
        {
            outside.set_input(*pin, true);
        }
        outside
    }

    /// The machine.
    pub fn machine(&self) -> &Machine {
        &self.machine
    }

    /// An encoder.
    pub fn encoder(&self, index: usize) -> Encoder {
        self.encoders.get(index).copied().unwrap_or_default()
    }

    /// Lines that the board drives.
    pub fn outputs(&self) -> &[Output] {
        &self.outputs
    }

    /// Pins of both channels of the emergency stop.
    pub fn emergency_stop(&self) -> &[Pin] {
        &self.wiring.emergency_stop
    }

    /// The chip was reset: it drives no line.
    pub fn chip_resets(&mut self, now: Time, findings: &mut Findings) {
        self.shown = safe_state::Shown::default();
        for port in 0..PORTS {
            self.drive(port, 0, 0, now, findings);
        }
    }

    /// The watchdog runs from now on.
    pub fn watchdog_runs(&mut self) {
        self.shown.watchdog = true;
    }

    /// Which encoder's signal comes to a pin.
    pub fn track(&self, pin: Pin) -> Option<(usize, Track)> {
        self.wiring
            .encoders
            .iter()
            .enumerate()
            .find_map(|(index, tracks)| {
                let tracks = tracks.iter().zip([Track::A, Track::B, Track::Z]);
                let (_, track) = tracks.into_iter().find(|(other, _)| **other == pin)?;
                Some((index, track))
            })
    }

    /// Lines of a port that are driven from outside, and their levels.
    pub fn inputs(&self, port: usize) -> (u16, u16) {
        self.driven[port]
    }

    /// Sets a line that comes from outside.
    pub fn set_input(&mut self, pin: Pin, high: bool) {
        let (driven, levels) = &mut self.driven[usize::from(pin.port)];
        *driven |= 1 << pin.number;
        *levels = *levels & !(1 << pin.number) | u16::from(high) << pin.number;
    }

    /// From now on every step of the machine is recorded.
    pub fn record_steps(&mut self) {
        self.record = Some(Vec::new());
    }

    /// The steps since they were taken last, in their order.
    pub fn take_steps(&mut self) -> Vec<Step> {
        self.record.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Whether a line is high.
    pub fn line(&self, pin: Pin) -> bool {
        self.lines[usize::from(pin.port)] & 1 << pin.number != 0
    }

    /// Codes that the converters give out now.
    pub fn codes(&self) -> Vec<[i16; 4]> {
        self.converters.iter().map(Ad5764r::outputs).collect()
    }

    /// Since when all converters give 0 V; `None` if one does not, or none has stepped since the last reset.
    pub fn zero_since(&self) -> Option<Time> {
        self.shown.zero
    }

    /// How many complete frames the converters have taken.
    pub fn frames(&self) -> u64 {
        self.converters.iter().map(|converter| converter.frames).sum()
    }

    /// The chip drives lines of a port anew.
    pub fn drive(&mut self, port: usize, drives: u16, levels: u16, now: Time, findings: &mut Findings) {
        let pulled = PULLED_UP.iter().filter(|pin| usize::from(pin.port) == port);
        let pulled = pulled.fold(0_u16, |mask, pin| mask | 1 << pin.number);
        let new = drives & levels | !drives & pulled;
        let old = std::mem::replace(&mut self.lines[port], new);
        let (rises, falls) = (new & !old, old & !new);
        if rises | falls == 0 {
            return;
        }
        self.check_lines(port, rises, falls, now, findings);
        let is = |edges: u16, pin: Pin| usize::from(pin.port) == port && edges & 1 << pin.number != 0;
        for (converter, sync) in self.converters.iter_mut().zip(SYNC) {
            if is(falls, sync) {
                converter.select();
            }
            if is(rises, sync) {
                converter.deselect(now, findings);
            }
        }
        if is(falls, LOAD) {
            self.advance(now);
            for converter in &mut self.converters {
                converter.load(now, findings);
            }
        }
        if is(falls, CLEAR) {
            self.advance(now);
            self.converters.iter_mut().for_each(Ad5764r::clear);
        }
        self.note_voltage(now);
    }

    /// A byte on the bus of the converters; what comes back.
    pub fn spi_byte(&mut self, byte: u8, clock: SpiClock, findings: &mut Findings) -> u8 {
        let lines = self.lines;
        let selected = |pin: &Pin| lines[usize::from(pin.port)] & 1 << pin.number == 0;
        let mut answer = u8::MAX;
        for (converter, _) in self
            .converters
            .iter_mut()
            .zip(SYNC)
            .filter(|(_, sync)| selected(sync))
        {
            answer &= converter.byte(byte, clock, findings);
        }
        answer
    }

    /// The board's ticks begin: the machine's steps are in phase with them, as on the other simulated boards.
    pub fn tick_begins(&mut self, now: Time) {
        if self.next_step == Time::NEVER {
            self.next_step = now + self.machine.step();
        }
    }

    /// Brings the machine to the present.
    pub fn advance(&mut self, now: Time) {
        while self.next_step <= now {
            self.next_step = self.next_step + self.machine.step();
            self.steps += 1;
            self.step();
        }
    }

    fn step(&mut self) {
        let codes: Vec<i16> = self
            .converters
            .iter()
            .flat_map(|converter| converter.outputs())
            .collect();
        let high = |pins: &[Pin]| -> Vec<bool> { pins.iter().map(|pin| self.line(*pin)).collect() };
        let (enables, gates) = (high(&self.wiring.enables), high(&self.wiring.gates));
        let Some(seen) = self.machine.advance(&enables, &gates, &codes) else {
            return;
        };
        for (encoder, (counts, mark)) in self.encoders.iter_mut().zip(&seen.counts) {
            encoder.counts = *counts;
            if let Some(mark) = mark {
                encoder.mark = *mark;
                encoder.marks += 1;
            }
        }
        let wiring = self.wiring.clone();
        for (switches, pressed) in [
            (&wiring.limit_plus, seen.limit_plus),
            (&wiring.limit_minus, seen.limit_minus),
        ] {
            for (index, pin) in switches.iter().enumerate() {
                self.set_input(*pin, pressed & 1 << index == 0);
            }
        }
        if let Some(record) = &mut self.record {
            record.push(Step {
                enables,
                gates,
                codes,
                seen,
            });
        }
    }
}
