//! Two closed loops on a circle, with the drive model of mathematics 0.11.

use super::file::{Golden, near, number};
use super::servo::pid;
use heapless::Vec;
use plant::{Drive, DriveConfig, MechanicsConfig, Noise, Wave};
use serde_json::{Value, json};
use shared::control::{PidState, Setpoint};

/// Step of the model \[s\].
const H: f64 = 50e-6;
/// Acceleration limit of the drive \[mm/s²\].
const DRIVE_ACCELERATION: f64 = 4000.0;
/// Tangential acceleration of the reference \[mm/s²\].
const START: f64 = 500.0;

/// The drive of one axis.
fn drive(par: &Value, position: f64) -> Drive {
    let drive = DriveConfig {
        velocity_at_10v: 400.0,
        bandwidth_hz: number(par, "fv"),
        dead_time_s: number(par, "delay"),
        max_acceleration: DRIVE_ACCELERATION,
        brake: DRIVE_ACCELERATION,
        enable_s: 0.0,
        gain_error: 0.0,
        offset: 0.0,
        noise: 0.0,
    };
    let mechanics = MechanicsConfig {
        friction: number(par, "fc"),
        damping_per_s: 1.0,
        backlash: number(par, "bl"),
        stiction: 0.0,
        stribeck_speed: 0.0,
        presliding: 0.0,
        gravity: 0.0,
        cogging: Wave::default(),
        modes: Vec::new(),
    };
    Drive::new(&drive, &mechanics, H, position, Noise::new(1, 0))
}

/// Position, velocity and acceleration on the circle about the origin, from rest at (R, 0).
fn circle(radius: f64, speed: f64, t: f64) -> [Setpoint; 2] {
    let ramp = speed / START;
    let (s, v, a) = if t < ramp {
        (START * t * t / 2.0, START * t, START)
    } else {
        (speed * (t - ramp / 2.0), speed, 0.0)
    };
    let (sin, cos) = (s / radius).sin_cos();
    let inward = v * v / radius;
    [
        Setpoint {
            position: radius * cos,
            velocity: -v * sin,
            acceleration: -a * sin - inward * cos,
        },
        Setpoint {
            position: radius * sin,
            velocity: v * cos,
            acceleration: a * cos - inward * sin,
        },
    ]
}

/// Checks the file `closed_loop_servo`.
pub fn closed_loop_servo(golden: &Golden) {
    for case in &golden.cases {
        let input = &case["in"];
        let (radius, speed) = (number(input, "Rc"), number(input, "v"));
        let period = 1.0 / number(input, "fs");
        let mut par = input.clone();
        for (key, value) in [
            ("T", period),
            ("td", 2.0 * period),
            ("tt", 0.05),
            ("umax", 400.0),
            ("imax", 20.0),
        ] {
            par[key] = json!(value);
        }
        let pid = pid(&par);
        let mut states = [PidState::default(); 2];
        let mut axes = circle(radius, speed, 0.0).map(|start| drive(input, start.position));
        let ramp = speed / START;
        let end = ramp + 3.2 * std::f64::consts::PI * radius / speed;
        let steps = (period / H).round() as u32;
        let quantum = number(input, "q");
        let (mut contour_max, mut contour_sum, mut follow_max, mut count) = (0.0f64, 0.0, 0.0f64, 0.0);
        for k in 0..(end / period) as usize {
            let t = k as f64 * period;
            let reference = circle(radius, speed, t);
            for ((axis, state), setpoint) in axes.iter_mut().zip(&mut states).zip(&reference) {
                let read = (axis.at_tool() / quantum + 0.5).floor() * quantum;
                let command = pid.step(state, setpoint, read, 0.0).expect("finite inputs");
                axis.run(command, steps);
            }
            if t > ramp + 0.4 {
                let [x, y] = [axes[0].at_tool(), axes[1].at_tool()];
                let contour = (x.hypot(y) - radius).abs();
                let target = circle(radius, speed, t + period);
                let follow = (x - target[0].position).hypot(y - target[1].position);
                contour_max = contour_max.max(contour);
                contour_sum += contour * contour;
                follow_max = follow_max.max(follow);
                count += 1.0;
            }
        }
        let contour_rms = (contour_sum / count).sqrt();
        let out = &case["out"];
        near(
            case,
            "contour_max",
            contour_max,
            number(out, "contour_max_ref"),
            golden.tolerance,
        );
        near(
            case,
            "contour_rms",
            contour_rms,
            number(out, "contour_rms_ref"),
            golden.tolerance,
        );
        near(
            case,
            "follow_max",
            follow_max,
            number(out, "follow_max_ref"),
            golden.tolerance,
        );
    }
}
