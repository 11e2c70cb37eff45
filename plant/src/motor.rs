//! One motor of a machine: its drive, its grating with mark and limit switches, and where it stood when it was
//! switched on.

use crate::{Drive, DriveConfig, Grating, GratingConfig};
use shared::io::{DacCode, MOTORS};
use shared::units::DEG_PER_RAD;

/// Servo tick \[s\].
const TICK: f64 = 250e-6;
/// Steps of the drive model in a servo tick: h = 50 µs as in mathematics 0.11.
const STEPS: u32 = 5;
/// Dead time of the drives, round(0.25 ms / h) + 1 steps (mathematics 0.11).
const FIFO: usize = 6;

/// The motors of a machine, in the order of [`shared::io::MOTOR_NAMES`]; `None` where nothing is wired.
pub type Motors = [Option<Motor>; MOTORS];

/// One motor in mm or degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Speed at +10 V \[1/s\].
    velocity_at_10v: f64,
    drive: DriveConfig,
    grating: GratingConfig,
    power_up: f64,
    /// mm or rad in one mm or degree.
    unit: f64,
}

/// Drive of a linear axis.
pub const LINEAR: DriveConfig = DriveConfig {
    bandwidth_hz: 80.0,
    max_acceleration: 4000.0,
    friction: 150.0,
    damping_per_s: 1.0,
    backlash: 0.005,
    brake: 4000.0,
};

/// Drive of a rotary axis.
const ROTARY: DriveConfig = DriveConfig {
    backlash: 0.000_36,
    ..LINEAR
};

/// Counts in one mm or degree: 0.1 µm, 0.36″.
const COUNTS_PER_UNIT: f64 = 10_000.0;

impl Motor {
    /// Of an axis in mm with `travel` from its lowest to its highest position, limit switches 5 mm outside it, and
    /// the reference mark at `mark`.
    pub const fn linear(velocity_at_10v: f64, travel: [f64; 2], mark: f64, power_up: f64) -> Self {
        Self {
            velocity_at_10v,
            drive: LINEAR,
            grating: GratingConfig {
                counts_per_unit: COUNTS_PER_UNIT,
                mark,
                switch_minus: travel[0] - 5.0,
                switch_plus: travel[1] + 5.0,
            },
            power_up,
            unit: 1.0,
        }
    }

    /// Of an axis in degrees with `travel` from its lowest to its highest position, limit switches 1° outside it,
    /// and the reference mark at 0.
    pub const fn rotary(velocity_at_10v: f64, travel: [f64; 2], power_up: f64) -> Self {
        Self {
            velocity_at_10v,
            drive: ROTARY,
            grating: GratingConfig {
                counts_per_unit: COUNTS_PER_UNIT,
                mark: 0.0,
                switch_minus: travel[0] - 1.0,
                switch_plus: travel[1] + 1.0,
            },
            power_up,
            unit: 1.0 / DEG_PER_RAD,
        }
    }

    /// The same motor behind another drive.
    pub const fn with_drive(mut self, drive: DriveConfig) -> Self {
        self.drive = drive;
        self
    }

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

/// A motor that runs (mm or rad).
#[derive(Clone, Debug, PartialEq)]
pub struct RunningMotor {
    velocity_at_10v: f64,
    drive: Drive<FIFO>,
    grating: Grating,
}

impl RunningMotor {
    /// A motor that stands where it was switched off.
    pub fn new(motor: &Motor) -> Self {
        Self {
            velocity_at_10v: motor.velocity_at_10v * motor.unit,
            drive: motor.drive(),
            grating: motor.grating(),
        }
    }

    /// One servo tick with the velocity command `dac`, or with the brake closed, and what its grating and switches
    /// tell at the end.
    pub fn advance(&mut self, enable: bool, dac: DacCode) -> crate::Reading {
        if enable {
            self.drive.run(dac.ratio() * self.velocity_at_10v, STEPS);
        } else {
            self.drive.brake(STEPS);
        }
        self.grating.read(self.drive.position())
    }

    /// True position of the load.
    pub fn position(&self) -> f64 {
        self.drive.position()
    }
}
