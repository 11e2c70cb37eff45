//! What the values of a set have to be.

use super::{Weave, WeldSet};
use crate::{RangeError, in_range};

/// Longest pre-flow, ignition, crater fill and post-flow \[s\].
const LONGEST_S: f64 = 60.0;
/// Longest ramp and largest offset \[mm\], and fastest weave \[Hz\].
const LONGEST_MM: f64 = 1000.0;
const FARTHEST_MM: f64 = 50.0;
const FASTEST_HZ: f64 = 50.0;
/// Shortest ignition and crater fill \[s\]: less than coming to rest and starting from it takes.
const SHORTEST_REST_S: f64 = 0.1;

impl WeldSet {
    pub(super) fn check(&self) -> Result<(), RangeError> {
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
        self.check_stir()?;
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

    fn check_stir(&self) -> Result<(), RangeError> {
        let Some(stir) = self.stir else { return Ok(()) };
        in_range("power", self.power, self.power > 0.0, "above 0 for a pin to turn")?;
        for (key, mm) in [
            ("stir.clearance_mm", stir.clearance_mm),
            ("stir.depth_mm", stir.depth_mm),
        ] {
            in_range(key, mm, mm > 0.0 && mm <= FARTHEST_MM, "above 0 and at most 50")?;
        }
        for (key, s) in [("stir.spin_up_s", stir.spin_up_s), ("stir.dwell_s", stir.dwell_s)] {
            in_range(key, s, (0.0..=LONGEST_S).contains(&s), "from 0 to 60")?;
        }
        for (key, speed) in [
            ("stir.plunge_mm_s", stir.plunge_mm_s),
            ("stir.retract_mm_s", stir.retract_mm_s),
        ] {
            in_range(key, speed, speed > 0.0, "above 0")?;
        }
        Ok(())
    }

    /// The first key of a set with `stir` that only a beam or an arc can follow.
    pub(super) fn burns_while_stirring(&self) -> Option<&'static str> {
        self.stir?;
        [
            ("ignition", self.ignition.is_some()),
            ("crater_fill", self.crater_fill.is_some()),
            ("ramp_up", self.ramp_up.is_some()),
            ("ramp_down", self.ramp_down.is_some()),
            ("by_speed", self.by_speed.is_some()),
            (
                "tacks without power",
                self.tacks.iter().any(|tack| tack.power.is_none()),
            ),
        ]
        .into_iter()
        .find_map(|(key, there)| there.then_some(key))
    }
}
