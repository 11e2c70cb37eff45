//! The path tick: from what the servo ticks saw to the references of the next millisecond.

use super::{Controller, Outbox, PATH_TASK, Servo};
use crate::board;
use rtic::Mutex;
use shared::motion::PathTickInput;

/// One path tick; false if the network does not keep up and what it publishes is dropped.
pub fn tick(
    servo: &mut impl Mutex<T = Servo>,
    controller: &mut impl Mutex<T = &'static mut Controller>,
    outbox: &mut Outbox,
    elapsed: u32,
) -> bool {
    let report = servo.lock(|servo| {
        servo.alive.seen(PATH_TASK);
        servo.loops.take_report()
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
    outbox.enqueue((output.path_state, output.sample)).is_ok()
}
