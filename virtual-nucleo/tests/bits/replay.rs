//! The controllers on this computer, with the inputs of a record: what they give otherwise than the boards did.

use crate::journal::Event;
use crate::record::{Asked, Record};
use shared::io::{Bits, Command, Feedback, MOTORS, SIDES, SLIDES, SwitchedLines};
use shared::motion::{MotionController, PathTickInput, ServoLoops};
use shared::protocol::framing::{MAX_DATAGRAM, MAX_MESSAGE, encode_datagram, encode_message};
use shared::protocol::{
    Datagram, MotionSample, MotionTelemetry, PathState, Request, Response, TrackerSample, TrackerTelemetry,
};
use shared::tracking::{TickInput, TrackerController};
use shared::trajectory::BoardPlanning;
use std::fmt::{self, Display, Formatter};
use virtual_nucleo::outside::{Seen, Step};

/// Servo ticks of a path tick.
const SERVO_TICKS: usize = 4;
/// Knots of the tracker board (firmware-tracker).
const KNOTS: usize = 512;
/// Inputs of the process, which are on at the model.
const PROCESS: Bits = Bits(0b1111);
/// Outputs of the converters by their numbers, for messages.
const CODES: [&str; 12] = [
    "code 0", "code 1", "code 2", "code 3", "code 4", "code 5", "code 6", "code 7", "code 8", "code 9",
    "code 10", "code 11",
];

/// Between two ticks of the path, or of the slides \[µs\].
const MILLISECOND: u64 = 1000;

/// The first thing that is not the same.
#[derive(Debug)]
pub enum Difference {
    /// An output after a tick.
    Output {
        tick: usize,
        output: &'static str,
        board: i32,
        here: i32,
    },
    /// An answer, by the number of ticks before it.
    Answer {
        tick: usize,
        request: Box<Request>,
        board: Box<Response>,
        here: Box<Response>,
    },
    /// A datagram; telemetry by its samples.
    Datagram {
        board: Box<Datagram>,
        here: Option<Box<Datagram>>,
    },
}

impl Display for Difference {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Output {
                tick,
                output,
                board,
                here,
            } => write!(f, "tick {tick}: {output} is {board} on the board, {here} here"),
            Self::Answer {
                tick,
                request,
                board,
                here,
            } => write!(
                f,
                "after tick {tick}, {request:?}:\n  board {board:?}\n  here  {here:?}"
            ),
            Self::Datagram { board, here } => write!(f, "sent\n  board {board:?}\n  here  {here:?}"),
        }
    }
}

/// How much was the same.
#[derive(Debug, Default)]
pub struct Same {
    ticks: usize,
    codes: usize,
    answers: usize,
    datagrams: usize,
}

impl Display for Same {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self {
            ticks,
            codes,
            answers,
            datagrams,
        } = self;
        write!(
            f,
            "{ticks} ticks, {codes} codes, {answers} answers and {datagrams} samples and datagrams are equal"
        )
    }
}

impl Same {
    /// Compares what a tick gives with what drove the machine until the next; there is none after the last.
    fn outputs(&mut self, board: Option<&Step>, here: impl FnOnce(&Step) -> Step) -> Result<(), Difference> {
        self.ticks += 1;
        let Some(board) = board else { return Ok(()) };
        let here = here(board);
        let tick = self.ticks;
        let differs = |output, board, here| {
            Err(Difference::Output {
                tick,
                output,
                board,
                here,
            })
        };
        assert_eq!(board.codes.len(), here.codes.len());
        for (output, (of_board, of_here)) in CODES.iter().zip(board.codes.iter().zip(&here.codes)) {
            self.codes += 1;
            if of_board != of_here {
                return differs(output, i32::from(*of_board), i32::from(*of_here));
            }
        }
        let lines = [
            ("an enable", &board.enables, &here.enables),
            ("a gate", &board.gates, &here.gates),
        ];
        for (output, board, here) in lines {
            for (board, here) in board.iter().zip(here) {
                if board != here {
                    return differs(output, i32::from(*board), i32::from(*here));
                }
            }
        }
        Ok(())
    }

    /// Has a request handled here, and compares the answers by what is sent of them.
    fn answer(
        &mut self,
        asked: &Asked,
        handle: impl FnOnce(&Request, u32) -> Response,
    ) -> Result<(), Difference> {
        self.answers += 1;
        let unsent = match &asked.answer {
            Response::MotionStatus(status) => status.unsent,
            Response::TrackerStatus(status) => status.unsent,
            _ => 0,
        };
        let here = handle(&asked.request, unsent);
        let bytes = |response: &Response| {
            let mut buffer = [0; 2 + MAX_MESSAGE];
            encode_message(response, &mut buffer).expect("it fits").to_vec()
        };
        if bytes(&asked.answer) == bytes(&here) {
            return Ok(());
        }
        Err(Difference::Answer {
            tick: self.ticks,
            request: Box::new(asked.request.clone()),
            board: Box::new(asked.answer.clone()),
            here: Box::new(here),
        })
    }

    /// Compares a datagram that was sent.
    fn datagram(&mut self, board: Datagram, here: Option<Datagram>) -> Result<(), Difference> {
        self.datagrams += 1;
        let bytes = |datagram: &Datagram| {
            let mut buffer = [0; MAX_DATAGRAM];
            encode_datagram(0, datagram, &mut buffer)
                .expect("it fits")
                .to_vec()
        };
        if here.as_ref().map(bytes) == Some(bytes(&board)) {
            return Ok(());
        }
        Err(Difference::Datagram {
            board: Box::new(board),
            here: here.map(Box::new),
        })
    }
}

/// What a board reads.
fn feedback<const N: usize>(seen: &Seen) -> Feedback<N> {
    Feedback {
        counts: std::array::from_fn(|index| seen.counts[index].0),
        mark: std::array::from_fn(|index| seen.counts[index].1),
        limit_plus: Bits(seen.limit_plus),
        limit_minus: Bits(seen.limit_minus),
        ..Feedback::NONE
    }
}

/// What a command puts on the outputs, as docs/wiring.md has them; `seen` is only carried along.
fn driven<const N: usize>(command: &Command<N>, codes: Vec<i16>, seen: &Seen) -> Step {
    let last = command.changes.iter().last();
    let gates = last.map_or(command.beam_gate, |change| change.lines.gates());
    Step {
        enables: vec![command.enable; N],
        gates: gates.to_vec(),
        codes,
        seen: seen.clone(),
    }
}

/// The motion board's record.
pub fn motion(record: &Record) -> Result<Same, Difference> {
    let mut same = Same::default();
    let mut servo = ServoLoops::default();
    let mut controller = Box::new(MotionController::new());
    let mut planning = Box::new(BoardPlanning::new());
    let first_us = record.first_us(|datagram| match datagram {
        Datagram::MotionTelemetry(telemetry) => telemetry.samples.first().map(|s| (s.tick, s.time_us)),
        _ => None,
    });
    let mut published: Vec<(PathState, MotionSample)> = Vec::new();
    let mut steps = record.steps.iter();
    for event in &record.events {
        match event {
            Event::Tick { .. } => {
                let step = steps.next().expect("a step before each tick");
                let next = steps.as_slice().first();
                let feedback = Feedback {
                    process: PROCESS,
                    ..feedback::<MOTORS>(&step.seen)
                };
                let command = servo.tick(&feedback, None, 1);
                let mut codes = vec![0; 12];
                for (code, of) in codes.iter_mut().zip(&command.dac) {
                    *code = of.0;
                }
                for side in 0..SIDES {
                    codes[8 + side] = command.beam_power[side].0;
                    codes[10 + side] = command.analog[side].0;
                }
                same.outputs(next, |next| driven(&command, codes, &next.seen))?;
                if same.ticks % SERVO_TICKS != 0 {
                    continue;
                }
                let output = controller.tick(&PathTickInput {
                    now_us: first_us + MILLISECOND * (same.ticks / SERVO_TICKS) as u64,
                    elapsed: 1,
                    report: servo.take_report(),
                });
                if let Some(setup) = controller.take_servo_setup() {
                    servo.configure(setup);
                }
                servo.give(&output.order);
                controller.plan(&mut planning);
                published.push((output.path_state, output.sample));
            }
            Event::Datagram(datagram, arrived_us) => {
                if let Some(lease) = controller.datagram(datagram, *arrived_us) {
                    servo.renew(lease);
                }
            }
            Event::Asked(asked) => {
                same.answer(asked, |request, unsent| controller.handle(request, unsent))?;
            }
        }
    }
    let at = |tick: u32| published.get(tick as usize - 1);
    // What ticks take, and when between two of them a line was switched, only the board itself knows.
    let telemetry = |sample: MotionSample| {
        let sample = MotionSample {
            load: None,
            switched: SwitchedLines::default(),
            ..sample
        };
        let samples = [sample].into_iter().collect();
        Datagram::MotionTelemetry(MotionTelemetry { samples })
    };
    for datagram in &record.sent {
        match datagram {
            Datagram::PathState(state) if at(state.tick).is_some() => {
                let sent = |(here, _): &(PathState, _)| {
                    Datagram::PathState(PathState {
                        sent_us: state.sent_us,
                        ..*here
                    })
                };
                same.datagram(datagram.clone(), at(state.tick).map(sent))?;
            }
            Datagram::MotionTelemetry(batch) => {
                for sample in batch.samples.iter().filter(|sample| at(sample.tick).is_some()) {
                    let here = at(sample.tick).map(|(_, here)| telemetry(*here));
                    same.datagram(telemetry(*sample), here)?;
                }
            }
            _ => {}
        }
    }
    Ok(same)
}

/// The tracker board's record.
pub fn tracker(record: &Record) -> Result<Same, Difference> {
    let mut same = Same::default();
    let mut controller = Box::new(TrackerController::<KNOTS>::new());
    let first_us = record.first_us(|datagram| match datagram {
        Datagram::TrackerTelemetry(telemetry) => telemetry.samples.first().map(|s| (s.tick, s.time_us)),
        _ => None,
    });
    let clock_requests = record.sent.iter().filter_map(|datagram| match datagram {
        Datagram::ClockRequest(request) => Some(request.asked_us),
        _ => None,
    });
    let mut clock_requests = clock_requests.peekable();
    let (mut permits, mut captures, mut samples) = (Vec::new(), Vec::new(), Vec::new());
    let mut steps = record.steps.iter();
    for event in &record.events {
        match event {
            Event::Tick { strobed_us } => {
                let step = steps.next().expect("a step before each tick");
                let next = steps.as_slice().first();
                let now_us = first_us + MILLISECOND * (same.ticks as u64 + 1);
                let strobes = controller.strobe(1);
                assert_eq!(strobes, strobed_us.is_some(), "the cameras are triggered");
                let output = controller.tick(&TickInput {
                    now_us,
                    periods: 1,
                    strobed_us: *strobed_us,
                    feedback: feedback::<SLIDES>(&step.seen),
                    truth: None,
                });
                if output.clock_request {
                    // None is sent as long as there is nobody to ask.
                    let sent = clock_requests.next_if(|asked_us| *asked_us < now_us + MILLISECOND);
                    controller.asks_clock(sent.unwrap_or(now_us));
                }
                let codes = output.command.dac.iter().map(|code| code.0).collect();
                same.outputs(next, |next| driven(&output.command, codes, &next.seen))?;
                permits.extend(output.permit);
                captures.extend(output.capture);
                samples.push(output.sample);
            }
            Event::Datagram(datagram, arrived_us) => controller.datagram(datagram, *arrived_us),
            Event::Asked(asked) => {
                same.answer(asked, |request, unsent| controller.handle(request, unsent))?;
            }
        }
    }
    let telemetry = |sample: TrackerSample| {
        let samples = [sample].into_iter().collect();
        Datagram::TrackerTelemetry(TrackerTelemetry { samples })
    };
    let (mut permits, mut captures) = (permits.into_iter(), captures.into_iter());
    for datagram in &record.sent {
        match datagram {
            Datagram::Permit(_) => same.datagram(datagram.clone(), permits.next().map(Datagram::Permit))?,
            Datagram::Capture(_) => {
                same.datagram(datagram.clone(), captures.next().map(Datagram::Capture))?
            }
            Datagram::TrackerTelemetry(batch) => {
                for sample in &batch.samples {
                    let here = samples.get(sample.tick as usize - 1).copied();
                    same.datagram(telemetry(*sample), here.map(telemetry))?;
                }
            }
            _ => {}
        }
    }
    Ok(same)
}
