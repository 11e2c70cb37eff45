//! Datagrams of the other board, and those to it.

use crate::bench::{Bench, PC_PORT, SUBSCRIBER, identity, measurement};
use link::{Partner, Source};
use shared::protocol::{BeamPermit, ClockRequest, Datagram, Identity, PathState, Permit, Role};

/// Address of a station on the network that is neither the PC nor the other board.
const NOBODY: Source = Source {
    address: [192, 168, 7, 99],
    port: 7101,
};

fn permit() -> Datagram {
    Datagram::Permit(Permit {
        tick: 1,
        path_id: 1,
        sides: [BeamPermit::Open; 2],
    })
}

fn path_state() -> Datagram {
    Datagram::PathState(PathState {
        tick: 1,
        time_us: 1000,
        sent_us: 1000,
        path_id: 1,
        s_mm: 0.0,
        speed_mm_s: 0.0,
        pose: [0.0; 9],
        tracking: false,
        beams: [false; 2],
        superimposed_rate: [0.0; 3],
    })
}

fn heard(bench: &mut Bench) -> Vec<Datagram> {
    bench.steps(2);
    bench
        .firmware
        .datagrams
        .drain(..)
        .map(|(datagram, ..)| datagram)
        .collect()
}

#[test]
fn another_board_that_is_not_there_does_not_hold_up_the_pc() {
    let mut bench = Bench::subscribed();
    bench.link.set_partner(Partner {
        source: NOBODY,
        session: 5,
    });
    for k in 0..12 {
        bench.link.send_to_partner(&measurement(1000));
        bench.link.send_to_pc(&measurement(k));
        bench.step();
    }
    bench.step();
    assert_eq!(bench.datagrams(), (0..12).map(measurement).collect::<Vec<_>>());

    // Nor does what waits for it hold up the board that is found later.
    bench.link.set_partner(Partner {
        source: SUBSCRIBER,
        session: bench.number,
    });
    bench.link.send_to_partner(&measurement(50));
    // The socket asks for a missing neighbour once a second.
    bench.steps(1000);
    assert_eq!(bench.datagrams(), [measurement(50)]);
}

#[test]
fn datagrams_are_taken_of_the_pc_and_the_other_board_only_and_with_their_number() {
    let clock = Datagram::ClockRequest(ClockRequest { asked_us: 1 });
    let mut bench = Bench::greeted();
    // Without a subscription no datagram is accepted, whatever number is guessed.
    for number in [0, 1] {
        bench.say(number, &measurement(1));
        bench.say(number, &clock);
    }
    assert!(heard(&mut bench).is_empty() && bench.datagrams().is_empty());
    bench.subscribe();
    let (number, stranger) = (
        bench.number,
        Source {
            port: PC_PORT + 1,
            ..SUBSCRIBER
        },
    );
    bench.say(number ^ 1, &measurement(2));
    bench.say(number ^ 1, &clock);
    bench.say(number, &permit());
    assert!(heard(&mut bench).is_empty() && bench.datagrams().is_empty());
    bench.say(number, &measurement(3));
    assert_eq!(heard(&mut bench), [measurement(3)]);

    // Another port of the same host is not the other board, nor is another number.
    for (source, session, taken) in [
        (stranger, 77, false),
        (SUBSCRIBER, 78, false),
        (SUBSCRIBER, 77, true),
    ] {
        bench.link.set_partner(Partner { source, session });
        bench.say(77, &permit());
        assert_eq!(
            heard(&mut bench).len(),
            usize::from(taken),
            "{source:?} {session}"
        );
    }
    assert_eq!(bench.link.counters().strange_datagrams, 9);
}

#[test]
fn the_tracker_board_finds_the_motion_board_by_the_number_of_its_session() {
    let mut bench = Bench::of(Identity {
        role: Role::Tracker,
        ..identity()
    });
    bench.connect();
    bench.greet();
    bench.subscribe();
    bench.say(bench.number ^ 1, &path_state());
    assert!(heard(&mut bench).is_empty() && !bench.link.send_to_partner(&permit()));
    bench.say(bench.number, &path_state());
    assert_eq!(heard(&mut bench), [path_state()]);
    assert!(bench.link.send_to_partner(&permit()));
    bench.steps(2);
    assert_eq!(bench.datagrams(), [permit()]);
    // With the session the other board is forgotten.
    bench.stream().close();
    bench.steps(20);
    bench.say(bench.number, &path_state());
    assert!(heard(&mut bench).is_empty() && !bench.link.send_to_partner(&permit()));
}
