//! Filters of the loops on the board: what they remember does not outlast a fault.

use super::bench::{Bench, Y, config};
use shared::control::{LowPassConfig, NotchConfig};
use shared::io::ESTOP_CHANNELS;
use shared::protocol::Request;
use shared::state::State;

/// Y has a slow low-pass and a notch: a filter that was driven hard swings for long.
fn filtered() -> Bench {
    let mut config = config();
    let motor = config.motors[2].as_mut().unwrap();
    motor.kp = 10.0;
    motor.low_pass = Some(LowPassConfig {
        frequency_hz: 20.0,
        damping: 0.3,
    });
    let notch = NotchConfig {
        frequency_hz: 40.0,
        damping: 0.5,
        depth: 0.1,
    };
    motor.notches.push(notch).unwrap();
    Bench::homed_as(config)
}

#[test]
fn after_a_fault_the_loop_begins_with_filters_that_have_seen_nothing() {
    let mut bench = filtered();
    // Someone pushes the axis by 0.4 mm, within the trip of 0.5 mm: the filter is driven.
    for _ in 0..10 {
        bench.position[Y] += 0.04;
        bench.servo_tick();
    }
    bench.run_ms(5);
    assert!(bench.speed() < -0.5, "{} mm/s", bench.speed());
    bench.inputs.estop = [true; ESTOP_CHANNELS];
    bench.run_ms(3);
    assert_eq!(bench.status().state, State::Fault);
    assert!(!bench.command.enable);
    bench.inputs.estop = [false; ESTOP_CHANNELS];
    bench.run_ms(1200);
    bench.done(&Request::Reset);
    bench.run_ms(3);
    bench.done(&Request::Home);
    // The search has hardly begun: what the drive is told is the speed of the search, not what the filter remembers.
    let mut told = 0;
    for _ in 0..12 {
        bench.servo_tick();
        if bench.command.enable {
            told += 1;
            assert!(
                bench.speed().abs() < 0.1,
                "{} mm/s on Y, whose turn it is not",
                bench.speed()
            );
        }
    }
    assert!(told >= 4, "{told} ticks");
}
