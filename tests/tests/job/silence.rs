//! A tracker board that does not answer, and a PC that was not there.

use super::*;
use host_link::boards::Stall;
use std::cell::Cell;
use std::rc::Rc;

/// Stops the job when something is so.
struct StopsWhen(Rc<Cell<bool>>);

impl Operator for StopsWhen {
    fn turn(&mut self, remote: &Remote) {
        if self.0.get() {
            remote.send(Command::Stop).unwrap();
        }
    }
}

/// What goes wrong once the beam is on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wrong {
    /// The tracker board does not report its state any more, and the operator stops the job.
    TrackerSilent,
    /// This program is paused for so long.
    Paused(Duration),
    /// It is, and another one has its place on the boards afterwards.
    Replaced,
}

const PAUSE: Duration = Duration::from_secs(3);
/// A pause that the link bears, in which the tip passes all that was seen ahead of it.
const SHORT_PAUSE: Duration = Duration::from_millis(300);

struct Alone {
    boards: SimulatedBoards,
    wrong: Wrong,
    interrupted: Rc<Cell<bool>>,
    begun: bool,
    last_stall: Option<Stall>,
    /// What was asked with an answer waited for, since it went wrong.
    asked: Vec<(Role, Request)>,
    polled: usize,
}

impl Alone {
    fn new(wrong: Wrong, interrupted: &Rc<Cell<bool>>) -> Self {
        Self {
            boards: SimulatedBoards::default(),
            wrong,
            interrupted: interrupted.clone(),
            begun: false,
            last_stall: None,
            asked: Vec::new(),
            polled: 0,
        }
    }
}

impl Boards for Alone {
    pass_on!(boards: send, now, identity, path_states_target);

    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        if self.begun {
            self.asked.push((role, request.clone()));
            if self.wrong == Wrong::Replaced {
                let source = std::io::ErrorKind::BrokenPipe.into();
                return Err(LinkError::Lost { role, source });
            }
        }
        self.boards.request(role, request)
    }

    fn ask(&mut self, role: Role, request: &Request) -> Result<Option<Response>, LinkError> {
        if self.begun
            && self.wrong == Wrong::TrackerSilent
            && (role, request) == (Role::Tracker, &Request::Status)
        {
            return self.answer(role);
        }
        self.request(role, request).map(Some)
    }

    fn answer(&mut self, role: Role) -> Result<Option<Response>, LinkError> {
        assert_eq!(role, Role::Tracker);
        // The job continues meanwhile, until the operator has enough.
        self.polled += 1;
        if self.polled <= 20 {
            return Ok(None);
        }
        self.interrupted.set(true);
        self.boards.request(role, &Request::Status).map(Some)
    }

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let received = self.boards.receive(timeout)?;
        if let Some((_, Datagram::MotionTelemetry(telemetry))) = &received
            && !self.begun
            && telemetry.samples.iter().any(|sample| sample.beams[0])
        {
            self.begun = true;
            let lasted = match self.wrong {
                Wrong::TrackerSilent => return Ok(received),
                Wrong::Paused(lasted) => lasted,
                Wrong::Replaced => PAUSE,
            };
            let end = self.now() + lasted;
            while self.now() < end {
                self.boards.receive(Duration::from_millis(1))?;
            }
            self.last_stall = Some(Stall {
                ended: self.now(),
                lasted,
            });
        }
        Ok(received)
    }

    fn last_stall(&self) -> Option<Stall> {
        self.last_stall
    }
}

#[test]
fn a_tracker_that_does_not_answer_keeps_nobody_from_stopping() {
    let interrupted = Rc::new(Cell::new(false));
    let mut boards = Alone::new(Wrong::TrackerSilent, &interrupted);
    let ended = weld(&mut boards, &mut StopsWhen(interrupted));
    assert!(
        matches!(ended.error, Some(JobError::Interrupted)),
        "{:?}",
        ended.error
    );
    // It was polled while the motion board was asked and fed, and nothing that waits for it came before the stop.
    let stop = boards
        .asked
        .iter()
        .position(|asked| *asked == (Role::Motion, Request::Stop));
    let before = &boards.asked[..stop.expect("the machine is stopped")];
    assert!(boards.polled > 20);
    assert!(before.contains(&(Role::Motion, Request::Status)), "{before:?}");
    assert!(before.iter().all(|(role, _)| *role == Role::Motion), "{before:?}");
    assert_off(&mut boards);
}

/// Welds with a pause that the end is put down to.
fn paused(boards: &mut Alone, interrupted: &Rc<Cell<bool>>, told_as: &str) -> String {
    let ended = weld(boards, &mut StopsWhen(interrupted.clone()));
    let told = ended.error.expect("the boards stop without the PC").to_string();
    assert!(
        told.starts_with(&format!("this PC was stalled for {told_as} (paused")) && told.contains("board"),
        "{told}"
    );
    assert_eq!(ended.report.outcome, Outcome::Failed);
    assert!(
        ended.report.faults[0].contains("this PC was stalled"),
        "{:?}",
        ended.report.faults
    );
    told
}

#[test]
fn a_paused_pc_says_that_it_was_paused() {
    let interrupted = Rc::new(Cell::new(false));
    let mut boards = Alone::new(Wrong::Paused(PAUSE), &interrupted);
    paused(&mut boards, &interrupted, "3.0 s");
    assert_off(&mut boards);
}

#[test]
fn a_pc_that_was_busy_for_a_moment_does_not_blame_the_seam() {
    let interrupted = Rc::new(Cell::new(false));
    let mut boards = Alone::new(Wrong::Paused(SHORT_PAUSE), &interrupted);
    let told = paused(&mut boards, &interrupted, "0.3 s");
    assert!(told.contains("seam"), "{told}");
    assert_off(&mut boards);
}

#[test]
fn a_pc_that_was_paused_until_another_has_its_place_says_so_too() {
    let interrupted = Rc::new(Cell::new(false));
    paused(
        &mut Alone::new(Wrong::Replaced, &interrupted),
        &interrupted,
        "3.0 s",
    );
}

/// Boards in a network that answer a little later, and whose tracker board is lost for good once the beam is on.
struct Lost {
    boards: SimulatedBoards,
    lost: bool,
    answer: Option<Response>,
    /// The state of the motion board when its drives were switched off for the last time.
    off_from: Option<State>,
}

fn lost_tracker() -> LinkError {
    LinkError::Lost {
        role: Role::Tracker,
        source: std::io::ErrorKind::HostUnreachable.into(),
    }
}

impl Boards for Lost {
    pass_on!(boards: now, identity, path_states_target);

    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        if self.lost && role == Role::Tracker {
            return Err(lost_tracker());
        }
        if self.lost && *request == Request::Disable {
            let Response::MotionStatus(status) = self.boards.request(role, &Request::Status)? else {
                panic!("a state");
            };
            self.off_from = Some(status.state);
        }
        self.boards.request(role, request)
    }

    fn ask(&mut self, role: Role, request: &Request) -> Result<Option<Response>, LinkError> {
        self.answer = Some(self.request(role, request)?);
        Ok(None)
    }

    fn answer(&mut self, _role: Role) -> Result<Option<Response>, LinkError> {
        Ok(self.answer.take())
    }

    fn send(&mut self, role: Role, datagram: &Datagram) -> Result<(), LinkError> {
        if self.lost && role == Role::Tracker {
            return Err(lost_tracker());
        }
        self.boards.send(role, datagram)
    }

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let received = self.boards.receive(timeout)?;
        if let Some((_, Datagram::MotionTelemetry(telemetry))) = &received {
            self.lost |= telemetry.samples.iter().any(|sample| sample.beams[0]);
        }
        match (&received, self.lost) {
            (Some((Role::Tracker, _)), true) => Err(lost_tracker()),
            _ => Ok(received),
        }
    }
}

#[test]
fn a_lost_tracker_board_does_not_keep_the_machine_from_standing_before_its_drives_go_off() {
    let mut boards = Lost {
        boards: SimulatedBoards::default(),
        lost: false,
        answer: None,
        off_from: None,
    };
    let ended = weld(&mut boards, &mut NoOperator);
    let error = ended.error.expect("the tracker board is lost").to_string();
    assert!(
        error.contains("the connection to the tracker board was lost"),
        "{error}"
    );
    // At rest on its path: not in the middle of the stop.
    assert_eq!(boards.off_from, Some(State::Idle));
}
