//! The tracker board with its slides.

use super::KNOTS;
use plant::SlidePlant;
use shared::io::SlideCommand;
use shared::protocol::{Capture, ClockRequest, TrackerTelemetry};
use shared::tracking::{TickInput, TrackerController};

pub struct TrackerBoard {
    plant: SlidePlant,
    command: SlideCommand,
    pub controller: Box<TrackerController<KNOTS>>,
    batch: TrackerTelemetry,
    pub estop: bool,
}

impl TrackerBoard {
    pub fn new() -> Self {
        Self {
            plant: SlidePlant::dual_beam_tracker(),
            command: SlideCommand::SAFE,
            controller: Box::new(TrackerController::new()),
            batch: TrackerTelemetry {
                samples: heapless::Vec::new(),
            },
            estop: false,
        }
    }

    /// One control tick at `now_us` of the board's clock; the capture and the clock request to send.
    pub fn tick(&mut self, now_us: u64) -> (Option<Capture>, Option<ClockRequest>) {
        let mut feedback = self.plant.advance(&self.command);
        feedback.estop = self.estop;
        let truth = Some(self.plant.truth());
        let output = self.controller.tick(&TickInput {
            now_us,
            periods: 1,
            feedback,
            truth,
        });
        self.command = output.command;
        // A full batch was fetched at the control tick that filled it.
        let _ = self.batch.samples.push(output.sample);
        (output.capture, output.clock_request)
    }

    /// A full batch of telemetry.
    pub fn telemetry(&mut self) -> Option<TrackerTelemetry> {
        self.batch.samples.is_full().then(|| {
            std::mem::replace(
                &mut self.batch,
                TrackerTelemetry {
                    samples: heapless::Vec::new(),
                },
            )
        })
    }
}
