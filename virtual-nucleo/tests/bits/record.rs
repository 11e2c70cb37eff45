//! Both shipped images on the model: what they read and gave out at every tick, and what was asked after which tick.

use crate::common::shipped;
use nalgebra::Vector3;
use plant_file::PlantChoice;
use shared::kinematics::AXIS_UNIT;
use shared::protocol::{
    Channel, MotionStatus, PathAction, PathChannel, PathElement, PathEvent, PathJoin, PathLimits, PathShape,
    Request, Response,
};
use shared::state::{State, TrackerState};
use shared::trajectory::PathSpace;
use virtual_nucleo::outside::Step;
use virtual_nucleo::pair::Pair;
use virtual_nucleo::session::{Session, parameters};
use virtual_nucleo::time::Time;

/// A request, the tick after which it was answered, and the answer.
#[derive(Clone, Debug)]
pub struct Asked {
    pub tick: u32,
    pub request: Request,
    pub answer: Response,
}

/// All that a board has done.
#[derive(Clone, Debug)]
pub struct Record {
    /// The machine's steps; each shows what the tick of that number reads.
    pub steps: Vec<Step>,
    pub asked: Vec<Asked>,
}

impl Record {
    /// Whether a converter's output is not always at 0 V.
    pub fn moves(&self, output: usize) -> bool {
        self.steps
            .iter()
            .any(|step| step.codes.get(output).is_some_and(|code| *code != 0))
    }
}

/// Where the slides go in the end \[mm\].
pub const TRACKED: [f64; 4] = [-2.5, 1.75, 3.125, -0.6];
/// Machine's steps from one tick that answers requests to the next.
const STEPS: [u64; 2] = [4, 1];
/// From one look at the state to the next: less than the PC may be silent.
const LOOK: Time = Time::ms(50);
/// Longest that anything takes.
const LIMIT: Time = Time::ms(20_000);

/// Records both boards.
pub fn both() -> [Record; 2] {
    let images = [shipped("motion"), shipped("tracker")];
    let pair = Pair::start(
        [&images[0], &images[1]],
        plant_file::DEFAULT_MACHINE,
        &PlantChoice::Shipped,
    );
    let mut pair = pair.expect("both run");
    for board in &mut pair.boards {
        board.chip_mut().shared.outside.record_steps();
    }
    let session = Session::connect(&mut pair).expect("both boards answer");
    let mut operator = Operator {
        pair,
        session,
        asked: [Vec::new(), Vec::new()],
    };
    operator.work();
    let Operator {
        mut pair,
        asked: [motion, tracker],
        ..
    } = operator;
    let mut record = |board: usize, asked| Record {
        steps: pair.boards[board].chip_mut().shared.outside.take_steps(),
        asked,
    };
    [record(0, motion), record(1, tracker)]
}

struct Operator {
    pair: Pair,
    session: Session,
    asked: [Vec<Asked>; 2],
}

impl Operator {
    fn work(&mut self) {
        for (board, request) in parameters().expect("a machine").iter().enumerate() {
            self.done(board, request);
        }
        for board in 0..2 {
            self.done(board, &Request::Home);
        }
        self.until("both are homed", |motion, tracker| {
            motion.state == State::Idle && tracker == TrackerState::Ready
        });
        let target_mm = [4.0, -3.0, -4.0, 2.5];
        self.done(1, &Request::MoveSlides { target_mm });
        for request in path(&self.motion()) {
            self.ask(0, &request);
        }
        self.done(0, &Request::Run);
        self.until("half of the path", |motion, _| motion.s_mm > 100.0);
        self.done(0, &Request::Override { factor: 0.6 });
        self.done(1, &Request::MoveSlides { target_mm: TRACKED });
        self.until("its end", |motion, _| motion.state == State::Idle);
    }

    fn done(&mut self, board: usize, request: &Request) {
        assert_eq!(self.ask(board, request), Response::Done, "{request:?}");
    }

    /// A request between two of the state, all of which come after the same tick: by them it is known which.
    fn ask(&mut self, board: usize, request: &Request) -> Response {
        self.run_to_tick(board);
        let [before, answer, after] = self
            .session
            .ask_together(
                &mut self.pair,
                board,
                [&Request::Status, request, &Request::Status],
            )
            .expect("an answer");
        assert!(!matches!(answer, Response::Refused(_)), "{request:?}: {answer:?}");
        let tick = tick(&before);
        assert_eq!(tick, self::tick(&after), "{request:?} comes while a tick does");
        let requests = [&Request::Status, request, &Request::Status];
        for (request, answer) in requests.into_iter().zip([before, answer.clone(), after]) {
            self.asked[board].push(Asked {
                tick,
                request: request.clone(),
                answer,
            });
        }
        answer
    }

    /// Runs until a tick has just been, so that there is time before the next.
    fn run_to_tick(&mut self, board: usize) {
        let ticks = |pair: &Pair| pair.boards[board].chip().shared.outside.steps / STEPS[board];
        let last = ticks(&self.pair);
        while ticks(&self.pair) == last {
            self.pair.run_slice();
        }
    }

    fn status(&mut self, board: usize) -> Response {
        let asked = self.session.ask(&mut self.pair, board, &Request::Status);
        let answer = asked.expect("a status");
        self.asked[board].push(Asked {
            tick: tick(&answer),
            request: Request::Status,
            answer: answer.clone(),
        });
        answer
    }

    fn motion(&mut self) -> MotionStatus {
        match self.status(0) {
            Response::MotionStatus(status) => status,
            other => panic!("{other:?}"),
        }
    }

    fn until(&mut self, what: &str, there: impl Fn(&MotionStatus, TrackerState) -> bool) {
        let end = self.pair.now() + LIMIT;
        loop {
            let motion = self.motion();
            let Response::TrackerStatus(tracker) = self.status(1) else {
                panic!("the tracker is another board")
            };
            assert_eq!((motion.fault, tracker.fault), (None, None), "{what}");
            if there(&motion, tracker.state) {
                return;
            }
            assert!(self.pair.now() < end, "not within {LIMIT}: {what}");
            let later = self.pair.now() + LOOK;
            self.pair.run(later);
        }
    }
}

fn tick(status: &Response) -> u32 {
    match status {
        Response::MotionStatus(status) => status.path_ticks,
        Response::TrackerStatus(status) => status.ticks,
        other => panic!("{other:?} is no status"),
    }
}

/// A line away from the marks, another one on which the tip turns about two axes, round a corner, and half a
/// circle, with both beams.
fn path(status: &MotionStatus) -> Vec<Request> {
    let configured = parameters().expect("a machine");
    let Some(Request::ConfigureMotion(config)) = configured.first() else {
        panic!("the motion board's come first")
    };
    let kinematics = config.kinematics().expect("a machine");
    let axes = std::array::from_fn(|axis| status.reference[axis] * AXIS_UNIT[axis]);
    let begin = kinematics.forward(&axes);
    let across = begin.normal.cross(&begin.tangent);
    let turned = [
        across * 0.1 + begin.normal * 0.05,
        begin.tangent * -0.05 + across * 0.08,
    ];
    let level = PathJoin::Blend {
        position_mm: 0.05,
        attitude_rad: 1e-3,
    };
    let corner = begin.position + Vector3::new(120.0, 80.0, -30.0);
    let edge = corner + Vector3::new(10.0, 60.0, 0.0);
    let centre = edge + Vector3::new(15.0, 0.0, 0.0);
    let end = edge + Vector3::new(30.0, 0.0, 0.0);
    let numbers = |v: Vector3<f64>| [v.x, v.y, v.z];
    // T and N are `part` of the turn on where an element begins, and turn by `rate` of it for each mm.
    let rest = |part: f64, rate: f64| {
        let mut rest = [PathChannel::Constant(0.0); 8];
        for (place, (from, turn)) in [(begin.tangent, turned[0]), (begin.normal, turned[1])]
            .into_iter()
            .enumerate()
        {
            for axis in 0..3 {
                rest[3 * place + axis] =
                    PathChannel::Linear([from[axis] + part * turn[axis], rate * turn[axis]]);
            }
        }
        rest
    };
    let line = |number, from: Vector3<f64>, to: Vector3<f64>, turns: bool| {
        let length = (to - from).norm();
        PathElement {
            line: number,
            shape: PathShape::Line {
                start: numbers(from),
                end: numbers(to),
            },
            rest: rest(0.0, if turns { 1.0 / length } else { 0.0 }),
            length_mm: length,
            feed_mm_s: 150.0,
            join: level,
        }
    };
    let arc = PathElement {
        line: 3,
        shape: PathShape::Arc {
            start: numbers(edge),
            end: numbers(end),
            centre: numbers(centre),
            axis: [0.0, 0.0, 1.0],
            turns: 0,
        },
        rest: rest(1.0, 0.0),
        length_mm: std::f64::consts::PI * 15.0,
        feed_mm_s: 90.0,
        join: PathJoin::Stop,
    };
    let elements = [
        line(1, begin.position, corner, false),
        line(2, corner, edge, true),
        arc,
    ];
    let limits = PathLimits {
        acceleration_mm_s2: 1000.0,
        jerk_mm_s3: 20_000.0,
        tolerance_mm: 0.05,
    };
    vec![
        Request::BeginPath {
            id: 7,
            space: PathSpace::Tool,
            start_s_mm: 0.0,
            limits,
        },
        Request::LoadElements {
            elements: elements.into_iter().collect(),
            last: true,
        },
        Request::LoadEvents(events().into_iter().collect()),
    ]
}

fn events() -> Vec<PathEvent> {
    let at = |s_mm, action| PathEvent { s_mm, action };
    let power = |side, watt| PathAction::Power { side, watt };
    vec![
        at(5.0, power(0, 1500.0)),
        at(5.0, power(1, 900.0)),
        at(30.0, PathAction::Beam { side: 0, on: true }),
        at(31.7, PathAction::Beam { side: 1, on: true }),
        at(
            50.0,
            PathAction::Level {
                channel: Channel::Power(0),
                value: 3100.0,
                over_mm: 80.0,
            },
        ),
        at(
            60.0,
            PathAction::BySpeed {
                channel: Channel::Power(1),
                full_mm_s: 150.0,
                least: 0.1,
            },
        ),
        at(210.3, PathAction::Beam { side: 1, on: false }),
        at(225.0, PathAction::Beam { side: 0, on: false }),
    ]
}
