//! The motion board with its machine.

use super::KNOTS;
use plant::MotionPlant;
use shared::io::MotionCommand;
use shared::motion::{MotionController, PathTickInput, SERVO_TICKS_PER_PATH_TICK, ServoLoops};
use shared::protocol::{Batch, MotionSample, MotionTelemetry, PathState, Request, Response};

pub struct MotionBoard {
    plant: MotionPlant,
    command: MotionCommand,
    servo: ServoLoops,
    controller: Box<MotionController<KNOTS>>,
    ticks: u32,
    batch: Batch<MotionSample>,
    telemetry: Option<MotionTelemetry>,
    pub estop: bool,
}

impl MotionBoard {
    pub fn new(plant: MotionPlant) -> Self {
        Self {
            plant,
            command: MotionCommand::SAFE,
            servo: ServoLoops::default(),
            controller: Box::new(MotionController::new()),
            ticks: 0,
            batch: Batch::default(),
            telemetry: None,
            estop: false,
        }
    }

    /// One servo tick, and the path tick where it is due; what goes to the tracker board then.
    pub fn tick(&mut self, now_us: u64) -> Option<PathState> {
        let mut feedback = self.plant.advance(&self.command);
        feedback.estop = self.estop;
        let truth = Some(self.plant.truth());
        self.command = self.servo.tick(&feedback, truth, 1);
        self.ticks += 1;
        self.ticks
            .is_multiple_of(SERVO_TICKS_PER_PATH_TICK)
            .then(|| self.path_tick(now_us))
    }

    fn path_tick(&mut self, now_us: u64) -> PathState {
        let output = self.controller.tick(&PathTickInput {
            now_us,
            elapsed: 1,
            report: self.servo.take_report(),
        });
        if let Some(setup) = self.controller.take_servo_setup() {
            self.servo.configure(setup);
        }
        self.servo.give(&output.order);
        let full = self.batch.push(output.sample);
        self.telemetry = full.map(|samples| MotionTelemetry { samples });
        output.path_state
    }

    /// Telemetry to send since the last call.
    pub fn telemetry(&mut self) -> Option<MotionTelemetry> {
        self.telemetry.take()
    }

    pub fn handle(&mut self, request: &Request) -> Response {
        self.controller.handle(request, 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::MachineFile;
    use plant::DEFAULT_MACHINE;
    use shared::io::{AXES, DacCode, MOTOR_AXIS, MOTORS};
    use shared::kinematics::{AXIS_UNIT, KinematicsConfig};
    use shared::motion::{Fault, MotionConfig, State};
    use shared::protocol::{Knot, MotionStatus, PathAction, PathEvent, Refusal};
    use shared::trajectory::{CHANNELS, PathSpace};

    fn config() -> MotionConfig {
        config_of(DEFAULT_MACHINE)
    }

    /// Of a shipped machine file.
    fn config_of(machine: &str) -> MotionConfig {
        let path = format!("{}/../machines/{machine}.toml", env!("CARGO_MANIFEST_DIR"));
        MachineFile::read(std::path::Path::new(&path))
            .expect("a shipped machine file")
            .motion
    }

    /// A board with a clock, that keeps what it published.
    struct Bench {
        board: MotionBoard,
        now_us: u64,
        samples: Vec<MotionSample>,
    }

    impl Bench {
        fn configured() -> Self {
            Self::configured_as(DEFAULT_MACHINE)
        }

        /// Of a machine by its name.
        fn configured_as(machine: &str) -> Self {
            let plant = MotionPlant::of(machine).expect("a plant of the machine");
            let mut bench = Self {
                board: MotionBoard::new(plant),
                now_us: 0,
                samples: Vec::new(),
            };
            bench.done(&Request::ConfigureMotion(config_of(machine)));
            bench.run_ms(5);
            bench
        }

        fn homed() -> Self {
            let mut bench = Self::configured();
            bench.done(&Request::Home);
            bench.until(State::Idle, 20_000);
            bench
        }

        fn run_ms(&mut self, ms: u32) {
            for _ in 0..ms * SERVO_TICKS_PER_PATH_TICK {
                self.now_us += 250;
                self.board.tick(self.now_us);
                if let Some(batch) = self.board.telemetry() {
                    self.samples.extend(batch.samples);
                }
            }
        }

        /// Runs until `state`, asking for the status like a PC that is alive; at most `ms`.
        fn until(&mut self, state: State, ms: u32) {
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

        fn status(&mut self) -> MotionStatus {
            match self.board.handle(&Request::Status) {
                Response::MotionStatus(status) => status,
                other => panic!("{other:?}"),
            }
        }

        fn done(&mut self, request: &Request) {
            assert_eq!(self.board.handle(request), Response::Done, "{request:?}");
        }

        /// Loads a straight line of `length` mm along X from where the machine stands, in its attitude.
        fn load_line(&mut self, length: f64) {
            let machine = config().kinematics().expect("kinematics");
            let reference = self.status().reference;
            let axes: [f64; 6] = std::array::from_fn(|i| reference[i] * shared::kinematics::AXIS_UNIT[i]);
            let pose = machine.forward(&axes);
            self.done(&Request::ClearPath {
                id: 7,
                space: PathSpace::Tool,
            });
            for s_mm in [0.0, length] {
                let mut value = [0.0; CHANNELS];
                let mut slope = [0.0; CHANNELS];
                value[..3].copy_from_slice(pose.position.as_slice());
                value[0] += s_mm;
                value[3..6].copy_from_slice(pose.tangent.as_slice());
                value[6..9].copy_from_slice(pose.normal.as_slice());
                slope[0] = 1.0;
                let mut knots = heapless::Vec::new();
                knots.push(Knot { s_mm, value, slope }).expect("one knot");
                self.done(&Request::LoadKnots(knots));
            }
            for (s_mm, action) in [
                (
                    20.0,
                    PathAction::Power {
                        side: 0,
                        watt: 2000.0,
                    },
                ),
                (20.0, PathAction::Beam { side: 0, on: true }),
                (length - 20.0, PathAction::Beam { side: 0, on: false }),
            ] {
                self.done(&Request::LoadEvent(PathEvent { s_mm, action }));
            }
        }

        fn run(&mut self) {
            self.done(&Request::Run {
                speed_mm_s: 150.0,
                acceleration_mm_s2: 1000.0,
                jerk_mm_s3: 20_000.0,
            });
        }
    }

    #[test]
    fn homing_finds_the_marks_and_squares_the_gantry() {
        let mut bench = Bench::homed();
        assert!(bench.status().homed);
        bench.run_ms(200);
        let truth = bench.board.plant.truth();
        // Positions are counted from the marks, so they agree with the truth to a few counts.
        let status = bench.status();
        let true_axes = [truth[0], truth[2], truth[3], truth[4], truth[5], truth[6]];
        for axis in 0..6 {
            let position = status.axes[axis] * shared::kinematics::AXIS_UNIT[axis];
            assert!(
                (position - true_axes[axis]).abs() < 0.002,
                "axis {axis}: {position} {true_axes:?}"
            );
        }
        assert!(
            (truth[0] - truth[1]).abs() < 0.002,
            "skew {}",
            truth[0] - truth[1]
        );
    }

    #[test]
    fn every_machine_homes_and_commands_no_motor_it_does_not_have() {
        for name in KinematicsConfig::NAMES {
            let motors = config_of(name).motors.map(|motor| motor.is_some());
            let mut bench = Bench::configured_as(name);
            bench.done(&Request::Home);
            for elapsed in 0..20_000 {
                bench.run_ms(1);
                let commanded = bench.board.command.dac;
                for motor in (0..MOTORS).filter(|motor| !motors[*motor]) {
                    assert_eq!(commanded[motor], DacCode::ZERO, "{name}, motor {motor}");
                }
                let status = if elapsed % 100 == 0 {
                    bench.status()
                } else {
                    continue;
                };
                assert_ne!(status.state, State::Fault, "{name}: {:?}", status.fault);
                if status.state == State::Idle {
                    break;
                }
            }
            bench.run_ms(200);
            let status = bench.status();
            assert!(status.homed && status.state == State::Idle, "{name}: {status:?}");
            let truth = bench.board.plant.truth();
            // X1 stands for X; a few counts.
            for axis in 0..AXES {
                let motor = (0..MOTORS).find(|motor| MOTOR_AXIS[*motor] == axis).expect("one");
                let true_position = truth[motor] / AXIS_UNIT[axis];
                let off = (status.axes[axis] - true_position).abs();
                assert!(off < 0.002, "{name}, axis {axis}: {off}");
                assert!(motors[motor] || status.axes[axis] == 0.0, "{name}, axis {axis}");
            }
        }
    }

    #[test]
    fn a_line_is_followed_within_micrometres_with_the_beam_where_it_belongs() {
        let mut bench = Bench::homed();
        bench.load_line(200.0);
        bench.run();
        bench.samples.clear();
        bench.until(State::Idle, 5_000);
        let beam: Vec<_> = bench.samples.iter().filter(|sample| sample.beams[0]).collect();
        let (first, last) = (beam.first().expect("beam on"), beam.last().expect("beam on"));
        assert!(
            (first.s_mm - 20.0).abs() < 0.151 && (last.s_mm - 180.0).abs() < 0.151,
            "{} {}",
            first.s_mm,
            last.s_mm
        );
        let worst = bench
            .samples
            .iter()
            .flat_map(|sample| sample.following_error)
            .fold(0.0, f32::max);
        assert!(worst < 0.05, "following error {worst}");
        let skew = bench
            .samples
            .iter()
            .map(|sample| sample.skew_mm)
            .fold(0.0, f32::max);
        assert!(skew < 0.03, "skew {skew}");
        println!("following error {worst}, skew {skew}");
    }

    #[test]
    fn hold_stops_on_the_path_with_the_beam_off_and_resume_goes_on() {
        let mut bench = Bench::homed();
        bench.load_line(300.0);
        bench.run();
        bench.run_ms(400);
        assert!(bench.samples.last().expect("samples").beams[0]);
        bench.done(&Request::Hold);
        bench.run_ms(5);
        assert_eq!(bench.samples.last().expect("samples").beams, [false; 2]);
        bench.run_ms(400);
        let held = bench.status();
        assert_eq!(held.state, State::Holding);
        assert!(held.s_mm > 20.0 && held.s_mm < 280.0);
        let line = bench.board.plant.truth();
        bench.run_ms(100);
        let moved = bench.board.plant.truth()[0] - line[0];
        assert!(moved.abs() < 2e-3, "moved {moved}");
        bench.done(&Request::Resume);
        bench.run_ms(20);
        bench.until(State::Idle, 5_000);
        assert_eq!(bench.status().s_mm, 300.0);
    }

    #[test]
    fn a_silent_pc_stops_the_machine_on_the_path() {
        let mut bench = Bench::homed();
        bench.load_line(600.0);
        bench.run();
        bench.run_ms(2000);
        let status = bench.status();
        assert_eq!(status.state, State::Fault);
        assert!(
            matches!(status.fault, Some(Fault::LinkLost { .. })),
            "{:?}",
            status.fault
        );
        assert!(status.s_mm < 300.0);
        bench.done(&Request::Reset);
        assert_eq!(bench.status().state, State::Off);
    }

    #[test]
    fn the_emergency_stop_switches_everything_off_in_one_tick() {
        let mut bench = Bench::homed();
        bench.load_line(300.0);
        bench.run();
        bench.run_ms(400);
        bench.board.estop = true;
        bench.now_us += 250;
        bench.board.tick(bench.now_us);
        assert_eq!(bench.board.command, MotionCommand::SAFE);
        bench.run_ms(5);
        assert_eq!(bench.status().fault, Some(Fault::EmergencyStop));
        assert!(bench.board.handle(&Request::Home) != Response::Done);
    }

    #[test]
    fn what_makes_no_sense_is_refused_and_changes_nothing() {
        let mut bench = Bench {
            board: MotionBoard::new(MotionPlant::default()),
            now_us: 0,
            samples: Vec::new(),
        };
        let refused = |bench: &mut Bench, request: Request| match bench.board.handle(&request) {
            Response::Refused(refusal) => refusal,
            other => panic!("{other:?}"),
        };
        assert_eq!(refused(&mut bench, Request::Home), Refusal::NotConfigured);
        let mut bad = config();
        bad.motors[2].as_mut().expect("Y").kp = -1.0;
        assert!(matches!(
            refused(&mut bench, Request::ConfigureMotion(bad)),
            Refusal::Parameter(_)
        ));
        let mut bench = Bench::homed();
        let run = Request::Run {
            speed_mm_s: 100.0,
            acceleration_mm_s2: 1000.0,
            jerk_mm_s3: 20_000.0,
        };
        bench.done(&Request::ClearPath {
            id: 1,
            space: PathSpace::Tool,
        });
        assert_eq!(refused(&mut bench, run.clone()), Refusal::NoPath);
        assert!(matches!(
            refused(&mut bench, Request::Hold),
            Refusal::WrongState { state: State::Idle }
        ));
        bench.load_line(100.0);
        bench.run();
        bench.until(State::Idle, 5_000);
        // The axes now stand at the end of that path, not at its start.
        assert!(matches!(
            refused(&mut bench, run),
            Refusal::NotAtStart { axis: 0, .. }
        ));
        assert_eq!(
            refused(&mut bench, Request::ConfigureMotion(config())),
            Refusal::WrongState { state: State::Idle }
        );
    }
}
