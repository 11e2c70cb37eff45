//! AD5764R, strapped for two's complement (data sheet, rev. D: "Serial interface", table 2).

use super::SpiClock;
use crate::finding::Findings;
use crate::time::Time;

/// Highest SCLK: its period is 33 ns at least (t1).
const HIGHEST_HZ: u64 = 30_303_030;
/// From SYNC high to LDAC low (t9), when all channels of a chip were written.
const BEFORE_LOAD: Time = Time::ns(1700);
const FRAME_BITS: u32 = 24;
const READ: u32 = 1 << 23;
const DATA: u32 = 0b010;
const FUNCTION: u32 = 0b000;
/// Of the function register: clear, load.
const CLEAR: u32 = 0b100;
const LOAD: u32 = 0b101;

/// A converter.
#[derive(Debug)]
pub struct Ad5764r {
    /// Counted from 1, as in docs/wiring.md.
    number: usize,
    shifted: u32,
    bits: u32,
    /// What a read command has asked for: it goes out with the next frame.
    answer: u32,
    inputs: [i16; 4],
    outputs: [i16; 4],
    deselected: Time,
    /// Complete frames.
    pub frames: u64,
}

impl Ad5764r {
    /// After power-up: all outputs at 0 V.
    pub fn new(index: usize) -> Self {
        Self {
            number: index + 1,
            shifted: 0,
            bits: 0,
            answer: 0,
            inputs: [0; 4],
            outputs: [0; 4],
            deselected: Time::default(),
            frames: 0,
        }
    }

    /// Codes at its outputs.
    pub fn outputs(&self) -> [i16; 4] {
        self.outputs
    }

    /// SYNC falls.
    pub fn select(&mut self) {
        (self.shifted, self.bits) = (0, 0);
    }

    /// A byte while SYNC is low; what comes out at the same time.
    pub fn byte(&mut self, byte: u8, clock: SpiClock, findings: &mut Findings) -> u8 {
        let number = self.number;
        if clock.hz > HIGHEST_HZ {
            findings.report(format!(
                "DAC {number} is clocked at {} Hz: it takes {HIGHEST_HZ} Hz",
                clock.hz
            ));
        }
        let (mut taken, mut given) = (byte, (self.answer >> (16 - self.bits.min(16))) as u8);
        if clock.idles_high == clock.second_edge {
            let mode = u8::from(clock.idles_high) << 1 | u8::from(clock.second_edge);
            findings.report(format!(
                "DAC {number} gets SPI mode {mode}: it takes data at the falling edge, which is mode 1 or 2"
            ));
            // At the edge at which the data changes the converter sees the bit before.
            (taken, given) = (byte >> 1, given >> 1);
        }
        self.shifted = self.shifted << 8 | u32::from(taken);
        self.bits += 8;
        given
    }

    /// SYNC rises: a complete frame is taken.
    pub fn deselect(&mut self, now: Time, findings: &mut Findings) {
        self.deselected = now;
        if self.bits == 0 {
            return;
        }
        if self.bits != FRAME_BITS {
            findings.report(format!(
                "DAC {} gets a frame of {} bits instead of {FRAME_BITS}",
                self.number, self.bits
            ));
            return;
        }
        self.frames += 1;
        let (register, address) = (self.shifted >> 19 & 7, self.shifted >> 16 & 7);
        let channel = (register == DATA && address < 4).then_some(address as usize);
        if self.shifted & READ != 0 {
            self.answer = channel.map_or(0, |channel| u32::from(self.inputs[channel] as u16));
            return;
        }
        match (register, address, channel) {
            (.., Some(channel)) => self.inputs[channel] = self.shifted as i16,
            (FUNCTION, CLEAR, _) => self.clear(),
            (FUNCTION, LOAD, _) => self.outputs = self.inputs,
            // No operation.
            (FUNCTION, ..) => {}
            _ => findings.report(format!(
                "register {register}, {address} of DAC {} is not modelled",
                self.number
            )),
        }
    }

    /// LDAC falls.
    pub fn load(&mut self, now: Time, findings: &mut Findings) {
        let since = now - self.deselected;
        if self.frames > 0 && since < BEFORE_LOAD {
            findings.report(format!(
                "LDAC of DAC {} falls {} ns after SYNC: it needs {} ns",
                self.number,
                since.as_ns(),
                BEFORE_LOAD.as_ns()
            ));
        }
        self.outputs = self.inputs;
    }

    /// CLR falls.
    pub fn clear(&mut self) {
        (self.inputs, self.outputs) = ([0; 4], [0; 4]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Symbols;
    use std::rc::Rc;

    const MODE_1: SpiClock = SpiClock {
        hz: 7_000_000,
        idles_high: false,
        second_edge: true,
    };

    fn frame(converter: &mut Ad5764r, bytes: &[u8], clock: SpiClock, findings: &mut Findings) -> Vec<u8> {
        converter.select();
        let answer = bytes
            .iter()
            .map(|byte| converter.byte(*byte, clock, findings))
            .collect();
        converter.deselect(Time::us(1), findings);
        answer
    }

    fn none() -> Findings {
        Findings::new(Rc::new(Symbols::default()))
    }

    #[test]
    fn a_code_is_given_out_at_the_load_and_read_back() {
        let (mut converter, mut findings) = (Ad5764r::new(0), none());
        frame(&mut converter, &[0x12, 0x80, 0x01], MODE_1, &mut findings);
        assert_eq!(converter.outputs(), [0; 4]);
        converter.load(Time::us(3), &mut findings);
        assert_eq!(converter.outputs(), [0, 0, -32767, 0]);
        frame(&mut converter, &[0x92, 0, 0], MODE_1, &mut findings);
        let answer = frame(&mut converter, &[0, 0, 0], MODE_1, &mut findings);
        assert_eq!(answer[1..], [0x80, 0x01]);
        assert_eq!(findings.all(), []);
        converter.clear();
        assert_eq!(converter.outputs(), [0; 4]);
    }

    #[test]
    fn what_the_data_sheet_forbids_is_found() {
        let found = |act: fn(&mut Ad5764r, &mut Findings)| {
            let (mut converter, mut findings) = (Ad5764r::new(1), none());
            act(&mut converter, &mut findings);
            findings
                .all()
                .first()
                .map(|finding| finding.cause.clone())
                .unwrap_or_default()
        };
        let torn = found(|converter, findings| drop(frame(converter, &[1, 2], MODE_1, findings)));
        assert_eq!(torn, "DAC 2 gets a frame of 16 bits instead of 24");
        let mode = found(|converter, findings| {
            let mode_0 = SpiClock {
                second_edge: false,
                ..MODE_1
            };
            frame(converter, &[0x10, 0, 0], mode_0, findings);
        });
        assert!(mode.starts_with("DAC 2 gets SPI mode 0"), "{mode}");
        let early = found(|converter, findings| {
            frame(converter, &[0x10, 0, 0], MODE_1, findings);
            converter.load(Time::us(2), findings);
        });
        assert_eq!(early, "LDAC of DAC 2 falls 1000 ns after SYNC: it needs 1700 ns");
        let fast = found(|converter, findings| {
            let fast = SpiClock {
                hz: 57_000_000,
                ..MODE_1
            };
            frame(converter, &[0x10, 0, 0], fast, findings);
        });
        assert!(fast.contains("clocked at 57000000 Hz"), "{fast}");
    }
}
