//! Both shipped images on the model: what they read, took in and gave out at every tick.

use crate::cameras::Cameras;
use crate::common::shipped;
use crate::journal::{Event, Journal, datagram};
use crate::paths::{tracked, untracked};
use plant_file::PlantChoice;
use shared::config::TrackerConfig;
use shared::protocol::{DATAGRAM_PORT, Datagram, MotionStatus, Request, Response, TrackerStatus};
use shared::state::{State, TrackerState};
use virtual_nucleo::outside::Step;
use virtual_nucleo::pair::{ADDRESSES, Pair};
use virtual_nucleo::session::{Session, parameters};
use virtual_nucleo::time::Time;

/// A request and its answer.
#[derive(Clone, Debug)]
pub struct Asked {
    pub request: Request,
    pub answer: Response,
}

/// All that a board has done.
#[derive(Clone, Debug)]
pub struct Record {
    /// The machine's steps; each shows what the tick of that number reads.
    pub steps: Vec<Step>,
    /// What it took in.
    pub events: Vec<Event>,
    /// Datagrams that it has sent.
    pub sent: Vec<Datagram>,
}

impl Record {
    /// The last answer.
    pub fn end(&self) -> &Response {
        let answer = self.events.iter().rev().find_map(|event| match event {
            Event::Asked(asked) => Some(&asked.answer),
            _ => None,
        });
        answer.expect("something was asked")
    }

    /// The board's clock at tick 0, a millisecond before the first \[µs\], by the ticks and times that its telemetry tells.
    pub fn first_us(&self, tells: impl Fn(&Datagram) -> Option<(u32, u64)>) -> u64 {
        let (tick, time_us) = self.sent.iter().find_map(tells).expect("telemetry");
        time_us - 1000 * u64::from(tick)
    }

    /// Whether a converter's output is not always at 0 V.
    pub fn moves(&self, output: usize) -> bool {
        self.steps
            .iter()
            .any(|step| step.codes.get(output).is_some_and(|code| *code != 0))
    }
}

/// Where the slides go before the seam comes \[mm\].
const ASIDE: [f64; 4] = [-2.5, 1.75, 3.125, -0.6];
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
    let journals = [0, 1].map(|board| Journal::keep(&mut pair.boards[board]));
    for board in &mut pair.boards {
        board.chip_mut().shared.outside.record_steps();
    }
    let session = Session::connect(&mut pair).expect("both boards answer");
    let mut operator = Operator {
        pair,
        session,
        cameras: None,
        asked: [Vec::new(), Vec::new()],
    };
    operator.work();
    let Operator { mut pair, asked, .. } = operator;
    let mut asked = asked.into_iter();
    [0, 1].map(|index: usize| {
        let board = &mut pair.boards[index];
        let steps = board.chip_mut().shared.outside.take_steps();
        let frames = board
            .ethernet_mut()
            .and_then(|port| port.record.take())
            .expect("is kept");
        let asked = asked.next().expect("of each board");
        Record {
            steps,
            events: journals[index].events(&frames.received, asked),
            sent: frames.sent.iter().filter_map(|frame| datagram(frame)).collect(),
        }
    })
}

struct Operator {
    pair: Pair,
    session: Session,
    cameras: Option<Cameras>,
    asked: [Vec<Asked>; 2],
}

impl Operator {
    fn work(&mut self) {
        let parameters = parameters().expect("a machine");
        for (board, request) in parameters.iter().enumerate() {
            self.done(board, request);
        }
        for board in 0..2 {
            self.done(board, &Request::Home);
        }
        self.until("both are homed", |motion, tracker| {
            motion.state == State::Idle && tracker.state == TrackerState::Ready
        });
        let target_mm = [4.0, -3.0, -4.0, 2.5];
        self.done(1, &Request::MoveSlides { target_mm, hold_to_run: None });
        for request in untracked(&self.motion()) {
            self.ask(0, &request);
        }
        self.done(0, &Request::Run);
        self.until("half of the path", |motion, _| motion.s_mm > 100.0);
        self.done(0, &Request::Override { factor: 0.6 });
        self.done(1, &Request::MoveSlides { target_mm: ASIDE, hold_to_run: None });
        self.until("its end", |motion, _| motion.state == State::Idle);
        self.done(0, &Request::Override { factor: 1.0 });
        let Some(Request::ConfigureTracker(config)) = parameters.get(1) else {
            panic!("the tracker board's come second")
        };
        self.relate(config);
        let [motion, tracker] = tracked(&self.motion());
        for (board, requests) in [(1, tracker), (0, motion)] {
            for request in requests {
                self.ask(board, &request);
            }
        }
        self.done(0, &Request::Run);
        self.until("the end of the seam", |motion, _| {
            motion.state == State::Idle && motion.s_mm > 299.0
        });
        // The tick after the last answer is compared, too.
        let later = self.pair.now() + Time::ms(2);
        self.pair.run(later);
    }

    /// Has the boards speak with each other and with the cameras, and waits until they know each other's clocks.
    fn relate(&mut self, config: &TrackerConfig) {
        let (pair, session) = (&mut self.pair, &mut self.session);
        // What the motion board sends to the PC is seen at its port.
        Cameras::subscribe(pair, session, 0);
        let cameras = Cameras::new(pair, session, config);
        let partner = Request::PathStatesTo {
            address: ADDRESSES[1].octets(),
            port: DATAGRAM_PORT,
            session: cameras.session,
        };
        session.done(pair, 0, &partner).expect("they find each other");
        self.cameras = Some(cameras);
        self.until("their clocks are related", |_, tracker| tracker.clock_settled);
    }

    fn done(&mut self, board: usize, request: &Request) {
        assert_eq!(self.ask(board, request), Response::Done, "{request:?}");
    }

    /// A request that comes while no tick begins.
    fn ask(&mut self, board: usize, request: &Request) -> Response {
        self.run_to_tick(board);
        let answer = self
            .session
            .ask(&mut self.pair, board, request)
            .expect("an answer");
        assert!(!matches!(answer, Response::Refused(_)), "{request:?}: {answer:?}");
        self.asked[board].push(Asked {
            request: request.clone(),
            answer: answer.clone(),
        });
        answer
    }

    /// Runs until a tick has just been, so that there is time before the next.
    fn run_to_tick(&mut self, board: usize) {
        let ticks = |pair: &Pair| pair.boards[board].chip().shared.outside.steps / STEPS[board];
        let last = ticks(&self.pair);
        while ticks(&self.pair) == last {
            self.step();
        }
    }

    fn step(&mut self) {
        self.pair.run_slice();
        if let Some(cameras) = &mut self.cameras {
            cameras.step(&self.pair);
        }
    }

    fn motion(&mut self) -> MotionStatus {
        match self.ask(0, &Request::Status) {
            Response::MotionStatus(status) => status,
            other => panic!("{other:?}"),
        }
    }

    fn tracker(&mut self) -> TrackerStatus {
        match self.ask(1, &Request::Status) {
            Response::TrackerStatus(status) => status,
            other => panic!("{other:?}"),
        }
    }

    fn until(&mut self, what: &str, there: impl Fn(&MotionStatus, &TrackerStatus) -> bool) {
        let end = self.pair.now() + LIMIT;
        loop {
            let (motion, tracker) = (self.motion(), self.tracker());
            assert_eq!((motion.fault, tracker.fault), (None, None), "{what}");
            if there(&motion, &tracker) {
                return;
            }
            assert!(self.pair.now() < end, "not within {LIMIT}: {what}");
            let later = self.pair.now() + LOOK;
            while self.pair.now() < later {
                self.step();
            }
        }
    }
}
