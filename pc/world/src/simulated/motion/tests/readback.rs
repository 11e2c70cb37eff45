//! The power that the plant's sources give, supervised.

use super::bench::{Bench, config};
use super::*;
use shared::config::ReadbackConfig;
use shared::io::DacCode;

/// With 5 % of full power allowed for 5 ms; on a line, with beam 1 on.
fn welding() -> Bench {
    let mut config = config();
    for beam in config.beams.iter_mut().flatten() {
        beam.readback = Some(ReadbackConfig {
            tolerance: 0.05,
            time_ms: 5,
        });
    }
    let mut bench = Bench::configured();
    bench.done(&Request::ConfigureMotion(config));
    bench.run_ms(5);
    bench.done(&Request::Home);
    bench.until(State::Idle, 20_000);
    bench.load_line(300.0);
    bench.run();
    bench.run_ms(400);
    assert_eq!(bench.board.plant.beams(), [true, false]);
    bench
}

/// Servo ticks until the gates are shut, at most 100.
fn ticks_until_shut(bench: &mut Bench) -> Option<u32> {
    (1..=100).find(|_| {
        bench.now_us += 250;
        bench.board.tick(bench.now_us);
        bench.board.command.beam_gate == [false; 2]
    })
}

#[test]
fn a_sound_source_is_left_alone_and_one_that_goes_out_stops_the_path() {
    let mut bench = welding();
    bench.until(State::Idle, 5000);
    assert_eq!((bench.status().fault, bench.status().s_mm), (None, 300.0));

    let mut bench = welding();
    bench.board.plant.stick_beam(0, Some(DacCode::ZERO));
    assert_eq!(ticks_until_shut(&mut bench), Some(21), "5 ms and a tick");
    assert!(bench.board.command.enable, "it stops on the path");
    bench.run_ms(1000);
    let fault = bench.status().fault;
    assert!(
        matches!(fault, Some(Fault::BeamPower { side: 0, measured_w, .. }) if measured_w == 0.0),
        "{fault:?}"
    );
    assert_eq!(bench.status().state, State::Fault);
}

#[test]
fn a_source_that_burns_with_its_gate_shut_is_told_by_its_side() {
    let mut bench = welding();
    bench
        .board
        .plant
        .stick_beam(1, DacCode::from_ratio(0.1, 1.0).into());
    assert_eq!(ticks_until_shut(&mut bench), Some(21), "5 ms and a tick");
    bench.run_ms(1000);
    let status = bench.status();
    assert_eq!(status.state, State::Fault);
    let text = status.fault.expect("a fault").to_string();
    assert!(
        text.starts_with("beam 2 gives 400 W with its gate closed"),
        "{text}"
    );
}

#[test]
fn a_source_that_is_not_supervised_may_do_what_it_likes() {
    let mut bench = Bench::homed();
    bench
        .board
        .plant
        .stick_beam(0, DacCode::from_ratio(1.0, 1.0).into());
    bench.run_ms(100);
    assert_eq!((bench.status().state, bench.status().fault), (State::Idle, None));
}
