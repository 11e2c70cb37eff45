//! The voltage detector and the clock security, without a PC: the heartbeat tells whether the board still runs.

mod common;

use common::{causes, motion, plant_fault, tracker};
use virtual_nucleo::board::Board;
use virtual_nucleo::chip::pins::pin;
use virtual_nucleo::time::Time;

/// After start-up, the longer one of both boards.
const STARTED: Time = Time::ms(20);
/// The detector's threshold is 2.85 V with the supply rising, 0.1 V lower with it falling.
const ABOVE_MV: u32 = 2760;
const BELOW_MV: u32 = 2740;

/// Whether the heartbeat alternates in the next milliseconds.
fn beats(board: &mut Board) -> bool {
    board.record_pins();
    board.chip_mut().shared.recorder.take();
    board.run(board.now() + Time::ms(5));
    let changes = board.chip_mut().shared.recorder.take();
    changes.iter().filter(|change| change.pin == pin('F', 15)).count() > 1
}

#[test]
fn a_low_supply_and_a_lost_clock_stop_both_boards() {
    for (name, board) in [("motion", motion as fn() -> Board), ("tracker", tracker)] {
        let mut low = board();
        low.run(STARTED);
        low.chip_mut().shared.supply_mv = ABOVE_MV;
        assert!(beats(&mut low), "{name}");
        low.chip_mut().shared.supply_mv = BELOW_MV;
        assert!(!beats(&mut low), "{name}");
        let mut lost = board();
        lost.run(STARTED);
        lost.chip_mut().fail_clock();
        assert!(!beats(&mut lost), "{name}");
        assert_eq!(lost.chip().shared.clocks.core, 64_000_000, "{name}");
        assert!(lost.function().contains("stop"), "{name}: {}", lost.function());
    }
}

#[test]
fn a_supply_that_is_low_from_the_start_stops_the_board_before_its_first_tick() {
    let mut board = motion();
    board.chip_mut().shared.supply_mv = BELOW_MV;
    board.run(STARTED);
    assert!(!beats(&mut board));
    assert_eq!(board.resets, 0);
}

#[test]
fn a_detector_or_a_clock_security_that_is_left_off_shows() {
    // What is left out, and whether the clock fails; otherwise the supply.
    type Fault = (&'static str, &'static str, u32, fn(u32) -> u32, bool);
    let faults: [Fault; 4] = [
        ("detector", "PWR", 0x00, |v| v & !(1 << 4), false),
        ("threshold", "PWR", 0x00, |v| v & !(7 << 5), false),
        ("mask", "EXTI", 0x80, |v| v & !(1 << 16), false),
        ("clock security", "RCC", 0x00, |v| v & !(1 << 19), true),
    ];
    for (what, peripheral, register, change, clock) in faults {
        let mut board = motion();
        plant_fault(&mut board, (peripheral, register), change);
        board.run(STARTED);
        if clock {
            board.chip_mut().fail_clock();
            assert!(!beats(&mut board), "{what}");
            let found = causes(&board);
            let expected = "the HSE fails, and its clock security is off: the core stops";
            assert!(found.iter().any(|cause| cause == expected), "{what}: {found:#?}");
        } else {
            board.chip_mut().shared.supply_mv = BELOW_MV;
            assert!(beats(&mut board), "{what}");
        }
    }
}
