//! Loops, deviations and arms in a machine file: values are replaced, everything else stays as it was written, and what was there before is told
//! beside them.

use crate::arms::Arm;
use crate::design::Loop;
use crate::excitations::least_kp;
use crate::four_digits;
use shared::config::{DeviationConfig, MotionConfig};
use shared::control::{FrictionConfig, NotchConfig};
use shared::io::MOTOR_NAMES;
use shared::motion::vibration_limit;
use thiserror::Error;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value};

/// Why a machine file is not written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// It is no TOML.
    #[error(transparent)]
    Toml(#[from] toml_edit::TomlError),
    /// The motor is not in it.
    #[error("it has no table [motors.{0}]")]
    NoMotor(String),
    /// Something else is called so.
    #[error("its {0} is no table")]
    NoTable(String),
    /// Lengths of joints.
    #[error("its joints are a list: write what was found into it by hand")]
    Joints,
    /// There is no gantry in it.
    #[error("it has no table [gantry]")]
    NoGantry,
}

/// The machine file `text` with the loop of motor `name`.
///
/// # Errors
/// It is no machine file with that motor.
pub fn rewrite(text: &str, name: &str, found: &Loop) -> Result<String, WriteError> {
    let mut document: DocumentMut = text.parse()?;
    let motor = table_of(&mut document, name)?;
    let values = [
        ("velocity_at_10v", found.motor.velocity_at_10v),
        ("kp", found.motor.kp),
        ("ki", found.motor.ki),
        ("kd", found.motor.kd),
        ("velocity_feed_forward", found.motor.velocity_feed_forward),
        (
            "acceleration_feed_forward_s",
            found.motor.acceleration_feed_forward_s,
        ),
        ("max_command", found.motor.max_command),
    ];
    for (key, value) in values {
        let digits = four_digits(value);
        replace(motor, key, digits.into());
    }
    let notches: Array = found.motor.notches.iter().map(of_notch).collect();
    if !notches.is_empty() || motor.contains_key("notches") {
        replace(motor, "notches", notches.into());
    }
    if let Some(friction) = &found.motor.friction {
        replace(motor, "friction", of_friction(friction).into());
    }
    Ok(document.to_string())
}

/// The machine file `text` of `machine` with these loops of motors, by their indices, and vibration limits of all `motors` that have none:
/// one whose loop was left as it is may swing. The cross-coupling of a gantry goes with the lesser proportional gain of its motors.
///
/// # Errors
/// It is no machine file with these motors.
pub fn rewrite_all(
    text: &str,
    machine: &MotionConfig,
    motors: &[usize],
    found: &[(usize, &Loop)],
) -> Result<String, WriteError> {
    let mut text = text.to_owned();
    for (index, found) in found {
        text = rewrite(&text, MOTOR_NAMES[*index], found)?;
    }
    for index in motors {
        text = rewrite_vibration_limit(&text, machine, *index)?;
    }
    if machine.gantry.is_none() {
        return Ok(text);
    }
    let now = |index: usize| {
        let of_motor = found.iter().find(|(motor, _)| *motor == index);
        of_motor.map(|(_, found)| found.motor.kp)
    };
    let factor = least_kp(machine, now) / least_kp(machine, |_| None);
    if factor == 1.0 {
        return Ok(text);
    }
    rewrite_coupling(&text, factor)
}

/// The machine file `text` of `machine` with the usual vibration limit of the motor with this `index`, if it has none.
fn rewrite_vibration_limit(text: &str, machine: &MotionConfig, index: usize) -> Result<String, WriteError> {
    let mut document: DocumentMut = text.parse()?;
    let table = table_of(&mut document, MOTOR_NAMES[index])?;
    let motor = machine.motors[index].as_ref();
    if let Some(motor) = motor.filter(|motor| motor.vibration_limit == 0.0) {
        let limit = four_digits(vibration_limit(index, motor));
        replace(table, "vibration_limit", limit.into());
    }
    Ok(document.to_string())
}

/// The table of motor `name`.
fn table_of<'a>(document: &'a mut DocumentMut, name: &str) -> Result<&'a mut Table, WriteError> {
    let motor = document.get_mut("motors").and_then(|motors| motors.get_mut(name));
    let table = motor.and_then(Item::as_table_mut);
    table.ok_or_else(|| WriteError::NoMotor(name.to_owned()))
}

/// The machine file `text` with the cross-coupling of its gantry so many times as strong.
fn rewrite_coupling(text: &str, factor: f64) -> Result<String, WriteError> {
    let mut document: DocumentMut = text.parse()?;
    let gantry = document
        .get_mut("gantry")
        .and_then(Item::as_table_mut)
        .ok_or(WriteError::NoGantry)?;
    for key in ["coupling", "coupling_derivative"] {
        if let Some(before) = gantry.get(key).and_then(Item::as_float) {
            replace(gantry, key, four_digits(factor * before).into());
        }
    }
    Ok(document.to_string())
}

/// The machine file `text` with a table of measured deviations of `of`, a motor or an axis, along `axis`.
///
/// # Errors
/// It is no TOML.
pub fn rewrite_deviation(
    text: &str,
    of: &str,
    axis: &str,
    deviation: &DeviationConfig,
) -> Result<String, WriteError> {
    let mut document: DocumentMut = text.parse()?;
    let mut table = document.as_table_mut();
    for name in ["deviations", of, axis] {
        let mut inner = Table::new();
        inner.set_implicit(true);
        let item = table.entry(name).or_insert(Item::Table(inner));
        table = item
            .as_table_mut()
            .ok_or_else(|| WriteError::NoTable(name.to_owned()))?;
    }
    table.set_implicit(false);
    // To 0.01 µm, and 0.00001°.
    let rounded = |value: &f32| (f64::from(*value) * 1e5).round() / 1e5;
    let values: Array = deviation.values.iter().map(rounded).collect();
    replace(table, "from", deviation.from.into());
    replace(table, "step", deviation.step.into());
    replace(table, "values", values.into());
    Ok(document.to_string())
}

/// The machine file `text` with these lengths of the machine that is called `name`, to 0.1 µm.
///
/// # Errors
/// It is no machine file of that machine, or its lengths are those of joints, which are in a list.
pub fn rewrite_arms(text: &str, name: &str, arms: &[Arm]) -> Result<String, WriteError> {
    let mut document: DocumentMut = text.parse()?;
    let table = document
        .get_mut("kinematics")
        .and_then(|kinematics| kinematics.get_mut(name))
        .and_then(Item::as_table_mut)
        .ok_or_else(|| WriteError::NoTable(format!("kinematics.{name}")))?;
    let rounded = |arm: &Arm| (arm.found_mm * 1e4).round() / 1e4;
    for arm in arms {
        match arm.place().ok_or(WriteError::Joints)? {
            (key, None) => replace(table, key, rounded(arm).into()),
            (key, Some(0)) => {
                let of_key = |other: &&Arm| other.place().is_some_and(|(of, _)| of == key);
                let values: Array = arms.iter().filter(of_key).map(rounded).collect();
                replace(table, key, values.into());
            }
            // Written with the first of its list.
            (_, Some(_)) => {}
        }
    }
    Ok(document.to_string())
}

/// A value, with what was there before in a comment behind it; one that stays is left alone.
fn replace(table: &mut Table, key: &str, mut value: Value) {
    let before = table.get(key).cloned().and_then(|item| item.into_value().ok());
    let plain = |value: &Value| {
        let mut value = value.clone();
        value.decor_mut().clear();
        value.to_string()
    };
    let same = |before: &Value| match (before.as_float(), value.as_float()) {
        (Some(before), Some(value)) => four_digits(before) == value,
        _ => plain(before) == plain(&value),
    };
    if before.as_ref().is_some_and(same) {
        return;
    }
    let was = before.as_ref().map_or("none".to_owned(), plain);
    value
        .decor_mut()
        .set_suffix(format!(" # commissioned; was {was}"));
    value.decor_mut().set_prefix(" ");
    table[key] = Item::Value(value);
}

fn of_notch(notch: &NotchConfig) -> InlineTable {
    table([
        ("frequency_hz", notch.frequency_hz),
        ("damping", notch.damping),
        ("depth", notch.depth),
    ])
}

fn of_friction(friction: &FrictionConfig) -> InlineTable {
    table([
        ("coulomb", friction.coulomb),
        ("viscous", friction.viscous),
        ("reversal_speed", friction.reversal_speed),
        ("lead_s", friction.lead_s),
        ("decay_s", friction.decay_s),
    ])
}

fn table<const N: usize>(fields: [(&str, f64); N]) -> InlineTable {
    fields
        .into_iter()
        .map(|(key, value)| (key, Value::from(four_digits(value))))
        .collect()
}
