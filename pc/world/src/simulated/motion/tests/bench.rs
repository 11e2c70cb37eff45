//! A motion board with a clock.

use crate::simulated::motion::MotionBoard;
use config::machine::MachineFile;
use plant::MotionPlant;
use plant_file::{DEFAULT_MACHINE, PlantFile};
use shared::config::MotionConfig;
use shared::protocol::{
    MotionSample, MotionStatus, PathAction, PathChannel, PathElement, PathEvent, PathJoin, PathLimits,
    PathShape, Request, Response,
};
use shared::state::State;
use shared::ticks::SERVO_TICKS_PER_PATH_TICK;
use shared::trajectory::{CHANNELS, PathSpace, SHAPED};

pub fn config() -> MotionConfig {
    config_of(DEFAULT_MACHINE)
}

/// Of a shipped machine file.
pub fn config_of(machine: &str) -> MotionConfig {
    let path = format!("{}/../../machines/{machine}.toml", env!("CARGO_MANIFEST_DIR"));
    MachineFile::read(std::path::Path::new(&path))
        .expect("a shipped machine file")
        .motion
}

/// A board with a clock, that keeps what it published.
pub struct Bench {
    pub board: MotionBoard,
    pub now_us: u64,
    pub samples: Vec<MotionSample>,
}

/// The motors of a machine by its name.
pub fn plant_of(machine: &str) -> MotionPlant {
    PlantFile::shipped(machine)
        .unwrap_or_else(|error| panic!("{error}"))
        .motion()
}

impl Bench {
    pub fn configured() -> Self {
        Self::configured_as(DEFAULT_MACHINE)
    }

    /// Of a machine by its name.
    pub fn configured_as(machine: &str) -> Self {
        let mut bench = Self {
            board: MotionBoard::new(plant_of(machine)),
            now_us: 0,
            samples: Vec::new(),
        };
        bench.done(&Request::ConfigureMotion(config_of(machine)));
        bench.run_ms(5);
        bench
    }

    pub fn homed() -> Self {
        let mut bench = Self::configured();
        bench.done(&Request::Home);
        bench.until(State::Idle, 20_000);
        bench
    }

    pub fn run_ms(&mut self, ms: u32) {
        for _ in 0..ms * SERVO_TICKS_PER_PATH_TICK {
            self.now_us += 250;
            self.board.tick(self.now_us);
            if let Some(batch) = self.board.telemetry() {
                self.samples.extend(batch.samples);
            }
        }
    }

    /// Runs until `state`, asking for the status like a PC that is alive; at most `ms`.
    pub fn until(&mut self, state: State, ms: u32) {
        for _ in 0..ms / 100 {
            self.run_ms(100);
            let status = self.status();
            if status.state == state {
                return;
            }
            assert_ne!(status.state, State::Fault, "{:?}", status.fault);
        }
        panic!("{state:?} was not reached in {ms} ms: {:?}", self.status());
    }

    pub fn status(&mut self) -> MotionStatus {
        match self.board.handle(&Request::Status) {
            Response::MotionStatus(status) => status,
            other => panic!("{other:?}"),
        }
    }

    pub fn done(&mut self, request: &Request) {
        assert_eq!(self.board.handle(request), Response::Done, "{request:?}");
    }

    /// A request that is answered by the room that is left.
    pub fn loaded(&mut self, request: &Request) {
        let response = self.board.handle(request);
        assert!(matches!(response, Response::Room(_)), "{response:?}");
    }

    /// Loads a straight line of `length` mm along X at 150 mm/s from where the machine stands, in its attitude.
    pub fn load_line(&mut self, length: f64) {
        let machine = config().kinematics().expect("kinematics");
        let reference = self.status().reference;
        let axes: [f64; 6] = std::array::from_fn(|i| reference[i] * shared::kinematics::AXIS_UNIT[i]);
        let pose = machine.forward(&axes);
        self.done(&Request::BeginPath {
            id: 7,
            space: PathSpace::Tool,
            start_s_mm: 0.0,
            limits: PathLimits {
                acceleration_mm_s2: 1000.0,
                jerk_mm_s3: 20_000.0,
                tolerance_mm: 0.05,
            },
        });
        let attitude = pose.tangent.iter().chain(&pose.normal).chain(&[0.0; 2]);
        let mut rest = [PathChannel::Constant(0.0); CHANNELS - SHAPED];
        for (channel, value) in rest.iter_mut().zip(attitude) {
            *channel = PathChannel::Constant(*value);
        }
        let start = pose.position;
        let element = PathElement {
            line: 1,
            shape: PathShape::Line {
                start: start.into(),
                end: [start.x + length, start.y, start.z],
            },
            rest,
            length_mm: length,
            feed_mm_s: 150.0,
            join: PathJoin::Stop,
        };
        self.loaded(&Request::LoadElements {
            elements: [element].into_iter().collect(),
            last: true,
        });
        let power = PathAction::Power {
            side: 0,
            watt: 2000.0,
        };
        let beam = |on| PathAction::Beam { side: 0, on };
        let events = [(20.0, power), (20.0, beam(true)), (length - 20.0, beam(false))];
        let events = events.map(|(s_mm, action)| PathEvent { s_mm, action });
        self.loaded(&Request::LoadEvents(events.into_iter().collect()));
    }

    pub fn run(&mut self) {
        self.done(&Request::Run);
    }
}
