//! One motor of a machine: its drive, its grating with mark and limit switches, and where it stood when it was
//! switched on.

use crate::config::{EnvironmentConfig, MotorConfig};
use crate::drive::Outside;
use crate::noise::Noise;
use crate::{Drive, Grating, Reading};
use shared::io::DacCode;

/// Servo tick \[s\].
pub(crate) const TICK: f64 = 250e-6;
/// Steps of the drive model in a servo tick: h = 50 µs as in mathematics 0.11.
const STEPS: u32 = 5;

/// A motor that runs (mm or rad).
#[derive(Clone, Debug, PartialEq)]
pub struct RunningMotor {
    velocity_at_10v: f64,
    /// Servo ticks from the enable until the brake opens, and those that are left.
    enable_ticks: u32,
    braked_ticks: u32,
    drive: Drive,
    grating: Grating,
    environment: EnvironmentConfig,
    mark: f64,
    time_s: f64,
}

impl RunningMotor {
    /// A motor that stands where it was switched off. One unit of its axis has `unit` mm or rad; its noise begins at `seed`,
    /// in streams of its own by its number.
    pub fn new(config: &MotorConfig, unit: f64, seed: u32, number: u32) -> Self {
        let config = config.scaled(unit);
        let noise = |of| Noise::new(seed, 2 * number + of);
        Self {
            velocity_at_10v: config.drive.velocity_at_10v,
            enable_ticks: (config.drive.enable_s / TICK + 0.5) as u32,
            braked_ticks: 0,
            drive: Drive::new(
                &config.drive,
                &config.mechanics,
                TICK / f64::from(STEPS),
                config.power_up,
                noise(0),
            ),
            grating: Grating::new(&config.grating, config.power_up, noise(1)),
            environment: config.environment,
            mark: config.grating.mark,
            time_s: 0.0,
        }
    }

    /// One servo tick with the velocity command `dac`, or with the brake closed, while what it moves is pulled so \[1/s²\]; what its
    /// grating and switches tell at the end.
    pub fn advance(&mut self, enable: bool, dac: DacCode, pull: f64) -> Reading {
        self.drive.accelerate(Outside {
            pull,
            floor: self.environment.floor.at(self.time_s),
        });
        if enable && self.braked_ticks == 0 {
            self.drive.run(dac.ratio() * self.velocity_at_10v, STEPS);
        } else {
            self.braked_ticks = match enable {
                true => self.braked_ticks - 1,
                false => self.enable_ticks,
            };
            self.drive.brake(STEPS);
        }
        self.time_s += TICK;
        let place = self.drive.at_grating();
        let grown = self.environment.grating_growth.at(self.time_s);
        // A longer scale has fewer lines on the way.
        self.grating.read(place - grown * (place - self.mark))
    }

    /// True position of the load at the tool.
    pub fn position(&self) -> f64 {
        self.drive.at_tool() + self.environment.growth.at(self.time_s)
    }

    /// Its drive and mechanics.
    pub fn drive(&self) -> &Drive {
        &self.drive
    }
}
