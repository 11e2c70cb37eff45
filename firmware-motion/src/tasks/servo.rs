//! The servo tick: read the gratings, run the loops, write the drives; feed the watchdog if all others live.

use super::ALIVE_SUPERVISION;
use crate::board::{
    self, Watchdog,
    motion::{Axes, ProcessLines},
};
use rtic::Mutex;
use shared::alive_supervision::AliveSupervision;
use shared::execution_time::ExecutionTime;
use shared::motion::ServoLoops;

/// The servo loops, and who else is alive.
pub struct Servo {
    /// Drives off until parameters were accepted.
    pub loops: ServoLoops,
    /// Decides about the watchdog.
    pub alive: AliveSupervision<2>,
    /// What the servo ticks take, on an emulated board without its machine.
    pub time: ExecutionTime,
}

impl Servo {
    /// Without parameters.
    pub fn new() -> Self {
        Self {
            loops: ServoLoops::default(),
            alive: ALIVE_SUPERVISION,
            time: ExecutionTime::new(),
        }
    }
}

/// One servo tick, whose period began at `began_us`, `elapsed` after the last.
pub fn tick(
    servo: &mut Servo,
    axes: &mut Axes,
    lines: &mut impl Mutex<T = ProcessLines>,
    watchdog: &mut Watchdog,
    (began_us, elapsed): (u64, u32),
) {
    let begin = board::cycles();
    axes.advance();
    let own = board::cycles();
    let mut feedback = axes.read();
    lines.lock(|lines| lines.read(&mut feedback));
    let truth = axes.truth();
    let command = servo.loops.tick(&feedback, truth, elapsed);
    axes.write(&command);
    lines.lock(|lines| lines.write(&command, began_us));
    if servo.alive.tick() {
        watchdog.feed();
    }
    servo.time.add(begin, own, board::cycles());
}
