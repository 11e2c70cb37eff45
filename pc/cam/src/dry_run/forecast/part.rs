//! Parts of elements.

use crate::path::part_of_arc;
use shared::geometry::Line;
use shared::trajectory::{Cubic, Element, Join, SHAPED, Shape};

/// A part of a curve that is as short as this share of it is a cubic.
const SHORT: f64 = 1.0 / 16.0;

/// Whether there are parts of `element` at its ends that are as long \[mm\].
pub(super) fn has_parts(element: &Element, length: f64) -> bool {
    !matches!(element.shape, Shape::Curve(_)) || length <= SHORT * element.length
}

/// `element` from one place to another \[mm\], if that can be had.
pub(super) fn part(element: &Element, from: f64, to: f64, join: Join) -> Option<Element> {
    let length = to - from;
    let shape = match &element.shape {
        Shape::Point(place) => Shape::Point(*place),
        Shape::Line(line) => Shape::Line(Line::new(line.at(from).value, line.at(to).value).ok()?),
        Shape::Arc(arc) => Shape::Arc(part_of_arc(arc, from, to, element.length).ok()?),
        Shape::Span(cubics) => Shape::Span(cubics.map(|cubic| cubic.from(from))),
        Shape::Curve(_) if !has_parts(element, length) => return None,
        Shape::Curve(curve) => {
            let [start, end] = [from, to].map(|s| curve.at(s));
            let cubic = |i: usize| {
                let [start, end] = [&start, &end].map(|at| [at.value[i], at.first[i]]);
                Cubic::hermite(start, end, length)
            };
            let cubics: [Cubic; SHAPED] = std::array::from_fn(cubic);
            Shape::Span(cubics)
        }
    };
    Some(Element {
        line: element.line,
        shape,
        rest: element.rest.map(|cubic| cubic.from(from)),
        length,
        feed: element.feed,
        join,
    })
}
