//! How far a camera moves from capture to capture.

use super::*;
use crate::machine::MachineFile;
use crate::world::SceneFile;

fn images() -> Images {
    let text = include_str!("../../../../machines/dual-beam-gantry.toml");
    let unit = MachineFile::parse("m.toml", text).unwrap().tracking.unwrap();
    let heads = unit.board.head.build().unwrap();
    let of = ImageCameras {
        calibrations: std::array::from_fn(|side| unit.cameras.nominal(side)),
        source: PictureSource::Rendered(SceneFile::default()),
        kept: Default::default(),
    };
    Images::begin(&of, &unit, heads, 1).unwrap()
}

fn capture(number: u32, s_mm: f64, u1_mm: f64) -> Capture {
    Capture {
        number,
        time_us: 0,
        motion_time_us: 0,
        s_mm,
        path_id: 1,
        slides_mm: [u1_mm, 0.0, 0.0, 0.0],
        truth_mm: None,
    }
}

/// A bend of 500 mm radius: the camera, 10 mm ahead, swings out.
fn pose(s: f64) -> Pose {
    let (sin, cos) = (s / 500.0).sin_cos();
    Pose {
        position: Vector3::new(500.0 * sin, 500.0 * (1.0 - cos), 0.0),
        tangent: Vector3::new(cos, sin, 0.0),
        normal: Vector3::z(),
    }
}

#[test]
fn a_camera_moves_with_path_bend_and_slides() {
    let mut images = images();
    images.strobe(capture(0, 0.0, 0.0), 0, Some(pose(0.0)));
    let moved = images.moved(0, &pose(0.75), &capture(1, 0.75, 0.2)).unwrap();
    // Camera 1 looks along the skin's normal, u to the left: the bend swings it left by 10 mm · 0.75 / 500 + 0.0006,
    // the slide carries it by U, 30° off the skin, to the right and down.
    let (sin, cos) = 30f64.to_radians().sin_cos();
    assert!((moved.travel_mm - 0.75).abs() < 0.01, "{moved:?}");
    assert!(
        (moved.lateral_mm - (0.0144 - 0.2 * cos)).abs() < 1e-3,
        "{moved:?}"
    );
    assert!((moved.height_mm.abs() - 0.2 * sin).abs() < 1e-3, "{moved:?}");
}

#[test]
fn nothing_is_known_of_a_way_that_is_too_far_or_begins_nowhere() {
    let mut images = images();
    let way = |images: &Images, s: f64| images.moved(0, &pose(s), &capture(2, s, 0.0));
    images.strobe(capture(0, 30.0, 0.0), 0, None);
    assert_eq!(way(&images, 30.0), None);
    images.strobe(capture(1, 30.0, 0.0), 5_000, Some(pose(30.0)));
    assert!(way(&images, 30.75).is_some());
    assert_eq!(way(&images, 40.0), None);
}
