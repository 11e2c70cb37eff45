//! The shipped images run.

mod common;

use common::{causes, motion, tracker};
use virtual_nucleo::time::Time;

/// What embassy-stm32 0.6 does once where it sets up the bus of the converters, without harm: it clears its flags by writing ones to
/// reserved bits, too.
const KNOWN: &str = "reserved bits 0xfffff007 of IFCR of SPI3 are changed";

#[test]
fn both_images_come_to_their_idle_loops_and_keep_their_ticks() {
    for (name, mut board, hz) in [("motion", motion(), 4000), ("tracker", tracker(), 1000)] {
        board.run(Time::ms(50));
        let (at, instructions) = board.first_wait.expect("it waits");
        let steps = board.chip().shared.outside.steps;
        println!(
            "{name}: first wait at {at} after {instructions} instructions, {steps} steps of the machine"
        );
        assert_eq!(causes(&board), [KNOWN], "{name}");
        assert_eq!(board.resets, 0, "{name}");
        let ticks = (Time::ms(50) - at).seconds() * f64::from(hz);
        assert!(
            (steps as f64 - ticks).abs() <= 2.0,
            "{name}: {steps} steps, {ticks} ticks"
        );
    }
}

#[test]
fn the_same_board_does_the_same_twice() {
    let run = || {
        let mut board = motion();
        board.run(Time::ms(30));
        (
            board.chip().instructions,
            board.asleep,
            board.chip().shared.outside.frames(),
        )
    };
    assert_eq!(run(), run());
}

#[test]
fn it_boots_without_the_phy_and_with_a_silent_one() {
    for (no_clock, silent) in [(true, false), (false, true)] {
        let mut board = motion();
        let ethernet = board.ethernet_mut().expect("is there");
        (ethernet.phy.fault.no_clock, ethernet.phy.fault.silent) = (no_clock, silent);
        board.run(Time::ms(1500));
        println!("no clock {no_clock}, silent {silent}: {:?}", board.first_wait);
        assert!(board.first_wait.is_some(), "no clock {no_clock}, silent {silent}");
        assert_eq!(board.resets, 0);
    }
}
