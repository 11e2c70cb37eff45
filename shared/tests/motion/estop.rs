//! The two channels of the emergency stop: either one stops, and one that is open alone for long is a fault of its own.

use super::bench::{Bench, config};
use shared::control::DISCREPANCY_US;
use shared::io::MotionCommand;
use shared::protocol::{Refusal, Request};
use shared::state::{Fault, State};

/// The longest time that the channels may differ \[ms\].
const LONGEST_MS: u32 = DISCREPANCY_US / 1000;

/// Both closed, the first open, the second, both.
const CLOSED: [bool; 2] = [false; 2];
const FIRST: [bool; 2] = [true, false];
const SECOND: [bool; 2] = [false, true];
const PRESSED: [bool; 2] = [true; 2];

impl Bench {
    fn channels(&mut self, open: [bool; 2], ms: u32) {
        self.inputs.estop = open;
        self.run_ms(ms);
    }

    fn refuses_reset(&mut self, refusal: Refusal) {
        assert_eq!(self.refused(&Request::Reset), refusal);
        assert_eq!(self.controller.state(), State::Fault);
    }

    fn resets(&mut self) {
        self.done(&Request::Reset);
        assert_eq!((self.status().state, self.fault()), (State::Off, None));
    }
}

#[test]
fn either_channel_stops_in_its_tick_and_keeps_the_reset_away_while_it_is_open() {
    for alone in [FIRST, SECOND] {
        let mut bench = Bench::welding();
        bench.inputs.estop = alone;
        bench.servo_tick();
        assert_eq!(bench.command, MotionCommand::SAFE);
        bench.run_ms(2);
        assert_eq!(bench.fault(), Some(Fault::EmergencyStop));
        bench.refuses_reset(Refusal::CauseRemains);
        bench.channels(CLOSED, 1);
        bench.resets();
    }
}

#[test]
fn channels_that_differ_for_too_long_are_a_fault_that_only_a_full_press_clears() {
    for (alone, closed) in [(FIRST, 1), (SECOND, 0)] {
        let mut bench = Bench::welding();
        bench.channels(alone, LONGEST_MS - 1);
        assert_eq!(bench.fault(), Some(Fault::EmergencyStop));
        bench.run_ms(3);
        assert_eq!(bench.fault(), Some(Fault::EmergencyStopChannels { closed }));
        bench.refuses_reset(Refusal::CauseRemains);
        // Released, and pressed so that the other channel opens alone: neither shows that both open.
        bench.channels(CLOSED, 20);
        bench.refuses_reset(Refusal::EmergencyStopNotTested);
        bench.channels(alone.map(|open| !open), 20);
        bench.channels(CLOSED, 20);
        bench.refuses_reset(Refusal::EmergencyStopNotTested);

        bench.channels(PRESSED, 5);
        bench.refuses_reset(Refusal::CauseRemains);
        bench.channels(CLOSED, 2);
        assert_eq!(bench.fault(), Some(Fault::EmergencyStopChannels { closed }));
        bench.resets();
        bench.done(&Request::Home);
        bench.until(State::Idle, 5000);
    }
}

#[test]
fn a_button_whose_channels_open_and_close_one_after_the_other_is_no_fault() {
    let mut bench = Bench::welding();
    for _ in 0..2 {
        bench.channels(FIRST, LONGEST_MS - 1);
        bench.channels(PRESSED, 3000);
        bench.channels(SECOND, LONGEST_MS - 1);
        bench.channels(CLOSED, 10);
    }
    assert_eq!(bench.fault(), Some(Fault::EmergencyStop));
    bench.resets();
}

/// A welded contact is found when the button is tried, which is done with the drives off.
#[test]
fn channels_that_differ_are_told_with_the_drives_off_and_before_there_are_parameters() {
    let mut bench = Bench::new();
    bench.channels(SECOND, LONGEST_MS - 1);
    assert_eq!((bench.status().state, bench.fault()), (State::Off, None));
    bench.run_ms(3);
    assert_eq!(bench.fault(), Some(Fault::EmergencyStopChannels { closed: 0 }));
    bench.channels(PRESSED, 1);
    bench.channels(CLOSED, 1);
    bench.resets();
    bench.done(&Request::ConfigureMotion(config()));
}

/// Lost servo ticks count: the time is real time.
#[test]
fn the_time_that_channels_differ_goes_on_over_lost_ticks() {
    let mut bench = Bench::new();
    bench.inputs.estop = FIRST;
    bench.servo_tick_after(4 * (LONGEST_MS + 1));
    bench.path_tick_after(LONGEST_MS + 1);
    assert_eq!(bench.fault(), Some(Fault::EmergencyStopChannels { closed: 1 }));
}

/// What came first is kept; the reset asks for the full press all the same.
#[test]
fn an_earlier_fault_is_kept_and_the_reset_still_asks_for_a_full_press() {
    let mut bench = Bench::homed();
    bench.inputs.drive_fault.set(2, true);
    bench.run_ms(2);
    bench.inputs.drive_fault.set(2, false);
    bench.channels(FIRST, LONGEST_MS + 2);
    bench.channels(CLOSED, 1);
    assert_eq!(bench.fault(), Some(Fault::Drive { motor: 2 }));
    bench.refuses_reset(Refusal::EmergencyStopNotTested);
    bench.channels(PRESSED, 1);
    bench.channels(CLOSED, 1);
    bench.resets();
}

#[test]
fn the_fault_says_which_channel_stayed_closed_and_what_to_do() {
    let text = Fault::EmergencyStopChannels { closed: 0 }.to_string();
    assert!(
        text.starts_with("emergency-stop channel 1 stayed closed while channel 2 was open"),
        "{text}"
    );
    assert!(text.contains("wire") && text.contains("welded"), "{text}");
    assert!(
        text.ends_with("press the button fully, release it, then reset"),
        "{text}"
    );
}
