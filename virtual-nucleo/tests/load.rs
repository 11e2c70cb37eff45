//! The load of the shipped images at rest, by each way to count cycles.

mod common;

use common::{motion, tracker};
use virtual_nucleo::board::Board;
use virtual_nucleo::cpu::cycles::Cycles;
use virtual_nucleo::time::Time;

/// The start-up is over.
const BEGIN: Time = Time::ms(300);
const END: Time = Time::ms(400);

/// Share of the time in which the core does not wait for an interrupt.
fn load(mut board: Board, cycles: Cycles) -> f64 {
    board.count(cycles);
    board.run(BEGIN);
    let asleep = board.asleep;
    board.run(END);
    1.0 - (board.asleep - asleep).seconds() / (END - BEGIN).seconds()
}

#[test]
fn one_cycle_an_instruction_lies_between_least_and_most() {
    for (name, board) in [("motion", motion as fn() -> Board), ("tracker", tracker)] {
        let [least, one, most] =
            [Cycles::Least, Cycles::One, Cycles::Most].map(|cycles| load(board(), cycles));
        println!(
            "{name}: {:.2} %, {:.2} %, {:.2} %",
            100.0 * least,
            100.0 * one,
            100.0 * most
        );
        assert!(least < one && one < most, "{name}: {least} {one} {most}");
        assert!(most < 1.0, "{name}");
    }
}
