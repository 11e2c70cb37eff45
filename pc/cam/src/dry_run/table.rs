//! The prediction as text.

use super::figures::name;
use super::{DryRun, PATH, PathFigures, Peak, QUANTITIES, ROWS, Slowed};
use nc::Motion;
use shared::io::AXIS_NAMES;
use shared::units::MM_S_PER_M_MIN;
use std::fmt::{Display, Formatter, Result};

/// The last row that is not rotary.
const ROTARY: usize = 3;
/// Most limits that are printed for a path.
const RULERS: usize = 3;
/// They rule for this part of its time at least.
const TOLD: f64 = 0.005;

/// What a row is called.
pub fn row_name(row: usize) -> &'static str {
    match row {
        PATH => "path",
        axis => AXIS_NAMES[axis - 1],
    }
}

/// Speeds below this are printed in mm/min \[mm/s\].
const SLOW: f64 = 0.995 * MM_S_PER_M_MIN;

/// Unit of a quantity of a row, and how many of the inner ones (mm or degrees, s) it is; `largest` is the largest value.
pub fn unit(row: usize, quantity: usize, largest: f64) -> (&'static str, f64) {
    match (row, quantity) {
        (PATH, 0) if largest < SLOW => ("mm/min", MM_S_PER_M_MIN / 1e3),
        (PATH, 0) => ("m/min", MM_S_PER_M_MIN),
        (row, quantity) if row > ROTARY => (["°/s", "°/s²", "°/s³"][quantity], 1.0),
        (_, quantity) => (["mm/s", "mm/s²", "mm/s³"][quantity], 1.0),
    }
}

/// A value with its unit.
fn value(row: usize, quantity: usize, value: f64) -> String {
    let (unit, scale) = unit(row, quantity, value);
    format!("{} {unit}", short(value / scale))
}

impl Display for DryRun {
    fn fmt(&self, f: &mut Formatter) -> Result {
        writeln!(f, " path  lines          motion    length       time  ruled by")?;
        for (index, path) in self.paths.iter().enumerate() {
            write_path(f, index + 1, path)?;
        }
        writeln!(f, "\n Highest      speed              acceleration        jerk")?;
        let rows = (0..ROWS).filter(|row| *row == PATH || self.fitted[*row - 1]);
        for row in rows {
            write!(f, "  {:<5}", row_name(row))?;
            for (quantity, peak) in self.highest.rows()[row].iter().enumerate() {
                let highest = value(row, quantity, peak.highest);
                write!(f, " {highest:>14} {:>4.0} %", 100.0 * peak.share())?;
            }
            writeln!(f)?;
        }
        writeln!(
            f,
            "  (% of the limit at most; by differences of the positions each millisecond)"
        )?;
        write!(f, "{}", self.slowed)?;
        for (row, quantity, peak) in self.highest.above() {
            writeln!(
                f,
                "  ABOVE ITS LIMIT: {}, at {:.3} s",
                describe(row, quantity, &peak),
                peak.time_s
            )?;
        }
        if let Some(stop) = self.longest_stop {
            writeln!(
                f,
                "  longest stop    {:.2} s{}, at {:.2} s",
                stop.duration_s,
                after(stop.after_line),
                stop.start_s
            )?;
        }
        writeln!(
            f,
            "  on the paths    {:.2} s, {:.1} mm in {} paths",
            self.motion_s,
            self.length_mm,
            self.paths.len()
        )?;
        writeln!(
            f,
            "  the job         {:.2} s, from the end of homing to the park position",
            self.duration_s
        )
    }
}

impl Display for Slowed {
    /// A line a place.
    fn fmt(&self, f: &mut Formatter) -> Result {
        for place in &self.slowest {
            let lines = match place.lines {
                (first, last) if first == last => format!("line {first}"),
                (first, last) => format!("lines {first}–{last}"),
            };
            let speed = |mm_s: f64| value(PATH, 0, mm_s);
            write!(
                f,
                "  slows down in {lines}, {:.2}–{:.2} mm of path {}: from {} to {} at {:.2} mm",
                place.from_mm,
                place.to_mm,
                place.path,
                speed(place.feed_mm_s),
                speed(place.lowest_mm_s),
                place.lowest_at_mm
            )?;
            if place.lines.0 != place.lines.1 {
                write!(f, " (line {})", place.line)?;
            }
            writeln!(f, ", by the {}", place.limit)?;
        }
        let more = self.count - self.slowest.len() as u64;
        if more > 0 {
            writeln!(
                f,
                "  slows down in {more} more places, but less there; on {:.1} mm in all",
                self.length_mm
            )?;
        }
        Ok(())
    }
}

fn write_path(f: &mut Formatter, number: usize, path: &PathFigures) -> Result {
    if path.dwell_s > 0.0 {
        writeln!(f, "       rests for {:.2} s", path.dwell_s)?;
    }
    if let Some(corner) = path.corner_deg {
        writeln!(f, "       stops for a corner of {corner:.1}°")?;
    }
    let lines = match path.lines {
        _ if path.parking => "parking".to_owned(),
        (first, last) if first == last => first.to_string(),
        (first, last) => format!("{first}–{last}"),
    };
    write!(
        f,
        "{number:5}  {lines:<14} {:<6} {:9.1} mm {:8.3} s",
        name(path.motion),
        path.length_mm,
        path.duration_s
    )?;
    let told = path.ruled.iter().filter(|ruled| ruled.part >= TOLD);
    for (i, ruled) in told.take(RULERS).enumerate() {
        let comma = if i == 0 { "  " } else { ", " };
        let limit = match (ruled.row, ruled.quantity, path.motion) {
            (PATH, 0, Motion::Feed) => "feed".to_owned(),
            (PATH, 0, _) => "its speed".to_owned(),
            (row, quantity, _) => limit_name(row, quantity),
        };
        write!(f, "{comma}{limit} {:.0} %", 100.0 * ruled.part)?;
        let peak = path.highest.rows()[ruled.row][ruled.quantity];
        if (ruled.row, ruled.quantity) != (PATH, 0) && path.lines.0 != path.lines.1 {
            write!(f, " (line {})", peak.line)?;
        }
    }
    writeln!(f)
}

/// What a limit is called.
fn limit_name(row: usize, quantity: usize) -> String {
    match (row, quantity) {
        (PATH, quantity) => format!("{} of the path", QUANTITIES[quantity]),
        (row, quantity) => format!("{} of {}", QUANTITIES[quantity], row_name(row)),
    }
}

/// "acceleration of Y 1980 mm/s², 104 %, line 12".
fn describe(row: usize, quantity: usize, peak: &Peak) -> String {
    let line = match peak.line {
        0 => String::new(),
        line => format!(", line {line}"),
    };
    format!(
        "{} {}, {:.0} %{line}",
        limit_name(row, quantity),
        value(row, quantity, peak.value),
        100.0 * peak.share()
    )
}

fn after(line: u32) -> String {
    match line {
        0 => String::new(),
        line => format!(" after line {line}"),
    }
}

/// A number with three digits at least.
fn short(value: f64) -> String {
    match value {
        v if v < 10.0 => format!("{v:.2}"),
        v if v < 100.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}
