//! Saddles of the shipped part and machine.

mod dimensions;
mod planned;
mod taught;

use super::pipes::Sheet;
use super::seam::{Placement, Seam};
use super::*;
use crate::PartFile;
use config::machine::MachineFile;
use std::path::PathBuf;
use tempfile::NamedTempFile;

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

fn machine() -> MachineFile {
    MachineFile::read(&shipped("machines/pipe-welder.toml")).unwrap()
}

fn text() -> String {
    std::fs::read_to_string(shipped("programs/saddle-320-80.toml")).unwrap()
}

/// A temporary file with `text`.
fn written(text: &str) -> NamedTempFile {
    let file = NamedTempFile::new().unwrap();
    std::fs::write(&file, text).unwrap();
    file
}

/// Plans the part file `text`.
fn plan_text(text: &str, machine: &MachineFile) -> Result<Plan, String> {
    let part = PartFile::read(written(text).path()).map_err(|error| error.to_string())?;
    part.plan(machine, "saddle").map_err(|error| format!("{error:#}"))
}

/// The prototype of mathematics 1.3: main pipe 320, branch 80, offset 10, 5° off square.
fn prototype(placement: Placement) -> Seam {
    let pair = PipePair::new(160.0, 40.0, 85f64.to_radians(), 10.0).unwrap();
    Seam::new(pair, 10.0, placement).unwrap()
}

#[test]
fn the_nearest_place_of_the_seam_is_that_of_the_exact_curve() {
    let placement = Placement {
        turn: 0.4,
        lift: 25.0,
    };
    let seam = prototype(placement);
    let curve = seam.pair().curve(Sheet::Plus).unwrap();
    for i in 0..50 {
        let phi = f64::from(i) * 0.7;
        let near = seam
            .at_length(f64::from(i) * 5.3, &Offset::default(), 0.0)
            .unwrap();
        let off = nalgebra::Vector3::new(phi.sin(), phi.cos(), (2.0 * phi).sin()) * 0.3;
        let tip = near.tip + off;
        let found = (seam.nearest(&tip, &Offset::default()).unwrap().tip - tip).norm();
        let turned = shared::geometry::rotate(&nalgebra::Vector3::z(), -placement.turn, &tip);
        let branch = turned - nalgebra::Vector3::z() * placement.lift;
        let exact = curve.nearest(&seam.pair().to_main(&branch)).distance;
        assert!((found - exact).abs() < 1e-10, "{found} {exact}");
    }
}

#[test]
fn an_offset_pass_is_nearest_where_its_own_points_are() {
    let seam = prototype(Placement::default());
    let offset = Offset {
        radial: 3.0,
        axial: -1.5,
    };
    for i in 0..40 {
        let station = seam.at_length(f64::from(i) * 6.7, &offset, 0.0).unwrap();
        let base = seam
            .at_length(f64::from(i) * 6.7, &Offset::default(), 0.0)
            .unwrap();
        let way = station.tip - base.tip;
        assert!((way.dot(&station.outward()) - 3.0).abs() < 1e-12 && (way.z + 1.5).abs() < 1e-12);
        let ahead = seam.at_length(f64::from(i) * 6.7 + 1e-4, &offset, 0.0).unwrap();
        let behind = seam.at_length(f64::from(i) * 6.7 - 1e-4, &offset, 0.0).unwrap();
        let along = (ahead.tip - behind.tip).normalize();
        // A tip beside the pass, across it.
        let across = along.cross(&station.outward()).normalize() * 0.5;
        let found = seam.nearest(&(station.tip + across), &offset).unwrap();
        assert!((found.tip - station.tip).norm() < 1e-5);
    }
}
