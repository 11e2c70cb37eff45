//! The contour: lines and arcs that touch, with the heading over the length (mathematics 4.2, 4.3).

use super::error::StirError;
use nalgebra::Vector3;
use serde::Deserialize;
use shared::geometry::{Arc, Line, Turn};
use shared::units::wrap;

/// Largest corner between two segments \[°\]: half of what the heading of a weld may be off. Coordinates with three
/// decimals stay below on segments above 10 mm.
const MAX_CORNER: f64 = 0.01;

/// One segment as the part file has it.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SegmentEntry {
    /// End of a line \[mm\].
    pub line_to: Option<[f64; 2]>,
    /// End of an arc \[mm\]; a full circle if it is the start.
    pub arc_to: Option<[f64; 2]>,
    /// Centre of the arc \[mm\].
    pub centre: Option<[f64; 2]>,
    /// Sense of the arc, seen from above.
    pub turn: Option<TurnEntry>,
}

/// Sense of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TurnEntry {
    /// Counter-clockwise, G3.
    Ccw,
    /// Clockwise, G2.
    Cw,
}

/// A segment of the contour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Its form.
    pub form: Form,
    /// Length of the contour before it \[mm\].
    pub start_s: f64,
    /// Heading at its start, without jumps along the contour \[rad\].
    pub heading: f64,
    /// By how much the heading turns over its length, positive to the left \[rad\].
    pub turn: f64,
}

/// Form of a segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Straight.
    Line(Line),
    /// About a vertical axis.
    Arc(Arc),
}

/// Lines and arcs that touch, at the height of the pin's tip.
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    segments: Vec<Segment>,
}

impl Segment {
    /// Length \[mm\].
    pub fn length(&self) -> f64 {
        match &self.form {
            Form::Line(line) => line.length(),
            Form::Arc(arc) => arc.length(),
        }
    }

    /// Length of the contour up to its end \[mm\].
    pub fn end_s(&self) -> f64 {
        self.start_s + self.length()
    }

    /// Heading at its end \[rad\].
    pub fn end_heading(&self) -> f64 {
        self.heading + self.turn
    }

    /// Curvature, positive to the left \[1/mm\].
    pub fn curvature(&self) -> f64 {
        self.turn / self.length()
    }

    /// Point and heading a length `u` from its start.
    fn at(&self, u: f64) -> (Vector3<f64>, f64) {
        let point = match &self.form {
            Form::Line(line) => line.at(u).value,
            Form::Arc(arc) => arc.at(u).value,
        };
        (point, self.heading + self.turn * (u / self.length()))
    }

    /// Length from its start to its place nearest to `point`, from `low` to `high`.
    fn nearest(&self, point: &Vector3<f64>, low: f64, high: f64) -> f64 {
        match &self.form {
            Form::Line(line) => (point - line.start()).dot(&line.tangent()).clamp(low, high),
            Form::Arc(arc) => {
                // Counted from the middle of the part in question, the nearer end follows by clamping.
                let (per_mm, middle) = (arc.sweep() / arc.length(), (low + high) / 2.0);
                let off = wrap(arc.angle_of(point) - middle * per_mm) / per_mm;
                (middle + off).clamp(low, high)
            }
        }
    }
}

impl Contour {
    /// The contour from `start` through `entries` at the height `z` \[mm\].
    pub fn build(start: [f64; 2], entries: &[SegmentEntry], z: f64) -> Result<Self, StirError> {
        let mut segments: Vec<Segment> = Vec::with_capacity(entries.len());
        let mut from = Vector3::new(start[0], start[1], z);
        for (index, entry) in entries.iter().enumerate() {
            let number = index + 1;
            let (form, direction, turn) = entry.form(from, number)?;
            let (start_s, heading) = match segments.last() {
                None => (0.0, direction),
                Some(before) => {
                    let corner = wrap(direction - before.end_heading());
                    if corner.abs().to_degrees() > MAX_CORNER {
                        return Err(StirError::Corner {
                            segment: number,
                            degrees: corner.to_degrees(),
                            limit_deg: MAX_CORNER,
                        });
                    }
                    (before.end_s(), before.end_heading() + corner)
                }
            };
            from = match &form {
                Form::Line(line) => line.end(),
                Form::Arc(arc) => arc.end(),
            };
            segments.push(Segment {
                form,
                start_s,
                heading,
                turn,
            });
        }
        if segments.is_empty() {
            return Err(StirError::NoSegments);
        }
        Ok(Self { segments })
    }

    /// The segments in their order.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Length \[mm\].
    pub fn length(&self) -> f64 {
        self.segments.last().map_or(0.0, Segment::end_s)
    }

    /// Index of the segment at `s`; at a join the one before it.
    pub fn segment_at(&self, s: f64) -> usize {
        let index = self.segments.partition_point(|segment| segment.end_s() < s);
        index.min(self.segments.len() - 1)
    }

    /// Point \[mm\] and heading \[rad\] after the length `s` \[mm\]; the heading has no jumps.
    pub fn at(&self, s: f64) -> (Vector3<f64>, f64) {
        let segment = &self.segments[self.segment_at(s)];
        segment.at((s - segment.start_s).clamp(0.0, segment.length()))
    }

    /// Length up to the place nearest to `point`, not further than `reach` from `s` \[mm\]: a contour may come
    /// back to where it was.
    pub fn nearest(&self, point: &Vector3<f64>, s: f64, reach: f64) -> f64 {
        let (low, high) = (s - reach, s + reach);
        let near = |segment: &&Segment| segment.end_s() >= low && segment.start_s <= high;
        let places = self.segments.iter().filter(near).map(|segment| {
            let part = |s: f64| (s - segment.start_s).clamp(0.0, segment.length());
            let u = segment.nearest(point, part(low), part(high));
            (segment.start_s + u, (segment.at(u).0 - point).norm())
        });
        places
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(s.clamp(0.0, self.length()), |(s, _)| s)
    }

    /// Least and largest X and Y of a segment \[mm\].
    pub fn bounds(segment: &Segment) -> [[f64; 2]; 2] {
        let ends = [0.0, segment.length()].map(|u| segment.at(u).0);
        let mut bounds = [0, 1].map(|i| [ends[0][i].min(ends[1][i]), ends[0][i].max(ends[1][i])]);
        if let Form::Arc(arc) = &segment.form {
            for (i, direction) in [Vector3::x(), Vector3::y()].into_iter().enumerate() {
                for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
                    let furthest = arc.centre() + direction * (sign * arc.radius());
                    if arc.angle_of(&furthest) <= arc.sweep() {
                        bounds[i][side] = furthest[i];
                    }
                }
            }
        }
        bounds
    }
}

impl SegmentEntry {
    /// Form, direction at the start and turn of the segment from `from` on.
    fn form(&self, from: Vector3<f64>, segment: usize) -> Result<(Form, f64, f64), StirError> {
        let at = |[x, y]: [f64; 2]| Vector3::new(x, y, from.z);
        match (self.line_to, self.arc_to, self.centre, self.turn) {
            (Some(end), None, None, None) => {
                let line = Line::new(from, at(end)).map_err(|source| StirError::Line { segment, source })?;
                let tangent = line.tangent();
                Ok((Form::Line(line), libm::atan2(tangent.y, tangent.x), 0.0))
            }
            (None, Some(end), Some(centre), Some(turn)) => {
                let turn = match turn {
                    TurnEntry::Ccw => Turn::CounterClockwise,
                    TurnEntry::Cw => Turn::Clockwise,
                };
                let arc = Arc::about_centre(from, at(end), at(centre), Vector3::z(), turn)
                    .map_err(|source| StirError::Arc { segment, source })?;
                let first = arc.axis().cross(&(from - arc.centre()));
                let direction = libm::atan2(first.y, first.x);
                Ok((Form::Arc(arc), direction, arc.signed_sweep(&Vector3::z())))
            }
            _ => Err(StirError::Form { segment }),
        }
    }
}
