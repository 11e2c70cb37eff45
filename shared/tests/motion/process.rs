//! Outputs and inputs of the process: switched at their places, led over the path, off when the machine is.

use super::bench::{BLEND, Bench, config};
use shared::config::{AnalogConfig, MotionConfig, OutputConfig, ProcessInputConfig};
use shared::io::{Bits, HeldLines};
use shared::protocol::{Channel, PathAction, PathEvent, PathJoin, Refusal, Request};
use shared::state::{Fault, State};
use shared::trajectory::PathSpace;

const GAS: u8 = 0;
/// It follows beam 1.
const WIRE: u8 = 1;
const FEED_MM_S: f64 = 80.0;
/// Of the path.
const LENGTH: f64 = 120.0;

fn with_outputs() -> MotionConfig {
    let mut config = config();
    let follows_beam = Some(0);
    config.process.outputs[usize::from(GAS)] = Some(OutputConfig { follows_beam: None });
    config.process.outputs[usize::from(WIRE)] = Some(OutputConfig { follows_beam });
    config.process.analog[0] = Some(AnalogConfig {
        value_at_10v: 20.0,
        follows_beam,
    });
    config
}

fn event(s_mm: f64, action: PathAction) -> PathEvent {
    PathEvent { s_mm, action }
}

fn beam(on: bool) -> PathAction {
    PathAction::Beam { side: 0, on }
}

fn output(output: u8, on: bool) -> PathAction {
    PathAction::Output { output, on }
}

fn level(channel: Channel, value: f64, over_mm: f64) -> PathAction {
    PathAction::Level {
        channel,
        value,
        over_mm,
    }
}

/// Loads a line of [`LENGTH`] along Y with `events`.
fn load(bench: &mut Bench, events: &[PathEvent]) {
    bench.begin(PathSpace::Tool);
    let halves = [(0.0, LENGTH / 2.0, BLEND), (LENGTH / 2.0, LENGTH, PathJoin::Stop)];
    for (from, to, join) in halves {
        let element = bench.along_y(from, to, FEED_MM_S, join);
        bench.loaded(&super::bench::load(element, to == LENGTH));
    }
    bench.loaded(&Request::LoadEvents(events.iter().copied().collect()));
}

const WELD: [(f64, PathAction); 10] = [
    (
        0.0,
        PathAction::Output {
            output: GAS,
            on: true,
        },
    ),
    (
        0.0,
        PathAction::Output {
            output: WIRE,
            on: true,
        },
    ),
    (
        0.0,
        PathAction::Level {
            channel: Channel::Power(0),
            value: 1000.0,
            over_mm: 0.0,
        },
    ),
    (
        0.0,
        PathAction::Level {
            channel: Channel::Analog(0),
            value: 5.0,
            over_mm: 0.0,
        },
    ),
    (30.0137, PathAction::Beam { side: 0, on: true }),
    (
        30.0137,
        PathAction::Level {
            channel: Channel::Power(0),
            value: 3000.0,
            over_mm: 20.0,
        },
    ),
    (60.0611, PathAction::Beam { side: 0, on: false }),
    (60.0911, PathAction::Beam { side: 0, on: true }),
    (
        90.0223,
        PathAction::Output {
            output: GAS,
            on: false,
        },
    ),
    (90.0449, PathAction::Beam { side: 0, on: false }),
];

fn weld(bench: &mut Bench) {
    load(bench, &WELD.map(|(s, action)| event(s, action)));
    bench.run();
}

/// Runs as with a PC that is there.
fn run_ms(bench: &mut Bench, ms: u32) {
    for _ in 0..ms {
        bench.run_ms(1);
        bench.status();
    }
}

#[test]
fn lines_are_switched_within_microseconds_of_their_places() {
    let mut bench = Bench::homed_as(with_outputs());
    weld(&mut bench);
    let mut lines = HeldLines::NONE;
    let mut seen = Vec::new();
    let begin = bench.samples.len();
    for _ in 0..4 * 2500 {
        bench.servo_tick();
        bench.status();
        lines.set(bench.command.lines(), 0);
        bench
            .command
            .changes
            .iter()
            .for_each(|change| lines.set(change.lines, change.after_us));
        let switched = lines.take();
        seen.extend(
            switched
                .iter()
                .map(|one| (one.line, one.on, bench.now_us + u64::from(one.at_us))),
        );
    }
    let samples = &bench.samples[begin..];
    let place = |time_us: u64| {
        let after = samples.partition_point(|sample| sample.time_us <= time_us);
        let [a, b] = [&samples[after - 1], &samples[after]];
        a.s_mm + (b.s_mm - a.s_mm) * (time_us - a.time_us) as f64 / 1000.0
    };
    // Gate, gas and wire are lines 0, 2 and 3; the wire has the places of the gate. The gas goes on at rest.
    let places = [30.0137, 60.0611, 60.0911, 90.0449];
    for (line, wanted) in [(0, &places[..]), (3, &places[..]), (2, &[0.0, 90.0223][..])] {
        let found: Vec<_> = seen.iter().filter(|(own, ..)| *own == line).collect();
        assert_eq!(found.len(), wanted.len(), "line {line}: {found:?}");
        for (k, ((_, on, time_us), wanted)) in found.iter().zip(wanted).enumerate() {
            let off_us = (place(*time_us) - wanted) / FEED_MM_S * 1e6;
            assert!(
                *on == (k % 2 == 0) && (off_us.abs() < 2.0 || *wanted == 0.0),
                "line {line} at {wanted}: {off_us} us"
            );
        }
    }
}

#[test]
fn levels_are_led_over_the_path_and_0_where_their_beam_is_shut() {
    let mut bench = Bench::homed_as(with_outputs());
    weld(&mut bench);
    let mut on_ramp = 0;
    for _ in 0..2500 {
        run_ms(&mut bench, 1);
        let s = bench.samples.last().unwrap().s_mm;
        let power = bench.command.beam_power[0].ratio() * 4000.0;
        let wire = bench.command.analog[0].ratio() * 20.0;
        if !bench.command.beam_gate[0] {
            continue;
        }
        // The command of a tick is for the place after it.
        let wanted = 1000.0 + 2000.0 * ((s - 30.0137) / 20.0).clamp(0.0, 1.0);
        assert!(
            (power - wanted).abs() < 2000.0 / 20.0 * 0.1,
            "{power} W at {s}, and not {wanted}"
        );
        assert!((wire - 5.0).abs() < 0.001);
        on_ramp += u32::from((31.0..49.0).contains(&s));
    }
    assert!(on_ramp > 200);
    assert_eq!((bench.command.beam_power[0].0, bench.command.analog[0].0), (0, 0));
}

#[test]
fn in_a_hold_gas_flows_on_and_wire_stops_and_a_stop_ends_both() {
    for (stop, flows) in [(Request::Hold, true), (Request::Stop, false)] {
        let mut bench = Bench::homed_as(with_outputs());
        weld(&mut bench);
        run_ms(&mut bench, 800);
        assert_eq!(
            (bench.command.outputs, bench.command.beam_gate[0]),
            (Bits(0b11), true)
        );
        bench.done(&stop);
        run_ms(&mut bench, 1500);
        assert_eq!(bench.command.outputs, Bits(u8::from(flows)), "{stop:?}");
    }
}

#[test]
fn outputs_stay_from_path_to_path_and_end_with_the_drives_or_the_session() {
    let gas_on = |bench: &mut Bench| {
        load(bench, &[event(0.0, output(GAS, true))]);
        bench.run();
        bench.until(State::Idle, 5000);
        bench.run_ms(5);
        assert_eq!(bench.command.outputs, Bits(1));
    };
    let mut bench = Bench::homed_as(with_outputs());
    gas_on(&mut bench);
    bench.controller.session_ended();
    bench.run_ms(3);
    assert!(bench.command.enable && bench.command.outputs == Bits::NONE);
    bench = Bench::homed_as(with_outputs());
    gas_on(&mut bench);
    bench.inputs.estop = [true; 2];
    bench.servo_tick();
    assert!(!bench.command.enable && bench.command.outputs == Bits::NONE);
}

#[test]
fn an_answer_that_is_missing_stops_the_machine_in_its_time() {
    let mut config = with_outputs();
    config.process.inputs[2] = Some(ProcessInputConfig {
        answers: 0,
        within_ms: 40,
    });
    let mut bench = Bench::homed_as(config);
    bench.inputs.process = Bits(0b100);
    weld(&mut bench);
    run_ms(&mut bench, 800);
    assert!(bench.command.beam_gate[0] && bench.status().state == State::Running);
    bench.inputs.process = Bits::NONE;
    run_ms(&mut bench, 38);
    assert!(bench.command.beam_gate[0]);
    run_ms(&mut bench, 6);
    assert!(!bench.command.beam_gate[0]);
    bench.until(State::Fault, 2000);
    let fault = bench.fault().unwrap();
    assert_eq!(
        fault,
        Fault::NoAnswer {
            input: 2,
            line: 0,
            within_ms: 40
        }
    );
    assert_eq!(
        fault.to_string(),
        "input 3 did not come within 40 ms while beam 1 was on, and the machine stopped: look at what it reports, and its cable"
    );
}

#[test]
fn what_the_machine_does_not_have_is_refused() {
    let mut bench = Bench::homed_as(with_outputs());
    load(&mut bench, &[]);
    for action in [
        output(2, true),
        output(8, true),
        level(Channel::Analog(1), 1.0, 0.0),
        level(Channel::Analog(0), 20.5, 0.0),
        level(Channel::Analog(7), 0.0, 0.0),
        level(Channel::Power(0), -1.0, 0.0),
        level(Channel::Power(0), 1.0, f64::NAN),
        PathAction::BySpeed {
            channel: Channel::Power(0),
            full_mm_s: 10.0,
            least: 1.5,
        },
        PathAction::AtRest { side: 2, ms: 1 },
        PathAction::AtRest { side: 0, ms: 60_001 },
    ] {
        let refused = bench.refused(&Request::LoadEvents([event(1.0, action)].into_iter().collect()));
        assert_eq!(refused, Refusal::BadEvent { index: 0 }, "{action:?}");
    }
    bench.loaded(&Request::LoadEvents(
        [event(1.0, beam(true))].into_iter().collect(),
    ));
}
