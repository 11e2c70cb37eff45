//! Welds of a program, made with weld data: what the sets say becomes motions and outputs of the program.
//!
//! A weld goes from WELDON to WELDOFF, from rest to rest. Before it are paths without motion that switch what flows, in it
//! the times at rest of ignition and crater fill, and between them the seam: as it is programmed, or as NURBS where the
//! tip is beside it. A pin turns before it plunges, and until it has come out.

mod error;
mod paths;
mod phases;
mod powers;
mod seam;
#[cfg(test)]
mod tests;
mod weave;
mod woven;

pub use error::WeldError;

use super::targets::RestState;
use super::{PathError, Planner};
use nc::{FeedRate, Motion, Program, ProgramAction, ProgramEvent, ProgramPath, SourcePosition};
use paths::Weld;

/// A second at rest within a path counts as so many millimetres of it: the speed of [`nc::Way::Wait`] \[mm/s\].
pub(super) const WAIT_MM_S: f64 = 1.0;

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
                    return Err(WeldError::On {
                        place: place(path).unwrap_or(weld.place),
                        name: name.clone(),
                        on: weld.place,
                    }
                    .into());
                }
                weld.done = true;
                let mut path = self.without_short_blocks(path.whole()?, stand)?;
                let speed = speed(&path)?;
                if let Some(speed) = speed_mm_s {
                    let feed = Some(FeedRate::PerMinute(60.0 * speed));
                    path.targets.iter_mut().for_each(|target| target.feed = feed);
                }
                let speed = speed_mm_s.unwrap_or(speed);
                let set = &self.welding.sets[name];
                let weld = Weld::of(self, (name, set), &path, (weld.place, speed), stand)?;
                Ok(Made {
                    paths: weld.paths(stand)?,
                    speed_mm_s: None,
                })
            }
        }
    }

    /// The program ends.
    pub(super) fn check_welded(&self, program: &Program, called: Option<Called>) -> Result<(), WeldError> {
        called.map_or(Ok(()), |weld| {
            Err(WeldError::Open {
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
    ) -> Result<(), WeldError> {
        let place = word.place;
        match (word.action, called.take()) {
            (ProgramAction::WeldOn(index), None) => {
                let name = &program.welds[index];
                if !self.welding.sets.contains_key(name) {
                    let known: Vec<&str> = self.welding.sets.keys().map(String::as_str).collect();
                    return Err(WeldError::NoSet {
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
            (ProgramAction::WeldOn(_), Some(weld)) => Err(WeldError::On {
                place,
                name: program.welds[weld.index].clone(),
                on: weld.place,
            }),
            (_, Some(weld)) if weld.done => Ok(()),
            (_, Some(weld)) => Err(WeldError::Empty {
                place,
                name: program.welds[weld.index].clone(),
            }),
            (_, None) => Err(WeldError::NotOn { place }),
        }
    }

    /// Path length of a time at rest within a path \[mm\]: from rest to rest it takes that time.
    pub fn path_length_at_rest(&self, time_s: f64) -> f64 {
        let rise_s = 2.0 * self.planning.speed_up_length(WAIT_MM_S) / WAIT_MM_S;
        WAIT_MM_S * (time_s - rise_s).max(rise_s)
    }
}

/// The one speed of a seam \[mm/s\].
fn speed(path: &ProgramPath) -> Result<f64, WeldError> {
    let mut speed = None;
    for target in &path.targets {
        let place = target.place;
        match (target.feed, speed) {
            (Some(FeedRate::PerMinute(feed)), None) => speed = Some(feed),
            (Some(FeedRate::PerMinute(feed)), Some(before)) if feed == before => {}
            (Some(FeedRate::PerMinute(_)), _) => return Err(WeldError::Feeds { place }),
            _ => return Err(WeldError::InverseTime { place }),
        }
    }
    Ok(speed.unwrap_or_default() / 60.0)
}

fn place(path: &ProgramPath) -> Option<SourcePosition> {
    let target = path.targets.first().map(|target| target.place);
    target.or(path.events.first().map(|event| event.place))
}
