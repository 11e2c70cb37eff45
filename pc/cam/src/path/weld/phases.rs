//! What a set of weld data switches, and where on its seam.

use super::super::{PathError, Planner};
use config::weld_data::WeldSet;
use nc::SourcePosition;
use shared::protocol::{Channel, PathAction};
use std::collections::BTreeMap;

/// What a board takes from rest to rest besides the motion \[s\]: planning from rest, and its output filter.
const REST_SLACK_S: f64 = 0.2;

/// What a set switches, and where.
pub(super) struct Phases {
    /// Before the beam, at rest.
    pub(super) before: Vec<PathAction>,
    /// Where the ignition begins, or before a pin plunges.
    pub(super) ignition: Vec<PathAction>,
    /// On the seam, in order of its places \[mm\].
    pub(super) on_seam: Vec<(f64, PathAction)>,
    /// Where the crater fill begins.
    pub(super) crater: Vec<PathAction>,
    /// Beam off, at rest.
    pub(super) after: Vec<PathAction>,
    /// After the post-flow.
    pub(super) end: Vec<PathAction>,
}

impl Phases {
    /// Those of `set`, called `name` at `place`, on a seam of `length` \[mm\].
    pub(super) fn of(
        planner: &Planner,
        name: &str,
        set: &WeldSet,
        length: f64,
        place: SourcePosition,
    ) -> Result<Self, PathError> {
        let power = Channel::Power(set.side());
        let side = set.side();
        let level = |channel, value, over_mm| PathAction::Level {
            channel,
            value,
            over_mm,
        };
        let gate = |on| PathAction::Beam { side, on };
        let unknown = |output: &String| PathError::NoOutput {
            place,
            output: format!("{output} ({name} of the weld data)"),
            machine: planner.name.clone(),
        };
        let output = |wanted: &String| {
            let number = planner.output_names.outputs.get(wanted).copied();
            number.ok_or_else(|| unknown(wanted))
        };
        let outputs = set.outputs.iter().map(output).collect::<Result<Vec<u8>, _>>()?;
        let levels = |levels: &BTreeMap<String, f64>, over_mm: f64| {
            let level = |(wanted, value): (&String, &f64)| {
                let number = planner.output_names.analog.get(wanted).copied();
                let number = number.ok_or_else(|| unknown(wanted))?;
                Ok(level(Channel::Analog(number), *value, over_mm))
            };
            levels.iter().map(level).collect::<Result<Vec<_>, PathError>>()
        };
        let fed = levels(&set.levels, 0.0)?;
        let begin = || fed.iter().copied();
        let rest_s = [set.ignition, set.crater_fill].into_iter().flatten();
        let rest_s = rest_s.map(|rest| rest.time_s).fold(0.0, f64::max);
        let rest = (rest_s > 0.0).then(|| PathAction::AtRest {
            side,
            ms: ((rest_s + REST_SLACK_S) * 1e3).ceil() as u32,
        });
        let mut ignition = Vec::new();
        let mut on_seam: Vec<(f64, PathAction)> = Vec::new();
        let up = set.ramp_up;
        let ignites = set.ignition.map(|ignition| ignition.power);
        if let Some(first) = ignites.or(set.stir.map(|_| set.power)) {
            ignition.extend(rest);
            ignition.push(level(power, first, 0.0));
            ignition.extend(begin());
            ignition.push(gate(true));
        } else {
            let first = up.map_or(set.power, |ramp| ramp.power);
            let burns = [level(power, first, 0.0)].into_iter().chain(begin());
            on_seam.extend(burns.chain([gate(true)]).map(|action| (0.0, action)));
            // Only at the end: the beam goes on when it is fast enough.
            on_seam.extend(rest.map(|rest| (length / 2.0, rest)));
        }
        on_seam.extend(set.by_speed.map(|by_speed| {
            let (full_mm_s, least) = (by_speed.full_mm_s, by_speed.least);
            let action = PathAction::BySpeed {
                channel: power,
                full_mm_s,
                least,
            };
            (0.0, action)
        }));
        on_seam.push((0.0, level(power, set.power, up.map_or(0.0, |ramp| ramp.over_mm))));
        let behind = |key: &'static str, s: f64| match s <= length {
            true => Ok(()),
            false => Err(PathError::WeldBehind {
                place,
                name: name.to_owned(),
                key,
                s,
                length,
            }),
        };
        let mut now = vec![(0.0, set.power)];
        for change in &set.changes {
            behind("changes", change.at_mm + change.over_mm)?;
            if let Some(value) = change.power {
                now.push((change.at_mm, value));
                on_seam.push((change.at_mm, level(power, value, change.over_mm)));
            }
            let levels = levels(&change.levels, change.over_mm)?;
            on_seam.extend(levels.into_iter().map(|action| (change.at_mm, action)));
        }
        for tack in &set.tacks {
            behind("tacks", tack.to_mm)?;
            let before = now.iter().rev().find(|(s, _)| *s <= tack.to_mm);
            let after = before.map_or(set.power, |(_, power)| *power);
            let [over, back] = match tack.power {
                Some(value) => [level(power, value, 0.0), level(power, after, 0.0)],
                None => [gate(false), gate(true)],
            };
            on_seam.extend([(tack.from_mm, over), (tack.to_mm, back)]);
        }
        if let Some(down) = set.ramp_down {
            let ramps = up.map_or(0.0, |ramp| ramp.over_mm) + down.over_mm;
            behind("ramp_up and ramp_down", ramps)?;
            on_seam.push((length - down.over_mm, level(power, down.power, down.over_mm)));
        }
        on_seam.sort_by(|a, b| a.0.total_cmp(&b.0));
        let steady = PathAction::BySpeed {
            channel: power,
            full_mm_s: 0.0,
            least: 0.0,
        };
        let steady = set.by_speed.map(|_| steady);
        let crater = set.crater_fill.map(|crater| level(power, crater.power, 0.0));
        let off = set.levels.keys().map(|name| (name.clone(), 0.0)).collect();
        let mut after = vec![gate(false), level(power, 0.0, 0.0)];
        after.extend(rest.map(|_| PathAction::AtRest { side, ms: 0 }));
        after.extend(steady);
        after.extend(levels(&off, 0.0)?);
        let switch = |on: bool| {
            outputs
                .iter()
                .map(move |output| PathAction::Output { output: *output, on })
        };
        let phases = Self {
            before: switch(true).collect(),
            ignition,
            on_seam,
            crater: steady.into_iter().chain(crater).collect(),
            after,
            end: switch(false).collect(),
        };
        let seam = phases.on_seam.iter().map(|(_, action)| action);
        let all = phases
            .before
            .iter()
            .chain(&phases.ignition)
            .chain(seam)
            .chain(&phases.crater);
        all.chain(&phases.after)
            .try_for_each(|action| planner.check_output(action, place))?;
        Ok(phases)
    }
}
