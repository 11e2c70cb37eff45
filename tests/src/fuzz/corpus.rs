//! What a PC really says to the boards in the shipped jobs, and the boards as they were at moments of them.

use super::random::Random;
use super::wire::Wire;
use crate::{JOBS, MACHINE, assert_held_weld_goes_on, shipped, shipped_seam, weld, weld_job};
use config::machine::MachineFile;
use host_link::boards::{Boards, LinkError};
use host_link::pass_on;
use shared::config::{DeviationConfig, MotionConfig, TrackerConfig};
use shared::geometry::PoseOffset;
use shared::io::SLIDES;
use shared::protocol::{Datagram, Excitation, Excited, Request, Response, Role};
use world::simulated::SimulatedBoards;

/// Moments of a job at which its boards are kept.
const MOMENTS: usize = 24;
/// Messages of a job that are kept: of a long one the rest says nothing new.
const LONGEST: usize = 6000;

/// Something that the PC said.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// A request.
    Request(Box<Request>),
    /// A datagram.
    Datagram(Box<Datagram>),
}

impl Message {
    /// Its postcard bytes.
    pub fn write(&self, wire: &mut Wire) {
        match self {
            Self::Request(request) => wire.write(request),
            Self::Datagram(datagram) => wire.write(datagram),
        }
    }
}

/// Something that the PC said to a board, when.
#[derive(Clone, Debug)]
pub struct Said {
    /// Time since the boards were switched on \[µs\].
    pub at_us: u64,
    /// To which board.
    pub to: Role,
    /// What.
    pub message: Message,
}

/// A job, and boards at some moments of it.
pub struct Session {
    /// Its name.
    pub name: String,
    /// Parameters of its machine.
    pub motion: MotionConfig,
    /// The same of its tracker.
    pub tracker: Option<TrackerConfig>,
    /// All that was said, in order.
    pub said: Vec<Said>,
    /// Boards, and what is said next.
    pub moments: Vec<(SimulatedBoards, usize)>,
}

/// Boards that record the messages sent to them.
struct Recorder {
    boards: SimulatedBoards,
    said: Vec<Said>,
}

impl Recorder {
    fn keep(&mut self, to: Role, message: Message) {
        let at_us = self.boards.now().as_micros() as u64;
        self.said.push(Said { at_us, to, message });
    }
}

impl Boards for Recorder {
    pass_on!(boards: receive, now, identity, path_states_target);

    fn request(&mut self, role: Role, request: &Request) -> Result<Response, LinkError> {
        let answer = self.boards.request(role, request);
        // After the time that it takes: that is when the board has it.
        self.keep(role, Message::Request(Box::new(request.clone())));
        answer
    }

    fn send(&mut self, role: Role, datagram: &Datagram) -> Result<(), LinkError> {
        self.keep(role, Message::Datagram(Box::new(datagram.clone())));
        self.boards.send(role, datagram)
    }
}

impl Session {
    /// Does a job on the machine of `file` and keeps what was said.
    fn record(file: &str, name: &str, job: impl FnOnce(&mut dyn Boards)) -> Self {
        let machine = MachineFile::read(&shipped(file)).unwrap_or_else(|error| panic!("{error}"));
        let boards = SimulatedBoards::new(machine.motion.kinematics.name());
        let boards = boards.unwrap_or_else(|error| panic!("{error}"));
        let mut recorder = Recorder {
            boards: boards.clone(),
            said: Vec::new(),
        };
        job(&mut recorder);
        let mut said = recorder.said;
        said.truncate(LONGEST);
        let moments = moments(boards, &said);
        Self {
            name: name.to_owned(),
            motion: machine.motion,
            tracker: machine.tracking.map(|unit| unit.board),
            said,
            moments,
        }
    }

    /// A weld of the dual-beam gantry, held in the middle.
    pub fn of_weld() -> Self {
        Self::record(MACHINE, "held weld", |boards| {
            assert_held_weld_goes_on(boards, 9.0);
        })
    }

    /// The shipped jobs of all machines.
    pub fn all() -> Vec<Self> {
        let mut all = vec![
            Self::of_weld(),
            Self::record(MACHINE, "weld", |boards| {
                weld(boards, shipped_seam(), 5.0);
            }),
        ];
        all.extend(JOBS.map(|(machine, job)| {
            Self::record(&format!("machines/{machine}.toml"), job, |boards| {
                weld_job(boards, machine, job);
            })
        }));
        all
    }
}

/// Boards at moments that lie evenly over the messages of a job, and the first of all.
fn moments(mut boards: SimulatedBoards, said: &[Said]) -> Vec<(SimulatedBoards, usize)> {
    let mut moments = Vec::new();
    let every = said.len().div_ceil(MOMENTS).max(1);
    for (index, said) in said.iter().enumerate() {
        while boards.advance(said.at_us) {}
        if index.is_multiple_of(every) {
            moments.push((boards.clone(), index));
        }
        match &said.message {
            Message::Request(request) => {
                boards.ask(said.to, request);
            }
            Message::Datagram(datagram) => boards.send(said.to, datagram).expect("boards of this process"),
        }
    }
    moments
}

/// Requests that a job says seldom or never.
pub fn seldom() -> Vec<Request> {
    vec![
        Request::Status,
        Request::Inputs,
        Request::Compensate(deviation(2, [0.0, 0.002, -0.001])),
        Request::Compensate(deviation(9, [0.0, f32::NAN, 1e9])),
        Request::Home,
        Request::Disable,
        Request::Reset,
        Request::Run,
        Request::HoldToRun,
        Request::RunUntil { input: 1, on: true },
        Request::RunUntil {
            input: 200,
            on: false,
        },
        Request::Back,
        Request::Hold,
        Request::Resume,
        Request::Stop,
        Request::Override { factor: 0.5 },
        Request::Override { factor: 1.5 },
        Request::Override { factor: 1e-9 },
        Request::MoveSlides {
            target_mm: [1.0; SLIDES],
            hold_to_run: Some(2.0),
        },
        Request::OffsetPose(PoseOffset::of([0.5, -0.5, 0.001])),
        Request::Excite(Excitation {
            motor: 2,
            excited: Excited::Command,
            amplitude: 3.0,
            from_hz: 5.0,
            to_hz: 400.0,
            settle_periods: 1,
            way: 0.0,
            max_travel: 1.0,
            max_speed: 50.0,
        }),
        Request::EndExcitation,
        Request::ReadCapture { from: 0 },
    ]
}

/// One of what was said in any job.
pub fn any<'a>(random: &mut Random, sessions: &'a [Session]) -> &'a Said {
    let session = random.of(sessions);
    random.of(&session.said)
}

/// Of a motor along X.
fn deviation(motor: u8, values: [f32; 3]) -> DeviationConfig {
    DeviationConfig {
        axis: 0,
        motor,
        from: 0.0,
        step: 50.0,
        values: values.into_iter().collect(),
    }
}
