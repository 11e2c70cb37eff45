//! Requests and their answers.

use crate::bench::{BOARD, Bench, PC, PC_PORT, identity};
use shared::protocol::framing::encode_message;
use shared::protocol::{Refusal, Request, Response, SCHEMA_HASH};

#[test]
fn requests_are_answered_in_order() {
    let mut bench = Bench::greeted();
    assert_eq!(bench.link.session(), Some(PC));
    bench.send(&Request::Status);
    bench.send(&Request::Home);
    bench.send(&Request::Status);
    bench.steps(50);
    let answers: Vec<_> = std::iter::from_fn(|| bench.answer()).collect();
    let refused = Response::Refused(Refusal::NotMine);
    assert_eq!(answers, [Response::Done, refused, Response::Done]);
    assert_eq!(
        bench.firmware.requests,
        [Request::Status, Request::Home, Request::Status]
    );
    assert_eq!(bench.link.counters().requests, 4);
}

#[test]
fn a_request_may_come_byte_by_byte() {
    let mut bench = Bench::greeted();
    let mut buffer = [0; 64];
    let bytes = encode_message(
        &Request::PathStatesTo {
            address: BOARD,
            port: 7,
            session: 9,
        },
        &mut buffer,
    )
    .unwrap();
    for byte in bytes {
        assert_eq!(bench.answer(), None);
        bench.stream().send_slice(&[*byte]).unwrap();
        bench.steps(3);
    }
    bench.steps(20);
    assert_eq!(bench.answer(), Some(Response::Refused(Refusal::NotMine)));
}

#[test]
fn a_long_run_of_requests_is_answered_completely_even_if_the_pc_reads_late() {
    let mut bench = Bench::greeted();
    for _ in 0..2000 {
        bench.send(&Request::Status);
    }
    bench.steps(1000);
    let answers = std::iter::from_fn(|| bench.answer()).count();
    assert_eq!((answers, bench.firmware.requests.len()), (2000, 2000));
}

#[test]
fn malformed_bytes_are_refused_and_the_session_goes_on() {
    let mut bench = Bench::greeted();
    bench.stream().send_slice(&[3, 0, 0xFF, 0xFF, 0xFF]).unwrap();
    bench.steps(10);
    assert_eq!(bench.answer(), Some(Response::Refused(Refusal::Malformed)));
    assert_eq!(bench.request(&Request::Status), Some(Response::Done));
    assert_eq!(bench.link.counters().malformed_requests, 1);
}

#[test]
fn nothing_but_hello_is_answered_before_a_hello_of_the_same_schema() {
    let mut bench = Bench::new();
    bench.connect();
    let refused = Some(Response::Refused(Refusal::WrongSchema));
    assert_eq!(bench.request(&Request::Status), refused);
    let other = Request::Hello {
        schema_hash: SCHEMA_HASH ^ 1,
    };
    assert_eq!(bench.request(&other), Some(Response::Identity(identity())));
    assert_eq!(bench.request(&Request::Status), refused);
    assert_eq!(bench.request(&Request::Subscribe { port: PC_PORT }), refused);
    assert!(!bench.link.is_subscribed());
    assert!(bench.firmware.requests.is_empty());
}

#[test]
fn requests_come_through_a_line_that_loses_frames() {
    let mut bench = Bench::greeted();
    bench.pc_end.lossy = 7;
    bench.board_end.lossy = 10;
    for _ in 0..30 {
        assert_eq!(bench.request(&Request::Status), Some(Response::Done));
    }
    assert_eq!(bench.firmware.requests.len(), 30);
}
