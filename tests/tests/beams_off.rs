//! From a fault to beams off, at 9 m/min, by the plant's beams and at moments of every phase of both boards' ticks.

use host_link::boards::Boards;
use shared::io::SIDES;
use shared::protocol::{Request, Response, Role};
use std::slice::Iter;
use system_tests::fuzz::{Message, Said, Session};
use world::simulated::{InjectedFault, SimulatedBoards};

/// Servo tick of the motion board, control tick of the tracker board, and their time on the network, one way \[µs\].
const SERVO_US: u64 = 250;
const CONTROL_US: u64 = 1000;
const TRANSIT_US: u64 = 300;
/// A permit is valid for so long \[µs\].
const PERMIT_US: u64 = 5000;
/// Moments of a weld lie so far apart that they are in all phases of both ticks \[µs\].
const APART_US: u64 = 19_937;
/// Beams are looked at for no longer \[µs\].
const LONGEST_US: u64 = 100_000;
/// Longest time for which the seam ahead is known, with what was seen before a hold \[µs\].
const SEEN_US: u64 = 400_000;
/// Speed of the weld \[mm/s\].
const SPEED: f64 = 150.0;

/// State of both boards in mid-weld, and what the PC sends next.
#[derive(Clone)]
struct WeldSnapshot<'a> {
    boards: SimulatedBoards,
    next: Iter<'a, Said>,
}

impl WeldSnapshot<'_> {
    fn now_us(&self) -> u64 {
        self.boards.outputs().now_us
    }

    /// The next thing that happens, until `end_us`; whether there was one.
    fn step(&mut self, end_us: u64) -> bool {
        match self.next.as_slice().first() {
            Some(said) if said.at_us <= end_us => {
                if !self.boards.advance(said.at_us) {
                    self.next.next();
                    match &said.message {
                        Message::Request(request) => {
                            self.boards.ask(said.to, request);
                        }
                        Message::Datagram(datagram) => {
                            self.boards
                                .send(said.to, datagram)
                                .expect("boards of this process");
                        }
                    }
                }
                true
            }
            _ => self.boards.advance(end_us),
        }
    }

    fn advance(&mut self, end_us: u64) {
        while self.step(end_us) {}
    }

    fn burns(&self) -> bool {
        let outputs = self.boards.outputs();
        let speed = outputs.path.map_or(0.0, |(state, _)| state.speed_mm_s);
        outputs.beams == [true; SIDES] && (speed - SPEED).abs() < 1e-3
    }

    /// Goes on until `over`; how long that took \[µs\].
    fn until(&mut self, longest_us: u64, over: impl Fn(&mut SimulatedBoards) -> bool) -> u64 {
        let begin_us = self.now_us();
        while !over(&mut self.boards) {
            assert!(self.now_us() < begin_us + longest_us, "not after {longest_us} µs");
            self.step(begin_us + longest_us);
        }
        self.now_us() - begin_us
    }

    /// Goes on until beams `sides` are off; how long they were on \[µs\]. They stay off. What the plant's beams are after a
    /// servo tick they have been since the tick before.
    fn until_off(&mut self, sides: &[usize]) -> u64 {
        let off = |boards: &SimulatedBoards| sides.iter().all(|side| !boards.outputs().beams[*side]);
        let took_us = self.until(LONGEST_US, |boards| off(boards));
        let end_us = self.now_us() + LONGEST_US;
        while self.step(end_us) {
            assert!(off(&self.boards), "on again");
        }
        took_us.saturating_sub(SERVO_US)
    }
}

fn moments(session: &Session) -> Vec<WeldSnapshot<'_>> {
    let (boards, first) = &session.moments[0];
    let mut now = WeldSnapshot {
        boards: boards.clone(),
        next: session.said[*first..].iter(),
    };
    let mut found = Vec::new();
    while !now.next.as_slice().is_empty() {
        now.advance(now.now_us() + APART_US);
        // Not when the PC itself is about to end it.
        let mut later = now.clone();
        later.advance(now.now_us() + LONGEST_US);
        if now.burns() && later.burns() {
            found.push(now.clone());
        }
    }
    found
}

/// The longest of what `measure` finds at all moments, held to `bound_us`.
#[track_caller]
fn hold(moments: &[WeldSnapshot], what: &str, bound_us: u64, measure: impl Fn(&mut WeldSnapshot) -> u64) {
    let longest_us = moments
        .iter()
        .map(|moment| measure(&mut moment.clone()))
        .max()
        .expect("moments");
    let way_mm = SPEED * longest_us as f64 * 1e-6;
    println!("{what:44} {longest_us:6} µs {way_mm:6.3} mm");
    assert!(longest_us <= bound_us, "{what}: {longest_us} of {bound_us} µs");
}

/// As [`hold`], for what goes wrong on the boards: until beams `sides` are off.
#[track_caller]
fn hold_off(moments: &[WeldSnapshot], what: &str, bound_us: u64, fault: InjectedFault, sides: &[usize]) {
    hold(moments, what, bound_us, |moment| {
        moment.boards.inject(fault);
        moment.until_off(sides)
    });
}

fn tracker_faulty(boards: &mut SimulatedBoards) -> bool {
    match boards.ask(Role::Tracker, &Request::Status) {
        Response::TrackerStatus(status) => status.fault.is_some(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn beams_are_off_in_time_whatever_fails() {
    let session = Session::of_weld();
    let moments = moments(&session);
    println!("{} moments", moments.len());
    assert!(moments.len() > 50);
    let both: &[usize] = &[0, 1];

    // What the motion board sees itself: at its next servo tick.
    let own: [(&str, &[usize], InjectedFault); 6] = [
        (
            "emergency stop",
            both,
            InjectedFault::MotionInputs(|f| f.estop = [true; 2]),
        ),
        (
            "drive fault",
            both,
            InjectedFault::MotionInputs(|f| f.drive_fault.set(2, true)),
        ),
        (
            "limit switch",
            both,
            InjectedFault::MotionInputs(|f| f.limit_plus.set(0, true)),
        ),
        (
            "encoder jumps",
            both,
            InjectedFault::MotionInputs(|f| f.counts[1] += 1_000_000),
        ),
        (
            "laser fault, its own beam",
            &[1],
            InjectedFault::MotionInputs(|f| f.laser_fault[1] = true),
        ),
        ("session ended", both, InjectedFault::SessionEnded),
    ];
    for (what, sides, fault) in own {
        // The end of a session is an order of the path tick, a millisecond, to the servo tick after it.
        let bound_us = match fault {
            InjectedFault::SessionEnded => 4 * SERVO_US + SERVO_US,
            _ => SERVO_US,
        };
        hold_off(&moments, what, bound_us, fault, sides);
    }
    hold_off(
        &moments,
        "laser fault, the other beam",
        2 * CONTROL_US,
        InjectedFault::MotionInputs(|f| f.laser_fault[1] = true),
        &[0],
    );
    for (what, request) in [("stop", Request::Stop), ("hold", Request::Hold)] {
        hold(&moments, what, 2 * CONTROL_US, |moment| {
            moment.boards.ask(Role::Motion, &request);
            // What the PC says of the weld afterwards is of another one.
            moment.next = [].iter();
            moment.until_off(both)
        });
    }

    // What the tracker sees: at its next control tick, sent with its permit.
    let told_us = CONTROL_US + TRANSIT_US + SERVO_US;
    for (what, fault) in [
        (
            "tracker: emergency stop",
            InjectedFault::TrackerInputs(|f| f.estop = [true; 2]),
        ),
        (
            "tracker: drive fault",
            InjectedFault::TrackerInputs(|f| f.drive_fault.set(0, true)),
        ),
        (
            "tracker: limit switch",
            InjectedFault::TrackerInputs(|f| f.limit_minus.set(3, true)),
        ),
        (
            "tracker: encoder jumps",
            InjectedFault::TrackerInputs(|f| f.counts[2] += 100_000),
        ),
    ] {
        hold_off(&moments, what, told_us, fault, both);
    }
    hold(
        &moments,
        "seam lost, from the tracker's fault",
        told_us,
        |moment| {
            // No measurement any more: after a hold, what was seen before it is gone over first.
            moment.next = [].iter();
            moment.until(SEEN_US, tracker_faulty);
            moment.until_off(both)
        },
    );

    // No message says this: the permit is not renewed.
    for (what, fault) in [
        ("tracker frozen, reset or off", InjectedFault::TrackerFrozen),
        ("tracker cut off", InjectedFault::CutOff(Role::Tracker)),
        ("motion board cut off", InjectedFault::CutOff(Role::Motion)),
    ] {
        hold_off(&moments, what, PERMIT_US + SERVO_US, fault, both);
    }
}
