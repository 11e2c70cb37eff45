//! Curves of seams in files, which welds are planned from.

use config::table::{self, TableError};
use nalgebra::Vector3;
use std::path::Path;

/// A point of a seam that is planned from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamPoint {
    /// Place in the world \[mm\].
    pub position: Vector3<f64>,
    /// Skin normal, pointing up to the head; any length.
    pub normal: Vector3<f64>,
}

/// Reads seam 1, `x_mm,y_mm,z_mm,nx,ny,nz`: points in the direction of travel with the skin normal.
pub fn read_main_curve(path: &Path) -> Result<Vec<SeamPoint>, TableError> {
    parse_main_curve(&path.display().to_string(), &table::read(path)?)
}

/// Understands the `text` of seam 1; `name` of the file is used in messages only.
pub fn parse_main_curve(name: &str, text: &str) -> Result<Vec<SeamPoint>, TableError> {
    let rows = table::parse(name, text, ["x_mm", "y_mm", "z_mm", "nx", "ny", "nz"])?;
    check_points(name, rows.iter().map(|r| (r.line, vector(&r.values, 0))))?;
    rows.iter()
        .map(|row| {
            let normal = vector(&row.values, 3);
            if normal.norm() < 1e-6 {
                return Err(TableError::Row {
                    path: name.to_owned(),
                    line: row.line,
                    reason: "the normal has no length",
                });
            }
            Ok(SeamPoint {
                position: vector(&row.values, 0),
                normal,
            })
        })
        .collect()
}

/// Reads seam 2, `x_mm,y_mm,z_mm`: points in the direction of travel.
pub fn read_other_curve(path: &Path) -> Result<Vec<Vector3<f64>>, TableError> {
    parse_other_curve(&path.display().to_string(), &table::read(path)?)
}

/// Understands the `text` of seam 2; `name` of the file is used in messages only.
pub fn parse_other_curve(name: &str, text: &str) -> Result<Vec<Vector3<f64>>, TableError> {
    let rows = table::parse(name, text, ["x_mm", "y_mm", "z_mm"])?;
    check_points(name, rows.iter().map(|r| (r.line, vector(&r.values, 0))))?;
    Ok(rows.iter().map(|row| vector(&row.values, 0)).collect())
}

fn vector(values: &[f64], from: usize) -> Vector3<f64> {
    Vector3::new(values[from], values[from + 1], values[from + 2])
}

/// At least three points, none twice in a row.
fn check_points(path: &str, points: impl Iterator<Item = (usize, Vector3<f64>)>) -> Result<(), TableError> {
    let points: Vec<_> = points.collect();
    let path = path.to_owned();
    if points.len() < 3 {
        return Err(TableError::Short { path, wanted: 3 });
    }
    match points.windows(2).find(|p| (p[1].1 - p[0].1).norm() < 1e-6) {
        Some(pair) => Err(TableError::Row {
            path,
            line: pair[1].0,
            reason: "this point equals the one before",
        }),
        None => Ok(()),
    }
}
