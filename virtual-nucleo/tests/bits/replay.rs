//! The controllers on this computer, with the inputs of a record: what they give otherwise than the boards did.

use crate::record::{Asked, Record};
use shared::io::{Bits, Command, Feedback, MOTORS, SIDES, SLIDES};
use shared::motion::{MotionController, PathTickInput, ServoLoops};
use shared::protocol::framing::{MAX_MESSAGE, encode_message};
use shared::protocol::{Request, Response};
use shared::tracking::{TickInput, TrackerController};
use shared::trajectory::BoardPlanning;
use std::fmt::{self, Display, Formatter};
use std::iter::Peekable;
use virtual_nucleo::outside::{Seen, Step};

/// Servo ticks of a path tick.
const SERVO_TICKS: u32 = 4;
/// Knots of the tracker board (firmware-tracker).
const KNOTS: usize = 512;
/// Inputs of the process, which are on at the model.
const PROCESS: Bits = Bits(0b1111);
/// Outputs of the converters by their numbers, for messages.
const CODES: [&str; 12] = [
    "code 0", "code 1", "code 2", "code 3", "code 4", "code 5", "code 6", "code 7", "code 8", "code 9",
    "code 10", "code 11",
];

/// What was asked of a board, in its order.
type Requests<'a> = Peekable<std::slice::Iter<'a, Asked>>;

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
    /// An answer.
    Answer {
        tick: u32,
        request: Box<Request>,
        board: Box<Response>,
        here: Box<Response>,
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
        }
    }
}

/// How much was the same.
#[derive(Debug, Default)]
pub struct Same {
    ticks: usize,
    codes: usize,
    answers: usize,
}

impl Display for Same {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self {
            ticks,
            codes,
            answers,
        } = self;
        write!(f, "{ticks} ticks, {codes} codes and {answers} answers are equal")
    }
}

impl Same {
    /// Compares what a tick gives with what drove the machine until the next.
    fn outputs(&mut self, board: &Step, here: &Step) -> Result<(), Difference> {
        self.ticks += 1;
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

    /// Has what was asked after `tick` handled here, and compares the answers.
    fn requests(
        &mut self,
        asked: &mut Requests<'_>,
        tick: u32,
        mut handle: impl FnMut(&Request, u32) -> Response,
    ) -> Result<(), Difference> {
        while let Some(asked) = asked.next_if(|asked| asked.tick == tick) {
            let unsent = match &asked.answer {
                Response::MotionStatus(status) => status.unsent,
                Response::TrackerStatus(status) => status.unsent,
                _ => 0,
            };
            self.answer(asked, handle(&asked.request, unsent))?;
        }
        Ok(())
    }

    /// The same at the end of a record, where nothing of what was asked is left.
    fn after_all(self, mut asked: Requests<'_>) -> Self {
        assert_eq!(
            asked.next().map(|asked| asked.tick),
            None,
            "a request was left out"
        );
        self
    }

    /// Compares answers by what is sent of them.
    fn answer(&mut self, asked: &Asked, here: Response) -> Result<(), Difference> {
        self.answers += 1;
        let bytes = |response: &Response| {
            let mut buffer = [0; 2 + MAX_MESSAGE];
            encode_message(response, &mut buffer).expect("it fits").to_vec()
        };
        if bytes(&asked.answer) == bytes(&here) {
            return Ok(());
        }
        Err(Difference::Answer {
            tick: asked.tick,
            request: Box::new(asked.request.clone()),
            board: Box::new(asked.answer.clone()),
            here: Box::new(here),
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
    let mut asked = record.asked.iter().peekable();
    for (number, steps) in (1_u32..).zip(record.steps.windows(2)) {
        let [step, next] = steps else { continue };
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
        same.outputs(next, &driven(&command, codes, &next.seen))?;
        if number % SERVO_TICKS != 0 {
            continue;
        }
        let tick = number / SERVO_TICKS;
        let output = controller.tick(&PathTickInput {
            now_us: 1000 * u64::from(tick),
            elapsed: 1,
            report: servo.take_report(),
        });
        if let Some(setup) = controller.take_servo_setup() {
            servo.configure(setup);
        }
        servo.give(&output.order);
        controller.plan(&mut planning);
        same.requests(&mut asked, tick, |request, unsent| {
            controller.handle(request, unsent)
        })?;
    }
    Ok(same.after_all(asked))
}

/// The tracker board's record.
pub fn tracker(record: &Record) -> Result<Same, Difference> {
    let mut same = Same::default();
    let mut controller = Box::new(TrackerController::<KNOTS>::new());
    let mut asked = record.asked.iter().peekable();
    for (tick, steps) in (1_u32..).zip(record.steps.windows(2)) {
        let [step, next] = steps else { continue };
        let now_us = 1000 * u64::from(tick);
        let strobes = controller.strobe(1);
        let output = controller.tick(&TickInput {
            now_us,
            periods: 1,
            strobed_us: strobes.then_some(now_us),
            feedback: feedback::<SLIDES>(&step.seen),
            truth: None,
        });
        if output.clock_request {
            controller.asks_clock(now_us);
        }
        let codes = output.command.dac.iter().map(|code| code.0).collect();
        same.outputs(next, &driven(&output.command, codes, &next.seen))?;
        same.requests(&mut asked, tick, |request, unsent| {
            controller.handle(request, unsent)
        })?;
    }
    Ok(same.after_all(asked))
}
