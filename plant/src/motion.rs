//! What a motion board is wired to: the servo axes of a machine, and its beams.

use crate::beam::Beam;
use crate::config::{ERRORS, GeometryConfig, PlantConfig, TouchConfig};
use crate::geometry::axes;
use crate::motor::RunningMotor;
use heapless::Vec;
use shared::io::{
    Bits, Command, DacCode, Feedback, MOTOR_AXIS, MOTORS, MotionCommand, MotionFeedback, PROCESS_INPUTS,
    SIDES,
};
use shared::kinematics::AXIS_UNIT;

/// All inputs of the process on.
const ANSWERS: Bits = Bits((1 << PROCESS_INPUTS) - 1);

/// Drives, gratings and beams behind a motion board. A motor that the machine does not have counts nothing,
/// closes no switch and stays at 0.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionPlant {
    motors: [Option<RunningMotor>; MOTORS],
    /// What the sources give, as part of full power.
    power: [f64; SIDES],
    /// Their power, regardless of commands.
    stuck: [Option<DacCode>; SIDES],
    geometry: Vec<GeometryConfig, ERRORS>,
    beam: Option<Beam>,
    touch: Option<TouchConfig>,
}

impl MotionPlant {
    /// The machine of `config`, standing where it was switched off.
    pub fn new(config: &PlantConfig) -> Self {
        let motor = |i: usize| {
            let unit = AXIS_UNIT[MOTOR_AXIS[i]];
            let motor = config.motors[i].as_ref()?;
            Some(RunningMotor::new(motor, unit, config.seed, i as u32))
        };
        Self {
            motors: core::array::from_fn(motor),
            power: [0.0; SIDES],
            stuck: [None; SIDES],
            geometry: config.geometry.clone(),
            beam: config.beam.as_ref().map(Beam::new),
            touch: config.touch.clone(),
        }
    }

    /// From now on the source of `side` gives this power regardless of commands, until `None`: with a gate
    /// whose line is bridged, for instance, or at 0 with its interlock open.
    pub fn stick_beam(&mut self, side: usize, power: Option<DacCode>) {
        self.stuck[side] = power;
    }

    /// One servo tick of 250 µs with `command`, and what the board reads at its end.
    pub fn advance(&mut self, command: &MotionCommand) -> MotionFeedback {
        let Command {
            enable,
            dac,
            beam_gate,
            beam_power,
            ..
        } = command;
        // The process answers whatever it is asked.
        let mut feedback = Feedback {
            process: ANSWERS,
            ..Feedback::NONE
        };
        for side in 0..SIDES {
            let told = if beam_gate[side] {
                beam_power[side]
            } else {
                DacCode::ZERO
            };
            let gives = self.stuck[side].unwrap_or(told);
            self.power[side] = gives.ratio();
            feedback.beam_power[side] = Some(gives);
        }
        let pulls = match (&mut self.beam, &self.motors) {
            (Some(beam), [Some(x1), Some(x2), ..]) => beam.pulls([x1.drive(), x2.drive()]),
            _ => [0.0; 2],
        };
        for (i, motor) in self.motors.iter_mut().enumerate() {
            let Some(motor) = motor else { continue };
            let reading = motor.advance(*enable, dac[i], pulls.get(i).copied().unwrap_or_default());
            feedback.counts[i] = reading.counts;
            feedback.mark[i] = reading.mark;
            feedback.limit_minus.set(i, reading.limit_minus);
            feedback.limit_plus.set(i, reading.limit_plus);
        }
        if let Some(touch) = &self.touch {
            feedback.process = touch.read(feedback.process, &axes(&self.positions()));
        }
        feedback
    }

    /// True positions of what the motors move (mm, rad), at the end of the last tick.
    pub fn truth(&self) -> [f64; MOTORS] {
        self.positions().map(Option::unwrap_or_default)
    }

    /// The same, of the motors that are there.
    fn positions(&self) -> [Option<f64>; MOTORS] {
        let mut positions = self
            .motors
            .each_ref()
            .map(|motor| motor.as_ref().map(RunningMotor::position));
        if !self.geometry.is_empty() {
            let axes = axes(&positions);
            for error in &self.geometry {
                error.add(&axes, &mut positions);
            }
        }
        positions
    }

    /// Beams that are on: those whose source gives power.
    pub fn beams(&self) -> [bool; SIDES] {
        self.power.map(|power| power > 0.0)
    }
}
