//! Where the plane across seam 1 meets seam 2 (mathematics 0.5 (2)).

use super::locate::LocateError;
use cam::curve::Curve;
use curves::SplineError;
use nalgebra::Vector3;

/// Where a plane meets seam 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The point \[mm\].
    pub point: Vector3<f64>,
    /// Its arc length along seam 2 \[mm\].
    pub sigma: f64,
    /// Direction of seam 2 there, unit length, in its own sense.
    pub tangent: Vector3<f64>,
    /// How many points of the seam the plane meets within reach.
    pub count: usize,
}

/// A second seam that planes can cut.
pub trait OtherSeam {
    /// The point of the seam in the plane through `p1` with normal `t`, at most `gap_max` \[mm\] from `p1`:
    /// the one nearest to arc length `sigma_prev` if that is given, the one nearest to `p1` otherwise.
    fn cut(
        &self,
        p1: &Vector3<f64>,
        t: &Vector3<f64>,
        gap_max: f64,
        sigma_prev: Option<f64>,
    ) -> Result<Crossing, LocateError>;
}

/// Seam 2 as straight segments.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    points: Vec<Vector3<f64>>,
}

impl Polyline {
    /// Segments between `points`; segments without length are skipped.
    pub fn new(points: Vec<Vector3<f64>>) -> Self {
        Self { points }
    }

    /// Everything the plane meets: point, arc length, direction of the segment. A vertex counts once.
    fn hits(&self, p1: &Vector3<f64>, t: &Vector3<f64>) -> Vec<Crossing> {
        let last = self.points.len().saturating_sub(2);
        let mut hits = Vec::new();
        let mut sigma = 0.0;
        for (j, pair) in self.points.windows(2).enumerate() {
            let step = pair[1] - pair[0];
            let length = step.norm();
            if length == 0.0 {
                continue;
            }
            let (d0, d1) = ((pair[0] - p1).dot(t), (pair[1] - p1).dot(t));
            let part = if d0 == 0.0 && d1 == 0.0 {
                Some(((p1 - pair[0]).dot(&step) / (length * length)).clamp(0.0, 1.0))
            } else if d0 == 0.0 {
                Some(0.0)
            } else if d1 == 0.0 {
                (j == last).then_some(1.0)
            } else {
                (d0 * d1 < 0.0).then(|| d0 / (d0 - d1))
            };
            hits.extend(part.map(|part| Crossing {
                point: pair[0] + step * part,
                sigma: sigma + length * part,
                tangent: step / length,
                count: 0,
            }));
            sigma += length;
        }
        hits
    }
}

impl OtherSeam for Polyline {
    fn cut(
        &self,
        p1: &Vector3<f64>,
        t: &Vector3<f64>,
        gap_max: f64,
        sigma_prev: Option<f64>,
    ) -> Result<Crossing, LocateError> {
        let mut hits = self.hits(p1, t);
        if hits.is_empty() {
            return Err(LocateError::Miss);
        }
        hits.retain(|hit| (hit.point - p1).norm() <= gap_max);
        let count = hits.len();
        let far = |hit: &Crossing| match sigma_prev {
            Some(sigma) => (hit.sigma - sigma).abs(),
            None => (hit.point - p1).norm(),
        };
        hits.into_iter()
            .min_by(|a, b| far(a).total_cmp(&far(b)))
            .map(|hit| Crossing { count, ..hit })
            .ok_or(LocateError::TooFar)
    }
}

/// Seam 2 as a smooth curve, which continues straight for a while beyond its ends.
#[derive(Clone, Debug)]
pub struct SmoothSeam {
    curve: Curve<3>,
    /// The same in short segments, to find where to start.
    coarse: Polyline,
    /// Arc length at the start of `coarse`.
    begin: f64,
}

/// How far seam 2 continues beyond its ends \[mm\].
const EXTENSION: f64 = 20.0;
/// Length of the coarse segments \[mm\].
const SEGMENT: f64 = 1.0;
/// Newton steps, and the distance from the plane that ends them \[mm\].
const STEPS: usize = 20;
const IN_PLANE: f64 = 1e-12;

impl SmoothSeam {
    /// The natural spline through `points` by its arc length.
    pub fn through(points: &[Vector3<f64>]) -> Result<Self, SplineError> {
        let points: Vec<[f64; 3]> = points.iter().map(|&p| p.into()).collect();
        let curve = Curve::by_length(&points)?;
        let begin = -EXTENSION;
        let count = ((curve.end() + 2.0 * EXTENSION) / SEGMENT).ceil();
        let step = (curve.end() + 2.0 * EXTENSION) / count;
        let coarse = (0..=count as usize)
            .map(|i| Vector3::from(curve.at(begin + i as f64 * step)[0]))
            .collect();
        Ok(Self {
            curve,
            coarse: Polyline::new(coarse),
            begin,
        })
    }

    /// Length between the first and the last point \[mm\].
    pub fn length(&self) -> f64 {
        self.curve.end()
    }
}

impl OtherSeam for SmoothSeam {
    fn cut(
        &self,
        p1: &Vector3<f64>,
        t: &Vector3<f64>,
        gap_max: f64,
        sigma_prev: Option<f64>,
    ) -> Result<Crossing, LocateError> {
        let near = self
            .coarse
            .cut(p1, t, gap_max, sigma_prev.map(|sigma| sigma - self.begin))?;
        let mut sigma = near.sigma + self.begin;
        for _ in 0..STEPS {
            let [value, first, _] = self.curve.at(sigma).map(Vector3::from);
            let ahead = (value - p1).dot(t);
            if ahead.abs() < IN_PLANE {
                break;
            }
            sigma -= ahead / first.dot(t);
        }
        let [point, first, _] = self.curve.at(sigma).map(Vector3::from);
        // What Newton leaves at coordinates of some metres is their last bits.
        if (point - p1).dot(t).abs() > 1e-9 {
            return Err(LocateError::NoConvergence);
        }
        Ok(Crossing {
            point,
            sigma,
            tangent: first / first.norm(),
            count: near.count,
        })
    }
}
