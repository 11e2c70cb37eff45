//! What the board reads, told before it has parameters.

use super::bench::{Bench, SCALE};
use shared::io::MOTORS;
use shared::protocol::{Inputs, Request, Response};

fn inputs(bench: &mut Bench) -> Inputs {
    match bench.controller.handle(&Request::Inputs, 0) {
        Response::Inputs(inputs) => inputs,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_board_without_parameters_tells_what_it_reads() {
    let mut bench = Bench::new();
    bench.run_ms(2);
    assert_eq!(inputs(&mut bench), Inputs::NONE);
    bench.slipped[4] = -300;
    bench.inputs.limit_plus.set(1, true);
    bench.inputs.limit_minus.set(6, true);
    bench.inputs.drive_fault.set(2, true);
    bench.inputs.converter_failed = true;
    bench.inputs.estop = [false, true];
    bench.inputs.laser_fault = [true, false];
    bench.inputs.process.set(3, true);
    bench.run_ms(2);
    let told = inputs(&mut bench);
    let expected = Inputs {
        counts: told.counts,
        limit_plus: 1 << 1,
        limit_minus: 1 << 6,
        drive_fault: 1 << 2,
        converter_failed: true,
        estop: [false, true],
        laser_fault: [true, false],
        process: 1 << 3,
        ..Inputs::NONE
    };
    assert_eq!(told, expected);
    assert_eq!(told.counts[4], -300);
    assert!(!bench.command.enable);
}

#[test]
fn marks_that_were_seen_are_remembered() {
    let mut bench = Bench::homed();
    bench.run_ms(1000);
    assert_eq!(inputs(&mut bench).marks, [Some((-2.0 * SCALE) as i64); MOTORS]);
}
