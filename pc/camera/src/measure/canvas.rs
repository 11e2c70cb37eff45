//! A coloured picture to draw on.

use crate::{Picture, PngError, write_rgb};
use std::path::Path;
use tiny_skia::{Color, LineJoin, Paint, PathBuilder, Pixmap, Rect, Stroke, StrokeDash, Transform};

/// Red, green, blue.
pub type Colour = [u8; 3];

/// A picture, enlarged, and what is drawn over it. Places are \[row, column\] of the picture, pixel centres from 0.
#[derive(Clone, Debug)]
pub struct Canvas {
    enlarged: usize,
    pixels: Pixmap,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Pen {
    /// Its colour.
    pub colour: Colour,
    /// Width \[pixels of the canvas\].
    pub width: f32,
    /// How much of the picture it covers, 0 to 1.
    pub opacity: f32,
    /// Length of dashes and of the gaps between them \[pixels of the canvas\].
    pub dash: Option<f32>,
}

impl Pen {
    /// A full line that covers what is under it.
    pub fn new(colour: Colour, width: f32) -> Self {
        Self {
            colour,
            width,
            opacity: 1.0,
            dash: None,
        }
    }

    /// The same in dashes.
    pub fn dashed(self, length: f32) -> Self {
        Self {
            dash: Some(length),
            ..self
        }
    }

    /// The same, through which the picture is seen.
    pub fn faint(self, opacity: f32) -> Self {
        Self { opacity, ..self }
    }
}

impl Canvas {
    /// Shows a picture of one pixel or more, each of its pixels as `enlarged` × `enlarged`.
    pub fn new(picture: &Picture, enlarged: usize) -> Self {
        let [columns, rows] = [picture.columns, picture.rows].map(|count| (count * enlarged) as u32);
        let mut pixels = Pixmap::new(columns, rows).expect("a picture with pixels");
        let enlarge = |(k, pixel): (usize, &mut [u8])| {
            let (row, column) = (k / columns as usize / enlarged, k % columns as usize / enlarged);
            let grey = picture.pixels[row * picture.columns + column];
            pixel.copy_from_slice(&[grey, grey, grey, u8::MAX]);
        };
        pixels
            .data_mut()
            .chunks_exact_mut(4)
            .enumerate()
            .for_each(enlarge);
        Self { enlarged, pixels }
    }

    /// One of a single colour.
    pub fn blank(rows: usize, columns: usize, colour: Colour) -> Self {
        let mut pixels =
            Pixmap::new(columns.max(1) as u32, rows.max(1) as u32).expect("a canvas with pixels");
        let [red, green, blue] = colour;
        pixels.fill(Color::from_rgba8(red, green, blue, u8::MAX));
        Self { enlarged: 1, pixels }
    }

    /// Rows and columns \[pixels of the canvas\].
    pub fn size_pixels(&self) -> [usize; 2] {
        [self.pixels.height(), self.pixels.width()].map(|count| count as usize)
    }

    /// Colour of a pixel at \[row, column\] of the canvas.
    pub fn at(&self, [row, column]: [usize; 2]) -> Colour {
        let at = 4 * (row * self.pixels.width() as usize + column);
        let pixel = &self.pixels.data()[at..at + 3];
        [pixel[0], pixel[1], pixel[2]]
    }

    /// Colours a pixel at \[row, column\] of the canvas; one outside is left out.
    pub fn set(&mut self, [row, column]: [usize; 2], [red, green, blue]: Colour) {
        let [rows, columns] = self.size_pixels();
        if row < rows && column < columns {
            let at = 4 * (row * columns + column);
            self.pixels.data_mut()[at..at + 4].copy_from_slice(&[red, green, blue, u8::MAX]);
        }
    }

    /// Puts another canvas on this one, its upper left corner at \[row, column\]; what does not fit is left out.
    pub fn paste(&mut self, other: &Self, [row, column]: [usize; 2]) {
        let [rows, columns] = other.size_pixels();
        for r in 0..rows {
            for c in 0..columns {
                self.set([row + r, column + c], other.at([r, c]));
            }
        }
    }

    /// The same with `rows` more below it, in one colour.
    pub fn extended(&self, rows: usize, colour: Colour) -> Self {
        let [height, width] = self.size_pixels();
        let mut canvas = Self::blank(height + rows, width, colour);
        canvas.paste(self, [0, 0]);
        canvas.enlarged = self.enlarged;
        canvas
    }

    /// Each pixel the mean of `times` × `times` of these.
    pub fn shrunk(&self, times: usize) -> Self {
        let [rows, columns] = self.size_pixels().map(|count| count / times);
        let mut canvas = Self::blank(rows, columns, [0; 3]);
        for row in 0..rows {
            for column in 0..columns {
                let mut sum = [0_usize; 3];
                for k in 0..times * times {
                    let colour = self.at([row * times + k / times, column * times + k % times]);
                    sum.iter_mut()
                        .zip(colour)
                        .for_each(|(sum, part)| *sum += usize::from(part));
                }
                canvas.set([row, column], sum.map(|sum| (sum / (times * times)) as u8));
            }
        }
        canvas
    }

    /// Writes it.
    pub fn write(&self, path: &Path) -> Result<(), PngError> {
        let opaque = self.pixels.pixels().iter();
        let colours: Vec<u8> = opaque.flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
        let [rows, columns] = [self.pixels.height(), self.pixels.width()].map(|count| count as usize);
        write_rgb(path, rows, columns, &colours)
    }

    /// Draws lines from place to place; what lies outside is left out.
    pub fn lines(&mut self, places: &[[f64; 2]], pen: Pen) {
        let mut path = PathBuilder::new();
        for (k, place) in places.iter().enumerate() {
            let [y, x] = place.map(|pixel| ((pixel + 0.5) * self.enlarged as f64) as f32);
            match k {
                0 => path.move_to(x, y),
                _ => path.line_to(x, y),
            }
        }
        let stroke = Stroke {
            width: pen.width,
            line_join: LineJoin::Round,
            dash: pen.dash.and_then(|length| StrokeDash::new(vec![length; 2], 0.0)),
            ..Stroke::default()
        };
        // No path of a single place, nor with numbers that are not finite.
        if let Some(path) = path.finish() {
            let paint = paint(pen.colour, pen.opacity);
            self.pixels
                .stroke_path(&path, &paint, &stroke, Transform::identity(), None);
        }
    }

    /// Draws a frame inside the border.
    pub fn frame(&mut self, colour: Colour, width: f32) {
        let [right, bottom] = [self.pixels.width(), self.pixels.height()].map(|count| count as f32);
        for [x, y, w, h] in [
            [0.0, 0.0, right, width],
            [0.0, bottom - width, right, width],
            [0.0, 0.0, width, bottom],
            [right - width, 0.0, width, bottom],
        ] {
            if let Some(side) = Rect::from_xywh(x, y, w, h) {
                self.pixels
                    .fill_rect(side, &paint(colour, 1.0), Transform::identity(), None);
            }
        }
    }
}

fn paint(colour: Colour, opacity: f32) -> Paint<'static> {
    let [red, green, blue] = colour.map(|part| f32::from(part) / 255.0);
    let mut paint = Paint::default();
    paint.set_color(Color::from_rgba(red, green, blue, opacity).unwrap_or(Color::BLACK));
    paint
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
        canvas.at([row, column])
    }

    #[test]
    fn a_line_lies_where_it_was_put_and_nowhere_else() {
        let mut canvas = canvas();
        assert_eq!((canvas.pixels.height(), canvas.pixels.width()), (20, 40));
        // The middle of pixel 4 is between pixels 8 and 9 of the canvas.
        canvas.lines(&[[4.0, -50.0], [4.0, 50.0]], Pen::new(RED, 2.0));
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
        canvas.lines(&[[4.0, 0.0], [4.0, 19.0]], Pen::new(RED, 2.0).dashed(6.0));
        let covered = (0..40).filter(|column| at(&canvas, 8, *column) == RED).count();
        assert!((15..=25).contains(&covered), "{covered}");
        canvas.lines(&[[8.0, 0.0], [8.0, 19.0]], Pen::new(RED, 2.0).faint(0.5));
        assert_eq!(at(&canvas, 16, 20), [178, 50, 50]);
    }

    #[test]
    fn a_canvas_is_shrunk_extended_and_pasted() {
        let mut canvas = canvas();
        for place in [[0, 0], [0, 1], [1, 0], [1, 1], [0, 2]] {
            canvas.set(place, RED);
        }
        let half = canvas.shrunk(2);
        assert_eq!(half.size_pixels(), [10, 20]);
        assert_eq!(at(&half, 0, 0), RED);
        assert_eq!(at(&half, 0, 1), [138, 75, 75]);
        let longer = half.extended(3, [9; 3]);
        assert_eq!(longer.size_pixels(), [13, 20]);
        assert_eq!((at(&longer, 9, 19), at(&longer, 10, 0)), ([100; 3], [9; 3]));
        let mut sheet = Canvas::blank(12, 12, [0; 3]);
        sheet.paste(&half, [5, 6]);
        assert_eq!((at(&sheet, 5, 6), at(&sheet, 4, 6)), (RED, [0; 3]));
    }

    #[test]
    fn a_line_outside_is_left_out() {
        let mut canvas = canvas();
        let before = canvas.pixels.data().to_vec();
        canvas.lines(&[[-30.0, -30.0], [-3.0, -9.0]], Pen::new(RED, 1.0));
        canvas.lines(&[[60.0, 60.0], [90.0, 90.0]], Pen::new(RED, 1.0));
        assert_eq!(canvas.pixels.data(), before);
    }
}
