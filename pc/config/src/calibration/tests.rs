use super::*;
use nalgebra::{Rotation3, Unit, Vector3};
use proptest::prelude::*;
use shared::tracking::frames::SpotFrame;

const OPTICS: Optics = Optics {
    magnification: 4.0,
    pixel_mm: 0.0138,
    tilt_rad: std::f64::consts::FRAC_PI_4,
    aperture: 0.10,
    wavelength_mm: 0.00053,
    rows: 300,
    columns: 400,
};

/// A measurement in the plate frame turned into that of a head tilted by `theta` \[rad\] about T from the plate
/// normal: `u` \[mm\] lateral (along n × t), `h` \[mm\] height (along n) → (ΔU, ΔV) \[mm\] (mathematics 0.7).
fn plate_to_head(theta: f64, u: f64, h: f64) -> (f64, f64) {
    let (s, c) = (theta.sin(), theta.cos());
    (-(u * c + h * s), u * s - h * c)
}

const NOISE: PhotonTransfer = PhotonTransfer {
    full_well: 20_000.0,
    read_noise: 15.0,
};

fn nominal(mount_deg: f64) -> Calibration {
    Calibration::nominal(OPTICS, NOISE, mount_deg.to_radians())
}

/// One that was measured: nothing of it is a round number.
fn measured() -> Calibration {
    Calibration {
        profile: Profile {
            fine_mm: 0.091_234_567,
            coarse_mm: 0.137_654_321,
        },
        slides: SlideMap {
            matrix: [[-0.871_123_456, 0.493_123_456], [-0.501_234_567, -0.862_345_678]],
            offset_mm: [0.031_234_567, -0.047_654_321],
        },
        corner_offset_mm: Some([0.001_234_5, 0.004_912_3]),
        spot: Some(SpotCalibration {
            lead_mm: 10.123_456,
            delay_s: 0.000_345_678,
            uncertainty_mm: [0.001_234, 0.002_345],
        }),
        ..nominal(-30.0)
    }
}

fn error_of(text: &str) -> String {
    Calibration::parse("c.toml", text).unwrap_err().to_string()
}

fn line_of(text: &str, line: &str) -> usize {
    1 + text.lines().position(|l| l == line).unwrap()
}

proptest! {
    /// The nominal camera measures as a head does that is turned by −mount from its n (mathematics 0.7).
    #[test]
    fn a_nominal_camera_maps_as_the_plate_of_spec_0_7(
        mount in prop::sample::select(vec![-30.0, -15.0, 0.0, 15.0, 30.0]),
        u in -0.7..0.7f64,
        a in -0.5..0.5f64,
        n in -0.5..0.5f64,
    ) {
        let seen = nominal(mount).side_measurement(u, a, n);
        let (delta_u, delta_v) = plate_to_head(-mount.to_radians(), u, n);
        prop_assert!((seen.delta_u_mm - delta_u).abs() < 1e-12 && (seen.delta_v_mm - delta_v).abs() < 1e-12);
        prop_assert_eq!(seen.along_mm, a);
    }

    /// The same from the frames in the world: a point of the camera's frame is where the slides' frame has it.
    #[test]
    fn a_nominal_camera_stands_on_its_head_turned_about_travel(
        mount in -40.0..40.0f64, u in -0.7..0.7f64, n in -0.5..0.5f64,
    ) {
        let (t, head) = (Vector3::x(), Vector3::new(0.0, 0.3f64.sin(), 0.3f64.cos()));
        let out = Rotation3::from_axis_angle(&Unit::new_normalize(t), mount.to_radians()) * head;
        let point = out.cross(&t) * u + out * n;
        let (_, delta_u, delta_v) = SpotFrame::new(Vector3::zeros(), t, head).coordinates(&point);
        let seen = nominal(mount).side_measurement(u, 0.0, n);
        prop_assert!((seen.delta_u_mm - delta_u).abs() < 1e-12 && (seen.delta_v_mm - delta_v).abs() < 1e-12);
    }

    /// Errors of scale leave what the slides tell of the mount as it is.
    #[test]
    fn the_slides_tell_how_the_camera_is_mounted(
        mount in -80.0..80.0f64, u in 0.95..1.05f64, n in 0.95..1.05f64,
    ) {
        let mut slides = nominal(mount).slides;
        slides.matrix = slides.matrix.map(|[across, up]| [across * u, up * n]);
        prop_assert!((slides.mount_rad() - mount.to_radians()).abs() < 1e-12);
    }

    /// Slides that carry the camera by a step carry a resting point the other way through its picture: what is measured
    /// stays the same place.
    #[test]
    fn a_step_of_the_slides_moves_the_picture_and_not_the_seam(
        u in -0.3..0.3f64, n in -0.3..0.3f64, du in -0.2..0.2f64, dv in -0.2..0.2f64,
    ) {
        let camera = measured();
        let before = camera.side_measurement(u, 0.0, n);
        let [right, up] = camera.camera_step(du, dv);
        let after = camera.side_measurement(u - right, 0.0, n - up);
        prop_assert!((after.delta_u_mm + du - before.delta_u_mm).abs() < 1e-12);
        prop_assert!((after.delta_v_mm + dv - before.delta_v_mm).abs() < 1e-12);
    }
}

#[test]
fn a_file_says_what_was_measured() {
    for camera in [nominal(30.0), measured()] {
        let read = Calibration::parse("c.toml", &camera.to_toml()).unwrap();
        assert_eq!(read.to_toml(), camera.to_toml(), "read and written again");
        let [wrote, read] = [camera, read].map(|c| {
            let (o, p) = (c.optics, c.profile);
            let corner = c.corner_offset_mm.unwrap_or_default();
            let spot = c.spot.unwrap_or_default();
            let [m0, m1] = c.slides.matrix;
            [
                vec![
                    o.magnification,
                    o.pixel_mm,
                    o.tilt_rad,
                    o.aperture,
                    o.wavelength_mm,
                ],
                vec![o.rows as f64, o.columns as f64, p.fine_mm, p.coarse_mm],
                vec![c.photon_transfer.full_well, c.photon_transfer.read_noise],
                [m0, m1, c.slides.offset_mm, corner, spot.uncertainty_mm].concat(),
                vec![spot.lead_mm, spot.delay_s],
            ]
            .concat()
        });
        for (wrote, read) in wrote.iter().zip(&read) {
            assert!((wrote - read).abs() < 1e-9, "{read} instead of {wrote}");
        }
        assert_eq!(
            Calibration::parse("c.toml", &camera.to_toml())
                .unwrap()
                .corner_offset_mm
                .is_some(),
            camera.corner_offset_mm.is_some()
        );
    }
}

#[test]
fn people_read_degrees_and_micrometres() {
    let text = measured().to_toml();
    for line in [
        "pixel_um = 13.8",
        "tilt_deg = 45.0",
        "wavelength_um = 0.53",
        "fine_um = 91.234567",
    ] {
        assert!(text.lines().any(|l| l == line), "{line} is not in\n{text}");
    }
}

#[test]
fn a_singular_or_mirrored_matrix_is_refused_with_its_line() {
    let text = measured().to_toml();
    let at = text.find("matrix = ").unwrap();
    let end = text.find("offset_um").unwrap();
    for matrix in [
        "[[1.0, 2.0], [0.5, 1.0]]",
        "[[0.0, 0.0], [0.0, 0.0]]",
        "[[-1.0, 0.0], [0.0, 1.0]]",
        "[[nan, 0.0], [0.0, 1.0]]",
    ] {
        let wrong = format!("{}matrix = {matrix}\n{}", &text[..at], &text[end..]);
        let error = error_of(&wrong);
        let head = format!(
            "calibration c.toml, line {}: matrix has",
            line_of(&wrong, "[slides]")
        );
        assert!(error.starts_with(&head), "{error}");
    }
}

#[test]
fn a_value_that_makes_no_sense_is_named_with_its_line() {
    let text = measured().to_toml();
    let cases = [
        ("tilt_deg = 45.0", "tilt_deg = 95.0", "[optics]", "tilt of 95°"),
        (
            "full_well = 20000.0",
            "full_well = 0.0",
            "[photon_transfer]",
            "full_well is 0",
        ),
        (
            "read_noise = 15.0",
            "read_noise = -1.0",
            "[photon_transfer]",
            "read_noise is -1",
        ),
        (
            "fine_um = 91.234567",
            "fine_um = nan",
            "[profile]",
            "fine_um is NaN",
        ),
        ("4.9123", "inf", "[corner]", "offset_um is inf"),
        (
            "lead_mm = 10.123456",
            "lead_mm = -1.0",
            "[spot]",
            "lead_mm is -1, but must be above 0",
        ),
        (
            "delay_us = 345.678",
            "delay_us = 40000.0",
            "[spot]",
            "delay_us is 40000, but must be within ±20000",
        ),
        ("2.345", "nan", "[spot]", "uncertainty_um is NaN"),
        // More than a terabyte of pixels, and pixels without end.
        (
            "columns = 400",
            "columns = 4294967296",
            "[optics]",
            "4294967296 pixels; 67108864 pixels in all are possible",
        ),
        (
            "magnification = 4.0",
            "magnification = 1e300",
            "[optics]",
            "the pixel pitch over the magnification in mm of the camera is",
        ),
        (
            "magnification = 4.0",
            "magnification = 0.2",
            "[optics]",
            "it must be between 0.000001 and 0.05",
        ),
    ];
    for (right, wrong, table, says) in cases {
        let changed = text.replace(right, wrong);
        assert_ne!(changed, text, "{right}");
        let error = error_of(&changed);
        let line = format!("line {}: ", line_of(&changed, table));
        assert!(error.contains(&line) && error.contains(says), "{error}");
    }
}

#[test]
fn an_unknown_or_missing_key_is_named_with_its_line() {
    let text = measured().to_toml();
    let changed = text.replace("[profile]", "[profile]\nwobble = 1.0");
    let error = error_of(&changed);
    let line = line_of(&changed, "wobble = 1.0");
    assert!(
        error.contains(&format!("line {line}: ")) && error.contains("wobble"),
        "{error}"
    );
    let error = error_of(&text.replace("fine_um = 91.234567\n", ""));
    assert!(error.contains("fine_um"), "{error}");
}

#[test]
fn a_missing_file_says_how_to_make_one() {
    let error = Calibration::read(Path::new("none.toml")).unwrap_err().to_string();
    assert!(
        error.starts_with("cannot read calibration none.toml: "),
        "{error}"
    );
    assert!(error.ends_with("; `seamwright calibrate` writes one"), "{error}");
}
