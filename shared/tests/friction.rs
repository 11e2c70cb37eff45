//! Feed-forward of friction: its shape, and what it is good for on a drive with friction behind it.

use plant::{Drive, DriveConfig, MechanicsConfig, Noise, Wave};
use shared::control::{
    Friction, FrictionConfig, FrictionState, HomeConfig, MotorConfig, Pid, PidState, Setpoint,
};
use std::f64::consts::PI;

const PERIOD_S: f64 = 250e-6;
/// Of the drive's velocity loop \[Hz\], whose gain is then 2π times that \[1/s\].
const BANDWIDTH_HZ: f64 = 80.0;
/// Coulomb friction of the machine \[mm/s²\].
const FRICTION: f64 = 150.0;

fn friction() -> FrictionConfig {
    let gain = 2.0 * PI * BANDWIDTH_HZ;
    FrictionConfig {
        coulomb: FRICTION / gain,
        viscous: 0.0,
        reversal_speed: 0.2,
        lead_s: 0.0005,
        // Proportional gain ω over integral gain ω²/4.
        decay_s: 4.0 / gain,
    }
}

fn moving(velocity: f64, acceleration: f64) -> Setpoint {
    Setpoint {
        position: 0.0,
        velocity,
        acceleration,
    }
}

#[test]
fn it_grows_smoothly_to_coulomb_and_viscous_friction_and_is_odd() {
    let config = FrictionConfig {
        coulomb: 0.3,
        viscous: 0.02,
        reversal_speed: 2.0,
        lead_s: 0.0,
        decay_s: 0.0,
    };
    let friction = Friction::build("Y", &config, 1.0, PERIOD_S).unwrap();
    let at = |v: f64| friction.step(&mut FrictionState::default(), &moving(v, 0.0));
    assert_eq!(at(0.0), 0.0);
    for (v, expected) in [(2.0, 0.34), (10.0, 0.5), (1.0, 0.3 * 0.6875 + 0.02)] {
        assert!((at(v) - expected).abs() < 1e-12, "{v}: {}", at(v));
        assert_eq!(at(-v), -at(v));
    }
    // No step, and no corner where it begins to be level: 1.5·0.3/2 + 0.02 is the steepest.
    for i in -400..400 {
        let v = f64::from(i) * 0.01;
        let slope = (at(v + 0.01) - at(v)) / 0.01;
        assert!((0.0199..0.2451).contains(&slope), "{v}: {slope}");
    }
    let corner = (at(2.01) - at(2.0)) - (at(2.0) - at(1.99));
    assert!(corner.abs() < 2e-5, "{corner}");
}

#[test]
fn a_drive_with_an_integral_part_is_told_of_a_reversal_and_then_left_alone() {
    let config = friction();
    let friction = Friction::build("Y", &config, 1.0, PERIOD_S).unwrap();
    let mut state = FrictionState::default();
    let first = friction.step(&mut state, &moving(50.0, 0.0));
    assert!((first - config.coulomb).abs() < 0.05 * config.coulomb, "{first}");
    // After one time constant 1/e is left.
    let ticks = (config.decay_s / PERIOD_S).round() as u32;
    let left = (0..ticks).fold(first, |_, _| friction.step(&mut state, &moving(50.0, 0.0)));
    assert!((left / first - (-1.0_f64).exp()).abs() < 0.01, "{}", left / first);
    // Turned round, it is told of twice the friction.
    let back = friction.step(&mut state, &moving(-50.0, 0.0)) - left;
    assert!((back / first + 2.0).abs() < 0.05, "{}", back / first);
}

#[test]
fn it_is_earlier_than_the_motion_by_its_lead() {
    let friction = Friction::build("Y", &friction(), 1.0, PERIOD_S).unwrap();
    // 0.5 ms before it turns round at 100 mm/s².
    let command = friction.step(&mut FrictionState::default(), &moving(-0.05, 100.0));
    assert!(command.abs() < 1e-12, "{command}");
}

#[test]
fn degrees_of_a_rotary_motor_are_as_many_radians() {
    let unit = PI / 180.0;
    let config = friction();
    let [degrees, radians] = [1.0, unit].map(|unit| Friction::build("A", &config, unit, PERIOD_S).unwrap());
    let seen = radians.step(&mut FrictionState::default(), &moving(0.1 * unit, 3.0 * unit));
    let expected = unit * degrees.step(&mut FrictionState::default(), &moving(0.1, 3.0));
    assert!((seen - expected).abs() < 1e-12 * unit, "{seen} {expected}");
}

/// Largest following error \[mm\] on a sine of 100 mm and 150 mm/s, as on a circle R100 at 9 m/min, after the first period.
fn spike(friction: Option<FrictionConfig>, presliding: f64) -> f64 {
    let config = MotorConfig {
        kp: 120.0,
        ki: 1000.0,
        integral_limit: 20.0,
        anti_windup_time_s: 0.05,
        kd: 0.0,
        derivative_filter_s: 0.0005,
        velocity_feed_forward: 1.0,
        acceleration_feed_forward_s: 0.0025,
        notches: heapless::Vec::new(),
        low_pass: None,
        friction,
        max_command: 400.0,
        counts_per_unit: 10_000.0,
        velocity_at_10v: 400.0,
        following_error_base: 0.5,
        following_error_time_s: 0.05,
        vibration_limit: 0.0,
        home_sequence: 0,
        home: HomeConfig {
            velocity: 10.0,
            mark_position: 0.0,
            max_travel: 100.0,
        },
    };
    let drive = DriveConfig {
        velocity_at_10v: 400.0,
        bandwidth_hz: BANDWIDTH_HZ,
        dead_time_s: 0.0005,
        max_acceleration: 4000.0,
        brake: 4000.0,
        enable_s: 0.0,
        gain_error: 0.0,
        offset: 0.0,
        noise: 0.0,
    };
    let mechanics = MechanicsConfig {
        friction: FRICTION,
        damping_per_s: 1.0,
        backlash: 0.0,
        stiction: 0.0,
        stribeck_speed: 0.0,
        presliding,
        gravity: 0.0,
        cogging: Wave::default(),
        modes: heapless::Vec::new(),
    };
    let mut drive = Drive::new(&drive, &mechanics, PERIOD_S / 5.0, 0.0, Noise::new(1, 0));
    let pid = Pid::build("Y", &config, 1.0, PERIOD_S).unwrap();
    let mut state = PidState::default();
    let (radius, rate) = (100.0, 1.5);
    let mut largest: f64 = 0.0;
    for tick in 0..34_000 {
        let angle = rate * f64::from(tick) * PERIOD_S;
        let setpoint = Setpoint {
            position: radius * (1.0 - angle.cos()),
            velocity: radius * rate * angle.sin(),
            acceleration: radius * rate * rate * angle.cos(),
        };
        let read = (drive.at_grating() * 1e4).round() / 1e4;
        let command = pid.step(&mut state, &setpoint, read, 0.0).unwrap();
        if angle > 2.0 * PI {
            largest = largest.max((setpoint.position - drive.at_grating()).abs());
        }
        drive.run(command, 5);
    }
    largest
}

#[test]
fn reversal_spikes_are_less_than_a_third_with_it_and_half_where_friction_builds_up_over_micrometres() {
    let gradual = FrictionConfig {
        reversal_speed: 4.0,
        lead_s: 0.0,
        ..friction()
    };
    for (presliding, config, part) in [(0.0, friction(), 0.33), (0.005, gradual, 0.55)] {
        let (without, with) = (spike(None, presliding), spike(Some(config), presliding));
        println!("presliding {presliding}: {without:.5} mm without, {with:.5} mm with");
        assert!(without > 0.0015, "{without}");
        assert!(with < part * without, "{with} mm of {without} mm");
    }
}
