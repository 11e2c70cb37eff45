//! States and faults of the tracker board.

use crate::io::SLIDE_NAMES;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// What the tracker board is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum TrackerState {
    /// Drives off.
    #[default]
    Off,
    /// Drives on, looking for reference marks.
    Homing,
    /// Drives on, slides at rest or following the plan.
    Ready,
    /// The path asks for tracking: slides follow the seam.
    Tracking,
    /// Drives off after a fault, until it is reset.
    Fault,
}

/// Why the tracker stopped, or wants the beams off; the first one since the last reset is kept.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema, Error)]
pub enum TrackerFault {
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
    #[error("the drive of slide {} reports a fault; look at the drive's own display", SLIDE_NAMES[*slide as usize])]
    Drive {
        /// Index of the slide.
        slide: u8,
    },
    /// A limit switch was pressed outside homing.
    #[error("limit switch {} of slide {} is pressed", if *positive { "+" } else { "−" }, SLIDE_NAMES[*slide as usize])]
    LimitSwitch {
        /// Index of the slide.
        slide: u8,
        /// Which end.
        positive: bool,
    },
    /// The search for a reference mark ended without one.
    #[error("no reference mark of slide {} was found", SLIDE_NAMES[*slide as usize])]
    MarkNotFound {
        /// Index of the slide.
        slide: u8,
    },
    /// A beam burns where its seam was never seen.
    #[error("beam {} is on at s = {s_mm:.1} mm, but its camera has not seen the seam yet: check camera and lights, or give the path a longer run-in", side + 1)]
    SeamNotSeen {
        /// 0 or 1.
        side: u8,
        /// Path position.
        s_mm: f32,
    },
    /// No seam was seen for longer than the map reaches.
    #[error("side {} lost the seam at s = {s_mm:.1} mm", side + 1)]
    LostSeam {
        /// 0 or 1.
        side: u8,
        /// Path position.
        s_mm: f32,
    },
    /// A spot would have been beside its seam: that jumps or bends more than the slide follows, or was not seen there.
    #[error("beam {} went off at s = {s_mm:.1} mm: the spot may be {off_mm:.2} mm beside the seam from there on by {}: the seam jumps, bends too sharply or is out of sight; look at the seam there, go slower, or see to camera and lights", slide / 2 + 1, SLIDE_NAMES[*slide as usize])]
    BesideSeam {
        /// Index of the slide.
        slide: u8,
        /// How far at most.
        off_mm: f32,
        /// Path position.
        s_mm: f32,
    },
    /// A slide could not keep up.
    #[error("slide {} was at its speed limit for {ms} ms", SLIDE_NAMES[*slide as usize])]
    Saturated {
        /// Index of the slide.
        slide: u8,
        /// How long.
        ms: u32,
    },
    /// A slide reached its soft limit while tracking.
    #[error("slide {} is at its soft limit ({position_mm:.2} mm) while tracking", SLIDE_NAMES[*slide as usize])]
    SoftLimit {
        /// Index of the slide.
        slide: u8,
        /// Where it stands.
        position_mm: f32,
    },
    /// The session of the PC ended while a path was tracked, or while homing.
    #[error("the PC's session ended while the slides moved; check the PC and its cable, then reset")]
    SessionEnded,
    /// The session of the PC ended and no other one began.
    #[error("no PC was connected for {seconds} s: the slide drives were switched off; connect, then reset")]
    Unattended {
        /// How long.
        seconds: u8,
    },
    /// Nothing was received from the motion board while tracking.
    #[error("the motion board was silent for {silent_ms} ms while tracking")]
    PathStale {
        /// How long.
        silent_ms: u32,
    },
    /// A slide did not go where its commands lead.
    #[error("slide {} is {seen_um:.0} µm away from the commanded position, the limit is {limit_um:.0}: check encoder, drive and slide, and preview_s; then reset and home", SLIDE_NAMES[*slide as usize])]
    FollowingError {
        /// Index of the slide.
        slide: u8,
        /// What was seen.
        seen_um: f32,
        /// The trip.
        limit_um: f32,
    },
    /// An encoder counted further in one tick than its slide can go.
    #[error("the encoder of slide {} jumped by {seen} counts in one tick, at most {limit} are possible: check its cable and reading head; then reset and home", SLIDE_NAMES[*slide as usize])]
    EncoderStep {
        /// Index of the slide.
        slide: u8,
        /// Counts in the tick.
        seen: i32,
        /// Largest believable step.
        limit: i32,
    },
    /// A slide moved faster than it is ever commanded to.
    #[error("slide {} went at {seen_mm_s:.0} mm/s, the limit is {limit_mm_s:.0}: check its drive and the encoder's scale; then reset and home", SLIDE_NAMES[*slide as usize])]
    Overspeed {
        /// Index of the slide.
        slide: u8,
        /// What was seen.
        seen_mm_s: f32,
        /// The trip.
        limit_mm_s: f32,
    },
    /// A slide was commanded to move, and its encoder did not change.
    #[error("slide {} was commanded to move by {commanded_um:.0} µm, but its encoder did not move: check encoder and its cable, drive and brake, and the offset of the drive; then reset and home", SLIDE_NAMES[*slide as usize])]
    NoMovement {
        /// Index of the slide.
        slide: u8,
        /// The way that was commanded meanwhile.
        commanded_um: f32,
    },
}
