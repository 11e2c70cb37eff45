//! The control tick: latch the slides, run the controller, write the drives, trigger the cameras.

use super::{Controller, Published};
use crate::board::{self, tracker::Slides};
use shared::tracking::TickInput;

/// One control tick, `periods` after the last.
pub fn tick(controller: &mut Controller, slides: &mut Slides, periods: u32) -> Published {
    let input = TickInput {
        now_us: board::now_us(),
        periods,
        feedback: slides.read(),
        truth: slides.truth(),
    };
    let output = controller.tick(&input);
    if output.capture.is_some() {
        slides.strobe();
    }
    slides.write(&output.command);
    Published {
        sample: output.sample,
        capture: output.capture,
        permit: output.permit,
        clock_request: output.clock_request,
    }
}
