//! Steps that a board does by itself.

use super::{Step, inputs};
use host_link::boards::{Boards, LinkError};
use shared::protocol::{Datagram, Request, Response, Role};
use shared::state::{State, TrackerState};
use std::time::Duration;

/// Round trips that are timed.
const ROUND_TRIPS: usize = 200;
/// A board answers within a few milliseconds; a pause of this length is near those that a path may have.
const LONGEST_ANSWER: Duration = Duration::from_millis(100);
/// Time over which ticks and samples are counted.
const COUNTING: Duration = Duration::from_secs(3);
/// Part by which a rate may be off: crystals are within 0.01 %, a round trip is 0.1 % of the time, and a wrong clock tree is off by
/// some per cent.
const OFF: f64 = 0.005;
/// Samples that may be under way at both ends of the time, two batches.
const UNDER_WAY: u32 = 32;

/// Link, converters and clocks.
pub(super) fn steps(boards: &mut dyn Boards, role: Role) -> Result<Vec<Step>, LinkError> {
    Ok(vec![
        answers(boards, role)?,
        converters(boards, role)?,
        ticks(boards, role)?,
    ])
}

fn answers(boards: &mut dyn Boards, role: Role) -> Result<Step, LinkError> {
    let mut times = Vec::with_capacity(ROUND_TRIPS);
    for _ in 0..ROUND_TRIPS {
        let asked = boards.now();
        inputs(boards, role)?;
        times.push(boards.now().saturating_sub(asked));
    }
    times.sort_unstable();
    let (median, longest) = (times[ROUND_TRIPS / 2], times[ROUND_TRIPS - 1]);
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    let good = longest <= LONGEST_ANSWER;
    let found = format!(
        "{ROUND_TRIPS} requests answered, half of them within {:.1} ms, all within {:.1} ms{}",
        ms(median),
        ms(longest),
        if good {
            ""
        } else {
            ": a path stops when the PC is silent for long; look for other traffic, a busy PC, a bad cable"
        }
    );
    Ok(Step::new("requests", good, found))
}

fn converters(boards: &mut dyn Boards, role: Role) -> Result<Step, LinkError> {
    let failed = inputs(boards, role)?.converter_failed;
    let found = if failed {
        "one reads back something else than it was told, and all outputs are off until a reset; the board's log says which: supply, SYNC, SDO and its buffer"
    } else {
        "all read back what they were told"
    };
    Ok(Step::new("converters", !failed, found.to_owned()))
}

/// Counters of a board: ticks of its fastest task, those that were lost, datagrams that were not sent.
fn counters(boards: &mut dyn Boards, role: Role) -> Result<[u32; 3], LinkError> {
    match boards.request(role, &Request::Status)? {
        Response::MotionStatus(status) => {
            let lost = status.servo_lost.wrapping_add(status.path_lost);
            Ok([status.servo_ticks, lost, status.unsent])
        }
        Response::TrackerStatus(status) => Ok([status.ticks, status.lost, status.unsent]),
        _ => Err(LinkError::Unexpected { role }),
    }
}

fn ticks(boards: &mut dyn Boards, role: Role) -> Result<Step, LinkError> {
    let hz = match role {
        Role::Motion => 4000.0,
        Role::Tracker => 1000.0,
    };
    let (began, before) = (boards.now(), counters(boards, role)?);
    let mut samples = 0;
    while boards.now().saturating_sub(began) < COUNTING {
        match boards.receive(Duration::from_millis(20))? {
            Some((from, Datagram::MotionTelemetry(telemetry))) if from == role => {
                samples += telemetry.samples.len() as u32;
            }
            Some((from, Datagram::TrackerTelemetry(telemetry))) if from == role => {
                samples += telemetry.samples.len() as u32;
            }
            _ => {}
        }
    }
    let after = counters(boards, role)?;
    let seconds = boards.now().saturating_sub(began).as_secs_f64();
    let [ticks, lost, unsent] = [0, 1, 2].map(|i: usize| after[i].wrapping_sub(before[i]));
    let rate = f64::from(ticks) / seconds;
    // A sample a millisecond.
    let expected = (f64::from(ticks) / hz * 1e3) as u32;
    let missing = expected.saturating_sub(samples + UNDER_WAY);
    let mut wrong = Vec::new();
    if (rate / hz - 1.0).abs() > OFF {
        wrong.push("the clock tree, or the PC stood still");
    }
    if lost > 0 {
        wrong.push("ticks came too late to be served: report that");
    }
    if missing > 0 || unsent > 0 {
        wrong.push("UDP of the board does not arrive: firewall of the PC, the network");
    }
    let found = format!(
        "{rate:.0} a second of {hz:.0}, {lost} lost; {samples} samples came by UDP of {expected}, {unsent} datagrams not sent{}{}",
        if wrong.is_empty() { "" } else { ": " },
        wrong.join("; ")
    );
    Ok(Step::new("ticks", wrong.is_empty(), found))
}

/// Drives are off at the end. A channel of the emergency stop that was opened alone is a fault, which is reset first.
pub(super) fn drives_off(boards: &mut dyn Boards, role: Role) -> Result<Step, LinkError> {
    let _ = boards.request(role, &Request::Reset)?;
    let (off, state, fault) = match boards.request(role, &Request::Status)? {
        Response::MotionStatus(status) => (
            status.state == State::Off,
            format!("{:?}", status.state),
            status.fault.map(|fault| fault.to_string()),
        ),
        Response::TrackerStatus(status) => (
            status.state == TrackerState::Off,
            format!("{:?}", status.state),
            status.fault.map(|fault| fault.to_string()),
        ),
        _ => return Err(LinkError::Unexpected { role }),
    };
    let found = match fault {
        Some(fault) => format!("state {state}, {fault}"),
        None => format!("state {state}, no fault"),
    };
    let good = off && found.ends_with("no fault");
    Ok(Step::new("drives off", good, found))
}
