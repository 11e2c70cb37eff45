//! Welds of a program, made with weld data: what the sets say becomes motions and outputs of the program.
//!
//! A weld goes from WELDON to WELDOFF, from rest to rest. Before it are paths without motion that switch what flows, in it
//! the times at rest of ignition and crater fill, and between them the seam: as it is programmed, or as NURBS where the
//! tip is beside it.

mod phases;
mod seam;
#[cfg(test)]
mod tests;
mod weave;
mod woven;

use super::targets::RestState;
use super::{PathError, Planner};
use config::weld_data::{AtRest, WeldSet};
use nc::{
    FeedRate, Motion, PathControl, Program, ProgramAction, ProgramEvent, ProgramPath, SourcePosition, Target,
    Way, Words,
};
use phases::Phases;
use seam::Seam;
use shared::protocol::PathAction;
use weave::Stretch;
use woven::Aside;

/// A second at rest within a path counts as so many millimetres of it: the speed of [`Way::Wait`] \[mm/s\].
pub(super) const WAIT_MM_S: f64 = 1.0;
/// Half a period of a weave is no shorter \[mm\]: finer than any bead, it is a slip of feed or frequency.
const FINEST_MM: f64 = 0.1;

/// The weld that a program has called.
#[derive(Clone, Copy, Debug)]
pub(super) struct Called {
    /// Its number in [`Program::welds`].
    index: usize,
    place: SourcePosition,
    /// Its seam was gone.
    done: bool,
}

/// What a path of the program becomes.
pub(super) struct Made {
    pub(super) paths: Vec<ProgramPath>,
    /// The speed that replaces the programmed feeds of these paths \[mm/s\]; weld data has done that already.
    pub(super) speed_mm_s: Option<f64>,
}

impl Planner {
    /// What the machine does for `path` of `program`, from where it stands, `called` being the weld that is on: itself, or
    /// what the weld data makes of it. `speed_mm_s` replaces the programmed feed.
    pub(super) fn welded(
        &self,
        program: &Program,
        path: &ProgramPath,
        called: &mut Option<Called>,
        (stand, speed_mm_s): (&RestState, Option<f64>),
    ) -> Result<Made, PathError> {
        let itself = |paths| Made { paths, speed_mm_s };
        let events = &path.events;
        let words = events
            .iter()
            .find(|event| matches!(event.action, ProgramAction::WeldOn(_) | ProgramAction::WeldOff));
        match (words, called.as_mut()) {
            (None, None) => Ok(itself(vec![path.clone()])),
            (Some(word), _) => {
                self.call(program, word, called)?;
                // The path stands, and may switch more.
                let mut path = path.clone();
                path.events.retain(|event| event != word);
                let rests = path.dwell_before_s > 0.0 || !path.waits_before.is_empty();
                let nothing = path.events.is_empty() && !rests;
                Ok(itself(if nothing { Vec::new() } else { vec![path] }))
            }
            (None, Some(weld)) => {
                let name = &program.welds[weld.index];
                let rests = path.dwell_before_s > 0.0 || !path.waits_before.is_empty();
                let welds = path.motion == Motion::Feed && !rests;
                if weld.done || !welds {
                    return Err(PathError::WeldOn {
                        place: place(path).unwrap_or(weld.place),
                        name: name.clone(),
                        on: weld.place,
                    });
                }
                weld.done = true;
                let mut path = self.without_short_blocks(path.whole()?, stand)?;
                let speed = speed(&path)?;
                if let Some(speed) = speed_mm_s {
                    let feed = Some(FeedRate::PerMinute(60.0 * speed));
                    path.targets.iter_mut().for_each(|target| target.feed = feed);
                }
                let speed = speed_mm_s.unwrap_or(speed);
                let paths = self.weld(name, &self.welding.sets[name], &path, (weld.place, speed), stand)?;
                Ok(Made {
                    paths,
                    speed_mm_s: None,
                })
            }
        }
    }

    /// The program ends.
    pub(super) fn check_welded(&self, program: &Program, called: Option<Called>) -> Result<(), PathError> {
        called.map_or(Ok(()), |weld| {
            Err(PathError::WeldOpen {
                place: weld.place,
                name: program.welds[weld.index].clone(),
            })
        })
    }

    /// WELDON, WELDOFF.
    fn call(
        &self,
        program: &Program,
        word: &ProgramEvent,
        called: &mut Option<Called>,
    ) -> Result<(), PathError> {
        let place = word.place;
        match (word.action, called.take()) {
            (ProgramAction::WeldOn(index), None) => {
                let name = &program.welds[index];
                if !self.welding.sets.contains_key(name) {
                    let known: Vec<&str> = self.welding.sets.keys().map(String::as_str).collect();
                    return Err(PathError::NoWeldSet {
                        place,
                        name: name.clone(),
                        known: known.join(", "),
                        file: self.welding.path.clone(),
                    });
                }
                *called = Some(Called {
                    index,
                    place,
                    done: false,
                });
                Ok(())
            }
            (ProgramAction::WeldOn(_), Some(weld)) => Err(PathError::WeldOn {
                place,
                name: program.welds[weld.index].clone(),
                on: weld.place,
            }),
            (_, Some(weld)) if weld.done => Ok(()),
            (_, Some(weld)) => Err(PathError::WeldEmpty {
                place,
                name: program.welds[weld.index].clone(),
            }),
            (_, None) => Err(PathError::WeldNotOn { place }),
        }
    }

    /// The paths of a weld with `set`, called at `on`, along the seam of `path`, which is gone at `speed` \[mm/s\].
    fn weld(
        &self,
        name: &str,
        set: &WeldSet,
        path: &ProgramPath,
        (on, speed): (SourcePosition, f64),
        stand: &RestState,
    ) -> Result<Vec<ProgramPath>, PathError> {
        let smooth = self.is_smooth(path, stand)?;
        let seam = Seam::of(self, path, stand, smooth)?;
        let length = seam.length();
        let phases = Phases::of(self, name, set, length, on)?;
        let beside = set.weave.is_some() || set.offset_mm != [0.0; 2];
        let rests = set.ignition.is_some() || set.crater_fill.is_some();
        let aside = Aside {
            seam: &seam,
            offset: set.offset_mm,
        };
        if self.tracks && (beside || rests) {
            return Err(PathError::WeldTracked {
                place: on,
                name: name.to_owned(),
            });
        }
        let first = &path.targets[0];
        let mut paths = Vec::new();
        let mut axes = stand.axes;
        if set.offset_mm != [0.0; 2] {
            let target = aside.transfer(0.0, set.offset_mm, speed, &mut axes, &self.fitted, first)?;
            paths.push(feeding(vec![target], Vec::new(), 0.0));
        }
        paths.push(standing(phases.before.clone(), 0.0, on));
        let (mut targets, mut events) = if beside || rests && smooth {
            self.beside(&aside, set, name, &phases, speed, &mut axes, path)?
        } else {
            let place = |event: &(f64, PathAction)| {
                let target = seam.target(event.0);
                output(target, event.0 - seam.start(target), event.1, on)
            };
            (path.targets.clone(), phases.on_seam.iter().map(place).collect())
        };
        if let Some(ignition) = set.ignition {
            targets.insert(0, wait(ignition, first));
            events.iter_mut().for_each(|event| event.with_target += 1);
            let burns = phases.ignition.iter().map(|action| output(0, 0.0, *action, on));
            events.splice(0..0, burns);
        }
        if let Some(crater) = set.crater_fill {
            let burns = phases
                .crater
                .iter()
                .map(|action| output(targets.len(), 0.0, *action, on));
            events.extend(burns);
            targets.push(wait(crater, first));
        }
        paths.push(feeding(targets, events, set.pre_flow_s));
        paths.push(standing(phases.after.clone(), 0.0, on));
        paths.push(standing(phases.end.clone(), set.post_flow_s, on));
        if set.offset_mm != [0.0; 2] {
            let last = &path.targets[path.targets.len() - 1];
            let target = aside.transfer(length, [0.0; 2], speed, &mut axes, &self.fitted, last)?;
            paths.push(feeding(vec![target], Vec::new(), 0.0));
        }
        paths.retain(|path| path.motion != Motion::Stand || !path.events.is_empty());
        Ok(paths)
    }

    /// Motions beside the seam, with what happens on the way.
    #[expect(clippy::too_many_arguments, reason = "all of one weld")]
    fn beside(
        &self,
        aside: &Aside,
        set: &WeldSet,
        name: &str,
        phases: &Phases,
        speed: f64,
        axes: &mut [f64; shared::io::AXES],
        path: &ProgramPath,
    ) -> Result<(Vec<Target>, Vec<ProgramEvent>), PathError> {
        let seam = aside.seam;
        if let Some((target, turn)) = seam.corner() {
            return Err(PathError::WeldCorner {
                place: path.targets[target + 1].place,
                name: name.to_owned(),
                degrees: turn.to_degrees(),
            });
        }
        if let Some(place) = seam.stands() {
            return Err(PathError::WeldStands {
                place,
                name: name.to_owned(),
            });
        }
        let on = path.targets[0].place;
        let stretches = match &set.weave {
            Some(weave) => {
                let half = speed / weave.frequency_hz / 2.0;
                if half < FINEST_MM {
                    return Err(PathError::WeldFine {
                        place: on,
                        name: name.to_owned(),
                        half,
                        finest: FINEST_MM,
                    });
                }
                weave::stretches(weave, seam.length(), speed).ok_or_else(|| PathError::WeldShort {
                    place: on,
                    name: name.to_owned(),
                    length: seam.length(),
                    half,
                })?
            }
            None => {
                let starts = (0..seam.ends.len()).map(|target| seam.start(target));
                starts
                    .zip(&seam.ends)
                    .map(|(from, to)| Stretch::along(from, *to))
                    .collect()
            }
        };
        let (mut targets, mut starts) = (Vec::new(), Vec::new());
        for stretch in &stretches {
            starts.push(stretch.seam[0]);
            let like = &path.targets[seam.target(stretch.seam[0])];
            targets.push(aside.target(stretch, speed, axes, &self.fitted, like)?);
        }
        let length = |stretch: &Stretch| aside.length(stretch, stretch.seam[1]);
        let lengths: Vec<f64> = stretches.iter().map(length).collect();
        let place = |s: f64| {
            let index = starts.partition_point(|start| *start <= s).max(1) - 1;
            (index, aside.length(&stretches[index], s))
        };
        let on_way = |(index, after): (usize, f64)| lengths[..index].iter().sum::<f64>() + after;
        let events = phases.on_seam.iter().map(|(s, action)| {
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
            output(index, after_mm, action, on)
        });
        let events = events.collect();
        Ok((targets, events))
    }

    /// Path length of a time at rest within a path \[mm\]: from rest to rest it takes that time.
    pub fn path_length_at_rest(&self, time_s: f64) -> f64 {
        let rise_s = 2.0 * self.planning.speed_up_length(WAIT_MM_S) / WAIT_MM_S;
        WAIT_MM_S * (time_s - rise_s).max(rise_s)
    }
}

/// The one speed of a seam \[mm/s\].
fn speed(path: &ProgramPath) -> Result<f64, PathError> {
    let mut speed = None;
    for target in &path.targets {
        let place = target.place;
        match (target.feed, speed) {
            (Some(FeedRate::PerMinute(feed)), None) => speed = Some(feed),
            (Some(FeedRate::PerMinute(feed)), Some(before)) if feed == before => {}
            (Some(FeedRate::PerMinute(_)), _) => return Err(PathError::WeldFeeds { place }),
            _ => return Err(PathError::WeldInverseTime { place }),
        }
    }
    Ok(speed.unwrap_or_default() / 60.0)
}

fn place(path: &ProgramPath) -> Option<SourcePosition> {
    let target = path.targets.first().map(|target| target.place);
    target.or(path.events.first().map(|event| event.place))
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
fn standing(actions: Vec<PathAction>, dwell_before_s: f64, place: SourcePosition) -> ProgramPath {
    ProgramPath {
        waits_before: Vec::new(),
        dwell_before_s,
        motion: Motion::Stand,
        targets: Vec::new(),
        events: actions
            .into_iter()
            .map(|action| output(0, 0.0, action, place))
            .collect(),
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
