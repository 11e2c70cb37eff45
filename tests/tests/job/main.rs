//! Whole jobs on simulated boards, and what happens when something goes wrong in the middle of one.

mod by_hand;
mod changed;
mod corners;
mod drawing;
mod from_line;
mod holds;
mod machines;
mod probing;
mod real_cameras;
mod recentring;
mod seam_ends;
mod silence;
mod single_block;
mod spooled;
mod subscribers;
mod tapping;
mod taught_seam;
mod verdict;
mod waits;

use cam::path::Planner;
use config::machine::MachineFile;
use host_link::boards::{Boards, LinkError, command};
use host_link::events::{Event, Next, Phase, Question};
use host_link::pass_on;
use host_link::{Command, Remote};
use job::{Job, JobError, Names, Work};
use nc::{Options, Program, interpret};
use plant_file::PlantFile;
use report::{Ended, Outcome, Report, SeamFigures};
use shared::protocol::{Datagram, Identity, Request, Response, Role};
use shared::state::{State, TrackerFault, TrackerState};
use std::sync::Arc;
use std::time::Duration;
use system_tests::{NoOperator, Operator, TappedBoards, run};
use world::simulated::SimulatedBoards;
use world::{Deviation, SeamError, Surroundings, TrueMachine, check_seam};

const PROGRAM: &str = "\
G43.4
G0 X900 Y900 Z100 A0 B0 C0
F5000
M62 P2
G1 X940
M62 P0
M62 P1
X1140
M63 P0
M63 P1
M63 P2
X1180
M2";

fn machine() -> MachineFile {
    MachineFile::parse("m.toml", include_str!("../../../machines/dual-beam-gantry.toml")).unwrap()
}

/// Bends, slopes and a kink.
fn seam() -> Arc<Deviation> {
    let mut text = "s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n".to_owned();
    for s in 0..=200 {
        let s = f64::from(s);
        let wave = 0.5 * (s / 100.0 * std::f64::consts::TAU).sin();
        text += &format!(
            "{s},{wave},{},{},{}\n",
            0.02 * s,
            -0.3 * wave,
            0.01 * (s - 80.0).max(0.0)
        );
    }
    Arc::new(Deviation::parse("seam.csv", &text).unwrap())
}

fn weld(boards: &mut dyn Boards, operator: &mut dyn Operator) -> Ended {
    run_on(boards, &machine(), PROGRAM, Some(seam()), operator).unwrap()
}

fn run_on(
    boards: &mut dyn Boards,
    machine: &MachineFile,
    program: &str,
    seam: Option<Arc<Deviation>>,
    operator: &mut dyn Operator,
) -> Result<Ended, JobError> {
    let program = interpret(program, Options::default()).unwrap();
    run(boards, &job(machine, &program, seam), operator)
}

fn job<'a>(machine: &'a MachineFile, program: &'a Program, seam: Option<Arc<Deviation>>) -> Job<'a> {
    Job {
        machine,
        work: Work::Program(program),
        part: None,
        speed_m_per_min: None,
        from_line: None,
        surroundings: around(seam).into(),
        spooling: Default::default(),
        names: Names {
            program: "job.ngc".into(),
            machine: "m.toml".into(),
            seam: None,
            boards: "simulated".into(),
        },
    }
}

fn around(seam: Option<Arc<Deviation>>) -> Surroundings {
    Surroundings {
        seam,
        ..Surroundings::default()
    }
}

fn seam_of(report: &Report) -> &SeamFigures {
    report.seam.as_ref().expect("a machine with a tracker")
}

fn undisturbed(boards: &mut dyn Boards) -> Ended {
    weld(boards, &mut NoOperator)
}

/// What can go wrong, from a path position of the welding path on.
enum Trouble {
    /// Measurements of U1 are wrong by this much \[mm\].
    Bias(f64),
    /// No measurement arrives any more.
    Blind,
    /// The emergency stop is pressed.
    EmergencyStop,
    /// The tracker board cannot be reached any more.
    TrackerGone,
}

/// Simulated boards with a trouble.
struct Troubled {
    boards: SimulatedBoards,
    trouble: Trouble,
    /// Path position where it begins \[mm\].
    from_s_mm: f64,
    begun: bool,
    /// The last request to the motion board was to switch its drives off.
    motion_disabled: bool,
}

impl Troubled {
    fn new(trouble: Trouble, from_s_mm: f64) -> Self {
        Self {
            boards: SimulatedBoards::default(),
            trouble,
            from_s_mm,
            begun: false,
            motion_disabled: false,
        }
    }

    fn look(&mut self, datagram: &Datagram) {
        let Datagram::MotionTelemetry(telemetry) = datagram else {
            return;
        };
        let there = telemetry
            .samples
            .iter()
            .any(|s| s.beams[0] && s.s_mm >= self.from_s_mm);
        if there && !self.begun {
            self.begun = true;
            if let Trouble::EmergencyStop = self.trouble {
                self.boards.set_emergency_stop(true);
            }
        }
    }

    fn reachable(&self, role: Role) -> Result<(), LinkError> {
        match self.trouble {
            Trouble::TrackerGone if self.begun && role == Role::Tracker => Err(LinkError::Lost {
                role,
                source: std::io::ErrorKind::ConnectionReset.into(),
            }),
            _ => Ok(()),
        }
    }
}

impl Boards for Troubled {
    pass_on!(boards: now, identity, path_states_target);

    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        self.reachable(role)?;
        if role == Role::Motion {
            self.motion_disabled = *request == Request::Disable;
        }
        self.boards.request(role, request)
    }

    fn receive(&mut self, timeout: Duration) -> Result<Option<(Role, Datagram)>, LinkError> {
        let received = self.boards.receive(timeout)?;
        if let Some((_, datagram)) = &received {
            self.look(datagram);
        }
        Ok(received)
    }

    fn send(&mut self, role: Role, datagram: &Datagram) -> Result<(), LinkError> {
        self.reachable(role)?;
        let mut datagram = datagram.clone();
        if let (Datagram::Measurement(measurement), true) = (&mut datagram, self.begun) {
            match self.trouble {
                Trouble::Blind => return Ok(()),
                Trouble::Bias(bias) => {
                    if let Some(seen) = &mut measurement.sides[0] {
                        seen.delta_u_mm += bias;
                    }
                }
                Trouble::EmergencyStop | Trouble::TrackerGone => {}
            }
        }
        self.boards.send(role, &datagram)
    }
}

fn assert_off(boards: &mut dyn Boards) {
    let (Ok(Response::MotionStatus(motion)), Ok(Response::TrackerStatus(tracker))) = (
        boards.request(Role::Motion, &Request::Status),
        boards.request(Role::Tracker, &Request::Status),
    ) else {
        panic!("both boards tell their state");
    };
    assert!(
        matches!(motion.state, State::Off | State::Fault),
        "{:?}",
        motion.state
    );
    assert!(
        matches!(tracker.state, TrackerState::Off | TrackerState::Fault),
        "{:?}",
        tracker.state
    );
}

/// The beams are off at the end, and the machine stood there without having left its path.
fn assert_stopped_on_path(ended: &Ended, before_along_mm: f64) {
    let last = ended.evaluation.ticks.iter().last().unwrap();
    assert_eq!(last.beams, [false, false]);
    assert!(last.speed_mm_s.abs() < 0.5, "{} mm/s", last.speed_mm_s);
    assert!(last.along_mm < before_along_mm, "{} mm", last.along_mm);
    let off = ended.evaluation.ticks.iter().filter_map(|t| t.contour_error_mm);
    assert!(off.fold(0.0, f64::max) < 0.05);
}

#[test]
fn a_job_follows_both_seams_and_switches_everything_off() {
    let mut boards = SimulatedBoards::default();
    let ended = undisturbed(&mut boards);
    assert!(ended.error.is_none(), "{:?}", ended.error);
    let report = &ended.report;
    assert_eq!(report.outcome, Outcome::Finished);
    assert_eq!(report.faults, [""; 0]);
    for max in ended.evaluation.max_deviation_mm {
        assert!(max.unwrap() < 0.02, "{:?}", seam_of(report).max_deviation_mm);
    }
    assert!(
        (report.weld_length_mm - 200.0).abs() < 0.2,
        "{}",
        report.weld_length_mm
    );
    assert!((report.speed_m_per_min - 5.0).abs() < 1e-9);
    assert_eq!(report.weld_ticks.unknown, 0);
    assert_eq!((report.lost_ticks.total(), report.telemetry_gaps.total()), (0, 0));
    // On the way there the seams pass below the cameras, at an angle at which no seam leads away.
    let measurements = &seam_of(report).measurements;
    for (rejected, accepted) in measurements.rejected.iter().zip(&measurements.accepted) {
        assert!(rejected * 10 < *accepted, "{measurements:?}");
    }
    assert_eq!(measurements.given_up, 0);
    assert_off(&mut boards);
}

#[test]
fn two_runs_are_the_same_to_the_bit() {
    let run = || undisturbed(&mut SimulatedBoards::default());
    let (first, second) = (run(), run());
    assert_eq!(first.report, second.report);
    assert_eq!(first.evaluation, second.evaluation);
}

#[test]
fn boards_can_be_used_again_after_a_job() {
    let mut boards = SimulatedBoards::default();
    undisturbed(&mut boards);
    let again = undisturbed(&mut boards);
    assert!(again.error.is_none(), "{:?}", again.error);
    assert!(seam_of(&again.report).max_deviation_mm.u1.unwrap() < 0.02);
}

#[test]
fn the_report_tells_the_truth_and_not_what_the_controller_believes() {
    let mut boards = Troubled::new(Trouble::Bias(0.1), 20.0);
    let ended = undisturbed(&mut boards);
    let max = seam_of(&ended.report).max_deviation_mm;
    assert!((max.u1.unwrap() - 0.1).abs() < 0.02, "{max:?}");
    assert!(max.v1.unwrap() < 0.02 && max.u2.unwrap() < 0.02, "{max:?}");
}

/// Presses Ctrl-C in the middle of the weld.
struct Stopper {
    welding: bool,
}

impl Operator for Stopper {
    fn event(&mut self, event: &Event, remote: &Remote) {
        match event {
            Event::Phase(phase) => self.welding = *phase == Phase::Welding,
            Event::Progress { done_mm, .. } if self.welding && *done_mm > 100.0 => {
                remote.send(Command::Stop).unwrap();
            }
            _ => {}
        }
    }
}

#[test]
fn the_operator_stops_the_machine_on_its_path() {
    let mut boards = SimulatedBoards::default();
    let ended = weld(&mut boards, &mut Stopper { welding: false });
    assert!(
        matches!(ended.error, Some(JobError::Interrupted)),
        "{:?}",
        ended.error
    );
    assert_eq!(ended.report.outcome, Outcome::Interrupted);
    assert!(ended.began && ended.report.weld_length_mm > 50.0);
    assert_stopped_on_path(&ended, 80.0);
    assert_off(&mut boards);
}

#[test]
fn a_lost_seam_stops_the_weld() {
    let mut boards = Troubled::new(Trouble::Blind, 100.0);
    let ended = undisturbed(&mut boards);
    assert!(
        matches!(
            ended.error,
            Some(JobError::Tracker(TrackerFault::LostSeam { .. }))
        ),
        "{:?}",
        ended.error
    );
    assert_eq!(ended.report.outcome, Outcome::Failed);
    assert_stopped_on_path(&ended, 100.0);
    assert_off(&mut boards);
}

#[test]
fn the_emergency_stop_ends_the_job_and_is_reported_once() {
    let mut boards = Troubled::new(Trouble::EmergencyStop, 100.0);
    let ended = undisturbed(&mut boards);
    let faults = &ended.report.faults;
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert!(faults[0].contains("emergency stop is pressed"), "{faults:?}");
    assert_off(&mut boards);
}

#[test]
fn without_the_tracker_board_the_motion_board_is_stopped_and_switched_off() {
    let mut boards = Troubled::new(Trouble::TrackerGone, 100.0);
    let ended = undisturbed(&mut boards);
    assert!(
        matches!(ended.error, Some(JobError::Link(LinkError::Lost { .. }))),
        "{:?}",
        ended.error
    );
    assert_stopped_on_path(&ended, 120.0);
    assert!(boards.motion_disabled);
}
