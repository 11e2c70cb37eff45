use super::common::{NOISE, OPTICS, detector};
use super::image;
use proptest::prelude::*;
use vision::calibrate::{SlideError, SlideFit, SlideReading, slide_matrix};
use vision::render::{Finish, Gap, Joint, Scene, Texture, TruthRenderer};
use vision::{Optics, PlateSeam, Prior};

/// By the drawing the camera is turned by −30° against its head.
const MOUNT: f64 = -30.0;

/// [ΔU ΔV] = matrix · [u n] of a camera turned by `mount` degrees whose picture shows `scale` times too little.
fn matrix(mount: f64, scale: f64) -> [[f64; 2]; 2] {
    let (sin, cos) = mount.to_radians().sin_cos();
    [[-cos * scale, sin * scale], [-sin * scale, -cos * scale]]
}

/// Where the seam is seen with the slides at a place; at `zero` the camera's origin is on it.
fn seen([[a, b], [c, d]]: [[f64; 2]; 2], zero: [f64; 2], [u, v]: [f64; 2]) -> [f64; 2] {
    let (u, v, one) = (zero[0] - u, zero[1] - v, 1.0 / (a * d - b * c));
    [(d * u - b * v) * one, (a * v - c * u) * one]
}

/// Each slide out to both sides and back.
fn steps(size: f64) -> Vec<[f64; 2]> {
    let way = [0.0, 1.0, 2.0, 1.0, 0.0, -1.0, -2.0, -1.0, 0.0].map(|x| x * size);
    let along = |axis: usize| way.map(|x| if axis == 0 { [x, 0.0] } else { [0.0, x] });
    [along(0), along(1)].concat()
}

fn readings(truth: [[f64; 2]; 2], zero: [f64; 2], size: f64) -> Vec<SlideReading> {
    let reading = |slides_mm| SlideReading {
        place: 0,
        slides_mm,
        seen_mm: seen(truth, zero, slides_mm),
    };
    steps(size).into_iter().map(reading).collect()
}

fn fit(readings: &[SlideReading]) -> Result<SlideFit, SlideError> {
    slide_matrix(readings, matrix(MOUNT, 1.0))
}

/// From pictures of 8 places: a camera that is turned by 0.7° more and has a lens of 4.06 instead of 4.00. The matrix to
/// 0.2 % across, 1 % (mathematics 0.12) in height, which the texture shifts; the turn to 0.1°; its origin to
/// 2 µm.
#[test]
fn a_camera_that_is_not_as_drawn_is_found_from_its_pictures() {
    let truth = matrix(MOUNT + 0.7, 1.0);
    let optics = Optics {
        magnification: 4.06,
        ..OPTICS
    };
    let mut renderer = TruthRenderer::new(optics, NOISE, 1).expect("a renderer");
    let mut detector = detector();
    let zero = [0.031, -0.044];
    let mut take = |place: u32, slides_mm: [f64; 2]| {
        let [u, n] = seen(truth, zero, slides_mm);
        let roll = 0.7f64.to_radians();
        let gap = Gap::new(PlateSeam {
            height_mm: n - roll * u,
            pitch: 0.0,
            roll,
            lateral_mm: u,
            yaw_rad: 0.0,
            width_mm: 0.12,
        });
        let scene = Scene {
            position_mm: [10.0, -u],
            ..Scene::new(Joint::Gap(gap), Texture::new(Finish::Plain, u64::from(place)))
        };
        let pixels = renderer.render(&scene, (1e4 * (3.0 + u + 2.0 * n)) as u64);
        let prior = Prior {
            joint: vision::Joint::Gap,
            track: None,
            focus: 0.0,
        };
        let report = detector.measure(&image(&pixels), &prior).expect("a measurement");
        let measured = report.seam().expect("a seam");
        SlideReading {
            place,
            slides_mm,
            seen_mm: [measured.lateral_on_axis_mm(), measured.height_mm],
        }
    };
    let at = |place| steps(0.1).into_iter().map(move |slides_mm| (place, slides_mm));
    let readings: Vec<_> = (0..8)
        .flat_map(at)
        .map(|(place, slides)| take(place, slides))
        .collect();
    let fit = fit(&readings).expect("a matrix");
    let truth = matrix(MOUNT + 0.7, 4.0 / 4.06);
    for (found, is) in fit.matrix.iter().zip(truth) {
        assert!((found[0] - is[0]).abs() < 0.002, "across: {found:?} is {is:?}");
        assert!((found[1] - is[1]).abs() < 0.010, "height: {found:?} is {is:?}");
    }
    assert!((fit.rotation_rad.to_degrees() - 0.7).abs() < 0.1, "{fit:?}");
    for (found, is) in fit.zero_mm.iter().zip(zero) {
        assert!((found - is).abs() < 0.002, "{fit:?}");
    }
    assert!(fit.residual_mm < 0.002, "{fit:?}");
}

proptest! {
    /// Without noise everything comes back that was put in.
    #[test]
    fn matrix_zero_and_turn_come_back(
        turn in -9.0..9.0f64, scale in 0.92..1.08f64, u in -0.2..0.2f64, v in -0.2..0.2f64,
    ) {
        let truth = matrix(MOUNT + turn, scale);
        let fit = fit(&readings(truth, [u, v], 0.1)).expect("a matrix");
        for (found, is) in fit.matrix.concat().iter().zip(truth.concat()) {
            prop_assert!((found - is).abs() < 1e-9);
        }
        prop_assert!((fit.zero_mm[0] - u).abs() < 1e-9 && (fit.zero_mm[1] - v).abs() < 1e-9);
        prop_assert!((fit.rotation_rad.to_degrees() - turn).abs() < 1e-7);
        prop_assert!(fit.scale.iter().all(|s| (s - (scale - 1.0)).abs() < 1e-9));
        prop_assert!(fit.skew_rad.abs() < 1e-9 && fit.residual_mm < 1e-9);
    }
}

/// Slides whose camera lags by 6 and 10 µm of play: the play is reported, and does not move the matrix.
#[test]
fn play_of_the_slides_is_told() {
    let truth = matrix(MOUNT, 1.0);
    let mut last = [0.0, 0.0];
    let mut side = [0.0, 0.0];
    let reading = |slides_mm: [f64; 2]| {
        for k in 0..2 {
            if slides_mm[k] != last[k] {
                side[k] = (slides_mm[k] - last[k]).signum();
            }
        }
        last = slides_mm;
        let camera = [slides_mm[0] - 0.003 * side[0], slides_mm[1] - 0.005 * side[1]];
        SlideReading {
            place: 0,
            slides_mm,
            seen_mm: seen(truth, [0.0; 2], camera),
        }
    };
    let readings: Vec<_> = steps(0.1).into_iter().map(reading).collect();
    let fit = fit(&readings).expect("a matrix");
    let [u, v] = fit.backlash_mm.map(|play| play.expect("both ways"));
    assert!((u - 0.006).abs() < 1e-6 && (v - 0.010).abs() < 1e-6, "{fit:?}");
    for (found, is) in fit.matrix.concat().iter().zip(truth.concat()) {
        assert!((found - is).abs() < 1e-6, "{fit:?}");
    }
}

/// One way only: nothing is said of play.
#[test]
fn one_way_tells_no_play() {
    let truth = matrix(MOUNT, 1.0);
    let reading = |k: u32| {
        let slides_mm = [0.06 * f64::from(k), 0.06 * f64::from(k * k) / 9.0];
        SlideReading {
            place: 0,
            slides_mm,
            seen_mm: seen(truth, [0.0; 2], slides_mm),
        }
    };
    let fit = fit(&(0..10).map(reading).collect::<Vec<_>>()).expect("a matrix");
    assert_eq!(fit.backlash_mm, [None, None]);
}

#[test]
fn what_tells_no_matrix_is_refused() {
    let good = readings(matrix(MOUNT, 1.0), [0.0; 2], 0.1);
    assert_eq!(fit(&good[..7]), Err(SlideError::Few { found: 7 }));
    let small = readings(matrix(MOUNT, 1.0), [0.0; 2], 0.02);
    assert!(matches!(fit(&small), Err(SlideError::Steps { slide: 'U', .. })));
    let line = |k: u32| {
        let slides_mm = [0.05 * f64::from(k), -0.05 * f64::from(k)];
        SlideReading {
            place: 0,
            slides_mm,
            seen_mm: seen(matrix(MOUNT, 1.0), [0.0; 2], slides_mm),
        }
    };
    let line: Vec<_> = (0..10).map(line).collect();
    assert!(matches!(fit(&line), Err(SlideError::Collinear { spread_um }) if spread_um < 1.0));
}

#[test]
fn a_reading_of_something_else_is_refused_and_named() {
    let mut wild = readings(matrix(MOUNT, 1.0), [0.0; 2], 0.1);
    wild[5].seen_mm[0] += 0.08;
    let error = fit(&wild).unwrap_err();
    assert!(matches!(error, SlideError::Residual { worst: 6, .. }), "{error}");
}

#[test]
fn a_camera_that_is_not_the_drawn_one_is_refused() {
    let mirrored = matrix(MOUNT, 1.0).map(|[u, n]| [-u, n]);
    assert_eq!(fit(&readings(mirrored, [0.0; 2], 0.1)), Err(SlideError::Mirrored));
    let other = fit(&readings(matrix(-MOUNT, 1.0), [0.0; 2], 0.1));
    assert!(
        matches!(other, Err(SlideError::Rotated { degrees }) if (degrees - 60.0).abs() < 1e-6),
        "{other:?}"
    );
    let finer = fit(&readings(matrix(MOUNT, 2.0), [0.0; 2], 0.1));
    assert!(
        matches!(finer, Err(SlideError::Scale { along: "u", percent }) if (percent - 100.0).abs() < 1e-6),
        "{finer:?}"
    );
    let still: Vec<_> = readings(matrix(MOUNT, 1.0), [0.0; 2], 0.1)
        .into_iter()
        .map(|reading| SlideReading {
            seen_mm: [0.02, 0.01],
            ..reading
        })
        .collect();
    assert_eq!(fit(&still), Err(SlideError::Still));
}
