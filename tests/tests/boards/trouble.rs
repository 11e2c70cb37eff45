//! Jobs that are refused, interrupted or cut off: the machine stands on its path, the beams and, but for the
//! operator's work, the drives are off, and nothing is left running.

use crate::pair::{Pair, scratch, status};
use crate::process::Process;
use host_link::boards::Boards;
use job::JobError;
use nix::sys::signal::Signal;
use serde_json::Value;
use shared::protocol::{Datagram, MotionSample, TELEMETRY_BATCH};
use shared::state::{Fault, State, TrackerState};
use std::fs;
use std::time::{Duration, Instant};
use system_tests::{assert_on_seam, seam, seam_file, shipped_seam, weld};

/// Beyond the travel of V2 in the middle of the weld.
fn far(s: f64) -> [f64; 4] {
    [0.0, 0.0, 0.0, 13.0 - (s - 200.0).abs() / 20.0]
}

#[test]
fn ctrl_c_stops_on_the_path_and_leaves_a_report_and_the_drives_off() {
    let mut pair = Pair::boot("ctrl-c");
    let mut seamwright = Process::start(pair.seamwright(None));
    seamwright.wait_for("welding");
    seamwright.signal(Signal::SIGINT);
    let (status, said) = seamwright.end();
    assert_eq!(status.code(), Some(130), "{said:#?}");
    assert!(
        said.last()
            .is_some_and(|last| last.contains("stopped by the operator")),
        "{said:#?}"
    );

    let text = fs::read(pair.report().join("report.json")).expect("a report");
    let report: Value = serde_json::from_slice(&text).expect("JSON");
    assert_eq!(report["outcome"], "interrupted");
    let welded = report["weld_length_mm"].as_f64().expect("a number");
    assert!((0.0..200.0).contains(&welded), "{welded} mm");

    let log = fs::read_to_string(pair.report().join("log.csv")).expect("a log");
    let mut lines = log.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let heading = lines.next().expect("a heading");
    let column = |name: &str| heading.iter().position(|n| *n == name).expect(name);
    // The last tick on the path.
    let last = lines
        .rfind(|line| !line[column("contour_error_mm")].is_empty())
        .expect("ticks");
    let value = |name: &str| last[column(name)].parse::<f64>().expect(name);
    assert_eq!((value("beam_1"), value("beam_2")), (0.0, 0.0));
    assert!(value("speed_m_per_min").abs() < 0.05, "{last:?}");
    assert!(value("contour_error_mm") < 0.05, "{last:?}");
    pair.assert_off();
}

#[test]
fn a_refused_job_leaves_the_drives_off() {
    let mut pair = Pair::boot("refused");
    let file = scratch("far.csv");
    fs::write(&file, seam_file(far)).expect("the scratch folder is writable");
    let (status, said) = Process::start(pair.seamwright(Some(&file))).end();
    assert_eq!((status.code(), said.len()), (Some(1), 1), "{said:#?}");
    assert!(
        said[0].contains("V2") && said[0].contains("beyond its travel"),
        "{said:#?}"
    );
    let (motion, tracker) = pair.assert_off();
    assert!(
        !motion.homed && !tracker.homed,
        "the boards were not asked to move"
    );

    // The job itself finds out when the drives are on.
    let ended = weld(&mut pair.connect(), seam(far), 5.0);
    assert!(
        matches!(ended.error, Some(JobError::Surroundings(_))),
        "{:?}",
        ended.error
    );
    let (motion, tracker) = pair.assert_off();
    assert!(motion.homed && tracker.homed);
}

#[test]
fn without_the_pc_the_machine_stops_on_its_path_and_welds_again_later() {
    let mut pair = Pair::boot("vanished");
    let mut seamwright = Process::start(pair.seamwright(None));
    seamwright.wait_for("welding");
    seamwright.signal(Signal::SIGKILL);
    let killed = Instant::now();
    seamwright.end();
    let log = fs::read_to_string(pair.report().join("log.csv")).expect("a log");

    // A stranger who connects, says Hello, and asks for the state does not take the path over.
    let mut boards = pair.connect();
    status(&mut boards);
    let (mut samples, mut first_heard) = (Vec::<MotionSample>::new(), None);
    let end = Instant::now() + Duration::from_secs(30);
    while samples.last().is_none_or(|last| last.state != State::Fault) {
        assert!(Instant::now() < end, "no fault after {} ms", samples.len());
        let received = boards.receive(Duration::from_millis(10));
        if let Some((_, Datagram::MotionTelemetry(telemetry))) = received.expect("datagrams") {
            first_heard.get_or_insert_with(Instant::now);
            samples.extend(telemetry.samples);
        }
    }
    // What the PC left tells of the weld to within a second, in whole lines but for the last one.
    let columns = log.lines().next().expect("a heading").split(',').count();
    let whole = log
        .lines()
        .rfind(|line| line.split(',').count() == columns)
        .expect("ticks");
    let logged: u32 = whole
        .split(',')
        .next()
        .and_then(|tick| tick.parse().ok())
        .expect("a tick");
    let missing = samples[0].tick - logged;
    let since = first_heard.expect("samples").duration_since(killed).as_millis();
    assert!(u128::from(missing) <= 1000 + since, "{missing} ticks, {since} ms");

    // The end of its session shut the beams and began the stop before anybody else had one: only the first samples may be
    // of a batch that was begun before.
    let stops = samples
        .iter()
        .position(|sample| sample.state != State::Running)
        .expect("a stop");
    assert!(
        stops <= TELEMETRY_BATCH,
        "{stops} ticks after the new session began"
    );
    for sample in &samples[stops + 1..] {
        assert_eq!(sample.beams, [false; 2], "{sample:?}");
        assert!(
            matches!(sample.state, State::Stopping | State::Fault),
            "{sample:?}"
        );
    }
    let (motion, tracker) = status(&mut boards);
    assert_eq!(motion.fault, Some(Fault::SessionEnded));
    assert_ne!(tracker.state, TrackerState::Tracking);

    assert_on_seam(&weld(&mut boards, shipped_seam(), 9.0), 0.05);
    drop(boards);
    pair.assert_off();
}
