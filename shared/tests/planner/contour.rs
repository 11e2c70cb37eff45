//! How far the machine is from the programmed path.

use super::bench::Bench;
use nalgebra::Vector3;
use shared::io::AXES;
use shared::trajectory::{CHANNELS, Element, PathSpace, Tolerance};

/// A program, by path length.
pub struct Contour<'a> {
    bench: &'a Bench,
    elements: &'a [Element],
    starts: Vec<f64>,
    tolerance: Tolerance,
}

/// Where the machine is off by so much: shares of what is allowed.
#[derive(Clone, Copy, Debug)]
pub struct Off {
    pub position: f64,
    pub attitude: f64,
}

impl Off {
    pub fn worst(&self) -> f64 {
        self.position.max(self.attitude)
    }
}

impl<'a> Contour<'a> {
    pub fn new(bench: &'a Bench, elements: &'a [Element], tolerance: Tolerance) -> Self {
        let mut s = 0.0;
        let starts = elements.iter().map(|element| {
            s += element.length;
            s - element.length
        });
        Self {
            bench,
            starts: starts.collect(),
            elements,
            tolerance,
        }
    }

    /// Path length of the whole program.
    pub fn length(&self) -> f64 {
        self.elements.iter().map(|element| element.length).sum()
    }

    /// Where it ends.
    pub fn last(&self) -> Option<Vector3<f64>> {
        let element = self.elements.last()?;
        Some(Vector3::from_column_slice(&element.at(element.length).value[..3]))
    }

    fn index(&self, s: f64) -> usize {
        self.starts.partition_point(|start| *start <= s).max(1) - 1
    }

    /// Highest feed between two path lengths, with a little more on both sides.
    pub fn feed(&self, from: f64, to: f64) -> f64 {
        let range = self.index(from - 1e-9)..=self.index(to + 1e-9);
        let feeds = self.elements[range].iter().map(|element| element.feed);
        feeds.fold(0.0, f64::max)
    }

    /// Highest acceleration along the path with which the corners of the elements between two path lengths stay inside the
    /// tolerance: a mean over T is off by T²/24 of half the jump of the direction times that acceleration.
    pub fn accurate_acceleration(&self, from: f64, to: f64) -> f64 {
        if self.elements.is_empty() {
            return f64::INFINITY;
        }
        let [first, last] = [self.index(from.min(to)), self.index(from.max(to))];
        let corners = first.max(1)..=(last + 1).min(self.elements.len() - 1);
        let strain = |i: usize| {
            let [before, after] = [&self.elements[i - 1], &self.elements[i]];
            let [before, after] = [before.at(before.length).first, after.at(0.0).first];
            let jump = |channels: std::ops::Range<usize>| {
                channels
                    .map(|k| (after[k] - before[k]).powi(2))
                    .sum::<f64>()
                    .sqrt()
            };
            (jump(0..3) / self.tolerance.position).max(jump(3..CHANNELS) / self.tolerance.attitude)
        };
        let most = corners.map(strain).fold(0.0, f64::max);
        2.0 / (most * self.bench.limits.filter_off())
    }

    /// How far `axes` are from the path at `s`.
    fn off_at(&self, axes: &[f64; AXES], s: f64) -> Off {
        let i = self.index(s);
        let element = &self.elements[i];
        let value = element.at((s - self.starts[i]).clamp(0.0, element.length)).value;
        let programmed = Vector3::from_column_slice(&value[..3]);
        let attitude = match self.bench.space {
            PathSpace::Axes => (3..AXES).map(|i| (axes[i] - value[i]).abs()).fold(0.0, f64::max),
            PathSpace::Tool => match self.bench.realised(&value, axes) {
                None => f64::INFINITY,
                Some(wanted) => {
                    let is = self.bench.kinematics.forward(axes);
                    let tangent = match self.bench.whole {
                        true => (is.tangent - wanted.tangent).norm(),
                        false => 0.0,
                    };
                    tangent.max((is.normal - wanted.normal).norm())
                }
            },
        };
        Off {
            position: (self.bench.tip(axes) - programmed).norm() / self.tolerance.position,
            attitude: attitude / self.tolerance.attitude,
        }
    }

    /// How far `axes` are from the nearest point of the path, which is not far from `s`: within `reach`.
    pub fn off(&self, axes: &[f64; AXES], s: f64, reach: f64) -> Off {
        const PARTS: i32 = 400;
        let mut best = (s, self.off_at(axes, s));
        // Where it is within the tolerance there is no need to look for a nearer one.
        let mut reach = reach;
        for _ in 0..4 {
            if best.1.worst() <= 0.9 {
                break;
            }
            let middle = best.0;
            for k in -PARTS..=PARTS {
                let s = middle + reach * f64::from(k) / f64::from(PARTS);
                let off = self.off_at(axes, s);
                if off.worst() < best.1.worst() {
                    best = (s, off);
                }
            }
            reach *= 3.0 / f64::from(PARTS);
        }
        best.1
    }
}
