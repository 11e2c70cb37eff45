//! A run of lines that are smoothed together, as far as it is held, and averages of it.

use super::knot::{Channels, Knot};
use shared::trajectory::{CHANNELS, Element, Tolerance};
use std::collections::VecDeque;

/// A line of a run.
#[derive(Clone, Debug)]
pub(super) struct RunLine {
    pub element: Element,
    /// Where it begins, from the start of the run \[mm\].
    pub start: f64,
    /// All channels there.
    pub value: Channels,
    /// How they change over its length, evenly.
    pub slope: Channels,
    /// By how much that is more than on the line before.
    turn: Channels,
    /// An element of the smooth path is to begin where it does.
    pub mark: bool,
}

/// Lines one after the other. Those that nothing is needed of any more are dropped.
#[derive(Clone, Debug, Default)]
pub(super) struct Run {
    lines: VecDeque<RunLine>,
    end: f64,
}

impl RunLine {
    pub fn end(&self) -> f64 {
        self.start + self.element.length
    }

    /// The channels at `s` \[mm\].
    pub fn at(&self, s: f64) -> Channels {
        std::array::from_fn(|i| self.value[i] + self.slope[i] * (s - self.start))
    }

    fn knot(&self, s: f64) -> Knot {
        Knot {
            s,
            value: self.at(s),
            slope: self.slope,
            half: 0.0,
        }
    }
}

impl Run {
    pub fn push(&mut self, element: Element, mark: bool) {
        let length = element.length;
        let (value, slope) = chord(&element);
        let before = self.last().map_or(slope, |line| line.slope);
        self.lines.push_back(RunLine {
            element,
            start: self.end,
            value,
            slope,
            turn: std::array::from_fn(|i| slope[i] - before[i]),
            mark,
        });
        self.end += length;
    }

    pub fn len(&self) -> usize {
        self.lines.len()
    }

    pub fn get(&self, index: usize) -> Option<&RunLine> {
        self.lines.get(index)
    }

    pub fn last(&self) -> Option<&RunLine> {
        self.lines.back()
    }

    /// Where the last line ends \[mm\].
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Drops lines of which nothing lies beyond `s` \[mm\].
    pub fn drop_before(&mut self, s: f64) {
        while self.lines.front().is_some_and(|line| line.end() < s) && self.len() > 1 {
            self.lines.pop_front();
        }
    }

    /// Index of the line at `s` \[mm\]; between two, of the second.
    pub fn index(&self, s: f64) -> usize {
        let begun = self.lines.partition_point(|line| line.start <= s);
        begun.saturating_sub(1)
    }

    /// Both places are on one line.
    pub fn is_line(&self, from: f64, to: f64) -> bool {
        self.lines
            .get(self.index(from))
            .is_some_and(|line| to <= line.end())
    }

    /// All lines are of one line of the program: how they meet was meant so.
    pub fn is_block(&self) -> bool {
        let mut numbers = self.lines.iter().map(|line| line.element.line);
        let first = numbers.next();
        numbers.all(|number| Some(number) == first)
    }

    /// The lines themselves at `s` \[mm\]; between two with the slope of the second.
    pub fn on_line(&self, s: f64) -> Knot {
        self.lines[self.index(s)].knot(s)
    }

    /// The lines themselves where they end, or a part of the last one before that.
    pub fn on_last(&self, s: f64) -> Knot {
        self.lines[self.len() - 1].knot(s)
    }

    /// The lines averaged over `half` \[mm\] to both sides of `s`, what is far away counting evenly less.
    ///
    /// At a place x from a corner, the average is off the lines by turn·h(1−|x|/h)³/6.
    pub fn averaged(&self, s: f64, half: f64) -> Knot {
        let mut knot = self.on_line(s);
        if half <= 0.0 {
            return knot;
        }
        knot.half = half;
        for line in self.lines.range(self.index(s - half)..) {
            let away = s - line.start;
            if away <= -half {
                break;
            }
            if away >= half {
                continue;
            }
            let rest = 1.0 - libm::fabs(away) / half;
            let value = half * rest * rest * rest / 6.0;
            // Before the corner, on a line that does not turn yet, it grows.
            let slope = 0.5 * rest * rest * if away < 0.0 { 1.0 } else { -1.0 };
            for i in 0..CHANNELS {
                knot.value[i] += line.turn[i] * value;
                knot.slope[i] += line.turn[i] * slope;
            }
        }
        knot
    }

    /// The lines between two places \[mm\].
    pub fn between(&self, from: f64, to: f64) -> impl Iterator<Item = &RunLine> {
        let lines = self.lines.range(self.index(from)..);
        lines.take_while(move |line| line.start < to)
    }
}

/// Channels where a line begins, and how they change over its length if they do so evenly.
pub(super) fn chord(line: &Element) -> (Channels, Channels) {
    let [from, to] = [0.0, line.length].map(|s| line.at(s).value);
    (from, std::array::from_fn(|i| (to[i] - from[i]) / line.length))
}

/// By how many times the `allowed` deviation channels are off.
pub(super) fn used(off: &Channels, allowed: &Tolerance) -> f64 {
    let [position, attitude] = norms(off);
    (position / allowed.position).max(attitude / allowed.attitude)
}

/// Length of a difference: of the position, or of a slide if that is more; and of the attitude: of T or N, or of A B C
/// together.
pub(super) fn norms(difference: &Channels) -> [f64; 2] {
    let [x, y, z, a, b, c, d, e, f, v, w] = *difference;
    let norm = |x: f64, y: f64, z: f64| libm::sqrt(x * x + y * y + z * z);
    let slides = libm::fabs(v).max(libm::fabs(w));
    [norm(x, y, z).max(slides), norm(a, b, c).max(norm(d, e, f))]
}
