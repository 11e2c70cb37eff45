//! Prints the table of docs/safety.md: time from a cause to the enables off, measured on the pins of both boards.

use std::path::Path;
use std::process::ExitCode;
use virtual_nucleo::off_times::{MeasureError, Off, causes, measure};
use virtual_nucleo::time::Time;

const USAGE: &str = "off-times MOTION TRACKER [WORDS]

Runs both firmware images, switches their drives on, makes one cause after the other that has to switch them off, and
prints how long that took; with WORDS, only of causes with these words.";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let (Some(motion), Some(tracker)) = (arguments.next(), arguments.next()) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let words = arguments.next().unwrap_or_default();
    match print([Path::new(&motion), Path::new(&tracker)], &words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn print(images: [&Path; 2], words: &str) -> Result<(), MeasureError> {
    println!(
        "| cause | motion: enables off | converters at 0 V | tracker: enables off | converters at 0 V |"
    );
    println!("|---|---|---|---|---|");
    for cause in causes() {
        if !cause.to_string().contains(words) {
            continue;
        }
        let [motion, tracker] = measure(images, cause)?;
        println!("| {cause} | {} | {} |", cells(motion), cells(tracker));
    }
    Ok(())
}

fn cells(off: Option<Off>) -> String {
    let Some(off) = off else {
        return "no such task | —".to_owned();
    };
    let how = if off.floats { ", by reset" } else { "" };
    let converters = off.converters.map_or("before".to_owned(), text);
    format!("{}{how} | {converters}", text(off.enables))
}

/// Microseconds below a millisecond, three digits.
fn text(time: Time) -> String {
    let us = time.seconds() * 1e6;
    match us {
        0.0..10.0 => format!("{us:.2} µs"),
        10.0..1000.0 => format!("{us:.0} µs"),
        _ => format!("{:.1} ms", us / 1000.0),
    }
}
