//! From the points of a taught seam to the curves that are planned from.

use super::smooth::Scattered;
use crate::SeamPoint;
use nalgebra::Vector3;
use shared::geometry::angle;
use shared::io::SIDES;
use teach::seam::{MeasuredSeam, SeamPoint as TaughtPoint};
use thiserror::Error;

/// Points that a curve needs.
const FEWEST: usize = 4;
/// A point may be so far from the curve through its neighbours \[mm\], and at the ends, where they are on one side
/// only.
const BESIDE: f64 = 0.3;
const BESIDE_AT_ENDS: f64 = 1.5;
/// A seam bends by no more between two chords \[rad\].
const BEND: f64 = 0.5;
/// Chords of seam 1 are as long as s_mm says, to this much \[mm\].
const CHORD: f64 = 0.05;
/// What all pictures of a place have in common, such as its texture: they do not scatter by it \[mm\].
const IN_COMMON: f64 = 0.0015;
/// The head may stand so far from the normal of the skin, if it turns more evenly then: half a degree \[rad\].
const HEAD: f64 = 0.009;

/// Why a curve cannot be made of taught points. Reads as one sentence.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TaughtSeamError {
    /// Not enough points.
    #[error("{found} points are too few for a curve: {FEWEST} are needed, teach more")]
    Few {
        /// There are so many.
        found: usize,
    },
    /// Seen too badly.
    #[error(
        "line {line}: the quality of side {side} is {quality}, but must be {least} at least: teach this point again, or \
         take it out of the file"
    )]
    Quality {
        /// Line of the file.
        line: usize,
        /// 1 or 2.
        side: usize,
        /// 0…1.
        quality: f64,
        /// Limit.
        least: f64,
    },
    /// A place that does not belong to the others.
    #[error(
        "line {line}: side {side} jumps there, {away_mm:.3} mm off the course of the other points: take the point out \
         of the file, or teach it again"
    )]
    Jump {
        /// Line of the file.
        line: usize,
        /// 1 or 2.
        side: usize,
        /// How far \[mm\].
        away_mm: f64,
    },
    /// Bends too much between two chords.
    #[error(
        "line {line}: side {side} turns by {turn_deg:.0}° there: too sharp a bend from one point to the next, teach it \
         again with closer points"
    )]
    Bend {
        /// Line of the file.
        line: usize,
        /// 1 or 2.
        side: usize,
        /// By how much \[deg\].
        turn_deg: f64,
    },
}

/// Both seams as curves.
#[derive(Clone, Debug, PartialEq)]
pub struct TaughtSeams {
    /// Seam 1 with skin normals.
    pub main: Vec<SeamPoint>,
    /// Seam 2.
    pub other: Vec<Vector3<f64>>,
    /// How far the points are from them.
    pub fit: [Deviations; SIDES],
    /// Which of them begin, and which end, with what the cameras saw there.
    pub marked: Marked,
}

/// Seams that begin, and that end, at a plate or a tack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marked {
    /// At their first point.
    pub begins: [bool; SIDES],
    /// At their last one.
    pub ends: [bool; SIDES],
}

/// Distances of the points from their curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviations {
    /// \[mm\]
    pub largest_mm: f64,
    /// Line of the file with the largest.
    pub line: usize,
    /// \[mm\]
    pub rms_mm: f64,
}

impl TaughtSeams {
    /// Smooth curves through `points`, each with its line in the file. Points seen with less than `least_quality`, or
    /// that jump, are refused.
    pub fn through(points: &[(usize, TaughtPoint)], least_quality: f64) -> Result<Self, TaughtSeamError> {
        check(points, least_quality)?;
        let [first, second] = [0, 1].map(|side| smoothed(points, side));
        let fit = [(0, &first), (1, &second)].map(|(side, curve)| deviations(points, side, curve));
        let main = first.iter().zip(normals(points));
        Ok(Self {
            main: main
                .map(|(position, normal)| SeamPoint {
                    position: *position,
                    normal,
                })
                .collect(),
            other: second,
            fit,
            marked: Marked::of(points),
        })
    }

    /// What a person should know, a sentence each.
    pub fn notes(&self) -> Vec<String> {
        let sides = self.fit.iter().enumerate();
        let note = |(side, fit): (usize, &Deviations)| {
            format!(
                "seam {}: {} taught points lie within {:.4} mm of the curve (line {}), rms {:.4} mm",
                side + 1,
                self.main.len(),
                fit.largest_mm,
                fit.line,
                fit.rms_mm
            )
        };
        let marked = (0..SIDES).filter_map(|side| {
            let number = side + 1;
            let said = match (self.marked.begins[side], self.marked.ends[side]) {
                (true, true) => "on where its seam begins, and off where it ends",
                (true, false) => "on where its seam begins",
                (false, true) => "off where its seam ends",
                (false, false) => return None,
            };
            Some(format!("beam {number} goes {said}, as the cameras saw it"))
        });
        sides.map(note).chain(marked).collect()
    }
}

/// Refuses what is no seam.
fn check(points: &[(usize, TaughtPoint)], least: f64) -> Result<(), TaughtSeamError> {
    let found = points.len();
    if found < FEWEST {
        return Err(TaughtSeamError::Few { found });
    }
    let along = [0, 1].map(|side| chords(points, side));
    for (index, (first_line, point)) in points.iter().enumerate() {
        for (side, foot) in point.feet.iter().enumerate() {
            let (line, side, k) = (first_line + side, side + 1, side);
            let quality = foot.quality;
            if quality < least {
                return Err(TaughtSeamError::Quality {
                    line,
                    side,
                    quality,
                    least,
                });
            }
            let limit = if index == 0 || index == found - 1 {
                BESIDE_AT_ENDS
            } else {
                BESIDE
            };
            let away_mm = beside_neighbours(points, &along[k], index, k);
            if away_mm > limit {
                return Err(TaughtSeamError::Jump { line, side, away_mm });
            }
        }
    }
    for pair in points.windows(2) {
        let [(_, before), (line, point)] = pair else {
            continue;
        };
        let chord = (point.feet[0].position - before.feet[0].position).norm();
        let away_mm = (chord - (point.s_mm - before.s_mm)).abs();
        if away_mm > CHORD {
            let (line, side) = (*line, 1);
            return Err(TaughtSeamError::Jump { line, side, away_mm });
        }
    }
    for three in points.windows(3) {
        for side in 0..SIDES {
            let [a, b, c] = [0, 1, 2].map(|i: usize| three[i].1.feet[side].position);
            let turn = angle(&(b - a), &(c - b));
            if turn > BEND {
                return Err(TaughtSeamError::Bend {
                    line: three[1].0 + side,
                    side: side + 1,
                    turn_deg: turn.to_degrees(),
                });
            }
        }
    }
    Ok(())
}

/// How far a point is from the curve through the nearest other ones over the chords of its side: a cubic through four of them, at
/// the ends a parabola through three \[mm\].
fn beside_neighbours(points: &[(usize, TaughtPoint)], along: &[f64], index: usize, side: usize) -> f64 {
    let last = points.len() - 1;
    let at_end = index == 0 || index == last;
    let count = if at_end { 3 } else { 4.min(last) };
    let first = index.saturating_sub(2).min(last - count);
    let others: Vec<usize> = (first..=first + count)
        .filter(|i| *i != index)
        .take(count)
        .collect();
    let s = along[index];
    let mut expected = Vector3::zeros();
    for &i in &others {
        let weights = others.iter().filter(|j| **j != i);
        let weight: f64 = weights.map(|&j| (s - along[j]) / (along[i] - along[j])).product();
        expected += points[i].1.feet[side].position * weight;
    }
    (points[index].1.feet[side].position - expected).norm()
}

/// Sums of the chords of `side`.
fn chords(points: &[(usize, TaughtPoint)], side: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    for pair in points.windows(2) {
        let chord = (pair[1].1.feet[side].position - pair[0].1.feet[side].position).norm();
        sums.push(sums[sums.len() - 1] + chord);
    }
    sums
}

/// Standard deviation of a point.
fn sigma(foot: &MeasuredSeam) -> f64 {
    (foot.scatter_mm / libm::sqrt(foot.pictures as f64)).hypot(IN_COMMON)
}

/// The places of `side`, as smooth as their scatter asks for.
fn smoothed(points: &[(usize, TaughtPoint)], side: usize) -> Vec<Vector3<f64>> {
    let feet = points.iter().map(|(_, point)| &point.feet[side]);
    let y: Vec<[f64; 3]> = feet.clone().map(|foot| foot.position.into()).collect();
    let scattered = Scattered {
        x: &chords(points, side),
        y: &y,
        sigma: &feet.map(sigma).collect::<Vec<_>>(),
    };
    scattered.smoothed().into_iter().map(Vector3::from).collect()
}

/// The normals of the skin, the mean of both sides, smoother than they scatter from point to point.
fn normals(points: &[(usize, TaughtPoint)]) -> Vec<Vector3<f64>> {
    let x = chords(points, 0);
    let mean = |point: &TaughtPoint| (point.feet[0].normal + point.feet[1].normal).normalize();
    let y: Vec<[f64; 3]> = points.iter().map(|(_, point)| mean(point).into()).collect();
    // From the line between two neighbours; a normal that turns evenly is on it.
    let mut sum = 0.0;
    for i in 1..x.len() - 1 {
        let part = (x[i] - x[i - 1]) / (x[i + 1] - x[i - 1]);
        let variances = 1.0 + part * part + (1.0 - part) * (1.0 - part);
        let squares =
            (0..3).map(|c| libm::pow(y[i][c] - y[i - 1][c] * (1.0 - part) - y[i + 1][c] * part, 2.0));
        sum += squares.sum::<f64>() / (3.0 * variances);
    }
    let scatter = libm::sqrt(sum / (x.len() - 2) as f64).max(HEAD);
    // Mirrored at both ends, so that the head does not turn where the straight runs begin.
    let (count, length) = (x.len(), x[x.len() - 1]);
    let before = (1..count).rev().map(|i| (-x[i], y[i]));
    let inside = (0..count).map(|i| (x[i], y[i]));
    let after = (0..count - 1).rev().map(|i| (2.0 * length - x[i], y[i]));
    let (x, y): (Vec<f64>, Vec<[f64; 3]>) = before.chain(inside).chain(after).unzip();
    let scattered = Scattered {
        x: &x,
        y: &y,
        sigma: &vec![scatter; x.len()],
    };
    let smooth = scattered.smoothed().into_iter().map(Vector3::from);
    let inside = smooth.skip(count - 1).take(count);
    inside.map(|normal| normal.normalize()).collect()
}

impl Marked {
    fn of(points: &[(usize, TaughtPoint)]) -> Self {
        let marked = |point: Option<&(usize, TaughtPoint)>| {
            point.map_or([false; SIDES], |(_, point)| {
                point.feet.map(|foot| foot.end.is_some())
            })
        };
        Self {
            begins: marked(points.first()),
            ends: marked(points.last()),
        }
    }
}

impl Deviations {
    fn of(distances: impl Iterator<Item = (usize, f64)>) -> Self {
        let mut all = Self {
            largest_mm: 0.0,
            line: 0,
            rms_mm: 0.0,
        };
        let mut count = 0;
        for (line, distance) in distances {
            count += 1;
            all.rms_mm += distance * distance;
            if distance >= all.largest_mm {
                (all.largest_mm, all.line) = (distance, line);
            }
        }
        all.rms_mm = libm::sqrt(all.rms_mm / f64::from(count.max(1)));
        all
    }
}

fn deviations(points: &[(usize, TaughtPoint)], side: usize, curve: &[Vector3<f64>]) -> Deviations {
    Deviations::of(
        points
            .iter()
            .zip(curve)
            .map(|((line, point), at)| (line + side, (point.feet[side].position - at).norm())),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use teach::seam::SeamEnd;
    use vision::render::SplitMix64;

    /// Feet 4 mm apart on an arc of 600 mm radius, taught every 12 mm with a scatter of 0.007 mm in 8 pictures.
    fn taught(scatter_mm: f64) -> Vec<(usize, TaughtPoint)> {
        let mut noise = SplitMix64::new(2);
        let mut points: Vec<(usize, TaughtPoint)> = Vec::new();
        for i in 0..30 {
            let phi = 12.0 * f64::from(i) / 600.0;
            let mut at = |radius: f64| {
                let mut noise = || scatter_mm / 8f64.sqrt() * noise.gauss()[0];
                let (x, y) = (radius * phi.sin(), -radius * phi.cos());
                let normal = Vector3::new(0.3 * scatter_mm.signum() * noise(), noise(), 1.0).normalize();
                MeasuredSeam {
                    position: Vector3::new(x + noise(), y + noise(), 100.0 + noise()),
                    normal,
                    width_mm: 0.05,
                    quality: 0.9,
                    scatter_mm,
                    pictures: 8,
                    end: None,
                }
            };
            let feet = [at(598.0), at(602.0)];
            let before = points.last().map(|(_, point)| point);
            let point = TaughtPoint::after(before, feet);
            points.push((7 + 2 * i as usize, point));
        }
        points
    }

    #[test]
    fn points_are_as_near_to_the_curve_as_they_scatter() {
        let exact = TaughtSeams::through(&taught(0.0), 0.5).unwrap();
        assert!(exact.fit.iter().all(|fit| fit.rms_mm < IN_COMMON * 3f64.sqrt()));
        let noisy = TaughtSeams::through(&taught(0.007), 0.5).unwrap();
        let off = |seams: &TaughtSeams| {
            let radii = seams.main.iter().map(|p| p.position.xy().norm() - 598.0);
            radii.fold(0.0, |worst: f64, off| worst.max(off.abs()))
        };
        assert!(off(&noisy) < 0.006, "{}", off(&noisy));
        for fit in noisy.fit {
            // Half the variance of three channels with 0.0029 mm.
            assert!(
                (0.002..0.004).contains(&fit.rms_mm) && fit.largest_mm < 0.015,
                "{fit:?}"
            );
        }
        let mut ended = taught(0.0);
        ended[0].1.feet[1].end = Some(SeamEnd::Plate);
        ended[29].1.feet[0].end = Some(SeamEnd::Tack);
        let notes = TaughtSeams::through(&ended, 0.5).unwrap().notes();
        assert_eq!(
            notes[2..],
            [
                "beam 1 goes off where its seam ends, as the cameras saw it",
                "beam 2 goes on where its seam begins, as the cameras saw it"
            ]
        );
        assert_eq!(exact.notes().len(), 2);
        let note = &noisy.notes()[1];
        assert!(
            note.starts_with("seam 2: 30 taught points lie within 0.0"),
            "{note}"
        );
    }

    #[test]
    fn what_is_no_seam_is_refused_with_its_line() {
        let refused = |change: fn(&mut Vec<(usize, TaughtPoint)>)| {
            let mut points = taught(0.0);
            change(&mut points);
            TaughtSeams::through(&points, 0.5).unwrap_err().to_string()
        };
        let jump = refused(|points| points[10].1.feet[1].position.z += 0.4);
        assert!(jump.contains("line 28: side 2 jumps there, 0.4"), "{jump}");
        let quality = refused(|points| points[3].1.feet[0].quality = 0.4);
        assert!(
            quality.contains("line 13: the quality of side 1 is 0.4"),
            "{quality}"
        );
        let few = refused(|points| points.truncate(3));
        assert!(few.contains("3 points are too few"), "{few}");
        let along = refused(|points| points[20..].iter_mut().for_each(|(_, point)| point.s_mm += 0.2));
        assert!(along.contains("line 47: side 1 jumps there, 0.2"), "{along}");
    }
}
