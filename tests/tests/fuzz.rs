//! A bounded part of `cargo xtask fuzz`: the same cases in every run.

use std::time::Duration;
use system_tests::fuzz::{self, Session};

/// Messages, and a time within which there are as many on the slowest of machines, or it ends there.
const MESSAGES: u64 = 30_000;
const WITHIN: Duration = Duration::from_secs(30);

#[test]
fn no_message_brings_a_controller_down_opens_a_beam_or_moves_the_machine_beyond_its_limits() {
    let sessions = [Session::of_weld()];
    fuzz::quiet();
    match fuzz::run(&sessions, 1, 0, MESSAGES, WITHIN, |_, _| {}) {
        // Most that was said was understood, and much of it done: else this would be about refusals.
        Ok(tally) => {
            println!("{tally:?}");
            assert!(tally.accepted * 3 > tally.requests, "{tally:?}");
            assert!(tally.messages() > 1000, "{tally:?}");
        }
        Err(failure) => {
            // The hook of quiet() prints nothing, this does.
            eprintln!("{failure}");
            std::process::exit(1);
        }
    }
}
