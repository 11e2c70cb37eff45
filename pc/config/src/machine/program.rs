//! What NC programs for the machine begin with: modes that hold until a program says others.

use super::check::same;
use super::{MachineFile, Mistake};
use crate::in_range;
use serde::Deserialize;
use shared::io::{AXES, AXIS_NAMES};
use std::collections::BTreeSet;
use std::ops::RangeInclusive;

/// `[program]`: each key has the default of RS274/NGC as `docs/nc.md` states it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ProgramConfig {
    /// Of lengths and feeds.
    pub units: LengthUnit,
    /// Of arcs.
    pub plane: ArcPlane,
    /// X Y Z are the tip without a G43.4 or TRAORI.
    pub tip_control: bool,
    /// How closely the way is followed.
    pub path_mode: PathMode,
    /// P of a G64 \[mm\]; none is the G64 alone.
    pub tolerance_mm: Option<f64>,
    /// A B C of the first motion of the tip, where it does not say them \[°\].
    pub rotary_deg: Rotary,
    /// M codes, and commands to Grbl, that programs are read without.
    pub passed_over: PassedOver,
    /// S of M3 and M4 in programs that have said none \[r/min\].
    pub spindle_rpm: Option<f64>,
    /// The output that is on while the spindle turns by M4.
    pub spindle_reverse: Option<String>,
    /// The motion of axis words before any motion code.
    pub motion: Option<FirstMotion>,
    /// R of canned cycles that have none is the level where the first of them begins.
    pub r_at_initial_level: bool,
    /// F of programs that have said none \[mm/min\].
    pub feed_mm_min: Option<f64>,
    /// The beam that M3, M4, M5 and S switch.
    pub laser: Option<LaserWords>,
    /// The probe of G38.
    pub probe: Option<ProbeConfig>,
}

impl Default for ProgramConfig {
    fn default() -> Self {
        Self {
            units: LengthUnit::default(),
            plane: ArcPlane::default(),
            tip_control: true,
            path_mode: PathMode::default(),
            tolerance_mm: None,
            rotary_deg: Rotary::default(),
            passed_over: PassedOver::default(),
            spindle_rpm: None,
            spindle_reverse: None,
            motion: None,
            r_at_initial_level: false,
            feed_mm_min: None,
            laser: None,
            probe: None,
        }
    }
}

/// How M3, M4, M5 and S switch a beam.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LaserWords {
    /// 1 or 2.
    pub beam: u8,
    /// S of its full power.
    pub full_s: f64,
}

/// A probe that touches the work.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProbeConfig {
    /// Name of the input of the process that it switches.
    pub input: String,
    /// The input goes off when it touches; it comes on then otherwise.
    #[serde(default)]
    pub opens: bool,
}

/// Unit of lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LengthUnit {
    /// As after G21.
    #[default]
    Mm,
    /// As after G20.
    Inch,
}

/// What axis words before any motion code are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum FirstMotion {
    /// A rapid.
    G0,
}

/// Plane of arcs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[expect(missing_docs, reason = "codes")]
pub enum ArcPlane {
    #[default]
    G17,
    G18,
    G19,
}

/// How closely the programmed way is followed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum PathMode {
    /// Exact path.
    G61,
    /// Exact stop.
    #[serde(rename = "G61.1")]
    G61_1,
    /// Best speed.
    #[default]
    G64,
}

/// A value for some of the rotary axes \[°\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
#[expect(non_snake_case, reason = "the keys of the file are the names of the axes")]
#[expect(missing_docs, reason = "letters")]
pub struct Rotary {
    pub A: Option<f64>,
    pub B: Option<f64>,
    pub C: Option<f64>,
}

impl Rotary {
    /// A B C.
    pub fn into_array(self) -> [Option<f64>; 3] {
        [self.A, self.B, self.C]
    }
}

/// M codes of other machines, by their numbers, and commands to Grbl.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(try_from = "Vec<String>")]
pub struct PassedOver {
    numbers: BTreeSet<u16>,
    grbl_commands: bool,
}

/// Stands for the commands to Grbl.
const GRBL: &str = "$";

/// Largest number of an M code.
const MOST_FUNCTION: u16 = 9999;
/// M codes with a meaning of their own in programs, M19, which would leave a spindle where it must not be, and calls of other controllers.
const KNOWN: [RangeInclusive<u16>; 10] = [
    0..=9,
    17..=17,
    19..=19,
    30..=30,
    40..=45,
    48..=48,
    60..=68,
    70..=73,
    97..=99,
    198..=198,
];

impl PassedOver {
    /// Numbers of M codes.
    pub fn numbers(&self) -> &BTreeSet<u16> {
        &self.numbers
    }

    /// Commands to Grbl that move nothing.
    pub fn grbl_commands(&self) -> bool {
        self.grbl_commands
    }
}

impl TryFrom<Vec<String>> for PassedOver {
    type Error = String;

    fn try_from(codes: Vec<String>) -> Result<Self, String> {
        let functions = codes.iter().filter(|code| *code != GRBL);
        Ok(Self {
            numbers: functions.map(|code| function(code)).collect::<Result<_, _>>()?,
            grbl_commands: codes.iter().any(|code| code == GRBL),
        })
    }
}

/// The number of an M code that may be passed over.
fn function(code: &str) -> Result<u16, String> {
    let digits = code
        .strip_prefix('M')
        .filter(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()));
    let number = digits
        .and_then(|digits| digits.parse().ok())
        .filter(|number| *number <= MOST_FUNCTION);
    let Some(number) = number else {
        return Err(format!(
            "\"{code}\" is no M code: only those, up to \"M9999\", and \"$\" for commands to Grbl are passed over"
        ));
    };
    if KNOWN.iter().any(|known| known.contains(&number)) {
        return Err(format!(
            "\"{code}\" has a meaning in programs (docs/nc.md), and is not passed over"
        ));
    }
    Ok(number)
}

/// A tolerance only of a G64, speeds above 0, and only axes that the machine has, within their travel.
pub(super) fn check(machine: &MachineFile) -> Result<(), Mistake> {
    let program = &machine.program;
    if let Some(tolerance) = program.tolerance_mm {
        let key = "program.tolerance_mm";
        let blends = program.path_mode == PathMode::G64;
        in_range(key, tolerance, blends, "left out: path_mode is not \"G64\"")?;
        in_range(key, tolerance, tolerance > 0.0, "above 0")?;
    }
    for (key, speed) in [
        ("program.spindle_rpm", program.spindle_rpm),
        ("program.feed_mm_min", program.feed_mm_min),
    ] {
        let Some(speed) = speed else { continue };
        in_range(key, speed, speed > 0.0 && speed.is_finite(), "above 0")?;
    }
    laser(machine)?;
    spindle_reverse(machine)?;
    probe(machine)?;
    let fitted = machine.motion.kinematics.fitted();
    for (axis, angle) in (AXES - 3..).zip(program.rotary_deg.into_array()) {
        let Some(angle) = angle else { continue };
        let key = format!("program.rotary_deg.{}", AXIS_NAMES[axis]);
        same(machine, &key, true, fitted[axis])?;
        if let Some(limits) = &machine.motion.axes[axis] {
            let within = (limits.travel_min..=limits.travel_max).contains(&angle);
            in_range(key, angle, within, "within the travel")?;
        }
    }
    Ok(())
}

/// There is a spindle, and an output of this name.
fn spindle_reverse(machine: &MachineFile) -> Result<(), Mistake> {
    let Some(name) = &machine.program.spindle_reverse else {
        return Ok(());
    };
    let has_spindle = machine
        .motion
        .beams
        .iter()
        .flatten()
        .any(|beam| beam.stays_on_at_rest);
    if has_spindle && machine.outputs.outputs.contains_key(name) {
        return Ok(());
    }
    Err(Mistake::SpindleReverse { name: name.clone() })
}

/// There is an input of this name, which answers nothing.
fn probe(machine: &MachineFile) -> Result<(), Mistake> {
    let Some(ProbeConfig { input, .. }) = &machine.program.probe else {
        return Ok(());
    };
    let number = machine.inputs.get(input).copied();
    match number.and_then(|number| machine.motion.process.inputs.get(usize::from(number))) {
        Some(None) => Ok(()),
        _ => Err(Mistake::ProbeInput { input: input.clone() }),
    }
}

/// The beam is there, no other one is a spindle, and its S says how much of its power.
fn laser(machine: &MachineFile) -> Result<(), Mistake> {
    let Some(LaserWords { beam, full_s }) = machine.program.laser else {
        return Ok(());
    };
    let beams = &machine.motion.beams;
    let side = usize::from(beam).checked_sub(1);
    if !side.and_then(|side| beams.get(side)).is_some_and(Option::is_some) {
        let key = "program.laser".to_owned();
        return Err(Mistake::NoSuchBeam { key, beam });
    }
    let has_spindle = beams.iter().flatten().any(|beam| beam.stays_on_at_rest);
    in_range(
        "program.laser.beam",
        f64::from(beam),
        !has_spindle,
        "left out: M3, M4, M5 and S are those of the spindle, the beam with stays_on_at_rest",
    )?;
    in_range(
        "program.laser.full_s",
        full_s,
        full_s > 0.0 && full_s.is_finite(),
        "above 0",
    )?;
    if let Some(speed) = machine.program.spindle_rpm {
        in_range(
            "program.spindle_rpm",
            speed,
            false,
            "left out: laser says what S means",
        )?;
    }
    Ok(())
}
