//! The path tick: from what the servo ticks saw to the references of the next millisecond.

use super::{Controller, Outbox, PATH_TASK, Servo};
use crate::board;
use rtic::Mutex;
use shared::motion::PathTickInput;
use shared::protocol::{BoardLoad, MotionSample};

/// What the path tick owns.
pub struct PathTask {
    outbox: Outbox,
    /// Cycles of the last tick.
    took: u32,
}

impl PathTask {
    /// Publishes into `outbox`.
    pub fn new(outbox: Outbox) -> Self {
        Self { outbox, took: 0 }
    }

    /// One path tick; false if the network does not keep up and what it publishes is dropped.
    pub fn tick(
        &mut self,
        servo: &mut impl Mutex<T = Servo>,
        controller: &mut impl Mutex<T = &'static mut Controller>,
        elapsed: u32,
    ) -> bool {
        let (span, servo_tick, report) = servo.lock(|servo| {
            servo.alive.seen(PATH_TASK);
            let span = servo.time.span(board::cycles());
            (span, servo.time.take_longest(), servo.loops.take_report())
        });
        let input = PathTickInput {
            now_us: board::now_us(),
            elapsed,
            report,
        };
        let (output, setup) =
            controller.lock(|controller| (controller.tick(&input), controller.take_servo_setup()));
        servo.lock(|servo| {
            if let Some(setup) = setup {
                servo.loops.configure(setup);
            }
            servo.loops.give(&output.order);
        });
        let load = BoardLoad {
            cycles_per_us: board::CYCLES_PER_US,
            path_tick: self.took,
            servo_tick,
        };
        let sample = MotionSample {
            load: Some(load),
            ..output.sample
        };
        let published = self.outbox.enqueue((output.path_state, sample)).is_ok();
        self.took = servo.lock(|servo| servo.time.without(span, board::cycles()));
        published
    }
}
