//! Grey pictures.

use thiserror::Error;

/// A grey picture of 8 bits a pixel: row after row from the top, columns from the left.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    pixels: &'a [u8],
    rows: usize,
    columns: usize,
}

/// Why pixels make no picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ImageError {
    /// Their number is not rows × columns.
    #[error("{pixels} pixels do not make {rows} rows of {columns}")]
    Size {
        /// Pixels given.
        pixels: usize,
        /// Rows.
        rows: usize,
        /// Pixels a row.
        columns: usize,
    },
}

impl<'a> Image<'a> {
    /// A picture of `rows` × `columns` pixels.
    pub fn new(pixels: &'a [u8], rows: usize, columns: usize) -> Result<Self, ImageError> {
        if rows.checked_mul(columns) != Some(pixels.len()) {
            let pixels = pixels.len();
            return Err(ImageError::Size {
                pixels,
                rows,
                columns,
            });
        }
        Ok(Self {
            pixels,
            rows,
            columns,
        })
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Pixels a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// A row, from the top.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize) -> &'a [u8] {
        &self.pixels[row * self.columns..][..self.columns]
    }
}
