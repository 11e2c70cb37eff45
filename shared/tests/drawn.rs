//! Drawn machines, which are not as their machine file assumes: what every one of them must do uncommissioned.

use config::machine::MachineFile;
use plant::MotionPlant;
use plant_file::{DEFAULT_MACHINE, PlantChoice, Quality};
use shared::io::MotionCommand;
use shared::motion::{MotionController, PathTickInput, ServoLoops};
use shared::protocol::{Request, Response};
use shared::state::{Fault, State};
use std::path::Path;

/// A drawn machine behind the controller of the board.
struct Drawn {
    plant: MotionPlant,
    servo: ServoLoops,
    controller: Box<MotionController>,
    command: MotionCommand,
    now_us: u64,
}

impl Drawn {
    fn new(quality: Quality, seed: u32) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines/dual-beam-gantry.toml");
        let machine = MachineFile::read(&path).unwrap();
        let plant = PlantChoice::Drawn { quality, seed }.of(DEFAULT_MACHINE).unwrap();
        let mut drawn = Self {
            plant: plant.motion(),
            servo: ServoLoops::default(),
            controller: Box::new(MotionController::new()),
            command: MotionCommand::SAFE,
            now_us: 1_000_000,
        };
        drawn.done(&Request::ConfigureMotion(machine.motion));
        drawn.run_ms(5);
        drawn
    }

    fn done(&mut self, request: &Request) {
        assert_eq!(self.controller.handle(request, 0), Response::Done, "{request:?}");
    }

    fn run_ms(&mut self, ms: u32) {
        for _ in 0..ms {
            for _ in 0..4 {
                let feedback = self.plant.advance(&self.command);
                self.command = self.servo.tick(&feedback, None, 1);
            }
            self.now_us += 1000;
            let output = self.controller.tick(&PathTickInput {
                now_us: self.now_us,
                elapsed: 1,
                report: self.servo.take_report(),
            });
            if let Some(setup) = self.controller.take_servo_setup() {
                self.servo.configure(setup);
            }
            self.servo.give(&output.order);
        }
    }

    /// Homes; the fault if that does not succeed.
    fn home(&mut self) -> Option<Fault> {
        self.done(&Request::Home);
        for _ in 0..3000 {
            self.run_ms(100);
            let Response::MotionStatus(status) = self.controller.handle(&Request::Status, 0) else {
                panic!("no status");
            };
            if status.state != State::Homing {
                return status.fault;
            }
        }
        panic!("homing has no end");
    }
}

#[test]
fn usual_machines_home_and_none_is_stopped_for_the_offset_of_a_drive() {
    for seed in 1..=20 {
        assert_eq!(Drawn::new(Quality::Usual, seed).home(), None, "usual {seed}");
        // Poor ones may be stopped for their resonances, which is right.
        let fault = Drawn::new(Quality::Poor, seed).home();
        assert!(
            !matches!(fault, Some(Fault::NoMovement { .. })),
            "poor {seed}: {fault:?}"
        );
    }
}
