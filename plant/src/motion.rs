//! The seven servo axes of the dual-beam gantry.

use crate::{Drive, DriveConfig, Grating, GratingConfig};
use shared::io::{Command, DacCode, Feedback, MOTORS, MotionCommand, MotionFeedback, SIDES};
use shared::units::DEG_PER_RAD;

/// Servo tick \[s\].
const TICK: f64 = 250e-6;
/// Steps of the drive model in a servo tick: h = 50 µs as in SPEC 0.11.
const STEPS: u32 = 5;
/// Dead time of the drives, round(0.25 ms / h) + 1 steps (SPEC 0.11).
const FIFO: usize = 6;

/// One motor in mm or degrees.
struct Motor {
    velocity_at_10v: f64,
    drive: DriveConfig,
    grating: GratingConfig,
    power_up: f64,
    /// mm or rad in one mm or degree.
    unit: f64,
}

impl Motor {
    fn drive(&self) -> Drive<FIFO> {
        let config = DriveConfig {
            max_acceleration: self.drive.max_acceleration * self.unit,
            friction: self.drive.friction * self.unit,
            backlash: self.drive.backlash * self.unit,
            brake: self.drive.brake * self.unit,
            ..self.drive
        };
        Drive::new(&config, TICK / f64::from(STEPS), self.power_up * self.unit)
    }

    fn grating(&self) -> Grating {
        let config = GratingConfig {
            counts_per_unit: self.grating.counts_per_unit / self.unit,
            mark: self.grating.mark * self.unit,
            switch_minus: self.grating.switch_minus * self.unit,
            switch_plus: self.grating.switch_plus * self.unit,
        };
        Grating::new(config, self.power_up * self.unit)
    }
}

const LINEAR: DriveConfig = DriveConfig {
    bandwidth_hz: 80.0,
    max_acceleration: 4000.0,
    friction: 150.0,
    damping_per_s: 1.0,
    backlash: 0.005,
    brake: 4000.0,
};

const ROTARY: DriveConfig = DriveConfig {
    backlash: 0.000_36,
    ..LINEAR
};

/// 15 % slower than its partner and twice the friction.
const LAZY: DriveConfig = DriveConfig {
    bandwidth_hz: 68.0,
    friction: 300.0,
    ..LINEAR
};

const fn linear(
    velocity_at_10v: f64,
    drive: DriveConfig,
    mark: f64,
    travel_max: f64,
    power_up: f64,
) -> Motor {
    Motor {
        velocity_at_10v,
        drive,
        grating: GratingConfig {
            counts_per_unit: 10_000.0,
            mark,
            switch_minus: -5.0,
            switch_plus: travel_max + 5.0,
        },
        power_up,
        unit: 1.0,
    }
}

const fn rotary(travel: f64, power_up: f64) -> Motor {
    Motor {
        velocity_at_10v: 150.0,
        drive: ROTARY,
        grating: GratingConfig {
            counts_per_unit: 10_000.0,
            mark: 0.0,
            switch_minus: -travel - 1.0,
            switch_plus: travel + 1.0,
        },
        power_up,
        unit: 1.0 / DEG_PER_RAD,
    }
}

/// The marks of X1 and X2 were mounted at 20 mm, half the square offset of 0.037 mm to either side: positions
/// counted from them differ by X1 − X2 = 0.037 mm when the beam is square. At power-up it is 0.06 mm out.
const DUAL_BEAM_GANTRY: [Motor; MOTORS] = [
    linear(400.0, LINEAR, 20.0 - 0.0185, 5000.0, 35.013),
    linear(400.0, LAZY, 20.0 + 0.0185, 5000.0, 34.953),
    linear(400.0, LINEAR, 20.0, 3000.0, 41.27),
    linear(200.0, LINEAR, 980.0, 1000.0, 955.4),
    rotary(100.0, 3.2),
    rotary(30.0, -1.7),
    rotary(90.0, 2.4),
];

/// Drives, gratings and beams behind a motion board.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionPlant {
    velocity_at_10v: [f64; MOTORS],
    drives: [Drive<FIFO>; MOTORS],
    gratings: [Grating; MOTORS],
    beams: [bool; SIDES],
    power: [f64; SIDES],
}

impl MotionPlant {
    /// The dual-beam gantry, standing where it was switched off.
    pub fn dual_beam_gantry() -> Self {
        let motor = |i: usize| &DUAL_BEAM_GANTRY[i];
        Self {
            velocity_at_10v: core::array::from_fn(|i| motor(i).velocity_at_10v * motor(i).unit),
            drives: core::array::from_fn(|i| motor(i).drive()),
            gratings: core::array::from_fn(|i| motor(i).grating()),
            beams: [false; SIDES],
            power: [0.0; SIDES],
        }
    }

    /// One servo tick of 250 µs with `command`, and what the board reads at its end.
    pub fn advance(&mut self, command: &MotionCommand) -> MotionFeedback {
        let Command {
            enable,
            dac,
            beam_gate,
            beam_power,
        } = command;
        self.beams = *beam_gate;
        self.power = beam_power.map(DacCode::ratio);

        let mut feedback = Feedback::default();
        for (i, (drive, grating)) in self.drives.iter_mut().zip(&mut self.gratings).enumerate() {
            if *enable {
                drive.run(dac[i].ratio() * self.velocity_at_10v[i], STEPS);
            } else {
                drive.brake(STEPS);
            }
            let reading = grating.read(drive.position());
            feedback.counts[i] = reading.counts;
            feedback.mark[i] = reading.mark;
            feedback.limit_minus.set(i, reading.limit_minus);
            feedback.limit_plus.set(i, reading.limit_plus);
        }
        feedback
    }

    /// True positions of the loads (mm, rad), at the end of the last tick.
    pub fn truth(&self) -> [f64; MOTORS] {
        core::array::from_fn(|i| self.drives[i].position())
    }

    /// Beams that are on: gate open and power above zero.
    pub fn beams(&self) -> [bool; SIDES] {
        core::array::from_fn(|k| self.beams[k] && self.power[k] > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let mut plant = MotionPlant::dual_beam_gantry();
        let mut ignored = command([1.0; MOTORS]);
        ignored.enable = false;
        let before = plant.truth();
        let feedback = run(&mut plant, &ignored, 400);
        assert_eq!(feedback, MotionFeedback::default());
        assert_eq!(plant.truth(), before);
        assert_eq!(before[0], 35.013);
        assert!((before[4] - 3.2_f64.to_radians()).abs() < 1e-12);
    }

    #[test]
    fn ten_volts_drive_every_motor_at_its_speed() {
        let mut plant = MotionPlant::dual_beam_gantry();
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
        let mut plant = MotionPlant::dual_beam_gantry();
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
        let mut plant = MotionPlant::dual_beam_gantry();
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
        let mut plant = MotionPlant::dual_beam_gantry();
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
        let mut plant = MotionPlant::dual_beam_gantry();
        run(&mut plant, &command([1.0; MOTORS]), 1600);
        run(&mut plant, &MotionCommand::SAFE, 400);
        let rest = plant.truth();
        run(&mut plant, &MotionCommand::SAFE, 400);
        assert_eq!(plant.truth(), rest);
    }

    #[test]
    fn a_beam_needs_its_gate_and_its_power() {
        let mut plant = MotionPlant::dual_beam_gantry();
        let mut command = MotionCommand::SAFE;
        command.beam_gate = [true, true];
        command.beam_power = [DacCode(1000), DacCode::ZERO];
        plant.advance(&command);
        assert_eq!(plant.beams(), [true, false]);
        plant.advance(&MotionCommand::SAFE);
        assert_eq!(plant.beams(), [false, false]);
    }

    #[test]
    fn two_plants_with_the_same_commands_stay_equal_to_the_bit() {
        let mut one = MotionPlant::dual_beam_gantry();
        let mut two = MotionPlant::dual_beam_gantry();
        for k in 0..1000 {
            let command = command([libm::sin(f64::from(k) * 0.03); MOTORS]);
            assert_eq!(one.advance(&command), two.advance(&command));
        }
        assert_eq!(one, two);
    }
}
