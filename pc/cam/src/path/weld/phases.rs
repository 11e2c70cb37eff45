//! What a set of weld data switches, and where on its seam.

use super::super::{PathError, Planner};
use super::WeldError;
use super::powers::Powers;
use config::weld_data::{Tack, WeldSet};
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

/// A set on a seam.
struct Switching<'w> {
    planner: &'w Planner,
    name: &'w str,
    set: &'w WeldSet,
    /// Of the seam \[mm\].
    length: f64,
    /// Where the program calls it.
    place: SourcePosition,
}

impl Phases {
    /// Those of `set`, called `name` at `place`, on a seam of `length` \[mm\].
    pub(super) fn of(
        planner: &Planner,
        (name, set): (&str, &WeldSet),
        length: f64,
        place: SourcePosition,
    ) -> Result<Self, PathError> {
        let switching = Switching {
            planner,
            name,
            set,
            length,
            place,
        };
        switching.check_places()?;
        let phases = Self {
            before: switching.outputs(true)?,
            ignition: switching.ignition()?,
            on_seam: switching.on_seam()?,
            crater: switching.crater(),
            after: switching.after()?,
            end: switching.outputs(false)?,
        };
        let seam = phases.on_seam.iter().map(|(_, action)| action);
        let rests = [&phases.before, &phases.ignition, &phases.crater, &phases.after];
        rests
            .into_iter()
            .flatten()
            .chain(seam)
            .try_for_each(|action| planner.check_output(action, place))?;
        Ok(phases)
    }
}

impl Switching<'_> {
    /// Nothing of the set lies behind the end of the seam.
    fn check_places(&self) -> Result<(), WeldError> {
        let set = self.set;
        let changes = set
            .changes
            .iter()
            .map(|change| ("changes", change.at_mm + change.over_mm));
        let tacks = set.tacks.iter().map(|tack| ("tacks", tack.to_mm));
        let down = set.ramp_down.map(|down| {
            let up = set.ramp_up.map_or(0.0, |up| up.over_mm);
            ("ramp_up and ramp_down", up + down.over_mm)
        });
        let behind = changes.chain(tacks).chain(down).find(|(_, s)| *s > self.length);
        match behind {
            Some((key, s)) => Err(WeldError::Behind {
                place: self.place,
                name: self.name.to_owned(),
                key,
                s,
                length: self.length,
            }),
            None => Ok(()),
        }
    }

    /// Before the seam, where the beam goes on at rest; nothing where it does not.
    fn ignition(&self) -> Result<Vec<PathAction>, PathError> {
        let mut actions = Vec::new();
        if self.set.ignition.is_some() || self.set.stir.is_some() {
            actions.extend(self.rest());
            actions.extend(self.on()?);
        }
        Ok(actions)
    }

    fn on_seam(&self) -> Result<Vec<(f64, PathAction)>, PathError> {
        let set = self.set;
        let powers = Powers::of(set, self.length);
        let mut on_seam: Vec<(f64, PathAction)> = Vec::new();
        if set.ignition.is_none() && set.stir.is_none() {
            on_seam.extend(self.on()?.into_iter().map(|action| (0.0, action)));
            // Only at the end: the beam goes on when it is fast enough.
            on_seam.extend(self.rest().map(|rest| (self.length / 2.0, rest)));
        }
        on_seam.extend(set.by_speed.map(|by_speed| {
            let (full_mm_s, least) = (by_speed.full_mm_s, by_speed.least);
            (0.0, self.by_speed(full_mm_s, least))
        }));
        // The power of a tack holds for all of it.
        let has_own = |tack: &&Tack| tack.power.is_some();
        let own = |s: f64| {
            let mut tacks = set.tacks.iter().filter(has_own);
            tacks.any(|tack| (tack.from_mm..tack.to_mm).contains(&s))
        };
        let steps = powers.steps.iter().filter(|step| !own(step.at));
        on_seam.extend(steps.map(|step| (step.at, self.power(step.to, step.over))));
        for change in &set.changes {
            let levels = self.levels(&change.levels, change.over_mm)?;
            on_seam.extend(levels.into_iter().map(|action| (change.at_mm, action)));
        }
        for tack in &set.tacks {
            let (from, to) = (tack.from_mm, tack.to_mm);
            match tack.power {
                Some(power) => {
                    on_seam.push((from, self.power(power, 0.0)));
                    on_seam.push((to, self.power(powers.at(to), 0.0)));
                    on_seam.extend(powers.left(to).map(|left| (to, self.power(left.to, left.over))));
                }
                None => on_seam.extend([(from, self.gate(false)), (to, self.gate(true))]),
            }
        }
        on_seam.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(on_seam)
    }

    /// At the beginning of the crater fill.
    fn crater(&self) -> Vec<PathAction> {
        let crater = self.set.crater_fill.map(|crater| self.power(crater.power, 0.0));
        self.steady().into_iter().chain(crater).collect()
    }

    /// The beam goes off, and what is fed stops.
    fn after(&self) -> Result<Vec<PathAction>, PathError> {
        let side = self.set.side();
        let mut after = vec![self.gate(false), self.power(0.0, 0.0)];
        after.extend(self.rest().map(|_| PathAction::AtRest { side, ms: 0 }));
        after.extend(self.steady());
        let off = self.set.levels.keys().map(|name| (name.clone(), 0.0)).collect();
        after.extend(self.levels(&off, 0.0)?);
        Ok(after)
    }

    /// The first power, what is fed, and the beam on.
    fn on(&self) -> Result<Vec<PathAction>, PathError> {
        let first = Powers::of(self.set, self.length).first;
        let mut actions = vec![self.power(first, 0.0)];
        actions.extend(self.levels(&self.set.levels, 0.0)?);
        actions.push(self.gate(true));
        Ok(actions)
    }

    /// The beam may stay on at rest for as long as ignition or crater fill take, if there are any.
    fn rest(&self) -> Option<PathAction> {
        let rests = [self.set.ignition, self.set.crater_fill].into_iter().flatten();
        let longest_s = rests.map(|rest| rest.time_s).fold(0.0, f64::max);
        (longest_s > 0.0).then(|| PathAction::AtRest {
            side: self.set.side(),
            ms: ((longest_s + REST_SLACK_S) * 1e3).ceil() as u32,
        })
    }

    /// The power does not follow the speed any more, if it did.
    fn steady(&self) -> Option<PathAction> {
        self.set.by_speed.map(|_| self.by_speed(0.0, 0.0))
    }

    fn by_speed(&self, full_mm_s: f64, least: f64) -> PathAction {
        PathAction::BySpeed {
            channel: Channel::Power(self.set.side()),
            full_mm_s,
            least,
        }
    }

    fn power(&self, value: f64, over_mm: f64) -> PathAction {
        PathAction::Level {
            channel: Channel::Power(self.set.side()),
            value,
            over_mm,
        }
    }

    fn gate(&self, on: bool) -> PathAction {
        PathAction::Beam {
            side: self.set.side(),
            on,
        }
    }

    /// The outputs of the set, all of them.
    fn outputs(&self, on: bool) -> Result<Vec<PathAction>, PathError> {
        let known = &self.planner.output_names.outputs;
        let output = |wanted: &String| {
            let output = *known.get(wanted).ok_or_else(|| self.unknown(wanted))?;
            Ok(PathAction::Output { output, on })
        };
        self.set.outputs.iter().map(output).collect()
    }

    fn levels(&self, levels: &BTreeMap<String, f64>, over_mm: f64) -> Result<Vec<PathAction>, PathError> {
        let known = &self.planner.output_names.analog;
        let level = |(wanted, value): (&String, &f64)| {
            let number = *known.get(wanted).ok_or_else(|| self.unknown(wanted))?;
            Ok(PathAction::Level {
                channel: Channel::Analog(number),
                value: *value,
                over_mm,
            })
        };
        levels.iter().map(level).collect()
    }

    fn unknown(&self, output: &str) -> PathError {
        PathError::NoOutput {
            place: self.place,
            output: format!("{output} ({} of the weld data)", self.name),
            machine: self.planner.name.clone(),
        }
    }
}
