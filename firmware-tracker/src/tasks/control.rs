//! The control tick: latch the slides, trigger the cameras, run the controller, write the drives.

use super::{Controller, Published};
use crate::board::{self, tracker::Slides};
use shared::tracking::TickInput;

/// One control tick, whose period began at `began_us`, `periods` after the last.
pub fn tick(controller: &mut Controller, slides: &mut Slides, began_us: u64, periods: u32) -> Published {
    let strobes = controller.strobe(periods);
    let feedback = slides.read();
    let strobed_us = strobes.then(|| {
        slides.strobe();
        board::now_us()
    });
    let input = TickInput {
        now_us: began_us,
        periods,
        strobed_us,
        feedback,
        truth: slides.truth(),
    };
    let output = controller.tick(&input);
    slides.write(&output.command);
    Published {
        sample: output.sample,
        capture: output.capture,
        permit: output.permit,
        clock_request: output.clock_request,
    }
}
