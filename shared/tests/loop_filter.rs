//! Filters behind the position loop, by running sines through them, against the response of what they stand for.

use shared::control::{HomeConfig, LowPassConfig, MotorConfig, NotchConfig, Pid, PidState, Setpoint};
use std::f64::consts::PI;

const PERIOD_S: f64 = 250e-6;

/// A complex number.
#[derive(Clone, Copy, Debug)]
struct Complex(f64, f64);

impl Complex {
    fn over(self, other: Self) -> Self {
        let Self(c, d) = other;
        let size = c * c + d * d;
        Self((self.0 * c + self.1 * d) / size, (self.1 * c - self.0 * d) / size)
    }

    fn times(self, other: Self) -> Self {
        Self(
            self.0 * other.0 - self.1 * other.1,
            self.0 * other.1 + self.1 * other.0,
        )
    }

    fn off(self, other: Self) -> f64 {
        (self.0 - other.0).hypot(self.1 - other.1)
    }
}

/// A motor with kp 1 and nothing else: the command is the filtered error.
fn motor(notches: &[NotchConfig], low_pass: Option<LowPassConfig>) -> MotorConfig {
    MotorConfig {
        kp: 1.0,
        ki: 0.0,
        integral_limit: 0.0,
        anti_windup_time_s: 0.0,
        kd: 0.0,
        derivative_filter_s: 0.0,
        velocity_feed_forward: 0.0,
        acceleration_feed_forward_s: 0.0,
        notches: notches.iter().copied().collect(),
        low_pass,
        friction: None,
        max_command: 1e6,
        counts_per_unit: 10_000.0,
        velocity_at_10v: 400.0,
        following_error_base: 1.0,
        following_error_time_s: 0.05,
        vibration_limit: 0.0,
        home_sequence: 0,
        home: HomeConfig {
            velocity: 10.0,
            mark_position: 0.0,
            max_travel: 100.0,
        },
    }
}

/// Gain and phase at `hz`, a multiple of 1 Hz: the sine at the output, by correlation over a second after four.
fn measured(config: &MotorConfig, hz: f64) -> Complex {
    let pid = Pid::build("Y", config, 1.0, PERIOD_S).unwrap();
    let mut state = PidState::default();
    let (mut real, mut imaginary) = (0.0, 0.0);
    for tick in 0..20_000 {
        let angle = 2.0 * PI * hz * f64::from(tick) * PERIOD_S;
        let setpoint = Setpoint {
            position: angle.sin(),
            ..Setpoint::default()
        };
        let output = pid.step(&mut state, &setpoint, 0.0, 0.0).unwrap();
        if tick >= 16_000 {
            real += output * angle.sin() / 2000.0;
            imaginary += output * angle.cos() / 2000.0;
        }
    }
    Complex(real, imaginary)
}

/// s²·a + s·b + c at s = j·x.
fn square(x: f64, [a, b, c]: [f64; 3]) -> Complex {
    Complex(c - a * x * x, b * x)
}

/// The frequency relative to `corner_hz` to which the bilinear transform takes `hz`, the corner staying where it is.
fn warped(hz: f64, corner_hz: f64) -> f64 {
    (PI * hz * PERIOD_S).tan() / (PI * corner_hz * PERIOD_S).tan()
}

fn notch_at(x: f64, notch: &NotchConfig) -> Complex {
    let width = 2.0 * notch.damping;
    square(x, [1.0, width * notch.depth, 1.0]).over(square(x, [1.0, width, 1.0]))
}

fn low_pass_at(x: f64, filter: &LowPassConfig) -> Complex {
    Complex(1.0, 0.0).over(square(x, [1.0, 2.0 * filter.damping, 1.0]))
}

const NOTCHES: [NotchConfig; 2] = [
    NotchConfig {
        frequency_hz: 80.0,
        damping: 0.4,
        depth: 0.1,
    },
    NotchConfig {
        frequency_hz: 340.0,
        damping: 0.2,
        depth: 0.0,
    },
];
const LOW_PASS: LowPassConfig = LowPassConfig {
    frequency_hz: 600.0,
    damping: 0.7,
};

#[test]
fn two_notches_and_a_low_pass_answer_sines_as_their_formulas_say() {
    let config = motor(&NOTCHES, Some(LOW_PASS));
    for hz in [1.0, 20.0, 79.0, 80.0, 81.0, 150.0, 340.0, 600.0, 1200.0, 1900.0] {
        let [first, second] = NOTCHES.map(|n| notch_at(warped(hz, n.frequency_hz), &n));
        let low = low_pass_at(warped(hz, LOW_PASS.frequency_hz), &LOW_PASS);
        let (expected, seen) = (first.times(second).times(low), measured(&config, hz));
        assert!(expected.off(seen) < 1e-9, "{hz} Hz: {seen:?}, not {expected:?}");
    }
}

#[test]
fn slow_against_the_ticks_a_filter_is_the_one_of_continuous_time() {
    for hz in [5.0, 40.0, 60.0, 80.0, 120.0] {
        let seen = measured(&motor(&NOTCHES[..1], None), hz);
        let expected = notch_at(hz / 80.0, &NOTCHES[0]);
        assert!(expected.off(seen) < 3e-3, "{hz} Hz: {seen:?}, not {expected:?}");
    }
}

#[test]
fn at_its_frequency_a_notch_has_its_depth_and_a_low_pass_one_over_two_zeta() {
    for notch in NOTCHES {
        let seen = measured(&motor(&[notch], None), notch.frequency_hz);
        assert!(seen.off(Complex(notch.depth, 0.0)) < 1e-9, "{seen:?}");
    }
    let seen = measured(&motor(&[], Some(LOW_PASS)), LOW_PASS.frequency_hz);
    assert!(seen.off(Complex(0.0, -1.0 / 1.4)) < 1e-9, "{seen:?}");
}

/// Numbers that look like none in particular, in ±1.
fn noise(seed: &mut u32) -> f64 {
    *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    f64::from(*seed) / f64::from(u32::MAX) * 2.0 - 1.0
}

#[test]
fn without_filters_and_friction_the_command_is_to_the_bit_what_it_was() {
    let config = MotorConfig {
        kp: 120.0,
        ki: 1000.0,
        integral_limit: 20.0,
        anti_windup_time_s: 0.05,
        kd: 0.01,
        derivative_filter_s: 0.0005,
        velocity_feed_forward: 1.01,
        acceleration_feed_forward_s: 0.0025,
        max_command: 300.0,
        ..motor(&[], None)
    };
    let pid = Pid::build("Y", &config, 1.0, PERIOD_S).unwrap();
    let mut state = PidState::default();
    // The law as it was before there were filters.
    let keep = 0.0005 / (0.0005 + PERIOD_S);
    let (mut before, mut derivative, mut integral, mut excess) = (None, 0.0, 0.0_f64, 0.0);
    let mut seed = 1;
    for tick in 0..10_000 {
        let mut draw = |size: f64| size * noise(&mut seed);
        let (position, extra) = (draw(3.0), draw(20.0));
        let setpoint = Setpoint {
            position: draw(3.0),
            velocity: draw(200.0),
            acceleration: draw(1000.0),
        };
        let e = setpoint.position - position;
        derivative = keep * derivative + (1.0 - keep) * (e - before.unwrap_or(e)) / PERIOD_S;
        before = Some(e);
        integral = (integral + PERIOD_S * (1000.0 * e + excess * (1.0 / 0.05))).clamp(-20.0, 20.0);
        let forward = 1.01 * setpoint.velocity + 0.0025 * setpoint.acceleration;
        let command: f64 = 120.0 * e + integral + 0.01 * derivative + forward + extra;
        let limited = command.clamp(-300.0, 300.0);
        excess = limited - command;
        let seen = pid.step(&mut state, &setpoint, position, extra).unwrap();
        assert_eq!(seen.to_bits(), limited.to_bits(), "tick {tick}");
    }
}

#[test]
fn the_feed_forward_passes_beside_the_filter_and_what_couples_a_gantry_through_it() {
    let config = MotorConfig {
        kp: 10.0,
        velocity_feed_forward: 1.0,
        ..motor(
            &[],
            Some(LowPassConfig {
                frequency_hz: 10.0,
                damping: 0.7,
            }),
        )
    };
    let pid = Pid::build("Y", &config, 1.0, PERIOD_S).unwrap();
    let run = |velocity: f64, extra: f64| {
        let setpoint = Setpoint {
            velocity,
            ..Setpoint::default()
        };
        pid.step(&mut PidState::default(), &setpoint, 0.0, extra).unwrap()
    };
    assert_eq!(run(50.0, 0.0), 50.0);
    assert!(run(0.0, 50.0).abs() < 0.01, "{}", run(0.0, 50.0));
}

#[test]
fn a_ramp_comes_out_later_by_the_lag_of_the_filters() {
    let config = motor(&NOTCHES, Some(LOW_PASS));
    let pid = Pid::build("Y", &config, 1.0, PERIOD_S).unwrap();
    let mut state = PidState::default();
    let late = (0..4000).fold(0.0, |_, tick| {
        let setpoint = Setpoint {
            position: f64::from(tick) * PERIOD_S,
            ..Setpoint::default()
        };
        setpoint.position - pid.step(&mut state, &setpoint, 0.0, 0.0).unwrap()
    });
    // Against the corner as the bilinear transform has it, the lag is by (π·f·T)²/3 off: 7 % at 600 Hz, of 0.4 ms.
    assert!(
        (late / config.filter_lag_s() - 1.0).abs() < 0.02,
        "{late} {}",
        config.filter_lag_s()
    );
}
