//! Sessions with boards that are threads of the test, well behaved or not.

use super::*;
use shared::protocol::{ClockRequest, Refusal, SCHEMA_HASH};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream, UdpSocket};
use std::thread::JoinHandle;

const BRIEF: Timeouts = Timeouts {
    connect: Duration::from_millis(500),
    answer: Duration::from_millis(300),
};
/// Number of the sessions of all fakes.
const SESSION: u32 = 0x0102_0304;
const AMPLE: Duration = Duration::from_secs(10);

/// A board on this machine that takes one session and answers with `answer`; the thread ends with the
/// session. `None` leaves the request unanswered, empty bytes end the session.
struct Fake {
    endpoint: Endpoint,
    datagrams: UdpSocket,
    /// Where the PC wants its datagrams, once it has said so.
    subscriber: Arc<AtomicU32>,
    thread: Option<JoinHandle<()>>,
}

impl Fake {
    fn new(mut answer: impl FnMut(Request) -> Option<Vec<u8>> + Send + 'static) -> Self {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let datagrams = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        datagrams.set_read_timeout(Some(AMPLE)).unwrap();
        let endpoint = Endpoint {
            host: "127.0.0.1".into(),
            request_port: listener.local_addr().unwrap().port(),
            datagram_port: datagrams.local_addr().unwrap().port(),
        };
        let thread = std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            stream.set_read_timeout(Some(AMPLE)).unwrap();
            let mut prefix = [0; 2];
            while stream.read_exact(&mut prefix).is_ok() {
                let mut body = vec![0; usize::from(u16::from_le_bytes(prefix))];
                stream.read_exact(&mut body).unwrap();
                let Some(bytes) = answer(framing::decode_message(&body).unwrap()) else {
                    continue;
                };
                if bytes.is_empty() {
                    return;
                }
                // In two pieces, as a stream may bring it.
                let (head, tail) = bytes.split_at(1);
                stream.write_all(head).unwrap();
                stream.write_all(tail).unwrap();
            }
        });
        Self {
            endpoint,
            datagrams,
            subscriber: Arc::default(),
            thread: Some(thread),
        }
    }

    /// A board of `role` that answers Hello and Subscribe, and everything else with `answer`.
    fn board(role: Role, mut answer: impl FnMut(Request) -> Option<Vec<u8>> + Send + 'static) -> Self {
        let subscriber = Arc::new(AtomicU32::new(0));
        let told = Arc::clone(&subscriber);
        let mut fake = Self::new(move |request| match request {
            Request::Hello { .. } => Some(bytes(&Response::Identity(identity(role)))),
            Request::Subscribe { port } => {
                told.store(u32::from(port), Ordering::Relaxed);
                Some(bytes(&Response::Session { number: SESSION }))
            }
            request => answer(request),
        });
        fake.subscriber = subscriber;
        fake
    }

    /// Sends a datagram of the session `session` to the PC.
    fn send(&self, session: u32, datagram: &Datagram) {
        let mut buffer = [0; 64];
        self.send_bytes(framing::encode_datagram(session, datagram, &mut buffer).unwrap());
    }

    fn send_bytes(&self, bytes: &[u8]) {
        let port = self.subscriber.load(Ordering::Relaxed) as u16;
        self.datagrams.send_to(bytes, ("127.0.0.1", port)).unwrap();
    }

    fn silent(role: Role) -> Self {
        Self::board(role, |_| None)
    }
}

impl Drop for Fake {
    fn drop(&mut self) {
        // Wakes a thread that still waits for its session.
        let _ = TcpStream::connect(("127.0.0.1", self.endpoint.request_port));
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn identity(role: Role) -> Identity {
    Identity {
        schema_hash: SCHEMA_HASH,
        role,
        firmware: "0.1.0".try_into().unwrap(),
        board: "fake".try_into().unwrap(),
        simulated_machine: true,
    }
}

fn bytes(response: &Response) -> Vec<u8> {
    let mut buffer = [0; 2050];
    framing::encode_message(response, &mut buffer).unwrap().to_vec()
}

fn connect(motion: &Fake, tracker: &Fake) -> Result<NetworkBoards, LinkError> {
    NetworkBoards::connect(&motion.endpoint, Some(&tracker.endpoint), None, BRIEF)
}

fn message(result: Result<NetworkBoards, LinkError>) -> String {
    result.err().expect("must not connect").to_string()
}

#[test]
fn requests_go_to_the_board_they_are_meant_for() {
    let answer = |request| {
        let response = match request {
            Request::Home => Response::Done,
            _ => Response::Refused(Refusal::NotHomed),
        };
        Some(bytes(&response))
    };
    let motion = Fake::board(Role::Motion, answer);
    let tracker = Fake::board(Role::Tracker, |_| {
        Some(bytes(&Response::Refused(Refusal::NotMine)))
    });
    let mut boards = connect(&motion, &tracker).unwrap();
    assert_eq!(boards.identity(Role::Tracker), Some(&identity(Role::Tracker)));
    for _ in 0..3 {
        assert_eq!(
            boards.request(Role::Motion, &Request::Home).unwrap(),
            Response::Done
        );
        let refused = boards.request(Role::Tracker, &Request::Home).unwrap();
        assert_eq!(refused, Response::Refused(Refusal::NotMine));
    }
    let status = boards.request(Role::Motion, &Request::Status).unwrap();
    assert_eq!(status, Response::Refused(Refusal::NotHomed));
}

#[test]
fn datagrams_come_from_both_boards_in_order_and_bad_ones_are_counted() {
    let (motion, tracker) = (Fake::silent(Role::Motion), Fake::silent(Role::Tracker));
    let mut boards = connect(&motion, &tracker).unwrap();
    let datagram = |asked_us| Datagram::ClockRequest(ClockRequest { asked_us });
    motion.send_bytes(&[1, 2, 3, 4, 5]);
    // Left over from another session.
    motion.send(SESSION + 1, &datagram(7));
    for k in 0..20 {
        motion.send(SESSION, &datagram(k));
        tracker.send(SESSION, &datagram(100 + k));
    }
    let (mut from_motion, mut from_tracker) = (0, 100);
    for _ in 0..40 {
        let (role, received) = boards.receive(AMPLE).unwrap().unwrap();
        let next = match role {
            Role::Motion => &mut from_motion,
            Role::Tracker => &mut from_tracker,
        };
        assert_eq!(received, datagram(*next));
        *next += 1;
    }
    assert_eq!(boards.receive(Duration::ZERO).unwrap(), None);
    assert_eq!(boards.dropped_datagrams(), 2);
}

#[test]
fn datagrams_reach_the_board() {
    let (motion, tracker) = (Fake::silent(Role::Motion), Fake::silent(Role::Tracker));
    let mut boards = connect(&motion, &tracker).unwrap();
    let datagram = Datagram::ClockRequest(ClockRequest { asked_us: 5 });
    boards.send(Role::Tracker, &datagram).unwrap();
    let mut buffer = [0; 64];
    let (length, from) = tracker.datagrams.recv_from(&mut buffer).unwrap();
    assert_eq!(
        framing::decode_datagram(&buffer[..length]),
        Ok((SESSION, datagram))
    );
    assert_eq!(u32::from(from.port()), tracker.subscriber.load(Ordering::Relaxed));
    assert_eq!(
        boards.path_states_target(),
        Some(Request::PathStatesTo {
            address: [127, 0, 0, 1],
            port: tracker.endpoint.datagram_port,
            session: SESSION,
        })
    );
}

#[test]
fn a_session_without_a_tracker_board_leaves_it_alone() {
    let motion = Fake::silent(Role::Motion);
    let mut boards = NetworkBoards::connect(&motion.endpoint, None, None, BRIEF).unwrap();
    assert!(boards.identity(Role::Motion).is_some());
    assert_eq!(boards.identity(Role::Tracker), None);
    assert_eq!(boards.path_states_target(), None);
    let error = boards.request(Role::Tracker, &Request::Status).unwrap_err();
    assert!(error.to_string().contains("no tracker board"), "{error}");
}

#[test]
fn a_board_that_takes_no_connection_is_named_with_its_address() {
    // A port that was just free, and is not listened on.
    let port = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))
        .unwrap()
        .local_addr()
        .unwrap()
        .port();
    let nowhere = Endpoint {
        request_port: port,
        ..Endpoint::board("127.0.0.1")
    };
    let error = message(NetworkBoards::connect(&nowhere, Some(&nowhere), None, BRIEF));
    assert!(
        error.starts_with(&format!(
            "the motion board at 127.0.0.1:{port} refuses the connection"
        )),
        "{error}"
    );
}

#[test]
fn a_name_that_does_not_exist_is_an_unreachable_board() {
    let nobody = Endpoint::board("no such host");
    let error = message(NetworkBoards::connect(&nobody, Some(&nobody), None, BRIEF));
    assert!(error.contains("does not answer at no such host:7100"), "{error}");
}

#[test]
fn swapped_boards_are_recognised() {
    let (motion, tracker) = (Fake::silent(Role::Motion), Fake::silent(Role::Tracker));
    let error = message(connect(&tracker, &motion));
    assert!(
        error.contains("a tracker board answers") && error.contains("swapped"),
        "{error}"
    );
}

#[test]
fn another_schema_is_recognised() {
    let old = Identity {
        schema_hash: 0x1234,
        ..identity(Role::Motion)
    };
    let motion = Fake::new(move |_| Some(bytes(&Response::Identity(old.clone()))));
    let tracker = Fake::silent(Role::Tracker);
    let error = message(connect(&motion, &tracker));
    assert!(
        error.contains("another version of the protocol") && error.contains("0000000000001234"),
        "{error}"
    );
}

#[test]
fn a_silent_board_is_given_up_and_its_late_answers_are_never_used() {
    let (motion, tracker) = (Fake::silent(Role::Motion), Fake::silent(Role::Tracker));
    let mut boards = connect(&motion, &tracker).unwrap();
    let error = boards
        .request(Role::Motion, &Request::Status)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("motion board was lost (no answer within 0.3 s)"),
        "{error}"
    );
    assert!(matches!(
        boards.request(Role::Motion, &Request::Status),
        Err(LinkError::Lost {
            role: Role::Motion,
            ..
        })
    ));
}

#[test]
fn a_board_that_hangs_up_is_lost() {
    let motion = Fake::board(Role::Motion, |_| Some(Vec::new()));
    let tracker = Fake::silent(Role::Tracker);
    let mut boards = connect(&motion, &tracker).unwrap();
    let error = boards.request(Role::Motion, &Request::Home).unwrap_err();
    assert!(
        matches!(
            error,
            LinkError::Lost {
                role: Role::Motion,
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn an_answer_that_is_no_message_is_an_error_not_a_panic() {
    for answer in [vec![2, 0, 0xFF, 0xFF], vec![0xFF, 0xFF, 1]] {
        let motion = Fake::board(Role::Motion, move |_| Some(answer.clone()));
        let tracker = Fake::silent(Role::Tracker);
        let mut boards = connect(&motion, &tracker).unwrap();
        let error = boards.request(Role::Motion, &Request::Home).unwrap_err();
        assert!(
            matches!(
                error,
                LinkError::Frame {
                    role: Role::Motion,
                    ..
                }
            ),
            "{error}"
        );
    }
}

/// Longer than any test waits on purpose, shorter than for ever.
const LONG: Timeouts = Timeouts {
    connect: Duration::from_secs(2),
    answer: Duration::from_secs(2),
};

/// Sets a flag of the operator's a moment later.
fn interrupts(after: Duration) -> Arc<AtomicBool> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    std::thread::spawn(move || {
        std::thread::sleep(after);
        flag.store(true, Ordering::Relaxed);
    });
    interrupted
}

#[test]
fn a_stop_does_not_wait_for_a_board_that_does_not_answer() {
    let given_up = Arc::new(AtomicBool::new(false));
    let (after, (told, stops)) = (Arc::clone(&given_up), sync_channel(8));
    let motion = Fake::board(Role::Motion, move |request| {
        if request == Request::Stop {
            told.send(after.load(Ordering::Relaxed)).unwrap();
        }
        Some(bytes(&Response::Done))
    });
    let tracker = Fake::silent(Role::Tracker);
    let boards = NetworkBoards::connect(&motion.endpoint, Some(&tracker.endpoint), None, LONG).unwrap();
    let mut boards = boards.stopped_by(interrupts(Duration::from_millis(50)));
    let asked = boards.request(Role::Tracker, &Request::Status);
    given_up.store(true, Ordering::Relaxed);
    assert!(matches!(
        asked,
        Err(LinkError::Lost {
            role: Role::Tracker,
            ..
        })
    ));
    assert_eq!(stops.recv_timeout(AMPLE), Ok(false));
    // The answer to the stop is dropped: the next one is that of the next request.
    let refused = Response::Refused(Refusal::NotHomed);
    drop((boards, motion));
    let motion = Fake::board(Role::Motion, {
        let refused = bytes(&refused);
        move |request| match request {
            // Answered together with the stop only.
            Request::Status => None,
            Request::Stop => Some([refused.as_slice(), &bytes(&Response::Done)].concat()),
            _ => Some(bytes(&Response::Refused(Refusal::NoPath))),
        }
    });
    let boards = NetworkBoards::connect(&motion.endpoint, None, None, LONG).unwrap();
    let mut boards = boards.stopped_by(interrupts(Duration::from_millis(50)));
    assert_eq!(boards.request(Role::Motion, &Request::Status).unwrap(), refused);
    assert_eq!(
        boards.request(Role::Motion, &Request::Run).unwrap(),
        Response::Refused(Refusal::NoPath)
    );
    // One stop is enough.
    assert!(stops.try_recv().is_err());
}

#[test]
fn what_is_asked_is_waited_for_by_nobody_and_taken_when_it_comes() {
    let (answers, held) = sync_channel::<()>(8);
    let motion = Fake::silent(Role::Motion);
    let tracker = Fake::board(Role::Tracker, move |request| {
        held.recv_timeout(AMPLE).unwrap();
        Some(bytes(&match request {
            Request::Status => Response::Refused(Refusal::NotHomed),
            _ => Response::Done,
        }))
    });
    let mut boards = NetworkBoards::connect(&motion.endpoint, Some(&tracker.endpoint), None, LONG).unwrap();
    let poll = |boards: &mut NetworkBoards| {
        boards.receive(Duration::ZERO).unwrap();
        boards.answer(Role::Tracker).unwrap()
    };
    assert_eq!(boards.ask(Role::Tracker, &Request::Status).unwrap(), None);
    for _ in 0..3 {
        assert_eq!(poll(&mut boards), None);
    }
    answers.send(()).unwrap();
    let answer = std::iter::repeat_with(|| poll(&mut boards)).find_map(|answer| answer);
    assert_eq!(answer, Some(Response::Refused(Refusal::NotHomed)));
    // Another request takes its own answer, and not that of what was asked before.
    assert_eq!(boards.ask(Role::Tracker, &Request::Status).unwrap(), None);
    answers.send(()).unwrap();
    answers.send(()).unwrap();
    assert_eq!(
        boards.request(Role::Tracker, &Request::Home).unwrap(),
        Response::Done
    );
}

#[test]
fn a_program_that_was_paused_takes_the_answer_that_waited_for_it_and_knows_of_its_absence() {
    let motion = Fake::board(Role::Motion, |_| Some(bytes(&Response::Done)));
    let mut boards = NetworkBoards::connect(&motion.endpoint, None, None, BRIEF).unwrap();
    assert_eq!(boards.ask(Role::Motion, &Request::Status).unwrap(), None);
    let before = boards.now();
    std::thread::sleep(BRIEF.answer * 2);
    let answer = std::iter::repeat_with(|| {
        boards.receive(Duration::from_millis(10)).unwrap();
        boards.answer(Role::Motion).unwrap()
    });
    assert_eq!(answer.take(20).flatten().next(), Some(Response::Done));
    let last_stall = boards.last_stall().expect("it did nothing for a while");
    assert!(
        last_stall.ended >= before && last_stall.lasted >= BRIEF.answer * 2,
        "{last_stall:?}"
    );
}

#[test]
fn another_thread_ends_a_wait() {
    let motion = Fake::silent(Role::Motion);
    let mut boards = NetworkBoards::connect(&motion.endpoint, None, None, BRIEF).unwrap();
    let waker = boards.waker().unwrap();
    let began = std::time::Instant::now();
    let sleeper = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(50));
        waker.wake();
    });
    assert!(boards.receive(AMPLE).unwrap().is_none());
    assert!(began.elapsed() < AMPLE / 2);
    sleeper.join().unwrap();
}
