//! Inputs and outputs of the control laws, exchanged with a board once per tick: the axis facade in plain
//! values.
//!
//! A board crate turns these into registers; the emulated board turns them into a step of its plant. The
//! control laws know nothing else of the machine.

mod lines;

pub use lines::{CHANGES, HeldLines, LineChange, LineChanges, Lines, Switched, SwitchedLines};

use serde::{Deserialize, Serialize};

/// Servo drives of the motion board, in this order everywhere: X1, X2, Y, Z, A, B, C.
pub const MOTORS: usize = 7;
/// Linked axes, in this order everywhere: X, Y, Z, A, B, C.
pub const AXES: usize = 6;
/// Slide drives of the tracker board, in this order everywhere: U1, V1, U2, V2.
pub const SLIDES: usize = 4;
/// Channels of the emergency stop.
pub const ESTOP_CHANNELS: usize = 2;
/// Sides of the seam, each with a beam, a camera and a pair of slides.
pub const SIDES: usize = 2;
/// Digital outputs of the motion board for the process: gas, wire feed, whatever the machine file names.
pub const OUTPUTS: usize = 8;
/// Analog outputs of the motion board for the process.
pub const ANALOG_OUTPUTS: usize = 2;
/// Inputs of the motion board by which the process answers: arc on, gas flows, wire moves, cooling runs.
pub const PROCESS_INPUTS: usize = 4;
/// Levels that are set on the path: the powers of the beams, then the analog outputs.
pub const LEVELS: usize = SIDES + ANALOG_OUTPUTS;
/// Lines that are switched on the path: the gates of the beams, then the digital outputs.
pub const LINES: usize = SIDES + OUTPUTS;

/// Names of the motors, in the order of [`MOTORS`].
pub const MOTOR_NAMES: [&str; MOTORS] = ["X1", "X2", "Y", "Z", "A", "B", "C"];
/// Names of the axes, in the order of [`AXES`].
pub const AXIS_NAMES: [&str; AXES] = ["X", "Y", "Z", "A", "B", "C"];
/// The axis that each motor drives.
pub const MOTOR_AXIS: [usize; MOTORS] = [0, 0, 1, 2, 3, 4, 5];
/// Names of the slides, in the order of [`SLIDES`].
pub const SLIDE_NAMES: [&str; SLIDES] = ["U1", "V1", "U2", "V2"];

/// Whether `motor` is called so, by its own name or by that of its axis.
pub fn is_called(motor: usize, name: &str) -> bool {
    [MOTOR_NAMES[motor], AXIS_NAMES[MOTOR_AXIS[motor]]].contains(&name)
}

/// A signed 16-bit converter code, −32767…32767 for −10…+10 V; −32768 is never sent (mathematics 0.8.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DacCode(pub i16);

impl DacCode {
    /// Zero volts.
    pub const ZERO: Self = Self(0);

    /// The code for `value` when `full_scale` (same unit, may be negative for a reversed drive) is +10 V;
    /// saturates at ±10 V, and is zero for a value that is not a number.
    pub fn from_ratio(value: f64, full_scale: f64) -> Self {
        let code = value / full_scale * 32767.0;
        // The cast rounds towards zero and saturates.
        Self(((code + libm::copysign(0.5, code)) as i16).max(-32767))
    }

    /// Part of the full scale, −1…1.
    pub fn ratio(self) -> f64 {
        f64::from(self.0) / 32767.0
    }
}

/// One bit a motor or slide, bit 0 the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Bits(pub u8);

impl Bits {
    /// No bit set.
    pub const NONE: Self = Self(0);

    /// Whether bit `index` is set.
    pub fn get(self, index: usize) -> bool {
        self.0 & (1 << index) != 0
    }

    /// Sets or clears bit `index`.
    pub fn set(&mut self, index: usize, on: bool) {
        if on {
            self.0 |= 1 << index;
        } else {
            self.0 &= !(1 << index);
        }
    }

    /// Whether any bit is set.
    pub fn any(self) -> bool {
        self.0 != 0
    }

    /// The first bit that is set.
    pub fn first(self) -> Option<u8> {
        self.any().then(|| self.0.trailing_zeros() as u8)
    }

    /// The bits that are set in `of`, too.
    #[must_use]
    pub fn only(self, of: Self) -> Self {
        Self(self.0 & of.0)
    }

    /// The bits that are set in either.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Inputs of `N` drives, latched together at one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback<const N: usize> {
    /// Grating or encoder counts since power-up, extended to 64 bits by the board.
    pub counts: [i64; N],
    /// Counts that the hardware latched at a reference mark since the last tick.
    pub mark: [Option<i64>; N],
    /// Limit switch at the positive end of the axis is pressed.
    pub limit_plus: Bits,
    /// Limit switch at the negative end of the axis is pressed.
    pub limit_minus: Bits,
    /// Drive reports a fault.
    pub drive_fault: Bits,
    /// A converter did not read back what it was told: all outputs are off until the board is reset, and every drive reports
    /// a fault.
    pub converter_failed: bool,
    /// Channels of the emergency stop that are open: both when it is pressed, and either one stops.
    pub estop: [bool; ESTOP_CHANNELS],
    /// Laser source reports a fault, per side (motion board).
    pub laser_fault: [bool; SIDES],
    /// Power that the source of each side gives, in the scale of [`Command::beam_power`]; `None` where it is not measured
    /// (motion board).
    pub beam_power: [Option<DacCode>; SIDES],
    /// Inputs of the process that are on, bit 0 the first (motion board).
    pub process: Bits,
    /// Lines that were switched in the period that ends with this tick (motion board).
    pub switched: SwitchedLines,
}

impl<const N: usize> Feedback<N> {
    /// Nothing moves, nothing is pressed.
    pub const NONE: Self = Self {
        counts: [0; N],
        mark: [None; N],
        limit_plus: Bits::NONE,
        limit_minus: Bits::NONE,
        drive_fault: Bits::NONE,
        converter_failed: false,
        estop: [false; ESTOP_CHANNELS],
        laser_fault: [false; SIDES],
        beam_power: [None; SIDES],
        process: Bits::NONE,
        switched: SwitchedLines::NONE,
    };
}

impl<const N: usize> Default for Feedback<N> {
    fn default() -> Self {
        Self::NONE
    }
}

/// Outputs to `N` drives and, on the motion board, to the beams.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command<const N: usize> {
    /// Drives are enabled. All of a board's drives are switched together.
    pub enable: bool,
    /// Velocity command to each drive.
    pub dac: [DacCode; N],
    /// Beam gate open, per side (motion board); the beam of the side may burn (tracker board).
    pub beam_gate: [bool; SIDES],
    /// Beam power, per side (motion board); only 0…32767.
    pub beam_power: [DacCode; SIDES],
    /// Digital outputs that are on, bit 0 the first (motion board).
    pub outputs: Bits,
    /// Analog outputs (motion board).
    pub analog: [DacCode; ANALOG_OUTPUTS],
    /// How gates and digital outputs change before the next tick (motion board).
    pub changes: LineChanges,
}

impl<const N: usize> Command<N> {
    /// Drives off, zero volts, beams off.
    pub const SAFE: Self = Self {
        enable: false,
        dac: [DacCode::ZERO; N],
        beam_gate: [false; SIDES],
        beam_power: [DacCode::ZERO; SIDES],
        outputs: Bits::NONE,
        analog: [DacCode::ZERO; ANALOG_OUTPUTS],
        changes: LineChanges::NONE,
    };

    /// Gates and digital outputs at the tick.
    pub fn lines(&self) -> Lines {
        Lines(Lines::of_gates(self.beam_gate).0 | u16::from(self.outputs.0) << SIDES)
    }

    /// Sets gates and digital outputs.
    pub fn set_lines(&mut self, lines: Lines) {
        self.beam_gate = lines.gates();
        self.outputs = lines.outputs();
    }
}

/// Inputs of the motion board at a servo tick.
pub type MotionFeedback = Feedback<MOTORS>;
/// Outputs of the motion board at a servo tick.
pub type MotionCommand = Command<MOTORS>;
/// Inputs of the tracker board at a control tick.
pub type SlideFeedback = Feedback<SLIDES>;
/// Outputs of the tracker board at a control tick.
pub type SlideCommand = Command<SLIDES>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_saturate_round_away_and_survive_nan() {
        assert_eq!(DacCode::from_ratio(50.0, 100.0), DacCode(16384));
        assert_eq!(DacCode::from_ratio(-500.0, 100.0), DacCode(-32767));
        assert_eq!(DacCode::from_ratio(1.0, -100.0), DacCode(-328));
        assert_eq!(DacCode::from_ratio(f64::NAN, 100.0), DacCode::ZERO);
    }
}
