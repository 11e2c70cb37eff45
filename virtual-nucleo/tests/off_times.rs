//! From a cause to the enables off, on the pins: docs/safety.md's bounds hold.

mod common;

use common::shipped;
use virtual_nucleo::inject::Fault;
use virtual_nucleo::off_times::{Cause, Off, measure};
use virtual_nucleo::time::Time;

fn both(cause: Cause) -> [Option<Off>; 2] {
    let images = [shipped("motion"), shipped("tracker")];
    let measured = measure([&images[0], &images[1]], cause).expect("it is measured");
    println!("{cause}: {measured:?}");
    measured
}

/// Both boards are off within these times, by a reset or not.
fn within(cause: Cause, limits: [Time; 2], floats: bool) {
    for (off, limit) in both(cause).into_iter().zip(limits) {
        let off = off.expect("both have it");
        assert!(off.enables <= limit, "{cause}: {off:?}, {limit}");
        assert!(off.enables > Time::default(), "{cause}: {off:?}");
        assert_eq!(off.floats, floats, "{cause}: {off:?}");
    }
}

#[test]
fn faults_switch_off_within_microseconds() {
    // The handler after a failure of the clock runs at 64 MHz.
    let two = [Time::us(2); 2];
    within(Cause::Supply, two, false);
    within(Cause::Clock, two, false);
    within(Cause::Task(Fault::Panic, "network"), two, false);
    within(Cause::Task(Fault::WildJump, "idle"), two, false);
}

#[test]
fn a_stack_that_runs_over_switches_off_within_a_tick() {
    within(Cause::Task(Fault::FullStack, "network"), [Time::us(2); 2], false);
    // It shows when the next interrupt comes: Ethernet and ticks, at least once a millisecond.
    within(Cause::StackAtInterrupt, [Time::ms(1); 2], false);
}

#[test]
fn what_stops_the_core_ends_by_the_watchdog() {
    // It is set to 51 periods of a millisecond, by an oscillator that is exact here.
    for cause in [Cause::LockUp, Cause::NotFed] {
        within(cause, [Time::us(51_010); 2], true);
    }
}

#[test]
fn the_emergency_stop_takes_a_tick() {
    // The tick, and its work until the lines go off.
    within(Cause::EmergencyStop, [Time::us(260), Time::us(1040)], false);
}
