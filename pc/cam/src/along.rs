//! One path length through all paths of a job: that of its plots, its log and its messages.

use crate::path::PlannedPath;
use nc::Motion;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Path length through all paths that work, counted from where the first beam goes on; without beams, from where the
/// first such path begins. Before the first beam it is negative, as of the deviations in a seam file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Along {
    /// Where each of them begins \[mm\].
    begins_mm: BTreeMap<u32, f64>,
}

/// Whether a path is one that works: a feed, but none with a probe, or with a beam.
pub fn works(path: &PlannedPath) -> bool {
    path.weld().is_some() || path.motion == Motion::Feed && path.probe.is_none()
}

impl Along {
    /// Through `paths`, by their numbers.
    pub fn of(paths: &BTreeMap<u32, PlannedPath>) -> Self {
        let chosen = || paths.iter().filter(|(_, path)| works(path));
        // Up to the first beam it counts backwards.
        let mut before = 0.0;
        let mut any_beam = false;
        for (_, path) in chosen() {
            if let Some((start, _)) = path.weld() {
                before += start;
                any_beam = true;
                break;
            }
            before += path.length_mm();
        }
        let mut along_mm = if any_beam { -before } else { 0.0 };
        let begins_mm = chosen().map(|(id, path)| {
            let begins = along_mm;
            along_mm += path.length_mm();
            (*id, begins)
        });
        Self {
            begins_mm: begins_mm.collect(),
        }
    }

    /// Of the place `s_mm` of path `id` \[mm\]; `None` of a path that does not work.
    pub fn at(&self, id: u32, s_mm: f64) -> Option<f64> {
        Some(self.begins_mm.get(&id)? + s_mm)
    }
}
