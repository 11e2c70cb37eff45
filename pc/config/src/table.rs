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

/// Line number and cells of every row of `text`, which starts with the names of the `columns`. Spaces around cells, empty
/// lines and comments, which begin with #, are left out. `path` is used in messages only.
///
/// # Errors
/// Other columns; a row with more or fewer cells.
pub fn cells<'a>(
    path: &str,
    text: &'a str,
    columns: &[&str],
) -> Result<Vec<(usize, Vec<&'a str>)>, TableError> {
    let path = || path.to_owned();
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.starts_with('#'));
    let (line, header) = lines.next().unwrap_or((1, ""));
    if !header.split(',').map(str::trim).eq(columns.iter().copied()) {
        return Err(TableError::Header {
            path: path(),
            line,
            wanted: columns.join(","),
        });
    }
    let rows = lines.filter(|(_, line)| !line.trim().is_empty());
    rows.map(|(line, content)| {
        let cells: Vec<&str> = content.split(',').map(str::trim).collect();
        if cells.len() == columns.len() {
            return Ok((line, cells));
        }
        Err(TableError::Count {
            path: path(),
            line,
            found: cells.len(),
            wanted: columns.len(),
        })
    })
    .collect()
}

/// The numbers in the `cells` of a row, finite and no larger than [`FARTHEST_MM`].
///
/// # Errors
/// Something else, named by `path`, `line` and column.
pub fn numbers<const N: usize>(
    path: &str,
    line: usize,
    columns: [&str; N],
    cells: &[&str],
) -> Result<[f64; N], TableError> {
    let mut values = [0.0; N];
    for ((value, text), column) in values.iter_mut().zip(cells).zip(columns) {
        *value = number(path, line, column, text)?;
    }
    Ok(values)
}

fn number(path: &str, line: usize, column: &str, text: &str) -> Result<f64, TableError> {
    let finite = text.parse().ok().filter(|value: &f64| value.is_finite());
    let value = finite.ok_or_else(|| TableError::Number {
        path: path.to_owned(),
        line,
        column: column.to_owned(),
        text: shortened(text),
    })?;
    if value.abs() > FARTHEST_MM {
        return Err(TableError::TooLarge {
            path: path.to_owned(),
            line,
            column: column.to_owned(),
            value,
        });
    }
    Ok(value)
}

/// As much of a cell as a message takes.
fn shortened(text: &str) -> String {
    const MOST: usize = 40;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// The rows of `text` as numbers; otherwise as [`cells`].
///
/// # Errors
/// Those of [`cells`] and [`numbers`].
pub fn parse<const N: usize>(path: &str, text: &str, columns: [&str; N]) -> Result<Vec<Row<N>>, TableError> {
    let row = |(line, cells): (usize, Vec<&str>)| {
        let values = numbers(path, line, columns, &cells)?;
        Ok(Row { line, values })
    };
    cells(path, text, &columns)?.into_iter().map(row).collect()
}
