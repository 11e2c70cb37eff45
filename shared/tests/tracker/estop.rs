//! The two channels of the emergency stop: either one stops, and one that is open alone for long is a fault of its own.

use crate::bench::{Bench, config};
use crate::states::{bench, ready};
use shared::control::DISCREPANCY_US;
use shared::io::{SlideCommand, SlideFeedback};
use shared::protocol::{Refusal, Request, Response};
use shared::state::{TrackerFault, TrackerState};

/// The longest time that the channels may differ \[ms\].
const LONGEST_MS: u32 = DISCREPANCY_US / 1000;

type ChangeInputs = fn(&mut SlideFeedback);

const CLOSED: ChangeInputs = |f| f.estop = [false; 2];
const FIRST: ChangeInputs = |f| f.estop = [true, false];
const SECOND: ChangeInputs = |f| f.estop = [false, true];
const PRESSED: ChangeInputs = |f| f.estop = [true; 2];

impl Bench {
    fn channels(&mut self, open: ChangeInputs, ms: u32) {
        self.change_inputs = open;
        self.run_ms(ms);
    }

    fn refuses_reset(&mut self, refusal: Refusal) {
        assert_eq!(self.ask(Request::Reset), Response::Refused(refusal));
        assert_eq!(self.controller.state(), TrackerState::Fault);
    }

    fn resets(&mut self) {
        self.accept(Request::Reset);
        let status = self.status();
        assert_eq!((status.state, status.fault), (TrackerState::Off, None));
    }
}

#[test]
fn channels_that_differ_for_too_long_are_a_fault_that_only_a_full_press_clears() {
    for (alone, other, closed) in [(FIRST, SECOND, 1), (SECOND, FIRST, 0)] {
        let mut bench = ready();
        let disagree = Some(TrackerFault::EmergencyStopChannels { closed });
        bench.channels(alone, 1);
        assert_eq!(bench.last.command, SlideCommand::SAFE);
        bench.run_ms(LONGEST_MS - 1);
        assert_eq!(bench.status().fault, Some(TrackerFault::EmergencyStop));
        bench.run_ms(1);
        assert_eq!(bench.status().fault, disagree);
        assert_eq!(bench.last.sample.fault, disagree);
        bench.refuses_reset(Refusal::CauseRemains);
        bench.channels(CLOSED, 20);
        bench.refuses_reset(Refusal::EmergencyStopNotTested);
        bench.channels(other, 20);
        bench.channels(CLOSED, 20);
        bench.refuses_reset(Refusal::EmergencyStopNotTested);

        bench.channels(PRESSED, 5);
        bench.refuses_reset(Refusal::CauseRemains);
        bench.channels(CLOSED, 2);
        assert_eq!(bench.status().fault, disagree);
        bench.resets();
        bench.accept(Request::Home);
        bench.run_ms(3000);
        assert_eq!(bench.controller.state(), TrackerState::Ready);
    }
}

#[test]
fn a_button_whose_channels_open_and_close_one_after_the_other_is_no_fault() {
    let mut bench = ready();
    for _ in 0..2 {
        bench.channels(FIRST, LONGEST_MS);
        bench.refuses_reset(Refusal::CauseRemains);
        bench.channels(PRESSED, 3000);
        bench.channels(SECOND, LONGEST_MS);
        bench.refuses_reset(Refusal::CauseRemains);
        bench.channels(CLOSED, 10);
    }
    assert_eq!(bench.status().fault, Some(TrackerFault::EmergencyStop));
    bench.resets();
}

#[test]
fn channels_that_differ_are_told_with_the_drives_off_and_before_there_are_parameters() {
    let mut bench = bench();
    bench.channels(SECOND, LONGEST_MS);
    assert_eq!(bench.controller.state(), TrackerState::Off);
    bench.run_ms(1);
    let closed = 0;
    let disagree = Some(TrackerFault::EmergencyStopChannels { closed });
    assert_eq!(bench.status().fault, disagree);
    bench.channels(PRESSED, 1);
    bench.channels(CLOSED, 1);
    bench.resets();
    bench.accept(Request::ConfigureTracker(config()));
}

#[test]
fn an_earlier_fault_is_kept_and_the_reset_still_asks_for_a_full_press() {
    let mut bench = ready();
    bench.channels(|f| f.drive_fault.set(3, true), 2);
    bench.channels(FIRST, LONGEST_MS + 2);
    bench.channels(CLOSED, 1);
    assert_eq!(bench.status().fault, Some(TrackerFault::Drive { slide: 3 }));
    bench.refuses_reset(Refusal::EmergencyStopNotTested);
    bench.channels(PRESSED, 1);
    bench.channels(CLOSED, 1);
    bench.resets();
}
