//! The paths that a weld becomes, in their order.

use super::super::targets::RestState;
use super::super::{PathError, Planner};
use super::WeldError;
use super::phases::Phases;
use super::seam::Seam;
use super::weave::{self, Stretch};
use super::woven::Aside;
use config::weld_data::{AtRest, WeldSet};
use nc::{Motion, PathControl, ProgramAction, ProgramEvent, ProgramPath, SourcePosition, Target, Way, Words};
use shared::io::AXES;
use shared::protocol::PathAction;

/// Half a period of a weave is no shorter \[mm\]: finer than any bead, it is a slip of feed or frequency.
const FINEST_MM: f64 = 0.1;

/// A weld with its weld data.
pub(super) struct Weld<'w, 'p> {
    name: &'w str,
    set: &'w WeldSet,
    /// The seam as it is programmed.
    path: &'w ProgramPath,
    /// Its speed \[mm/s\].
    speed: f64,
    /// Where the program calls it.
    on: SourcePosition,
    /// The seam is one smooth curve through its points.
    smooth: bool,
    aside: Aside<'p>,
    phases: Phases,
}

impl<'w, 'p> Weld<'w, 'p> {
    /// The weld with the set of this `name`, called at `on`, along the seam of `path` that begins at `stand` and is gone at
    /// `speed` \[mm/s\].
    pub(super) fn of(
        planner: &'p Planner,
        (name, set): (&'w str, &'w WeldSet),
        path: &'w ProgramPath,
        (on, speed): (SourcePosition, f64),
        stand: &RestState,
    ) -> Result<Self, PathError> {
        let smooth = planner.is_smooth(path, stand)?;
        let seam = Seam::of(planner, path, stand, smooth)?;
        let phases = Phases::of(planner, (name, set), seam.length(), on)?;
        let [left, away] = set.offset_mm;
        let down = set.stir.map_or(0.0, |stir| stir.clearance_mm + stir.depth_mm);
        let offset = [left, away - down];
        if set.stir.is_some() && planner.spindle != Some(set.side()) {
            return Err(WeldError::NoPin {
                place: on,
                name: name.to_owned(),
                beam: set.beam,
            }
            .into());
        }
        let weld = Self {
            name,
            set,
            path,
            speed,
            on,
            smooth,
            aside: Aside { seam, offset },
            phases,
        };
        if planner.tracks && (weld.is_beside() || weld.rests()) {
            let name = name.to_owned();
            return Err(WeldError::Tracked { place: on, name }.into());
        }
        Ok(weld)
    }

    /// Its paths, from where the machine stands.
    pub(super) fn paths(&self, stand: &RestState) -> Result<Vec<ProgramPath>, PathError> {
        let (set, phases, on) = (self.set, &self.phases, self.on);
        let length = self.aside.seam.length();
        let leads = set.offset_mm != [0.0; 2];
        let mut axes = stand.axes;
        let mut paths = Vec::new();
        if leads {
            paths.push(self.straight(0.0, set.offset_mm, self.speed, &mut axes)?);
        }
        paths.push(standing(&phases.before, 0.0, on));
        if let Some(stir) = set.stir {
            paths.push(standing(&phases.ignition, set.pre_flow_s, on));
            let plunge = self.straight(0.0, self.aside.offset, stir.plunge_mm_s, &mut axes)?;
            paths.push(ProgramPath {
                dwell_before_s: stir.spin_up_s,
                ..plunge
            });
        }
        let (targets, events) = self.seam(&mut axes)?;
        let before_s = set.stir.map_or(set.pre_flow_s, |stir| stir.dwell_s);
        paths.push(feeding(targets, events, before_s));
        if let Some(stir) = set.stir {
            paths.push(self.straight(length, set.offset_mm, stir.retract_mm_s, &mut axes)?);
        }
        paths.push(standing(&phases.after, 0.0, on));
        paths.push(standing(&phases.end, set.post_flow_s, on));
        if leads {
            paths.push(self.straight(length, [0.0; 2], self.speed, &mut axes)?);
        }
        paths.retain(|path| path.motion != Motion::Stand || !path.events.is_empty());
        Ok(paths)
    }

    /// The tip goes elsewhere than the programmed seam.
    fn is_beside(&self) -> bool {
        self.set.weave.is_some() || self.aside.offset != [0.0; 2]
    }

    /// The beam burns at rest.
    fn rests(&self) -> bool {
        self.set.ignition.is_some() || self.set.crater_fill.is_some()
    }

    /// A straight motion at place `s` of the seam to so far to the left and away from the work \[mm\].
    fn straight(
        &self,
        s: f64,
        offset: [f64; 2],
        speed: f64,
        axes: &mut [f64; AXES],
    ) -> Result<ProgramPath, PathError> {
        let like = &self.path.targets[self.aside.seam.target(s)];
        let target = self.aside.transfer(s, offset, speed, axes, like)?;
        Ok(feeding(vec![target], Vec::new(), 0.0))
    }

    /// The motions of the seam with its times at rest, and what happens on them.
    fn seam(&self, axes: &mut [f64; AXES]) -> Result<(Vec<Target>, Vec<ProgramEvent>), PathError> {
        let (on, phases) = (self.on, &self.phases);
        let (mut targets, mut events) = if self.is_beside() || self.rests() && self.smooth {
            self.beside(axes)?
        } else {
            (self.path.targets.clone(), self.on_seam())
        };
        let first = &self.path.targets[0];
        if let Some(ignition) = self.set.ignition {
            targets.insert(0, wait(ignition, first));
            events.iter_mut().for_each(|event| event.with_target += 1);
            let burns = phases.ignition.iter().map(|action| output(0, 0.0, *action, on));
            events.splice(0..0, burns);
        }
        if let Some(crater) = self.set.crater_fill {
            let end = targets.len();
            let burns = phases.crater.iter().map(|action| output(end, 0.0, *action, on));
            events.extend(burns);
            targets.push(wait(crater, first));
        }
        Ok((targets, events))
    }

    /// What happens on the seam as it is programmed.
    fn on_seam(&self) -> Vec<ProgramEvent> {
        let seam = &self.aside.seam;
        let place = |event: &(f64, PathAction)| {
            let target = seam.target(event.0);
            output(target, event.0 - seam.start(target), event.1, self.on)
        };
        self.phases.on_seam.iter().map(place).collect()
    }

    /// Motions beside the seam, with what happens on the way.
    fn beside(&self, axes: &mut [f64; AXES]) -> Result<(Vec<Target>, Vec<ProgramEvent>), PathError> {
        let stretches = self.stretches()?;
        let aside = &self.aside;
        let (mut targets, mut starts) = (Vec::new(), Vec::new());
        for stretch in &stretches {
            starts.push(stretch.seam[0]);
            let like = &self.path.targets[aside.seam.target(stretch.seam[0])];
            targets.push(aside.target(stretch, self.speed, axes, like)?);
        }
        let length = |stretch: &Stretch| aside.length(stretch, stretch.seam[1]);
        let lengths: Vec<f64> = stretches.iter().map(length).collect();
        let place = |s: f64| {
            let index = starts.partition_point(|start| *start <= s).max(1) - 1;
            (index, aside.length(&stretches[index], s))
        };
        let on_way = |(index, after): (usize, f64)| lengths[..index].iter().sum::<f64>() + after;
        let events = self.phases.on_seam.iter().map(|(s, action)| {
            let (index, after_mm) = place(*s);
            let action = match *action {
                PathAction::Level {
                    channel,
                    value,
                    over_mm,
                } => PathAction::Level {
                    channel,
                    value,
                    over_mm: on_way(place(s + over_mm)) - on_way(place(*s)),
                },
                other => other,
            };
            output(index, after_mm, action, self.on)
        });
        let events = events.collect();
        Ok((targets, events))
    }

    /// The stretches of the way beside the seam: of the weave, or block by block.
    fn stretches(&self) -> Result<Vec<Stretch>, WeldError> {
        let seam = &self.aside.seam;
        let name = || self.name.to_owned();
        if let Some((target, turn)) = seam.corner() {
            return Err(WeldError::Corner {
                place: self.path.targets[target + 1].place,
                name: name(),
                degrees: turn.to_degrees(),
            });
        }
        if let Some(place) = seam.stands() {
            return Err(WeldError::Stands { place, name: name() });
        }
        let Some(weave) = &self.set.weave else {
            let starts = (0..seam.ends.len()).map(|target| seam.start(target));
            let along = |(from, to): (f64, &f64)| Stretch::along(from, *to);
            return Ok(starts.zip(&seam.ends).map(along).collect());
        };
        let place = self.path.targets[0].place;
        let half = self.speed / weave.frequency_hz / 2.0;
        if half < FINEST_MM {
            return Err(WeldError::Fine {
                place,
                name: name(),
                half,
                finest: FINEST_MM,
            });
        }
        weave::stretches(weave, seam.length(), self.speed).ok_or_else(|| WeldError::Short {
            place,
            name: name(),
            length: seam.length(),
            half,
        })
    }
}

fn output(with_target: usize, after_mm: f64, action: PathAction, place: SourcePosition) -> ProgramEvent {
    ProgramEvent {
        with_target,
        after_mm,
        action: ProgramAction::Output(action),
        code: "WELDON",
        place,
    }
}

/// The machine stands and switches `actions`.
fn standing(actions: &[PathAction], dwell_before_s: f64, place: SourcePosition) -> ProgramPath {
    ProgramPath {
        waits_before: Vec::new(),
        dwell_before_s,
        motion: Motion::Stand,
        targets: Vec::new(),
        events: actions
            .iter()
            .map(|action| output(0, 0.0, *action, place))
            .collect(),
        probe: None,
        fixed_feed: false,
        rest: None,
    }
}

fn feeding(targets: Vec<Target>, events: Vec<ProgramEvent>, dwell_before_s: f64) -> ProgramPath {
    ProgramPath {
        waits_before: Vec::new(),
        dwell_before_s,
        motion: Motion::Feed,
        targets,
        events,
        probe: None,
        fixed_feed: false,
        rest: None,
    }
}

/// A time at rest on the path.
fn wait(rest: AtRest, like: &Target) -> Target {
    Target {
        way: Way::Wait(rest.time_s),
        words: Words::default(),
        feed: like.feed,
        control: PathControl::ExactStop,
        place: like.place,
    }
}
