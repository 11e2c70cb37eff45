//! The file of taught seams (CSV), complete after every point.

use super::{MeasuredSeam, SeamEnd, SeamPoint};
use crate::kept::free_name;
use config::kept::replace;
use config::table::{self, TableError};
use nalgebra::Vector3;
use nc::text::decimal;
use std::fs::{File, OpenOptions};
use std::io::{Error as IoError, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

const NUMBERS: [&str; 13] = [
    "point",
    "side",
    "s_mm",
    "x_mm",
    "y_mm",
    "z_mm",
    "nx",
    "ny",
    "nz",
    "width_mm",
    "quality",
    "scatter_mm",
    "pictures",
];
/// What the seam begins or ends with at a point: one of [`ENDS`]. Files that were taught without it have only the numbers.
const END: &str = "end";
/// Nothing, and the ends that there are.
const ENDS: [(&str, Option<SeamEnd>); 3] = [
    ("-", None),
    ("plate", Some(SeamEnd::Plate)),
    ("tack", Some(SeamEnd::Tack)),
];

/// Names of all columns.
fn columns() -> Vec<&'static str> {
    NUMBERS.into_iter().chain([END]).collect()
}

/// Whose points these are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Head {
    /// Name of the machine.
    pub machine: String,
    /// Name of the part.
    pub part: String,
}

impl Head {
    fn text(&self) -> String {
        format!(
            "# Both seams at the feet of a rib, as seamwright teach saw them.\n\
             # machine: {}\n\
             # part: {}\n\
             # A row a point and side: place and normal of the skin in the frame of the work, width of the gap (0: not\n\
             # measured), quality 0 to 1, standard deviation from picture to picture; s_mm: chords of side 1; end: plate or tack with which the\n\
             # seam begins or ends at that point.\n\
             {}\n",
            self.machine,
            self.part,
            columns().join(",")
        )
    }

    /// The head of `text`, if it has one.
    fn of(text: &str) -> Option<Self> {
        let value = |key: &str| {
            let mut lines = text.lines().take_while(|line| line.starts_with('#'));
            let value = lines.find_map(|line| line.strip_prefix(key))?;
            Some(value.trim().to_owned())
        };
        Some(Self {
            machine: value("# machine:")?,
            part: value("# part:")?,
        })
    }
}

/// Why points cannot be added to a file. Reads as one sentence.
#[derive(Debug, Error)]
pub enum SeamFileError {
    /// What the system said.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: String,
        /// The reason.
        source: IoError,
    },
    /// Taught for something else.
    #[error(
        "{path} was taught on machine {} for part {}, not on {} for {}: choose another output, or start over with \
         --restart",
        found.machine, found.part, wanted.machine, wanted.part
    )]
    Foreign {
        /// The file.
        path: String,
        /// What it says.
        found: Head,
        /// What it should say.
        wanted: Head,
    },
    /// Something else.
    #[error(
        "{path} exists and is not a file of taught seams: choose another output, or start over with --restart"
    )]
    Unknown {
        /// The file.
        path: String,
    },
    /// The points cannot be understood.
    #[error(transparent)]
    Table(#[from] TableError),
}

/// A file that takes points.
#[derive(Debug)]
pub struct SeamFile {
    path: PathBuf,
    file: File,
    points: usize,
}

/// A file that was opened, and what it held.
#[derive(Debug)]
pub struct Opened {
    /// The file.
    pub file: SeamFile,
    /// Points taught before.
    pub points: Vec<SeamPoint>,
    /// What a person should know of it, a sentence each.
    pub notes: Vec<String>,
}

impl SeamFile {
    /// Opens the file at `path`, or makes one; points that it has already are given back, and new ones follow them.
    /// With `restart` a file that is there gets another name.
    pub fn open(path: &Path, head: &Head, restart: bool) -> Result<Opened, SeamFileError> {
        let name = path.display().to_string();
        let written = |source| SeamFileError::Write {
            path: name.clone(),
            source,
        };
        let mut notes = Vec::new();
        if restart && path.exists() {
            let kept = free_name(path);
            std::fs::rename(path, &kept).map_err(written)?;
            notes.push(format!("the points taught before are in {}", kept.display()));
        }
        let mut points = Vec::new();
        if path.exists() {
            let text = table::read(path)?;
            let found = Head::of(&text).ok_or_else(|| SeamFileError::Unknown { path: name.clone() })?;
            if found != *head {
                let wanted = head.clone();
                return Err(SeamFileError::Foreign {
                    path: name,
                    found,
                    wanted,
                });
            }
            let (complete, cut) = complete(&text);
            points = parse_seam_points(&name, &complete)?
                .into_iter()
                .map(|(_, point)| point)
                .collect();
            if !has_ends(&complete) && !points.is_empty() {
                // What follows has the column.
                replace(path, &(head.text() + &rows_of(&points))).map_err(written)?;
            } else if !has_ends(&complete) {
                replace(path, &head.text()).map_err(written)?;
            }
            if cut {
                notes.push(format!(
                    "the last point in {name} was not complete: it is taught again"
                ));
                replace(path, &(head.text() + &rows_of(&points))).map_err(written)?;
            }
        } else {
            replace(path, &head.text()).map_err(written)?;
        }
        let file = OpenOptions::new().append(true).open(path).map_err(written)?;
        Ok(Opened {
            file: Self {
                path: path.to_owned(),
                file,
                points: points.len(),
            },
            points,
            notes,
        })
    }

    /// Adds a point; it is on the disk afterwards.
    pub fn add(&mut self, point: &SeamPoint) -> Result<(), SeamFileError> {
        self.points += 1;
        let written = self.file.write_all(rows(self.points, point).as_bytes());
        written
            .and_then(|()| self.file.sync_data())
            .map_err(|source| SeamFileError::Write {
                path: self.path.display().to_string(),
                source,
            })
    }

    /// Takes the last point out of the file again; `points` are those that stay.
    pub fn keep(&mut self, points: &[SeamPoint], head: &Head) -> Result<(), SeamFileError> {
        let kept = replace(&self.path, &(head.text() + &rows_of(points)))
            .and_then(|()| OpenOptions::new().append(true).open(&self.path));
        self.file = kept.map_err(|source| SeamFileError::Write {
            path: self.path.display().to_string(),
            source,
        })?;
        self.points = points.len();
        Ok(())
    }
}

/// `text` without a last line that is cut and without half a point, and whether there was one.
fn complete(text: &str) -> (String, bool) {
    let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
    let is_row = |line: &&str| line.starts_with(|c: char| c.is_ascii_digit());
    if whole.lines().filter(is_row).count().is_multiple_of(2) {
        return (whole.to_owned(), whole.len() < text.len());
    }
    let last = whole.trim_end().rfind('\n').map_or(0, |end| end + 1);
    (whole[..last].to_owned(), true)
}

/// Whether a file has the column of the ends.
fn has_ends(text: &str) -> bool {
    header(text).is_some_and(|header| header.split(',').count() > NUMBERS.len())
}

/// The names of the columns of a file.
fn header(text: &str) -> Option<&str> {
    text.lines().find(|line| !line.starts_with('#'))
}

/// How an end is written.
fn name_of(end: Option<SeamEnd>) -> &'static str {
    let [(nothing, _), named @ ..] = ENDS;
    let name = named.into_iter().find(|(_, kind)| *kind == end);
    name.map_or(nothing, |(name, _)| name)
}

/// The rows of all points.
fn rows_of(points: &[SeamPoint]) -> String {
    let numbered = points.iter().enumerate();
    numbered.map(|(index, point)| rows(index + 1, point)).collect()
}

/// The two rows of a point.
fn rows(number: usize, point: &SeamPoint) -> String {
    let row = |(index, foot): (usize, &MeasuredSeam)| {
        let head = [
            number.to_string(),
            (index + 1).to_string(),
            decimal(point.s_mm, 4),
        ];
        let place = foot.position.iter().map(|x| decimal(*x, 4));
        let normal = foot.normal.iter().map(|x| decimal(*x, 7));
        let rest = [
            decimal(foot.width_mm, 4),
            decimal(foot.quality, 3),
            decimal(foot.scatter_mm, 4),
            foot.pictures.to_string(),
            name_of(foot.end).to_owned(),
        ];
        let cells: Vec<String> = head.into_iter().chain(place).chain(normal).chain(rest).collect();
        cells.join(",") + "\n"
    };
    point.feet.iter().enumerate().map(row).collect()
}

/// Reads the points of a taught seam at `path`, each with the line of its first row, in the order of travel.
pub fn read_seam_points(path: &Path) -> Result<Vec<(usize, SeamPoint)>, TableError> {
    parse_seam_points(&path.display().to_string(), &table::read(path)?)
}

/// Understands the `text` of such a file; `path` is used in messages only.
pub fn parse_seam_points(path: &str, text: &str) -> Result<Vec<(usize, SeamPoint)>, TableError> {
    let all = columns();
    let names =
        if has_ends(text) || header(text).is_none_or(|header| header.split(',').count() < NUMBERS.len()) {
            &all[..]
        } else {
            &NUMBERS[..]
        };
    let rows: Vec<Row> = table::cells(path, text, names)?
        .into_iter()
        .map(|(line, cells)| Row::of(path, line, &cells))
        .collect::<Result<_, _>>()?;
    let wrong = |line, reason| TableError::Row {
        path: path.to_owned(),
        line,
        reason,
    };
    let mut points: Vec<(usize, SeamPoint)> = Vec::new();
    for pair in rows.chunks(2) {
        let [first, second] = pair else {
            return Err(wrong(pair[0].line, "the row of side 2 is missing"));
        };
        let sides = [first.values[1], second.values[1]];
        if first.values[0] != second.values[0] || sides != [1.0, 2.0] {
            return Err(wrong(
                second.line,
                "a point has a row of side 1, then one of side 2",
            ));
        }
        let mut feet = [None; 2];
        for (foot, row) in feet.iter_mut().zip([first, second]) {
            *foot = Some(read_foot(row).map_err(|reason| wrong(row.line, reason))?);
        }
        let [Some(one), Some(two)] = feet else { continue };
        let point = SeamPoint {
            s_mm: first.values[2],
            feet: [one, two],
        };
        if let Some((_, before)) = points.last() {
            if point.s_mm <= before.s_mm {
                return Err(wrong(first.line, "s_mm must increase from point to point"));
            }
            let same = |k: usize| (point.feet[k].position - before.feet[k].position).norm() < 1e-3;
            if let Some(k) = (0..2).find(|&k| same(k)) {
                return Err(wrong(pair[k].line, "this point equals the one before"));
            }
        }
        points.push((first.line, point));
    }
    let inner = points.get(1..points.len().saturating_sub(1)).unwrap_or_default();
    let has_end = |(_, point): &&(usize, SeamPoint)| point.feet.iter().any(|foot| foot.end.is_some());
    if let Some((line, _)) = inner.iter().find(has_end) {
        return Err(wrong(
            *line,
            "only the first and the last point are where a seam begins or ends: end is - between them",
        ));
    }
    Ok(points)
}

/// A row and its line in the file.
struct Row {
    line: usize,
    values: [f64; NUMBERS.len()],
    end: Option<SeamEnd>,
}

impl Row {
    fn of(path: &str, line: usize, cells: &[&str]) -> Result<Self, TableError> {
        let values = table::numbers(path, line, NUMBERS, cells)?;
        let end = match cells.get(NUMBERS.len()) {
            None => None,
            Some(text) => {
                let known = ENDS.into_iter().find(|(name, _)| name == text);
                known
                    .ok_or(TableError::Row {
                        path: path.to_owned(),
                        line,
                        reason: "end is plate, tack, or - where the seam goes on",
                    })?
                    .1
            }
        };
        Ok(Self { line, values, end })
    }
}

fn read_foot(row: &Row) -> Result<MeasuredSeam, &'static str> {
    let [
        _,
        _,
        _,
        x,
        y,
        z,
        nx,
        ny,
        nz,
        width_mm,
        quality,
        scatter_mm,
        pictures,
    ] = row.values;
    let normal = Vector3::new(nx, ny, nz);
    if normal.norm() < 1e-6 {
        return Err("the normal has no length");
    }
    if !(0.0..=1.0).contains(&quality) {
        return Err("quality is between 0 and 1");
    }
    if pictures < 1.0 || pictures.fract() != 0.0 {
        return Err("pictures is a count");
    }
    if width_mm < 0.0 || scatter_mm < 0.0 {
        return Err("width_mm and scatter_mm are 0 or more");
    }
    Ok(MeasuredSeam {
        position: Vector3::new(x, y, z),
        normal: normal.normalize(),
        width_mm,
        quality,
        scatter_mm,
        pictures: pictures as usize,
        end: row.end,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head() -> Head {
        Head {
            machine: "gantry".into(),
            part: "rib".into(),
        }
    }

    fn foot(x: f64, y: f64) -> MeasuredSeam {
        MeasuredSeam {
            position: Vector3::new(x, y, 100.25),
            normal: Vector3::new(0.0, 0.6, 0.8),
            width_mm: 0.05,
            quality: 0.9,
            scatter_mm: 0.004,
            pictures: 8,
            end: None,
        }
    }

    fn points(count: usize) -> Vec<SeamPoint> {
        let mut points: Vec<SeamPoint> = Vec::new();
        for i in 0..count {
            let x = 5.0 * i as f64;
            points.push(SeamPoint::after(points.last(), [foot(x, 0.0), foot(x, 4.0)]));
        }
        points
    }

    fn teach(path: &Path, points: &[SeamPoint]) {
        let mut opened = SeamFile::open(path, &head(), false).unwrap();
        points.iter().for_each(|point| opened.file.add(point).unwrap());
    }

    #[test]
    fn points_come_back_and_new_ones_follow_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taught.csv");
        let all = points(5);
        teach(&path, &all[..2]);
        let opened = SeamFile::open(&path, &head(), false).unwrap();
        assert_eq!((opened.points.as_slice(), opened.notes.len()), (&all[..2], 0));
        drop(opened);
        teach(&path, &all[2..]);
        let read = read_seam_points(&path).unwrap();
        let read: Vec<SeamPoint> = read.into_iter().map(|(_, point)| point).collect();
        assert_eq!(read, all);
    }

    #[test]
    fn a_file_cut_at_any_byte_keeps_its_complete_points() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taught.csv");
        let all = points(3);
        teach(&path, &all);
        let text = std::fs::read_to_string(&path).unwrap();
        let begin = head().text().len();
        for end in begin..text.len() {
            std::fs::write(&path, &text[..end]).unwrap();
            let opened = SeamFile::open(&path, &head(), false).unwrap();
            let kept = opened.points.len();
            assert_eq!(opened.points, all[..kept], "cut at {end}");
            drop(opened);
            teach(&path, &all[kept..]);
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text, "cut at {end}");
        }
    }

    #[test]
    fn ends_come_back_and_a_file_without_them_is_read_and_gone_on_with() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taught.csv");
        let mut all = points(4);
        let text = head().text() + &rows_of(&all[..3]);
        let before = text.replace(",end\n", "\n").replace(",8,-\n", ",8\n");
        std::fs::write(&path, before).unwrap();
        let read = |path: &Path| -> Vec<SeamPoint> {
            let points = read_seam_points(path).unwrap();
            points.into_iter().map(|(_, point)| point).collect()
        };
        assert_eq!(read(&path), all[..3]);
        all[3].feet[0].end = Some(SeamEnd::Plate);
        all[3].feet[1].end = Some(SeamEnd::Tack);
        teach(&path, &all[3..]);
        assert_eq!(read(&path), all);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(
            text.contains(",8,plate\n4,2,") && text.ends_with(",8,tack\n"),
            "{text}"
        );
    }

    #[test]
    fn a_file_of_another_part_is_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taught.csv");
        teach(&path, &points(2));
        let other = Head {
            part: "other".into(),
            ..head()
        };
        let error = SeamFile::open(&path, &other, false).unwrap_err().to_string();
        assert!(
            error.contains("for part rib, not on gantry for other") && error.contains("--restart"),
            "{error}"
        );
        let opened = SeamFile::open(&path, &other, true).unwrap();
        assert!(opened.points.is_empty() && opened.notes[0].contains("taught.1.csv"));
        assert_eq!(
            read_seam_points(&path.with_file_name("taught.1.csv"))
                .unwrap()
                .len(),
            2
        );
        std::fs::write(&path, "x,y\n1,2\n").unwrap();
        let unknown = SeamFile::open(&path, &other, false);
        assert!(
            matches!(unknown, Err(SeamFileError::Unknown { .. })),
            "{unknown:?}"
        );
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let text = |rows: &str| format!("{}{rows}", head().text());
        let message = |rows: &str| parse_seam_points("t.csv", &text(rows)).unwrap_err().to_string();
        let row = |point: u32, side: u32, s: f64, x: f64| {
            format!("{point},{side},{s},{x},0,0,0,0,1,0.05,0.9,0.001,8,-\n")
        };
        let ends = |point: u32| {
            let s = 5.0 * f64::from(point - 1);
            (row(point, 1, s, s) + &row(point, 2, s, s)).replace(",8,-", ",8,tack")
        };
        let first = row(1, 1, 0.0, 0.0) + &row(1, 2, 0.0, 0.0);
        for (rows, line, reason) in [
            (
                row(1, 2, 0.0, 0.0) + &row(1, 1, 0.0, 0.0),
                9,
                "then one of side 2",
            ),
            (
                first.clone() + &row(2, 1, 0.0, 5.0) + &row(2, 2, 0.0, 5.0),
                10,
                "must increase",
            ),
            (
                first.clone() + &row(2, 1, 5.0, 5.0) + &row(2, 2, 5.0, 0.0),
                11,
                "equals the one before",
            ),
            (first.clone() + &row(2, 1, 5.0, 5.0), 10, "side 2 is missing"),
            (first.replace(",0,0,1,", ",0,0,0,"), 8, "normal has no length"),
            (first.replace("0.9", "1.9"), 8, "quality"),
            (first.replace(",8,-", ",8,hole"), 8, "end is plate, tack, or -"),
            (
                ends(1) + &ends(2) + &ends(3),
                10,
                "only the first and the last point",
            ),
        ] {
            let message = message(&rows);
            assert!(
                message.contains(&format!("line {line}:")) && message.contains(reason),
                "{message}"
            );
        }
    }
}
