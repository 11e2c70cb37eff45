//! `seamwright check --explain`: what each block of a program does.

use crate::console::{outln, shown};
use nc::Told;
use std::str::FromStr;

/// Most blocks that are printed; the others are counted.
const MOST_BLOCKS: usize = 1000;

/// Lines of a program, the first and the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lines(u32, u32);

impl Lines {
    /// Every line.
    pub const ALL: &str = "1-4294967295";
}

impl FromStr for Lines {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        match (first.trim().parse(), last.trim().parse()) {
            (Ok(first), Ok(last)) if 1 <= first && first <= last => Ok(Self(first, last)),
            _ => Err("must be a line or two, such as 120 or 100-140"),
        }
    }
}

/// Prints blocks as they are run.
pub struct Explanation {
    lines: Lines,
    printed: usize,
    more: usize,
}

impl Explanation {
    /// Of the blocks in these lines, of the program and of files of subroutines.
    pub fn of(lines: Lines) -> Self {
        Self {
            lines,
            printed: 0,
            more: 0,
        }
    }

    /// Prints a block, if it is one of those, and not too many were printed.
    pub fn tell(&mut self, told: &Told) {
        if !(self.lines.0..=self.lines.1).contains(&told.line) {
            return;
        }
        if self.printed == MOST_BLOCKS {
            self.more += 1;
            return;
        }
        self.printed += 1;
        let inside = "  ".repeat(told.depth);
        let file = told.file.as_ref().map(|file| format!("{file}, "));
        let text = shown(&told.text);
        outln!("{inside}{}line {}: {text}", file.unwrap_or_default(), told.line);
        for fact in &told.facts {
            outln!("{inside}    {}", shown(fact));
        }
    }

    /// Says how many more there were.
    pub fn end(&self) {
        if self.more > 0 {
            outln!(
                "and {} blocks more: say which lines with --explain=FROM-TO",
                self.more
            );
        }
        if self.printed == 0 {
            outln!("no block is run in these lines");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_one_or_from_one_to_another() {
        assert_eq!("120".parse(), Ok(Lines(120, 120)));
        assert_eq!("100-140".parse(), Ok(Lines(100, 140)));
        assert_eq!(Lines::ALL.parse(), Ok(Lines(1, u32::MAX)));
        for wrong in ["", "0", "140-100", "1-", "a", "-5"] {
            assert!(wrong.parse::<Lines>().is_err(), "{wrong}");
        }
    }
}
