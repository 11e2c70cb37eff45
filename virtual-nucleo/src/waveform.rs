//! What leaves the pins of both boards, as a file that viewers of waveforms read (VCD, IEEE 1364-2005, 18).

use crate::board::Board;
use crate::chip::pins::Pin;
use crate::chip::recorder::{Change, Level};
use crate::time::Time;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use vcd::{IdCode, TimescaleUnit, Value, Writer};

/// Ports of the chip in its package of 144 pins: A to H, of the last one two pins (DS13313, table 8).
const PINS: std::ops::Range<u8> = 0..7 * 16 + 2;

/// A file that is being written.
pub struct Waveform {
    writer: Writer<BufWriter<File>>,
    /// Of each board.
    wires: Vec<BTreeMap<Pin, IdCode>>,
    /// Changes later than what was written.
    waiting: Vec<(Time, IdCode, Level)>,
}

impl Waveform {
    /// Begins to record `boards`, which have these names. Lines of docs/wiring.md have their names there, the other pins only
    /// their own.
    pub fn create(path: &Path, names: &[&str], boards: &mut [Board]) -> io::Result<Self> {
        let mut writer = Writer::new(BufWriter::new(File::create(path)?));
        writer.timescale(1, TimescaleUnit::NS)?;
        let mut wires = Vec::new();
        for (name, board) in names.iter().zip(&mut *boards) {
            writer.add_module(name)?;
            let mut of_board = BTreeMap::new();
            writer.add_module("outputs")?;
            for line in board.chip().shared.outside.outputs() {
                let name = format!("{}_{}", line.name.replace(' ', "_"), line.pin);
                of_board.insert(line.pin, writer.add_wire(1, &name)?);
            }
            writer.upscope()?;
            writer.add_module("other_pins")?;
            for index in PINS {
                let pin = Pin {
                    port: index / 16,
                    number: index % 16,
                };
                if let Entry::Vacant(other) = of_board.entry(pin) {
                    other.insert(writer.add_wire(1, &pin.to_string())?);
                }
            }
            writer.upscope()?;
            writer.upscope()?;
            wires.push(of_board);
            board.record_pins();
        }
        writer.enddefinitions()?;
        writer.timestamp(0)?;
        let mut waveform = Self {
            writer,
            wires,
            waiting: Vec::new(),
        };
        for (wires, board) in waveform.wires.iter().zip(boards) {
            for (pin, wire) in wires {
                let level = board.chip().shared.recorder.level(*pin);
                waveform.writer.change_scalar(*wire, value(level))?;
            }
        }
        Ok(waveform)
    }

    /// Writes what the boards did until `now`.
    pub fn write(&mut self, boards: &mut [Board], now: Time) -> io::Result<()> {
        for (wires, board) in self.wires.iter().zip(boards) {
            let changes = board.chip_mut().shared.recorder.take();
            let known = |Change { at, pin, level }| Some((at, *wires.get(&pin)?, level));
            self.waiting.extend(changes.into_iter().filter_map(known));
        }
        self.waiting.sort_by_key(|(at, ..)| *at);
        let due = self.waiting.partition_point(|(at, ..)| *at <= now);
        let mut last = None;
        for (at, wire, level) in self.waiting.drain(..due) {
            if last.replace(at.as_ns()) != Some(at.as_ns()) {
                self.writer.timestamp(at.as_ns())?;
            }
            self.writer.change_scalar(wire, value(level))?;
        }
        Ok(())
    }

    /// Writes the end.
    pub fn close(mut self, boards: &mut [Board], now: Time) -> io::Result<()> {
        self.write(boards, now)?;
        self.writer.timestamp(now.as_ns())?;
        self.writer.writer().flush()
    }
}

/// A peripheral's level is not known.
fn value(level: Level) -> Value {
    match level {
        Level::Floating => Value::Z,
        Level::Low => Value::V0,
        Level::High => Value::V1,
        Level::Peripheral => Value::X,
    }
}
