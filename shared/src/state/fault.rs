//! Why the motion board stopped, with the evidence.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::io::{AXIS_NAMES, MOTOR_NAMES, SIDES};
use core::fmt::{self, Display, Formatter};

/// A reason to stop; the first one since the last reset is kept. Small and `Copy`; reads as a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema, Error)]
pub enum Fault {
    /// The emergency stop is pressed.
    #[error("emergency stop is pressed; release it, then reset")]
    EmergencyStop,
    /// One channel of the emergency stop was open for long while the other one stayed closed.
    #[error("emergency-stop channel {} stayed closed while channel {} was open: the wire of the open one is broken, or the contact of the other one welded or bridged; repair it, press the button fully, release it, then reset", closed + 1, 2 - closed)]
    EmergencyStopChannels {
        /// The channel that stayed closed, 0 or 1.
        closed: u8,
    },
    /// A drive reports a fault.
    #[error("the drive of {} reports a fault; look at the drive's own display", MOTOR_NAMES[*motor as usize])]
    Drive {
        /// Index of the motor.
        motor: u8,
    },
    /// A laser source reports a fault.
    #[error("laser {} reports a fault; look at the source's own display", side + 1)]
    Laser {
        /// 0 or 1.
        side: u8,
    },
    /// The power of a beam that is on is not the commanded one.
    #[error("beam {} gives {measured_w:.0} W, and {commanded_w:.0} W are commanded: check the source, its interlock, and the lines of gate, power and readback", side + 1)]
    BeamPower {
        /// 0 or 1.
        side: u8,
        /// What was commanded.
        commanded_w: f32,
        /// What was measured.
        measured_w: f32,
    },
    /// A beam gives power with its gate closed.
    #[error("beam {} gives {measured_w:.0} W with its gate closed: open its interlock, then check the source and the lines of gate and readback", side + 1)]
    BeamNotOff {
        /// 0 or 1.
        side: u8,
        /// What was measured.
        measured_w: f32,
    },
    /// The power of a beam is not measured any more.
    #[error("the power of beam {} is not measured any more: check its readback and the converter", side + 1)]
    BeamPowerUnknown {
        /// 0 or 1.
        side: u8,
    },
    /// |reference − position| above the trip (µm or millidegrees).
    #[error("following error of {} is {seen_um:.0} µm (or m°), the limit there {limit_um:.0}: check for a blocked axis, gains and drive scaling", MOTOR_NAMES[*motor as usize])]
    FollowingError {
        /// Index of the motor.
        motor: u8,
        /// What was seen.
        seen_um: f32,
        /// The trip at that speed.
        limit_um: f32,
    },
    /// The following error swings by more than the vibration trip (root mean square, µm or millidegrees).
    #[error("{} vibrates by {seen_um:.1} µm (or m°) rms, the limit is {limit_um:.1}: look for a loose coupling or screw; if its loop hunts, commission it anew or lower kp", MOTOR_NAMES[*motor as usize])]
    Vibration {
        /// Index of the motor.
        motor: u8,
        /// What was seen.
        seen_um: f32,
        /// The trip.
        limit_um: f32,
    },
    /// A grating moved further in one tick than the axis can.
    #[error("the grating of {} jumped by {seen} counts in one tick, at most {limit} are possible: check its cable and reading head", MOTOR_NAMES[*motor as usize])]
    EncoderStep {
        /// Index of the motor.
        motor: u8,
        /// Counts in the tick.
        seen: i32,
        /// Largest believable step.
        limit: i32,
    },
    /// X1 − X2 left its square position.
    #[error(
        "the gantry is out of square by {seen_um:.0} µm, the limit is {limit_um:.0}: both X drives are off; square it before the next motion"
    )]
    GantrySkew {
        /// What was seen.
        seen_um: f32,
        /// The trip.
        limit_um: f32,
    },
    /// A limit switch was pressed outside homing.
    #[error("limit switch {} of {} is pressed; reset and home: the search leads away from it", if *positive { "+" } else { "−" }, MOTOR_NAMES[*motor as usize])]
    LimitSwitch {
        /// Index of the motor.
        motor: u8,
        /// Which end.
        positive: bool,
    },
    /// The search for a reference mark ended without one.
    #[error("no reference mark of {} was found; check the reading head and the search distance", MOTOR_NAMES[*motor as usize])]
    MarkNotFound {
        /// Index of the motor.
        motor: u8,
    },
    /// The path asks an axis for a place beyond its travel.
    #[error("the path leaves the travel of {} ({position:.3})", AXIS_NAMES[*axis as usize])]
    SoftLimit {
        /// Index of the axis.
        axis: u8,
        /// Where it would have gone (mm or degrees).
        position: f32,
    },
    /// The path has no inverse kinematics or is not finite there.
    #[error(
        "line {line}: the machine cannot follow the path to s = {s_mm:.3} mm: no solution of the kinematics there"
    )]
    NoSolution {
        /// Line of the program.
        line: u32,
        /// Path position.
        s_mm: f32,
    },
    /// The path asks an axis for more in a millisecond than twice its speed.
    #[error(
        "the path requires {} to jump by {distance:.3} mm (or °) at s = {s_mm:.3} mm; keep it away from poles and half turns",
        AXIS_NAMES[*axis as usize]
    )]
    Jump {
        /// Index of the axis.
        axis: u8,
        /// How far within a millisecond (mm or degrees).
        distance: f32,
        /// Path position.
        s_mm: f32,
    },
    /// Nothing was received from the PC while a path was running, or while homing.
    #[error(
        "the PC was silent for {silent_ms} ms while the machine moved, so it was stopped; check the connection, then reset"
    )]
    LinkLost {
        /// How long.
        silent_ms: u32,
    },
    /// The session of the PC ended while a path was running, or while homing.
    #[error(
        "the PC's session ended while the machine moved, so it was stopped; check the PC and its cable, then reset"
    )]
    SessionEnded,
    /// The session of the PC ended and no other one began.
    #[error("no PC was connected for {seconds} s: the drives were switched off; connect, then reset")]
    Unattended {
        /// How long.
        seconds: u8,
    },
    /// A beam should go on where the tracker does not let it.
    #[error(
        "beam {} was to be switched on at s = {s_mm:.1} mm, but {why}: check camera and lights, or give the path a longer run-in", side + 1
    )]
    NotLocked {
        /// 0 or 1.
        side: u8,
        /// Path position.
        s_mm: f32,
        /// What was missing.
        why: NoPermit,
    },
    /// The tracker withdrew the permit of a beam that was on, or nothing was received from it any more.
    #[error("beam {} was switched off at s = {s_mm:.1} mm and the machine stopped, because {why}", side + 1)]
    PermitLost {
        /// 0 or 1.
        side: u8,
        /// Path position.
        s_mm: f32,
        /// What was missing.
        why: NoPermit,
    },
    /// An input of the process was off while the line that it answers was on.
    #[error(
        "input {} did not come within {within_ms} ms while {} was on, and the machine stopped: look at what it reports, and its cable",
        input + 1, LineName(*line)
    )]
    NoAnswer {
        /// Index of the input.
        input: u8,
        /// The line.
        line: u8,
        /// How long it may be missing.
        within_ms: u32,
    },
    /// A control law got a value that is not a number.
    #[error("a control law got a value that is not a number; check the machine parameters")]
    NotANumber,
    /// The path task did not deliver references in time, twice in a row or three times within 100 ms.
    #[error(
        "the path task was late twice in a row, or three times within 100 ms; the servo loops had no references"
    )]
    ReferencesLate,
    /// A motor was commanded to move, and its grating did not change.
    #[error("the drive of {} was commanded to move by {commanded_um:.0} µm (or m°), but its grating did not move: check grating and its cable, drive and brake, and the offset of the drive", MOTOR_NAMES[*motor as usize])]
    NoMovement {
        /// Index of the motor.
        motor: u8,
        /// The way that was commanded meanwhile (µm or millidegrees).
        commanded_um: f32,
    },
    /// A stop on the path took longer than any can.
    #[error(
        "the machine was not at rest {limit_ms} ms after the stop command: the drives were switched off; please report it"
    )]
    StopTooLong {
        /// How long it may have taken.
        limit_ms: u32,
    },
    /// An axis is further beyond its travel than a stop on the path takes it.
    #[error("{} is at {position:.3}, beyond its travel and its stopping distance; check its drive and its grating", AXIS_NAMES[*axis as usize])]
    BeyondTravel {
        /// Index of the axis.
        axis: u8,
        /// Where it is (mm or degrees).
        position: f32,
    },
}

/// A line as messages call it.
struct LineName(u8);

impl Display for LineName {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match usize::from(self.0) {
            beam @ ..SIDES => write!(f, "beam {}", beam + 1),
            line => write!(f, "output {}", line + 1 - SIDES),
        }
    }
}

/// Why a beam may not burn where the path tracks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema, Error)]
pub enum NoPermit {
    /// No permit came in time.
    #[error("nothing is received from the tracker board")]
    Silent,
    /// The tracker refuses.
    #[error("the tracker board does not permit it")]
    Refused,
    /// The seam is followed, but the spot is not on it.
    #[error("its slides are not on the seam yet")]
    NotOnSeam,
    /// Permits come, but what they answer is too old.
    #[error(
        "the tracker board answers only where the machine was before: what it is told now is lost, late, or jumps \
         faster than its slides can go, as with axes that swing"
    )]
    Outdated,
}
