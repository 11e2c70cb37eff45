//! The path tick: from what the servo ticks saw to the references of the next millisecond.

use super::{Controller, Outbox, PATH_TASK, Servo, Times};
use crate::board;
use rtic::Mutex;
use shared::motion::PathTickInput;
use shared::protocol::BoardLoad;

/// What becomes of a path tick.
pub struct Told {
    /// What it publishes is on its way; else the network does not keep up, and it is dropped.
    pub published: bool,
    /// A turn of planning is due.
    pub plans: bool,
}

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

    /// One path tick, whose period began at `began_us`, `elapsed` after the last.
    pub fn tick(
        &mut self,
        servo: &mut impl Mutex<T = Servo>,
        controller: &mut impl Mutex<T = &'static mut Controller>,
        times: &mut impl Mutex<T = Times>,
        began_us: u64,
        elapsed: u32,
    ) -> Told {
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
        let (plans, planning_missed) =
            controller.lock(|controller| (controller.plans(), controller.missed_turns()));
        let planning = times.lock(|times| times.planning.take_longest());
        output.sample.load = Some(BoardLoad {
            cycles_per_us: board::CYCLES_PER_US,
            path_tick: self.took,
            servo_tick,
            planning,
            planning_missed,
        });
        let published = self.outbox.enqueue((output.path_state, output.sample)).is_ok();
        self.took = servo.lock(|servo| servo.time.without(span, board::cycles()));
        times.lock(|times| times.path.add_net(self.took));
        Told { published, plans }
    }
}
