//! What a motion board has: seven axes on a simulated machine, two ticks, a network, a watchdog.

use crate::registers::Block;
use crate::{Network, Tick, Watchdog, logger, machine, time};
use board_switching::{LinePort, SysTick};
use plant::MotionPlant;
use shared::io::{Lines, MOTORS, MotionCommand, MotionFeedback};

/// IPv4 address of the board.
pub const ADDRESS: [u8; 4] = [10, 0, 2, 15];
/// Length of the net's prefix.
pub const PREFIX: u8 = 24;
/// Gateway; behind it stands the PC.
pub const GATEWAY: [u8; 4] = [10, 0, 2, 2];

/// Period of the servo tick \[µs\].
const SERVO_PERIOD_US: u32 = 250;
/// Period of the path tick \[µs\].
const PATH_PERIOD_US: u32 = 1000;

/// The board's parts.
pub struct Board {
    /// Servo tick, 4 kHz.
    pub servo_tick: Tick,
    /// Path tick, 1 kHz, in phase with every fourth servo tick.
    pub path_tick: Tick,
    /// Drives, gratings and powers.
    pub axes: Axes,
    /// Gates of the beams and digital outputs.
    pub lines: ProcessLines,
    /// Ethernet port.
    pub network: Network,
    /// Watchdog.
    pub watchdog: Watchdog,
}

/// Sets the board up. Both timers run when it returns.
pub fn init(mut core: cortex_m::Peripherals) -> Board {
    board_faults::guard_stack(&mut core);
    time::start();
    logger::start();
    let axes = Axes {
        plant: MotionPlant::new(&machine::wired()),
        command: MotionCommand::SAFE,
        feedback: MotionFeedback::NONE,
    };
    let network = Network::start();
    let watchdog = Watchdog::new(&mut core.NVIC);
    let timer = SysTick::new(core.SYST, time::TICKS_PER_US as u32);
    let lines = ProcessLines::new(timer, Pins);
    Board {
        servo_tick: Tick::start(Block::TIMER0, SERVO_PERIOD_US),
        path_tick: Tick::start(Block::TIMER1, PATH_PERIOD_US),
        axes,
        lines,
        network,
        watchdog,
    }
}

/// The axes, on a simulated machine.
pub struct Axes {
    plant: MotionPlant,
    command: MotionCommand,
    feedback: MotionFeedback,
}

impl Axes {
    /// The machine goes on by a servo tick under the last command.
    pub fn advance(&mut self) {
        self.feedback = self.plant.advance(&self.command);
    }

    /// The inputs of a servo tick.
    pub fn read(&mut self) -> MotionFeedback {
        self.feedback
    }

    /// Sets the outputs.
    pub fn write(&mut self, command: &MotionCommand) {
        self.command = *command;
    }

    /// True position of each motor's axis (mm, rad), which a real machine does not know.
    pub fn truth(&self) -> Option<[f64; MOTORS]> {
        Some(self.plant.truth())
    }
}

/// Gates and digital outputs, which are switched at ticks and between them.
pub type ProcessLines = board_switching::ProcessLines<SysTick, Pins>;

/// A simulated machine has no wires: it takes the lines of a tick with its command.
pub struct Pins;

impl LinePort for Pins {
    fn now_us(&self) -> u64 {
        time::now_us()
    }

    fn set(&mut self, _lines: Lines) {}
}
