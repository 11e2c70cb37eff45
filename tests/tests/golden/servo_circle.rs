//! Two closed loops on a circle, with the drive model of SPEC 0.11.

use crate::file::{golden, near, number};
use crate::servo::pid;
use serde_json::{Value, json};
use shared::control::{PidState, Setpoint};
use std::collections::VecDeque;

/// Step of the model \[s\].
const H: f64 = 50e-6;
/// Acceleration limit of the drive \[mm/s²\].
const DRIVE_ACCELERATION: f64 = 4000.0;
/// Tangential acceleration of the reference \[mm/s²\].
const START: f64 = 500.0;

/// A velocity drive with delay, bandwidth, Coulomb friction, backlash and a quantised scale on the load.
struct Axis {
    pipeline: VecDeque<f64>,
    omega: f64,
    friction: f64,
    backlash: f64,
    quantum: f64,
    integral: f64,
    velocity: f64,
    motor: f64,
    load: f64,
}

impl Axis {
    fn new(par: &Value, position: f64) -> Self {
        let delay = (number(par, "delay") / H).round() as usize;
        Self {
            pipeline: vec![0.0; delay + 1].into(),
            omega: 2.0 * std::f64::consts::PI * number(par, "fv"),
            friction: number(par, "fc"),
            backlash: number(par, "bl"),
            quantum: number(par, "q"),
            integral: 0.0,
            velocity: 0.0,
            motor: position,
            load: position,
        }
    }

    fn read(&self) -> f64 {
        (self.load / self.quantum + 0.5).floor() * self.quantum
    }

    fn step(&mut self, command: f64) {
        self.pipeline.push_back(command);
        let command = self.pipeline.pop_front().expect("never empty");
        let error = command - self.velocity;
        self.integral = (self.integral + self.omega * self.omega / 4.0 * error * H)
            .clamp(-DRIVE_ACCELERATION, DRIVE_ACCELERATION);
        let force = (self.omega * error + self.integral).clamp(-DRIVE_ACCELERATION, DRIVE_ACCELERATION)
            - self.velocity;
        if self.velocity == 0.0 {
            if force.abs() > self.friction {
                self.velocity = (force - force.signum() * self.friction) * H;
            }
        } else {
            let next = self.velocity + (force - self.velocity.signum() * self.friction) * H;
            let stuck = next * self.velocity < 0.0 && force.abs() <= self.friction;
            self.velocity = if stuck { 0.0 } else { next };
        }
        self.motor += self.velocity * H;
        self.load = self
            .load
            .clamp(self.motor - self.backlash / 2.0, self.motor + self.backlash / 2.0);
    }
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

#[test]
fn closed_loop_servo() {
    let golden = golden("closed_loop_servo");
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
        let mut axes = circle(radius, speed, 0.0).map(|start| Axis::new(input, start.position));
        let ramp = speed / START;
        let end = ramp + 3.2 * std::f64::consts::PI * radius / speed;
        let steps = (period / H).round() as usize;
        let (mut contour_max, mut contour_sum, mut follow_max, mut count) = (0.0f64, 0.0, 0.0f64, 0.0);
        for k in 0..(end / period) as usize {
            let t = k as f64 * period;
            let reference = circle(radius, speed, t);
            for ((axis, state), setpoint) in axes.iter_mut().zip(&mut states).zip(&reference) {
                let command = pid
                    .step(state, setpoint, axis.read(), 0.0)
                    .expect("finite inputs");
                for _ in 0..steps {
                    axis.step(command);
                }
            }
            if t > ramp + 0.4 {
                let [x, y] = [axes[0].load, axes[1].load];
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
