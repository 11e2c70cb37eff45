//! What a slide must not do without its drive being switched off.
//!
//! Slides are driven by velocity commands alone: there is no reference that a position could lag behind. Their
//! following error is taken between two ways, that which the commands lead and that which the encoder counted. The
//! first is the commanded velocity behind a lag of `preview_s`, which is what drive and dead time make of it. Both
//! are forgotten within ten times that, so that a scale of the drive that is some percent off adds up to nothing:
//! at speed v a drive that is wrong by the part g shows g·v·10·`preview_s`.

use crate::control::{MovementCheck, MovementState};
use crate::parameter::{ParameterError, check};
use crate::state::TrackerFault;
use crate::ticks::TRACKER_PERIOD_S;

/// Ways are forgotten within this many times the lag of the drive.
const MEMORY: f64 = 10.0;
/// An encoder may count this much further in a tick than its slide may go.
const STEP_MARGIN: f64 = 1.5;
/// A slide may overshoot its largest command by this factor.
const SPEED_MARGIN: f64 = 1.2;
/// Time over which the speed is taken \[s\].
const SPEED_TIME: f64 = 2e-3;
/// A following error of more than this part of the travel would protect nothing.
const MOST_OF_TRAVEL: f64 = 0.1;

/// Trips of one slide, ready for the tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supervision {
    slide: u8,
    /// Way of one count \[mm\], signed.
    pitch: f64,
    /// What the model's velocity takes of a command in a tick.
    lag: f64,
    /// What is left of the following error after a tick.
    fade: f64,
    following_error: f64,
    /// Largest believable step \[counts\].
    step: i32,
    /// Largest believable speed \[mm/s\].
    speed: f64,
    movement: MovementCheck,
}

/// What [`Supervision::build`] needs to know of a slide, checked already.
#[derive(Clone, Copy, Debug)]
pub struct SupervisedSlide {
    /// Index of the slide.
    pub slide: u8,
    /// Encoder counts in one mm, signed.
    pub counts_per_mm: f64,
    /// Speed at 10 V \[mm/s\], signed.
    pub full_scale: f64,
    /// Largest command \[mm/s\].
    pub max_velocity: f64,
    /// From one soft limit to the other \[mm\].
    pub travel: f64,
    /// Lag and dead time of the drive \[s\].
    pub preview: f64,
}

impl Supervision {
    /// Trips of the slide `of` with the name `owner` at a following error of `following_error_mm`.
    ///
    /// That must be more than the model may be wrong by: a turn round at full speed behind a dead time of `preview_s`
    /// is 2·v·`preview_s`/e away from the same behind a lag. And no more than a tenth of the travel.
    pub fn build(owner: &str, of: &SupervisedSlide, following_error_mm: f64) -> Result<Self, ParameterError> {
        let least = 2.0 * of.max_velocity * of.preview / core::f64::consts::E;
        let most = MOST_OF_TRAVEL * of.travel;
        let following_error = check(owner, "following_error_mm", following_error_mm, |v| {
            v >= least && v <= most
        })?;
        let step =
            libm::ceil(libm::fabs(of.counts_per_mm) * of.max_velocity * TRACKER_PERIOD_S * STEP_MARGIN);
        Ok(Self {
            slide: of.slide,
            pitch: 1.0 / of.counts_per_mm,
            lag: 1.0 - libm::exp(-TRACKER_PERIOD_S / of.preview),
            fade: libm::exp(-TRACKER_PERIOD_S / (MEMORY * of.preview)),
            following_error,
            step: step as i32,
            speed: SPEED_MARGIN * of.max_velocity,
            movement: MovementCheck::new(of.full_scale, following_error),
        })
    }
}

/// Position and command of a slide.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlideWatch {
    counts: i64,
    /// Command to the drive at the last tick \[mm/s\].
    command: f64,
    /// What the drive makes of its commands \[mm/s\].
    expected: f64,
    /// Way of the commands minus way of the encoder, fading \[mm\].
    error: f64,
    /// Measured \[mm/s\].
    speed: f64,
    movement: MovementState,
}

impl SlideWatch {
    /// At rest.
    pub const fn new() -> Self {
        Self {
            counts: 0,
            command: 0.0,
            expected: 0.0,
            error: 0.0,
            speed: 0.0,
            movement: MovementState::new(),
        }
    }

    /// The drive is off and the encoder at `counts`.
    pub fn rest(&mut self, counts: i64) {
        *self = Self {
            counts,
            ..Self::new()
        };
    }

    /// The drive gets the command `velocity` \[mm/s\].
    pub fn command(&mut self, velocity: f64) {
        self.command = velocity;
    }

    /// `periods` ticks after the last call, drive on, the encoder is at `counts`: a reason to switch it off.
    pub fn check(&mut self, by: &Supervision, counts: i64, periods: u32) -> Result<(), TrackerFault> {
        let slide = by.slide;
        let step = counts.saturating_sub(self.counts);
        self.counts = counts;
        // Over lost ticks the drive kept its command.
        let time = f64::from(periods.max(1)) * TRACKER_PERIOD_S;
        let moved = step as f64 * by.pitch;
        for _ in 0..periods.clamp(1, 100) {
            self.expected += (self.command - self.expected) * by.lag;
            self.error = (self.error + self.expected * TRACKER_PERIOD_S) * by.fade;
        }
        self.error -= moved;
        self.speed += (moved / time - self.speed) * (1.0 - libm::exp(-time / SPEED_TIME));
        // A step over a lost tick may be longer and says nothing.
        if periods <= 1 && step.unsigned_abs() > by.step.unsigned_abs().into() {
            return Err(TrackerFault::EncoderStep {
                slide,
                seen: step.clamp(i32::MIN.into(), i32::MAX.into()) as i32,
                limit: by.step,
            });
        }
        if libm::fabs(self.speed) > by.speed {
            return Err(TrackerFault::Overspeed {
                slide,
                seen_mm_s: libm::fabs(self.speed) as f32,
                limit_mm_s: by.speed as f32,
            });
        }
        if let Some(commanded) = by.movement.step(&mut self.movement, counts, self.expected, time) {
            return Err(TrackerFault::NoMovement {
                slide,
                commanded_um: (commanded * 1e3) as f32,
            });
        }
        if libm::fabs(self.error) > by.following_error {
            return Err(TrackerFault::FollowingError {
                slide,
                seen_um: (libm::fabs(self.error) * 1e3) as f32,
                limit_um: (by.following_error * 1e3) as f32,
            });
        }
        Ok(())
    }
}
