//! Every machine on its board: it homes, and holds its tool on a path as its work asks.

use super::bench::{Bench, config_of};
use cam::path::TOLERANCE;
use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::io::{AXES, DacCode, MOTOR_AXIS, MOTORS};
use shared::kinematics::AXIS_UNIT;
use shared::protocol::{PathElement, PathLimits, Request};
use shared::state::State;
use shared::trajectory::{CHANNELS, Cubic, Element, Join, Knot, PathSpace, SHAPED, Shape};
use std::f64::consts::TAU;

#[test]
fn every_machine_homes_and_commands_no_motor_it_does_not_have() {
    for name in plant_file::names() {
        let motors = config_of(name).motors.map(|motor| motor.is_some());
        let mut bench = Bench::configured_as(name);
        bench.done(&Request::Home);
        for elapsed in 0..20_000 {
            bench.run_ms(1);
            let commanded = bench.board.command.dac;
            for motor in (0..MOTORS).filter(|motor| !motors[*motor]) {
                assert_eq!(commanded[motor], DacCode::ZERO, "{name}, motor {motor}");
            }
            let status = if elapsed % 100 == 0 {
                bench.status()
            } else {
                continue;
            };
            assert_ne!(status.state, State::Fault, "{name}: {:?}", status.fault);
            if status.state == State::Idle {
                break;
            }
        }
        bench.run_ms(200);
        let status = bench.status();
        assert!(status.homed && status.state == State::Idle, "{name}: {status:?}");
        let truth = bench.board.plant.truth();
        // X1 stands for X; a few counts.
        for axis in 0..AXES {
            let motor = (0..MOTORS).find(|motor| MOTOR_AXIS[*motor] == axis).expect("one");
            let true_position = truth[motor] / AXIS_UNIT[axis];
            let off = (status.axes[axis] - true_position).abs();
            assert!(off < 0.002, "{name}, axis {axis}: {off}");
            assert!(motors[motor] || status.axes[axis] == 0.0, "{name}, axis {axis}");
        }
    }
}

/// Most of a circle about the Z of the work frame, with an attitude that turns with it.
struct Circle {
    /// Its middle \[mm\].
    centre: [f64; 3],
    /// Its radius \[mm\].
    radius: f64,
    /// Where it begins, from X \[deg\].
    start: f64,
    /// Where C stands at its beginning \[deg\].
    c: f64,
    /// N by its parts outwards, along the travel and up.
    normal: [f64; 3],
    /// Speed of the tip \[mm/s\].
    speed: f64,
}

impl Circle {
    /// 300 degrees: no axis has to turn once around.
    fn length(&self) -> f64 {
        TAU * self.radius * 300.0 / 360.0
    }

    /// Pose after `s` mm, with its derivatives over s: everything turns about Z by 1/radius.
    fn knot(&self, s_mm: f64) -> Knot {
        let (sin, cos) = (self.start.to_radians() + s_mm / self.radius).sin_cos();
        let out = Vector3::new(cos, sin, 0.0);
        let along = Vector3::new(-sin, cos, 0.0);
        let [a, b, c] = self.normal;
        let normal = (out * a + along * b + Vector3::z() * c).normalize();
        let tangent = (along - normal * along.dot(&normal)).normalize();
        let position = Vector3::from(self.centre) + out * self.radius;
        let turn = |v: &Vector3<f64>| Vector3::z().cross(v) / self.radius;
        let mut value = [0.0; CHANNELS];
        let mut slope = [0.0; CHANNELS];
        for (place, vector, derivative) in [
            (0, position, along),
            (3, tangent, turn(&tangent)),
            (6, normal, turn(&normal)),
        ] {
            value[place..place + 3].copy_from_slice(vector.as_slice());
            slope[place..place + 3].copy_from_slice(derivative.as_slice());
        }
        Knot { s_mm, value, slope }
    }

    fn pose(&self, s_mm: f64) -> Pose {
        let value = self.knot(s_mm).value;
        let vector = |place: usize| Vector3::new(value[place], value[place + 1], value[place + 2]);
        Pose {
            position: vector(0),
            tangent: vector(3),
            normal: vector(6),
        }
    }

    /// How far `position` is from it \[mm\].
    fn off(&self, position: &Vector3<f64>) -> f64 {
        let from = position - Vector3::from(self.centre);
        (from.xy().norm() - self.radius).hypot(from.z)
    }
}

/// Runs through `knots` at one speed, with a path acceleration.
fn run(bench: &mut Bench, space: PathSpace, knots: &[Knot], speed_mm_s: f64, acceleration_mm_s2: f64) {
    bench.done(&Request::BeginPath {
        id: 1,
        space,
        start_s_mm: 0.0,
        limits: PathLimits {
            acceleration_mm_s2,
            jerk_mm_s3: 20.0 * acceleration_mm_s2,
            tolerance_mm: 1e-4 * acceleration_mm_s2,
        },
    });
    let spans = knots.windows(2).enumerate();
    for (i, span) in spans {
        let (from, to) = (&span[0], &span[1]);
        let length = to.s_mm - from.s_mm;
        let end = |knot: &Knot, i: usize| [knot.value[i], knot.slope[i]];
        let channel = |i: usize| Cubic::hermite(end(from, i), end(to, i), length);
        let last = i + 2 == knots.len();
        let element = Element {
            line: i as u32,
            shape: Shape::Span(std::array::from_fn(channel)),
            rest: std::array::from_fn(|i| channel(SHAPED + i)),
            length,
            feed: speed_mm_s,
            join: if last { Join::Stop } else { Join::Blend(TOLERANCE) },
        };
        bench.loaded(&Request::LoadElements {
            elements: [PathElement::from(&element)].into_iter().collect(),
            last,
        });
    }
    bench.done(&Request::Run);
    bench.until(State::Idle, 300_000);
}

/// Moves all axes of a machine together to `axes` (mm, rad), the slowest at half its speed.
fn go(bench: &mut Bench, name: &str, axes: &[f64; AXES]) {
    let reference = bench.status().reference;
    let from: [f64; AXES] = std::array::from_fn(|axis| reference[axis] * AXIS_UNIT[axis]);
    let limits = config_of(name).axes;
    let seconds = |axis: usize| {
        let speed = limits[axis]
            .as_ref()
            .map_or(f64::INFINITY, |limits| limits.max_velocity);
        (axes[axis] - from[axis]).abs() / (0.5 * speed * AXIS_UNIT[axis])
    };
    // s is time here, and the speed 1.
    let length = (0..AXES).map(seconds).fold(0.0, f64::max);
    let mut slope = [0.0; CHANNELS];
    for axis in 0..AXES {
        slope[axis] = (axes[axis] - from[axis]) / length;
    }
    let knots = [0.0, length].map(|s_mm| {
        let mut value = [0.0; CHANNELS];
        for axis in 0..AXES {
            value[axis] = from[axis] + slope[axis] * s_mm;
        }
        Knot { s_mm, value, slope }
    });
    run(bench, PathSpace::Axes, &knots, 1.0, 1.0);
}

/// Homes, goes to the beginning of `circle` and follows it; the largest distance of the true tip from it \[mm\],
/// and the largest angle between N and that of the circle there \[deg\].
fn follow(name: &str, circle: &Circle) -> [f64; 2] {
    let mut bench = Bench::configured_as(name);
    bench.done(&Request::Home);
    bench.until(State::Idle, 20_000);
    let machine = config_of(name).kinematics().expect("kinematics");
    let near = [0.0, 0.0, 0.0, 0.0, 0.0, circle.c.to_radians()];
    let start = machine
        .inverse(&circle.pose(0.0), &near)
        .expect("a pose in reach");
    go(&mut bench, name, &start);
    let knots: Vec<Knot> = (0..=90)
        .map(|k| circle.knot(circle.length() * f64::from(k) / 90.0))
        .collect();
    bench.samples.clear();
    run(
        &mut bench,
        PathSpace::Tool,
        &knots,
        circle.speed,
        2.0 * circle.speed,
    );

    let mut worst = [0.0_f64; 2];
    for sample in &bench.samples {
        let truth = sample.truth.expect("a simulated machine");
        let axes =
            std::array::from_fn(|axis| truth[MOTOR_AXIS.iter().position(|of| *of == axis).expect("a motor")]);
        let pose = machine.forward(&axes);
        let normal = circle.pose(sample.s_mm).normal;
        let angle = pose.normal.cross(&normal).norm().asin().to_degrees();
        worst = [worst[0].max(circle.off(&pose.position)), worst[1].max(angle)];
    }
    worst
}

#[test]
fn every_machine_holds_its_tool_on_a_circle_while_its_rotary_axes_turn() {
    let circles = [
        // Around a branch pipe.
        (
            "pipe-welder",
            Circle {
                centre: [0.0, 0.0, 158.0],
                radius: 40.0,
                start: 0.0,
                c: 0.0,
                normal: [0.755, 0.0, 0.656],
                speed: 5.0,
            },
        ),
        // The head swings around.
        (
            "ac-head",
            Circle {
                centre: [1500.0, 750.0, 50.0],
                radius: 50.0,
                start: 0.0,
                c: -270.0,
                normal: [0.5, 0.0, 0.866],
                speed: 50.0,
            },
        ),
        // The table turns under the torch.
        (
            "wire-arc",
            Circle {
                centre: [0.0, 0.0, 10.0],
                radius: 30.0,
                start: 0.0,
                c: 270.0,
                normal: [0.0, 0.0, 1.0],
                speed: 10.0,
            },
        ),
        // Leaning backwards by 2.5 degrees.
        (
            "stir-gantry",
            Circle {
                centre: [500.0, 500.0, 100.0],
                radius: 25.0,
                start: 100.0,
                c: -170.0,
                normal: [0.0, -0.04362, 0.99905],
                speed: 1.0,
            },
        ),
    ];
    for (name, circle) in circles {
        let [distance, angle] = follow(name, &circle);
        println!("{name}: {distance:.5} mm, {angle:.5} deg");
        assert!(
            distance < 0.01 && angle < 0.02,
            "{name}: {distance} mm, {angle} deg"
        );
    }
}
