//! The file of places to which the tip was led (CSV).

use crate::kept::free_name;
use config::kept::replace;
use config::table::{self, TableError};
use nc::text::decimal;
use std::path::{Path, PathBuf};

/// Columns of the file: as the words of an NC program.
const COLUMNS: [&str; 6] = ["x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg"];
/// Places nearer than this are one \[mm\].
const SAME_PLACE: f64 = 1e-3;

/// A place of the tip, as the operator took it down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipPoint {
    /// The tip in the frame of the work \[mm\].
    pub position_mm: [f64; 3],
    /// The machine's rotary axes A B C \[°\]; 0 for those that it does not have.
    pub angles_deg: [f64; 3],
}

/// Reads `x_mm,y_mm,z_mm,a_deg,b_deg,c_deg` at `path`: two places or more, in the order of travel.
pub fn read_tip_points(path: &Path) -> Result<Vec<TipPoint>, TableError> {
    parse_tip_points(&path.display().to_string(), &table::read(path)?)
}

/// Understands the `text` of such a file; `path` is used in messages only.
pub fn parse_tip_points(path: &str, text: &str) -> Result<Vec<TipPoint>, TableError> {
    let points = rows(path, text)?;
    if points.len() < 2 {
        return Err(TableError::Short {
            path: path.to_owned(),
            wanted: 2,
        });
    }
    Ok(points)
}

/// Any number of places.
fn rows(path: &str, text: &str) -> Result<Vec<TipPoint>, TableError> {
    let rows = table::parse(path, text, COLUMNS)?;
    let mut points: Vec<TipPoint> = Vec::new();
    for row in rows {
        let [x, y, z, a, b, c] = row.values;
        let point = TipPoint {
            position_mm: [x, y, z],
            angles_deg: [a, b, c],
        };
        if points.last().is_some_and(|before| before.is_near(&point)) {
            return Err(TableError::Row {
                path: path.to_owned(),
                line: row.line,
                reason: "this place equals the one before",
            });
        }
        points.push(point);
    }
    Ok(points)
}

/// A file that takes places while they are taught.
#[derive(Debug)]
pub struct TipFile {
    path: PathBuf,
}

impl TipFile {
    /// The file at `path`, and the places that it has already. With `restart` a file that is there gets another name, which is
    /// given back.
    ///
    /// # Errors
    /// What is there is no such file, or cannot be renamed.
    pub fn open(path: &Path, restart: bool) -> Result<(Self, Vec<TipPoint>, Option<PathBuf>), TableError> {
        let name = path.display().to_string();
        let mut kept = None;
        if restart && path.exists() {
            let free = free_name(path);
            std::fs::rename(path, &free).map_err(|source| TableError::Read {
                path: name.clone(),
                source,
            })?;
            kept = Some(free);
        }
        let points = match path.exists() {
            true => rows(&name, &table::read(path)?)?,
            false => Vec::new(),
        };
        let path = path.to_owned();
        Ok((Self { path }, points, kept))
    }

    /// Has `points` from now on: they are on the disk afterwards, or those before are.
    ///
    /// # Errors
    /// As of the system.
    pub fn keep(&self, points: &[TipPoint]) -> std::io::Result<()> {
        replace(&self.path, &write_tip_points(points))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// The file of `points`.
pub fn write_tip_points(points: &[TipPoint]) -> String {
    let row = |point: &TipPoint| {
        let lengths = point.position_mm.iter().map(|mm| decimal(*mm, 5));
        let angles = point.angles_deg.iter().map(|deg| decimal(*deg, 6));
        lengths.chain(angles).collect::<Vec<_>>().join(",") + "\n"
    };
    COLUMNS.join(",") + "\n" + &points.iter().map(row).collect::<String>()
}

impl TipPoint {
    /// Whether the tip is at the same place, however the tool stands.
    pub fn is_near(&self, other: &Self) -> bool {
        let squares = self.position_mm.iter().zip(other.position_mm);
        let square: f64 = squares.map(|(a, b)| (a - b) * (a - b)).sum();
        libm::sqrt(square) < SAME_PLACE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIRST: TipPoint = TipPoint {
        position_mm: [-100.5, 0.0, 50.25],
        angles_deg: [0.0, -2.5, 36.869898],
    };

    #[test]
    fn points_come_back_as_they_were_written() {
        let second = TipPoint {
            position_mm: [0.0, 12.0, 50.0],
            ..FIRST
        };
        let points = [FIRST, second];
        assert_eq!(
            parse_tip_points("t.csv", &write_tip_points(&points)).unwrap(),
            points
        );
    }

    #[test]
    fn one_place_is_no_seam_and_the_same_one_again_is_named_with_its_line() {
        let error = |points: &[TipPoint]| {
            let error = parse_tip_points("t.csv", &write_tip_points(points)).unwrap_err();
            error.to_string()
        };
        assert_eq!(error(&[FIRST]), "t.csv: at least 2 rows are needed");
        assert_eq!(
            error(&[FIRST, FIRST]),
            "t.csv, line 3: this place equals the one before"
        );
    }
}
