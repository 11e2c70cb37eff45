//! One motor is excited and captured: what comes back is the drive's response, and everything that ends it does so at once.

use super::bench::{Bench, FULL_SPEED, SCALE, TRAVEL_MAX, Y};
use shared::io::{ESTOP_CHANNELS, MotionCommand};
use shared::motion::Chirp;
use shared::parameter::ParameterError;
use shared::protocol::{
    CAPTURE_TICKS, CapturePart, CaptureSample, CaptureState, Excitation, ExcitationEnd, Excited, Refusal,
    Request, Response,
};
use shared::state::{Fault, State};
use shared::ticks::SERVO_PERIOD_S;
use std::f64::consts::PI;

/// Y, with 3 mm/s from 5 to 400 Hz: 0.1 mm at the lowest.
const ASKED: Excitation = Excitation {
    motor: Y as u8,
    excited: Excited::Command,
    amplitude: 3.0,
    from_hz: 5.0,
    to_hz: 400.0,
    settle_periods: 2,
    way: 0.0,
    max_travel: 1.0,
    max_speed: 50.0,
};

/// Homed, and in the middle of the travel of Y.
fn bench() -> Bench {
    let mut bench = Bench::homed();
    bench.load_line(300.0);
    bench.run();
    bench.run_ms(1);
    bench.until(State::Idle, 10_000);
    bench
}

fn part(bench: &mut Bench, from: u16) -> CapturePart {
    match bench.controller.handle(&Request::ReadCapture { from }, 0) {
        Response::Captured(part) => part,
        other => panic!("{other:?}"),
    }
}

/// Runs for `ms` with a PC that is alive.
fn run_alive(bench: &mut Bench, ms: u32) {
    for _ in 0..ms / 50 {
        bench.status();
        bench.run_ms(50);
    }
}

fn captured(bench: &mut Bench) -> Vec<CaptureSample> {
    let mut samples = Vec::new();
    loop {
        let part = part(bench, samples.len() as u16);
        assert_eq!(part.state, CaptureState::Complete);
        if part.samples.is_empty() {
            return samples;
        }
        samples.extend(part.samples);
    }
}

fn ended(bench: &mut Bench) -> ExcitationEnd {
    match part(bench, 0).state {
        CaptureState::Ended(end) => end,
        other => panic!("{other:?}"),
    }
}

/// Line `line` of the spectrum.
fn spectrum(values: &[f64], line: u32) -> (f64, f64) {
    let mut sum = (0.0, 0.0);
    for (k, value) in values.iter().enumerate() {
        let angle = 2.0 * PI * f64::from(line) * k as f64 / CAPTURE_TICKS as f64;
        sum.0 += value * angle.cos();
        sum.1 -= value * angle.sin();
    }
    sum
}

#[test]
fn what_is_captured_is_the_response_of_the_drive() {
    for (excited, amplitude, max_speed) in [(Excited::Command, 3.0, 50.0), (Excited::Reference, 0.02, 60.0)] {
        let mut bench = bench();
        let stood = bench.position[Y];
        bench.done(&Request::Excite(Excitation {
            excited,
            amplitude,
            max_speed,
            ..ASKED
        }));
        run_alive(&mut bench, 1700);
        let samples = captured(&mut bench);
        assert_eq!(samples.len(), CAPTURE_TICKS);
        let told: Vec<f64> = samples
            .iter()
            .map(|s| f64::from(s.command) / 32767.0 * FULL_SPEED)
            .collect();
        let seen: Vec<f64> = samples.iter().map(|s| f64::from(s.counts) / SCALE).collect();
        let error: Vec<f64> = samples.iter().map(|s| f64::from(s.error)).collect();
        // Every sample by itself: the loop is P with 100/s, and the reference stands still, at a part of a count.
        let chirp = Chirp::new(ASKED.from_hz, ASKED.to_hz);
        for k in 0..CAPTURE_TICKS {
            let shaken = amplitude * chirp.at(k as u32);
            let (seen, step) = match excited {
                Excited::Command => (told[k] - 100.0 * error[k], 0.008 + 2.0 * FULL_SPEED / 65535.0),
                Excited::Reference => (error[k] + seen[k] - (error[0] + seen[0]), 1.1e-4),
            };
            assert!((seen - shaken).abs() < step, "{k}: {seen} {shaken}");
        }
        let (first, last) = chirp.lines();
        for line in (first + 3..last - 3).step_by(7) {
            // The drives of the bench integrate: y(k + 1) = y(k) + T·u(k), so y/u = T·e^{−jωT/2}/(2j·sin(ωT/2)).
            let angle = 2.0 * PI * f64::from(line) / CAPTURE_TICKS as f64;
            let (u, y) = (spectrum(&told, line), spectrum(&seen, line));
            let gain = y.0.hypot(y.1) / u.0.hypot(u.1);
            let expected = SERVO_PERIOD_S / (2.0 * (angle / 2.0).sin());
            let hz = f64::from(line) * Chirp::LINE_HZ;
            assert!((gain / expected - 1.0).abs() < 0.05, "{hz} Hz: {gain} {expected}");
            let phase = y.1.atan2(y.0) - u.1.atan2(u.0) + PI / 2.0 + angle / 2.0;
            assert!((phase / 2.0).sin().abs() < 0.025, "{hz} Hz: {phase}");
            // The loop is P with 100/s, so its error answers in the command.
            let e = spectrum(&error, line);
            if excited == Excited::Reference {
                let loop_gain = u.0.hypot(u.1) / e.0.hypot(e.1);
                assert!((loop_gain / 100.0 - 1.0).abs() < 0.05, "{hz} Hz: {loop_gain}");
            }
        }
        bench.run_ms(100);
        assert_eq!(bench.status().state, State::Idle);
        assert!(
            (bench.position[Y] - stood).abs() < 2e-3,
            "{}",
            bench.position[Y] - stood
        );
    }
}

#[test]
fn nothing_is_there_before_and_parts_continue_one_another() {
    let mut bench = bench();
    assert_eq!(part(&mut bench, 0), CapturePart::default());
    bench.done(&Request::Excite(ASKED));
    bench.run_ms(20);
    let begun = part(&mut bench, 0);
    assert_eq!((begun.state, begun.taken), (CaptureState::Running, 0));
    run_alive(&mut bench, 1700);
    let [first, second] = [0, 10].map(|from| part(&mut bench, from));
    assert_eq!(first.samples[10..], second.samples[..first.samples.len() - 10]);
    assert!(part(&mut bench, u16::MAX).samples.is_empty());
    // A second one begins anew.
    bench.done(&Request::Excite(ASKED));
    run_alive(&mut bench, 1700);
    assert_eq!(captured(&mut bench).len(), CAPTURE_TICKS);
}

#[test]
fn it_ends_where_the_motor_goes_too_far_or_too_fast() {
    let mut bench = bench();
    bench.done(&Request::Excite(Excitation {
        max_travel: 0.15,
        ..ASKED
    }));
    bench.run_ms(30);
    let stood = bench.position[Y];
    // Someone leans on the axis, which the loop holds.
    for _ in 0..12 {
        bench.position[Y] += 0.02;
        bench.servo_tick();
    }
    assert_eq!(ended(&mut bench), ExcitationEnd::Travel);
    run_alive(&mut bench, 500);
    assert_eq!(bench.status().state, State::Idle);
    assert!((bench.position[Y] - stood).abs() < 0.15, "it does not go on");
    let told: Vec<_> = (0..200)
        .map(|_| {
            bench.servo_tick();
            bench.command.dac[Y]
        })
        .collect();
    assert!(told.iter().all(|code| code.0.abs() <= 1), "{told:?}");

    bench.done(&Request::Excite(Excitation {
        max_speed: 4.0,
        ..ASKED
    }));
    bench.run_ms(30);
    for _ in 0..10 {
        bench.position[Y] += 0.01;
        bench.servo_tick();
    }
    bench.run_ms(2);
    assert_eq!(ended(&mut bench), ExcitationEnd::Speed);
    assert_eq!(bench.status().state, State::Idle);
}

#[test]
fn it_ends_at_once_when_asked_and_with_whatever_switches_the_drives_off() {
    let mut bench = bench();
    bench.done(&Request::Excite(ASKED));
    bench.run_ms(30);
    bench.done(&Request::EndExcitation);
    assert_eq!(ended(&mut bench), ExcitationEnd::Asked);
    bench.run_ms(200);
    assert!(bench.command.dac[Y].0.abs() <= 1);
    // A PC that falls silent, as on a path: 500 ms.
    bench.done(&Request::Excite(ASKED));
    bench.run_ms(510);
    assert_eq!(bench.command, MotionCommand::SAFE);
    assert!(
        matches!(bench.fault(), Some(Fault::LinkLost { .. })),
        "{:?}",
        bench.fault()
    );
    assert_eq!(ended(&mut bench), ExcitationEnd::DrivesOff);

    let mut bench = self::bench();
    bench.done(&Request::Excite(ASKED));
    bench.run_ms(30);
    bench.controller.session_ended();
    bench.run_ms(2);
    assert_eq!(bench.command, MotionCommand::SAFE);
    assert_eq!(bench.fault(), Some(Fault::SessionEnded));

    let mut bench = self::bench();
    bench.done(&Request::Excite(ASKED));
    bench.run_ms(30);
    bench.inputs.estop = [true; ESTOP_CHANNELS];
    bench.servo_tick();
    assert_eq!(bench.command, MotionCommand::SAFE);
    bench.run_ms(2);
    assert_eq!(ended(&mut bench), ExcitationEnd::DrivesOff);
}

#[test]
fn lost_ticks_end_it() {
    let mut bench = bench();
    bench.done(&Request::Excite(ASKED));
    bench.run_ms(30);
    bench.servo_tick_after(2);
    bench.run_ms(3);
    assert_eq!(ended(&mut bench), ExcitationEnd::Gap);
}

#[test]
fn nothing_else_moves_meanwhile_and_it_needs_a_machine_at_rest() {
    let mut bench = Bench::configured();
    assert_eq!(
        bench.refused(&Request::Excite(ASKED)),
        Refusal::WrongState { state: State::Off }
    );
    let mut bench = self::bench();
    bench.done(&Request::Excite(ASKED));
    for request in [
        Request::Home,
        Request::Run,
        Bench::begin_request(shared::trajectory::PathSpace::Tool),
        Request::Excite(ASKED),
    ] {
        assert_eq!(bench.refused(&request), Refusal::Exciting);
    }
    run_alive(&mut bench, 1700);
    bench.load_line(100.0);
    bench.run();
    bench.run_ms(100);
    assert_eq!(
        bench.refused(&Request::Excite(ASKED)),
        Refusal::WrongState {
            state: State::Running
        }
    );
}

/// So that a gantry turns round as it does on a path, and its beam is not racked.
#[test]
fn both_motors_of_a_gantry_are_excited_alike() {
    let [x1, x2] = [0, 1];
    for (excited, amplitude) in [(Excited::Reference, 0.8), (Excited::Command, 10.0)] {
        let mut bench = bench();
        let stood = bench.position;
        bench.done(&Request::Excite(Excitation {
            motor: x1 as u8,
            excited,
            amplitude,
            from_hz: 2.0,
            to_hz: 2.0,
            ..ASKED
        }));
        let mut farthest = [0.0_f64; 2];
        for _ in 0..30 {
            bench.status();
            bench.run_ms(50);
            for motor in [x1, x2] {
                farthest[motor] = farthest[motor].max((bench.position[motor] - stood[motor]).abs());
            }
        }
        assert_eq!(bench.fault(), None, "{excited:?}");
        // The skew trips at 0.3 mm.
        assert!(farthest[x1] > 0.05, "{excited:?}: {farthest:?}");
        assert!(
            (farthest[x1] - farthest[x2]).abs() < 0.1 * farthest[x1],
            "{excited:?}: {farthest:?}"
        );
    }
}

#[test]
fn what_would_end_it_at_once_is_refused() {
    let mut bench = bench();
    let mut refused = |field: &str, value: f64, asked: Excitation| {
        let refusal = bench.refused(&Request::Excite(asked));
        assert_eq!(
            refusal,
            Refusal::Excitation(ParameterError::new("Y", field, value))
        );
        assert!(refusal.to_string().contains("must be from"), "{refusal}");
    };
    for amplitude in [0.0, -1.0, f64::NAN, 51.0] {
        refused(
            "excitation.amplitude",
            amplitude,
            Excitation { amplitude, ..ASKED },
        );
    }
    // At 5 Hz 3 mm/s are 0.095 mm.
    refused(
        "excitation.amplitude",
        3.0,
        Excitation {
            max_travel: 0.09,
            ..ASKED
        },
    );
    let reference = Excitation {
        excited: Excited::Reference,
        amplitude: 0.05,
        ..ASKED
    };
    // 0.05 mm at 400 Hz are 126 mm/s.
    refused("excitation.amplitude", 0.05, reference);
    for from_hz in [0.0, 1.0, 2000.0, f64::INFINITY] {
        refused("excitation.from_hz", from_hz, Excitation { from_hz, ..ASKED });
    }
    for to_hz in [4.0, 1001.0] {
        refused("excitation.to_hz", to_hz, Excitation { to_hz, ..ASKED });
    }
    for max_speed in [0.0, 301.0] {
        refused(
            "excitation.max_speed",
            max_speed,
            Excitation { max_speed, ..ASKED },
        );
    }
    for max_travel in [0.0, 5.1, TRAVEL_MAX] {
        refused(
            "excitation.max_travel",
            max_travel,
            Excitation { max_travel, ..ASKED },
        );
    }
    for (settle_periods, value) in [(0, 0.0), (11, 11.0)] {
        refused(
            "excitation.settle_periods",
            value,
            Excitation {
                settle_periods,
                ..ASKED
            },
        );
    }
    let nobody = Excitation { motor: 7, ..ASKED };
    assert_eq!(
        bench.refused(&Request::Excite(nobody)),
        Refusal::NoSuchMotor { motor: 7 }
    );
}
