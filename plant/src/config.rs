//! What a machine is, in numbers: one plant file a machine. Units are those of the axis, mm or degrees, and seconds.
//!
//! Nothing here is known to a controller: what it believes is in the machine file, and the two may differ. Fields that
//! can be left out of a file are 0: without that error.

use heapless::Vec;
use serde::{Deserialize, Serialize};
use shared::io::{MOTORS, SLIDES};

/// Most resonances of a motor's mechanics.
pub const MODES: usize = 3;

/// Most bodies that the axes touch.
pub const BODIES: usize = 8;

/// Most errors of geometry.
pub const ERRORS: usize = 24;

/// Most bytes of a [`PlantConfig`] in postcard, as an emulated board reads it.
pub const LONGEST: usize = 6144;

/// What both boards are wired to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlantConfig {
    /// In the order of [`shared::io::MOTOR_NAMES`]; `None` where nothing is wired.
    pub motors: [Option<MotorConfig>; MOTORS],
    /// In the order of [`shared::io::SLIDE_NAMES`].
    pub slides: [Option<SlideConfig>; SLIDES],
    /// Errors of its geometry.
    pub geometry: Vec<GeometryConfig, ERRORS>,
    /// The beam between the two motors of X; without one each moves on its own.
    pub beam: Option<BeamConfig>,
    /// What the axes touch; without it every input of the process is on, as if the process always answered.
    pub touch: Option<TouchConfig>,
    /// Start of all noise.
    pub seed: u32,
}

/// The beam of a gantry on its two motors, which it keeps square as a spring does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BeamConfig {
    /// At which it yaws with both drives free \[Hz\].
    pub yaw_hz: f64,
    /// Damping ζ of that.
    pub damping: f64,
    /// By which part of the acceleration of the other end each end is pushed back, since the beam is one body. Masses m at the ends
    /// and a beam of mass M and inertia J over the length L give (M/4 − J/L²)/(m + M/4 + J/L²).
    #[serde(default)]
    pub share: f64,
}

/// What the axes touch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TouchConfig {
    /// Input of the process that is on while something is touched, 1 to 4.
    pub input: u8,
    /// What can be touched.
    pub bodies: Vec<BodyConfig, BODIES>,
}

/// A box between two corners, in true positions of X, Y and Z \[mm\].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyConfig {
    /// Its lower corner.
    pub from: [f64; 3],
    /// Its upper one.
    pub to: [f64; 3],
}

/// By how much what a motor moves is beside its place, as another axis or its own moves; its grating does not see it. Of another axis
/// the slope is squareness, and the wave straightness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GeometryConfig {
    /// As in [`shared::io::MOTOR_NAMES`].
    pub motor: u8,
    /// As in [`shared::io::AXIS_NAMES`].
    pub axis: u8,
    /// Error for each unit of the axis, from its zero.
    pub slope: f64,
    /// Error over the axis.
    pub wave: Wave,
}

/// An angle by which a joint turns what it carries, over the way of its axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AngularError {
    /// At the zero of the axis: what the joint carries is not square to it \[deg\].
    #[serde(default)]
    pub constant: f64,
    /// For each unit of the axis \[deg\].
    #[serde(default)]
    pub slope: f64,
    /// Over the axis \[deg\].
    #[serde(default)]
    pub wave: Wave,
}

/// About x, y and z of the work's frame, as it stands with all axes at 0: roll, pitch and yaw of X.
pub type AngularErrors = [AngularError; 3];

impl AngularError {
    /// Its angle with the axis at `along` (mm, deg) \[rad\].
    pub fn at(&self, along: f64) -> f64 {
        (self.constant + self.slope * along + self.wave.at(along)).to_radians()
    }
}

/// One motor: its drive, what it moves, its grating.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorConfig {
    /// Where it stood when it was switched on.
    pub power_up: f64,
    /// The drive.
    pub drive: DriveConfig,
    /// What the drive moves.
    pub mechanics: MechanicsConfig,
    /// The grating and its switches.
    pub grating: GratingConfig,
    /// Where it stands.
    #[serde(default)]
    pub environment: EnvironmentConfig,
}

/// Warmth and the floor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentConfig {
    /// What it moves grows away from the grating by so much.
    #[serde(default)]
    pub growth: Growth,
    /// Its grating grows away from the mark by this part of its length.
    #[serde(default)]
    pub grating_growth: Growth,
    /// The floor is accelerated along the axis, over time: the amplitude is in 1/s², the period in s.
    #[serde(default)]
    pub floor: Wave,
}

/// Growth from power-up on, towards an end: amount · (1 − exp(−t/τ)).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Growth {
    /// In the end.
    pub amount: f64,
    /// Time constant τ \[s\].
    pub time_constant_s: f64,
}

/// A velocity-mode drive: a PI loop on the speed of its motor with the double pole −ωv/2, behind a dead time
/// (mathematics 0.11).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveConfig {
    /// Speed at +10 V \[1/s\].
    pub velocity_at_10v: f64,
    /// Bandwidth fv = ωv/2π of the velocity loop \[Hz\].
    pub bandwidth_hz: f64,
    /// Time from a command to its effect, at most 2 ms \[s\].
    pub dead_time_s: f64,
    /// Acceleration at the current limit \[1/s²\].
    pub max_acceleration: f64,
    /// Deceleration of the brake that closes when the drive is disabled \[1/s²\].
    pub brake: f64,
    /// From the enable on the brake stays closed for so long \[s\].
    #[serde(default)]
    pub enable_s: f64,
    /// Error of the gain, as part of it: speed is (1 + this) times what the voltage says.
    #[serde(default)]
    pub gain_error: f64,
    /// Offset of converter and drive: speed at 0 V \[1/s\].
    #[serde(default)]
    pub offset: f64,
    /// Noise of converter and drive, rms \[1/s\].
    #[serde(default)]
    pub noise: f64,
}

/// What a drive moves. Forces are told as the acceleration that they take \[1/s²\].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MechanicsConfig {
    /// Coulomb friction.
    pub friction: f64,
    /// Friction for each unit of speed \[1/s\].
    pub damping_per_s: f64,
    /// Backlash between motor and load.
    #[serde(default)]
    pub backlash: f64,
    /// Friction at rest above Coulomb friction.
    #[serde(default)]
    pub stiction: f64,
    /// Speed at which half of that is left (Lorentz form of the Stribeck curve) \[1/s\].
    #[serde(default)]
    pub stribeck_speed: f64,
    /// Way over which friction builds up after a reversal (Dahl's presliding, with the level of the LuGre model).
    #[serde(default)]
    pub presliding: f64,
    /// Weight that no counterweight carries; it pulls towards the negative end.
    #[serde(default)]
    pub gravity: f64,
    /// Cogging.
    #[serde(default)]
    pub cogging: Wave,
    /// Resonances.
    #[serde(default)]
    pub modes: Vec<ModeConfig, MODES>,
}

/// A sine over the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wave {
    /// Amplitude.
    pub amplitude: f64,
    /// Period; 0 is no wave.
    pub period: f64,
}

/// A resonance, in modal coordinates: q″ + 2ζω q′ + ω² q = a for the acceleration a of the rigid body, which moves each
/// place by its gain times q. Two masses with the share μ of the load have gains μ/(1 − μ) at the motor and −1 at the
/// load, at the frequency of both swinging freely.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModeConfig {
    /// Frequency ω/2π \[Hz\].
    pub frequency_hz: f64,
    /// Damping ζ.
    pub damping: f64,
    /// Gain at the motor, whose speed the drive controls.
    #[serde(default)]
    pub motor: f64,
    /// Gain at the grating.
    #[serde(default)]
    pub grating: f64,
    /// Gain at the tool.
    pub tool: f64,
}

/// One grating with its mark, and the limit switches beside it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GratingConfig {
    /// Counts in one unit. Counts stay within 32 bits, 214 m at 10 000 counts/mm.
    pub counts_per_unit: f64,
    /// True position of the reference mark.
    pub mark: f64,
    /// The negative limit switch is pressed below this position.
    pub switch_minus: f64,
    /// The positive limit switch is pressed above this position.
    pub switch_plus: f64,
    /// Error of the pitch, as part of it, by mounting or warmth: it counts so much more, from the mark on.
    #[serde(default)]
    pub pitch_error: f64,
    /// Error over the length.
    #[serde(default)]
    pub long_error: Wave,
    /// Error within a signal period (sub-divisional error).
    #[serde(default)]
    pub subdivision: Wave,
    /// Noise of a position, rms.
    #[serde(default)]
    pub noise: f64,
    /// Scatter of the mark, rms.
    #[serde(default)]
    pub mark_scatter: f64,
}

/// One slide of the tracker \[mm\]: a first-order lag behind a dead time (mathematics 0.9).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SlideConfig {
    /// Where it stood when it was switched on.
    pub power_up: f64,
    /// Speed at +10 V \[mm/s\].
    pub velocity_at_10v: f64,
    /// Time from a command to its effect, at most 4 ms \[s\].
    pub dead_time_s: f64,
    /// Time constant of the velocity loop \[s\].
    pub lag_s: f64,
    /// Time constant of the brake that closes when the drives are disabled \[s\].
    pub brake_s: f64,
    /// From the enable on the brake stays closed for so long \[s\].
    #[serde(default)]
    pub enable_s: f64,
    /// Error of the gain, as part of it.
    #[serde(default)]
    pub gain_error: f64,
    /// Speed at 0 V \[mm/s\].
    #[serde(default)]
    pub offset: f64,
    /// Backlash between motor and slide; the encoder is at the motor.
    #[serde(default)]
    pub backlash: f64,
    /// The encoder and its switches.
    pub encoder: GratingConfig,
}

impl Wave {
    /// Its value at `x`.
    pub fn at(&self, x: f64) -> f64 {
        if self.period == 0.0 {
            return 0.0;
        }
        self.amplitude * libm::sin(2.0 * core::f64::consts::PI / self.period * x)
    }

    fn scaled(&self, unit: f64) -> Self {
        Self {
            amplitude: self.amplitude * unit,
            period: self.period * unit,
        }
    }
}

impl Default for Growth {
    /// None.
    fn default() -> Self {
        Self {
            amount: 0.0,
            time_constant_s: 1.0,
        }
    }
}

impl Growth {
    /// Its value `time_s` after power-up.
    pub fn at(&self, time_s: f64) -> f64 {
        if self.amount == 0.0 {
            return 0.0;
        }
        self.amount * -libm::expm1(-time_s / self.time_constant_s)
    }
}

impl EnvironmentConfig {
    fn scaled(&self, unit: f64) -> Self {
        Self {
            growth: Growth {
                amount: self.growth.amount * unit,
                ..self.growth
            },
            floor: Wave {
                amplitude: self.floor.amplitude * unit,
                ..self.floor
            },
            ..self.clone()
        }
    }
}

impl MotorConfig {
    /// The same in another unit, of which one of the axis has `unit`.
    pub(crate) fn scaled(&self, unit: f64) -> Self {
        Self {
            power_up: self.power_up * unit,
            drive: DriveConfig {
                velocity_at_10v: self.drive.velocity_at_10v * unit,
                max_acceleration: self.drive.max_acceleration * unit,
                brake: self.drive.brake * unit,
                offset: self.drive.offset * unit,
                noise: self.drive.noise * unit,
                ..self.drive.clone()
            },
            mechanics: self.mechanics.scaled(unit),
            grating: self.grating.scaled(unit),
            environment: self.environment.scaled(unit),
        }
    }
}

impl MechanicsConfig {
    fn scaled(&self, unit: f64) -> Self {
        Self {
            friction: self.friction * unit,
            backlash: self.backlash * unit,
            stiction: self.stiction * unit,
            stribeck_speed: self.stribeck_speed * unit,
            presliding: self.presliding * unit,
            gravity: self.gravity * unit,
            cogging: self.cogging.scaled(unit),
            ..self.clone()
        }
    }
}

impl GratingConfig {
    fn scaled(&self, unit: f64) -> Self {
        Self {
            counts_per_unit: self.counts_per_unit / unit,
            mark: self.mark * unit,
            switch_minus: self.switch_minus * unit,
            switch_plus: self.switch_plus * unit,
            long_error: self.long_error.scaled(unit),
            subdivision: self.subdivision.scaled(unit),
            noise: self.noise * unit,
            mark_scatter: self.mark_scatter * unit,
            ..self.clone()
        }
    }
}
