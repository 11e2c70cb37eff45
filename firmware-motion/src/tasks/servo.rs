//! The servo tick: read the gratings, run the loops, write the drives.

use super::RollCall;
use crate::board::motion::Axes;
use shared::io::MotionCommand;
use shared::motion::ServoLoops;

/// The servo loops, once the machine's parameters are known, and who else is alive.
pub struct Servo {
    /// `None` until parameters were accepted: drives off.
    pub loops: Option<ServoLoops>,
    /// Servo ticks since boot.
    pub ticks: u32,
    /// Decides about the watchdog.
    pub alive: RollCall,
}

impl Servo {
    /// Without parameters.
    pub fn new(alive: RollCall) -> Self {
        Self {
            loops: None,
            ticks: 0,
            alive,
        }
    }
}

/// One servo tick.
pub fn tick(servo: &mut Servo, axes: &mut Axes, elapsed: u32) {
    servo.ticks = servo.ticks.wrapping_add(elapsed);
    let feedback = axes.read();
    let truth = axes.truth();
    let command = match &mut servo.loops {
        Some(loops) => loops.tick(&feedback, truth, elapsed),
        None => MotionCommand::SAFE,
    };
    axes.write(&command);
    servo.alive.servo_ticked();
}
