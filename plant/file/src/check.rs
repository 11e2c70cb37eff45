//! Values that make no sense.

use crate::PlantFile;
use crate::read::{ABOUT, Mistake};
use plant::{
    DriveConfig, EnvironmentConfig, GratingConfig, Growth, MechanicsConfig, ModeConfig, SlideConfig,
    TouchConfig, Wave,
};
use shared::io::{AXIS_NAMES, MOTOR_NAMES, PROCESS_INPUTS, SLIDE_NAMES};

/// Longest dead times of the models \[s\].
const DRIVE_DEAD_TIME: f64 = 2e-3;
const SLIDE_DEAD_TIME: f64 = 4e-3;
/// Highest frequency of a resonance \[Hz\]: its model is stable up to 6.4 kHz, and right to 1 % of its frequency up to this.
const HIGHEST_MODE: f64 = 1500.0;
/// Highest frequency at which a gantry yaws \[Hz\]: its model, by ticks of 250 µs, is right to some percent of the damping up to this.
const HIGHEST_YAW: f64 = 100.0;
/// Largest inertial share of a beam: the model is stable up to a third.
const MOST_SHARE: f64 = 0.3;
/// Longest time until a brake opens \[s\].
const MOST_ENABLE: f64 = 2.0;
/// Bandwidths that the model of a drive resolves \[Hz\].
const BANDWIDTH: [f64; 2] = [1.0, 1000.0];
/// How far a camera may be from its lead \[mm\]: half of the usual lead.
const LEAD_ERROR: [f64; 2] = [-5.0, 5.0];
/// Longest delay of a camera's exposure \[s\]: some frames.
const CAMERA_DELAY: f64 = 0.02;

/// Angles of joints and cameras that are not as they should be \[deg\].
const ANGLE_DEG: [f64; 2] = [-2.0, 2.0];

/// What a value must be.
enum Must {
    BeFinite,
    BePositive,
    NotBeNegative,
    BeWithin(f64, f64),
}

impl Must {
    fn fails(&self, value: f64) -> Option<String> {
        let (good, what) = match self {
            Self::BeFinite => (true, "must be a number".to_owned()),
            Self::BePositive => (value > 0.0, "must be greater than 0".to_owned()),
            Self::NotBeNegative => (value >= 0.0, "must not be negative".to_owned()),
            Self::BeWithin(low, high) => (
                (*low..=*high).contains(&value),
                format!("must be from {low} to {high}"),
            ),
        };
        (!good || !value.is_finite()).then(|| format!("= {value} {what}"))
    }
}

use Must::{BeFinite, BePositive, BeWithin, NotBeNegative};

/// Checks all values.
pub fn plant(file: &PlantFile) -> Result<(), Mistake> {
    for (name, motor) in MOTOR_NAMES.iter().zip(&file.plant.motors) {
        let Some(motor) = motor else { continue };
        let key = format!("motors.{name}");
        all(&key, &[("power_up", motor.power_up, BeFinite)])?;
        drive(&format!("{key}.drive"), &motor.drive)?;
        mechanics(&format!("{key}.mechanics"), &motor.mechanics)?;
        grating(&format!("{key}.grating"), &motor.grating)?;
        environment(&format!("{key}.environment"), &motor.environment)?;
    }
    for (name, config) in SLIDE_NAMES.iter().zip(&file.plant.slides) {
        if let Some(config) = config {
            slide(&format!("slides.{name}"), config)?;
        }
    }
    for error in &file.plant.geometry {
        let motor = MOTOR_NAMES[usize::from(error.motor)];
        let key = format!("geometry.{motor}.{}", AXIS_NAMES[usize::from(error.axis)]);
        all(&key, &[("slope", error.slope, BeWithin(-0.01, 0.01))])?;
        wave(&format!("{key}.wave"), &error.wave)?;
    }
    for (along, errors) in AXIS_NAMES.iter().zip(&file.angular) {
        for (about, error) in ABOUT.iter().zip(errors) {
            let key = format!("angular.{about}.{along}");
            let [least, most] = ANGLE_DEG;
            all(
                &key,
                &[
                    ("constant", error.constant, BeWithin(least, most)),
                    ("slope", error.slope, BeWithin(-0.01, 0.01)),
                ],
            )?;
            wave(&format!("{key}.wave"), &error.wave)?;
        }
    }
    if let Some(beam) = &file.plant.beam {
        let values = [
            ("yaw_hz", beam.yaw_hz, BeWithin(0.1, HIGHEST_YAW)),
            ("damping", beam.damping, BeWithin(0.0, 1.0)),
            ("share", beam.share, BeWithin(0.0, MOST_SHARE)),
        ];
        all("beam", &values)?;
        if file.plant.motors[..2].contains(&None) {
            let what = "is between X1 and X2: this machine has not both of them".to_owned();
            return Err(("beam".to_owned(), what));
        }
    }
    if let Some(config) = &file.plant.touch {
        touch(config)?;
    }
    for (number, mount) in file.cameras.iter().enumerate() {
        let [u, v] = mount.beside_spot_mm;
        let key = format!("cameras.{}", number + 1);
        let [least, most] = LEAD_ERROR;
        let [least_deg, most_deg] = ANGLE_DEG;
        if let Some(lead) = mount.lead_mm {
            all(&key, &[("lead_mm", lead, BePositive)])?;
        }
        all(
            &key,
            &[
                ("beside_spot_mm", u, BeFinite),
                ("beside_spot_mm", v, BeFinite),
                ("lead_error_mm", mount.lead_error_mm, BeWithin(least, most)),
                ("delay_s", mount.delay_s, BeWithin(0.0, CAMERA_DELAY)),
                ("jitter_s", mount.jitter_s, BeWithin(0.0, CAMERA_DELAY)),
                ("turned_deg", mount.turned_deg, BeWithin(least_deg, most_deg)),
            ],
        )?;
        for drift in &mount.drift_mm {
            growth(&format!("{key}.drift_mm"), drift, BeFinite)?;
        }
    }
    Ok(())
}

fn touch(config: &TouchConfig) -> Result<(), Mistake> {
    let inputs = (1.0, PROCESS_INPUTS as f64);
    all(
        "touch",
        &[("input", config.input.into(), BeWithin(inputs.0, inputs.1))],
    )?;
    for body in &config.bodies {
        for (from, to) in body.from.into_iter().zip(body.to) {
            if from >= to || from.is_nan() || to.is_nan() {
                return Err((
                    "touch.bodies".to_owned(),
                    format!("has a body from {from} to {to}: the first must be the lower one"),
                ));
            }
        }
    }
    Ok(())
}

fn all(table: &str, values: &[(&str, f64, Must)]) -> Result<(), Mistake> {
    for (name, value, must) in values {
        if let Some(what) = must.fails(*value) {
            return Err((format!("{table}.{name}"), what));
        }
    }
    Ok(())
}

fn drive(key: &str, drive: &DriveConfig) -> Result<(), Mistake> {
    let [lowest, highest] = BANDWIDTH;
    all(
        key,
        &[
            ("velocity_at_10v", drive.velocity_at_10v, BePositive),
            ("bandwidth_hz", drive.bandwidth_hz, BeWithin(lowest, highest)),
            ("dead_time_s", drive.dead_time_s, BeWithin(0.0, DRIVE_DEAD_TIME)),
            ("max_acceleration", drive.max_acceleration, BePositive),
            ("brake", drive.brake, BePositive),
            ("enable_s", drive.enable_s, BeWithin(0.0, MOST_ENABLE)),
            ("gain_error", drive.gain_error, BeWithin(-0.5, 0.5)),
            ("offset", drive.offset, BeFinite),
            ("noise", drive.noise, NotBeNegative),
        ],
    )
}

fn mechanics(key: &str, mechanics: &MechanicsConfig) -> Result<(), Mistake> {
    all(
        key,
        &[
            ("friction", mechanics.friction, NotBeNegative),
            ("damping_per_s", mechanics.damping_per_s, NotBeNegative),
            ("backlash", mechanics.backlash, NotBeNegative),
            ("stiction", mechanics.stiction, NotBeNegative),
            ("stribeck_speed", mechanics.stribeck_speed, NotBeNegative),
            ("presliding", mechanics.presliding, NotBeNegative),
            ("gravity", mechanics.gravity, BeFinite),
        ],
    )?;
    if mechanics.presliding > 0.0 && mechanics.friction == 0.0 {
        return Err((format!("{key}.presliding"), "needs friction".to_owned()));
    }
    if mechanics.stiction > 0.0 && mechanics.stribeck_speed == 0.0 {
        return Err((
            format!("{key}.stiction"),
            "needs a stribeck_speed, at which half of it is left".to_owned(),
        ));
    }
    wave(&format!("{key}.cogging"), &mechanics.cogging)?;
    for ModeConfig {
        frequency_hz,
        damping,
        motor,
        grating,
        tool,
    } in &mechanics.modes
    {
        all(
            &format!("{key}.modes"),
            &[
                ("frequency_hz", *frequency_hz, BeWithin(0.1, HIGHEST_MODE)),
                ("damping", *damping, BeWithin(0.0, 1.0)),
                ("motor", *motor, BeFinite),
                ("grating", *grating, BeFinite),
                ("tool", *tool, BeFinite),
            ],
        )?;
    }
    Ok(())
}

fn environment(key: &str, environment: &EnvironmentConfig) -> Result<(), Mistake> {
    growth(&format!("{key}.growth"), &environment.growth, BeFinite)?;
    let part = BeWithin(-0.01, 0.01);
    growth(
        &format!("{key}.grating_growth"),
        &environment.grating_growth,
        part,
    )?;
    wave(&format!("{key}.floor"), &environment.floor)
}

fn growth(key: &str, growth: &Growth, amount: Must) -> Result<(), Mistake> {
    all(
        key,
        &[
            ("amount", growth.amount, amount),
            ("time_constant_s", growth.time_constant_s, BePositive),
        ],
    )
}

fn wave(key: &str, wave: &Wave) -> Result<(), Mistake> {
    all(
        key,
        &[
            ("amplitude", wave.amplitude, BeFinite),
            ("period", wave.period, NotBeNegative),
        ],
    )
}

fn grating(key: &str, grating: &GratingConfig) -> Result<(), Mistake> {
    all(
        key,
        &[
            ("counts_per_unit", grating.counts_per_unit, BePositive),
            ("mark", grating.mark, BeFinite),
            ("switch_minus", grating.switch_minus, BeFinite),
            ("switch_plus", grating.switch_plus, BeFinite),
            ("pitch_error", grating.pitch_error, BeWithin(-0.01, 0.01)),
            ("noise", grating.noise, NotBeNegative),
            ("mark_scatter", grating.mark_scatter, NotBeNegative),
        ],
    )?;
    if grating.switch_minus >= grating.switch_plus {
        return Err((
            format!("{key}.switch_minus"),
            "must be below switch_plus".to_owned(),
        ));
    }
    wave(&format!("{key}.long_error"), &grating.long_error)?;
    wave(&format!("{key}.subdivision"), &grating.subdivision)
}

fn slide(key: &str, slide: &SlideConfig) -> Result<(), Mistake> {
    all(
        key,
        &[
            ("power_up", slide.power_up, BeFinite),
            ("velocity_at_10v", slide.velocity_at_10v, BePositive),
            ("dead_time_s", slide.dead_time_s, BeWithin(0.0, SLIDE_DEAD_TIME)),
            ("lag_s", slide.lag_s, BePositive),
            ("brake_s", slide.brake_s, BePositive),
            ("enable_s", slide.enable_s, BeWithin(0.0, MOST_ENABLE)),
            ("gain_error", slide.gain_error, BeWithin(-0.5, 0.5)),
            ("offset", slide.offset, BeFinite),
            ("backlash", slide.backlash, NotBeNegative),
        ],
    )?;
    grating(&format!("{key}.encoder"), &slide.encoder)
}
