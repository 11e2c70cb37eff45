//! The elements in the queue, with their corners rounded: where the tool is at path length s.

use super::channels::{SAME, SMOOTH, position_norm};
use super::corner::Corner;
use crate::trajectory::{CHANNELS, Cubic, Element, Join, PathPoint, SHAPED, Shape};
use nalgebra::Vector3;
use thiserror::Error;

/// Channels of two elements that meet may differ by this much (mm, rad).
const GAP: f64 = 1e-5;
/// No path is longer than this \[mm\], 1000 km, and no channel farther from 0: single micrometres are still
/// resolved there.
pub const LONGEST: f64 = 1e9;
/// No channel changes by more than this for each mm of path length: a turn of some degrees about a tip that stands may be
/// a short path.
const STEEPEST: f64 = 1e6;
/// Highest feed \[mm/s\], and one divided by the lowest: beyond them the squares cannot be resolved in single precision.
const FASTEST: f64 = 1e6;
/// Elements that are kept behind the one that the machine is on.
pub(super) const REACH: u32 = 8;

/// An element in the queue, with the corner where it begins.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub element: Element,
    /// Path length where it begins \[mm\].
    pub start: f64,
    /// The first channels there, but for its corner \[mm\].
    pub place: Vector3<f64>,
    /// The corner there.
    pub corner: Corner,
    /// The machine comes to rest there.
    pub stop: bool,
    /// Change of the programmed direction there, of the first channels.
    pub turn: Vector3<f64>,
    /// By how much its direction turns in all; infinite where the rates of other channels change.
    pub bend: f64,
    /// But for its corner, neither the bend of the path nor the feed changes where it begins.
    pub even: bool,
    /// It is a line.
    pub straight: bool,
    /// It begins at a corner that was moved, as a chain of lines allows.
    pub chained: bool,
    /// How far the corner at its end reaches into it \[mm\].
    end_half: f64,
}

/// Why an element was not taken; the planner is as before.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum PushError {
    /// No room for another element now; there will be when some have been passed.
    #[error("the planner is full; send the element again when it has room")]
    Full,
    /// Length or feed is not above zero, a number is not finite, or one is out of all proportion: a path of more than
    /// 1000 km, a feed above 1 km/s or below 1 nm/s, a channel that changes by more than 10⁶ for each mm.
    #[error(
        "line {line}: the element has no length, no feed, or a number that is not finite or far too large"
    )]
    Unsound {
        /// Line of the program.
        line: u32,
    },
    /// It does not begin where the one before it ends.
    #[error("line {line}: the element begins {distance} mm (or rad) away from the end of the one before it")]
    Gap {
        /// Line of the program.
        line: u32,
        /// Largest difference of a channel.
        distance: f32,
    },
}

impl Piece {
    /// Path length where it ends \[mm\].
    pub fn end(&self) -> f64 {
        self.start + self.element.length
    }
}

/// A queue of up to `E` elements, a power of two. Elements have serial numbers, which continue for ever.
#[derive(Clone, Debug)]
pub(super) struct Track<const E: usize> {
    pieces: [Option<Piece>; E],
    /// Serial of the oldest element kept.
    pub first: u32,
    /// Serial after the newest.
    pub end: u32,
    /// Corners at the start of elements below this serial are where they stay.
    pub moved: u32,
    /// Corners at the start of elements below this serial have their shape.
    pub decided: u32,
    end_s: f64,
    end_value: [f64; CHANNELS],
    end_slope: [f64; CHANNELS],
    /// By how much the slope of the first channels at the end is other than programmed.
    pub end_turned: Vector3<f64>,
    end_bend: [f64; CHANNELS],
    end_feed: f64,
}

impl<const E: usize> Track<E> {
    pub const fn new() -> Self {
        Self {
            pieces: [const { None }; E],
            first: 0,
            end: 0,
            moved: 0,
            decided: 0,
            end_s: 0.0,
            end_value: [0.0; CHANNELS],
            end_slope: [0.0; CHANNELS],
            end_turned: Vector3::new(0.0, 0.0, 0.0),
            end_bend: [0.0; CHANNELS],
            end_feed: 0.0,
        }
    }

    /// Forgets everything; the next element begins at path length `s`.
    pub fn clear(&mut self, s: f64) {
        (self.first, self.end) = (0, 0);
        (self.moved, self.decided) = (0, 0);
        self.end_s = s;
    }

    pub fn room(&self) -> usize {
        E - (self.end - self.first) as usize
    }

    pub fn get(&self, serial: u32) -> Option<&Piece> {
        if serial < self.first || serial >= self.end {
            return None;
        }
        self.pieces[serial as usize % E].as_ref()
    }

    pub fn get_mut(&mut self, serial: u32) -> Option<&mut Piece> {
        if serial < self.first || serial >= self.end {
            return None;
        }
        self.pieces[serial as usize % E].as_mut()
    }

    /// Path length where what is known ends \[mm\].
    pub fn end_s(&self) -> f64 {
        self.end_s
    }

    /// The last element known comes to rest at its end.
    pub fn closed(&self) -> bool {
        self.end > self.first
            && self
                .get(self.end - 1)
                .is_none_or(|piece| piece.element.join == Join::Stop)
    }

    pub fn push(&mut self, element: Element) -> Result<(), PushError> {
        let line = element.line;
        if self.room() == 0 {
            return Err(PushError::Full);
        }
        let start = element.at(0.0);
        let end = element.at(element.length);
        let far = self.end_s + element.length;
        if !(is_sound(&element, [&start, &end]) && libm::fabs(far) <= LONGEST) {
            return Err(PushError::Unsound { line });
        }
        let mut corner = Corner::NONE;
        let mut turn = Vector3::zeros();
        let mut stop = true;
        if self.end > 0 {
            let mut distance = 0.0;
            for i in 0..CHANNELS {
                distance = libm::fmax(distance, libm::fabs(start.value[i] - self.end_value[i]));
            }
            corner.set_jump(&self.end_slope, &start.first);
            turn = position(&corner.jump);
            // The element before it may not be as it was programmed any more.
            corner.turn_by(-self.end_turned);
            if distance > GAP {
                return Err(PushError::Gap {
                    line,
                    distance: distance as f32,
                });
            }
            stop = self.closed();
        }
        let (length, feed) = (element.length, element.feed);
        self.pieces[self.end as usize % E] = Some(Piece {
            start: self.end_s,
            place: position(&start.value),
            corner,
            stop,
            turn,
            bend: bend(&element, [&start, &end]),
            straight: matches!(element.shape, Shape::Line(_)),
            even: element.feed == self.end_feed && start.second == self.end_bend,
            chained: false,
            end_half: 0.0,
            element,
        });
        self.end += 1;
        self.end_s += length;
        self.end_value = end.value;
        self.end_slope = end.first;
        self.end_bend = end.second;
        self.end_turned = Vector3::zeros();
        self.end_feed = feed;
        Ok(())
    }

    /// The first channels where element `serial` begins, or where the newest one ends if it is the next one to come,
    /// without rounding \[mm\].
    pub fn junction(&self, serial: u32) -> Vector3<f64> {
        self.get(serial)
            .map_or_else(|| position(&self.end_value), |piece| piece.place)
    }

    /// The first channels at path length `s`, were element `serial` straight and no corner rounded \[mm\].
    pub fn along(&self, serial: u32, s: f64) -> Vector3<f64> {
        let (start, end) = (self.junction(serial), self.junction(serial + 1));
        let part = self
            .get(serial)
            .map_or(0.0, |piece| (s - piece.start) / piece.element.length);
        start + (end - start) * part
    }

    /// Path length from which on the path is as it was, though older elements are gone.
    pub fn kept_s(&self) -> f64 {
        let sound = if self.first == 0 { 0 } else { self.first + REACH };
        self.get(sound).map_or(self.end_s, |piece| piece.start)
    }

    /// Element `serial` is kept, and ends at or before path length `s`.
    pub fn ends_before(&self, serial: u32, s: f64) -> bool {
        self.get(serial).is_some_and(|piece| piece.end() <= s)
    }

    /// Lets go of the oldest elements, up to but not including `serial`.
    pub fn release(&mut self, serial: u32) {
        self.first = self.first.max(serial.min(self.end));
    }

    /// Gives the corner at the start of element `serial` its shape; it reaches no farther than the elements that meet
    /// there.
    pub fn shape_corner(&mut self, serial: u32, half: f64, stop: bool) {
        let Some(piece) = self.get_mut(serial) else { return };
        piece.corner.half = half;
        piece.stop |= stop;
        if let Some(before) = serial.checked_sub(1).and_then(|serial| self.get_mut(serial)) {
            before.end_half = half;
        }
    }

    /// The element at path length `s`, looked for from `hint`, which is left there.
    #[inline]
    pub fn find(&self, s: f64, hint: &mut u32) -> Option<&Piece> {
        match self.get(*hint) {
            Some(piece) if piece.start <= s && s < piece.end() => Some(piece),
            _ => self.search(s, hint),
        }
    }

    fn search(&self, s: f64, hint: &mut u32) -> Option<&Piece> {
        *hint = (*hint).clamp(self.first, self.end.saturating_sub(1));
        let mut piece = self.get(*hint)?;
        while s < piece.start {
            let Some(before) = hint.checked_sub(1).and_then(|serial| self.get(serial)) else {
                break;
            };
            piece = before;
            *hint -= 1;
        }
        while s >= piece.end() {
            let Some(after) = self.get(*hint + 1) else { break };
            piece = after;
            *hint += 1;
        }
        Some(piece)
    }

    /// The first `N` channels at path length `s`.
    // Into its two callers: a point is many numbers to hand over.
    #[inline(always)]
    pub fn at<const N: usize>(&self, s: f64, hint: &mut u32) -> Option<PathPoint<N>> {
        let piece = self.find(s, hint)?;
        let mut point = piece.element.channels(s - piece.start);
        piece.corner.add_to(&mut point, s - piece.start);
        let beyond = s - piece.end();
        if -beyond < piece.end_half
            && let Some(next) = self.get(*hint + 1)
        {
            next.corner.add_to(&mut point, beyond);
        }
        Some(point)
    }
}

/// Whether an element with these `ends` can be planned: its numbers, which may come from anywhere, are so that no sum or
/// square of them runs over.
fn is_sound(element: &Element, ends: [&PathPoint; 2]) -> bool {
    let within = |x: f64, most: f64| libm::fabs(x) <= most;
    let length = element.length;
    let calm = |Cubic([c0, c1, c2, c3]): &Cubic| {
        within(*c0, LONGEST)
            && [*c1, c2 * length, c3 * length * length]
                .into_iter()
                .all(|slope| within(slope, STEEPEST))
    };
    let place = |point: &PathPoint| {
        let close = point.value.iter().all(|x| within(*x, LONGEST));
        close && point.first.iter().all(|x| within(*x, STEEPEST))
    };
    let spans = match &element.shape {
        Shape::Span(cubics) => cubics.iter().all(calm),
        Shape::Arc(_) | Shape::Curve(_) | Shape::Line(_) | Shape::Point(_) => true,
    };
    length > SAME
        && length <= LONGEST
        && (1.0 / FASTEST..=FASTEST).contains(&element.feed)
        && spans
        && element.rest.iter().all(calm)
        && ends.into_iter().all(place)
}

/// By how much the direction of `element` turns in all, of which `ends` are the ends.
fn bend(element: &Element, ends: [&PathPoint; 2]) -> f64 {
    let even = |cubic: &Cubic| cubic.0[2..] == [0.0; 2];
    if matches!(element.shape, Shape::Line(_)) && element.rest.iter().all(even) {
        return 0.0;
    }
    let middle = element.at(0.5 * element.length);
    let mut most = 0.0;
    for point in [ends[0], &middle, ends[1]] {
        if point.second[SHAPED..]
            .iter()
            .any(|second| libm::fabs(*second) > SMOOTH)
        {
            return f64::INFINITY;
        }
        most = libm::fmax(most, position_norm(&point.second));
    }
    most * element.length
}

/// The first channels.
fn position(channels: &[f64; CHANNELS]) -> Vector3<f64> {
    Vector3::new(channels[0], channels[1], channels[2])
}
