//! Machines whose motors deviate from what their gratings say, and tables of that.

use super::bench::{Bench, SCALE, TRAVEL_MAX, Y, config, load};
use core::f64::consts::PI;
use shared::config::{DEVIATION_POINTS, DEVIATION_POINTS_IN_ALL, DEVIATIONS, DeviationConfig};
use shared::io::AXES;
use shared::kinematics::AxisMotion;
use shared::motion::Machine;
use shared::protocol::{PathJoin, Refusal, Request, Response};
use shared::state::State;
use shared::trajectory::PathSpace;

const X1: usize = 0;
const X2: usize = 1;
const Z: usize = 3;
const C: usize = 6;

/// True deviations \[mm\] at a place along Y: of X1 and X2 unlike, of Y itself, and of Z.
fn true_deviation(motor: usize, y: f64) -> f64 {
    let wave = |period: f64, phase: f64| (2.0 * PI * y / period + phase).sin();
    match motor {
        X1 => 0.010 * wave(400.0, 0.3),
        X2 => 0.015 * wave(400.0, 0.0) - 0.005,
        Y => 20e-6 * (y - 500.0) + 0.004 * wave(250.0, 1.0),
        Z => 0.05 * wave(300.0, 2.0),
        _ => 0.0,
    }
}

fn table(motor: usize, axis: u8, from: f64, step: f64, of: impl Fn(f64) -> f64) -> DeviationConfig {
    DeviationConfig {
        axis,
        motor: motor as u8,
        from,
        step,
        values: (0..DEVIATION_POINTS)
            .map(|point| of(from + step * point as f64) as f32)
            .collect(),
    }
}

/// A machine, homed, that deviates along Y, with tables of that if it is `compensated`.
fn deviating(compensated: bool) -> Bench {
    let mut bench = Bench::configured();
    if compensated {
        for motor in [X1, X2, Y, Z] {
            let step = TRAVEL_MAX / (DEVIATION_POINTS - 1) as f64;
            let deviation = table(motor, 1, 0.0, step, |y| true_deviation(motor, y));
            bench.done(&Request::Compensate(deviation));
        }
    }
    bench.done(&Request::Home);
    bench.until(State::Idle, 5000);
    bench
}

/// Where a motor truly is, which says `reading`, with Y truly at `y`.
fn actual(motor: usize, reading: f64, y: f64) -> f64 {
    reading + true_deviation(motor, y)
}

/// Where Y truly is, of which the grating says `reading`.
fn actual_y(reading: f64) -> f64 {
    (0..5).fold(reading, |y, _| actual(Y, reading, y))
}

/// Largest distance of X1, X2 and Z from where they are when it begins, and of Y from what the board says, on a line of 200 mm
/// along Y.
fn worst_on_a_line(compensated: bool) -> [f64; 4] {
    let mut bench = deviating(compensated);
    bench.begin(PathSpace::Tool);
    let element = bench.along_y(0.0, 200.0, 100.0, PathJoin::Stop);
    bench.loaded(&load(element, true));
    bench.run();
    // The bench's frame: readings of what is moved are those of the homed machine.
    let frame: [f64; 4] = [X1, X2, Y, Z].map(|motor| bench.servo.take_report().offset[motor]);
    let mut first = None;
    let mut worst = [0.0_f64; 4];
    while bench.controller.state() != State::Idle {
        bench.run_ms(1);
        if bench.now_us.is_multiple_of(100_000) {
            bench.status();
        }
        let readings = [X1, X2, Y, Z].map(|motor| (bench.position[motor] * SCALE).floor() / SCALE);
        let y = actual_y(readings[2] + frame[2]);
        let now = [X1, X2, Z].map(|motor| actual(motor, bench.position[motor], y));
        let from = first.get_or_insert(now);
        for ((worst, now), from) in worst.iter_mut().zip(now).zip(*from) {
            *worst = worst.max((now - from).abs());
        }
    }
    bench.run_ms(100);
    let reading = (bench.position[Y] * SCALE).floor() / SCALE + frame[2];
    worst[3] = (bench.status().axes[1] - actual_y(reading)).abs();
    worst
}

#[test]
fn deviations_are_made_up_for_along_the_path_and_in_what_the_board_tells() {
    let plain = worst_on_a_line(false);
    assert!(plain.iter().all(|off| *off > 0.002), "{plain:?}");
    let compensated = worst_on_a_line(true);
    println!("{compensated:?}, without tables {plain:?}");
    // One count is 0.1 µm.
    assert!(compensated.iter().all(|off| *off < 0.0003), "{compensated:?}");
}

/// The bench's machine with tables between several axes and motors, rotary ones too.
fn crossed() -> Machine {
    let (mut machine, _) = Machine::build(&config()).unwrap();
    let waves = [
        (X1, 0, 0.2),
        (X2, 0, 0.1),
        (Y, 1, 0.3),
        (Z, 0, 0.15),
        (Z, 1, 0.25),
        (C, 5, 0.05),
        (C, 0, 0.02),
        (X1, 5, 0.1),
    ];
    for (motor, axis, amplitude) in waves {
        let (from, step) = if axis < 3 { (-5.0, 16.1) } else { (-91.0, 2.9) };
        let wave = |x: f64| amplitude * (2.0 * PI * x / (40.0 * step) + motor as f64).sin();
        machine.compensate(&table(motor, axis, from, step, wave)).unwrap();
    }
    machine
}

fn somewhere(seed: u32) -> AxisMotion {
    let part = |k: u32| f64::from(seed.wrapping_mul(2_654_435_761).rotate_left(5 * k)) / f64::from(u32::MAX);
    let numbers = |linear: f64, rotary: f64, k: u32| -> [f64; AXES] {
        core::array::from_fn(|axis| {
            let part = part(k + axis as u32);
            if axis < 3 {
                linear * part
            } else {
                rotary * (2.0 * part - 1.0)
            }
        })
    };
    AxisMotion {
        position: numbers(TRAVEL_MAX, 1.5, 0),
        velocity: numbers(200.0, 1.0, 2),
        acceleration: numbers(1000.0, 5.0, 3),
    }
}

#[test]
fn axes_and_motors_are_each_others_inverse() {
    let machine = crossed();
    for seed in 1..2000 {
        let motion = somewhere(seed);
        let back = machine.axes(&machine.motors(&motion).position);
        for (axis, (there, back)) in motion.position.into_iter().zip(back).enumerate() {
            assert!((there - back).abs() < 1e-8, "axis {axis}: {there} {back}");
        }
    }
}

#[test]
fn velocities_of_motors_are_the_change_of_their_positions() {
    let machine = crossed();
    const H: f64 = 1e-6;
    for seed in 1..2000 {
        let motion = somewhere(seed);
        let after = |time: f64| {
            let mut later = motion;
            for (position, velocity) in later.position.iter_mut().zip(motion.velocity) {
                *position += velocity * time;
            }
            machine.motors(&later).position
        };
        let (before, later) = (after(-H), after(H));
        let velocity = machine.motors(&motion).velocity;
        for motor in 0..velocity.len() {
            let change = (later[motor] - before[motor]) / (2.0 * H);
            assert!(
                (velocity[motor] - change).abs() < 1e-4,
                "motor {motor}: {} {change}",
                velocity[motor]
            );
        }
    }
}

#[test]
fn tables_go_on_as_they_are_at_their_ends() {
    let (mut machine, _) = Machine::build(&config()).unwrap();
    let deviation = table(Z, 1, 100.0, 1.0, |y| (y - 90.0) / 500.0);
    machine.compensate(&deviation).unwrap();
    let off = |y: f64| {
        -machine
            .motors(&AxisMotion::at_rest(&[0.0, y, 0.0, 0.0, 0.0, 0.0]))
            .position[Z]
    };
    for (y, expected) in [
        (-20.0, 0.02),
        (100.0, 0.02),
        (110.25, 0.0405),
        (163.0, 0.146),
        (900.0, 0.146),
    ] {
        // Kept to 0.03 µm.
        assert!((off(y) - expected).abs() < 2e-5, "{y}: {} {expected}", off(y));
        assert!((deviation.at(y) - expected).abs() < 1e-8, "{y}");
    }
}

#[test]
fn tables_that_make_no_sense_are_refused_by_name() {
    let mut bench = Bench::new();
    let good = table(Y, 1, 0.0, 10.0, |_| 0.001);
    let refused = bench.refused(&Request::Compensate(good.clone()));
    assert_eq!(refused, Refusal::NotConfigured);
    bench.done(&Request::ConfigureMotion(config()));
    bench.run_ms(3);
    bench.done(&Request::Compensate(good.clone()));
    let with = |change: fn(&mut DeviationConfig)| {
        let mut config = good.clone();
        change(&mut config);
        Request::Compensate(config)
    };
    for (bad, said) in [
        (with(|_| {}), "deviation.axis of Y is 1"),
        (with(|bad| bad.motor = 9), "deviation.motor of kinematics is 9"),
        (with(|bad| bad.axis = 6), "deviation.axis of Y is 6"),
        (
            with(|bad| bad.step = 0.0),
            "deviation.step of Y is 0, but must be above 0",
        ),
        (with(|bad| bad.from = f64::NAN), "deviation.from of Y is NaN"),
        (
            with(|bad| bad.values.truncate(1)),
            "deviation.values of Y is 1, but must be from 2 to 64",
        ),
        (
            with(|bad| bad.values[3] = 1.5),
            "deviation.values of Y is 1.5, but must be from -1 to 1",
        ),
        (
            with(|bad| bad.values[3] = 0.2),
            "deviation.values of Y is 0.2, but must be from -0.099 to 0.101",
        ),
        (
            with(|bad| bad.values[3] = f32::NAN),
            "deviation.values of Y is NaN",
        ),
    ] {
        match bench.refused(&bad) {
            Refusal::Parameter(error) => assert!(error.to_string().starts_with(said), "{error}"),
            other => panic!("{said}: {other:?}"),
        }
    }
    bench.done(&Request::Home);
    bench.run_ms(3);
    let refused = bench.refused(&Request::Compensate(good));
    assert_eq!(refused, Refusal::WrongState { state: State::Homing });
}

#[test]
fn there_is_room_for_so_many_tables_and_so_many_points() {
    for (points, room) in [
        (DEVIATION_POINTS, DEVIATION_POINTS_IN_ALL / DEVIATION_POINTS),
        (2, DEVIATIONS),
    ] {
        let mut bench = Bench::configured();
        let mut taken = 0;
        for (motor, axis) in (0..7).flat_map(|motor| (0..3).map(move |axis| (motor, axis))) {
            let mut deviation = table(motor, axis, 0.0, 10.0, |_| 0.001);
            deviation.values.truncate(points);
            match bench.controller.handle(&Request::Compensate(deviation), 0) {
                Response::Done => taken += 1,
                refused => assert!(matches!(refused, Response::Refused(Refusal::Parameter(_)))),
            }
        }
        assert_eq!(taken, room);
        // New parameters are those of a machine without any.
        bench.done(&Request::ConfigureMotion(config()));
        bench.done(&Request::Compensate(table(C, 0, 0.0, 10.0, |_| 0.001)));
    }
}
