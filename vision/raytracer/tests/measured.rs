//! What the detector says of pictures that it was not made with.

use raytracer::{Camera, Effect, Subject, subject};
use vision::{Detector, Image, Joint, Measured, Optics, PhotonTransfer, Prior, Profile};

/// A camera with the published lens.
const OPTICS: Optics = Optics {
    magnification: 4.0,
    pixel_mm: 0.0138,
    tilt_rad: std::f64::consts::FRAC_PI_4,
    aperture: 0.10,
    wavelength_mm: 0.000_53,
    rows: 300,
    columns: 400,
};
const NOISE: PhotonTransfer = PhotonTransfer {
    full_well: 20_000.0,
    read_noise: 15.0,
};

/// What is believed of the pictures of so many seeds, and what stood before the camera.
fn believed(effect: Effect, seeds: std::ops::Range<u64>) -> Vec<(Subject, Measured)> {
    let camera = Camera::new(OPTICS, 24);
    let mut detector = Detector::new(OPTICS, NOISE, Profile::expected(&OPTICS)).unwrap();
    let prior = Prior {
        joint: Joint::Gap,
        track: None,
        focus: 0.0,
    };
    let mut measured = |seed: u64| {
        let subject = subject(&[effect], &OPTICS, NOISE, seed);
        let pixels = camera.picture(&subject.work, &subject.exposure);
        let image = Image::new(&pixels, OPTICS.rows, OPTICS.columns).unwrap();
        let report = detector.measure(&image, &prior).unwrap();
        Some((subject, *report.seam()?))
    };
    seeds.filter_map(&mut measured).collect()
}

/// Errors of centre, height and width \[mm\].
fn errors((subject, seen): &(Subject, Measured)) -> [f64; 3] {
    let truth = subject.work.truth(&OPTICS);
    [
        seen.lateral_mm - truth.lateral_mm,
        seen.height_mm - truth.height_mm,
        seen.width_mm - truth.width_mm,
    ]
}

#[test]
fn plain_joints_are_measured_to_micrometres() {
    let all = believed(Effect::Plain, 100..106);
    assert_eq!(all.len(), 6);
    for picture in &all {
        let [centre, height, width] = errors(picture);
        let seed = picture.0.exposure.seed;
        assert!(centre.abs() < 0.005, "{seed}: centre {centre} mm off");
        assert!(height.abs() < 0.015, "{seed}: height {height} mm off");
        assert!(width.abs() < 0.010, "{seed}: width {width} mm off");
    }
}

#[test]
fn a_gap_is_told_from_the_shadow_beside_it() {
    let all = believed(Effect::Step, 100..106);
    assert!(all.len() >= 4, "{} of 6", all.len());
    for picture in &all {
        let [centre, ..] = errors(picture);
        assert!(centre.abs() < 0.010, "{}: {centre} mm", picture.0.exposure.seed);
    }
}

#[test]
fn where_one_plate_is_dark_or_missing_nothing_is_believed() {
    for effect in [Effect::DimPlate, Effect::OnePlate] {
        let all = believed(effect, 100..104);
        let wrong = all.iter().filter(|picture| errors(picture)[0].abs() > 0.010);
        assert_eq!(wrong.count(), 0, "{effect:?}");
        assert!(effect.has_seam() || all.is_empty(), "{effect:?}");
    }
}

#[test]
fn a_scratch_beside_a_gap_is_no_rival_of_it() {
    for effect in [Effect::Scratch, Effect::BrightEdges, Effect::Veil] {
        let all = believed(effect, 100..106);
        assert!(all.len() >= 4, "{effect:?}: {} of 6", all.len());
        for picture in &all {
            let [centre, ..] = errors(picture);
            let seed = picture.0.exposure.seed;
            assert!(centre.abs() < 0.005, "{effect:?} {seed}: {centre} mm");
        }
    }
}

/// Scratches wide enough for their texture to be seen between the blur of their edges.
#[test]
fn scratches_and_grooves_of_a_closed_joint_are_no_gap() {
    for effect in [Effect::ClosedScratched, Effect::ClosedGrooved] {
        for (subject, seen) in believed(effect, 100..110) {
            let widest = subject
                .work
                .marks
                .iter()
                .map(|mark| mark.width_mm)
                .fold(0.0, f64::max);
            let seed = subject.exposure.seed;
            assert!(widest < 0.03, "{effect:?} {seed}: {:.3} mm wide", seen.width_mm);
        }
    }
}
