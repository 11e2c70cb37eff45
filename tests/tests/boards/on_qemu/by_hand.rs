//! A jog whose cable is out.

use crate::by_hand::{LATE_MS, SPEED, assert_came_to_rest, held, operated};
use crate::pair::Pair;
use emulator::BoardAction;
use shared::protocol::Role;
use shared::state::State;
use std::thread;
use std::time::Duration;
use system_tests::{Rest, Then};

/// So long the cable is out: less than the boards take to give the session up.
const OUT: Duration = Duration::from_millis(1000);

#[test]
fn a_jog_ends_in_time_when_the_cable_is_out() {
    let mut pair = Pair::boot("jog-cable");
    let mut boards = pair.connect();
    let emulated = pair.emulated();
    let pull = || {
        for action in [BoardAction::CableOut, BoardAction::CableIn] {
            emulated.act(Role::Motion, action).expect("a board");
            if matches!(action, BoardAction::CableOut) {
                thread::sleep(OUT);
            }
        }
    };
    let rests = operated(
        &mut boards,
        [held(Then::Silence), held(Then::Happens(Box::new(pull)))],
    );
    drop(boards);
    assert_came_to_rest(&rests[1], "no more is asked for");
    // What the board tells without a cable is lost: by how far it went on.
    let [silent, cut] = [&rests[1], &rests[2]].map(way_after);
    println!("{silent:.2} mm after the last word, {cut:.2} mm with the cable out");
    assert!((cut - silent).abs() <= SPEED * 1e-3 * f64::from(LATE_MS));
    assert_eq!(
        (rests[2].motion.state, rests[2].motion.fault),
        (State::Idle, None)
    );
    pair.assert_off();
}

/// How far the first axis went on after it was held to for the last time \[mm\].
fn way_after(rest: &Rest) -> f64 {
    let last = rest.samples.iter().find(|sample| sample.tick == rest.asked);
    rest.motion.axes[0] - last.expect("a sample").axes[0]
}
