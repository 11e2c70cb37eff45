//! Limits in part files: numbers that make sense, or an error with their line.

use serde::Deserialize;

/// What something may be at most, in the unit of its key.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub struct Limit(f64);

impl Limit {
    /// A limit of `value`, 0 or more.
    pub const fn new(value: f64) -> Self {
        Self(value)
    }

    /// Its number.
    pub const fn get(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for Limit {
    type Error = String;

    fn try_from(value: f64) -> Result<Self, String> {
        if value.is_finite() && value >= 0.0 {
            Ok(Self(value))
        } else {
            Err(format!("a limit must be a number of 0 or more, not {value}"))
        }
    }
}

/// What something may be at least and at most, in the unit of its key: `[least, most]`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "[f64; 2]")]
pub struct Range([f64; 2]);

impl Range {
    /// From `least` to `most`.
    pub const fn new(least: f64, most: f64) -> Self {
        Self([least, most])
    }

    /// What it may be at least.
    pub const fn least(self) -> f64 {
        self.0[0]
    }

    /// What it may be at most.
    pub const fn most(self) -> f64 {
        self.0[1]
    }
}

impl TryFrom<[f64; 2]> for Range {
    type Error = String;

    fn try_from([least, most]: [f64; 2]) -> Result<Self, String> {
        if most.is_finite() && 0.0 <= least && least <= most {
            Ok(Self([least, most]))
        } else {
            Err(format!(
                "limits [least, most] must be numbers of 0 or more, the smaller one first, not [{least}, {most}]"
            ))
        }
    }
}

/// A limit that is a share \[%\].
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(try_from = "f64")]
pub struct Percent(f64);

impl Percent {
    /// A share of `value`, 0 to 100.
    pub const fn new(value: f64) -> Self {
        Self(value)
    }

    /// Its number.
    pub const fn get(self) -> f64 {
        self.0
    }
}

impl TryFrom<f64> for Percent {
    type Error = String;

    fn try_from(value: f64) -> Result<Self, String> {
        if (0.0..=100.0).contains(&value) {
            Ok(Self(value))
        } else {
            Err(format!(
                "a limit in percent must be a number from 0 to 100, not {value}"
            ))
        }
    }
}

/// How far the speed may fall below the programmed feed with a beam on, where a part file says nothing. Assumed: with a
/// tenth less speed each millimetre of seam gets a ninth more heat.
pub(super) const SPEED_DIP: Percent = Percent::new(10.0);
