//! Units of parameters, by their names.

use super::Parameter;

/// Endings of names, each before those that end like it.
const BY_ENDING: [(&str, &str); 20] = [
    ("counts_per_mm", "counts/mm"),
    ("mm_per_volt", "mm/V"),
    ("_mm_s3", "mm/s³"),
    ("_mm_s2", "mm/s²"),
    ("_mm_s", "mm/s"),
    ("_mm_min", "mm/min"),
    ("_m_min", "m/min"),
    ("_mm", "mm"),
    ("_um", "µm"),
    ("_deg", "°"),
    ("_ms", "ms"),
    ("_us", "µs"),
    ("_s", "s"),
    ("_hz", "Hz"),
    ("_rpm", "r/min"),
    ("_w", "W"),
    ("_volts", "V"),
    ("full_well", "e⁻"),
    ("read_noise", "e⁻"),
    ("coupling", "1/s"),
];

/// Names of what axes and motors have, without a unit in them: the units of a linear axis and of a rotary one.
const BY_AXIS: [(&[&str], [&str; 2]); 6] = [
    (
        &[
            "travel_min",
            "travel_max",
            "mark_position",
            "max_travel",
            "following_error_base",
            "vibration_limit",
            "park",
        ],
        ["mm", "°"],
    ),
    (
        &[
            "max_velocity",
            "velocity",
            "velocity_at_10v",
            "max_command",
            "integral_limit",
            "coulomb",
            "reversal_speed",
        ],
        ["mm/s", "°/s"],
    ),
    (&["max_acceleration"], ["mm/s²", "°/s²"]),
    (&["max_jerk"], ["mm/s³", "°/s³"]),
    (&["counts_per_unit"], ["counts/mm", "counts/°"]),
    (&["kp"], ["1/s", "1/s"]),
];

/// The unit of the parameter called `key`, with the names of the tables around it; nothing for a number alone.
pub fn unit(key: &str) -> &'static str {
    let parts: Vec<&str> = key.split('.').collect();
    // The unit of a table is that of what is in it, such as `rotary_deg = { A = 0.0 }`.
    let mut names = parts.iter().rev();
    if let Some(unit) = names.find_map(|name| by_ending(name)) {
        return unit;
    }
    let is_rotary = parts.iter().any(|part| ["A", "B", "C"].contains(part));
    let named = parts.iter().rev().find_map(|name| {
        let of = BY_AXIS.iter().find(|(names, _)| names.contains(name))?;
        Some(of.1[usize::from(is_rotary)])
    });
    match (named, parts.last()) {
        (Some(unit), _) => unit,
        (None, Some(&"ki")) => "1/s²",
        (None, _) => "",
    }
}

fn by_ending(name: &str) -> Option<&'static str> {
    let (_, unit) = BY_ENDING.iter().find(|(ending, _)| name.ends_with(ending))?;
    Some(unit)
}

/// The power of a spindle is its speed.
pub fn of_spindle(table: &mut [Parameter]) {
    let is_spindle = |of: &Parameter| of.name == "stays_on_at_rest" && of.value == "true";
    if table.iter().any(is_spindle) {
        let power = table.iter_mut().filter(|of| of.name == "power_at_10v_w");
        power.for_each(|of| of.unit = "r/min");
    }
}
