//! How a session begins and ends, and who has it.

use crate::bench::{BOARD, Bench, PC, STEP, client};
use shared::protocol::framing::MAX_MESSAGE;
use shared::protocol::{REQUEST_PORT, Refusal, Request, Response};
use smoltcp::socket::tcp;
use smoltcp::wire::{IpEndpoint, Ipv4Address};

#[test]
fn an_impossible_length_ends_the_session_and_the_board_listens_again() {
    for length in [0, MAX_MESSAGE + 1, 0xFFFF] {
        let mut bench = Bench::greeted();
        bench.stream().send_slice(&(length as u16).to_le_bytes()).unwrap();
        bench.steps(10);
        assert!(!bench.stream().is_open());
        assert_eq!(
            (bench.link.session(), bench.link.counters().broken_streams),
            (None, 1)
        );
        bench.connect();
        assert_eq!(
            bench.request(&Request::Status),
            Some(Response::Refused(Refusal::WrongSchema))
        );
    }
}

#[test]
fn after_a_session_the_next_one_starts_from_hello_without_subscriber() {
    let mut bench = Bench::subscribed();
    assert!(bench.link.is_subscribed());
    // An orderly end, then an abrupt one.
    for abrupt in [false, true] {
        if abrupt {
            bench.stream().abort();
        } else {
            bench.stream().close();
        }
        bench.steps(20);
        assert_eq!((bench.link.session(), bench.link.is_subscribed()), (None, false));
        assert_eq!(bench.firmware.sessions_ended, 1 + u32::from(abrupt));
        bench.reconnect();
        assert_eq!(
            bench.request(&Request::Status),
            Some(Response::Refused(Refusal::WrongSchema))
        );
    }
    assert_eq!(bench.link.counters().sessions, 3);
}

#[test]
fn a_second_pc_is_turned_away_and_the_first_does_not_notice() {
    let mut bench = Bench::greeted();
    let first = bench.stream;
    bench.stream = bench.sockets.add(client());
    bench.connect();
    assert!(!bench.stream().is_open());
    bench.stream = first;
    assert_eq!(bench.request(&Request::Status), Some(Response::Done));
}

#[test]
fn a_pc_that_vanishes_or_falls_silent_is_given_up() {
    let mut bench = Bench::greeted();
    // A request every 4 s renews the lease of 5 s.
    for _ in 0..3 {
        bench.steps(4000);
        assert_eq!(bench.request(&Request::Status), Some(Response::Done));
    }
    for cut in [false, true] {
        // The cable is cut: every frame of the PC is lost. Else its TCP acknowledges what it is asked.
        bench.pc_end.lossy = u32::from(cut);
        bench.steps(4400);
        assert!(bench.link.session().is_some());
        bench.steps(1500);
        assert_eq!(bench.link.session(), None);
        assert_eq!(bench.firmware.sessions_ended, 1 + u32::from(cut));
        bench.pc_end.lossy = 0;
        bench.reconnect();
        assert_eq!(bench.link.session(), Some(PC));
        bench.greet();
    }
}

#[test]
fn who_connects_and_says_no_hello_loses_the_place() {
    let mut bench = Bench::new();
    bench.connect();
    bench.steps(400);
    assert_eq!(bench.link.session(), Some(PC));
    bench.steps(200);
    assert_eq!(bench.link.session(), None);
    assert_eq!(bench.link.counters().silent_sessions, 1);
}

#[test]
fn a_connection_that_is_never_completed_loses_the_place() {
    let mut bench = Bench::new();
    bench.step();
    // The first frame of a connection gets through, and nothing after it.
    let (port, handle) = (39_999, bench.stream);
    let board = IpEndpoint::new(Ipv4Address::from(BOARD).into(), REQUEST_PORT);
    bench
        .sockets
        .get_mut::<tcp::Socket>(handle)
        .connect(bench.pc.context(), board, port)
        .unwrap();
    bench.steps(1);
    bench.pc_end.lossy = 1;
    bench.steps(800);
    bench.pc_end.lossy = 0;
    bench.reconnect();
    assert_eq!(bench.link.session(), Some(PC));
}

#[test]
fn no_two_sessions_have_the_same_number() {
    let mut bench = Bench::subscribed();
    let mut numbers = vec![bench.number];
    for _ in 0..20 {
        bench.stream().abort();
        bench.steps(20);
        bench.reconnect();
        bench.greet();
        bench.subscribe();
        assert!(bench.number != 0 && !numbers.contains(&bench.number));
        numbers.push(bench.number);
    }
}

#[test]
fn the_board_announces_itself_until_the_first_session() {
    let mut bench = Bench::new();
    let line = bench.board_end.outgoing.clone();
    let announcements = |bench: &mut Bench, steps: u32| {
        let mut seen = 0;
        for _ in 0..steps {
            let now = bench.now.get() + STEP;
            bench.now.set(now);
            bench
                .link
                .poll(&mut bench.board_end, |_| now, || now, &mut bench.firmware);
            // Broadcast, ARP, from and for the board's own address.
            let arp = |frame: &Vec<u8>| frame[..6] == [0xFF; 6] && frame[12..14] == [8, 6];
            let own = |frame: &Vec<u8>| frame[28..32] == BOARD && frame[38..42] == BOARD;
            seen += line
                .borrow_mut()
                .drain(..)
                .filter(|frame| arp(frame) && own(frame))
                .count();
        }
        seen
    };
    assert_eq!(announcements(&mut bench, 3000), 3);
    bench.connect();
    assert_eq!(announcements(&mut bench, 3000), 0);
}
