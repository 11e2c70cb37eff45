//! The tracker board with its slides.

use super::KNOTS;
use plant::SlidePlant;
use shared::io::{ESTOP_CHANNELS, SlideCommand, SlideFeedback};
use shared::protocol::{Batch, Capture, TrackerSample, TrackerTelemetry};
use shared::tracking::{TickInput, TickOutput, TrackerController};

#[derive(Clone)]
pub struct TrackerBoard {
    pub plant: SlidePlant,
    pub command: SlideCommand,
    pub controller: Box<TrackerController<KNOTS>>,
    batch: Batch<TrackerSample>,
    telemetry: Option<TrackerTelemetry>,
    /// Of the last control tick.
    pub published: Option<(Option<Capture>, TrackerSample)>,
    /// Channels of the emergency stop that are open.
    pub estop: [bool; ESTOP_CHANNELS],
    /// What its inputs read otherwise than its machine is.
    pub changed_inputs: Option<fn(&mut SlideFeedback)>,
    /// Its processor stands still.
    pub frozen: bool,
}

impl TrackerBoard {
    pub fn new(plant: SlidePlant) -> Self {
        Self {
            plant,
            command: SlideCommand::SAFE,
            controller: Box::new(TrackerController::new()),
            batch: Batch::default(),
            telemetry: None,
            published: None,
            estop: [false; ESTOP_CHANNELS],
            changed_inputs: None,
            frozen: false,
        }
    }

    /// One control tick at `now_us` of the board's clock; what there is to send.
    pub fn tick(&mut self, now_us: u64) -> TickOutput {
        let strobes = self.controller.strobe(1);
        let mut feedback = self.plant.advance(&self.command);
        feedback.estop = self.estop;
        if let Some(change) = self.changed_inputs {
            change(&mut feedback);
        }
        let truth = Some(self.plant.truth());
        let output = self.controller.tick(&TickInput {
            now_us,
            periods: 1,
            strobed_us: strobes.then_some(now_us),
            feedback,
            truth,
        });
        self.command = output.command;
        self.published = Some((output.capture, output.sample));
        let full = self.batch.push(output.sample);
        self.telemetry = full.map(|samples| TrackerTelemetry { samples });
        output
    }

    /// Telemetry to send since the last call.
    pub fn telemetry(&mut self) -> Option<TrackerTelemetry> {
        self.telemetry.take()
    }
}
