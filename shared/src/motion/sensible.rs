//! Permitted ranges of the motion board's parameters, derived from their meaning: a protection that is set to
//! never act is refused, and so is what no machine has.

use super::readback::DARK;
use crate::config::{BeamConfig, MotionConfig};
use crate::control::sensible::{MOST_COUNTS, SCALES, SHORTEST_TRAVEL, check_enable, check_home};
use crate::control::{GantryConfig, MotorConfig};
use crate::io::{AXES, MOTOR_AXIS, MOTOR_NAMES};
use crate::kinematics::{AXIS_OWNERS, AxisConfig};
use crate::parameter::{LARGEST_MACHINE_MM, ParameterError, within, within_either_sign};
use crate::ticks::SERVO_PERIOD_S;
use core::f64::consts::FRAC_PI_2;
use core::ops::RangeInclusive;

/// A hundred turns \[°\].
const MOST_TURNS: f64 = 36_000.0;
/// Linear axes of an X Y Z A B C.
const LINEAR: usize = 3;
/// Speeds of axes and drives: linear motors go 10 m/s at most.
const SPEEDS: RangeInclusive<f64> = 0.1..=1e4;
/// Accelerations: up to ten times that of gravity.
const ACCELERATIONS: RangeInclusive<f64> = 1.0..=1e5;
/// Longest time from no acceleration to the full one \[s\]; the shortest is a servo tick.
const LONGEST_RAMP_S: f64 = 10.0;
/// A trip needs some counts, or the grating's own noise sets it off.
const FEWEST_COUNTS: f64 = 10.0;
/// Servo loops have a delay of one and a half ticks at least \[s\]: sampled, computed, held.
const LEAST_DELAY_S: f64 = 1.5 * SERVO_PERIOD_S;
/// Part of the travel that a following error may have at rest, and no more than this (mm or °).
const ERROR_AT_REST: f64 = 0.05;
const MOST_ERROR_AT_REST: f64 = 10.0;
/// Part of the travel that it may have at full speed, and longest time of lag \[s\].
const ERROR_AT_SPEED: f64 = 0.2;
const LONGEST_LAG_S: f64 = 0.2;
/// Yaw that the guides of a gantry bear \[rad\]: the skew trip is this times the width, at most.
const MOST_YAW: f64 = 1e-3;
/// Off square by construction: a hundredth of the width.
const OFF_SQUARE: f64 = 0.01;
/// Narrowest gantry \[mm\].
const NARROWEST_MM: f64 = 10.0;
/// Derivative parts: one of 1 turns the loop's own speed round.
const MOST_DERIVATIVE: f64 = 0.5;
const LONGEST_FILTER_S: f64 = 0.1;
/// Corners of filters: slower ones stop the loop itself, and near half the rate of the ticks they are none \[Hz\].
const CORNERS_HZ: RangeInclusive<f64> = 5.0..=0.45 / SERVO_PERIOD_S;
/// Narrower than that, a notch misses its resonance by the warmth of a day; wider, it is a lag.
const NOTCH_DAMPINGS: RangeInclusive<f64> = 0.01..=2.0;
/// With less a low-pass is a resonance itself.
const LOW_PASS_DAMPINGS: RangeInclusive<f64> = 0.3..=2.0;
/// Friction slows a drive by less than this part of its speed at 10 V, and of its speed.
const MOST_COULOMB: f64 = 0.1;
const MOST_VISCOUS: f64 = 0.5;
/// Speed at which friction has turned round, lowest (mm/s or °/s): one count in a few ticks.
const SLOWEST_REVERSAL: f64 = 1e-3;
/// Powers at 10 V: 100 kW, the strongest lasers there are; or 100 000 turns a minute of a spindle.
const POWERS_W: RangeInclusive<f64> = 1.0..=1e5;
/// A beam goes over at most so much again \[mm\].
const MOST_OVERLAP_MM: f64 = 50.0;
/// Parts of full power by which a measured power may be off: less than [`DARK`] is the measurement's own noise, and half of
/// it off is no protection.
const POWER_TOLERANCES: RangeInclusive<f64> = DARK..=0.5;
/// Time for which it may \[ms\]: commands change every millisecond, and a laser follows within some; a spindle takes
/// seconds to run up.
const SHORTEST_READBACK_MS: f64 = 1.0;
const LONGEST_READBACK_MS: f64 = 100.0;
const LONGEST_RUN_UP_MS: f64 = 10_000.0;
/// Time that the PC may be silent \[ms\]: shorter than its own pauses, or longer than a weld of half a metre, is a
/// mistake.
const SILENCES_MS: RangeInclusive<f64> = 50.0..=5000.0;

/// Checks all of a configuration that can be built.
pub fn check(config: &MotionConfig) -> Result<(), ParameterError> {
    let mut fastest: f64 = 0.0;
    for number in 0..AXES {
        let Some(axis) = &config.axes[number] else {
            continue;
        };
        check_axis(number, axis)?;
        if number < LINEAR {
            fastest = fastest.max(axis.max_velocity);
        }
    }
    for (number, motor) in config.motors.iter().enumerate() {
        if let (Some(motor), Some(axis)) = (motor, &config.axes[MOTOR_AXIS[number]]) {
            check_motor(MOTOR_NAMES[number], motor, axis)?;
        }
    }
    if let (Some(gantry), Some(motor)) = (&config.gantry, &config.motors[0]) {
        check_gantry(gantry, motor)?;
    }
    for (owner, beam) in ["beam 1", "beam 2"].into_iter().zip(&config.beams) {
        if let Some(beam) = beam {
            check_beam(owner, beam, fastest)?;
        }
    }
    within(
        "link",
        "link_timeout_ms",
        f64::from(config.link_timeout_ms),
        SILENCES_MS,
    )?;
    check_enable(config.drive_enable_ms)
}

fn check_axis(number: usize, axis: &AxisConfig) -> Result<(), ParameterError> {
    let owner = AXIS_OWNERS[number];
    let far = if number < LINEAR {
        LARGEST_MACHINE_MM
    } else {
        MOST_TURNS
    };
    within(owner, "travel_min", axis.travel_min, -far..=far)?;
    let least = axis.travel_min + SHORTEST_TRAVEL;
    within(owner, "travel_max", axis.travel_max, least..=far)?;
    within(owner, "max_velocity", axis.max_velocity, SPEEDS)?;
    let acceleration = within(owner, "max_acceleration", axis.max_acceleration, ACCELERATIONS)?;
    let jerks = acceleration / LONGEST_RAMP_S..=acceleration / SERVO_PERIOD_S;
    within(owner, "max_jerk", axis.max_jerk, jerks)?;
    Ok(())
}

/// Highest gain of a loop with a delay: with more it swings by itself.
fn most_gain(delay_s: f64) -> f64 {
    FRAC_PI_2 / libm::fmax(delay_s, LEAST_DELAY_S)
}

/// Checks the gains of the position loop of `motor` beside the lag of its drive and its filters.
///
/// # Errors
/// The first gain that no machine file may have.
pub fn check_gains(owner: &str, motor: &MotorConfig) -> Result<(), ParameterError> {
    let of = |field, value, range| within(owner, field, value, range);
    let most = most_gain(motor.acceleration_feed_forward_s + motor.filter_lag_s());
    let kp = of("kp", motor.kp, 1.0..=most)?;
    // A damping of 0.7 at least.
    of("ki", motor.ki, 0.0..=0.5 * kp * kp)?;
    of("kd", motor.kd, 0.0..=MOST_DERIVATIVE)?;
    Ok(())
}

/// Checks the `coupling` of a gantry whose first motor is `motor`: both motors answer to a skew, each to its own error besides.
///
/// # Errors
/// It is more than a machine file may have.
pub fn check_coupling(coupling: f64, motor: &MotorConfig) -> Result<(), ParameterError> {
    let most = 0.5 * (most_gain(motor.acceleration_feed_forward_s + motor.filter_lag_s()) - motor.kp);
    within("gantry", "coupling", coupling, 0.0..=libm::fmax(most, 0.0))?;
    Ok(())
}

fn most_error_at_rest(axis: &AxisConfig) -> f64 {
    let travel = axis.travel_max - axis.travel_min;
    libm::fmin(ERROR_AT_REST * travel, MOST_ERROR_AT_REST)
}

fn most_error_at_speed(axis: &AxisConfig) -> f64 {
    ERROR_AT_SPEED * (axis.travel_max - axis.travel_min)
}

/// The vibration limit of the motor with this `index`, or the usual one if it has none (mm or °): a swing of ±0.028 mm, as much as a spot
/// may be beside its seam, or one that moves a tip 160 mm away as far; where gratings are coarse, ten counts.
pub fn vibration_limit(index: usize, motor: &MotorConfig) -> f64 {
    if motor.vibration_limit > 0.0 {
        return motor.vibration_limit;
    }
    let usual = if MOTOR_AXIS[index] < LINEAR { 0.02 } else { 0.01 };
    let counts = FEWEST_COUNTS / libm::fabs(motor.counts_per_unit);
    libm::fmin(libm::fmax(usual, counts), motor.following_error_base)
}

/// Largest `following_error_base` that `motor` of `axis` may have beside its `following_error_time_s` (mm or °).
pub fn most_following_error_base(motor: &MotorConfig, axis: &AxisConfig) -> f64 {
    let left = most_error_at_speed(axis) - motor.following_error_time_s * axis.max_velocity;
    libm::fmin(most_error_at_rest(axis), left)
}

fn check_motor(owner: &str, motor: &MotorConfig, axis: &AxisConfig) -> Result<(), ParameterError> {
    let of = |field, value, range| within(owner, field, value, range);
    let full_scale = within_either_sign(owner, "velocity_at_10v", motor.velocity_at_10v, SPEEDS)?;
    let command = of("max_command", motor.max_command, axis.max_velocity..=full_scale)?;
    let most = libm::fmin(*SCALES.end(), MOST_COUNTS / (command * SERVO_PERIOD_S));
    let scale = within_either_sign(
        owner,
        "counts_per_unit",
        motor.counts_per_unit,
        *SCALES.start()..=most,
    )?;

    of(
        "acceleration_feed_forward_s",
        motor.acceleration_feed_forward_s,
        0.0..=LONGEST_FILTER_S,
    )?;
    check_filters(owner, motor)?;
    check_gains(owner, motor)?;
    of("integral_limit", motor.integral_limit, 0.0..=command)?;
    if motor.anti_windup_time_s != 0.0 {
        of(
            "anti_windup_time_s",
            motor.anti_windup_time_s,
            SERVO_PERIOD_S..=LONGEST_RAMP_S,
        )?;
    }
    of(
        "derivative_filter_s",
        motor.derivative_filter_s,
        0.0..=LONGEST_FILTER_S,
    )?;
    of("velocity_feed_forward", motor.velocity_feed_forward, 0.0..=1.5)?;

    if let Some(friction) = &motor.friction {
        let slowest = SLOWEST_REVERSAL..=axis.max_velocity;
        of(
            "friction.coulomb",
            friction.coulomb,
            0.0..=MOST_COULOMB * full_scale,
        )?;
        of("friction.viscous", friction.viscous, 0.0..=MOST_VISCOUS)?;
        of("friction.reversal_speed", friction.reversal_speed, slowest)?;
        of("friction.lead_s", friction.lead_s, 0.0..=LONGEST_FILTER_S)?;
        of("friction.decay_s", friction.decay_s, 0.0..=LONGEST_RAMP_S)?;
    }
    let most = most_error_at_rest(axis);
    let base = of(
        "following_error_base",
        motor.following_error_base,
        FEWEST_COUNTS / scale..=most,
    )?;
    let room = (most_error_at_speed(axis) - base) / axis.max_velocity;
    of(
        "following_error_time_s",
        motor.following_error_time_s,
        0.0..=libm::fmin(room, LONGEST_LAG_S),
    )?;
    if motor.vibration_limit != 0.0 {
        of(
            "vibration_limit",
            motor.vibration_limit,
            FEWEST_COUNTS / scale..=base,
        )?;
    }
    check_home(
        owner,
        &motor.home,
        (axis.travel_min, axis.travel_max),
        axis.max_velocity,
    )
}

fn check_filters(owner: &str, motor: &MotorConfig) -> Result<(), ParameterError> {
    let of = |field, value, range| within(owner, field, value, range);
    for notch in &motor.notches {
        of("notches.frequency_hz", notch.frequency_hz, CORNERS_HZ)?;
        of("notches.damping", notch.damping, NOTCH_DAMPINGS)?;
    }
    if let Some(low_pass) = &motor.low_pass {
        of("low_pass.frequency_hz", low_pass.frequency_hz, CORNERS_HZ)?;
        of("low_pass.damping", low_pass.damping, LOW_PASS_DAMPINGS)?;
    }
    Ok(())
}

fn check_gantry(gantry: &GantryConfig, motor: &MotorConfig) -> Result<(), ParameterError> {
    let of = |field, value, range| within("gantry", field, value, range);
    let everywhere = -LARGEST_MACHINE_MM..=LARGEST_MACHINE_MM;
    let y1 = of("y1_mm", gantry.y1_mm, everywhere.clone())?;
    let y2 = of("y2_mm", gantry.y2_mm, everywhere)?;
    let width = libm::fabs(y2 - y1);
    if width < NARROWEST_MM {
        of("y2_mm", y2, y1 + NARROWEST_MM..=LARGEST_MACHINE_MM)?;
    }
    check_coupling(gantry.coupling, motor)?;
    of(
        "coupling_derivative",
        gantry.coupling_derivative,
        0.0..=MOST_DERIVATIVE,
    )?;
    of(
        "derivative_filter_s",
        gantry.derivative_filter_s,
        0.0..=LONGEST_FILTER_S,
    )?;
    let off = OFF_SQUARE * width;
    of("square_offset_mm", gantry.square_offset_mm, -off..=off)?;
    let least = FEWEST_COUNTS / libm::fabs(motor.counts_per_unit);
    of("skew_trip_mm", gantry.skew_trip_mm, least..=MOST_YAW * width)?;
    Ok(())
}

fn check_beam(owner: &str, beam: &BeamConfig, fastest: f64) -> Result<(), ParameterError> {
    within(owner, "power_at_10v_w", beam.power_at_10v_w, POWERS_W)?;
    // Faster than that it never opens.
    within(owner, "min_speed_mm_s", beam.min_speed_mm_s, 0.0..=fastest)?;
    within(owner, "overlap_mm", beam.overlap_mm, 0.0..=MOST_OVERLAP_MM)?;
    if let Some(readback) = &beam.readback {
        within(owner, "readback.tolerance", readback.tolerance, POWER_TOLERANCES)?;
        let longest = if beam.stays_on_at_rest {
            LONGEST_RUN_UP_MS
        } else {
            LONGEST_READBACK_MS
        };
        let times = SHORTEST_READBACK_MS..=longest;
        within(owner, "readback.time_ms", f64::from(readback.time_ms), times)?;
    }
    Ok(())
}
