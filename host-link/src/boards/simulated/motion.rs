//! The motion board with its machine.

use super::KNOTS;
use plant::MotionPlant;
use shared::io::MotionCommand;
use shared::motion::{MotionController, PathTickInput, SERVO_TICKS_PER_PATH_TICK, ServoLoops, ServoReport};
use shared::protocol::{MotionTelemetry, PathState, Request, Response};

pub struct MotionBoard {
    plant: MotionPlant,
    command: MotionCommand,
    servo: Option<ServoLoops>,
    controller: Box<MotionController<KNOTS>>,
    ticks: u32,
    batch: MotionTelemetry,
    pub estop: bool,
}

impl MotionBoard {
    pub fn new() -> Self {
        Self {
            plant: MotionPlant::dual_beam_gantry(),
            command: MotionCommand::SAFE,
            servo: None,
            controller: Box::new(MotionController::new()),
            ticks: 0,
            batch: MotionTelemetry { samples: heapless::Vec::new() },
            estop: false,
        }
    }

    /// One servo tick, and the path tick where it is due; what goes to the tracker board then.
    pub fn tick(&mut self, now_us: u64) -> Option<PathState> {
        let mut feedback = self.plant.advance(&self.command);
        feedback.estop = self.estop;
        let truth = Some(self.plant.truth());
        self.command =
            self.servo.as_mut().map_or(MotionCommand::SAFE, |servo| servo.tick(&feedback, truth, 1));
        self.ticks += 1;
        self.ticks.is_multiple_of(SERVO_TICKS_PER_PATH_TICK).then(|| self.path_tick(now_us))
    }

    fn path_tick(&mut self, now_us: u64) -> PathState {
        let report = self.servo.as_mut().map_or_else(ServoReport::default, ServoLoops::take_report);
        let output = self.controller.tick(&PathTickInput { now_us, elapsed: 1, report });
        if let Some(setup) = self.controller.take_servo_setup() {
            self.servo = Some(setup);
        } else if let Some(servo) = &mut self.servo {
            servo.give(&output.order);
        }
        // A full batch was fetched at the servo tick that filled it.
        let _ = self.batch.samples.push(output.sample);
        output.path_state
    }

    /// A full batch of telemetry.
    pub fn telemetry(&mut self) -> Option<MotionTelemetry> {
        self.batch.samples.is_full().then(|| {
            std::mem::replace(&mut self.batch, MotionTelemetry { samples: heapless::Vec::new() })
        })
    }

    pub fn handle(&mut self, request: &Request) -> Response {
        self.controller.handle(request, 0)
    }
}
