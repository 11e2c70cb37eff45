//! A folder of pictures to calibrate from, and what is known of each.

use super::CalibrateError;
use crate::{Picture, read_grey};
use config::table::{self, TableError};
use std::path::{Path, PathBuf};

/// Name of the list of pictures in a folder.
pub const PICTURES: &str = "calibration.csv";

/// A picture to calibrate from, with N known values.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferencePicture<const N: usize> {
    /// Its file, for messages.
    pub file: PathBuf,
    /// The picture.
    pub picture: Picture,
    /// The values, in the order of the columns.
    pub values: [f64; N],
}

impl ReferencePicture<3> {
    /// The same with a fourth value: 0 mm of travel of the machine.
    pub fn at_rest(self) -> ReferencePicture<4> {
        let [a, b, c] = self.values;
        let (file, picture) = (self.file, self.picture);
        let values = [a, b, c, 0.0];
        ReferencePicture {
            file,
            picture,
            values,
        }
    }
}

/// The pictures of `folder`, with the numbers that its list has in `columns` after the file's name.
pub fn read_pictures<const N: usize>(
    folder: &Path,
    columns: [&str; N],
) -> Result<Vec<ReferencePicture<N>>, CalibrateError> {
    let list = folder.join(PICTURES);
    let text = table::read(&list)?;
    let known = |(file, values)| {
        let file: PathBuf = folder.join(file);
        let mut picture = Picture::default();
        read_grey(&file, &mut picture)?;
        Ok(ReferencePicture {
            file,
            picture,
            values,
        })
    };
    let listed = parse_list(&list.display().to_string(), &text, columns)?;
    listed.into_iter().map(known).collect()
}

/// Files and numbers of a list; `name` is used in messages only.
pub fn parse_list<'a, const N: usize>(
    name: &str,
    text: &'a str,
    columns: [&str; N],
) -> Result<Vec<(&'a str, [f64; N])>, TableError> {
    let all: Vec<&str> = std::iter::once("file").chain(columns).collect();
    let rows = table::cells(name, text, &all)?.into_iter();
    rows.map(|(line, cells)| Ok((cells[0], table::numbers(name, line, columns, &cells[1..])?)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_has_a_file_and_its_numbers_a_row() {
        let rows = parse_list(
            "list",
            "file, u_mm,v_mm\r\na.png, 0.1,-0.2\n\nb.png,0,1e-1\n",
            ["u_mm", "v_mm"],
        );
        assert_eq!(rows.unwrap(), [("a.png", [0.1, -0.2]), ("b.png", [0.0, 0.1])]);
    }

    #[test]
    fn a_wrong_list_is_named_by_its_line() {
        let said = |text: &str| parse_list("list", text, ["u_mm"]).unwrap_err().to_string();
        assert_eq!(said("file,v_mm\n"), "list, line 1: the header must be file,u_mm");
        assert_eq!(said("file,u_mm\na.png\n"), "list, line 2: 1 values instead of 2");
        assert_eq!(
            said("file,u_mm\n\na.png,left\n"),
            "list, line 3: \"left\" is not a finite number (u_mm)"
        );
    }
}
