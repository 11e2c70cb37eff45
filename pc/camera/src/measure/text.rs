//! Text on a canvas, in fonts of whole pixels.

use super::canvas::{Canvas, Colour};
use embedded_graphics::Pixel;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::iso_8859_1::{FONT_6X13, FONT_9X15, FONT_9X15_BOLD, FONT_10X20};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::Rgb888;
use embedded_graphics::prelude::{DrawTarget, Drawable, RgbColor};
use embedded_graphics::text::{Baseline, Text};
use std::convert::Infallible;

/// Sizes of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Font {
    /// 6 × 13 pixels a character.
    Small,
    /// 9 × 15 pixels.
    Medium,
    /// The same in bold.
    Bold,
    /// 10 × 20 pixels.
    Large,
}

impl Font {
    /// The one that suits a picture so many pixels wide: about 80 characters a line.
    pub fn for_width(width: usize) -> Self {
        match width {
            0..600 => Self::Small,
            600..1000 => Self::Medium,
            _ => Self::Large,
        }
    }

    /// Width and height of a character \[pixels\].
    pub fn size(self) -> [usize; 2] {
        let Size { width, height } = self.font().character_size;
        [width, height].map(|pixels| pixels as usize)
    }

    fn font(self) -> &'static MonoFont<'static> {
        match self {
            Self::Small => &FONT_6X13,
            Self::Medium => &FONT_9X15,
            Self::Bold => &FONT_9X15_BOLD,
            Self::Large => &FONT_10X20,
        }
    }
}

/// `text` in lines of at most `most` characters, broken between words; a longer word is cut.
pub fn wrapped(text: &str, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let word: String = word.chars().take(most).collect();
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines
}

impl Canvas {
    /// Writes a line of text, its upper left corner at \[row, column\] of the canvas.
    pub fn text(&mut self, [row, column]: [usize; 2], text: &str, font: Font, colour: Colour) {
        let [red, green, blue] = colour;
        let style = MonoTextStyle::new(font.font(), Rgb888::new(red, green, blue));
        let at = Point::new(column as i32, row as i32);
        let Ok(_) = Text::with_baseline(text, at, style, Baseline::Top).draw(self);
    }
}

impl OriginDimensions for Canvas {
    fn size(&self) -> Size {
        let [rows, columns] = self.size_pixels();
        Size::new(columns as u32, rows as u32)
    }
}

impl DrawTarget for Canvas {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(Point { x, y }, colour) in pixels {
            if let (Ok(column), Ok(row)) = (usize::try_from(x), usize::try_from(y)) {
                self.set([row, column], [colour.r(), colour.g(), colour.b()]);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: Colour = [255; 3];

    #[test]
    fn text_stays_within_its_characters_and_is_cut_at_the_border() {
        for font in [Font::Small, Font::Medium, Font::Bold, Font::Large] {
            let [width, height] = font.size();
            let mut canvas = Canvas::blank(60, 100, [0; 3]);
            canvas.text([10, 20], "H\u{b1}", font, WHITE);
            let mut lit = 0;
            for row in 0..60 {
                for column in 0..100 {
                    let inside = (10..10 + height).contains(&row) && (20..20 + 2 * width).contains(&column);
                    let white = canvas.at([row, column]) == WHITE;
                    assert!(!white || inside, "{font:?} at {row}, {column}");
                    lit += usize::from(white);
                }
            }
            assert!(lit > 20, "{font:?}: {lit} pixels");
            canvas.text([55, 95], "beyond", font, WHITE);
        }
    }

    #[test]
    fn lines_are_broken_between_words() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(wrapped("one  two", 3), ["one", "two"]);
        assert_eq!(wrapped("abcdefgh", 5), ["abcde"]);
        assert_eq!(wrapped("", 5), Vec::<String>::new());
    }
}
