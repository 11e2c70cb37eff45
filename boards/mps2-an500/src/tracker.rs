//! What a tracker board has: four slides on a simulated machine, a tick, camera strobes, a network, a watchdog.

use crate::registers::Block;
use crate::{Network, Tick, Watchdog, logger, machine, time};
use plant::SlidePlant;
use shared::io::{SLIDES, SlideCommand, SlideFeedback};

/// IPv4 address of the board.
pub const ADDRESS: [u8; 4] = [10, 0, 2, 15];
/// Length of the net's prefix.
pub const PREFIX: u8 = 24;
/// Gateway; behind it stand the PC and the motion board.
pub const GATEWAY: [u8; 4] = [10, 0, 2, 2];

/// Period of the control tick \[µs\].
const CONTROL_PERIOD_US: u32 = 1000;

/// The board's parts.
pub struct Board {
    /// Control tick, 1 kHz.
    pub tick: Tick,
    /// Slides and camera strobes.
    pub slides: Slides,
    /// Ethernet port.
    pub network: Network,
    /// Watchdog.
    pub watchdog: Watchdog,
}

/// Sets the board up. The timer runs when it returns.
pub fn init(mut core: cortex_m::Peripherals) -> Board {
    board_faults::guard_stack(&mut core);
    time::start();
    logger::start();
    let slides = Slides {
        plant: SlidePlant::new(&machine::wired()),
        command: SlideCommand::SAFE,
    };
    let network = Network::start();
    let watchdog = Watchdog::new(&mut core.NVIC);
    Board {
        tick: Tick::start(Block::TIMER0, CONTROL_PERIOD_US),
        slides,
        network,
        watchdog,
    }
}

/// The slides, on a simulated machine.
pub struct Slides {
    plant: SlidePlant,
    command: SlideCommand,
}

impl Slides {
    /// Latches the inputs of a control tick; the slides advance by that tick under the last command.
    pub fn read(&mut self) -> SlideFeedback {
        self.plant.advance(&self.command)
    }

    /// Sets the outputs.
    pub fn write(&mut self, command: &SlideCommand) {
        self.command = *command;
    }

    /// True position of each slide \[mm\], which a real machine does not know.
    pub fn truth(&self) -> Option<[f64; SLIDES]> {
        Some(self.plant.truth())
    }

    /// Triggers both cameras: lights the board's lamp. The PC looks at the simulated world instead, at the time
    /// of the capture.
    pub fn strobe(&mut self) {
        let lamp = Block::FPGA_IO;
        lamp.write(0, !lamp.read(0));
    }
}
