//! Pictures of the cameras as viewers get them: smaller, and as JPEG.

use host_link::events::{Focus, MeasuredPicture, SeamInPicture};
use image::codecs::jpeg::{JpegDecoder, JpegEncoder};
use image::imageops::{FilterType, resize};
use image::{DynamicImage, GrayImage, ImageDecoder, ImageError};
use serde::{Deserialize, Serialize};
use shared::io::SIDES;
use std::io::Cursor;

/// Pixels a row at most: what a page shows of a picture on a panel of 1280 × 800.
const COLUMNS: u32 = 320;
/// Quality of the JPEG, 1…100: edges and scratches stay where they are.
const QUALITY: u8 = 60;
/// Rows and columns at most that a viewer takes.
const LARGEST: u32 = 4096;

/// A picture, and what was measured in it, in pixels of what is sent.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SentPicture {
    /// The camera, 0 or 1.
    side: usize,
    /// Number of the capture.
    capture: u32,
    /// Grey, 8 bits a pixel.
    jpeg: Vec<u8>,
    /// The seam, if one is accepted.
    seam: Option<SeamInPicture>,
}

impl SentPicture {
    /// Of a picture of the job; `None` of one without pixels.
    #[allow(clippy::cast_possible_truncation, reason = "scaled places of pixels")]
    pub fn of(picture: &MeasuredPicture) -> Option<Self> {
        let [columns, rows] = [picture.columns, picture.rows].map(|side| u32::try_from(side).unwrap_or(0));
        let whole = GrayImage::from_raw(columns, rows, picture.pixels.clone())?;
        if columns == 0 || rows == 0 {
            return None;
        }
        let width = columns.min(COLUMNS);
        let height = (rows * width / columns).max(1);
        let smaller = if width == columns {
            whole
        } else {
            resize(&whole, width, height, FilterType::Triangle)
        };
        let mut jpeg = Vec::new();
        JpegEncoder::new_with_quality(&mut jpeg, QUALITY)
            .encode_image(&smaller)
            .ok()?;
        let scales = [
            f64::from(height) / f64::from(rows),
            f64::from(width) / f64::from(columns),
        ];
        let scaled = |end: [f32; 2]| {
            std::array::from_fn(|axis| ((f64::from(end[axis]) + 0.5) * scales[axis] - 0.5) as f32)
        };
        let seam = picture.seam.map(|seam| SeamInPicture {
            edges: seam.edges.map(|edge| edge.map(scaled)),
            ..seam
        });
        Some(Self {
            side: picture.side,
            capture: picture.capture,
            jpeg,
            seam,
        })
    }

    /// As the screen shows it.
    ///
    /// # Errors
    /// It is no picture of a camera.
    pub fn decode(self) -> Result<MeasuredPicture, ImageError> {
        let mut decoder = JpegDecoder::new(Cursor::new(self.jpeg))?;
        let mut limits = image::Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(LARGEST), Some(LARGEST));
        decoder.set_limits(limits)?;
        let pixels = DynamicImage::from_decoder(decoder)?.into_luma8();
        Ok(MeasuredPicture {
            side: self.side.min(SIDES - 1),
            capture: self.capture,
            rows: pixels.height() as usize,
            columns: pixels.width() as usize,
            pixels: pixels.into_raw(),
            seam: self.seam,
            // Viewers have no page that shows these.
            measurement: None,
            focus: Focus::default(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bright above a slope from the left at row 60 to the right at row 180.
    fn sloped() -> MeasuredPicture {
        let (rows, columns) = (300, 400);
        let edge = |column: usize| 60.0 + 120.0 * column as f64 / columns as f64;
        let pixels = (0..rows * columns)
            .map(|at| {
                if ((at / columns) as f64) < edge(at % columns) {
                    220
                } else {
                    30
                }
            })
            .collect();
        let ends = [[59.5, -0.5], [179.5, 399.5]];
        MeasuredPicture {
            side: 1,
            capture: 77,
            rows,
            columns,
            pixels,
            seam: Some(SeamInPicture {
                lateral_mm: 0.1,
                travel_mm: 0.2,
                height_mm: None,
                width_mm: 0.0,
                quality: 0.9,
                edges: [ends; 2],
            }),
            measurement: None,
            focus: Focus::default(),
        }
    }

    #[test]
    fn a_picture_comes_smaller_with_its_seam_where_it_was_in_it() {
        let sent = SentPicture::of(&sloped()).unwrap();
        assert!(sent.jpeg.len() < 12_000, "{}", sent.jpeg.len());
        let seen = sent.decode().unwrap();
        assert_eq!(
            (seen.side, seen.capture, seen.rows, seen.columns),
            (1, 77, 240, 320)
        );
        let [[from, to], _] = seen.seam.unwrap().edges;
        // Half way between its ends the edge is between bright and dark, within a pixel.
        let (row, column) = ((from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0);
        let at = |row: f32| seen.pixels[row.round() as usize * seen.columns + column.round() as usize];
        assert!(
            at(row - 2.0) > 180 && at(row + 2.0) < 70,
            "{} {}",
            at(row - 2.0),
            at(row + 2.0)
        );
    }

    #[test]
    fn what_is_no_picture_is_refused() {
        let nothing = MeasuredPicture {
            rows: 0,
            pixels: Vec::new(),
            ..sloped()
        };
        assert!(SentPicture::of(&nothing).is_none());
        let mut sent = SentPicture::of(&sloped()).unwrap();
        sent.jpeg.truncate(40);
        assert!(sent.decode().is_err());
    }
}
