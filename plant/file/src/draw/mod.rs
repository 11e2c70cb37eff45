//! Machines drawn at random around a shipped one: what data sheets and textbooks let one expect of a machine that was set up
//! with care (`usual`) or without (`poor`), and machines with a defect (`bad`). docs/plant.md has the tables with their sources.

mod defect;

pub use defect::Defect;

use crate::PlantFile;
use plant::{ModeConfig, MotorConfig, Noise, SlideConfig, Wave};
use shared::io::{MOTOR_NAMES, MOTORS};
use std::fmt;
use std::str::FromStr;

/// How good a machine is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Set up with care.
    Usual,
    /// Worn, or set up without care: twice the errors.
    Poor,
    /// A usual one of which one motor has a [`Defect`].
    Bad,
}

impl FromStr for Quality {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "usual" => Ok(Self::Usual),
            "poor" => Ok(Self::Poor),
            "bad" => Ok(Self::Bad),
            _ => Err(format!(
                "{text} is no kind of machine: there are usual, poor and bad"
            )),
        }
    }
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Usual => "usual",
            Self::Poor => "poor",
            Self::Bad => "bad",
        })
    }
}

/// Draws of one machine.
struct Draw {
    noise: Noise,
    /// Errors are so many times those of a usual machine.
    errors: f64,
}

/// One unit of a rotary axis moves the tool, at an arm of 0.5 m, by about 9 mm: errors in degrees are so many times those in mm.
const DEGREES: f64 = 1.0 / 9.0;

/// A machine around `shipped`; the same one for the same `seed`.
pub fn around(mut shipped: PlantFile, quality: Quality, seed: u32) -> PlantFile {
    let mut draw = Draw {
        noise: Noise::new(seed, u32::MAX),
        errors: match quality {
            Quality::Usual | Quality::Bad => 1.0,
            Quality::Poor => 2.0,
        },
    };
    shipped.plant.seed = seed;
    for (i, motor) in shipped.plant.motors.iter_mut().enumerate() {
        if let Some(motor) = motor {
            draw.motor(motor, i);
        }
    }
    for slide in shipped.plant.slides.iter_mut().flatten() {
        draw.slide(slide);
    }
    if shipped.plant.slides.iter().any(Option::is_some) {
        for camera in &mut shipped.cameras {
            camera.beside_spot_mm = [draw.error(0.015), draw.error(0.015)];
        }
        // After all else: a seed keeps the machine that it had before cameras had these.
        for camera in &mut shipped.cameras {
            camera.lead_error_mm = draw.error(0.1);
            camera.delay_s = draw.amount(0.02e-3, 0.2e-3);
        }
    }
    for motor in shipped.plant.motors.iter_mut().flatten() {
        motor.drive.enable_s = draw.between(0.02, 0.15);
    }
    for slide in shipped.plant.slides.iter_mut().flatten() {
        slide.enable_s = draw.between(0.02, 0.15);
    }
    if let (Quality::Bad, Some((number, defect))) = (quality, defect(&shipped, seed))
        && let Some(motor) = &mut shipped.plant.motors[number]
    {
        draw.spoil(motor, number, defect);
    }
    shipped
}

/// Which motor of the bad machine around `shipped` has what defect; none if it has no motors.
pub fn defect(shipped: &PlantFile, seed: u32) -> Option<(usize, Defect)> {
    let motors = shipped.plant.motors.iter().enumerate();
    let fitted: Vec<_> = motors
        .filter_map(|(i, motor)| motor.as_ref().map(|_| i))
        .collect();
    // Of its own, so that it is the same whatever else is drawn.
    let mut draw = Draw {
        noise: Noise::new(seed, u32::MAX - 1),
        errors: 1.0,
    };
    let defect = draw.defect();
    (!fitted.is_empty()).then(|| (fitted[draw.one_of(fitted.len())], defect))
}

impl Draw {
    /// Evenly from `low` to `high`.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.noise.draw() / 3_f64.sqrt() + 1.0) / 2.0;
        low + (high - low) * unit
    }

    /// An error of either sign with this rms on a usual machine.
    fn error(&mut self, rms: f64) -> f64 {
        self.errors * rms * self.noise.draw()
    }

    /// An error between two amounts on a usual machine.
    fn amount(&mut self, low: f64, high: f64) -> f64 {
        self.errors * self.between(low, high)
    }

    fn motor(&mut self, motor: &mut MotorConfig, number: usize) {
        let linear = number < ROTARY;
        let unit = if linear { 1.0 } else { DEGREES };
        let full = motor.drive.velocity_at_10v;

        motor.drive.bandwidth_hz *= 1.0 + self.error(0.08);
        motor.drive.dead_time_s = self.between(0.25e-3, 0.6e-3);
        motor.drive.gain_error = self.error(0.005);
        motor.drive.offset = self.error(0.5e-3) * full;
        motor.drive.noise = self.amount(0.05e-3, 0.2e-3) * full;

        let friction = motor.mechanics.friction * self.between(0.7, 1.5);
        motor.mechanics.friction = friction;
        motor.mechanics.stiction = friction * self.amount(0.1, 0.4);
        motor.mechanics.stribeck_speed = self.between(1.0, 5.0) * unit;
        motor.mechanics.presliding = self.between(0.002, 0.01) * unit;
        motor.mechanics.backlash = self.amount(0.001, 0.006) * unit;
        motor.mechanics.cogging = Wave {
            amplitude: self.amount(2.0, 10.0) * unit,
            period: self.between(5.0, 30.0) * unit,
        };
        if number == Z {
            motor.mechanics.gravity = self.error(250.0);
        }
        let share = self.between(0.05, 0.25);
        let mode = ModeConfig {
            frequency_hz: self.between(60.0, 160.0) / self.errors.sqrt(),
            damping: self.between(0.03, 0.08),
            motor: share / (1.0 - share),
            // The scale is beside the guideway, closer to the load than the motor is.
            grating: -self.between(0.3, 0.8),
            tool: -1.0,
        };
        motor.mechanics.modes = [mode].into_iter().collect();

        let grating = &mut motor.grating;
        if linear {
            grating.pitch_error = self.error(5e-6);
        }
        grating.long_error = Wave {
            amplitude: self.amount(0.0005, 0.0015) * unit,
            period: self.between(200.0, 1500.0) * unit,
        };
        grating.subdivision = Wave {
            amplitude: self.amount(0.05e-3, 0.2e-3) * unit,
            period: 0.02 * unit,
        };
        grating.noise = self.amount(0.01e-3, 0.05e-3) * unit;
        grating.mark_scatter = self.amount(0.05e-3, 0.2e-3) * unit;
    }

    fn slide(&mut self, slide: &mut SlideConfig) {
        slide.dead_time_s *= 1.0 + self.error(0.1);
        slide.lag_s *= 1.0 + self.error(0.08);
        slide.gain_error = self.error(0.01);
        slide.offset = self.error(0.5e-3) * slide.velocity_at_10v;
        slide.backlash = self.amount(0.0005, 0.002);
        slide.encoder.noise = self.amount(0.02e-3, 0.1e-3);
        slide.encoder.mark_scatter = self.amount(0.1e-3, 0.5e-3);
        slide.encoder.pitch_error = self.error(20e-6);
    }
}

/// The first motor of a rotary axis, and the upright one.
const ROTARY: usize = 4;
const Z: usize = 3;
const _: () =
    assert!(matches!(MOTOR_NAMES[ROTARY].as_bytes(), b"A") && matches!(MOTOR_NAMES[Z].as_bytes(), b"Z"));
const _: () = assert!(ROTARY < MOTORS);
