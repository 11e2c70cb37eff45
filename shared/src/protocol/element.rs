//! Elements of a path on the wire, and their conversion for the motion board.

use crate::geometry::{Arc, Line, Turn};
use crate::trajectory::{
    ArcLengthCurve, CHANNELS, Cubic, CurveNumbers, Element, Join, SHAPED, Shape, Tolerance,
};
use nalgebra::Vector3;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Lengths of an element and of its shape may differ by this much \[mm\], or by this part.
const SAME_LENGTH: f64 = 1e-9;

/// A piece of path between two junctions: an [`Element`] in plain numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct PathElement {
    /// Line of the program that it comes from.
    pub line: u32,
    /// Position of D, or axes X Y Z \[mm\].
    pub shape: PathShape,
    /// Channels 3 and on: T (3), N (3) and the V slide extensions (2) \[mm\], or axes A B C \[rad\] and nothing (5).
    pub rest: [PathChannel; CHANNELS - SHAPED],
    /// Path length \[mm\].
    pub length_mm: f64,
    /// Highest speed along it \[mm/s\].
    pub feed_mm_s: f64,
    /// How it joins the next one.
    pub join: PathJoin,
}

/// Geometry of the first channels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum PathShape {
    /// The position stands.
    Point([f64; SHAPED]),
    /// Straight.
    Line {
        /// Where it begins.
        start: [f64; SHAPED],
        /// Where it ends.
        end: [f64; SHAPED],
    },
    /// Arc or helix, counter-clockwise about its axis.
    Arc {
        /// Where it begins.
        start: [f64; SHAPED],
        /// Where it ends; a full turn ends where it begins, or a pitch away.
        end: [f64; SHAPED],
        /// A point of the axis.
        centre: [f64; SHAPED],
        /// Direction of the axis.
        axis: [f64; SHAPED],
        /// Full turns beyond the first time it comes to its end.
        turns: u32,
    },
    /// A span of a spline.
    Span([PathChannel; SHAPED]),
    /// A piece of a NURBS.
    Curve(CurveNumbers),
}

/// One channel: coefficients over path length from the start of the element.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum PathChannel {
    /// c₀.
    Constant(f64),
    /// c₀, c₁.
    Linear([f64; 2]),
    /// c₀, c₁, c₂, c₃.
    Cubic([f64; 4]),
}

/// What happens where an element ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum PathJoin {
    /// Rest, exactly at the end.
    Stop,
    /// The path continues, and a corner is rounded.
    Blend {
        /// By at most this much in position \[mm\].
        position_mm: f64,
        /// By at most this much in each channel of attitude \[rad\].
        attitude_rad: f64,
    },
}

/// The numbers of an element are no piece of path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("line {line}: the element is not a line, arc or curve of its length, or its tolerance is not valid")]
pub struct BadElement {
    /// Line of the program.
    pub line: u32,
}

impl PathElement {
    /// The element that the planner takes; it checks the rest.
    pub fn build(&self) -> Result<Element, BadElement> {
        let bad = BadElement { line: self.line };
        let same_length = |length: f64| {
            let off = libm::fabs(length - self.length_mm);
            off <= SAME_LENGTH * libm::fmax(1.0, self.length_mm)
        };
        let (shape, length) = match &self.shape {
            PathShape::Point(position) => (Shape::Point(*position), self.length_mm),
            PathShape::Span(channels) => {
                let cubics = core::array::from_fn(|i| channels[i].cubic());
                (Shape::Span(cubics), self.length_mm)
            }
            PathShape::Line { start, end } => {
                let line = Line::new(Vector3::from(*start), Vector3::from(*end)).map_err(|_| bad)?;
                (Shape::Line(line), line.length())
            }
            PathShape::Arc {
                start,
                end,
                centre,
                axis,
                turns,
            } => {
                let [start, end, centre, axis] = [start, end, centre, axis].map(|v| Vector3::from(*v));
                let arc = Arc::with_turns(start, end, centre, axis, Turn::CounterClockwise, *turns);
                let arc = arc.map_err(|_| bad)?;
                (Shape::Arc(arc), arc.length())
            }
            PathShape::Curve(numbers) => {
                let curve = ArcLengthCurve::try_from(numbers).map_err(|_| bad)?;
                (Shape::Curve(curve), curve.length())
            }
        };
        if !same_length(length) {
            return Err(bad);
        }
        Ok(Element {
            line: self.line,
            shape,
            rest: core::array::from_fn(|i| self.rest[i].cubic()),
            length: self.length_mm,
            feed: self.feed_mm_s,
            join: self.join.build().ok_or(bad)?,
        })
    }
}

impl From<&Element> for PathElement {
    fn from(element: &Element) -> Self {
        let shape = match &element.shape {
            Shape::Point(position) => PathShape::Point(*position),
            Shape::Line(line) => PathShape::Line {
                start: line.start().into(),
                end: line.end().into(),
            },
            Shape::Arc(arc) => PathShape::Arc {
                start: arc.start().into(),
                end: arc.end().into(),
                centre: arc.centre().into(),
                axis: arc.axis().into(),
                turns: arc.more_turns(),
            },
            Shape::Span(cubics) => PathShape::Span(cubics.map(PathChannel::from)),
            Shape::Curve(curve) => PathShape::Curve(CurveNumbers::from(curve)),
        };
        Self {
            line: element.line,
            shape,
            rest: element.rest.map(PathChannel::from),
            length_mm: element.length,
            feed_mm_s: element.feed,
            join: match element.join {
                Join::Stop => PathJoin::Stop,
                Join::Blend(tolerance) => PathJoin::Blend {
                    position_mm: tolerance.position,
                    attitude_rad: tolerance.attitude,
                },
            },
        }
    }
}

impl PathChannel {
    fn cubic(self) -> Cubic {
        match self {
            Self::Constant(c0) => Cubic::constant(c0),
            Self::Linear([c0, c1]) => Cubic([c0, c1, 0.0, 0.0]),
            Self::Cubic(coefficients) => Cubic(coefficients),
        }
    }
}

impl From<Cubic> for PathChannel {
    fn from(cubic: Cubic) -> Self {
        match cubic.0 {
            [c0, 0.0, 0.0, 0.0] => Self::Constant(c0),
            [c0, c1, 0.0, 0.0] => Self::Linear([c0, c1]),
            coefficients => Self::Cubic(coefficients),
        }
    }
}

impl PathJoin {
    fn build(self) -> Option<Join> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        match self {
            Self::Stop => Some(Join::Stop),
            Self::Blend {
                position_mm,
                attitude_rad,
            } => (positive(position_mm) && positive(attitude_rad)).then_some(Join::Blend(Tolerance {
                position: position_mm,
                attitude: attitude_rad,
            })),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::protocol::framing::{MAX_MESSAGE, encode_message};
    use crate::protocol::{LOAD_ELEMENTS, Request};
    use crate::trajectory::curve;
    use std::vec::Vec;

    fn element(shape: Shape, length: f64) -> Element {
        let rest = core::array::from_fn(|i| match i % 3 {
            0 => Cubic::constant(0.3),
            1 => Cubic::linear(0.1, 0.7, length),
            _ => Cubic([0.1, 0.2, 0.3, 0.4]),
        });
        Element {
            line: 70_000,
            shape,
            rest,
            length,
            feed: 80.0,
            join: Join::Blend(Tolerance {
                position: 0.05,
                attitude: 0.001,
            }),
        }
    }

    /// One of every shape.
    fn elements() -> Vec<Element> {
        let v = Vector3::new;
        let line = Line::new(v(1.0, 2.0, 3.0), v(4.0, -5.0, 6.5)).unwrap();
        let arc = |end, turn, more| {
            let (start, centre, axis) = (v(10.0, 0.0, 1.0), v(0.0, 0.0, 0.0), v(0.1, 0.0, 1.0));
            Arc::with_turns(start, end, centre, axis, turn, more).unwrap()
        };
        let axis = v(0.1, 0.0, 1.0).normalize();
        let full = v(10.0, 0.0, 1.0) + axis * 2.0;
        let curve = curve::tests::arc();
        let cubics = [
            Cubic([1.0, 2.0, 3.0, 4.0]),
            Cubic::constant(1.0),
            Cubic::linear(0.0, 2.0, 5.0),
        ];
        let mut elements = std::vec![
            element(Shape::Point([1.0, 2.0, 3.0]), 5.0),
            element(Shape::Line(line), line.length()),
            element(Shape::Span(cubics), 5.0),
            element(Shape::Curve(curve), curve.length()),
        ];
        let (once, often) = (
            arc(full, Turn::CounterClockwise, 0),
            arc(full, Turn::Clockwise, 3),
        );
        for arc in [once, often] {
            elements.push(element(Shape::Arc(arc), arc.length()));
        }
        elements.last_mut().unwrap().join = Join::Stop;
        elements
    }

    /// A degree of 0 has no highest term, and a curve that is not as long as it says would be a jump of speed.
    #[test]
    fn numbers_that_are_no_curve_are_refused() {
        let all = elements();
        let curve = all
            .iter()
            .find(|element| matches!(element.shape, Shape::Curve(_)));
        let sent = PathElement::from(curve.unwrap());
        let mut buffer = [0; 1024];
        let length = postcard::to_slice(&sent, &mut buffer).unwrap().len();
        // Line, which shape, middle: then the number of terms of four numbers each.
        let line = postcard::to_slice(&sent.line, &mut [0; 8]).unwrap().len();
        let at = line + 1 + 3 * 8;
        assert_eq!(buffer[at], 2);
        let mut none = [0; 1024];
        none[..at].copy_from_slice(&buffer[..at]);
        none[at + 1..length - 64].copy_from_slice(&buffer[at + 1 + 64..length]);
        let none: PathElement = postcard::from_bytes(&none).unwrap();
        assert_eq!(none.build(), Err(BadElement { line: sent.line }));
        for bad in [f64::NAN, f64::INFINITY, 1e300, 0.0] {
            let mut wrong = buffer;
            wrong[at + 1..at + 9].copy_from_slice(&bad.to_le_bytes());
            let wrong: PathElement = postcard::from_bytes(&wrong).unwrap();
            assert_eq!(wrong.build(), Err(BadElement { line: sent.line }), "{bad}");
        }
    }

    #[test]
    fn elements_come_through_the_wire_as_they_are() {
        for element in elements() {
            let sent = PathElement::from(&element);
            let mut buffer = [0; 1024];
            let bytes = postcard::to_slice(&sent, &mut buffer).unwrap();
            let received: PathElement = postcard::from_bytes(bytes).unwrap();
            assert_eq!(received, sent);
            let built = received.build().unwrap();
            for part in [0.0, 0.25, 0.5, 1.0] {
                let (was, is) = (element.at(part * element.length), built.at(part * element.length));
                for i in 0..CHANNELS {
                    assert!((was.value[i] - is.value[i]).abs() < 1e-12, "{:?}", element.shape);
                    assert!((was.first[i] - is.first[i]).abs() < 1e-12, "{:?}", element.shape);
                }
            }
            assert_eq!(
                (built.line, built.feed, built.join),
                (element.line, element.feed, element.join)
            );
        }
    }

    #[test]
    fn a_full_batch_of_the_largest_elements_fits_a_message() {
        let largest = elements().into_iter().map(|mut element| {
            element.rest = [Cubic([0.1, 0.2, 0.3, 0.4]); CHANNELS - SHAPED];
            PathElement::from(&element)
        });
        for element in largest {
            let elements = core::iter::repeat_n(element, LOAD_ELEMENTS).collect();
            let request = Request::LoadElements { elements, last: true };
            encode_message(&request, &mut [0; MAX_MESSAGE + 2]).unwrap();
        }
    }

    #[test]
    fn what_is_no_piece_of_path_is_refused_with_its_line() {
        let good: Vec<PathElement> = elements().iter().map(PathElement::from).collect();
        let change = |i: usize, change: fn(&mut PathElement)| {
            let mut element = good[i].clone();
            change(&mut element);
            element.build()
        };
        let none = PathJoin::Blend {
            position_mm: 0.0,
            attitude_rad: 0.1,
        };
        assert!(none.build().is_none());
        for refused in [
            change(1, |line| line.length_mm += 1e-3),
            change(1, |line| {
                line.shape = PathShape::Line {
                    start: [1.0; 3],
                    end: [1.0; 3],
                }
            }),
            change(4, |arc| arc.length_mm = f64::NAN),
            change(3, |curve| curve.length_mm *= 2.0),
            change(2, |span| {
                span.join = PathJoin::Blend {
                    position_mm: 0.1,
                    attitude_rad: f64::NAN,
                }
            }),
        ] {
            assert_eq!(refused, Err(BadElement { line: 70_000 }));
        }
    }
}
