//! Machines that are jogged, and whoever holds to them: it lets go, freezes, dies, or its cable is out.

use crate::pair::{Pair, status};
use crate::process::Process;
use config::machine::MachineFile;
use host_link::boards::Boards;
use host_link::spool::Spooling;
use host_link::{Jog, JogWay};
use job::{Job, Names, Work};
use nix::sys::signal::Signal;
use shared::protocol::{Datagram, HOLD_TO_RUN_MS, MotionSample};
use shared::state::{Fault, State};
use std::thread;
use std::time::{Duration, Instant};
use system_tests::{Deed, Hands, MACHINE, Rest, Then, run, shipped};
use world::Surroundings;

/// A jog of the first axis \[mm/s\].
pub const SPEED: f64 = 100.0;
const X: JogWay = JogWay::Axis(0);
/// Held to for so long, the machine goes at full speed \[ms\].
const HELD_MS: u32 = 800;
/// A batch of telemetry, and how far emulated boards may be ahead of what the PC has handled: so much older than the board's own
/// time is the newest sample that the operator knows when they ask \[ms\].
pub const LATE_MS: u32 = 25;
/// Longer than any stop here takes.
const LONG: Duration = Duration::from_millis(1500);

pub fn machine() -> MachineFile {
    MachineFile::read(&shipped(MACHINE)).unwrap_or_else(|error| panic!("{error}"))
}

/// Jogs as long as `deeds` say; where the machine waited.
pub fn operated<'a>(boards: &mut dyn Boards, deeds: impl IntoIterator<Item = Deed<'a>>) -> Vec<Rest> {
    let machine = machine();
    let job = Job {
        machine: &machine,
        work: Work::ByHand,
        part: None,
        speed_m_per_min: None,
        from_line: None,
        surroundings: Surroundings::default().into(),
        spooling: Spooling::nothing(),
        names: Names::default(),
    };
    let mut hands = Hands::new(deeds);
    let ended = run(boards, &job, &mut hands).expect("a job that begins");
    assert!(ended.error.is_none(), "{:?}", ended.error);
    hands.rests()
}

/// Held to for a while, at full speed.
pub fn held(then: Then<'_>) -> Deed<'_> {
    Deed::Holds(Jog::now(X, SPEED, None), HELD_MS, then)
}

/// Checks that the machine came to rest in time after it was held to for the last time, without a fault.
#[track_caller]
pub fn assert_came_to_rest(rest: &Rest, what: &str) {
    assert_eq!(
        (rest.motion.state, rest.motion.fault),
        (State::Idle, None),
        "{what}"
    );
    let axis = machine().motion.axes[0].clone().expect("an axis");
    let full = rest
        .samples
        .iter()
        .map(|sample| sample.speed_mm_s.abs())
        .fold(0.0, f64::max);
    assert!(full > 0.99 * SPEED, "{what}: it went at {full} mm/s");
    let stops = first(rest, |sample| {
        sample.state != State::Running && sample.tick > rest.asked
    });
    let after_ms = stops.tick - rest.asked;
    let stands = first(rest, |sample| {
        sample.tick > stops.tick && sample.speed_mm_s == 0.0
    });
    let braking_ms = stands.tick - stops.tick;
    println!("{what}: the stop begins {after_ms} ms after the last word, at rest {braking_ms} ms later");
    assert!(after_ms <= HOLD_TO_RUN_MS + LATE_MS, "{what}: {after_ms} ms");
    // The bound of a hold: 0.4 s and four times what the deceleration alone takes.
    let bound = 400.0 + 4e3 * SPEED / axis.max_acceleration;
    assert!(
        f64::from(braking_ms) <= bound,
        "{what}: {braking_ms} of {bound} ms"
    );
}

#[track_caller]
fn first(rest: &Rest, is: impl Fn(&MotionSample) -> bool) -> &MotionSample {
    rest.samples.iter().find(|sample| is(sample)).expect("a sample")
}

#[test]
fn a_jog_ends_in_time_when_the_hand_or_the_pc_holds_to_it_no_more() {
    let mut pair = Pair::boot("jog");
    let frozen = || thread::sleep(LONG);
    let rests = operated(
        &mut pair.connect(),
        [held(Then::Silence), held(Then::Happens(Box::new(frozen)))],
    );
    assert_came_to_rest(&rests[1], "no more is asked for");
    assert_came_to_rest(&rests[2], "the PC does nothing for a while");
    pair.assert_off();
}

#[test]
fn a_jog_ends_at_once_when_its_program_is_killed() {
    let mut pair = Pair::boot("jog-killed");
    let mut command = pair.program(["jog", "X", "100"]);
    command.arg("--machine").arg(shipped(MACHINE));
    let mut seamwright = Process::start(command);
    seamwright.wait_for("jogging");
    thread::sleep(Duration::from_millis(HELD_MS.into()));
    seamwright.signal(Signal::SIGKILL);
    seamwright.end();
    let mut boards = pair.connect();
    status(&mut boards);
    let mut samples = Vec::<MotionSample>::new();
    let end = Instant::now() + Duration::from_secs(30);
    while samples.last().is_none_or(|last| last.state != State::Fault) {
        assert!(Instant::now() < end, "no rest after {} ms", samples.len());
        let received = boards.receive(Duration::from_millis(10));
        if let Some((_, Datagram::MotionTelemetry(telemetry))) = received.expect("datagrams") {
            samples.extend(telemetry.samples);
        }
    }
    let (motion, _) = status(&mut boards);
    assert_eq!(motion.fault, Some(Fault::SessionEnded));
    let moving = samples.iter().filter(|sample| sample.speed_mm_s != 0.0).count();
    println!("at rest {moving} ms after somebody else heard of it");
    assert!(moving < 800, "{moving} ms");
    drop(boards);
    pair.check();
}
