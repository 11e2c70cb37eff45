//! Where gates and outputs were switched, against where the program has them.

use cam::path::PlannedPath;
use serde::Serialize;
use shared::io::SIDES;
use shared::protocol::{MotionSample, PathAction};
use shared::ticks::PATH_PERIOD_S;
use std::collections::BTreeMap;

/// Slower than this the place says nothing of the time \[mm/s\].
const LEAST_SPEED_MM_S: f64 = 1.0;
/// What is switched further than this from a place of the program was switched for another reason: below the least speed of a
/// beam, after a hold \[s\].
const ELSEWHERE_S: f64 = 0.005;

/// How exactly lines were switched on the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Switching {
    /// Switchings at places that the program has, in motion.
    pub places: u32,
    /// The largest time between the place and the switching, by the path that the board planned \[µs\].
    pub worst_us: f64,
    /// Gates that were switched elsewhere.
    pub elsewhere: u32,
}

/// Switchings of a run as they come.
#[derive(Debug)]
pub(super) struct Switchings<'p> {
    paths: &'p BTreeMap<u32, PlannedPath>,
    /// Of the path that is run: line, state, and where it comes to that \[mm\].
    programmed: Vec<(u8, bool, f64)>,
    before: Option<MotionSample>,
    found: Option<Switching>,
}

impl<'p> Switchings<'p> {
    pub(super) fn new(paths: &'p BTreeMap<u32, PlannedPath>) -> Self {
        Self {
            paths,
            programmed: Vec::new(),
            before: None,
            found: None,
        }
    }

    /// The next sample on a path.
    pub(super) fn add(&mut self, sample: &MotionSample) {
        let before = self.before.replace(*sample);
        let Some(before) = before.filter(|before| before.path_id == sample.path_id) else {
            self.programmed = self.paths.get(&sample.path_id).map_or_else(Vec::new, programmed);
            return;
        };
        if sample.tick != before.tick.wrapping_add(1) {
            return;
        }
        let speed = (sample.s_mm - before.s_mm) / PATH_PERIOD_S;
        for switched in sample.switched.iter() {
            if speed < LEAST_SPEED_MM_S {
                continue;
            }
            let s = before.s_mm + speed * f64::from(switched.at_us) * 1e-6;
            let same = self
                .programmed
                .iter()
                .filter(|(line, on, _)| (*line, *on) == (switched.line, switched.on));
            let off = same
                .map(|(.., place)| (s - place).abs() / speed)
                .min_by(f64::total_cmp);
            let found = self.found.get_or_insert_default();
            match off.filter(|off| *off < ELSEWHERE_S) {
                Some(off) => {
                    found.places += 1;
                    found.worst_us = found.worst_us.max(off * 1e6);
                }
                None => found.elsewhere += u32::from(usize::from(switched.line) < SIDES),
            }
        }
    }

    /// `None` if nothing was switched in motion.
    pub(super) fn all(self) -> Option<Switching> {
        self.found
    }
}

/// Where `path` switches its lines.
fn programmed(path: &PlannedPath) -> Vec<(u8, bool, f64)> {
    let events = path.given_legs().map_while(Result::ok).flat_map(|leg| leg.events);
    let lines = events.filter_map(|event| match event.action {
        PathAction::Beam { side, on } => Some((side, on, event.s_mm)),
        PathAction::Output { output, on } => Some((SIDES as u8 + output, on, event.s_mm)),
        _ => None,
    });
    lines.collect()
}
