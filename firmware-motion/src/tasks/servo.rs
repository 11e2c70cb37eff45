//! The servo tick: read the gratings, run the loops, write the drives.

use super::RollCall;
use crate::board::motion::Axes;
use shared::motion::ServoLoops;

/// The servo loops, and who else is alive.
pub struct Servo {
    /// Drives off until parameters were accepted.
    pub loops: ServoLoops,
    /// Decides about the watchdog.
    pub alive: RollCall,
}

impl Servo {
    /// Without parameters.
    pub fn new(alive: RollCall) -> Self {
        Self {
            loops: ServoLoops::default(),
            alive,
        }
    }
}

/// One servo tick.
pub fn tick(servo: &mut Servo, axes: &mut Axes, elapsed: u32) {
    let feedback = axes.read();
    let truth = axes.truth();
    let command = servo.loops.tick(&feedback, truth, elapsed);
    axes.write(&command);
    servo.alive.servo_ticked();
}
