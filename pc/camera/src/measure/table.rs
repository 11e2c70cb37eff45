//! Measured pictures as a table.

use super::Record;
use super::record::Figure;

/// Width of a column with a figure and its deviation.
const FIGURE: usize = 18;

/// Writes a line or more for each picture.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    name: usize,
}

impl Table {
    /// A table whose longest name of a picture has `name` letters.
    pub fn new(name: usize) -> Self {
        Self { name: name.max(7) }
    }

    /// Head of the table.
    pub fn head(&self) -> String {
        let figures = [
            "across u [mm]",
            "height n [mm]",
            "width [mm]",
            "roll [°]",
            "angle [°]",
        ];
        let figures: String = figures.map(|name| format!("  {name:<FIGURE$}")).concat();
        format!(
            "{:<name$}  status       quality{figures}",
            "picture",
            name = self.name
        )
        .trim_end()
        .to_owned()
    }

    /// The lines printed for a picture, under the name `name`.
    pub fn lines(&self, name: &str, record: &Record) -> String {
        let mut text = format!("{name:<width$}  {:<11}", record.status, width = self.name);
        if let Some(measured) = &record.measured {
            let figures = [
                figure(measured.lateral_mm, 4),
                figure(measured.height_mm, 4),
                figure(measured.width_mm, 4),
                figure(measured.roll_deg, 2),
                figure(measured.angle_deg, 2),
            ];
            let figures = figures.map(|figure| format!("  {figure:<FIGURE$}")).concat();
            text.push_str(&format!("  {:<7.2}{figures}", measured.quality));
        }
        let mut lines = vec![text.trim_end().to_owned()];
        let mut add = |line: String| lines.push(format!("{:<1$}  {line}", "", self.name));
        if let Some(why) = &record.why {
            add(why.clone());
        }
        if let Some(measured) = record.measured.filter(|measured| measured.joint == "corner") {
            let [left, right] = measured.wall_deg.map(|wall| figure(wall, 2));
            add(format!("walls: {left}° left, {right}° right"));
        }
        if let Some(second) = record.measured.and_then(|measured| measured.second) {
            add(format!(
                "second: at {:+.4} mm, {:.4} mm wide, rank {:.2} of the first",
                second.lateral_mm, second.width_mm, second.rank
            ));
        }
        if let Some(observed) = record.observed {
            let mut line = observed.state.to_owned();
            if let Some(doubt) = observed.doubt {
                line.push_str(&format!("; {doubt}"));
            }
            if let Some([travel, lateral, height]) = observed.mean_mm {
                line.push_str(&format!(
                    "; mean: across {lateral:+.4} mm, height {height:+.4} mm, {travel:+.4} mm ahead"
                ));
            }
            add(line);
        }
        lines.join("\n")
    }
}

/// A figure with its standard deviation, or a dash where it was not measured.
fn figure(figure: Figure, decimals: usize) -> String {
    if figure.sigma.is_finite() {
        format!("{:+.decimals$} ±{:.decimals$}", figure.value, figure.sigma)
    } else {
        "-".to_owned()
    }
}
