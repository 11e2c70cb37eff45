//! Where each beam goes on and off: where its own seam begins and ends, if that was taught.

use super::{PlanError, PlannedPoint};
use crate::taught::Marked;

/// Places that are nearer are one \[mm\]: what the cameras see of an end scatters by that.
const SAME: f64 = 0.01;
/// Steps to where a seam ends.
const STEPS: usize = 4;

/// Lengths along seam 1, below 0 on the run before it and beyond its end on the run after it \[mm\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Places {
    /// Where each beam goes on and off.
    pub beams: [[f64; 2]; 2],
    /// Of seam 1.
    length: f64,
    /// Where the last of the seams begins that were seen to begin.
    begins: Option<f64>,
}

impl Places {
    /// Of seams of these lengths; `sigma_at` gives the place of seam 2 that belongs to one of seam 1.
    pub fn of(
        marked: Marked,
        [length, other]: [f64; 2],
        sigma_at: impl Fn(f64) -> Result<f64, PlanError>,
    ) -> Result<Self, PlanError> {
        let mut beams = [[0.0, length]; 2];
        // Beam 1 is at its own ends there: the points of seam 1 are.
        for (k, is_marked, from, sigma) in [
            (0, marked.begins[1], 0.0, 0.0),
            (1, marked.ends[1], length, other),
        ] {
            if !is_marked {
                continue;
            }
            let mut at: f64 = from;
            for _ in 0..STEPS {
                // On the runs both go straight on.
                at += sigma - sigma_at(at.clamp(0.0, length))? - (at - at.clamp(0.0, length));
            }
            if (at - from).abs() > SAME {
                beams[1][k] = at;
            }
        }
        let begins = marked.begins.iter().zip(beams).filter(|(marked, _)| **marked);
        Ok(Self {
            beams,
            length,
            begins: begins.map(|(_, [on, _])| on).reduce(f64::max),
        })
    }

    /// The places of seam 1, with those where a beam goes on or off between them.
    pub fn within(&self, mut places: Vec<f64>) -> Vec<f64> {
        for at in self.beams.into_iter().flatten() {
            let is_near = |place: &f64| (place - at).abs() < SAME;
            if (0.0..self.length).contains(&at) && !places.iter().any(is_near) {
                places.push(at);
            }
        }
        places.sort_by(f64::total_cmp);
        places
    }

    /// Where tracking goes on of a seam that was seen to begin, if one was: before that there is nothing to be seen, and nothing is to
    /// be looked for. The cameras look `lead` mm ahead, and know where the seam is `sight` mm after its beginning.
    pub fn first_seen(&self, lead: f64, sight: f64) -> Option<f64> {
        Some(self.begins? - (lead - sight).max(0.0))
    }

    /// Puts the places that are not on seam 1 into the runs before and after it; `tracks` is that where tracking goes on.
    pub fn insert(
        &self,
        line: &mut Vec<(f64, PlannedPoint)>,
        tracks: f64,
        on_run: impl Fn(f64) -> PlannedPoint,
    ) {
        for at in self.beams.into_iter().flatten().chain([tracks]) {
            let is_near = |(place, _): &(f64, PlannedPoint)| (place - at).abs() < SAME;
            if !(0.0..=self.length).contains(&at) && !line.iter().any(is_near) {
                line.push((at, on_run(at)));
            }
        }
        line.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    }
}
