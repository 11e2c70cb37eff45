//! The path tick: from what the servo ticks saw to the references of the next millisecond.

use super::{Controller, Outbox, PATH_TASK, Servo};
use crate::board;
use rtic::Mutex;
use shared::motion::PathTickInput;
use shared::protocol::BoardLoad;

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

    /// One path tick, whose period began at `began_us`, `elapsed` after the last; false if the network does not keep up and what it publishes is dropped.
    pub fn tick(
        &mut self,
        servo: &mut impl Mutex<T = Servo>,
        controller: &mut impl Mutex<T = &'static mut Controller>,
        began_us: u64,
        elapsed: u32,
    ) -> bool {
        let (span, servo_tick) = servo.lock(|servo| {
            servo.alive.seen(PATH_TASK);
            (servo.time.span(board::cycles()), servo.time.take_longest())
        });
        // What is large is made where it stays: moving it costs as much as using it.
        let input = servo.lock(|servo| PathTickInput {
            now_us: began_us,
            elapsed,
            report: servo.loops.take_report(),
        });
        let mut output = controller.lock(|controller| controller.tick(&input));
        if let Some(setup) = controller.lock(|controller| controller.take_servo_setup()) {
            servo.lock(|servo| servo.loops.configure(setup));
        }
        servo.lock(|servo| servo.loops.give(&output.order));
        output.sample.load = Some(BoardLoad {
            cycles_per_us: board::CYCLES_PER_US,
            path_tick: self.took,
            servo_tick,
        });
        let published = self.outbox.enqueue((output.path_state, output.sample)).is_ok();
        self.took = servo.lock(|servo| servo.time.without(span, board::cycles()));
        published
    }
}
