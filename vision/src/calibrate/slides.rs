//! How a picture lies to the slides that carry its camera.

use super::least_squares::LeastSquares;
use nalgebra::Matrix2;
use std::collections::BTreeMap;
use thiserror::Error;

/// Fewest places of the slides.
const FEWEST: usize = 8;

/// Least way of each slide, and least standard deviation of the places in any direction \[mm\].
const LEAST_WAY_MM: f64 = 0.15;
const LEAST_SPREAD_MM: f64 = 0.03;

/// Largest residual, root of the mean square \[mm\].
const RESIDUAL_MM: f64 = 0.005;

/// Largest error of scale, and largest rotation against the nominal camera \[rad\].
const SCALE: f64 = 0.10;
const ROTATION: f64 = 0.175;

/// Error of scale from which on the picture does not follow the slides at all.
const STILL: f64 = 4.0;

/// A slide that moved less than this did not move \[mm\].
const AT_REST_MM: f64 = 0.002;

/// A seam at rest, seen with the slides somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlideReading {
    /// Which place of the seam is seen, by any number: each has its own position. Many places even out what the texture
    /// of one does to heights.
    pub place: u32,
    /// U and V of the slides \[mm\].
    pub slides_mm: [f64; 2],
    /// u and n of the seam in the camera's frame \[mm\].
    pub seen_mm: [f64; 2],
}

/// The camera–slide matrix and how well it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlideFit {
    /// Slides' way for a way in the picture: \[ΔU ΔV\] = matrix · \[u n\].
    pub matrix: [[f64; 2]; 2],
    /// Slides at which the origin of the camera's frame is on the seam, mean of all places \[mm\].
    pub zero_mm: [f64; 2],
    /// Root of the mean square of what is left, of each coordinate in the picture \[mm\].
    pub residual_mm: f64,
    /// Reading that is farthest off, from 1, and how far \[mm\].
    pub worst: (usize, f64),
    /// Play of U and of V between the slide's encoder and the camera; `None` of a slide that did not move both
    /// ways \[mm\].
    pub backlash_mm: [Option<f64>; 2],
    /// How much more than the picture says the slides move, along u and along n.
    pub scale: [f64; 2],
    /// The camera's turn against the nominal one about travel, positive as the mount \[rad\].
    pub rotation_rad: f64,
    /// What u and n lack to a right angle \[rad\].
    pub skew_rad: f64,
}

/// Why readings give no matrix.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SlideError {
    /// Too few places.
    #[error("the seam was seen {found} times; at least 8 times are needed, and 5 more than there are places")]
    Few {
        /// How many.
        found: usize,
    },
    /// A slide moved too little.
    #[error("slide {slide} moved by {way_mm:.3} mm only; at least 0.150 mm are needed: take larger steps")]
    Steps {
        /// U or V.
        slide: char,
        /// From end to end \[mm\].
        way_mm: f64,
    },
    /// The slides moved along a line only.
    #[error(
        "the slides moved along one line only (they lie within {spread_um:.0} µm of it; at least 30 µm are needed): step U and V on their own"
    )]
    Collinear {
        /// Standard deviation square to the line \[µm\].
        spread_um: f64,
    },
    /// The readings do not fit any matrix.
    #[error(
        "the measured positions do not fit the slides' steps: {residual_um:.1} µm rms are left (may be 5 µm), reading {worst} is off by {worst_um:.1} µm; did the work or the machine move, or was another seam measured?"
    )]
    Residual {
        /// Root of the mean square \[µm\].
        residual_um: f64,
        /// Worst reading, from 1.
        worst: usize,
        /// How far it is off \[µm\].
        worst_um: f64,
    },
    /// The picture does not move with the slides.
    #[error("the picture does not move with the slides: is it this side's camera?")]
    Still,
    /// The picture is mirrored.
    #[error(
        "the picture is mirrored: what the camera sees moves the wrong way across or up; switch the camera's flip"
    )]
    Mirrored,
    /// The camera is not mounted as configured.
    #[error(
        "the camera is turned by {degrees:.1}° against its nominal mount (may be 10°): put the true angle into mount_deg of the machine file, or turn the picture"
    )]
    Rotated {
        /// About travel \[°\].
        degrees: f64,
    },
    /// The scale is not as configured.
    #[error(
        "the slides move {percent:.1} % more than the picture says along {along} (may be 10 %): put the true magnification, pixel and tilt into the machine file"
    )]
    Scale {
        /// Lateral or height.
        along: &'static str,
        /// Error of scale \[%\].
        percent: f64,
    },
}

/// The camera–slide matrix from readings in the order they were taken, by least squares. A seam at rest moves
/// through the picture against the camera: seen = −matrix⁻¹ · slides + constant. Play of a slide is separated
/// by the direction it last moved in. `nominal` is the matrix by the drawing.
///
/// Each place has a constant of its own: only what differs from the place's mean counts.
pub fn slide_matrix(readings: &[SlideReading], nominal: [[f64; 2]; 2]) -> Result<SlideFit, SlideError> {
    let count = readings.len();
    if count < FEWEST {
        return Err(SlideError::Few { found: count });
    }
    check_ways(readings)?;
    let directions = directions(readings);
    let told = [0, 1].map(|k| {
        [-1.0, 1.0]
            .iter()
            .all(|sign| directions.iter().any(|d| d[k] == *sign))
    });
    // U, V, direction of U, direction of V; u, n.
    let rows: Vec<[f64; 6]> = readings
        .iter()
        .zip(&directions)
        .map(|(reading, direction)| {
            let ([u, v], [seen_u, seen_n]) = (reading.slides_mm, reading.seen_mm);
            [u, v, direction[0], direction[1], seen_u, seen_n]
        })
        .collect();
    let (means, places) = means(readings, &rows);
    let own: Vec<[f64; 6]> = (0..count).map(|k| difference(&rows[k], &means[k])).collect();
    check_spread(&own)?;
    let mut plane = LeastSquares::<4, 2>::new();
    for [u, v, along_u, along_v, seen_u, seen_n] in &own {
        plane.add([*u, *v, *along_u, *along_v], [*seen_u, *seen_n], 1.0);
    }
    let mut parameters = 2 + places;
    for (axis, told) in told.into_iter().enumerate() {
        if told {
            parameters += 1;
        } else {
            plane.hold(2 + axis);
        }
    }
    let few = SlideError::Few { found: count };
    let found = plane.solve().ok_or(few)?;
    let off = |k: usize| {
        let off = |coordinate: usize| {
            let expected: f64 = (0..4).map(|i| found[(i, coordinate)] * own[k][i]).sum();
            own[k][4 + coordinate] - expected
        };
        off(0).hypot(off(1))
    };
    let squares: f64 = (0..count).map(|k| off(k).powi(2)).sum();
    let free = count
        .checked_sub(parameters)
        .filter(|free| *free > 0)
        .ok_or(few)?;
    let residual_mm = (squares / (2 * free) as f64).sqrt();
    let worst = (0..count).max_by(|a, b| off(*a).total_cmp(&off(*b)));
    let worst = worst.map_or((1, 0.0), |k| (k + 1, off(k)));
    if residual_mm > RESIDUAL_MM {
        return Err(SlideError::Residual {
            residual_um: 1e3 * residual_mm,
            worst: worst.0,
            worst_um: 1e3 * worst.1,
        });
    }
    let seen = Matrix2::new(found[(0, 0)], found[(1, 0)], found[(0, 1)], found[(1, 1)]);
    let matrix = seen.try_inverse().map(|inverse| -inverse);
    let matrix = matrix.ok_or(SlideError::Still)?;
    let zero_mm = [0, 1].map(|axis| {
        // slides + matrix · seen is where the seam is, whatever the slides do.
        let at = |row: &[f64; 6]| row[axis] + matrix[(axis, 0)] * row[4] + matrix[(axis, 1)] * row[5];
        rows.iter().map(at).sum::<f64>() / count as f64
    });
    let backlash_mm = [0, 1].map(|axis| {
        let play = |coordinate: usize| 2.0 * found[(2 + axis, coordinate)];
        told[axis].then(|| play(0).hypot(play(1)))
    });
    let fit = SlideFit {
        matrix: [[matrix[(0, 0)], matrix[(0, 1)]], [matrix[(1, 0)], matrix[(1, 1)]]],
        zero_mm,
        residual_mm,
        worst,
        backlash_mm,
        scale: [0, 1].map(|k| matrix.column(k).norm() - 1.0),
        rotation_rad: rotation(&matrix, &nominal),
        skew_rad: skew(&matrix),
    };
    check_mount(&matrix, &fit)?;
    Ok(fit)
}

/// Turn of `matrix` against `nominal` that fits both axes best. In the slides' frame the camera turns against its mount.
fn rotation(matrix: &Matrix2<f64>, nominal: &[[f64; 2]; 2]) -> f64 {
    let nominal = Matrix2::new(nominal[0][0], nominal[0][1], nominal[1][0], nominal[1][1]);
    let turn = matrix * nominal.transpose();
    (turn[(1, 0)] - turn[(0, 1)]).atan2(turn[(0, 0)] + turn[(1, 1)])
}

/// What the columns lack to a right angle.
fn skew(matrix: &Matrix2<f64>) -> f64 {
    let (u, n) = (matrix.column(0), matrix.column(1));
    (u.dot(&n) / (u.norm() * n.norm())).clamp(-1.0, 1.0).asin()
}

/// Whether the camera is built about as configured.
fn check_mount(matrix: &Matrix2<f64>, fit: &SlideFit) -> Result<(), SlideError> {
    if fit.scale.iter().any(|scale| *scale > STILL) {
        return Err(SlideError::Still);
    }
    if matrix.determinant() <= 0.0 {
        return Err(SlideError::Mirrored);
    }
    if fit.rotation_rad.abs() > ROTATION {
        let degrees = fit.rotation_rad.to_degrees();
        return Err(SlideError::Rotated { degrees });
    }
    for (scale, along) in fit.scale.into_iter().zip(["u", "n"]) {
        if scale.abs() > SCALE {
            let percent = 100.0 * scale;
            return Err(SlideError::Scale { along, percent });
        }
    }
    Ok(())
}

/// Whether both slides moved far enough.
fn check_ways(readings: &[SlideReading]) -> Result<(), SlideError> {
    for (k, slide) in ['U', 'V'].into_iter().enumerate() {
        let at = readings.iter().map(|reading| reading.slides_mm[k]);
        let (low, high) = at.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        if high - low < LEAST_WAY_MM {
            let way_mm = high - low;
            return Err(SlideError::Steps { slide, way_mm });
        }
    }
    Ok(())
}

/// Whether they moved in two directions.
fn check_spread(own: &[[f64; 6]]) -> Result<(), SlideError> {
    let mean = |i: usize, j: usize| own.iter().map(|row| row[i] * row[j]).sum::<f64>() / own.len() as f64;
    let (uu, vv, uv) = (mean(0, 0), mean(1, 1), mean(0, 1));
    let smallest = (uu + vv) / 2.0 - ((uu - vv) / 2.0).hypot(uv);
    let spread = smallest.max(0.0).sqrt();
    if spread < LEAST_SPREAD_MM {
        let spread_um = 1e3 * spread;
        return Err(SlideError::Collinear { spread_um });
    }
    Ok(())
}

/// For each reading the mean of its place's rows; how many places there are.
fn means(readings: &[SlideReading], rows: &[[f64; 6]]) -> (Vec<[f64; 6]>, usize) {
    let mut sums = BTreeMap::<u32, ([f64; 6], f64)>::new();
    for (reading, row) in readings.iter().zip(rows) {
        let (sum, count) = sums.entry(reading.place).or_default();
        *count += 1.0;
        for (sum, x) in sum.iter_mut().zip(row) {
            *sum += x;
        }
    }
    let mean = |reading: &SlideReading| {
        let (sum, count) = sums[&reading.place];
        sum.map(|sum| sum / count)
    };
    (readings.iter().map(mean).collect(), sums.len())
}

fn difference(a: &[f64; 6], b: &[f64; 6]) -> [f64; 6] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// The direction in which each slide last moved, −1 or 1; 0 as long as it has not.
fn directions(readings: &[SlideReading]) -> Vec<[f64; 2]> {
    let mut direction = [0.0; 2];
    let mut before = readings.first().map_or([0.0; 2], |reading| reading.slides_mm);
    let next = |reading: &SlideReading| {
        for axis in 0..2 {
            let way = reading.slides_mm[axis] - before[axis];
            if way.abs() > AT_REST_MM {
                direction[axis] = way.signum();
            }
        }
        before = reading.slides_mm;
        direction
    };
    readings.iter().map(next).collect()
}
