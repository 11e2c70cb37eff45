//! Datagrams of the PC, and those to it.

use crate::bench::{Bench, STEP, SUBSCRIBER, measurement};
use shared::protocol::framing::encode_datagram;
use shared::protocol::{ClockReply, ClockRequest, Datagram};

#[test]
fn datagrams_come_with_their_source_and_arrival_and_bad_ones_are_counted() {
    let mut bench = Bench::subscribed();
    let mut buffer = [0; 256];
    let good = encode_datagram(bench.number, &measurement(7), &mut buffer)
        .unwrap()
        .to_vec();
    let mut foreign = good.clone();
    foreign[0] ^= 1;
    let mut malformed = good.clone();
    malformed.push(0);
    for bytes in [&foreign[..], &malformed, &[], &[1, 2, 3], &[0xEE; 1470], &good] {
        bench.send_datagram(bytes);
    }
    bench.steps(5);
    let counters = bench.link.counters();
    assert_eq!(counters.foreign_datagrams, 2);
    assert_eq!(counters.malformed_datagrams, 3);
    assert_eq!(counters.datagrams, 1);
    let [(datagram, from, arrived_us)] = &bench.firmware.datagrams[..] else {
        panic!("one datagram expected")
    };
    assert_eq!((datagram, *from), (&measurement(7), SUBSCRIBER));
    assert_eq!(arrived_us % STEP, STEP - 40);
}

#[test]
fn a_burst_of_datagrams_is_taken_without_loss() {
    let mut bench = Bench::subscribed();
    for k in 0..15 {
        bench.say(bench.number, &measurement(k));
    }
    bench.step();
    let numbers: Vec<_> = bench
        .firmware
        .datagrams
        .iter()
        .map(|(datagram, ..)| datagram.clone())
        .collect();
    assert_eq!(numbers, (0..15).map(measurement).collect::<Vec<_>>());
}

#[test]
fn the_board_tells_its_clock() {
    let mut bench = Bench::subscribed();
    let request = Datagram::ClockRequest(ClockRequest { asked_us: 123 });
    bench.say(bench.number, &request);
    bench.step();
    let now = bench.now.get();
    let expected = ClockReply {
        asked_us: 123,
        received_us: now - 40,
        replied_us: now,
    };
    assert_eq!(bench.datagrams(), [Datagram::ClockReply(expected)]);
}

#[test]
fn datagrams_leave_with_flush_and_those_without_room_are_counted() {
    let mut bench = Bench::subscribed();
    assert!(bench.link.send_to_pc(&measurement(1)));
    bench.link.flush(&mut bench.board_end, bench.now.get());
    bench.step();
    assert_eq!(bench.datagrams(), [measurement(1)]);

    let accepted = (0..100)
        .filter(|k| bench.link.send_to_pc(&measurement(*k)))
        .count();
    bench.steps(3);
    assert_eq!(bench.datagrams().len(), accepted);
    assert_eq!(bench.link.counters().unsent as usize, 100 - accepted);
}
