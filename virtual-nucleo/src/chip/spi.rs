//! A serial bus as a master of bytes (RM0468, 55).

use super::pins::Signal;
use super::shared::{Peripheral, Shared};
use crate::outside::SpiClock;
use crate::time::Time;
use std::collections::VecDeque;

const CR1: u32 = 0x00;
const CFG1: u32 = 0x08;
const CFG2: u32 = 0x0c;
const IER: u32 = 0x10;
const SR: u32 = 0x14;
const IFCR: u32 = 0x18;
const TXDR: u32 = 0x20;
const RXDR: u32 = 0x30;
const WORDS: usize = 0x58 / 4;
const ENABLED: u32 = 1;
const STARTED: u32 = 1 << 9;
const MASTER: u32 = 1 << 22;
const RXP: u32 = 1;
const TXP: u32 = 1 << 1;
const EOT: u32 = 1 << 3;
const TXTF: u32 = 1 << 4;
const OVERRUN: u32 = 1 << 6;
const TXC: u32 = 1 << 12;
/// Bytes that SPI1 to SPI3 hold each way (RM0468, table 426).
const FIFO: usize = 16;
/// Readings of the status that take their time before they are skipped.
const POLLS: u32 = 2;

/// The controller.
#[derive(Debug)]
pub struct Spi {
    name: &'static str,
    words: [u32; WORDS],
    /// Bytes on their way in, and when they will have come.
    incoming: VecDeque<(Time, u8)>,
    /// Bytes that wait for the start.
    outgoing: VecDeque<u8>,
    /// When the last byte will be through.
    busy_until: Time,
    flags: u32,
    /// Times that the status was read since a byte was sent or taken.
    polls: u32,
    clock: Signal,
    output: Signal,
    input: Signal,
}

impl Spi {
    /// The controller of this name, as after a reset.
    pub fn new(name: &'static str) -> Self {
        let mut words = [0; WORDS];
        words[CFG1 as usize / 4] = 0x0007_0007;
        Self {
            name,
            words,
            incoming: VecDeque::new(),
            outgoing: VecDeque::new(),
            busy_until: Time::default(),
            flags: 0,
            polls: 0,
            clock: Signal::of(name, "SCK"),
            output: Signal::of(name, "MOSI"),
            input: Signal::of(name, "MISO"),
        }
    }

    fn word(&self, offset: u32) -> u32 {
        self.words[offset as usize / 4]
    }

    fn runs(&self) -> bool {
        self.word(CR1) & (ENABLED | STARTED) == ENABLED | STARTED
    }

    fn send_waiting(&mut self, shared: &mut Shared) {
        while self.runs() {
            let Some(byte) = self.outgoing.pop_front() else {
                return;
            };
            self.send(byte, shared);
        }
    }

    fn send(&mut self, byte: u8, shared: &mut Shared) {
        let (format, mode) = (self.word(CFG1), self.word(CFG2));
        let hz = shared.clocks.pll1_q >> ((format >> 28 & 7) + 1);
        if format & 0x1f != 7 || mode & MASTER == 0 {
            shared.report(format!("{} is modelled as a master of bytes only", self.name));
        }
        for signal in [&self.clock, &self.output, &self.input] {
            if shared.pins.connected(signal).is_none() {
                shared.findings.report(format!(
                    "{} sends, but no pin is connected to {}",
                    self.name, signal.name
                ));
            }
        }
        let begin = shared.now().max(self.busy_until);
        self.busy_until = begin + Time::periods(8, hz);
        let clock = SpiClock {
            hz,
            idles_high: mode & 1 << 25 != 0,
            second_edge: mode & 1 << 24 != 0,
        };
        let connected = |signal: &Signal| shared.pins.connected(signal).is_some();
        let (sends, receives) = (
            connected(&self.clock) && connected(&self.output),
            connected(&self.input),
        );
        let mut answer = u8::MAX;
        if sends {
            answer = shared.outside.spi_byte(byte, clock, &mut shared.findings);
        }
        if self.incoming.len() >= FIFO {
            self.flags |= OVERRUN;
            return;
        }
        self.incoming
            .push_back((self.busy_until, if receives { answer } else { u8::MAX }));
    }

    /// The status, again and again: the turns of the loop are skipped to the next byte.
    fn poll(&mut self, shared: &mut Shared) -> u32 {
        let now = shared.now();
        self.polls += 1;
        if self.polls > POLLS {
            shared.polls_until = self.incoming.front().map(|(at, _)| *at).filter(|at| *at > now);
        }
        self.status(now)
    }

    fn status(&self, now: Time) -> u32 {
        let mut status = self.flags;
        if self.incoming.front().is_some_and(|(at, _)| *at <= now) {
            status |= RXP;
        }
        if self.word(CR1) & ENABLED != 0 && self.outgoing.len() < FIFO {
            status |= TXP;
        }
        if self.busy_until <= now {
            status |= TXC | EOT | TXTF;
        }
        status
    }
}

impl Peripheral for Spi {
    fn read(&mut self, offset: u32, shared: &mut Shared) -> u32 {
        match offset {
            SR => self.poll(shared),
            RXDR => match self.incoming.front() {
                Some((at, byte)) if *at <= shared.now() => {
                    let byte = *byte;
                    self.polls = 0;
                    self.incoming.pop_front();
                    u32::from(byte)
                }
                _ => 0,
            },
            _ => self.words.get(offset as usize / 4).copied().unwrap_or(0),
        }
    }

    fn write(&mut self, offset: u32, value: u32, size: u32, shared: &mut Shared) {
        match offset {
            CR1 => {
                let was = self.word(CR1);
                self.words[CR1 as usize / 4] = if value & ENABLED == 0 {
                    value & !STARTED
                } else {
                    value
                };
                if was & ENABLED != 0 && value & ENABLED == 0 {
                    if self.busy_until > shared.now() {
                        shared.report(format!("{} is switched off while it sends", self.name));
                    }
                    self.incoming.clear();
                    self.outgoing.clear();
                }
                self.send_waiting(shared);
            }
            CFG1 | CFG2 if self.word(CR1) & ENABLED != 0 && self.word(offset) != value => {
                shared.report(format!(
                    "the setting of {} is written while it is on: the write is lost",
                    self.name
                ));
            }
            TXDR if self.word(CR1) & ENABLED == 0 => {
                shared.report(format!("{} is given a byte while it is off", self.name));
            }
            TXDR => {
                self.polls = 0;
                let bytes = value.to_le_bytes();
                self.outgoing.extend(bytes.into_iter().take(size as usize));
                self.send_waiting(shared);
            }
            IFCR => self.flags &= !value,
            IER if value != 0 => shared.report(format!("interrupts of {} are not modelled", self.name)),
            _ => {
                if let Some(word) = self.words.get_mut(offset as usize / 4) {
                    *word = value;
                }
            }
        }
    }
}
