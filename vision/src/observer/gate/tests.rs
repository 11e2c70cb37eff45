//! What is believed of things that are seen one after the other.

use super::*;
use crate::report::{Second, Sigma};

/// Way from picture to picture, how far the camera looks ahead, half the view \[mm\].
const STEP_MM: f64 = 0.5;
const JUMP_MM: f64 = 10.0;
const VIEW_MM: [f64; 2] = [1.0, 0.5];

/// A camera that goes along a seam, and what becomes of its pictures.
struct Bench {
    gate: Gate,
    camera: Moved,
    step_mm: f64,
}

impl Bench {
    /// It has followed a gap in its middle, 0.1 mm wide, for 8 pictures.
    fn following() -> Self {
        let mut bench = Self {
            gate: Gate::new(0.1, JUMP_MM, VIEW_MM),
            camera: Moved::default(),
            step_mm: STEP_MM,
        };
        let believed = (0..8).filter(|_| bench.sees(gap(0.0, 0.1))).count();
        assert_eq!(believed, 6);
        bench
    }

    /// Whether what it sees next is believed.
    fn sees(&mut self, measured: Measured) -> bool {
        self.camera.travel_mm += self.step_mm;
        let status = if measured.quality >= 0.5 {
            Status::Seam
        } else {
            Status::NoSeam
        };
        let report = Report {
            status,
            measured: Some(measured),
        };
        let verdict = self.gate.judge(&report, Some(&measured), &self.camera);
        matches!(verdict, Verdict::Accept { .. })
    }
}

fn gap(lateral_mm: f64, width_mm: f64) -> Measured {
    Measured {
        form: Form::Gap,
        lateral_mm,
        travel_mm: 0.0,
        height_mm: 0.0,
        width_mm,
        step_mm: 0.0,
        roll: 0.0,
        walls: [0.0; 2],
        yaw_rad: 0.0,
        focus: 0.0,
        quality: 1.0,
        weakest: None,
        gain: 1.0,
        contrast: 100.0,
        sigma: Sigma {
            lateral_mm: 0.001,
            height_mm: 0.01,
            width_mm: 0.0036,
            step_mm: 0.01,
            roll: 0.01,
            walls: [0.01; 2],
            yaw_rad: 0.01,
        },
        second: None,
    }
}

/// A plate with nothing on it that may be a seam.
fn plate() -> Measured {
    let mut plate = gap(0.0, 0.0);
    (plate.quality, plate.sigma.lateral_mm) = (0.0, f64::INFINITY);
    plate
}

#[test]
fn another_seam_is_not_believed_as_long_as_the_followed_one_is_in_its_place() {
    for seen_second in [true, false] {
        let mut bench = Bench::following();
        let mut other = gap(0.3, 0.1);
        other.second = seen_second.then_some(Second {
            lateral_mm: 0.0,
            width_mm: 0.1,
            rank: 0.3,
        });
        let believed = (0..40).position(|_| bench.sees(other));
        let waited = (JUMP_MM / STEP_MM) as usize;
        assert_eq!(believed, (!seen_second).then_some(waited));
    }
}

#[test]
fn a_doubtful_seam_in_its_place_is_not_refuted() {
    let mut bench = Bench::following();
    let mut doubtful = gap(0.0, 0.1);
    doubtful.quality = 0.3;
    for _ in 0..20 {
        assert!(!bench.sees(gap(0.3, 0.1)) && !bench.sees(gap(0.3, 0.1)) && !bench.sees(doubtful));
    }
    assert!(!bench.sees(gap(0.0, 0.1)) && !bench.sees(gap(0.0, 0.1)) && bench.sees(gap(0.0, 0.1)));
}

#[test]
fn what_comes_up_in_the_seams_place_by_and_by_is_not_believed() {
    // A joint closes, and a scratch that is a fifth narrower leaves it at 3 %.
    let mut bench = Bench::following();
    assert!(!bench.sees(plate()));
    for picture in 1..19 {
        let lateral_mm = 0.012 + 0.03 * STEP_MM * f64::from(picture);
        assert!(!bench.sees(gap(lateral_mm, 0.08)), "{picture}");
    }
}

#[test]
fn a_bend_and_a_taper_are_followed() {
    let mut bench = Bench::following();
    for picture in 1..30 {
        let travel_mm = STEP_MM * f64::from(picture);
        // A kink of 2 %, and on as on a sine of 1 mm over 100 mm; and 1 % wider.
        let lateral_mm = 0.02 * travel_mm + 0.002 * travel_mm.powi(2);
        assert!(bench.sees(gap(lateral_mm, 0.1 + 0.01 * travel_mm)), "{picture}");
    }
}

#[test]
fn a_width_that_was_wrong_once_does_not_shut_a_gap_that_widens_out() {
    let mut bench = Bench::following();
    for picture in 1..40 {
        let wrong = if picture == 30 { -0.035 } else { 0.0 };
        let width_mm = 0.1 + 0.005 * f64::from(picture) + wrong;
        assert!(bench.sees(gap(0.0, width_mm)), "{picture}");
    }
}

#[test]
fn the_seam_from_before_a_shadow_is_believed_again_after_three_pictures() {
    let mut bench = Bench::following();
    let shadowed = gap(0.02, 0.16);
    let believed: Vec<bool> = (0..5).map(|_| bench.sees(shadowed)).collect();
    assert_eq!(believed, [false, false, false, true, true]);
    assert!(!bench.sees(gap(0.0, 0.1)) && !bench.sees(gap(0.0, 0.1)) && bench.sees(gap(0.0, 0.1)));
}

#[test]
fn out_of_view_the_seam_is_forgotten() {
    let mut bench = Bench::following();
    bench.camera.lateral_mm = 1.1;
    assert!(!bench.sees(gap(0.3, 0.2)) && !bench.sees(gap(0.3, 0.2)) && bench.sees(gap(0.3, 0.2)));
}

#[test]
fn before_a_camera_that_stands_another_seam_is_believed_after_a_second() {
    let mut bench = Bench::following();
    bench.step_mm = 0.0;
    let believed = (0..300).position(|_| bench.sees(gap(0.3, 0.1)));
    assert_eq!(believed, Some(AGREEING_STANDING as usize - 1));
}
