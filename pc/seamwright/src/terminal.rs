//! The operator at a terminal: a bar on standard error, and lines on standard input.

use crate::console::errln;
use indicatif::{ProgressBar, ProgressStyle};
use job::{Line, Progress, Word};
use std::io::IsTerminal;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// What may be said.
const KEYS: &str = "Enter goes on, h holds, b goes back, s switches single block on or off, a number from 0 to 200 is \
                    the feed in %, Ctrl-C stops the job";

/// A bar on the terminal; one line for each part of the job if standard error is none.
#[derive(Debug)]
pub struct Terminal {
    bar: Option<ProgressBar>,
    /// What was told last.
    told: String,
    /// Lines that the operator enters.
    lines: Option<Receiver<String>>,
    single_block: bool,
    /// Lines are no words: whoever leads the job reads them, when the machine stands.
    led_by_lines: bool,
}

/// What a line means.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Said {
    Word(Word),
    SingleBlock,
}

impl Terminal {
    /// For an operator who looks on; shows a bar if standard error is a terminal.
    pub fn new() -> Self {
        Self {
            bar: std::io::stderr().is_terminal().then(ProgressBar::no_length),
            told: String::new(),
            lines: None,
            single_block: false,
            led_by_lines: false,
        }
    }

    /// For an operator who says words, a line each, if standard input is a terminal. With `single_block` the
    /// machine waits after every block, and words are read wherever they come from.
    pub fn with_words(single_block: bool) -> Self {
        let mut terminal = Self::new();
        terminal.single_block = single_block;
        if single_block || std::io::stdin().is_terminal() {
            terminal.lines = Some(read_lines());
            terminal.print(KEYS);
        }
        terminal
    }

    /// For an operator who leads a job by lines, if standard input is a terminal; with `always` they are read
    /// wherever they come from.
    pub fn with_lines(always: bool) -> Self {
        let mut terminal = Self::new();
        terminal.led_by_lines = true;
        if always || std::io::stdin().is_terminal() {
            terminal.lines = Some(read_lines());
        }
        terminal
    }

    fn print(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| errln!("{text}")),
            None => errln!("{text}"),
        }
    }
}

impl Default for Terminal {
    fn default() -> Self {
        Self::new()
    }
}

/// Lines of standard input as they come. The thread ends with the program, or with the input.
fn read_lines() -> Receiver<String> {
    let (sender, lines) = channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    lines
}

/// What `line` means, if anything.
fn meaning(line: &str) -> Option<Said> {
    Some(match line.trim() {
        "" => Said::Word(Word::GoOn),
        "h" => Said::Word(Word::Hold),
        "b" => Said::Word(Word::Back),
        "s" => Said::SingleBlock,
        number => {
            let percent: f64 = number.trim_end_matches('%').trim_end().parse().ok()?;
            let sensible = (0.0..=200.0).contains(&percent);
            sensible.then_some(Said::Word(Word::Override(percent / 100.0)))?
        }
    })
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the template is sound")
}

impl Progress for Terminal {
    fn phase(&mut self, text: &str) {
        if self.told == text {
            return;
        }
        text.clone_into(&mut self.told);
        match &self.bar {
            Some(bar) => {
                // How far it goes is not known before the path moves.
                bar.set_style(style("{msg:24} {spinner}"));
                bar.set_message(text.to_owned());
            }
            None => errln!("{text}"),
        }
    }

    fn travel(&mut self, done_mm: f64, length_mm: f64) {
        if let Some(bar) = &self.bar {
            bar.set_style(style("{msg:24} {wide_bar} {pos:>5} of {len} mm"));
            bar.set_length(length_mm.round() as u64);
            bar.set_position(done_mm.round() as u64);
        }
    }

    fn line(&mut self) -> Option<Line> {
        match self.lines.as_ref()?.try_recv() {
            Ok(line) => Some(Line::Said(line)),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Line::Over),
        }
    }

    fn say(&mut self, text: &str) {
        self.print(text);
    }

    fn word(&mut self) -> Option<Word> {
        if self.led_by_lines {
            return None;
        }
        let line = match self.lines.as_ref()?.try_recv() {
            Ok(line) => line,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => return Some(Word::Gone),
        };
        match meaning(&line) {
            Some(Said::Word(word)) => return Some(word),
            Some(Said::SingleBlock) => {
                self.single_block = !self.single_block;
                self.print(if self.single_block {
                    "single block: on, from the next block that has not gone to the board"
                } else {
                    "single block: off"
                });
            }
            None => self.print(KEYS),
        }
        None
    }

    fn single_block(&self) -> bool {
        self.single_block
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_words_or_nothing() {
        assert_eq!(meaning(""), Some(Said::Word(Word::GoOn)));
        assert_eq!(meaning(" h "), Some(Said::Word(Word::Hold)));
        assert_eq!(meaning("b"), Some(Said::Word(Word::Back)));
        assert_eq!(meaning("s"), Some(Said::SingleBlock));
        assert_eq!(meaning("50"), Some(Said::Word(Word::Override(0.5))));
        assert_eq!(meaning("200 %"), Some(Said::Word(Word::Override(2.0))));
        assert_eq!(meaning("0%"), Some(Said::Word(Word::Override(0.0))));
        for nothing in ["hold", "-1", "201", "NaN", "%", "1e9"] {
            assert_eq!(meaning(nothing), None, "{nothing}");
        }
    }
}
