//! Weld data: named sets of what a weld is made with, in TOML (mm, seconds, the units of the machine file).

use crate::toml_file::{self, TomlError};
use crate::{RangeError, in_range};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;
use thiserror::Error;

/// What messages call the file.
const WHAT: &str = "weld data";
/// Name of the file beside a program.
pub const FILE: &str = "welddata.toml";
/// Longest pre-flow, ignition, crater fill and post-flow \[s\].
const LONGEST_S: f64 = 60.0;
/// Longest ramp and largest offset \[mm\], and fastest weave \[Hz\].
const LONGEST_MM: f64 = 1000.0;
const FARTHEST_MM: f64 = 50.0;
const FASTEST_HZ: f64 = 50.0;

/// Why weld data cannot be used. Reads as one sentence.
#[derive(Debug, Error)]
pub enum WeldDataError {
    /// It cannot be read, is not TOML, or a key is missing, unknown or of the wrong type.
    #[error(transparent)]
    File(#[from] TomlError),
    /// A value makes no sense.
    #[error("weld data {path}: {source}")]
    Value {
        /// The file.
        path: String,
        /// Which, and what it has to be.
        source: RangeError,
    },
}

/// Sets by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WeldData {
    /// The file, for messages; empty if there is none.
    pub path: String,
    /// The sets.
    pub sets: BTreeMap<String, WeldSet>,
}

/// What a weld is made with.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WeldSet {
    /// 1 or 2.
    #[serde(default = "first_beam")]
    pub beam: u8,
    /// Power of the beam, or of the arc's source \[W\].
    pub power: f64,
    /// Digital outputs that are on from before the weld until after it, by name: shielding gas.
    #[serde(default)]
    pub outputs: Vec<String>,
    /// Analog outputs during the weld, by name: speed of the wire.
    #[serde(default)]
    pub levels: BTreeMap<String, f64>,
    /// The outputs are on for so long before the beam goes on \[s\].
    #[serde(default)]
    pub pre_flow_s: f64,
    /// And after it went off \[s\].
    #[serde(default)]
    pub post_flow_s: f64,
    /// The beam first burns at rest.
    pub ignition: Option<AtRest>,
    /// Then its power goes evenly to that of the weld.
    pub ramp_up: Option<Ramp>,
    /// Towards the end it goes evenly to another one.
    pub ramp_down: Option<Ramp>,
    /// The beam burns at rest in the end.
    pub crater_fill: Option<AtRest>,
    /// Power in proportion to the path speed.
    pub by_speed: Option<BySpeed>,
    /// The tip swings across the seam.
    pub weave: Option<Weave>,
    /// The weld lies so far beside the programmed seam: to the left of travel, and along the tool away from the work \[mm\].
    #[serde(default)]
    pub offset_mm: [f64; 2],
    /// Stretches of the seam that are welded already.
    #[serde(default)]
    pub tacks: Vec<Tack>,
    /// Changes on the way.
    #[serde(default)]
    pub changes: Vec<Change>,
}

fn first_beam() -> u8 {
    1
}

/// A time at rest.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtRest {
    /// Power \[W\].
    pub power: f64,
    /// How long \[s\].
    pub time_s: f64,
}

/// A length over which the power changes evenly.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ramp {
    /// Power at its outer end \[W\]; after an ignition that of the ignition.
    pub power: f64,
    /// Its length \[mm\].
    pub over_mm: f64,
}

/// How the power depends on the path speed.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BySpeed {
    /// From this speed on it is full \[mm/s\].
    pub full_mm_s: f64,
    /// The part that it keeps at rest, 0 to 1.
    pub least: f64,
}

/// A swing across the seam.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weave {
    /// How it crosses.
    pub form: WeaveForm,
    /// To either side \[mm\].
    pub amplitude_mm: f64,
    /// At the feed of the seam \[Hz\].
    pub frequency_hz: f64,
    /// How long it goes along at either side \[s\]; these times are part of the period.
    #[serde(default)]
    pub dwell_s: f64,
}

/// How a weave goes from one side to the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum WeaveForm {
    /// As a cosine.
    Sine,
    /// Straight.
    Triangle,
}

/// A stretch of the seam that a tack holds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tack {
    /// From the beginning of the seam \[mm\].
    pub from_mm: f64,
    /// To there \[mm\].
    pub to_mm: f64,
    /// Power over it \[W\]; the beam is off where none is given.
    pub power: Option<f64>,
}

/// A change on the way.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// From the beginning of the seam \[mm\].
    pub at_mm: f64,
    /// Evenly over so much of it \[mm\].
    #[serde(default)]
    pub over_mm: f64,
    /// To this power \[W\].
    pub power: Option<f64>,
    /// Analog outputs to these values, by name.
    #[serde(default)]
    pub levels: BTreeMap<String, f64>,
}

impl WeldData {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// As of [`WeldDataError`].
    pub fn read(path: &Path) -> Result<Self, WeldDataError> {
        Self::parse(&path.display().to_string(), &toml_file::text(WHAT, path)?)
    }

    /// [`FILE`] in the folder of `program`, if it is there; no sets if not.
    ///
    /// # Errors
    /// As of [`WeldDataError`].
    pub fn beside(program: &Path) -> Result<Self, WeldDataError> {
        let file = program.with_file_name(FILE);
        match file.exists() {
            true => Self::read(&file),
            false => Ok(Self::default()),
        }
    }

    /// Understands `text`; `path` is used in messages only.
    ///
    /// # Errors
    /// As of [`WeldDataError`].
    pub fn parse(path: &str, text: &str) -> Result<Self, WeldDataError> {
        let sets: BTreeMap<String, WeldSet> = toml_file::parse(WHAT, path, text)?;
        for (name, set) in &sets {
            set.check().map_err(|error| WeldDataError::Value {
                path: path.to_owned(),
                source: error.within(name),
            })?;
        }
        Ok(Self {
            path: path.to_owned(),
            sets,
        })
    }
}

impl WeldSet {
    /// Number of the beam, from 0.
    pub fn side(&self) -> u8 {
        self.beam - 1
    }

    fn check(&self) -> Result<(), RangeError> {
        in_range("beam", f64::from(self.beam), matches!(self.beam, 1 | 2), "1 or 2")?;
        let power = |key: &'static str, value: f64| in_range(key, value, value >= 0.0, "0 or more");
        let time = |key: &'static str, value: f64| {
            in_range(key, value, (0.0..=LONGEST_S).contains(&value), "from 0 to 60")
        };
        let way = |key: &'static str, value: f64| {
            in_range(key, value, (0.0..=LONGEST_MM).contains(&value), "from 0 to 1000")
        };
        power("power", self.power)?;
        self.levels
            .values()
            .try_for_each(|value| power("levels", *value).map(|_| ()))?;
        time("pre_flow_s", self.pre_flow_s)?;
        time("post_flow_s", self.post_flow_s)?;
        for (rest, [p, t]) in [
            (self.ignition, ["ignition.power", "ignition.time_s"]),
            (self.crater_fill, ["crater_fill.power", "crater_fill.time_s"]),
        ] {
            let Some(rest) = rest else { continue };
            power(p, rest.power)?;
            in_range(
                t,
                rest.time_s,
                (SHORTEST_REST_S..=LONGEST_S).contains(&rest.time_s),
                "from 0.1 to 60",
            )?;
        }
        for (ramp, [p, l]) in [
            (self.ramp_up, ["ramp_up.power", "ramp_up.over_mm"]),
            (self.ramp_down, ["ramp_down.power", "ramp_down.over_mm"]),
        ] {
            let Some(ramp) = ramp else { continue };
            power(p, ramp.power)?;
            way(l, ramp.over_mm)?;
        }
        if let Some(by_speed) = self.by_speed {
            let (full, least) = (by_speed.full_mm_s, by_speed.least);
            in_range("by_speed.full_mm_s", full, full > 0.0, "above 0")?;
            in_range(
                "by_speed.least",
                least,
                (0.0..=1.0).contains(&least),
                "from 0 to 1",
            )?;
        }
        if let Some(weave) = self.weave {
            let Weave {
                amplitude_mm,
                frequency_hz,
                dwell_s,
                ..
            } = weave;
            let ok = amplitude_mm > 0.0 && amplitude_mm <= FARTHEST_MM;
            in_range("weave.amplitude_mm", amplitude_mm, ok, "above 0 and at most 50")?;
            let ok = frequency_hz > 0.0 && frequency_hz <= FASTEST_HZ;
            in_range("weave.frequency_hz", frequency_hz, ok, "above 0 and at most 50")?;
            let ok = dwell_s >= 0.0 && 2.0 * dwell_s < 1.0 / frequency_hz;
            in_range(
                "weave.dwell_s",
                dwell_s,
                ok,
                "0 or more, and less than half a period",
            )?;
        }
        for offset in self.offset_mm {
            in_range("offset_mm", offset, offset.abs() <= FARTHEST_MM, "from -50 to 50")?;
        }
        let mut end = 0.0;
        for tack in &self.tacks {
            in_range(
                "tacks.from_mm",
                tack.from_mm,
                tack.from_mm >= end,
                "not before the end of the tack before it",
            )?;
            in_range(
                "tacks.to_mm",
                tack.to_mm,
                tack.to_mm > tack.from_mm,
                "behind from_mm",
            )?;
            end = tack.to_mm;
            tack.power.map(|value| power("tacks.power", value)).transpose()?;
        }
        for change in &self.changes {
            way("changes.at_mm", change.at_mm)?;
            way("changes.over_mm", change.over_mm)?;
            change
                .power
                .map(|value| power("changes.power", value))
                .transpose()?;
            change
                .levels
                .values()
                .try_for_each(|value| power("changes.levels", *value).map(|_| ()))?;
        }
        Ok(())
    }
}

/// Shortest ignition and crater fill \[s\]: less than coming to rest and starting from it takes.
const SHORTEST_REST_S: f64 = 0.1;

#[cfg(test)]
mod tests {
    use super::*;

    const FULL: &str = r#"
[root]
power = 4000.0
outputs = ["gas"]
levels = { wire_feed = 8.0 }
pre_flow_s = 0.5
post_flow_s = 2.0
ignition = { power = 2500.0, time_s = 0.3 }
ramp_up = { power = 0.0, over_mm = 5.0 }
ramp_down = { power = 1500.0, over_mm = 8.0 }
crater_fill = { power = 1200.0, time_s = 0.6 }
by_speed = { full_mm_s = 8.0, least = 0.4 }
weave = { form = "sine", amplitude_mm = 2.0, frequency_hz = 1.5, dwell_s = 0.1 }
offset_mm = [1.0, 2.0]
tacks = [{ from_mm = 20.0, to_mm = 28.0 }, { from_mm = 50.0, to_mm = 55.0, power = 4500.0 }]
changes = [{ at_mm = 60.0, over_mm = 10.0, power = 3000.0, levels = { wire_feed = 6.0 } }]

[cap]
power = 3000.0
"#;

    #[test]
    fn sets_are_read_with_all_that_they_may_have() {
        let data = WeldData::parse("w.toml", FULL).unwrap();
        let root = &data.sets["root"];
        assert_eq!(
            (root.side(), root.tacks.len(), root.changes[0].power),
            (0, 2, Some(3000.0))
        );
        assert_eq!(root.weave.unwrap().form, WeaveForm::Sine);
        let cap = &data.sets["cap"];
        assert_eq!((cap.offset_mm, cap.weave, cap.pre_flow_s), ([0.0; 2], None, 0.0));
    }

    #[test]
    fn what_makes_no_sense_is_named_with_its_set_and_key() {
        for (from, to, told) in [
            (
                "power = 4000.0",
                "power = -1.0",
                "root.power is -1, but must be 0 or more",
            ),
            (
                "dwell_s = 0.1",
                "dwell_s = 0.4",
                "root.weave.dwell_s is 0.4, but must be 0 or more, and less than half a period",
            ),
            (
                "time_s = 0.3",
                "time_s = 0.0",
                "root.ignition.time_s is 0, but must be from 0.1 to 60",
            ),
            (
                "to_mm = 28.0",
                "to_mm = 20.0",
                "root.tacks.to_mm is 20, but must be behind from_mm",
            ),
            (
                "from_mm = 50.0",
                "from_mm = 27.0",
                "root.tacks.from_mm is 27, but must be not before the end of the tack before it",
            ),
            (
                "least = 0.4",
                "least = 1.4",
                "root.by_speed.least is 1.4, but must be from 0 to 1",
            ),
        ] {
            let error = WeldData::parse("w.toml", &FULL.replacen(from, to, 1)).unwrap_err();
            assert_eq!(error.to_string(), format!("weld data w.toml: {told}"));
        }
        let error =
            WeldData::parse("w.toml", &FULL.replace("power = 3000.0\n", "powr = 3000.0\n")).unwrap_err();
        assert!(
            error
                .to_string()
                .starts_with("weld data w.toml, line 19: unknown field `powr`"),
            "{error}"
        );
    }
}
