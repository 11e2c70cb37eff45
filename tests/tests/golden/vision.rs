//! What a camera sees of a seam, and what the detector makes of pictures (mathematics 0.12).

use super::file::{Golden, near, near_all, number};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use vision::{
    Corner, Detector, Image, Joint, Optics, PhotonTransfer, PlateFeatures, PlateSeam, Prior, Profile,
    Readings,
};

/// The camera of a case or file.
fn optics(cam: &Value) -> Optics {
    Optics {
        magnification: number(cam, "mag"),
        pixel_mm: number(cam, "pix"),
        tilt_rad: number(cam, "alpha"),
        aperture: number(cam, "NA"),
        wavelength_mm: number(cam, "lam"),
        rows: number(cam, "rows") as usize,
        columns: number(cam, "cols") as usize,
    }
}

/// Checks the file `vision_geom`: to the picture and back.
pub fn vision_geom(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let optics = optics(&input["cam"]);
        let plate = PlateSeam {
            height_mm: number(input, "h"),
            pitch: number(input, "p"),
            roll: number(input, "q"),
            lateral_mm: number(input, "u0"),
            yaw_rad: number(input, "psi"),
            width_mm: number(input, "width"),
        };
        let features = match plate.features(&optics) {
            Ok(features) => features,
            Err(error) => {
                assert_eq!(case["err"], error.to_string(), "case {}", case["id"]);
                continue;
            }
        };
        let near = |what: &str, seen: f64| near(case, what, seen, number(out, what), golden.tolerance);
        let PlateFeatures { seam, edges, .. } = features;
        near("row0", features.band_row);
        near("slope", features.band_slope);
        near("row", seam[0]);
        near("col", seam[1]);
        near("colL", edges[0]);
        near("colR", edges[1]);
        near("zgrad", features.depth_slope);
        near("edge_slope", features.edge_slope);
        let normal = plate.normal();
        near_all(
            case,
            "normal",
            normal.as_slice(),
            &out["normal"],
            golden.tolerance,
        );
        let back = PlateSeam::from_features(&features, plate.pitch, &optics).expect("the same plate");
        near("h_back", back.height_mm);
        near("u0_back", back.lateral_mm);
        let same = [
            (back.roll, plate.roll),
            (back.yaw_rad, plate.yaw_rad),
            (back.width_mm, plate.width_mm),
        ];
        for (seen, wanted) in same {
            super::file::near(case, "roll, yaw or width", seen, wanted, golden.tolerance);
        }
    }
}

/// Checks the file `vision_fillet`: corners to the picture and back.
pub fn vision_fillet(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let optics = optics(&input["cam"]);
        let corner = Corner {
            height_mm: number(input, "h"),
            lateral_mm: number(input, "u0"),
            walls: [number(input, "bL"), number(input, "bR")],
        };
        let features = corner.features(&optics);
        let near = |what: &str, seen: f64, wanted: f64| near(case, what, seen, wanted, golden.tolerance);
        near("row", features.vertex[0], number(out, "row"));
        near("col", features.vertex[1], number(out, "col"));
        near("kL", features.band_slopes[0], number(out, "kL"));
        near("kR", features.band_slopes[1], number(out, "kR"));
        let back = Corner::from_features(&features, &optics);
        near("height", back.height_mm, corner.height_mm);
        near("lateral", back.lateral_mm, corner.lateral_mm);
        near("left wall", back.walls[0], corner.walls[0]);
        near("right wall", back.walls[1], corner.walls[1]);
    }
}

/// Checks the file `vision_err`: depth of field and errors.
pub fn vision_err(golden: &Golden) {
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let optics = optics(&input["cam"]);
        let readings = Readings {
            edge: number(input, "s_edge"),
            row: number(input, "s_row"),
            rows: number(input, "nrow"),
            span: number(input, "ncol_span"),
            blocks: number(input, "nsamp"),
        };
        let precision = readings.precision(&optics);
        let near = |what: &str, seen: f64| near(case, what, seen, number(out, what), golden.tolerance);
        near("dof", optics.depth_of_field_mm());
        near("band_mm", optics.band_mm());
        near("u0", precision.lateral_mm);
        near("width", precision.width_mm);
        near("h", precision.height_mm);
        near("q", precision.roll);
    }
}

/// Largest errors: lateral position, height, roll, width.
type Bounds = [f64; 4];

/// At 13.8 µm object pixels.
const COARSE: Bounds = [0.010, 0.035, 0.10, 0.015];

/// At 6.9 µm.
const MIDDLE: Bounds = [0.006, 0.020, 0.06, 0.008];

pub use coarse as vision_img_0;
pub use coarse as vision_img_1;
pub use coarse as vision_img_2;
pub use middle as vision_mid_0;
pub use middle as vision_mid_1;
pub use middle as vision_mid_2;
pub use middle as vision_mid_3;

/// Checks a file `vision_img_*`.
pub fn coarse(golden: &Golden) {
    pictures(golden, &COARSE);
}

/// Checks a file `vision_mid_*`.
pub fn middle(golden: &Golden) {
    pictures(golden, &MIDDLE);
}

/// Measures pictures of which nothing is known.
fn pictures(golden: &Golden, bounds: &Bounds) {
    let optics = optics(&golden.file["cam"]);
    let noise = PhotonTransfer {
        full_well: 20_000.0,
        read_noise: 10.0,
    };
    let mut detector = Detector::new(optics, noise, Profile::expected(&optics)).expect("a detector");
    let prior = Prior {
        joint: Joint::Gap,
        track: None,
        focus: 0.0,
    };
    for case in &golden.cases {
        let coded = case["in"]["pixels_b64"].as_str().expect("a picture");
        let pixels = STANDARD.decode(coded).expect("base64");
        let image = Image::new(&pixels, optics.rows, optics.columns).expect("a picture");
        let report = detector.measure(&image, &prior).expect("a measurement");
        let seam = report.seam();
        let seam = seam.unwrap_or_else(|| panic!("case {}: {:?}", case["id"], report));
        let seen = [
            ("u0", seam.lateral_on_axis_mm()),
            ("h", seam.plate_height_mm()),
            ("q", seam.roll),
            ("width", seam.width_mm),
        ];
        for ((what, seen), bound) in seen.into_iter().zip(bounds) {
            near(case, what, seen, number(&case["truth"], what), *bound);
        }
    }
}
