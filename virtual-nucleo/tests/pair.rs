//! Both boards on one net, spoken to as a program on the PC does.

mod common;

use common::shipped;
use plant_file::PlantChoice;
use shared::protocol::framing::{MAX_MESSAGE, decode_message, encode_message};
use shared::protocol::{Request, Response, Role, SCHEMA_HASH};
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use virtual_nucleo::pair::Pair;
use virtual_nucleo::time::Time;

/// The link is there some 1.5 s after power-up; nothing here takes longer than this.
const LONGEST: Time = Time::ms(6000);

fn ask(stream: &mut TcpStream, request: &Request) -> io::Result<Response> {
    let mut buffer = [0; 2 + MAX_MESSAGE];
    stream.write_all(encode_message(request, &mut buffer).map_err(io::Error::other)?)?;
    let mut prefix = [0; 2];
    stream.read_exact(&mut prefix)?;
    let body = buffer
        .get_mut(..usize::from(u16::from_le_bytes(prefix)))
        .ok_or(io::ErrorKind::InvalidData)?;
    stream.read_exact(body)?;
    decode_message(body).map_err(io::Error::other)
}

/// Both boards with their shipped images, out of reset.
fn both() -> Pair {
    let images = [shipped("motion"), shipped("tracker")];
    Pair::start(
        [&images[0], &images[1]],
        plant_file::DEFAULT_MACHINE,
        &PlantChoice::Shipped,
    )
    .expect("both run")
}

#[test]
fn both_boards_say_who_they_are() {
    let mut pair = both();
    let ports = pair.ports().expect("there are some");
    let over = AtomicBool::new(false);
    let answers = std::thread::scope(|scope| {
        let asking = scope.spawn(|| {
            let answers = ports.map(|(requests, _)| {
                let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, requests))?;
                stream.set_read_timeout(Some(Duration::from_secs(60)))?;
                ask(
                    &mut stream,
                    &Request::Hello {
                        schema_hash: SCHEMA_HASH,
                    },
                )
            });
            over.store(true, Ordering::Relaxed);
            answers
        });
        while !over.load(Ordering::Relaxed) && pair.now() < LONGEST {
            pair.run_slice();
        }
        drop(pair);
        asking.join().expect("no panic")
    });
    for (answer, role) in answers.into_iter().zip([Role::Motion, Role::Tracker]) {
        match answer {
            Ok(Response::Identity(identity)) => assert_eq!(identity.role, role),
            other => panic!("instead of an identity: {other:?}"),
        }
    }
}

#[test]
fn the_boards_are_on_the_net_after_their_phys_have_negotiated_and_not_before() {
    let mut pair = both();
    // The model's PHYs negotiate for 1.5 s.
    assert!(!pair.run_to_link(Time::ms(1500)), "at {}", pair.now());
    assert!(pair.run_to_link(LONGEST));
    println!("on the net: {}", pair.now());
}
