//! What a motion board is wired to: the servo axes of a machine, and its beams.

use crate::machines::MACHINES;
use crate::motor::{Motors, RunningMotor};
use shared::io::{
    Bits, Command, DacCode, Feedback, MOTORS, MotionCommand, MotionFeedback, PROCESS_INPUTS, SIDES,
};

/// The machine where none is named.
pub const DEFAULT_MACHINE: &str = MACHINES[0].0;

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
}

impl Default for MotionPlant {
    /// [`DEFAULT_MACHINE`].
    fn default() -> Self {
        let (_, motors) = MACHINES[0];
        Self::new(motors)
    }
}

impl MotionPlant {
    /// The machine called `name`, standing where it was switched off; `None` if there is none.
    pub fn of(name: &str) -> Option<Self> {
        let (_, motors) = MACHINES.iter().find(|(known, _)| *known == name)?;
        Some(Self::new(motors))
    }

    /// Names of all machines.
    pub fn names() -> impl Iterator<Item = &'static str> {
        MACHINES.iter().map(|(name, _)| *name)
    }

    fn new(motors: &Motors) -> Self {
        Self {
            motors: core::array::from_fn(|i| motors[i].as_ref().map(RunningMotor::new)),
            power: [0.0; SIDES],
            stuck: [None; SIDES],
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
        for (i, motor) in self.motors.iter_mut().enumerate() {
            let Some(motor) = motor else { continue };
            let reading = motor.advance(*enable, dac[i]);
            feedback.counts[i] = reading.counts;
            feedback.mark[i] = reading.mark;
            feedback.limit_minus.set(i, reading.limit_minus);
            feedback.limit_plus.set(i, reading.limit_plus);
        }
        feedback
    }

    /// True positions of the loads (mm, rad), at the end of the last tick.
    pub fn truth(&self) -> [f64; MOTORS] {
        core::array::from_fn(|i| self.motors[i].as_ref().map_or(0.0, RunningMotor::position))
    }

    /// Beams that are on: those whose source gives power.
    pub fn beams(&self) -> [bool; SIDES] {
        self.power.map(|power| power > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::kinematics::KinematicsConfig;
    use shared::units::DEG_PER_RAD;

    fn command(ratio: [f64; MOTORS]) -> MotionCommand {
        MotionCommand {
            enable: true,
            dac: ratio.map(|r| DacCode::from_ratio(r, 1.0)),
            ..MotionCommand::SAFE
        }
    }

    /// Runs until `done` or `ticks` are over; the last feedback.
    fn run(plant: &mut MotionPlant, command: &MotionCommand, ticks: u32) -> MotionFeedback {
        let mut feedback = plant.advance(command);
        for _ in 1..ticks {
            feedback = plant.advance(command);
        }
        feedback
    }

    #[test]
    fn a_disabled_machine_stands_and_counts_from_zero() {
        let mut plant = MotionPlant::default();
        let mut ignored = command([1.0; MOTORS]);
        ignored.enable = false;
        let before = plant.truth();
        let feedback = run(&mut plant, &ignored, 400);
        let dark = MotionFeedback {
            beam_power: [Some(DacCode::ZERO); SIDES],
            process: ANSWERS,
            ..MotionFeedback::NONE
        };
        assert_eq!(feedback, dark);
        assert_eq!(plant.truth(), before);
        assert_eq!(before[0], 35.013);
        assert!((before[4] - 3.2_f64.to_radians()).abs() < 1e-12);
    }

    #[test]
    fn ten_volts_drive_every_motor_at_its_speed() {
        let mut plant = MotionPlant::default();
        let half = command([0.5; MOTORS]);
        run(&mut plant, &half, 800);
        let before = plant.truth();
        run(&mut plant, &half, 400);
        let after = plant.truth();
        let degrees = 75.0_f64.to_radians();
        for (i, speed) in [200.0, 200.0, 200.0, 100.0, degrees, degrees, degrees]
            .into_iter()
            .enumerate()
        {
            let seen = (after[i] - before[i]) / 0.1;
            assert!((seen / speed - 1.0).abs() < 2e-3, "motor {i}: {seen}");
        }
    }

    #[test]
    fn counts_and_truth_agree_within_half_a_count() {
        let mut plant = MotionPlant::default();
        let start = plant.truth();
        for k in 0..2000 {
            let ratio = 0.3 * libm::sin(f64::from(k) * 0.01);
            let feedback = plant.advance(&command([ratio; MOTORS]));
            let truth = plant.truth();
            for i in 0..MOTORS {
                let per_unit = if i < 4 { 10_000.0 } else { 10_000.0 * DEG_PER_RAD };
                let error = feedback.counts[i] as f64 - (truth[i] - start[i]) * per_unit;
                // Half a count for the reading, half for the line at power-up.
                assert!(error.abs() <= 1.0 + 1e-6, "motor {i}: {error}");
            }
        }
    }

    #[test]
    fn marks_latch_one_count_whatever_the_direction_and_show_the_square_offset() {
        let mut plant = MotionPlant::default();
        let start = plant.truth();
        let down = command([-0.05, -0.05, -0.05, 0.1, -0.05, 0.05, -0.05]);
        let up = command(down.dac.map(|code| -code.ratio()));
        let mut seen = [[None; MOTORS]; 2];
        for (latched, command) in seen.iter_mut().zip([&down, &up]) {
            for _ in 0..8000 {
                for (latched, mark) in latched.iter_mut().zip(plant.advance(command).mark) {
                    *latched = latched.or(mark);
                }
            }
        }
        assert_eq!(seen[0], seen[1]);
        let mark = seen[0].map(|mark| mark.expect("every mark was passed") as f64);
        let position = |i: usize| 20.0 - mark[i] / 10_000.0;
        let out_of_square = start[0] - start[1];
        assert!((position(0) - position(1) - (0.037 + out_of_square)).abs() < 2e-4);
        assert!((out_of_square - 0.06).abs() < 1e-9);
        assert!((mark[4] / 10_000.0 + 3.2).abs() < 2e-4);
    }

    #[test]
    fn limit_switches_close_at_both_ends_of_the_travel() {
        let mut plant = MotionPlant::default();
        let low = run(
            &mut plant,
            &command([-0.5, -0.5, -0.5, -0.5, -0.5, -0.5, -0.5]),
            42_000,
        );
        assert_eq!((low.limit_minus.0, low.limit_plus.0), (0b111_1111, 0));
        let high = run(&mut plant, &command([1.0; MOTORS]), 160_000);
        assert_eq!((high.limit_minus.0, high.limit_plus.0), (0, 0b111_1111));
    }

    #[test]
    fn disabling_stops_every_motor_within_a_tenth_of_a_second() {
        let mut plant = MotionPlant::default();
        run(&mut plant, &command([1.0; MOTORS]), 1600);
        run(&mut plant, &MotionCommand::SAFE, 400);
        let rest = plant.truth();
        run(&mut plant, &MotionCommand::SAFE, 400);
        assert_eq!(plant.truth(), rest);
    }

    #[test]
    fn a_beam_needs_its_gate_and_its_power() {
        let mut plant = MotionPlant::default();
        let mut command = MotionCommand::SAFE;
        command.beam_gate = [true, true];
        command.beam_power = [DacCode(1000), DacCode::ZERO];
        let feedback = plant.advance(&command);
        assert_eq!(plant.beams(), [true, false]);
        assert_eq!(feedback.beam_power, command.beam_power.map(Some));
        plant.advance(&MotionCommand::SAFE);
        assert_eq!(plant.beams(), [false, false]);
        plant.stick_beam(1, Some(DacCode(500)));
        let feedback = plant.advance(&MotionCommand::SAFE);
        assert_eq!(plant.beams(), [false, true]);
        assert_eq!(feedback.beam_power, [DacCode::ZERO, DacCode(500)].map(Some));
    }

    #[test]
    fn two_plants_with_the_same_commands_stay_equal_to_the_bit() {
        let mut one = MotionPlant::default();
        let mut two = MotionPlant::default();
        for k in 0..1000 {
            let command = command([libm::sin(f64::from(k) * 0.03); MOTORS]);
            assert_eq!(one.advance(&command), two.advance(&command));
        }
        assert_eq!(one, two);
    }

    #[test]
    fn machines_are_called_as_their_kinematics() {
        for name in KinematicsConfig::NAMES {
            assert!(MotionPlant::of(name).is_some(), "{name} has no plant");
        }
        assert_eq!(MotionPlant::of(DEFAULT_MACHINE), Some(MotionPlant::default()));
        assert_eq!(MotionPlant::of("lathe"), None);
    }

    #[test]
    fn every_machine_obeys_and_what_is_not_wired_stays() {
        for name in MotionPlant::names() {
            let mut plant = MotionPlant::of(name).expect("a name of the list");
            let start = plant.truth();
            let feedback = run(&mut plant, &command([0.01; MOTORS]), 4000);
            assert_eq!((feedback.limit_minus.0, feedback.limit_plus.0), (0, 0), "{name}");
            for (i, motor) in plant.motors.iter().enumerate() {
                let moved = plant.truth()[i] - start[i];
                assert_eq!(motor.is_some(), moved > 0.0, "{name}, motor {i}");
                assert_eq!(motor.is_some(), feedback.counts[i] > 0, "{name}, motor {i}");
            }
        }
    }
}
