//! A planned path as elements, as they are sent to the motion board.

use super::ahead::Ahead;
use super::blocks::{Blocks, Leg};
use super::smooth_legs::SmoothLegs;
use super::{PathError, PlannedPath};
use nc::Blend;
use shared::protocol::{PathEvent, PathLimits};
use shared::trajectory::{CHANNELS, Cubic, Element, Join, Knot, SHAPED, Shape, Tolerance};

/// What rounded corners, and the planner's output filter on curves, may take.
pub const TOLERANCE: Tolerance = Tolerance {
    position: Blend::DEFAULT_TOLERANCE_MM,
    attitude: 1e-4,
};

/// What the output filter may take of a curve at a path acceleration \[s²\], if no corner asks for less: makes it 20 ms long, somewhat
/// less than half the time in which the axes of the shipped machines come to their acceleration. Curves are cut by its square; half as much
/// slows programs down by some thousandths.
const FILTER: f64 = 6e-5;
/// A step of the speed this near to a knot is at it \[mm\].
pub(super) const SAME: f64 = 1e-6;

impl PlannedPath {
    /// All of the path as elements with their events, in order. The last element comes to rest.
    ///
    /// # Errors
    /// The program is not the one that was checked, so there are no more legs.
    pub fn legs(&self) -> Box<dyn Iterator<Item = Result<Leg, PathError>> + '_> {
        if let Some(blocks) = &self.blocks {
            return Box::new(blocks.legs());
        }
        let mut elements = self.elements().peekable();
        let mut events = self.events.iter().copied().peekable();
        let mut end_s = 0.0;
        Box::new(std::iter::from_fn(move || {
            let element = elements.next()?;
            end_s += element.length;
            let ends = elements.peek().is_none();
            let here = |event: &PathEvent| ends || event.s_mm < end_s - SAME;
            let events = std::iter::from_fn(|| events.next_if(here)).collect();
            Some(Ok(Leg { events, element }))
        }))
    }

    /// The knots as elements, in order: every span between two knots is one, or several where the speed steps inside
    /// it. The last one comes to rest.
    fn elements(&self) -> impl Iterator<Item = Element> + '_ {
        let length = self.length_mm();
        let spans = self.knots.windows(2).map(|span| (&span[0], &span[1]));
        spans.flat_map(move |(from, to)| {
            let inside = self.steps.iter().map(|step| step.s);
            let inside = inside.filter(|s| *s > from.s_mm + SAME && *s < to.s_mm - SAME);
            let mut ends: Vec<f64> = inside.chain([to.s_mm]).collect();
            ends.dedup_by(|a, b| *a - *b <= SAME);
            let starts: Vec<f64> = std::iter::once(from.s_mm).chain(ends.iter().copied()).collect();
            starts.into_iter().zip(ends).map(move |(start, end)| {
                let join = if end >= length {
                    Join::Stop
                } else {
                    Join::Blend(TOLERANCE)
                };
                self.element(from, to, start, end, join)
            })
        })
    }

    /// What the motion board is given of it: from where the machine begins, runs of short lines smoothed where the program
    /// allows it.
    ///
    /// # Errors
    /// As of [`Self::legs`].
    pub fn given_legs(&self) -> Box<dyn Iterator<Item = Result<Leg, PathError>> + '_> {
        match &self.blocks {
            Some(blocks) => Box::new(self.given_of(blocks)),
            None => self.given_blocks(),
        }
    }

    /// The same, of a long path some ahead on a thread of its own.
    ///
    /// # Errors
    /// As of [`Self::legs`].
    pub(crate) fn given_ahead(&self) -> Box<dyn Iterator<Item = Result<Leg, PathError>> + '_> {
        match &self.blocks {
            Some(blocks) => Box::new(Ahead::new(self.given_of(blocks))),
            None => self.given_blocks(),
        }
    }

    fn given_of(&self, blocks: &Blocks) -> impl Iterator<Item = Result<Leg, PathError>> + Send + use<> {
        let legs = self.beyond_start(blocks.smoothable());
        SmoothLegs::new(legs, self.start_s, self.limits.acceleration)
    }

    /// The same with every block as it is written: for single block.
    ///
    /// # Errors
    /// As of [`Self::legs`].
    pub fn given_blocks(&self) -> Box<dyn Iterator<Item = Result<Leg, PathError>> + '_> {
        let legs = self.legs().map(|leg| Ok((leg?, 0.0)));
        Box::new(self.beyond_start(legs).map(|leg| leg.map(|(leg, _)| leg)))
    }

    /// The `legs` from where the machine begins.
    fn beyond_start<I>(&self, legs: I) -> impl Iterator<Item = Result<(Leg, f64), PathError>> + use<I>
    where
        I: Iterator<Item = Result<(Leg, f64), PathError>>,
    {
        let (start_s, start_actions) = (self.start_s, self.start_actions.clone());
        let mut s = 0.0;
        let given = legs.skip_while(move |leg| {
            let before = s < start_s - SAME;
            s += leg.as_ref().map_or(0.0, |(leg, _)| leg.element.length);
            before && leg.is_ok()
        });
        given.enumerate().map(move |(index, leg)| {
            let (mut leg, smoothing) = leg?;
            if index == 0 && start_s > 0.0 {
                // What was where a line begins is no sooner than the machine is there.
                let here = leg.events.iter().map(|event| event.action);
                let actions = start_actions.iter().copied().chain(here);
                let s_mm = start_s;
                leg.events = actions.map(|action| PathEvent { s_mm, action }).collect();
            }
            Ok((leg, smoothing))
        })
    }

    /// Limits along the path, as the motion board takes them.
    pub fn path_limits(&self) -> PathLimits {
        // Curves are slowed down until they are within their tolerance: a filter that is made for another takes longer.
        let own = |blocks: &Blocks| blocks.summary().tolerance_mm.unwrap_or(TOLERANCE.position);
        let closest = self.blocks.as_ref().map(own);
        PathLimits {
            acceleration_mm_s2: self.limits.acceleration,
            jerk_mm_s3: self.limits.jerk,
            tolerance_mm: closest
                .unwrap_or(f64::INFINITY)
                .min(FILTER * self.limits.acceleration),
        }
    }

    /// The part from `start` to `end` \[mm\] of the span between two knots.
    fn element(&self, from: &Knot, to: &Knot, start: f64, end: f64, join: Join) -> Element {
        let channel = |i: usize| span(from, to, i).from(start - from.s_mm);
        Element {
            line: self.line_at(start + SAME),
            shape: Shape::Span(std::array::from_fn(channel)),
            rest: std::array::from_fn(|i| channel(SHAPED + i)),
            length: end - start,
            feed: self.speed_limit(start),
            join,
        }
    }

    /// Programmed speed from `s` on \[mm/s\].
    fn speed_limit(&self, s: f64) -> f64 {
        let before = self.steps.iter().take_while(|step| step.s <= s + SAME);
        before.last().map_or(self.limits.velocity, |step| step.velocity)
    }
}

fn span(from: &Knot, to: &Knot, channel: usize) -> Cubic {
    debug_assert!(channel < CHANNELS);
    let end = |knot: &Knot| [knot.value[channel], knot.slope[channel]];
    Cubic::hermite(end(from), end(to), to.s_mm - from.s_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::SpeedStep;
    use crate::path::shape;
    use nc::{Motion, SourcePosition};
    use shared::trajectory::PathSpace;

    /// A path of three spans whose speed steps at a knot, inside a span twice, and next to a knot.
    fn planned() -> PlannedPath {
        let knots: Vec<Knot> = [0.0, 3.0, 7.5, 10.0]
            .map(|s: f64| Knot {
                s_mm: s,
                value: std::array::from_fn(|i| (s * 0.1 * (i + 1) as f64).sin()),
                slope: std::array::from_fn(|i| 0.1 * (i + 1) as f64 * (s * 0.1 * (i + 1) as f64).cos()),
            })
            .to_vec();
        let shape = shape::Shape {
            knots,
            speed_error: 0.0,
            targets: [(4.0, 7), (10.0, 9)]
                .map(|(s, line)| shape::Goal::exact(s, SourcePosition { line, column: 1 }))
                .to_vec(),
        };
        let mut planned = PlannedPath::untimed(&shape, PathSpace::Tool, Motion::Feed);
        planned.limits.velocity = 40.0;
        for (s, velocity) in [(3.0, 30.0), (4.0, 20.0), (6.0, 10.0), (7.5 + 1e-9, 50.0)] {
            planned.steps.push(SpeedStep { s, velocity });
        }
        planned
    }

    #[test]
    fn elements_are_the_path_and_change_their_feed_where_the_speed_steps() {
        let planned = planned();
        let (path, elements) = (planned.path(), planned.elements().collect::<Vec<_>>());
        let feeds: Vec<f64> = elements.iter().map(|element| element.feed).collect();
        assert_eq!(feeds, [40.0, 30.0, 20.0, 10.0, 50.0]);
        let lines: Vec<u32> = elements.iter().map(|element| element.line).collect();
        assert_eq!(lines, [7, 7, 9, 9, 9]);
        let mut s = 0.0;
        for element in &elements {
            for part in [0.0, 0.3, 0.7, 1.0] {
                let point = element.at(part * element.length);
                let wanted = path.at(s + part * element.length).unwrap();
                for i in 0..CHANNELS {
                    assert!(
                        (point.value[i] - wanted.value[i]).abs() < 1e-13,
                        "channel {i} at {s}"
                    );
                    assert!(
                        (point.first[i] - wanted.first[i]).abs() < 1e-12,
                        "channel {i} at {s}"
                    );
                }
            }
            s += element.length;
        }
        assert!((s - 10.0).abs() < 1e-12);
        let stops: Vec<bool> = elements.iter().map(|e| e.join == Join::Stop).collect();
        assert_eq!(stops, [false, false, false, false, true]);
    }
}
