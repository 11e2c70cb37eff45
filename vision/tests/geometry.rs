//! From plate and corner to the picture and back.

use proptest::prelude::*;
use vision::{Corner, GeometryError, Optics, PlateSeam};

/// A camera at its full resolution.
const OPTICS: Optics = Optics {
    magnification: 4.0,
    pixel_mm: 0.00345,
    tilt_rad: std::f64::consts::FRAC_PI_4,
    aperture: 0.10,
    wavelength_mm: 0.00055,
    rows: 1200,
    columns: 1600,
};

proptest! {
    /// What a camera sees of a plate tells it again to 1e-9.
    #[test]
    fn a_plate_is_told_by_its_features(
        height_mm in -0.3..0.3, pitch in -0.3..0.3, roll in -0.3..0.3,
        lateral_mm in -0.5..0.5, yaw_rad in -0.2..0.2, width_mm in 0.01..0.4,
    ) {
        let plate = PlateSeam { height_mm, pitch, roll, lateral_mm, yaw_rad, width_mm };
        let features = plate.features(&OPTICS).expect("features");
        let back = PlateSeam::from_features(&features, pitch, &OPTICS).expect("a plate");
        let pairs = [
            (back.height_mm, height_mm),
            (back.roll, roll),
            (back.lateral_mm, lateral_mm),
            (back.yaw_rad, yaw_rad),
            (back.width_mm, width_mm),
        ];
        for (back, there) in pairs {
            prop_assert!((back - there).abs() < 1e-9, "{back} for {there}");
        }
    }

    /// So does the vertex of a corner and what leads there.
    #[test]
    fn a_corner_is_told_by_its_features(
        height_mm in -0.3..0.3, lateral_mm in -0.5..0.5, left in -2.0..0.0, right in 0.0..2.0,
    ) {
        let corner = Corner { height_mm, lateral_mm, walls: [left, right] };
        let back = Corner::from_features(&corner.features(&OPTICS), &OPTICS);
        prop_assert!((back.height_mm - height_mm).abs() < 1e-9);
        prop_assert!((back.lateral_mm - lateral_mm).abs() < 1e-9);
        prop_assert!((back.walls[0] - left).abs() < 1e-9 && (back.walls[1] - right).abs() < 1e-9);
    }
}

/// A plate along the optical axis has no band.
#[test]
fn a_plate_along_the_axis_is_refused() {
    let plate = PlateSeam {
        height_mm: 0.0,
        pitch: 1.0,
        roll: 0.0,
        lateral_mm: 0.0,
        yaw_rad: 0.0,
        width_mm: 0.1,
    };
    assert_eq!(plate.features(&OPTICS), Err(GeometryError::AlongTheAxis));
}
