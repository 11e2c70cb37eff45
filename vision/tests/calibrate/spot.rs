//! Marks as a camera would see them that is mounted so; what is found is how it is.

use vision::calibrate::{BurntMark, Found, MarkSighting, SpotError, SpotFit, spot_offset};
use vision::render::SplitMix64;

/// How the camera is.
const OFFSET: [f64; 2] = [0.05, -0.03];
const LEAD: f64 = 10.7;
const DELAY: f64 = 0.0015;
/// Half the width of a mark.
const HALF: f64 = 0.08;
/// Turned by 30°, as the matrix of the shipped machine.
const MATRIX: [[f64; 2]; 2] = [[-0.866_025_403_784, 0.5], [-0.5, -0.866_025_403_784]];
/// The other beam comes from 60° beside.
const OTHER: [f64; 2] = [-0.866_025_403_784, 0.5];

fn marks(other: [f64; 2]) -> [BurntMark; 2] {
    let mark = |from: f64, u: f64, v: f64, beam| BurntMark {
        ends_mm: [[from, u, v], [from + 25.0, u + 0.01, v]],
        beam,
    };
    [mark(0.0, 0.02, 0.1, [0.0, 1.0]), mark(30.0, 0.015, 0.13, other)]
}

/// What is wrong with the pictures.
#[derive(Clone, Copy, Default)]
struct Trouble {
    /// Scatter of a picture \[mm\].
    scatter: f64,
    /// How far the first mark is bent \[mm\].
    bent: f64,
    /// Scatter of the ends \[mm\].
    ends: f64,
}

/// Passes at these speeds \[mm/s\], 200 pictures a second, over a plate whose height the beams hit at `height` along the own one.
fn sightings(marks: &[BurntMark; 2], speeds: &[f64], height: f64, trouble: Trouble) -> Vec<MarkSighting> {
    let mut random = SplitMix64::new(7);
    let [m0, m1] = MATRIX;
    let determinant = m0[0] * m1[1] - m0[1] * m1[0];
    let mut sightings = Vec::new();
    for (pass, speed) in (0..).zip(speeds) {
        let step = speed.abs() / 200.0;
        for k in 0..(70.0 / step) as u32 {
            let way = f64::from(k) * step - 7.0;
            let at = if *speed > 0.0 { way } else { 55.0 - way };
            let head = [at - LEAD, 0.012, 0.11];
            // Where it exposes.
            let here = head[0] + speed * DELAY;
            let mut sighting = MarkSighting {
                pass,
                head_mm: head,
                speed_mm_s: *speed,
                seen_mm: None,
                ends_mm: [None; 2],
            };
            for (number, mark) in marks.iter().enumerate() {
                let [from, to] = mark.ends_mm;
                let centre = here + LEAD;
                for (end, at) in [from[0] - HALF, to[0] + HALF].into_iter().enumerate() {
                    let [stray, _] = random.gauss();
                    let seen = at - centre + trouble.ends * stray;
                    if seen.abs() < 0.8 {
                        sighting.ends_mm[end] = Some(seen);
                    }
                }
                if !(from[0] - HALF..to[0] + HALF).contains(&centre) {
                    continue;
                }
                let share = (centre - from[0]) / (to[0] - from[0]);
                let [u, v] = [1, 2].map(|i| from[i] + (to[i] - from[i]) * share);
                // The plate is met somewhere along the beam.
                let bow = if number == 0 {
                    trouble.bent * (centre / 4.0).sin()
                } else {
                    0.0
                };
                let point = [u + mark.beam[0] * height + bow, v + mark.beam[1] * height];
                let delta = [0, 1].map(|i| point[i] - head[i + 1] - OFFSET[i]);
                let [a, b] = random.gauss();
                sighting.seen_mm = Some([
                    (m1[1] * delta[0] - m0[1] * delta[1]) / determinant + trouble.scatter * a,
                    0.0,
                    (m0[0] * delta[1] - m1[0] * delta[0]) / determinant + trouble.scatter * b,
                ]);
            }
            sightings.push(sighting);
        }
    }
    sightings
}

const SPEEDS: [f64; 4] = [30.0, -30.0, 100.0, -100.0];

fn fit(speeds: &[f64], height: f64, trouble: Trouble) -> Result<SpotFit, SpotError> {
    let marks = marks(OTHER);
    spot_offset(&marks, &sightings(&marks, speeds, height, trouble), MATRIX, 10.0)
}

#[test]
fn two_marks_tell_where_the_camera_is_whatever_the_height_of_the_plate() {
    for height in [-0.2, 0.0, 0.15] {
        let found = fit(&SPEEDS, height, Trouble::default()).expect("a spot");
        let v = found.offset_v_mm.expect("V");
        assert!((found.offset_u_mm.value - OFFSET[0]).abs() < 1e-4, "{found:?}");
        assert!((v.value - OFFSET[1]).abs() < 1e-4, "{found:?}");
        assert!((found.lead_mm.value - LEAD).abs() < 1e-6, "{found:?}");
        assert!((found.delay_s.value - DELAY).abs() < 1e-8, "{found:?}");
        assert!((found.longer_mm - HALF).abs() < 1e-6, "{found:?}");
    }
}

#[test]
fn uncertainties_are_those_of_the_scatter() {
    let trouble = Trouble {
        scatter: 0.006,
        ends: 0.02,
        ..Trouble::default()
    };
    let found = fit(&SPEEDS, 0.0, trouble).expect("a spot");
    let off = |found: Found, is: f64| (found.value - is).abs() / found.sigma;
    let v = found.offset_v_mm.expect("V");
    for (found, is) in [
        (found.offset_u_mm, OFFSET[0]),
        (v, OFFSET[1]),
        (found.lead_mm, LEAD),
        (found.delay_s, DELAY),
    ] {
        assert!(found.sigma > 0.0 && off(found, is) < 3.0, "{found:?} {is}");
    }
    assert!(
        found.offset_u_mm.sigma < 0.002 && found.delay_s.sigma < 1e-4,
        "{found:?}"
    );
}

#[test]
fn beams_that_are_parallel_tell_nothing_of_the_height() {
    let marks = marks([0.05, 0.998_749]);
    let found = spot_offset(
        &marks,
        &sightings(&marks, &SPEEDS, 0.1, Trouble::default()),
        MATRIX,
        10.0,
    )
    .expect("a spot");
    assert_eq!(found.offset_v_mm, None);
    assert!((found.offset_u_mm.value - OFFSET[0]).abs() < 1e-4, "{found:?}");
}

#[test]
fn a_poor_fit_is_refused_with_its_reason() {
    let bent = Trouble {
        bent: 0.016,
        ..Trouble::default()
    };
    let ragged = Trouble {
        ends: 0.25,
        ..Trouble::default()
    };
    let loose = Trouble {
        scatter: 0.02,
        ..Trouble::default()
    };
    let refused = |speeds: &[f64], trouble| fit(speeds, 0.0, trouble).expect_err("no spot").to_string();
    for (speeds, trouble, says) in [
        (&SPEEDS[..], bent, "mark of beam 1 is not straight"),
        (&SPEEDS, loose, "pictures scatter by"),
        (&SPEEDS, ragged, "rms off what any lead and delay say"),
        (
            &[30.0, 30.0],
            Trouble::default(),
            "two speeds and in both directions",
        ),
        (
            &[30.0, 30.0, 30.0],
            Trouble::default(),
            "two speeds and in both directions",
        ),
        (&[], Trouble::default(), "0 of 0 pictures show a mark"),
    ] {
        let error = refused(speeds, trouble);
        assert!(error.contains(says), "{says}: {error}");
    }
    // One of the marks is missing.
    let marks = marks(OTHER);
    let mut seen = sightings(&marks, &SPEEDS, 0.0, Trouble::default());
    for sighting in &mut seen {
        sighting.seen_mm = sighting.seen_mm.filter(|_| sighting.head_mm[0] < 18.0);
    }
    let error = spot_offset(&marks, &seen, MATRIX, 10.0).expect_err("no spot");
    assert!(matches!(error, SpotError::Few { beam: 2, .. }), "{error:?}");
}
