//! Where a camera looks beside its spot, from marks that beams have burnt.
//!
//! All is told in the frame of the head as it stood before the marks: along travel, U, V. A mark lies on its beam's axis, wherever
//! along it the plate is. So the mark of the head's own beam tells the offset across that beam, which is U, whatever the height of
//! the plate; that of the other head's beam, which comes from the side, tells the offset across that one, and with it V.

use super::least_squares::LeastSquares;
use nalgebra::{Matrix3, Vector3};
use thiserror::Error;

/// Marks are divided along travel into parts so long \[mm\]: work has another texture in each, which moves what is measured by
/// about a µm, the same way in every pass.
const PART_MM: f64 = 1.0;
/// So many neighbouring parts are off alike: waves of a machine's guideways, scales and cogging reach over them.
const ALIKE: f64 = 4.0;
/// Fewest such parts of a mark that are seen.
const FEWEST_PARTS: usize = 8;
/// Nearer to an end of a mark than this it is not measured \[mm\]: an end that is in focus is round.
const END_MM: f64 = 0.5;
/// Ends are looked for so near to where they should be by what is believed of the lead \[mm\].
const NEAR_MM: f64 = 2.4;
/// An end further from the middle one of its pass is none \[mm\]: spatter, or a tail of the mark.
const STRAY_MM: f64 = 0.15;
/// Largest scatter of pictures about a straight mark, of the parts of one about a line, and of the ends of passes about what lead
/// and delay say, each the root of the mean square \[mm\].
const SCATTER_MM: f64 = 0.012;
const BENT_MM: f64 = 0.006;
const ENDS_MM: f64 = 0.08;
/// Fewest ends that are seen, each counted once a pass: half of those of two marks in four passes.
const FEWEST_ENDS: usize = 8;
/// What the camera–slide matrix may be wrong by: it is calibrated to 1 %.
const SCALE: f64 = 0.01;
/// What is in every picture of a mark alike \[mm\]: play of a slide between its encoder and the head, 0.5 to 2 µm, what both heads' axes
/// repeat to, and what is left of the texture in heights.
const FLOOR_MM: f64 = 0.0015;
/// Least sine of the angle between two beams at which the other one's mark tells the height.
const LEAST_SINE: f64 = 0.2;

/// A mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BurntMark {
    /// Where the spot was when the beam went on and when it went off: along travel, U, V \[mm\].
    pub ends_mm: [[f64; 3]; 2],
    /// Direction of the beam in U and V, of unit length.
    pub beam: [f64; 2],
}

/// What a picture shows of the marks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkSighting {
    /// Number of the pass over the marks in which it was taken.
    pub pass: u32,
    /// Where the head was at the strobe: along travel, U, V \[mm\].
    pub head_mm: [f64; 3],
    /// How fast it went along travel \[mm/s\].
    pub speed_mm_s: f64,
    /// u, a and n of the mark in the camera's frame, if one is seen \[mm\].
    pub seen_mm: Option<[f64; 3]>,
    /// a of the ends that are seen, behind and ahead \[mm\].
    pub ends_mm: [Option<f64>; 2],
}

/// A value and its standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// The value.
    pub value: f64,
    /// One standard deviation.
    pub sigma: f64,
}

/// Where a camera looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotFit {
    /// Offset in U: \[ΔU ΔV\] = matrix · \[u n\] + offset \[mm\].
    pub offset_u_mm: Found,
    /// Offset in V \[mm\]; `None` where both beams are parallel.
    pub offset_v_mm: Option<Found>,
    /// How far it is ahead of the spot \[mm\].
    pub lead_mm: Found,
    /// From the strobe to the exposure \[s\].
    pub delay_s: Found,
    /// Scatter of a picture about the marks \[mm\].
    pub scatter_mm: f64,
    /// What the marks are not straight by \[mm\].
    pub bent_mm: f64,
    /// How much longer a mark is at either end than the way of its spot: half of its width, about \[mm\].
    pub longer_mm: f64,
    /// Where in the picture the mark of the head's own beam is, u and n on the mean \[mm\].
    pub seen_mm: [f64; 2],
    /// Pictures that show a mark.
    pub pictures: usize,
    /// Ends that were seen, each counted once a pass.
    pub ends: usize,
}

/// Why pictures of marks do not tell where the camera looks.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SpotError {
    /// Nothing is seen where a mark should be.
    #[error(
        "{seen} of {pictures} pictures show a mark, and the mark of beam {beam} in {parts} mm of it only; at least {FEWEST_PARTS} mm are needed: is there a bare plate, did both beams burn, and is the mark a dark line of 0.05 to 0.3 mm?"
    )]
    Few {
        /// Pictures with a mark.
        seen: usize,
        /// All pictures.
        pictures: usize,
        /// 1 for the head's own beam, 2 for the other one.
        beam: usize,
        /// How much of it was seen \[mm\].
        parts: usize,
    },
    /// Too few ends.
    #[error(
        "ends of the marks were seen {found} times; at least {FEWEST_ENDS} are needed, at two speeds and in both directions: do the marks end sharply, within 2.4 mm of where the lead of the machine file has them?"
    )]
    Ends {
        /// How often.
        found: usize,
    },
    /// Pictures do not agree.
    #[error(
        "the pictures scatter by {um:.1} µm about the marks (may be 12 µm): is something loose, or the mark ragged?"
    )]
    Scatter {
        /// Root of the mean square \[µm\].
        um: f64,
    },
    /// It is bent.
    #[error(
        "the mark of beam {beam} is not straight: parts of it are {um:.1} µm rms off a line (may be 6 µm); did the plate move or warp, or do loops swing (seamwright commission)?"
    )]
    Bent {
        /// 1 for the head's own beam, 2 for the other one.
        beam: usize,
        /// Root of the mean square \[µm\].
        um: f64,
    },
    /// Ends do not agree.
    #[error(
        "ends of the marks are {um:.0} µm rms off what any lead and delay say (may be 80 µm): do the beams go on and off sharply?"
    )]
    Ragged {
        /// Root of the mean square \[µm\].
        um: f64,
    },
}

/// Where the camera looks by what it saw of the mark of its own head's beam, and of that of the other head's. `matrix` is that of
/// the slides, `lead_mm` what is believed of the lead.
pub fn spot_offset(
    marks: &[BurntMark; 2],
    sightings: &[MarkSighting],
    matrix: [[f64; 2]; 2],
    lead_mm: f64,
) -> Result<SpotFit, SpotError> {
    // Where nothing is seen at all, that is to be said, and not that there are no ends.
    let believed = [0, 1].map(|mark| readings(marks, mark, sightings, matrix, lead_mm));
    let pictures = believed.iter().map(Vec::len).sum();
    for (k, readings) in believed.iter().enumerate() {
        let parts = parts(readings).len();
        if parts < FEWEST_PARTS {
            return Err(SpotError::Few {
                seen: pictures,
                pictures: sightings.len(),
                beam: k + 1,
                parts,
            });
        }
    }
    let along = along(marks, sightings, lead_mm)?;
    let lead_mm = along.lead_mm.value;
    let mut across = [Across::default(); 2];
    for (mark, across) in across.iter_mut().enumerate() {
        *across = Across::of(&readings(marks, mark, sightings, matrix, lead_mm), mark)?;
    }
    let [own, other] = marks.each_ref().map(|mark| normal(mark.beam));
    // own · offset = −own mean, other · offset = −other mean.
    let sine = own[0] * other[1] - own[1] * other[0];
    let [r, s] = across.map(|across| -across.mean.value);
    let offset_u_mm;
    let mut offset_v_mm = None;
    if sine.abs() >= LEAST_SINE {
        let [sigma_r, sigma_s] = across.map(|across| across.mean.sigma);
        let solved = |a: f64, b: f64| Found {
            value: (a * r + b * s) / sine,
            sigma: (a * sigma_r).hypot(b * sigma_s) / sine.abs(),
        };
        offset_u_mm = solved(other[1], -own[1]);
        offset_v_mm = Some(solved(-other[0], own[0]));
    } else {
        offset_u_mm = Found {
            value: r / own[0],
            sigma: across[0].mean.sigma / own[0].abs(),
        };
    }
    Ok(SpotFit {
        offset_u_mm,
        offset_v_mm,
        scatter_mm: across[0].scatter_mm.max(across[1].scatter_mm),
        bent_mm: across[0].bent_mm.max(across[1].bent_mm),
        seen_mm: across[0].seen_mm,
        pictures,
        ..along
    })
}

/// Square to a beam in U and V.
fn normal([u, v]: [f64; 2]) -> [f64; 2] {
    [v, -u]
}

/// How far a picture has a mark beside its beam's axis, without the offset.
#[derive(Clone, Copy, Debug)]
struct Reading {
    pass: u32,
    /// Place along the mark \[mm\].
    along_mm: f64,
    beside_mm: f64,
    /// How much of that comes from the place in the picture \[mm\].
    in_picture_mm: f64,
    /// u and n of that place \[mm\].
    seen_mm: [f64; 2],
}

/// Readings of a mark, by pictures that show it well within its ends if the camera is `lead_mm` ahead.
fn readings(
    marks: &[BurntMark; 2],
    mark: usize,
    sightings: &[MarkSighting],
    [row_u, row_v]: [[f64; 2]; 2],
    lead_mm: f64,
) -> Vec<Reading> {
    let BurntMark {
        ends_mm: [from, to],
        beam,
    } = marks[mark];
    let e = normal(beam);
    let reading = |sighting: &MarkSighting| {
        let [u, a, n] = sighting.seen_mm?;
        let [along, head_u, head_v] = sighting.head_mm;
        let along_mm = along + lead_mm + a;
        let share = (along_mm - from[0]) / (to[0] - from[0]);
        let in_picture = [row_u, row_v].map(|row| row[0] * u + row[1] * n);
        let beside =
            |k: usize, head: f64| head + in_picture[k] - (from[k + 1] + (to[k + 1] - from[k + 1]) * share);
        (from[0] + END_MM..to[0] - END_MM)
            .contains(&along_mm)
            .then_some(Reading {
                pass: sighting.pass,
                along_mm,
                beside_mm: e[0] * beside(0, head_u) + e[1] * beside(1, head_v),
                in_picture_mm: e[0] * in_picture[0] + e[1] * in_picture[1],
                seen_mm: [u, n],
            })
    };
    sightings.iter().filter_map(reading).collect()
}

/// Means of the readings in each part of a mark: place along it, and beside it \[mm\].
fn parts(readings: &[Reading]) -> Vec<[f64; 2]> {
    let mut sums = std::collections::BTreeMap::<i64, ([f64; 2], f64)>::new();
    for reading in readings {
        let (sum, count) = sums
            .entry((reading.along_mm / PART_MM).floor() as i64)
            .or_default();
        sum[0] += reading.along_mm;
        sum[1] += reading.beside_mm;
        *count += 1.0;
    }
    sums.into_values()
        .map(|(sum, count)| sum.map(|sum| sum / count))
        .collect()
}

/// Standard deviation of values, and their mean.
fn spread(values: &[f64]) -> Found {
    let count = values.len() as f64;
    let value = values.iter().sum::<f64>() / count;
    let squares = values.iter().map(|x| (x - value).powi(2)).sum::<f64>();
    Found {
        value,
        sigma: (squares / (count - 1.0).max(1.0)).sqrt(),
    }
}

/// What the pictures say across one mark.
#[derive(Clone, Copy, Debug, Default)]
struct Across {
    mean: Found,
    scatter_mm: f64,
    bent_mm: f64,
    seen_mm: [f64; 2],
}

impl Across {
    fn of(readings: &[Reading], mark: usize) -> Result<Self, SpotError> {
        let parts = parts(readings);
        let few = || SpotError::Few {
            seen: readings.len(),
            pictures: readings.len(),
            beam: mark + 1,
            parts: parts.len(),
        };
        let mut line = LeastSquares::<2, 1>::new();
        for [along, beside] in &parts {
            line.add([1.0, *along], [*beside], 1.0);
        }
        let line = line.solve().ok_or_else(few)?;
        let off_line = |[along, beside]: [f64; 2]| beside - line[0] - line[1] * along;
        let rms = |values: &mut dyn Iterator<Item = f64>| {
            let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x * x, count + 1.0));
            f64::sqrt(sum / count)
        };
        let scatter_mm = rms(&mut readings.iter().map(|r| off_line([r.along_mm, r.beside_mm])));
        if scatter_mm > SCATTER_MM {
            return Err(SpotError::Scatter { um: 1e3 * scatter_mm });
        }
        let beside: Vec<f64> = parts.iter().map(|part| part[1]).collect();
        let by_part = Found {
            value: spread(&beside).value,
            ..spread(&parts.iter().map(|part| off_line(*part)).collect::<Vec<_>>())
        };
        let bent_mm = by_part.sigma;
        if bent_mm > BENT_MM {
            return Err(SpotError::Bent {
                beam: mark + 1,
                um: 1e3 * bent_mm,
            });
        }
        // What differs from pass to pass is what the machine and its slides repeat to.
        let mut passes: Vec<u32> = readings.iter().map(|reading| reading.pass).collect();
        passes.sort_unstable();
        passes.dedup();
        let of_pass = |pass: &u32| {
            let of = readings.iter().filter(|reading| reading.pass == *pass);
            let of: Vec<f64> = of.map(|reading| reading.beside_mm).collect();
            spread(&of).value
        };
        let by_pass = spread(&passes.iter().map(of_pass).collect::<Vec<_>>());
        let scale = SCALE * rms(&mut readings.iter().map(|reading| reading.in_picture_mm));
        let independent = |spread: Found, count: f64| spread.sigma / count.sqrt();
        Ok(Self {
            mean: Found {
                value: by_part.value,
                sigma: independent(by_part, parts.len() as f64 / ALIKE)
                    .hypot(independent(by_pass, passes.len() as f64))
                    .hypot(scale)
                    .hypot(FLOOR_MM),
            },
            scatter_mm,
            bent_mm,
            seen_mm: [0, 1].map(|k| {
                let seen: Vec<f64> = readings.iter().map(|reading| reading.seen_mm[k]).collect();
                spread(&seen).value
            }),
        })
    }
}

/// Lead and delay by the ends of the marks; nothing of the rest yet.
fn along(marks: &[BurntMark; 2], sightings: &[MarkSighting], lead_mm: f64) -> Result<SpotFit, SpotError> {
    let mut passes: Vec<u32> = sightings.iter().map(|sighting| sighting.pass).collect();
    passes.sort_unstable();
    passes.dedup();
    // Speed, which end, and how far the head was from it when the camera saw it in the middle of its picture.
    let mut ends: Vec<[f64; 3]> = Vec::new();
    for pass in passes {
        for mark in marks {
            for (k, end) in mark.ends_mm.iter().enumerate() {
                let seen = |sighting: &MarkSighting| {
                    let from = end[0] - sighting.head_mm[0] - sighting.ends_mm[k]?;
                    ((from - lead_mm).abs() < NEAR_MM).then_some([sighting.speed_mm_s, from])
                };
                let of = sightings.iter().filter(|sighting| sighting.pass == pass);
                let mut seen: Vec<[f64; 2]> = of.filter_map(seen).collect();
                if seen.is_empty() {
                    continue;
                }
                seen.sort_by(|a, b| a[1].total_cmp(&b[1]));
                let middle = seen[seen.len() / 2][1];
                seen.retain(|[_, from]| (from - middle).abs() < STRAY_MM);
                let count = seen.len() as f64;
                let mean = |i: usize| seen.iter().map(|x| x[i]).sum::<f64>() / count;
                ends.push([mean(0), [1.0, -1.0][k], mean(1)]);
            }
        }
    }
    let few = SpotError::Ends { found: ends.len() };
    if ends.len() < FEWEST_ENDS {
        return Err(few);
    }
    let rows = || {
        ends.iter()
            .map(|[speed, end, from]| (Vector3::new(1.0, *speed, *end), *from))
    };
    let information: Matrix3<f64> = rows().map(|(x, _)| x * x.transpose()).sum();
    let sums: Vector3<f64> = rows().map(|(x, from)| x * from).sum();
    // Speeds or ends of one kind only tell nothing of the others.
    let inverse = information.try_inverse().filter(|inverse| {
        let [lead, delay, longer] = [0, 1, 2].map(|k| inverse[(k, k)]);
        let fastest = ends
            .iter()
            .fold(0.0, |fastest: f64, end| fastest.max(end[0].abs()));
        lead < 1.0 && longer < 1.0 && delay * fastest * fastest < 1.0
    });
    let inverse = inverse.ok_or(few)?;
    let found = inverse * sums;
    let squares: f64 = rows().map(|(x, from)| (from - x.dot(&found)).powi(2)).sum();
    let rms = (squares / ends.len() as f64).sqrt();
    if rms > ENDS_MM {
        return Err(SpotError::Ragged { um: 1e3 * rms });
    }
    let variance = squares / (ends.len() - 3) as f64;
    let found = [0, 1, 2].map(|k| Found {
        value: found[k],
        sigma: (variance * inverse[(k, k)]).sqrt(),
    });
    Ok(SpotFit {
        offset_u_mm: Found::default(),
        offset_v_mm: None,
        lead_mm: found[0],
        delay_s: found[1],
        scatter_mm: 0.0,
        bent_mm: 0.0,
        seen_mm: [0.0; 2],
        longer_mm: found[2].value,
        pictures: 0,
        ends: ends.len(),
    })
}
