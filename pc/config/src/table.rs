//! Tables of numbers: CSV with a fixed header, every problem named by its line.

use std::path::Path;
use thiserror::Error;

/// Nothing that a machine of this kind works on is larger \[mm\]: what is, is a slip of the pen, and the work of planning
/// grows with it. A hundred metres, more than the longest gantries have.
pub const FARTHEST_MM: f64 = 1e5;

/// Why a table cannot be used. Reads as one sentence.
#[derive(Debug, Error)]
pub enum TableError {
    /// The file cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Other columns.
    #[error("{path}, line {line}: the header must be {wanted}")]
    Header {
        /// The file.
        path: String,
        /// First line is 1.
        line: usize,
        /// The header.
        wanted: String,
    },
    /// Too many or too few values.
    #[error("{path}, line {line}: {found} values instead of {wanted}")]
    Count {
        /// The file.
        path: String,
        /// First line is 1.
        line: usize,
        /// Values there.
        found: usize,
        /// Columns.
        wanted: usize,
    },
    /// Not a number.
    #[error("{path}, line {line}: \"{text}\" is not a finite number ({column})")]
    Number {
        /// The file.
        path: String,
        /// First line is 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// What stands there.
        text: String,
    },
    /// A number that is out of all proportion.
    #[error(
        "{path}, line {line}: {value:e} is too large ({column}): at most {FARTHEST_MM} is possible, correct it"
    )]
    TooLarge {
        /// The file.
        path: String,
        /// First line is 1.
        line: usize,
        /// Name of the column.
        column: String,
        /// What stands there.
        value: f64,
    },
    /// The rows are not in order, or two are equal.
    #[error("{path}, line {line}: {reason}")]
    Row {
        /// The file.
        path: String,
        /// First line is 1.
        line: usize,
        /// What is wrong.
        reason: &'static str,
    },
    /// Not enough rows.
    #[error("{path}: at least {wanted} rows are needed")]
    Short {
        /// The file.
        path: String,
        /// How many.
        wanted: usize,
    },
}

/// One row and its line in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<const N: usize> {
    /// First line is 1.
    pub line: usize,
    /// Values, none beyond [`FARTHEST_MM`].
    pub values: [f64; N],
}

/// The text of the file at `path`.
pub fn read(path: &Path) -> Result<String, TableError> {
    std::fs::read_to_string(path).map_err(|source| TableError::Read {
        path: path.display().to_string(),
        source,
    })
}

/// The rows of `text`, which starts with the names of the `columns`; empty lines and comments, which begin with #,
/// are left out. `path` is used in messages only.
pub fn parse<const N: usize>(path: &str, text: &str, columns: [&str; N]) -> Result<Vec<Row<N>>, TableError> {
    let path = || path.to_owned();
    let mut lines = text
        .lines()
        .enumerate()
        .filter(|(_, line)| !line.starts_with('#'));
    let (index, header) = lines.next().map_or((0, ""), |(index, line)| {
        (index, line.trim_start_matches('\u{feff}'))
    });
    if !header.split(',').map(str::trim).eq(columns) {
        let (line, wanted) = (index + 1, columns.join(","));
        return Err(TableError::Header {
            path: path(),
            line,
            wanted,
        });
    }
    let mut rows = Vec::new();
    for (index, content) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let line = index + 1;
        let cells: Vec<&str> = content.split(',').map(str::trim).collect();
        let (found, wanted) = (cells.len(), N);
        if found != wanted {
            let path = path();
            return Err(TableError::Count {
                path,
                line,
                found,
                wanted,
            });
        }
        let mut values = [0.0; N];
        for ((value, text), column) in values.iter_mut().zip(&cells).zip(columns) {
            *value = text
                .parse()
                .ok()
                .filter(|x: &f64| x.is_finite())
                .ok_or_else(|| TableError::Number {
                    path: path(),
                    line,
                    column: column.to_owned(),
                    text: (*text).to_owned(),
                })?;
            if value.abs() > FARTHEST_MM {
                return Err(TableError::TooLarge {
                    path: path(),
                    line,
                    column: column.to_owned(),
                    value: *value,
                });
            }
        }
        rows.push(Row { line, values });
    }
    Ok(rows)
}
/// Number of the line that holds byte `offset`; the first is 1.
pub fn line_of(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|b| *b == b'\n').count()
}
