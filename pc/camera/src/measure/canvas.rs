//! A coloured picture to draw on.

use crate::{Picture, PngError, write_rgb};
use std::path::Path;

/// Red, green, blue.
pub type Colour = [u8; 3];

/// A picture, enlarged, and what is drawn over it. Places are \[row, column\] of the picture, pixel centres from 0.
#[derive(Clone, Debug)]
pub struct Canvas {
    enlarged: usize,
    rows: usize,
    columns: usize,
    pixels: Vec<u8>,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Pen {
    /// Its colour.
    pub colour: Colour,
    /// Width \[pixels of the canvas\].
    pub width: f64,
    /// How much of the picture it covers, 0 to 1.
    pub opacity: f64,
    /// Length of dashes and of the gaps between them \[pixels of the canvas\].
    pub dash: Option<f64>,
}

impl Pen {
    /// A full line that covers what is under it.
    pub fn new(colour: Colour, width: f64) -> Self {
        Self {
            colour,
            width,
            opacity: 1.0,
            dash: None,
        }
    }

    /// The same in dashes.
    pub fn dashed(self, length: f64) -> Self {
        Self {
            dash: Some(length),
            ..self
        }
    }

    /// The same, through which the picture is seen.
    pub fn faint(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

impl Canvas {
    /// Shows a picture, each of its pixels as `enlarged` × `enlarged`.
    pub fn new(picture: &Picture, enlarged: usize) -> Self {
        let (rows, columns) = (picture.rows * enlarged, picture.columns * enlarged);
        let mut pixels = Vec::with_capacity(3 * rows * columns);
        for row in 0..rows {
            let line = &picture.pixels[row / enlarged * picture.columns..][..picture.columns];
            for column in 0..columns {
                pixels.extend([line[column / enlarged]; 3]);
            }
        }
        Self {
            enlarged,
            rows,
            columns,
            pixels,
        }
    }

    /// Writes it.
    pub fn write(&self, path: &Path) -> Result<(), PngError> {
        write_rgb(path, self.rows, self.columns, &self.pixels)
    }

    /// Draws a straight line between two places; what lies outside is left out.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], pen: Pen) {
        let (from, to) = (self.on_canvas(from), self.on_canvas(to));
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]).max(1e-9);
        let reach = pen.width / 2.0 + 1.0;
        let span = |axis: usize, end: usize| {
            let low = from[axis].min(to[axis]) - reach;
            let high = from[axis].max(to[axis]) + reach;
            (low.max(0.0) as usize)..(high.clamp(0.0, end as f64) as usize)
        };
        for row in span(0, self.rows) {
            for column in span(1, self.columns) {
                let off = [row as f64 - from[0], column as f64 - from[1]];
                let way = (off[0] * along[0] + off[1] * along[1]) / length;
                if pen.dash.is_some_and(|dash| (way / dash).rem_euclid(2.0) >= 1.0) {
                    continue;
                }
                let beside = (off[0] * along[1] - off[1] * along[0]).abs() / length;
                let beyond = (way - length).max(-way).max(0.0);
                let across = (pen.width / 2.0 + 0.5 - beside).clamp(0.0, 1.0);
                let cover = across * (1.0 - beyond).clamp(0.0, 1.0);
                self.blend(row, column, pen.colour, cover * pen.opacity);
            }
        }
    }

    /// Draws lines from place to place.
    pub fn lines(&mut self, places: &[[f64; 2]], pen: Pen) {
        for pair in places.windows(2) {
            self.line(pair[0], pair[1], pen);
        }
    }

    /// Draws a frame inside the border.
    pub fn frame(&mut self, colour: Colour, width: usize) {
        for row in 0..self.rows {
            for column in 0..self.columns {
                let inside = row
                    .min(column)
                    .min(self.rows - 1 - row)
                    .min(self.columns - 1 - column);
                if inside < width {
                    self.blend(row, column, colour, 1.0);
                }
            }
        }
    }

    fn on_canvas(&self, place: [f64; 2]) -> [f64; 2] {
        place.map(|pixel| (pixel + 0.5) * self.enlarged as f64 - 0.5)
    }

    fn blend(&mut self, row: usize, column: usize, colour: Colour, cover: f64) {
        let at = 3 * (row * self.columns + column);
        for (pixel, colour) in self.pixels[at..at + 3].iter_mut().zip(colour) {
            let value = f64::from(*pixel) * (1.0 - cover) + f64::from(colour) * cover;
            *pixel = value.round() as u8;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Colour = [255, 0, 0];

    fn canvas() -> Canvas {
        let picture = Picture {
            rows: 10,
            columns: 20,
            pixels: vec![100; 200],
            ..Picture::default()
        };
        Canvas::new(&picture, 2)
    }

    fn at(canvas: &Canvas, row: usize, column: usize) -> Colour {
        let at = 3 * (row * canvas.columns + column);
        canvas.pixels[at..at + 3].try_into().expect("three")
    }

    #[test]
    fn a_line_lies_where_it_was_put_and_nowhere_else() {
        let mut canvas = canvas();
        assert_eq!((canvas.rows, canvas.columns), (20, 40));
        // The middle of pixel 4 is between pixels 8 and 9 of the canvas.
        canvas.line([4.0, -50.0], [4.0, 50.0], Pen::new(RED, 2.0));
        for column in 0..40 {
            for row in 0..20 {
                let colour = if row == 8 || row == 9 { RED } else { [100; 3] };
                assert_eq!(at(&canvas, row, column), colour, "{row} {column}");
            }
        }
    }

    #[test]
    fn dashes_and_faint_lines_leave_the_picture_to_be_seen() {
        let mut canvas = canvas();
        canvas.line([4.0, 0.0], [4.0, 19.0], Pen::new(RED, 2.0).dashed(6.0));
        let covered = (0..40).filter(|column| at(&canvas, 8, *column) == RED).count();
        assert!((15..=25).contains(&covered), "{covered}");
        canvas.line([8.0, 0.0], [8.0, 19.0], Pen::new(RED, 2.0).faint(0.5));
        assert_eq!(at(&canvas, 16, 20), [178, 50, 50]);
    }

    #[test]
    fn a_line_outside_is_left_out() {
        let mut canvas = canvas();
        let before = canvas.pixels.clone();
        canvas.line([-30.0, -30.0], [-3.0, -9.0], Pen::new(RED, 1.0));
        canvas.line([60.0, 60.0], [90.0, 90.0], Pen::new(RED, 1.0));
        assert_eq!(canvas.pixels, before);
    }
}
