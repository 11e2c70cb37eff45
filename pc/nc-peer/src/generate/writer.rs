//! Lines of a program in many spellings, and what is known where they are written.

use crate::random::Random;

/// Axis words of the tip.
pub const XYZ: [char; 3] = ['X', 'Y', 'Z'];

/// Kinds of loops.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Loop {
    While,
    Do,
    Repeat,
}

pub struct Writer {
    pub random: Random,
    pub lines: Vec<String>,
    /// Parameters that have a value here, as they are written.
    pub parameters: Vec<String>,
    /// Named subroutines that may be called, with the number of their arguments.
    pub subroutines: Vec<(String, usize)>,
    /// Numbered ones, for M98.
    pub numbered: Vec<usize>,
    /// The one kind of loop of a program with break and continue, none of a program without: the peer forgets to take
    /// its note of a break or continue back where a loop of another kind ends, and ends or repeats a later loop wrongly.
    pub jumps_in: Option<Loop>,
    label: usize,
    /// Number of the parameter that was set last.
    set: usize,
    /// Inches are in force.
    pub inches: bool,
}

impl Writer {
    pub fn new(mut random: Random) -> Self {
        let jumps_in = *random.of(&[None, None, Some(Loop::While), Some(Loop::Do)]);
        Self {
            jumps_in,
            random,
            lines: Vec::new(),
            parameters: Vec::new(),
            subroutines: Vec::new(),
            numbered: Vec::new(),
            label: 100,
            set: 0,
            inches: false,
        }
    }

    /// A number that no O word has had.
    pub fn label(&mut self) -> usize {
        self.label += 1;
        self.label
    }

    /// Adds a line as it is.
    pub fn line(&mut self, line: &str) {
        self.lines.push(line.to_owned());
    }

    /// Adds a block of words between spaces, spelt in one way or another.
    pub fn block(&mut self, words: &str) {
        let mut line = String::new();
        if self.random.percent(15) {
            line = format!("N{} ", self.lines.len() + 1);
        }
        let space = *self.random.of(&["", " ", " ", " ", "  ", "\t"]);
        line += &words.replace(' ', space);
        if self.random.percent(15) {
            line = line.to_lowercase();
        }
        match self.random.below(20) {
            0 => line += " (a remark)",
            1 => line += " ; a remark",
            2 => line.insert_str(0, "  "),
            _ => {}
        }
        self.lines.push(line);
    }

    /// A coordinate or length in the unit in force, of up to `size` mm.
    pub fn length(&mut self, size: f64) -> f64 {
        let size = if self.inches { size / 25.4 } else { size };
        self.random.within(-size, size)
    }

    /// `value` in digits, in one way or another.
    pub fn digits(&mut self, value: f64) -> String {
        let text = format!("{value:.6}");
        let short = text.trim_end_matches('0');
        match self.random.below(8) {
            0 => text,
            1 if value >= 0.0 => format!("+{text}"),
            2 => short.replacen("0.", ".", usize::from(value.abs() < 1.0)),
            3 => short.to_owned(),
            _ => short.trim_end_matches('.').to_owned(),
        }
    }

    /// `value` as a number, as an expression of two numbers, or as a parameter that is set in the line before.
    pub fn value(&mut self, value: f64) -> String {
        match self.random.below(12) {
            0 => {
                let part = self.random.within(-5.0, 5.0).round();
                let rest = self.digits(value - part);
                format!("[{part}+{rest}]")
            }
            1 => {
                let half = self.digits(value / 2.0);
                format!("[2*{half}]")
            }
            2 => {
                let digits = self.digits(value);
                // Another one each time: the block may have several.
                self.set = (self.set + 1) % 40;
                let number = self.set;
                let name = match self.random.below(4) {
                    0 => format!("#<one{number}>"),
                    1 => format!("#<_All {number}>"),
                    _ => format!("#{}", 2000 + number),
                };
                self.lines.push(format!("{name}={digits}"));
                name
            }
            _ => self.digits(value),
        }
    }
}
