//! What a motion board has: seven drives with gratings, two beams, two ticks, a network, a watchdog.

use crate::clocks::CORE_MHZ;
use crate::encoders::{self, Encoder};
use crate::inputs::{self, Snapshot};
use crate::outputs::{Outputs, output, switch_line};
use crate::pins::{BEAM_GATES, LASERS_READY, MOTION, PROCESS_INPUTS, PROCESS_OUTPUTS, mask};
use crate::{Network, Tick, Watchdog, bring_up, gpio, timebase};
use board_switching::{LinePort, SysTick};
use embassy_stm32::pac;
use shared::io::{Bits, LEVELS, Lines, MOTORS, MotionCommand, MotionFeedback, SIDES};

/// IPv4 address of the board.
pub const ADDRESS: [u8; 4] = [192, 168, 71, 11];
/// Length of the net's prefix.
pub const PREFIX: u8 = 24;
/// Gateway: the PC.
pub const GATEWAY: [u8; 4] = [192, 168, 71, 1];

/// Period of the servo tick \[µs\].
const SERVO_PERIOD_US: u32 = 250;
/// Period of the path tick \[µs\].
const PATH_PERIOD_US: u32 = 1000;

/// Servo ticks from one reading back of a converter's output to the next: a millisecond.
const READ_BACK_EVERY: u32 = PATH_PERIOD_US / SERVO_PERIOD_US;

/// Converters: seven velocities on the first two, beam powers and analog outputs on the third.
const CHIPS: usize = 3;
/// First output of the third converter.
const FIRST_POWER: usize = 8;
/// Enable lines.
const ENABLES: u16 = mask(&MOTION.enable);
/// A bit for every drive.
const ALL_DRIVES: u8 = (1 << MOTORS) - 1;

/// The board's parts.
pub struct Board {
    /// Servo tick, 4 kHz.
    pub servo_tick: Tick,
    /// Path tick, 1 kHz, in phase with every fourth servo tick.
    pub path_tick: Tick,
    /// Drives, gratings and levels.
    pub axes: Axes,
    /// Gates of the beams and digital outputs.
    pub lines: ProcessLines,
    /// Ethernet port.
    pub network: Network,
    /// Watchdog.
    pub watchdog: Watchdog,
}

/// Sets the board up, outputs off. Both timers run when it returns.
pub fn init(core: cortex_m::Peripherals) -> Board {
    let (watchdog, bus, parts, timer) = bring_up::start(core);
    inputs::start(&MOTION, &LASERS_READY);
    for pin in PROCESS_INPUTS {
        gpio::input(pin);
    }
    for pin in PROCESS_OUTPUTS {
        gpio::Output::new(pin, false);
    }
    let [gate_1, gate_2] = BEAM_GATES;
    let [x1, x2, y, z, a, b, c] = MOTION.enable;
    let axes = Axes {
        outputs: Outputs::start(bus, &[x1, x2, y, z, a, b, c, gate_1, gate_2], READ_BACK_EVERY),
        encoders: core::array::from_fn(|motor| Encoder::start(&MOTION.encoders[motor])),
    };
    let lines = ProcessLines::new(SysTick::new(timer, CORE_MHZ), Pins);
    let network = Network::start(parts);
    let [servo_tick, path_tick] = Tick::start([(pac::TIM6, SERVO_PERIOD_US), (pac::TIM7, PATH_PERIOD_US)]);
    Board {
        servo_tick,
        path_tick,
        axes,
        lines,
        network,
        watchdog,
    }
}

/// The axes.
pub struct Axes {
    outputs: Outputs<CHIPS>,
    encoders: [Encoder; MOTORS],
}

impl Axes {
    /// A real machine goes on by itself.
    pub fn advance(&mut self) {}

    /// Latches the inputs of a servo tick. Once a converter has failed, every drive reports a fault.
    pub fn read(&mut self) -> MotionFeedback {
        let mut feedback = MotionFeedback::default();
        encoders::fill(&mut self.encoders, &mut feedback);
        let inputs = Snapshot::take();
        inputs.fill(&MOTION, &mut feedback);
        feedback.laser_fault = LASERS_READY.map(|pin| inputs.open(pin));
        feedback.process = inputs.high(&PROCESS_INPUTS);
        feedback.converter_failed = self.outputs.failed();
        if feedback.converter_failed {
            feedback.drive_fault = Bits(ALL_DRIVES);
        }
        feedback
    }

    /// Sets the outputs: what goes off goes off first, then all converters step together, then the rest goes on.
    pub fn write(&mut self, command: &MotionCommand) {
        let mut on = if command.enable { ENABLES } else { 0 };
        for (gate, open) in BEAM_GATES.iter().zip(command.beam_gate) {
            if open {
                on |= mask(&[*gate]);
            }
        }
        let mut codes = [(output(0), 0); MOTORS + LEVELS];
        for (motor, code) in command.dac.iter().enumerate() {
            codes[motor] = (output(motor), code.0);
        }
        for (side, power) in command.beam_power.iter().enumerate() {
            codes[MOTORS + side] = (output(FIRST_POWER + side), power.0.max(0));
        }
        for (index, level) in command.analog.iter().enumerate() {
            codes[MOTORS + SIDES + index] = (output(FIRST_POWER + SIDES + index), level.0.max(0));
        }
        self.outputs.apply(ENABLES | mask(&BEAM_GATES), on, &codes);
    }

    /// True positions: a real machine does not know them.
    pub fn truth(&self) -> Option<[f64; MOTORS]> {
        None
    }
}

/// Gates and digital outputs, which are switched at ticks and between them.
pub type ProcessLines = board_switching::ProcessLines<SysTick, Pins>;

/// The pins of gates and digital outputs.
pub struct Pins;

impl LinePort for Pins {
    fn now_us(&self) -> u64 {
        timebase::now_us()
    }

    fn set(&mut self, lines: Lines) {
        let pins = BEAM_GATES.iter().chain(&PROCESS_OUTPUTS).enumerate();
        for (line, pin) in pins {
            switch_line(*pin, lines.get(line));
        }
    }
}
