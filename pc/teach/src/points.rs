//! The file of taught points (CSV).

use config::table::{self, TableError};
use nalgebra::Vector3;
use nc::text::decimal;
use std::path::Path;

/// Columns of the file.
const COLUMNS: [&str; 9] = [
    "x_mm",
    "y_mm",
    "z_mm",
    "nx",
    "ny",
    "nz",
    "error_deg",
    "rings",
    "time_s",
];

/// A point of a surface, as it was taught.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaughtPoint {
    /// The point in the frame of the work \[mm\].
    pub position: Vector3<f64>,
    /// Unit normal, from the work to the machine.
    pub normal: Vector3<f64>,
    /// Expected error of the normal \[rad\].
    pub error: f64,
    /// Rings measured for it.
    pub rings: usize,
    /// Time that it took on the machine, the way to it included \[s\].
    pub time_s: f64,
}

/// Reads `x_mm,y_mm,z_mm,nx,ny,nz,error_deg,rings,time_s` at `path`: points in the order of the cut.
pub fn read_points(path: &Path) -> Result<Vec<TaughtPoint>, TableError> {
    parse_points(&path.display().to_string(), &table::read(path)?)
}

/// Understands the `text` of such a file; `path` is used in messages only.
pub fn parse_points(path: &str, text: &str) -> Result<Vec<TaughtPoint>, TableError> {
    table::parse(path, text, COLUMNS)?
        .into_iter()
        .map(|row| {
            let [x, y, z, nx, ny, nz, error_deg, rings, time_s] = row.values;
            let normal = Vector3::new(nx, ny, nz);
            let wrong = |reason| TableError::Row {
                path: path.to_owned(),
                line: row.line,
                reason,
            };
            if normal.norm() < 1e-6 {
                return Err(wrong("the normal has no length"));
            }
            if rings < 0.0 || rings.fract() != 0.0 {
                return Err(wrong("rings is a count"));
            }
            Ok(TaughtPoint {
                position: Vector3::new(x, y, z),
                normal: normal.normalize(),
                error: error_deg.to_radians(),
                rings: rings as usize,
                time_s,
            })
        })
        .collect()
}

/// The file of `points`.
pub fn write_points(points: &[TaughtPoint]) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    for point in points {
        let lengths = point.position.iter().map(|x| decimal(*x, 4));
        let directions = point.normal.iter().map(|x| decimal(*x, 7));
        let rest = [
            decimal(point.error.to_degrees(), 4),
            point.rings.to_string(),
            decimal(point.time_s, 3),
        ];
        let cells: Vec<String> = lengths.chain(directions).chain(rest).collect();
        text += &(cells.join(",") + "\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_back_as_they_were_written() {
        let point = TaughtPoint {
            position: Vector3::new(510.0, 402.5, 148.25),
            normal: Vector3::new(0.6, 0.0, 0.8),
            error: 0.05f64.to_radians(),
            rings: 3,
            time_s: 6.5,
        };
        let read = parse_points("t.csv", &write_points(&[point, point])).unwrap();
        assert_eq!(read.len(), 2);
        assert!((read[1].position - point.position).norm() < 1e-9);
        assert!((read[1].normal - point.normal).norm() < 1e-7);
        assert_eq!((read[1].rings, read[1].time_s), (3, 6.5));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let text = COLUMNS.join(",") + "\n1,2,3,0,0,1,0.1,2,5\n1,2,3,0,0,0,0.1,2,5\n";
        let error = parse_points("t.csv", &text).unwrap_err().to_string();
        assert_eq!(error, "t.csv, line 3: the normal has no length");
    }
}
