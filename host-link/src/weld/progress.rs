//! What the operator sees while a job runs.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;

/// Where a job tells how far it is.
pub trait Progress {
    /// A new part of the job begins.
    fn phase(&mut self, text: &str);

    /// The machine is `done_mm` along a path of `length_mm`.
    fn travel(&mut self, done_mm: f64, length_mm: f64);
}

/// Tells nobody.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn phase(&mut self, _text: &str) {}

    fn travel(&mut self, _done_mm: f64, _length_mm: f64) {}
}

/// A bar on the terminal; one line for each part of the job if standard error is none.
#[derive(Debug)]
pub struct Terminal {
    bar: Option<ProgressBar>,
    /// What was told last.
    told: String,
}

impl Terminal {
    /// Looks whether standard error is a terminal.
    pub fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(ProgressBar::no_length);
        let told = String::new();
        Self { bar, told }
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).expect("the template is sound")
}

impl Default for Terminal {
    fn default() -> Self {
        Self::new()
    }
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
            None => eprintln!("{text}"),
        }
    }

    fn travel(&mut self, done_mm: f64, length_mm: f64) {
        if let Some(bar) = &self.bar {
            bar.set_style(style("{msg:24} {wide_bar} {pos:>5} of {len} mm"));
            bar.set_length(length_mm.round() as u64);
            bar.set_position(done_mm.round() as u64);
        }
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
