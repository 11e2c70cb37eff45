//! What a tracker board has: four slides with encoders, two cameras, a tick, a network, a watchdog.

use crate::encoders::{self, Encoder};
use crate::inputs::{self, Snapshot};
use crate::outputs::{Outputs, output, switch};
use crate::pins::{CAMERA_TRIGGERS, PERMITS, Pin, TRACKER, mask};
use crate::{Network, Tick, Watchdog, bring_up};
use embassy_stm32::pac;
use shared::io::{Bits, SLIDES, SlideCommand, SlideFeedback};

/// IPv4 address of the board.
pub const ADDRESS: [u8; 4] = [192, 168, 71, 12];
/// Length of the net's prefix.
pub const PREFIX: u8 = 24;
/// Gateway: the PC.
pub const GATEWAY: [u8; 4] = [192, 168, 71, 1];

/// Period of the control tick \[µs\].
const CONTROL_PERIOD_US: u32 = 1000;

/// Control ticks from one reading back of a converter's output to the next: a millisecond.
const READ_BACK_EVERY: u32 = 1;

/// One converter, a channel for each slide.
const CHIPS: usize = 1;
/// Enable lines.
const ENABLES: u16 = mask(&TRACKER.enable);
/// A bit for every drive.
const ALL_DRIVES: u8 = (1 << SLIDES) - 1;

/// The board's parts.
pub struct Board {
    /// Control tick, 1 kHz.
    pub tick: Tick,
    /// Slides and cameras.
    pub slides: Slides,
    /// Ethernet port.
    pub network: Network,
    /// Watchdog.
    pub watchdog: Watchdog,
}

/// Sets the board up, outputs off. The timer runs when it returns.
pub fn init(core: cortex_m::Peripherals) -> Board {
    let (watchdog, bus, parts, _) = bring_up::start(core);
    inputs::start(&TRACKER, &[]);
    let [camera_1, camera_2] = CAMERA_TRIGGERS;
    let [u1, v1, u2, v2] = TRACKER.enable;
    let [permit_1, permit_2] = PERMITS;
    let switched: [Pin; 8] = [u1, v1, u2, v2, camera_1, camera_2, permit_1, permit_2];
    let slides = Slides {
        outputs: Outputs::start(bus, &switched, READ_BACK_EVERY),
        encoders: core::array::from_fn(|slide| Encoder::start(&TRACKER.encoders[slide])),
    };
    let network = Network::start(parts);
    let [tick] = Tick::start([(pac::TIM6, CONTROL_PERIOD_US)]);
    Board {
        tick,
        slides,
        network,
        watchdog,
    }
}

/// The slides and their cameras.
pub struct Slides {
    outputs: Outputs<CHIPS>,
    encoders: [Encoder; SLIDES],
}

impl Slides {
    /// Latches the inputs of a control tick, and ends the trigger pulse of the last one. Once a converter has
    /// failed, every drive reports a fault.
    pub fn read(&mut self) -> SlideFeedback {
        let mut feedback = SlideFeedback::default();
        encoders::fill(&mut self.encoders, &mut feedback);
        switch(mask(&CAMERA_TRIGGERS), false);
        Snapshot::take().fill(&TRACKER, &mut feedback);
        feedback.converter_failed = self.outputs.failed();
        if feedback.converter_failed {
            feedback.drive_fault = Bits(ALL_DRIVES);
        }
        feedback
    }

    /// Sets the outputs: what goes off goes off first, then all slides step together, then the rest goes on.
    pub fn write(&mut self, command: &SlideCommand) {
        let mut on = if command.enable { ENABLES } else { 0 };
        for (line, permitted) in PERMITS.iter().zip(command.beam_gate) {
            if permitted {
                on |= mask(&[*line]);
            }
        }
        let mut codes = [(output(0), 0); SLIDES];
        for (slide, code) in command.dac.iter().enumerate() {
            codes[slide] = (output(slide), code.0);
        }
        self.outputs.apply(ENABLES | mask(&PERMITS), on, &codes);
    }

    /// Triggers both cameras: the rising edge exposes; the pulse lasts to the next tick.
    pub fn strobe(&mut self) {
        switch(mask(&CAMERA_TRIGGERS), true);
    }

    /// True positions: a real machine does not know them.
    pub fn truth(&self) -> Option<[f64; SLIDES]> {
        None
    }
}
