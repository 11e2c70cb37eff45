//! The power that a source gives back, against the one that is commanded.

use super::bench::{Bench, config};
use shared::config::{MotionConfig, ReadbackConfig};
use shared::io::{DacCode, MotionCommand};
use shared::motion::DARK;
use shared::protocol::{Refusal, Request};
use shared::state::{Fault, State};

/// A tenth of 4000 W, for 10 ms.
const READBACK: ReadbackConfig = ReadbackConfig {
    tolerance: 0.1,
    time_ms: 10,
};
const TIME_TICKS: u32 = 4 * READBACK.time_ms;
/// The bench welds with half of full power.
const HALF: f64 = 0.5;

fn supervised() -> MotionConfig {
    let mut config = config();
    for beam in config.beams.iter_mut().flatten() {
        beam.readback = Some(READBACK);
    }
    config
}

fn code(part: f64) -> Option<DacCode> {
    Some(DacCode::from_ratio(part, 1.0))
}

/// With a source that gives the power commanded a tick before, and `error` of full power more where its gate
/// is open.
struct Welder {
    bench: Bench,
    error: f64,
}

impl Welder {
    /// Homed, before any path.
    fn homed() -> Self {
        Self::homed_as(supervised())
    }

    fn homed_as(config: MotionConfig) -> Self {
        let mut bench = Bench::new();
        bench.inputs.beam_power = [code(0.0); 2];
        bench.run_ms(2);
        bench.done(&Request::ConfigureMotion(config));
        bench.run_ms(3);
        bench.done(&Request::Home);
        bench.until(State::Idle, 5000);
        Self { bench, error: 0.0 }
    }

    /// On a line of 300 mm at full speed, with beam 1 on at half of its power.
    fn welding() -> Self {
        Self::welding_as(supervised())
    }

    fn welding_as(config: MotionConfig) -> Self {
        let mut welder = Self::homed_as(config);
        welder.bench.load_line(300.0);
        welder.bench.run();
        welder.ticks(1600);
        assert!(welder.bench.command.beam_gate[0]);
        assert_eq!(welder.bench.status().state, State::Running);
        welder
    }

    /// Servo ticks, up to the first with the gate of beam 1 closed after it was open; how many.
    fn ticks_until_closed(&mut self, most: u32) -> Option<u32> {
        (1..=most).find(|_| {
            let before = self.bench.command.beam_gate[0];
            self.ticks(1);
            before && !self.bench.command.beam_gate[0]
        })
    }

    fn ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            let command = self.bench.command;
            for side in 0..2 {
                let gives = match command.beam_gate[side] {
                    true => command.beam_power[side].ratio() + self.error,
                    false => 0.0,
                };
                self.bench.inputs.beam_power[side] = code(gives);
            }
            self.bench.servo_tick();
        }
    }
}

#[test]
fn a_source_that_gives_what_it_is_told_welds_to_the_end() {
    for error in [-0.099, 0.0, 0.099] {
        let mut welder = Welder::homed();
        welder.error = error;
        welder.bench.load_line(100.0);
        welder.bench.run();
        let mut burnt = 0;
        while welder.bench.controller.state() == State::Running {
            welder.ticks(1);
            burnt += u32::from(welder.bench.command.beam_gate[0]);
            welder.bench.status();
        }
        assert!(burnt > 2000, "{burnt} ticks");
        assert_eq!((welder.bench.fault(), welder.bench.status().s_mm), (None, 100.0));
    }
}

#[test]
fn a_power_that_is_off_for_too_long_shuts_the_gate_and_stops_on_the_path() {
    for error in [-0.5, -0.11, 0.11] {
        let mut welder = Welder::welding();
        welder.error = error;
        let ticks = welder.ticks_until_closed(1000);
        // It is reported at the first tick after the time.
        assert_eq!(ticks, Some(TIME_TICKS + 1), "{error}");
        assert_eq!(welder.bench.command.beam_power, MotionCommand::SAFE.beam_power);
        assert!(welder.bench.command.enable);
        let command = welder.bench.command.beam_gate.map(|_| code(0.0));
        welder.bench.inputs.beam_power = command;
        let distance = welder.bench.stops_on_the_path_then_faults();
        assert!(distance > 10.0 && distance < 40.0, "{distance}");
        let Some(Fault::BeamPower {
            side: 0,
            commanded_w,
            measured_w,
        }) = welder.bench.fault()
        else {
            panic!("{:?}", welder.bench.fault());
        };
        let expected = (4000.0 * (HALF + error)) as f32;
        assert!((commanded_w - 2000.0).abs() < 1.0 && (measured_w - expected).abs() < 1.0);
        welder.bench.done(&Request::Reset);
        assert_eq!(welder.bench.status().state, State::Off);
    }
}

#[test]
fn a_power_that_is_off_for_a_short_time_again_and_again_is_none() {
    let mut welder = Welder::welding();
    for round in 0..10 {
        welder.error = if round % 2 == 0 { -0.3 } else { 0.3 };
        assert_eq!(welder.ticks_until_closed(TIME_TICKS), None);
        if round % 3 == 0 {
            welder.error = 0.0;
            welder.ticks(1);
        }
        welder.bench.status();
    }
    assert_eq!(welder.bench.fault(), None);
}

/// One that stays on through holds and stops does not continue again on the way to this one.
#[test]
fn a_beam_that_stays_on_at_rest_stays_off_once_its_power_was_wrong() {
    let mut config = supervised();
    for beam in config.beams.iter_mut().flatten() {
        (beam.stays_on_at_rest, beam.min_speed_mm_s) = (true, 0.0);
    }
    let mut welder = Welder::welding_as(config);
    welder.error = -0.5;
    assert_eq!(welder.ticks_until_closed(1000), Some(TIME_TICKS + 1));
    welder.bench.inputs.beam_power = [code(0.0); 2];
    welder.bench.stops_on_the_path_then_faults();
}

/// Off is detected where the tolerance is larger than the power.
#[test]
fn a_beam_that_is_off_is_told_however_small_its_power() {
    let mut welder = Welder::homed();
    let mut config = supervised();
    config.beams[0]
        .as_mut()
        .unwrap()
        .readback
        .as_mut()
        .unwrap()
        .tolerance = 0.5;
    // 2000 W are a twentieth of full power, more than twice what counts as dark.
    config.beams[0].as_mut().unwrap().power_at_10v_w = 2000.0 / (2.5 * DARK);
    welder.bench.done(&Request::Disable);
    welder.ticks(8);
    welder.bench.done(&Request::ConfigureMotion(config));
    welder.ticks(8);
    welder.bench.done(&Request::Home);
    welder.bench.until(State::Idle, 5000);
    welder.bench.load_line(300.0);
    welder.bench.run();
    welder.ticks(1200);
    assert!(welder.bench.command.beam_gate[0]);
    welder.error = -2.5 * DARK;
    assert_eq!(welder.ticks_until_closed(1000), Some(TIME_TICKS + 1));
}

#[test]
fn a_beam_that_burns_with_its_gate_closed_stops_the_path_and_keeps_the_reset_away() {
    let mut welder = Welder::welding();
    // Beam 2 was never asked for.
    welder.bench.inputs.beam_power[1] = code(0.05);
    for _ in 0..=TIME_TICKS {
        welder.bench.inputs.beam_power[0] = Some(welder.bench.command.beam_power[0]);
        assert!(welder.bench.command.beam_gate[0]);
        welder.bench.servo_tick();
    }
    assert_eq!(welder.bench.command.beam_gate, [false; 2]);
    welder.bench.inputs.beam_power[0] = code(0.0);
    welder.bench.stops_on_the_path_then_faults();
    let fault = welder.bench.fault();
    assert!(
        matches!(fault, Some(Fault::BeamNotOff { side: 1, measured_w }) if (measured_w - 200.0).abs() < 1.0),
        "{fault:?}"
    );
    assert_eq!(welder.bench.refused(&Request::Reset), Refusal::CauseRemains);
    welder.bench.inputs.beam_power[1] = code(DARK);
    welder.bench.run_ms(2);
    welder.bench.done(&Request::Reset);
    welder.bench.run_ms(50);
    assert_eq!(
        (welder.bench.status().state, welder.bench.fault()),
        (State::Off, None)
    );
}

#[test]
fn a_beam_that_burns_is_told_in_every_state() {
    type Reach = fn(&mut Bench);
    let states: [(State, Reach); 4] = [
        (State::Off, |bench| bench.done(&Request::Disable)),
        (State::Idle, |_| {}),
        (State::Homing, |bench| bench.done(&Request::Home)),
        (State::Holding, |bench| {
            bench.load_line(300.0);
            bench.run();
            bench.run_ms(20);
            bench.done(&Request::Hold);
            bench.run_ms(200);
        }),
    ];
    for (state, reach) in states {
        let mut welder = Welder::homed();
        reach(&mut welder.bench);
        welder.bench.run_ms(2);
        assert_eq!(welder.bench.controller.state(), state);
        welder.bench.inputs.beam_power[0] = code(0.5);
        welder.bench.run_ms(READBACK.time_ms - 1);
        assert_eq!(welder.bench.fault(), None, "{state:?}");
        welder.bench.run_ms(20);
        let fault = welder.bench.fault();
        assert!(
            matches!(fault, Some(Fault::BeamNotOff { side: 0, .. })),
            "{state:?}: {fault:?}"
        );
        assert_eq!(welder.bench.command, MotionCommand::SAFE);
        assert_eq!(welder.bench.controller.state(), State::Fault);
    }
}

#[test]
fn what_is_to_be_supervised_and_is_not_measured_is_refused_and_told() {
    let mut bench = Bench::new();
    bench.inputs.beam_power = [code(0.0), None];
    bench.run_ms(2);
    let configure = Request::ConfigureMotion(supervised());
    assert_eq!(bench.refused(&configure), Refusal::NoReadback { side: 1 });
    assert_eq!(bench.refused(&Request::Home), Refusal::NotConfigured);
    let mut one = supervised();
    one.beams[1].as_mut().unwrap().readback = None;
    bench.done(&Request::ConfigureMotion(one));

    // A converter that falls silent, on a weld.
    let mut welder = Welder::welding();
    welder.bench.inputs.beam_power[0] = None;
    for _ in 0..=TIME_TICKS {
        assert!(welder.bench.command.beam_gate[0]);
        welder.bench.servo_tick();
    }
    welder.bench.stops_on_the_path_then_faults();
    assert_eq!(welder.bench.fault(), Some(Fault::BeamPowerUnknown { side: 0 }));
    // Then the file can leave it out.
    welder.bench.done(&Request::Reset);
    welder.bench.run_ms(20);
    welder.bench.done(&Request::ConfigureMotion(config()));
}

#[test]
fn a_power_that_nobody_asked_to_supervise_stops_nothing() {
    let mut bench = Bench::welding();
    bench.inputs.beam_power = [code(0.0), code(1.0)];
    bench.run_ms(100);
    assert!(bench.command.beam_gate[0]);
    assert_eq!(bench.fault(), None);
}
