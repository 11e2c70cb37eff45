//! Servo loops and controller in lockstep with drives that follow their command at once.

use shared::config::{BeamConfig, MotionConfig, ProcessIo};
use shared::control::{GantryConfig, HomeConfig, MotorConfig};
use shared::io::{MOTORS, MotionCommand, MotionFeedback};
use shared::kinematics::{AXIS_UNIT, AxisConfig, DualBeamConfig, KinematicsConfig};
use shared::motion::{MotionController, PathTickInput, ServoLoops};
use shared::protocol::{
    MotionSample, MotionStatus, PathAction, PathChannel, PathElement, PathEvent, PathJoin, PathLimits,
    PathShape, PathState, Refusal, Request, Response, Room,
};
use shared::state::{Fault, State};
use shared::ticks::{SERVO_PERIOD_S, SERVO_TICKS_PER_PATH_TICK};
use shared::trajectory::{BoardPlanning, PathSpace};

/// Counts in one mm or degree.
pub const SCALE: f64 = 10_000.0;
/// Speed at +10 V \[mm/s, deg/s\].
pub const FULL_SPEED: f64 = 400.0;
/// Where the linear marks are on their axes; the machine is switched on 2 mm above them \[mm\].
pub const MARK: f64 = 500.0;
/// Where the lower limit switches are, from where the machine is switched on (mm or degrees).
const LOW_END: f64 = -12.0;
/// Highest position of the linear axes \[mm\].
pub const TRAVEL_MAX: f64 = 1000.0;
pub const Y: usize = 2;

/// Limits of the paths here.
pub const LIMITS: PathLimits = PathLimits {
    acceleration_mm_s2: 1000.0,
    jerk_mm_s3: 20_000.0,
    tolerance_mm: 0.05,
};
pub const BLEND: PathJoin = PathJoin::Blend {
    position_mm: 0.05,
    attitude_rad: 1e-4,
};

/// One element.
pub fn load(element: PathElement, last: bool) -> Request {
    Request::LoadElements {
        elements: [element].into_iter().collect(),
        last,
    }
}

pub fn config() -> MotionConfig {
    let motor = |mark_position| MotorConfig {
        counts_per_unit: SCALE,
        velocity_at_10v: FULL_SPEED,
        kp: 100.0,
        ki: 0.0,
        integral_limit: 0.0,
        anti_windup_time_s: 0.0,
        kd: 0.0,
        derivative_filter_s: 0.0,
        velocity_feed_forward: 1.0,
        acceleration_feed_forward_s: 0.0,
        notches: heapless::Vec::new(),
        low_pass: None,
        friction: None,
        max_command: FULL_SPEED,
        following_error_base: 0.5,
        following_error_time_s: 0.05,
        vibration_limit: 0.0,
        home_sequence: 1,
        home: HomeConfig {
            velocity: -20.0,
            mark_position,
            max_travel: 400.0,
        },
    };
    let axis = |min, max| AxisConfig {
        travel_min: min,
        travel_max: max,
        max_velocity: 300.0,
        max_acceleration: 1000.0,
        max_jerk: 20_000.0,
    };
    let (linear, rotary) = (axis(0.0, TRAVEL_MAX), axis(-90.0, 90.0));
    let (x, turn) = (motor(MARK), motor(0.0));
    let z = MotorConfig {
        home_sequence: 0,
        ..x.clone()
    };
    let beam = BeamConfig {
        power_at_10v_w: 4000.0,
        min_speed_mm_s: 5.0,
        overlap_mm: 2.0,
        stays_on_at_rest: false,
        readback: None,
    };
    MotionConfig {
        kinematics: KinematicsConfig::DualBeamGantry(DualBeamConfig {
            o1_mm: [0.0, 0.0, -120.0],
            o2_mm: [0.0, 0.0, -80.0],
            o3_mm: [0.0, 0.0, -450.0],
        }),
        axes: [
            linear.clone(),
            linear.clone(),
            linear,
            rotary.clone(),
            rotary.clone(),
            rotary,
        ]
        .map(Some),
        motors: [x.clone(), x.clone(), x, z, turn.clone(), turn.clone(), turn].map(Some),
        gantry: Some(GantryConfig {
            coupling: 20.0,
            coupling_derivative: 0.0,
            derivative_filter_s: 0.0,
            square_offset_mm: 0.0,
            skew_trip_mm: 0.3,
            y1_mm: -250.0,
            y2_mm: 3250.0,
        }),
        beams: [Some(beam.clone()), Some(beam)],
        process: ProcessIo::default(),
        link_timeout_ms: 500,
        drive_enable_ms: 0,
    }
}

fn counts(position: f64) -> i64 {
    (position * SCALE).floor() as i64
}

pub struct Bench {
    pub servo: ServoLoops,
    pub controller: Box<MotionController>,
    planning: Box<BoardPlanning>,
    /// Where the motors stand, from where they were switched on (mm or degrees).
    pub position: [f64; MOTORS],
    /// Where their marks are.
    pub marks: [Option<f64>; MOTORS],
    /// What a grating counts beside the position.
    pub slipped: [i64; MOTORS],
    /// What a grating counts that counts no more.
    pub dead: [Option<i64>; MOTORS],
    /// The motor does not turn.
    pub blocked: [bool; MOTORS],
    /// Switches and faults as the next ticks read them, beside the limit switches at [`LOW_END`].
    pub inputs: MotionFeedback,
    pub command: MotionCommand,
    pub now_us: u64,
    servo_ticks: u32,
    pub samples: Vec<MotionSample>,
    pub path_state: Option<PathState>,
}

impl Bench {
    /// Just switched on, without parameters.
    pub fn new() -> Self {
        Self {
            servo: ServoLoops::default(),
            controller: Box::new(MotionController::new()),
            planning: Box::new(BoardPlanning::new()),
            position: [0.0; MOTORS],
            marks: [Some(-2.0); MOTORS],
            slipped: [0; MOTORS],
            dead: [None; MOTORS],
            blocked: [false; MOTORS],
            inputs: MotionFeedback::default(),
            command: MotionCommand::SAFE,
            now_us: 1_000_000,
            servo_ticks: 0,
            samples: Vec::new(),
            path_state: None,
        }
    }

    pub fn configured() -> Self {
        Self::configured_as(config())
    }

    pub fn configured_as(config: MotionConfig) -> Self {
        let mut bench = Self::new();
        bench.done(&Request::ConfigureMotion(config));
        bench.run_ms(3);
        bench
    }

    pub fn homed() -> Self {
        Self::homed_as(config())
    }

    pub fn homed_as(config: MotionConfig) -> Self {
        let mut bench = Self::configured_as(config);
        bench.done(&Request::Home);
        bench.until(State::Idle, 5000);
        bench
    }

    /// On a line of 300 mm along Y, at full speed, with the beam on.
    pub fn welding() -> Self {
        let mut bench = Self::homed();
        bench.load_line(300.0);
        bench.run();
        bench.run_ms(400);
        assert!(bench.command.beam_gate[0] && bench.status().state == State::Running);
        bench
    }

    /// One servo tick, `elapsed` periods after the last.
    pub fn servo_tick_after(&mut self, elapsed: u32) {
        self.now_us += 250 * u64::from(elapsed);
        let mut feedback = self.inputs;
        for motor in 0..MOTORS {
            let before = self.position[motor];
            if !self.blocked[motor] {
                let speed = self.command.dac[motor].ratio() * FULL_SPEED;
                self.position[motor] += speed * SERVO_PERIOD_S * f64::from(elapsed);
            }
            let now = self.position[motor];
            feedback.counts[motor] = self.dead[motor].unwrap_or(counts(now) + self.slipped[motor]);
            feedback.mark[motor] = self.marks[motor]
                .filter(|mark| (before - mark) * (now - mark) < 0.0)
                .map(|mark| counts(mark) + self.slipped[motor]);
            if now < LOW_END {
                feedback.limit_minus.set(motor, true);
            }
        }
        self.command = self.servo.tick(&feedback, None, elapsed);
        self.servo_ticks = self.servo_ticks.wrapping_add(elapsed);
    }

    /// One path tick, `elapsed` periods after the last.
    pub fn path_tick_after(&mut self, elapsed: u32) {
        let output = self.controller.tick(&PathTickInput {
            now_us: self.now_us,
            elapsed,
            report: self.servo.take_report(),
        });
        if let Some(setup) = self.controller.take_servo_setup() {
            self.servo.configure(setup);
        }
        self.servo.give(&output.order);
        self.controller.plan(&mut self.planning);
        self.samples.push(output.sample);
        self.path_state = Some(output.path_state);
    }

    /// A quarter of a millisecond, with the path tick where it is due.
    pub fn servo_tick(&mut self) {
        self.servo_tick_after(1);
        if self.servo_ticks.is_multiple_of(SERVO_TICKS_PER_PATH_TICK) {
            self.path_tick_after(1);
        }
    }

    /// A millisecond without its path tick.
    pub fn ms_without_path_tick(&mut self) {
        for _ in 0..SERVO_TICKS_PER_PATH_TICK {
            self.servo_tick_after(1);
        }
    }

    pub fn run_ms(&mut self, ms: u32) {
        for _ in 0..ms * SERVO_TICKS_PER_PATH_TICK {
            self.servo_tick();
        }
    }

    /// Runs until `state`, at most `ms`, asking for the status every 100 ms like a PC that is alive.
    pub fn until(&mut self, state: State, ms: u32) {
        for elapsed in 0..ms {
            self.run_ms(1);
            if self.controller.state() == state {
                return;
            }
            if elapsed % 100 == 0 {
                self.status();
            }
        }
        panic!("{state:?} was not reached in {ms} ms: {:?}", self.status());
    }

    pub fn status(&mut self) -> MotionStatus {
        match self.controller.handle(&Request::Status, 0) {
            Response::MotionStatus(status) => status,
            other => panic!("{other:?}"),
        }
    }

    pub fn fault(&mut self) -> Option<Fault> {
        self.status().fault
    }

    pub fn done(&mut self, request: &Request) {
        assert_eq!(self.controller.handle(request, 0), Response::Done, "{request:?}");
    }

    pub fn refused(&mut self, request: &Request) -> Refusal {
        match self.controller.handle(request, 0) {
            Response::Refused(refusal) => refusal,
            other => panic!("{other:?}"),
        }
    }

    /// A request that is answered by the room that is left.
    pub fn loaded(&mut self, request: &Request) -> Room {
        match self.controller.handle(request, 0) {
            Response::Room(room) => room,
            other => panic!("{other:?}"),
        }
    }

    /// Begins path 7 where the machine stands.
    pub fn begin(&mut self, space: PathSpace) {
        self.done(&Self::begin_request(space));
    }

    pub fn begin_request(space: PathSpace) -> Request {
        Request::BeginPath {
            id: 7,
            space,
            start_s_mm: 0.0,
            limits: LIMITS,
        }
    }

    /// The part of a line along Y from `from` to `to` mm from where the machine stands, in its attitude.
    pub fn along_y(&mut self, from: f64, to: f64, feed_mm_s: f64, join: PathJoin) -> PathElement {
        let machine = config().kinematics().unwrap();
        let reference = self.status().reference;
        let pose = machine.forward(&std::array::from_fn(|axis| reference[axis] * AXIS_UNIT[axis]));
        let at = |way: f64| [pose.position.x, pose.position.y + way, pose.position.z];
        let mut rest = [PathChannel::Constant(0.0); 8];
        for (i, value) in pose.tangent.iter().chain(&pose.normal).enumerate() {
            rest[i] = PathChannel::Constant(*value);
        }
        PathElement {
            line: 1 + from as u32,
            shape: PathShape::Line {
                start: at(from),
                end: at(to),
            },
            rest,
            length_mm: to - from,
            feed_mm_s,
            join,
        }
    }

    /// Loads a line of `length` mm along Y from where the machine stands, with beam 1 on over all of it.
    pub fn load_line(&mut self, length: f64) {
        self.load_steps(&[(length, 150.0)]);
    }

    /// Loads a line along Y from where the machine stands, with beam 1 on over all of it: to each place \[mm\] at
    /// its speed.
    pub fn load_steps(&mut self, steps: &[(f64, f64)]) {
        self.begin(PathSpace::Tool);
        let mut from = 0.0;
        for (i, (to, feed)) in steps.iter().enumerate() {
            let last = i + 1 == steps.len();
            let join = if last { PathJoin::Stop } else { BLEND };
            let element = self.along_y(from, *to, *feed, join);
            self.loaded(&load(element, last));
            from = *to;
        }
        self.loaded(&Request::LoadEvents(
            [
                PathAction::Power {
                    side: 0,
                    watt: 2000.0,
                },
                PathAction::Beam { side: 0, on: true },
            ]
            .into_iter()
            .map(|action| PathEvent { s_mm: 0.0, action })
            .collect(),
        ));
    }

    pub fn run(&mut self) {
        self.done(&Request::Run);
    }

    /// Speed of Y now \[mm/s\].
    pub fn speed(&self) -> f64 {
        self.command.dac[Y].ratio() * FULL_SPEED
    }

    /// The machine is brought to rest with its drives on, no faster than the path allows, the beam off all the
    /// time; then it is in fault. Returns the distance \[mm\].
    pub fn stops_on_the_path_then_faults(&mut self) -> f64 {
        let from = self.position[Y];
        let mut speed = self.speed();
        for _ in 0..4000 {
            self.servo_tick();
            assert_eq!(self.command.beam_gate, [false; 2]);
            if self.controller.state() == State::Fault {
                assert!(speed.abs() < 0.5, "drives off at {speed} mm/s");
                self.run_ms(1);
                assert_eq!(self.command, MotionCommand::SAFE);
                return self.position[Y] - from;
            }
            assert!(self.command.enable);
            // 1000 mm/s² in 0.25 ms, and what the position loop adds.
            let change = self.speed() - speed;
            assert!(change.abs() < 0.5, "{change} mm/s in a tick");
            speed = self.speed();
        }
        panic!("did not stop: {:?}", self.status());
    }
}
