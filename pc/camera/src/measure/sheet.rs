//! Contact sheets: small pictures of what was refused, or is doubtful, by its reason.

use super::canvas::{Canvas, Colour};
use super::text::Font;
use crate::PngError;
use std::collections::BTreeMap;
use std::path::Path;

/// Pictures that are shown of a reason at most.
const MOST: usize = 12;
/// Pictures beside each other.
const COLUMNS: usize = 6;
/// A small picture is at most so wide \[pixels\].
const WIDTH: usize = 240;
/// Room around pictures and text \[pixels\].
const ROOM: usize = 8;

const PAPER: Colour = [30; 3];
const INK: Colour = [235; 3];
const FAINT: Colour = [170; 3];

/// Small pictures, by reason. Memory holds 12 of each at most, however many there are.
#[derive(Clone, Debug, Default)]
pub struct Sheet {
    reasons: BTreeMap<&'static str, Sampled>,
}

/// Pictures that are spread evenly over all that there are.
#[derive(Clone, Debug, Default)]
struct Sampled {
    seen: usize,
    /// Every so many-th is kept, less one.
    skipped: usize,
    kept: Vec<(String, Canvas)>,
}

impl Sheet {
    /// Takes a picture of `reason` and a name; `draw` gives what there is to be seen, if it is to be kept.
    ///
    /// # Errors
    /// Of `draw`.
    pub fn add<E>(
        &mut self,
        reason: &'static str,
        name: String,
        draw: impl FnOnce() -> Result<Canvas, E>,
    ) -> Result<(), E> {
        let sampled = self.reasons.entry(reason).or_default();
        let number = sampled.seen;
        sampled.seen += 1;
        if number.is_multiple_of(sampled.skipped + 1) {
            if sampled.kept.len() == MOST {
                sampled.thin();
                if !number.is_multiple_of(sampled.skipped + 1) {
                    return Ok(());
                }
            }
            let drawn = draw()?;
            let times = drawn.size_pixels()[1].div_ceil(WIDTH).max(1);
            sampled.kept.push((name, drawn.shrunk(times)));
        }
        Ok(())
    }

    /// Number of pictures that there are.
    pub fn len(&self) -> usize {
        self.reasons.values().map(|sampled| sampled.seen).sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.reasons.is_empty()
    }

    /// Number of pictures that are shown.
    pub fn shown(&self) -> usize {
        self.reasons.values().map(|sampled| sampled.kept.len()).sum()
    }

    /// Writes the sheet under a title.
    ///
    /// # Errors
    /// [`PngError`].
    pub fn write(&self, path: &Path, title: &str) -> Result<(), PngError> {
        self.drawn(title).write(path)
    }

    fn drawn(&self, title: &str) -> Canvas {
        let kept = || self.reasons.values().flat_map(|sampled| &sampled.kept);
        let size = |of: usize| {
            kept()
                .map(|(_, small)| small.size_pixels()[of])
                .max()
                .unwrap_or(0)
        };
        let [line, head] = [Font::Small, Font::Bold].map(|font| font.size()[1]);
        let (cell, below) = ([size(0), size(1)], line + ROOM);
        let row = cell[0] + below;
        let height: usize = self
            .reasons
            .values()
            .map(|sampled| head + ROOM + row * sampled.kept.len().div_ceil(COLUMNS) + ROOM)
            .sum();
        let mut sheet = Canvas::blank(
            2 * ROOM + Font::Large.size()[1] + height,
            ROOM + COLUMNS * (cell[1] + ROOM),
            PAPER,
        );
        sheet.text([ROOM, ROOM], title, Font::Large, INK);
        let mut top = 2 * ROOM + Font::Large.size()[1];
        // What there is most of comes first.
        let mut reasons: Vec<_> = self.reasons.iter().collect();
        reasons.sort_by_key(|(reason, sampled)| (std::cmp::Reverse(sampled.seen), **reason));
        for (reason, sampled) in reasons {
            let left_out = match sampled.seen - sampled.kept.len() {
                0 => String::new(),
                left_out => format!(", {left_out} left out"),
            };
            let count = format!("{} x {reason}{left_out}", sampled.seen);
            sheet.text([top, ROOM], &count, Font::Bold, INK);
            top += head + ROOM;
            for (number, (name, small)) in sampled.kept.iter().enumerate() {
                let left = ROOM + number % COLUMNS * (cell[1] + ROOM);
                let upper = top + number / COLUMNS * row;
                sheet.paste(small, [upper, left]);
                let name = shortened(name, cell[1] / Font::Small.size()[0]);
                sheet.text([upper + cell[0] + 1, left], &name, Font::Small, FAINT);
            }
            top += row * sampled.kept.len().div_ceil(COLUMNS) + ROOM;
        }
        sheet
    }
}

impl Sampled {
    /// Leaves every second one.
    fn thin(&mut self) {
        let mut number = 0;
        self.kept.retain(|_| {
            number += 1;
            number % 2 == 1
        });
        self.skipped = 2 * self.skipped + 1;
    }
}

/// The end of a name that is too long: what tells pictures apart is there.
fn shortened(name: &str, most: usize) -> String {
    let letters = name.chars().count();
    if letters <= most {
        return name.to_owned();
    }
    let end: String = name.chars().skip(letters + 2 - most.max(2)).collect();
    format!("..{end}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn small() -> Result<Canvas, Infallible> {
        Ok(Canvas::blank(30, 400, [200, 0, 0]))
    }

    #[test]
    fn of_many_pictures_of_a_reason_a_few_are_kept_that_are_spread_evenly() {
        let mut sheet = Sheet::default();
        let mut drawn = 0;
        for k in 0..5000 {
            let Ok(()) = sheet.add("dark", format!("{k}"), || {
                drawn += 1;
                small()
            });
        }
        let Ok(()) = sheet.add("rare", "one".into(), small);
        assert_eq!((sheet.len(), drawn < 100), (5001, true), "{drawn} drawn");
        let kept = &sheet.reasons["dark"].kept;
        assert!((MOST / 2..=MOST).contains(&kept.len()), "{}", kept.len());
        let numbers: Vec<usize> = kept.iter().map(|(name, _)| name.parse().unwrap()).collect();
        let step = numbers[1] - numbers[0];
        assert!(
            numbers.windows(2).all(|pair| pair[1] - pair[0] == step) && numbers[0] == 0,
            "{numbers:?}"
        );
        assert!(5000 - numbers[numbers.len() - 1] <= 2 * step, "{numbers:?}");
        assert_eq!(sheet.shown(), kept.len() + 1);
    }

    #[test]
    fn every_picture_lies_on_the_sheet_and_none_on_another() {
        let mut sheet = Sheet::default();
        for k in 0..8 {
            let Ok(()) = sheet.add("first", format!("capture-{k}.png"), small);
        }
        let Ok(()) = sheet.add("second", "x".into(), small);
        let drawn = sheet.drawn("Refused");
        let [rows, columns] = drawn.size_pixels();
        let red = |row, column| drawn.at([row, column]) == [200, 0, 0];
        let pixels = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        // Each is shrunk to 15 × 200.
        assert_eq!(
            pixels.filter(|(row, column)| red(*row, *column)).count(),
            9 * 15 * 200
        );
    }

    #[test]
    fn of_long_names_the_end_is_shown() {
        assert_eq!(shortened("capture-00000012.png", 20), "capture-00000012.png");
        assert_eq!(shortened("capture-00000012.png", 10), "..0012.png");
    }
}
