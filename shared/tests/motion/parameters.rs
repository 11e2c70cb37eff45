//! Parameters have floors and ceilings by what they mean.

use super::bench::{Bench, config};
use shared::config::{BeamConfig, MotionConfig, ReadbackConfig};
use shared::control::{FrictionConfig, GantryConfig, LowPassConfig, MotorConfig, NotchConfig};
use shared::kinematics::AxisConfig;
use shared::parameter::ParameterError;
use shared::protocol::{Refusal, Request};

fn refused(owner: &str, field: &str, value: f64, change: impl FnOnce(&mut MotionConfig)) {
    let mut config = config();
    change(&mut config);
    let refusal = Bench::new().refused(&Request::ConfigureMotion(config));
    let expected = Refusal::Parameter(ParameterError::new(owner, field, value));
    assert_eq!(refusal, expected);
    let text = refusal.to_string();
    assert!(text.contains("must"), "{text}");
}

fn motor(field: &str, value: f64, place: fn(&mut MotorConfig) -> &mut f64) {
    refused("Y", field, value, |config| {
        *place(config.motors[2].as_mut().unwrap()) = value;
    });
}

fn axis(field: &str, value: f64, place: fn(&mut AxisConfig) -> &mut f64) {
    refused("axis Y", field, value, |config| {
        *place(config.axes[1].as_mut().unwrap()) = value;
    });
}

fn gantry(field: &str, value: f64, place: fn(&mut GantryConfig) -> &mut f64) {
    refused("gantry", field, value, |config| {
        *place(config.gantry.as_mut().unwrap()) = value;
    });
}

fn beam(field: &str, value: f64, place: fn(&mut BeamConfig) -> &mut f64) {
    refused("beam 2", field, value, |config| {
        *place(config.beams[1].as_mut().unwrap()) = value;
    });
}

#[test]
fn a_protection_that_never_acts_is_refused() {
    // 5 % of a travel of 1000 mm, but no more than 10 mm.
    motor("following_error_base", 1e9, |m| &mut m.following_error_base);
    motor("following_error_base", 10.1, |m| &mut m.following_error_base);
    motor("following_error_time_s", 0.3, |m| &mut m.following_error_time_s);
    motor("vibration_limit", 0.6, |m| &mut m.vibration_limit);
    // 1 mrad of 3500 mm.
    gantry("skew_trip_mm", 1e9, |g| &mut g.skew_trip_mm);
    gantry("skew_trip_mm", 3.6, |g| &mut g.skew_trip_mm);
    for ms in [0, 20, 6000, u32::MAX] {
        refused("link", "link_timeout_ms", f64::from(ms), |config| {
            config.link_timeout_ms = ms
        });
    }
    // One that the grating's own noise sets off.
    motor("following_error_base", 1e-4, |m| &mut m.following_error_base);
    motor("vibration_limit", 1e-4, |m| &mut m.vibration_limit);
    gantry("skew_trip_mm", 1e-4, |g| &mut g.skew_trip_mm);
}

#[test]
fn what_no_machine_has_is_refused() {
    beam("power_at_10v_w", 1e300, |b| &mut b.power_at_10v_w);
    beam("overlap_mm", 1e3, |b| &mut b.overlap_mm);
    beam("min_speed_mm_s", 301.0, |b| &mut b.min_speed_mm_s);
    axis("travel_max", 1e300, |a| &mut a.travel_max);
    axis("max_velocity", 1e-3, |a| &mut a.max_velocity);
    axis("max_velocity", 1e300, |a| &mut a.max_velocity);
    axis("max_acceleration", 1e-300, |a| &mut a.max_acceleration);
    axis("max_jerk", 1e-300, |a| &mut a.max_jerk);
    axis("max_jerk", 1e300, |a| &mut a.max_jerk);
    gantry("square_offset_mm", -40.0, |g| &mut g.square_offset_mm);
    gantry("y2_mm", -249.0, |g| &mut g.y2_mm);
    gantry("coupling", 1e5, |g| &mut g.coupling);
}

#[test]
fn a_readback_that_never_acts_or_acts_on_noise_is_refused() {
    let readback = |field: &str, value: f64, tolerance: f64, time_ms: u32| {
        refused("beam 2", field, value, |config| {
            config.beams[1].as_mut().unwrap().readback = Some(ReadbackConfig { tolerance, time_ms });
        });
    };
    for tolerance in [1.0, 0.51, 0.01, 0.0, -0.1, f64::NAN] {
        readback("readback.tolerance", tolerance, tolerance, 20);
    }
    for time_ms in [0, 101, u32::MAX] {
        readback("readback.time_ms", f64::from(time_ms), 0.1, time_ms);
    }
}

#[test]
fn loops_that_swing_and_drives_that_cannot_are_refused() {
    // π/2 over one and a half servo ticks.
    motor("kp", 4200.0, |m| &mut m.kp);
    motor("kp", 0.0, |m| &mut m.kp);
    motor("ki", 5001.0, |m| &mut m.ki);
    motor("kd", 1.0, |m| &mut m.kd);
    motor("derivative_filter_s", 1.0, |m| &mut m.derivative_filter_s);
    motor("integral_limit", 401.0, |m| &mut m.integral_limit);
    motor("velocity_feed_forward", 2.0, |m| &mut m.velocity_feed_forward);
    motor("acceleration_feed_forward_s", 1.0, |m| {
        &mut m.acceleration_feed_forward_s
    });
    motor("anti_windup_time_s", 1e-9, |m| &mut m.anti_windup_time_s);
    // Slower than its axis, and faster than its drive.
    motor("max_command", 299.0, |m| &mut m.max_command);
    motor("max_command", 401.0, |m| &mut m.max_command);
    motor("velocity_at_10v", -1e300, |m| &mut m.velocity_at_10v);
    // Half way round a counter of 16 bits in a servo tick.
    motor("counts_per_unit", 330_000.0, |m| &mut m.counts_per_unit);
    motor("counts_per_unit", -1e-9, |m| &mut m.counts_per_unit);
    motor("home.velocity", -301.0, |m| &mut m.home.velocity);
    motor("home.mark_position", 1200.0, |m| &mut m.home.mark_position);
    motor("home.max_travel", 1e9, |m| &mut m.home.max_travel);
}

/// Y with something that it may have.
fn fitted(field: &str, value: f64, fit: impl FnOnce(&mut MotorConfig)) {
    refused("Y", field, value, |config| {
        fit(config.motors[2].as_mut().unwrap())
    });
}

#[test]
fn filters_that_are_none_and_those_that_leave_no_margin_are_refused() {
    let notch = |field: &str, value, frequency_hz, damping, depth| {
        let notch = NotchConfig {
            frequency_hz,
            damping,
            depth,
        };
        fitted(field, value, |motor| motor.notches.push(notch).unwrap());
    };
    // Half the rate of the servo ticks is 2000 Hz.
    for hz in [-80.0, 4.0, 1801.0, 2001.0, 1e9, f64::NAN] {
        notch("notches.frequency_hz", hz, hz, 0.5, 0.1);
    }
    for damping in [0.0, -0.5, 1e-3, 3.0, f64::INFINITY] {
        notch("notches.damping", damping, 80.0, damping, 0.1);
    }
    for depth in [-0.1, 1.1, f64::NAN] {
        notch("notches.depth", depth, 80.0, 0.5, depth);
    }
    let low_pass = |field: &str, value, frequency_hz, damping| {
        let filter = LowPassConfig {
            frequency_hz,
            damping,
        };
        fitted(field, value, |motor| motor.low_pass = Some(filter));
    };
    low_pass("low_pass.frequency_hz", 2500.0, 2500.0, 0.7);
    low_pass("low_pass.damping", 0.0, 300.0, 0.0);
    low_pass("low_pass.damping", 0.2, 300.0, 0.2);
    // It delays by 0.7/(π·10 Hz) = 22 ms: kp is at most (π/2)/22 ms.
    low_pass("kp", 100.0, 10.0, 0.7);
}

#[test]
fn friction_that_no_drive_has_is_refused() {
    const FRICTION: FrictionConfig = FrictionConfig {
        coulomb: 0.3,
        viscous: 0.0,
        reversal_speed: 1.0,
        lead_s: 0.0,
        decay_s: 0.0,
    };
    let friction = |field: &str, value, friction| {
        fitted(field, value, |motor| motor.friction = Some(friction));
    };
    for coulomb in [-0.1, 41.0] {
        friction(
            "friction.coulomb",
            coulomb,
            FrictionConfig { coulomb, ..FRICTION },
        );
    }
    for viscous in [-0.1, 1.0] {
        friction(
            "friction.viscous",
            viscous,
            FrictionConfig { viscous, ..FRICTION },
        );
    }
    for reversal_speed in [0.0, -1.0, 301.0] {
        let wrong = FrictionConfig {
            reversal_speed,
            ..FRICTION
        };
        friction("friction.reversal_speed", reversal_speed, wrong);
    }
    friction(
        "friction.lead_s",
        1.0,
        FrictionConfig {
            lead_s: 1.0,
            ..FRICTION
        },
    );
    friction(
        "friction.decay_s",
        -1.0,
        FrictionConfig {
            decay_s: -1.0,
            ..FRICTION
        },
    );
}
