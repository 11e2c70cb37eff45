//! The way of the tip beside a seam: what it does aside, as NURBS of the program.

use super::WeldError;
use super::seam::Seam;
use super::weave::Stretch;
use crate::path::{PathError, Tip};
use nalgebra::Vector3;
use nc::{ControlPoint, FeedRate, NurbsWay, PathControl, Target, Way, Words};
use shared::io::AXES;

/// A cubic may be off the way by so much \[mm\].
const TOLERANCE_MM: f64 = 1e-3;
/// Most cubics of a stretch; more than enough for half a period or a block.
const MOST_CUBICS: usize = 256;
/// Step of differences along the seam \[mm\].
const STEP_MM: f64 = 1e-3;
/// Parts of a stretch in which its length is taken: an even number.
const LENGTH_PARTS: usize = 64;

/// The way beside `seam`, offset by so much to the left and away from the work \[mm\].
pub(super) struct Aside<'p> {
    pub(super) seam: Seam<'p>,
    pub(super) offset: [f64; 2],
}

impl Aside<'_> {
    /// Where the tip is at `s` of the seam, `stretch` being gone over, and its derivative over s.
    fn at(&self, stretch: &Stretch, s: f64) -> [Vector3<f64>; 2] {
        let (from, to) = (
            (s - STEP_MM).max(stretch.seam[0]),
            (s + STEP_MM).min(stretch.seam[1]),
        );
        let position = |s: f64| {
            let at = self.seam.at(s);
            let [left, away] = self.offset;
            at.pose.position + at.left() * (left + stretch.at(s)[0]) + at.pose.normal * away
        };
        [position(s), (position(to) - position(from)) / (to - from)]
    }

    /// Cubics over `stretch` as Bézier points, the last of one being the first of the next, near enough.
    fn cubics(&self, stretch: &Stretch) -> Vec<Vector3<f64>> {
        let [from, to] = stretch.seam;
        let mut count = 1;
        loop {
            let step = (to - from) / count as f64;
            let nodes: Vec<_> = (0..=count)
                .map(|i| self.at(stretch, if i == count { to } else { from + step * i as f64 }))
                .collect();
            let mut points = vec![nodes[0][0]];
            let mut off: f64 = 0.0;
            for (i, pair) in nodes.windows(2).enumerate() {
                let [[p, u], [q, v]] = [pair[0], pair[1]];
                let (second, third) = (p + u * (step / 3.0), q - v * (step / 3.0));
                for t in [0.25, 0.5, 0.75] {
                    let r = 1.0 - t;
                    let cubic = p * (r * r * r) + (second * r + third * t) * (3.0 * r * t) + q * (t * t * t);
                    let wanted = self.at(stretch, from + step * (i as f64 + t))[0];
                    off = off.max((cubic - wanted).norm());
                }
                points.extend([second, third, q]);
            }
            if off <= TOLERANCE_MM || count >= MOST_CUBICS {
                return points;
            }
            count *= 2;
        }
    }

    /// Length of the way over `stretch`, up to place `to` of the seam \[mm\].
    pub(super) fn length(&self, stretch: &Stretch, to: f64) -> f64 {
        let from = stretch.seam[0];
        let step = (to - from) / LENGTH_PARTS as f64;
        // Simpson's rule.
        let weighed = (0..=LENGTH_PARTS).map(|i| {
            let weight = match i {
                0 | LENGTH_PARTS => 1.0,
                _ if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * self.at(stretch, from + step * i as f64)[1].norm()
        });
        weighed.sum::<f64>() * step / 3.0
    }

    /// The motion over `stretch`, whose seam is gone at `speed` \[mm/s\], at the end of which the axes stand at `axes` (mm,
    /// rad): from where they stand before. It is followed as `like` is.
    pub(super) fn target(
        &self,
        stretch: &Stretch,
        speed: f64,
        axes: &mut [f64; AXES],
        like: &Target,
    ) -> Result<Target, PathError> {
        let place = like.place;
        let points = self.cubics(stretch);
        let end = points[points.len() - 1];
        let at = self.seam.at(stretch.seam[1]);
        let tip = self.seam.tip(&at, end, axes).ok_or_else(|| WeldError::Reach {
            place,
            s: stretch.seam[1],
        })?;
        let longer = self.length(stretch, stretch.seam[1]) / (stretch.seam[1] - stretch.seam[0]);
        let cubics = (points.len() - 1) / 3;
        let knots = (0..=cubics).flat_map(|i| {
            let times = if i == 0 || i == cubics { 4 } else { 3 };
            std::iter::repeat_n(i as f64, times)
        });
        let control = |point: &Vector3<f64>| ControlPoint {
            position: [Some(point.x), Some(point.y), Some(point.z)],
            weight: 1.0,
            place,
        };
        Ok(Target {
            way: Way::Nurbs(Box::new(NurbsWay {
                order: 4,
                points: points.iter().map(control).collect(),
                knots: knots.collect(),
            })),
            words: self.words(&tip),
            feed: Some(FeedRate::PerMinute(60.0 * speed * longer)),
            control: like.control,
            place,
        })
    }

    /// A straight motion from the seam to the way beside it at `s`, or back.
    pub(super) fn transfer(
        &self,
        s: f64,
        offset: [f64; 2],
        speed: f64,
        axes: &mut [f64; AXES],
        like: &Target,
    ) -> Result<Target, PathError> {
        let at = self.seam.at(s);
        let position = at.pose.position + at.left() * offset[0] + at.pose.normal * offset[1];
        let place = like.place;
        let tip = self.seam.tip(&at, position, axes);
        let tip = tip.ok_or(WeldError::Reach { place, s })?;
        Ok(Target {
            way: Way::Line,
            words: self.words(&tip),
            feed: Some(FeedRate::PerMinute(60.0 * speed)),
            control: PathControl::ExactStop,
            place,
        })
    }

    /// The words that lead to `tip`.
    fn words(&self, tip: &Tip) -> Words {
        let mut words = Words::default();
        for i in 0..3 {
            words.axes[i] = Some(tip.position_mm[i]);
            words.axes[3 + i] = self.seam.planner.fitted[3 + i].then_some(tip.angles_deg[i]);
        }
        words
    }
}
