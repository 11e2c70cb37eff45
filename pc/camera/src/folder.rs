//! A folder of pictures with the times of their captures, as a source of pictures.
//!
//! Beside the PNG files stands `captures.csv`, a row for each picture in the order of the captures:
//!
//! ```csv
//! capture,time_us,file
//! 17,1250000,capture-00000017.png
//! ```
//!
//! [`Recorder`](crate::Recorder) writes such folders.

use crate::{Arrival, Camera, CameraError, Picture, read_grey};
use config::table::{self, TableError};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Name of the list of captures in a folder.
pub const CAPTURES: &str = "captures.csv";

/// Columns of that list.
pub const COLUMNS: [&str; 3] = ["capture", "time_us", "file"];

/// A picture of a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    /// Number of its capture.
    pub capture: u32,
    /// When it was taken \[µs\].
    pub time_us: u64,
    /// The file.
    pub file: PathBuf,
}

/// Pictures of a folder, given to the strobes of the captures they were recorded at.
#[derive(Clone, Debug)]
pub struct Folder {
    /// By rising numbers of captures.
    recorded: Vec<Recorded>,
    /// Captures strobed and not yet answered, and when.
    strobed: VecDeque<(u32, u64)>,
}

impl Folder {
    /// Reads the list of captures in `folder`; the pictures are read as they are asked for.
    pub fn open(folder: &Path) -> Result<Self, CameraError> {
        let list = folder.join(CAPTURES);
        let text = table::read(&list)?;
        let recorded = parse_captures(&list.display().to_string(), folder, &text)?;
        Ok(Self {
            recorded,
            strobed: VecDeque::new(),
        })
    }

    /// What the folder holds, in the order of the captures.
    pub fn recorded(&self) -> &[Recorded] {
        &self.recorded
    }
}

impl Camera for Folder {
    fn strobed(&mut self, capture: u32, time_us: u64) {
        self.strobed.push_back((capture, time_us));
    }

    /// Never waits: a capture that the folder does not hold is lost.
    fn next(&mut self, _: Duration, picture: &mut Picture) -> Result<Arrival, CameraError> {
        let Some((capture, time_us)) = self.strobed.pop_front() else {
            return Ok(Arrival::Nothing);
        };
        let Ok(place) = self
            .recorded
            .binary_search_by_key(&capture, |recorded| recorded.capture)
        else {
            return Ok(Arrival::Lost { capture });
        };
        read_grey(&self.recorded[place].file, picture)?;
        (picture.capture, picture.time_us) = (capture, time_us);
        Ok(Arrival::Picture)
    }
}

/// Understands the list of captures of `folder`; `name` is used in messages only.
pub fn parse_captures(name: &str, folder: &Path, text: &str) -> Result<Vec<Recorded>, TableError> {
    let mut recorded: Vec<Recorded> = Vec::new();
    for (line, cells) in table::cells(name, text, &COLUMNS)? {
        let &[capture, time_us, file] = &cells[..] else {
            continue;
        };
        let wrong = |reason| TableError::Row {
            path: name.to_owned(),
            line,
            reason,
        };
        let capture = capture
            .parse()
            .map_err(|_| wrong("a capture must be a whole number below 2^32"))?;
        let time_us = time_us
            .parse()
            .map_err(|_| wrong("a time must be a whole number of microseconds"))?;
        if recorded.last().is_some_and(|last| last.capture >= capture) {
            return Err(wrong("captures must be in ascending order, each once"));
        }
        recorded.push(Recorded {
            capture,
            time_us,
            file: folder.join(file),
        });
    }
    if recorded.is_empty() {
        return Err(TableError::Short {
            path: name.to_owned(),
            wanted: 1,
        });
    }
    Ok(recorded)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &str) -> String {
        let error = parse_captures("a/captures.csv", Path::new("a"), text).expect_err("refused");
        error.to_string()
    }

    #[test]
    fn a_wrong_list_is_named_by_its_line() {
        assert!(said("capture,file\n").contains("line 1: the header must be capture,time_us,file"));
        assert!(said("capture,time_us,file\n").contains("at least 1 rows"));
        assert!(said("capture,time_us,file\n1,2\n").contains("line 2: 2 values instead of 3"));
        assert!(said("capture,time_us,file\n-1,2,a.png\n").contains("line 2: a capture must be"));
        assert!(said("capture,time_us,file\n1,soon,a.png\n").contains("line 2: a time must be"));
        assert!(said("capture,time_us,file\n2,2,a.png\n\n2,3,b.png\n").contains("line 4: captures must"));
    }

    #[test]
    fn a_list_stands_beside_its_pictures() {
        let text = format!(
            "\u{feff}# of a weld\n{}\n7, 35000 ,x.png\r\n9,45000,y.png\n",
            COLUMNS.join(",")
        );
        let recorded = parse_captures("list", Path::new("dir"), &text).expect("a list");
        assert_eq!(recorded.len(), 2);
        assert_eq!((recorded[0].capture, recorded[0].time_us), (7, 35_000));
        assert_eq!(recorded[1].file, Path::new("dir/y.png"));
    }
}
