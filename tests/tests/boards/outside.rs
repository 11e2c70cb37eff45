//! What happens around the boards during a weld: a PC that dies or is paused, and a crowd on the network. The machine stops on its
//! path, and who is blamed is who it was.

use crate::pair::{Pair, assert_served, status};
use crate::process::{Process, wait_until};
use emulator::{BoardTime, Session};
use nix::sys::signal::Signal;
use serde_json::Value;
use shared::protocol::framing::{MAX_DATAGRAM, encode_datagram};
use shared::protocol::{
    BeamPermit, ClockReply, ClockRequest, Datagram, Measurement, PathState, Permit, SideMeasurement,
};
use shared::state::State;
use std::fs;
use std::net::{Ipv4Addr, SocketAddr, TcpStream, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use system_tests::{assert_on_seam, shipped_seam, weld};

/// No crowd lasts longer than this.
const LONGEST: Duration = Duration::from_secs(180);
/// So many frames go to each board at once, so often.
const FRAMES: u32 = 10;
const FRAMES_EVERY: Duration = Duration::from_millis(2);
/// A connection to each board is begun so often.
const CONNECTS_EVERY: Duration = Duration::from_millis(20);
/// So often the time of the boards is looked at.
const LOOK: Duration = Duration::from_micros(100);
/// Speed of the weld in a crowd \[m/min\].
const FAST: f64 = 9.0;
/// Speed of welds that are paused \[m/min\]: a computer that is busy for 0.1 s does not lose the seam.
const SLOW: &str = "3";
/// A connection that says nothing keeps its place for so long, by the time of the boards.
const LEASE: Duration = Duration::from_secs(5);
/// Longer than a machine takes to miss its PC and to stop, by the time of the boards.
const STOPPED: Duration = Duration::from_secs(2);

/// From the beginning of the path to well inside the weld, by the time of the boards.
const BEAMS_ON: Duration = Duration::from_secs(2);

/// Waits until the boards have gone on for so long by their own time, which goes slower than the wall's on a busy computer.
#[track_caller]
fn let_pass(pair: &Pair, time: Duration) {
    let boards = BoardTime::of(&pair.session().pace).expect("boards that run");
    let now = || boards.now().expect("boards that run");
    let begin = now();
    wait_until("the boards", || now() - begin >= time);
}

/// A program that welds, paused when its beams have been on for a while.
fn paused(pair: &Pair) -> Process {
    let mut command = pair.seamwright(None);
    command.args(["--speed", SLOW]);
    let mut seamwright = Process::start(command);
    seamwright.wait_for("welding");
    let_pass(pair, BEAMS_ON);
    seamwright.signal(Signal::SIGSTOP);
    seamwright
}

/// Checks that what was paused says so and ends with an error, and that nothing moves or burns.
#[track_caller]
fn assert_blames_itself(seamwright: Process, pair: &Pair) {
    seamwright.signal(Signal::SIGCONT);
    let (status, said) = seamwright.end();
    println!("{said:#?}");
    assert_eq!(status.code(), Some(1), "{said:#?}");
    let last = said.last().expect("an error");
    assert!(last.contains("this PC was stalled for"), "{last}");
    let report = fs::read_to_string(pair.report().join("report.json")).expect("a report");
    let report: Value = serde_json::from_str(&report).expect("JSON");
    let welded = report["weld_length_mm"].as_f64().expect("a number");
    assert!((10.0..390.0).contains(&welded), "{welded} mm");
}

#[test]
fn a_pc_that_is_paused_stops_the_machine_and_blames_itself() {
    let pair = Pair::boot("pc-paused");
    let seamwright = paused(&pair);
    let_pass(&pair, STOPPED);
    assert_blames_itself(seamwright, &pair);
    let (motion, _) = status(&mut pair.connect());
    assert_eq!(motion.state, State::Fault, "{:?}", motion.fault);
}

#[test]
fn a_pc_that_is_started_anew_takes_the_place_of_one_that_is_silent() {
    let mut pair = Pair::boot("pc-anew");
    let silent = paused(&pair);
    let_pass(&pair, LEASE + Duration::from_millis(100));
    let mut anew = Process::start(pair.seamwright(None));
    anew.wait_for("searching reference marks");
    assert_blames_itself(silent, &pair);
    // The marks are a minute away.
    anew.signal(Signal::SIGINT);
    let (status, said) = anew.end();
    assert_eq!(status.code(), Some(130), "{said:#?}");
    pair.assert_off();
}

/// A crowd that sends frames of every kind to both boards, until dropped: 10⁴ a second in all, and 100 connections, by the
/// time of the boards.
struct Crowd {
    over: Arc<AtomicBool>,
    threads: Vec<JoinHandle<u32>>,
}

impl Crowd {
    fn on(session: &Session) -> Self {
        let over = Arc::new(AtomicBool::new(false));
        let mut threads = Vec::new();
        let mut add = |every, act: Box<dyn FnMut() -> u32 + Send>| {
            let (over, time) = (
                Arc::clone(&over),
                BoardTime::of(&session.pace).expect("boards that run"),
            );
            threads.push(thread::spawn(move || again(&over, &time, every, act)));
        };
        for board in [session.motion, session.tracker] {
            add(FRAMES_EVERY, Box::new(frames(board.datagrams())));
            add(CONNECTS_EVERY, Box::new(move || connect(board.requests())));
        }
        Self { over, threads }
    }

    /// Frames and connections.
    fn end(self) -> u32 {
        self.over.store(true, Ordering::Relaxed);
        self.threads
            .into_iter()
            .map(|thread| thread.join().expect("no panic"))
            .sum()
    }
}

/// Acts every so often, by `time`; how much that was. What came late is not made up for at once: that would be another
/// crowd.
fn again(
    over: &AtomicBool,
    time: &BoardTime,
    every: Duration,
    mut act: Box<dyn FnMut() -> u32 + Send>,
) -> u32 {
    let (begin, mut due, mut done) = (Instant::now(), Duration::ZERO, 0);
    while !over.load(Ordering::Relaxed) && begin.elapsed() < LONGEST {
        let now = time.now().expect("boards that run");
        if now < due {
            thread::sleep(LOOK);
            continue;
        }
        due = (due + every).max(now);
        done += act();
    }
    done
}

/// Some frames to one board: what is no datagram, what is of another version, and datagrams of every kind with the numbers
/// of other sessions.
fn frames(board: SocketAddr) -> impl FnMut() -> u32 {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
    let mut frames = forged().into_iter().cycle();
    move || {
        for frame in frames.by_ref().take(FRAMES as usize) {
            // A system that has no room drops them.
            let _ = socket.send_to(&frame, board);
        }
        FRAMES
    }
}

fn connect(board: SocketAddr) -> u32 {
    drop(TcpStream::connect_timeout(&board, Duration::from_millis(100)));
    1
}

fn forged() -> Vec<Vec<u8>> {
    let pose = [1000.0, 1000.0, 100.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let side = SideMeasurement {
        along_mm: 0.0,
        delta_u_mm: 0.5,
        delta_v_mm: 0.5,
    };
    let datagrams = [
        Datagram::PathState(PathState {
            tick: 1_000_000,
            time_us: 1 << 40,
            sent_us: 1 << 40,
            path_id: 1,
            s_mm: 10.0,
            speed_mm_s: 150.0,
            pose,
            tracking: true,
            beams: [true; 2],
            superimposed_rate: [0.0; 3],
        }),
        Datagram::Permit(Permit {
            tick: 1_000_000,
            path_id: 1,
            sides: [BeamPermit::No; 2],
        }),
        Datagram::Measurement(Measurement {
            capture: 100,
            sides: [Some(side); 2],
        }),
        Datagram::ClockRequest(ClockRequest { asked_us: 5 }),
        Datagram::ClockReply(ClockReply {
            asked_us: 5,
            received_us: 30_000,
            replied_us: 30_000,
        }),
    ];
    let mut frames = vec![vec![], vec![0; 3], vec![0xEE; 1400]];
    let mut buffer = [0; MAX_DATAGRAM];
    for (number, datagram) in (0..).zip(&datagrams) {
        let bytes = encode_datagram(number, datagram, &mut buffer).expect("fits");
        frames.push(bytes.to_vec());
        let mut foreign = bytes.to_vec();
        foreign[0] ^= 1;
        frames.push(foreign);
    }
    frames
}

#[test]
fn a_crowd_on_the_network_changes_nothing() {
    let mut pair = Pair::boot("crowd");
    let time = BoardTime::of(&pair.session().pace).expect("boards that run");
    let now = || time.now().expect("boards that run").as_secs_f64();
    let crowd = Crowd::on(pair.session());
    let begin = now();
    let ended = weld(&mut pair.connect(), shipped_seam(), FAST);
    let seconds = now() - begin;
    let sent = crowd.end();
    println!("{:.0} frames and connections a second", f64::from(sent) / seconds);
    assert_on_seam(&ended, 0.03);
    assert_served(&ended.report);
    pair.assert_off();
}
