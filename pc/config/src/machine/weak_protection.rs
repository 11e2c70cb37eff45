//! Protections that a machine's parameters leave weaker than usual: allowed, but reported.

use super::MachineFile;
use shared::config::{BeamConfig, MotionConfig, TrackerConfig};
use shared::io::MOTOR_NAMES;
use thiserror::Error;

/// Following errors at rest that trip late (mm or °), and lags \[s\].
const ERROR: f64 = 1.0;
const LAG_S: f64 = 0.1;
/// Yaw of the beam of a gantry that trips late \[rad\].
const YAW: f64 = 3e-4;
/// Silence of the PC that stops late \[ms\].
const SILENCE_MS: u32 = 1000;
/// Part of full power by which a beam may be off: more is detected late.
const POWER: f64 = 0.2;
/// Distance without sight of the seam: more is detected late \[mm\].
const BLIND_MM: f64 = 10.0;
/// Outliers that are taken for the seam \[mm\], and deviations that are left alone.
const OUTLIER_MM: f64 = 2.0;
const LEFT_ALONE_MM: f64 = 0.05;
/// Silence of the motion board that stops the slides late, and saturation: more is detected late \[ms\].
const STALE_MS: u32 = 50;
const SATURATED_MS: u32 = 500;

/// A protection that acts later than usual.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum WeakProtection {
    /// A motor that stands elsewhere is noticed late.
    #[error("following_error_base of {} is {limit} mm (or °): a motor that does not follow is detected late; usual values are up to {ERROR}", MOTOR_NAMES[*.motor as usize])]
    FollowingError {
        /// Index of the motor.
        motor: u8,
        /// Limit at rest (mm or °).
        limit: f64,
    },
    /// The same in motion.
    #[error("following_error_time_s of {} is {time_s} s: a motor that does not follow in motion is detected late; usual values are up to {LAG_S}", MOTOR_NAMES[*.motor as usize])]
    FollowingErrorInMotion {
        /// Index of the motor.
        motor: u8,
        /// By which the limit grows with speed \[s\].
        time_s: f64,
    },
    /// A gantry may be far from square.
    #[error("skew_trip_mm of gantry is {trip_mm} mm, {:.2} mrad over its width: the guides may be forced before it trips; usual values are up to {} mrad", yaw * 1e3, YAW * 1e3)]
    Skew {
        /// The trip \[mm\].
        trip_mm: f64,
        /// The yaw at which it trips \[rad\].
        yaw: f64,
    },
    /// A machine without its PC continues for long.
    #[error(
        "link_timeout_ms is {timeout_ms}: a weld continues for this time without its PC; usual values are up to {SILENCE_MS}"
    )]
    Link {
        /// The timeout \[ms\].
        timeout_ms: u32,
    },
    /// A beam may be on while the machine stands.
    #[error("min_speed_mm_s of beam {} is 0: it may be on where the machine stands, and burn through", side + 1)]
    BeamAtRest {
        /// 0 or 1.
        side: u8,
    },
    /// A beam may burn with another power than commanded.
    #[error("readback.tolerance of beam {} is {tolerance}: the power may be off by this part of full power; usual values are up to {POWER}", side + 1)]
    Power {
        /// 0 or 1.
        side: u8,
        /// The tolerance, as part of full power.
        tolerance: f64,
    },
    /// A beam goes on for long without sight of its seam.
    #[error(
        "window_mm and hold_mm of tracking are {way_mm} mm together: a beam goes over twice this way between two places where its seam was seen; usual values are up to {BLIND_MM}"
    )]
    LostSeam {
        /// The way \[mm\].
        way_mm: f64,
    },
    /// What is far from the seam is taken for it.
    #[error(
        "gate_mm of tracking is {gate_mm} mm: a measurement this far from the seam is accepted; usual values are up to {OUTLIER_MM}"
    )]
    Outliers {
        /// The gate \[mm\].
        gate_mm: f64,
    },
    /// Deviations are left alone.
    #[error(
        "dead_band_mm of tracking is {band_mm} mm: a spot may stay this far beside its seam; usual values are up to {LEFT_ALONE_MM}"
    )]
    DeadBand {
        /// The band \[mm\].
        band_mm: f64,
    },
    /// Slides follow old path states for long.
    #[error(
        "stale_path_ms of tracking is {stale_ms}: the slides continue for this time without the motion board; usual values are up to {STALE_MS}"
    )]
    StalePath {
        /// The time \[ms\].
        stale_ms: u32,
    },
    /// A slide that cannot follow is reported late.
    #[error(
        "saturation_trip_ms of tracking is {trip_ms}: a slide that cannot follow its seam is reported late; usual values are up to {SATURATED_MS}"
    )]
    Saturation {
        /// The time \[ms\].
        trip_ms: u32,
    },
}

impl MachineFile {
    /// Protections that act later than usual.
    pub fn weak_protections(&self) -> Vec<WeakProtection> {
        let tracking = self.tracking.as_ref();
        let mut found = of_motion(&self.motion);
        found.extend(tracking.into_iter().flat_map(|unit| of_tracker(&unit.board)));
        found
    }
}

fn of_motion(motion: &MotionConfig) -> Vec<WeakProtection> {
    let mut found = Vec::new();
    for (number, motor) in (0..).zip(&motion.motors) {
        let Some(motor) = motor else { continue };
        let (limit, time_s) = (motor.following_error_base, motor.following_error_time_s);
        if limit > ERROR {
            found.push(WeakProtection::FollowingError { motor: number, limit });
        }
        if time_s > LAG_S {
            found.push(WeakProtection::FollowingErrorInMotion {
                motor: number,
                time_s,
            });
        }
    }
    if let Some(gantry) = &motion.gantry {
        let yaw = libm::fabs(gantry.skew_trip_mm / (gantry.y2_mm - gantry.y1_mm));
        if yaw > YAW {
            found.push(WeakProtection::Skew {
                trip_mm: gantry.skew_trip_mm,
                yaw,
            });
        }
    }
    for (side, beam) in (0..).zip(&motion.beams) {
        let rests = |beam: &BeamConfig| {
            // A spindle is meant to turn at rest.
            beam.min_speed_mm_s <= 0.0 && !beam.stays_on_at_rest
        };
        if beam.as_ref().is_some_and(rests) {
            found.push(WeakProtection::BeamAtRest { side });
        }
        let tolerance = beam
            .as_ref()
            .and_then(|beam| Some(beam.readback.as_ref()?.tolerance));
        if let Some(tolerance) = tolerance.filter(|tolerance| *tolerance > POWER) {
            found.push(WeakProtection::Power { side, tolerance });
        }
    }
    if motion.link_timeout_ms > SILENCE_MS {
        found.push(WeakProtection::Link {
            timeout_ms: motion.link_timeout_ms,
        });
    }
    found
}

fn of_tracker(board: &TrackerConfig) -> Vec<WeakProtection> {
    let tracking = &board.tracking;
    let way_mm = tracking.window_mm + tracking.hold_mm;
    let (gate_mm, band_mm) = (tracking.gate_mm, tracking.dead_band_mm);
    let (stale_ms, trip_ms) = (tracking.stale_path_ms, tracking.saturation_trip_ms);
    let all = [
        (way_mm > BLIND_MM, WeakProtection::LostSeam { way_mm }),
        (gate_mm > OUTLIER_MM, WeakProtection::Outliers { gate_mm }),
        (band_mm > LEFT_ALONE_MM, WeakProtection::DeadBand { band_mm }),
        (stale_ms > STALE_MS, WeakProtection::StalePath { stale_ms }),
        (trip_ms > SATURATED_MS, WeakProtection::Saturation { trip_ms }),
    ];
    all.into_iter()
        .filter_map(|(late, found)| late.then_some(found))
        .collect()
}
