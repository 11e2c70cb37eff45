//! Writes the seam files of the shipped job into a folder: `cargo run -p system-tests --example t-seam -- programs`.
//!
//! The rib stands on a gently bent sheet. Along 400 mm its line turns by 22.5° (radius 650 mm at its
//! tightest), climbs by 20 mm and rolls by 4°; all three begin and end without curvature, so that straight
//! runs before and after the seam join smoothly. The feet of the 4 mm rib lie 2 mm to the right (seam 1) and
//! to the left (seam 2) of that line.
//!
//! The real seams deviate: U1 is a sine of 0.5 mm over 100 mm, U2 slopes by 2 % and has kinks of 1 %, V1 and
//! V2 wave by a few tenths of a millimetre.

use nalgebra::Vector3;
use shared::geometry::rotate;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::PathBuf;

const LENGTH: f64 = 400.0;
const START: [f64; 3] = [400.0, 300.0, 100.0];
const TIGHTEST_RADIUS: f64 = 650.0;
const CLIMB: f64 = 20.0;
const ROLL: f64 = 4.0 * PI / 180.0;
const RIB: f64 = 4.0;
/// Spacing of the points written, and steps of integration between two of them \[mm\].
const SPACING: f64 = 5.0;
const STEPS: usize = 500;
/// The deviation goes a little further than the weld.
const DEVIATION_END: f64 = 410.0;
const DEVIATION_SPACING: f64 = 0.5;

/// Direction of travel at length `s`.
fn tangent(s: f64) -> Vector3<f64> {
    let phase = PI * s / LENGTH;
    let heading = LENGTH / (PI * TIGHTEST_RADIUS) * phase.cos();
    let slope = 2.0 * CLIMB / LENGTH * phase.sin().powi(2);
    Vector3::new(
        heading.cos() * slope.cos(),
        heading.sin() * slope.cos(),
        slope.sin(),
    )
}

/// Skin normal at length `s`.
fn normal(s: f64) -> Vector3<f64> {
    let t = tangent(s);
    let upright = (Vector3::z() - t * t.z).normalize();
    rotate(&t, ROLL * (PI * s / LENGTH).sin().powi(2), &upright)
}

/// u1, v1, u2, v2 at `s`.
fn deviation(s: f64) -> [f64; 4] {
    let wave = |amplitude: f64, length: f64| amplitude * (2.0 * PI * s / length).sin();
    // Slope 2 %, then kinks of 1 % each at 150, 250 and 330 mm.
    let bent = -1.5 + 0.02 * s
        - [150.0, 250.0, 330.0]
            .map(|kink| 0.01 * (s - kink).max(0.0))
            .iter()
            .sum::<f64>();
    [wave(0.5, 100.0), wave(0.2, 160.0), bent, wave(-0.15, 130.0)]
}

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "programs".to_owned()));
    let mut seam1 = String::from("x_mm,y_mm,z_mm,nx,ny,nz\n");
    let mut seam2 = String::from("x_mm,y_mm,z_mm\n");
    let mut point = Vector3::from(START);
    let count = (LENGTH / SPACING) as usize;
    for i in 0..=count {
        let s = i as f64 * SPACING;
        let (t, n) = (tangent(s), normal(s));
        let left = n.cross(&t);
        let (right_foot, left_foot) = (point - left * (RIB / 2.0), point + left * (RIB / 2.0));
        let row = |p: Vector3<f64>| format!("{:.6},{:.6},{:.6}", p.x, p.y, p.z);
        // Writing to a String cannot fail.
        let _ = writeln!(seam1, "{},{:.9},{:.9},{:.9}", row(right_foot), n.x, n.y, n.z);
        let _ = writeln!(seam2, "{}", row(left_foot));
        let h = SPACING / STEPS as f64;
        for step in 0..STEPS {
            point += tangent(s + (step as f64 + 0.5) * h) * h;
        }
    }
    let mut table = String::from("s_mm,u1_mm,v1_mm,u2_mm,v2_mm\n");
    for i in 0..=(DEVIATION_END / DEVIATION_SPACING) as usize {
        let s = i as f64 * DEVIATION_SPACING;
        let [u1, v1, u2, v2] = deviation(s).map(|x| x + 0.0);
        let _ = writeln!(table, "{s:.1},{u1:.6},{v1:.6},{u2:.6},{v2:.6}");
    }
    std::fs::write(folder.join("t-seam-400-seam1.csv"), seam1)?;
    std::fs::write(folder.join("t-seam-400-seam2.csv"), seam2)?;
    std::fs::write(folder.join("t-seam-400-deviation.csv"), table)
}
