//! Timers (RM0468, 43 to 46): counting up by their clock, and encoder mode with capture of the reference mark.

use super::map::exception;
use super::pins::Signal;
use super::shared::{Peripheral, Shared};
use crate::outside::Track;
use crate::time::Time;

const CR1: u32 = 0x00;
const SMCR: u32 = 0x08;
const DIER: u32 = 0x0c;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CCMR2: u32 = 0x1c;
const CCER: u32 = 0x20;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2c;
const CCR1: u32 = 0x34;
const CCR4: u32 = 0x40;
const WORDS: usize = 0x70 / 4;
const ENABLED: u32 = 1;
const UPDATE_BY_OVERFLOW_ONLY: u32 = 1 << 2;
const UPDATE: u32 = 1;
/// An interrupt more often than this leaves no time for its own handler.
const SHORTEST: Time = Time::us(1);
/// Encoder mode 3: both edges of both tracks count.
const ENCODER: u32 = 3;

/// A timer.
#[derive(Debug)]
pub struct Timer {
    name: &'static str,
    words: [u32; WORDS],
    /// Highest value that its counter holds.
    highest: u32,
    /// Place in [`super::clocks::Clocks::timers`].
    bus: usize,
    exception: Option<u16>,
    signals: [Signal; 4],
    /// The prescaler in use; PSC is taken over at an update.
    prescaler: u32,
    /// Count at `since`, from where it counts on.
    base: u32,
    since: Time,
    /// When it updates next, if that asks for an interrupt.
    next: Time,
    encoder: Option<Encoder>,
}

/// What encoder mode follows.
#[derive(Debug)]
struct Encoder {
    /// Number of the encoder outside.
    index: usize,
    /// Its counts where this timer's counter was 0, and the direction.
    zero: i64,
    sign: i64,
    /// Marks seen.
    marks: u64,
}

impl Timer {
    /// The timer of this name, as after a reset.
    pub fn new(name: &'static str) -> Self {
        let wide = matches!(name, "TIM2" | "TIM5" | "TIM23" | "TIM24");
        let on_apb2 = matches!(name, "TIM1" | "TIM8" | "TIM15" | "TIM16" | "TIM17");
        let highest = if wide { u32::MAX } else { 0xffff };
        let mut words = [0; WORDS];
        words[ARR as usize / 4] = highest;
        let interrupt = match name {
            "TIM6" => "TIM6_DAC",
            // Their update has a vector of its own, which nothing here uses.
            "TIM1" => "TIM1_UP",
            "TIM8" => "TIM8_UP_TIM13",
            other => other,
        };
        Self {
            name,
            words,
            highest,
            bus: usize::from(on_apb2),
            exception: exception(interrupt),
            signals: ["CH1", "CH2", "CH3", "CH4"].map(|channel| Signal::of(name, channel)),
            prescaler: 0,
            base: 0,
            since: Time::default(),
            next: Time::NEVER,
            encoder: None,
        }
    }

    fn word(&self, offset: u32) -> u32 {
        self.words[offset as usize / 4]
    }

    fn mode(&self) -> u32 {
        let mode = self.word(SMCR);
        mode & 7 | mode >> 13 & 8
    }

    fn runs(&self) -> bool {
        self.word(CR1) & ENABLED != 0
    }

    /// Clock of the counter \[Hz\], and its periods to an overflow.
    fn period(&self, shared: &Shared) -> Time {
        let hz = shared.clocks.timers[self.bus];
        Time::periods(
            (u64::from(self.word(ARR)) + 1) * (u64::from(self.prescaler) + 1),
            hz,
        )
    }

    fn count(&self, shared: &Shared) -> u32 {
        if let Some(encoder) = &self.encoder {
            let counts = shared.outside.encoder(encoder.index).counts;
            return encoder.reading(counts) as u32 & self.highest;
        }
        if !self.runs() || self.mode() != 0 {
            return self.base;
        }
        let steps = (shared.now() - self.since).count(shared.clocks.timers[self.bus])
            / (u64::from(self.prescaler) + 1);
        let modulus = u64::from(self.word(ARR)) + 1;
        ((u64::from(self.base) + steps) % modulus) as u32
    }

    /// Works out when it updates next.
    fn schedule(&mut self, shared: &mut Shared) {
        self.next = Time::NEVER;
        if !self.runs() || self.mode() != 0 {
            return;
        }
        let period = self.period(shared);
        if period < SHORTEST && self.word(DIER) & UPDATE != 0 {
            shared.report(format!(
                "{} would interrupt every {period}: nothing else could run",
                self.name
            ));
            return;
        }
        let left = (u64::from(self.word(ARR)) + 1).saturating_sub(u64::from(self.base));
        let hz = shared.clocks.timers[self.bus];
        self.next = self.since + Time::periods(left * (u64::from(self.prescaler) + 1), hz);
    }

    fn restart(&mut self, count: u32, shared: &Shared) {
        self.base = count;
        self.since = shared.now();
        if let Some(encoder) = &mut self.encoder {
            let counts = shared.outside.encoder(encoder.index).counts;
            encoder.zero = counts - encoder.sign * i64::from(count);
        }
    }

    fn update(&mut self, shared: &Shared) {
        self.prescaler = self.word(PSC) & 0xffff;
        self.restart(0, shared);
    }

    /// Looks which encoder the pins of channels 1 and 2 lead to.
    fn connect(&mut self, shared: &mut Shared) {
        self.encoder = None;
        if !self.runs() || self.mode() != ENCODER {
            return;
        }
        let mut tracks = [None; 2];
        for (track, signal) in tracks.iter_mut().zip(&self.signals) {
            let pin = shared.pins.connected(signal);
            if pin.is_none() {
                shared.findings.report(format!(
                    "{} counts an encoder, but no pin is connected to {}",
                    self.name, signal.name
                ));
            }
            *track = pin.and_then(|pin| shared.outside.track(pin));
        }
        for channel in [0, 1] {
            if self.word(CCMR1) >> (8 * channel) & 3 != 1 {
                shared.report(format!(
                    "{} counts an encoder, but its channel {} is not an input from its own pin",
                    self.name,
                    channel + 1
                ));
            }
        }
        let (index, sign) = match tracks {
            [Some((index, Track::A)), Some((other, Track::B))] if index == other => (index, 1),
            [Some((index, Track::B)), Some((other, Track::A))] if index == other => (index, -1),
            _ => {
                shared.report(format!(
                    "{} counts an encoder, but its channels 1 and 2 are not tracks A and B of one",
                    self.name
                ));
                return;
            }
        };
        let outside = shared.outside.encoder(index);
        self.encoder = Some(Encoder {
            index,
            zero: outside.counts - sign * i64::from(self.base),
            sign,
            marks: outside.marks,
        });
    }

    /// Latches the count of a mark that has passed.
    fn capture(&mut self, shared: &mut Shared) {
        let Some(encoder) = &mut self.encoder else { return };
        let outside = shared.outside.encoder(encoder.index);
        if outside.marks == encoder.marks {
            return;
        }
        encoder.marks = outside.marks;
        let latched = encoder.reading(outside.mark) as u32 & self.highest;
        let mark = (encoder.index, Track::Z);
        for channel in 0..4 {
            let mode = self.word(if channel < 2 { CCMR1 } else { CCMR2 }) >> (8 * (channel % 2)) & 3;
            let enabled = self.word(CCER) >> (4 * channel) & 1 != 0;
            let pin = shared.pins.connected(&self.signals[channel as usize]);
            if enabled && mode == 1 && pin.and_then(|pin| shared.outside.track(pin)) == Some(mark) {
                let flag = 1 << (channel + 1);
                let status = &mut self.words[SR as usize / 4];
                // A second one before the first was read sets the overcapture flag, too.
                *status |= if *status & flag != 0 { flag << 8 } else { flag };
                self.words[(CCR1 + 4 * channel) as usize / 4] = latched;
            }
        }
    }
}

impl Encoder {
    fn reading(&self, counts: i64) -> i64 {
        self.sign * (counts - self.zero)
    }
}

impl Peripheral for Timer {
    fn read(&mut self, offset: u32, shared: &mut Shared) -> u32 {
        shared.outside.advance(shared.clock.now());
        self.capture(shared);
        match offset {
            CNT => self.count(shared),
            CCR1..=CCR4 => {
                let flag = 1 << ((offset - CCR1) / 4 + 1);
                self.words[SR as usize / 4] &= !flag;
                self.word(offset)
            }
            _ => self.words.get(offset as usize / 4).copied().unwrap_or(0),
        }
    }

    fn write(&mut self, offset: u32, value: u32, _: u32, shared: &mut Shared) {
        match offset {
            SR => self.words[SR as usize / 4] &= value,
            EGR => {
                self.update(shared);
                if value & UPDATE != 0 && self.word(CR1) & UPDATE_BY_OVERFLOW_ONLY == 0 {
                    self.words[SR as usize / 4] |= UPDATE;
                }
            }
            CNT => self.restart(value & self.highest, shared),
            CR1 | SMCR | CCMR1 | CCMR2 => {
                let (count, ran) = (self.count(shared), self.runs());
                self.words[offset as usize / 4] = value;
                self.restart(count, shared);
                if self.runs() {
                    if !ran && self.word(DIER) & UPDATE != 0 {
                        shared.outside.tick_begins(shared.clock.now());
                    }
                    if !matches!(self.mode(), 0 | ENCODER) {
                        shared.report(format!(
                            "the mode {} of {} is not modelled",
                            self.mode(),
                            self.name
                        ));
                    }
                }
                self.connect(shared);
            }
            DIER if value & !UPDATE != 0 => shared.report(format!(
                "interrupts of {} but its update are not modelled",
                self.name
            )),
            ARR if value & !self.highest != 0 => {
                shared.report(format!("ARR of {} is written with more than 16 bits", self.name))
            }
            _ => {
                if let Some(word) = self.words.get_mut(offset as usize / 4) {
                    *word = value;
                }
            }
        }
        self.schedule(shared);
    }

    fn due(&self) -> Time {
        self.next
    }

    fn advance(&mut self, shared: &mut Shared) {
        let now = shared.now();
        if self.next > now {
            return;
        }
        let periods = (now - self.next).0 / self.period(shared).0.max(1);
        self.since = self.next + Time(periods * self.period(shared).0);
        self.base = 0;
        self.words[SR as usize / 4] |= UPDATE;
        self.schedule(shared);
    }

    fn asks_for(&self) -> Option<u16> {
        self.exception
            .filter(|_| self.word(SR) & self.word(DIER) & UPDATE != 0)
    }
}
