//! The motion board with its machine.

use plant::MotionPlant;
use shared::io::{ESTOP_CHANNELS, HeldLines, MotionCommand, MotionFeedback};
use shared::motion::{MotionController, PathTickInput, ServoLoops};
use shared::protocol::{Batch, Datagram, MotionSample, MotionTelemetry, PathState, Request, Response};
use shared::ticks::SERVO_TICKS_PER_PATH_TICK;
use shared::trajectory::BoardPlanning;

#[derive(Clone)]
pub struct MotionBoard {
    pub plant: MotionPlant,
    pub command: MotionCommand,
    /// Gates and digital outputs, switched without delay.
    lines: HeldLines,
    servo: ServoLoops,
    pub controller: Box<MotionController>,
    planning: Box<BoardPlanning>,
    ticks: u32,
    batch: Batch<MotionSample>,
    telemetry: Option<MotionTelemetry>,
    /// Of the last path tick.
    pub published: Option<(PathState, MotionSample)>,
    /// Channels of the emergency stop that are open.
    pub estop: [bool; ESTOP_CHANNELS],
    /// What its inputs read otherwise than its machine is.
    pub changed_inputs: Option<fn(&mut MotionFeedback)>,
}

impl MotionBoard {
    pub fn new(plant: MotionPlant) -> Self {
        Self {
            plant,
            command: MotionCommand::SAFE,
            lines: HeldLines::NONE,
            servo: ServoLoops::default(),
            controller: Box::new(MotionController::new()),
            planning: Box::new(BoardPlanning::new()),
            ticks: 0,
            batch: Batch::default(),
            telemetry: None,
            published: None,
            estop: [false; ESTOP_CHANNELS],
            changed_inputs: None,
        }
    }

    /// One servo tick, and the path tick where it is due; what goes to the tracker board then.
    pub fn tick(&mut self, now_us: u64) -> Option<PathState> {
        let mut feedback = self.plant.advance(&self.command);
        feedback.estop = self.estop;
        feedback.switched = self.lines.take();
        if let Some(change) = self.changed_inputs {
            change(&mut feedback);
        }
        let truth = Some(self.plant.truth());
        self.command = self.servo.tick(&feedback, truth, 1);
        self.lines.set(self.command.lines(), 0);
        for change in self.command.changes.iter() {
            self.lines.set(change.lines, change.after_us);
        }
        self.ticks += 1;
        self.ticks
            .is_multiple_of(SERVO_TICKS_PER_PATH_TICK)
            .then(|| self.path_tick(now_us))
    }

    fn path_tick(&mut self, now_us: u64) -> PathState {
        let output = self.controller.tick(&PathTickInput {
            now_us,
            elapsed: 1,
            report: self.servo.take_report(),
        });
        if let Some(setup) = self.controller.take_servo_setup() {
            self.servo.configure(setup);
        }
        self.servo.give(&output.order);
        self.controller.plan(&mut self.planning);
        self.published = Some((output.path_state, output.sample));
        let full = self.batch.push(output.sample);
        self.telemetry = full.map(|samples| MotionTelemetry { samples });
        output.path_state
    }

    /// Telemetry to send since the last call.
    pub fn telemetry(&mut self) -> Option<MotionTelemetry> {
        self.telemetry.take()
    }

    pub fn handle(&mut self, request: &Request) -> Response {
        self.controller.handle(request, 0)
    }

    /// A datagram of the tracker board that arrived at `arrived_us`.
    pub fn datagram(&mut self, datagram: &Datagram, arrived_us: u64) {
        if let Some(lease) = self.controller.datagram(datagram, arrived_us) {
            self.servo.renew(lease);
        }
    }
}

#[cfg(test)]
mod tests;
