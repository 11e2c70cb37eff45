//! A picture of what the lines of docs/wiring.md do from reset to the first enable (SVG).

use crate::board::Board;
use crate::chip::recorder::{Change, Level};
use crate::outside::{Output, Role};
use crate::pair::{NAMES, Pair};
use crate::session::{LINK_LIMIT, Session, SessionError};
use crate::time::Time;
use std::fmt::Write as _;

const LABELS: f64 = 110.0;
const PANEL: f64 = 280.0;
const GAP: f64 = 20.0;
const ROW: f64 = 17.0;
/// From a line's low level to its high one.
const SWING: f64 = 10.0;
/// Room for the words above the lines, and below them for the times.
const HEAD: f64 = 24.0;
const FOOT: f64 = 24.0;
/// What is shown before the first drive is enabled and after the last.
const AROUND: Time = Time::us(800);

/// A line, and all that it did.
struct Row {
    output: Output,
    changes: Vec<Change>,
}

/// What both boards did.
pub struct FirstEnable {
    rows: [Vec<Row>; 2],
    /// When both boards were on the net.
    pub on_net: Time,
    /// When the first drive went on, and the last.
    enabled: (Time, Time),
}

/// A span of time that is drawn.
struct Panel {
    words: String,
    from: Time,
    to: Time,
    /// Time that the figures count from, between two of them, and their unit.
    zero: Time,
    step: Time,
    unit: (&'static str, Time),
}

impl FirstEnable {
    /// Lets both boards, which are at power-up, come to the net and enable their drives.
    pub fn record(pair: &mut Pair) -> Result<Self, SessionError> {
        pair.boards.iter_mut().for_each(Board::record_pins);
        if !pair.run_to_link(LINK_LIMIT) {
            return Err(SessionError::Link);
        }
        let on_net = pair.now();
        Session::open(pair)?.enable(pair)?;
        let end = pair.now() + AROUND;
        pair.run(end);
        let mut of_board = pair.boards.iter_mut().map(|board| {
            let changes = board.chip_mut().shared.recorder.take();
            let outputs = board.chip().shared.outside.outputs();
            let row = |output: &Output| Row {
                output: output.clone(),
                changes: changes
                    .iter()
                    .filter(|change| change.pin == output.pin)
                    .copied()
                    .collect(),
            };
            outputs.iter().map(row).collect::<Vec<_>>()
        });
        let rows = [(); 2].map(|()| of_board.next().unwrap_or_default());
        let enables = rows
            .iter()
            .flatten()
            .filter(|row| row.output.role == Role::Enable);
        let on: Vec<Time> = enables.filter_map(|row| first(row, Level::High)).collect();
        let enabled = on.iter().min().copied().zip(on.iter().max().copied());
        Ok(Self {
            rows,
            on_net,
            enabled: enabled.ok_or(SessionError::Drives)?,
        })
    }

    /// When each line was driven first, and when it went high first.
    pub fn times(&self) -> Vec<(&'static str, &Output, Option<Time>, Option<Time>)> {
        let rows = NAMES
            .iter()
            .zip(&self.rows)
            .flat_map(|(name, rows)| rows.iter().map(move |row| (*name, row)));
        rows.map(|(name, row)| {
            let driven = row.changes.iter().find(|change| change.level != Level::Floating);
            (
                name,
                &row.output,
                driven.map(|change| change.at),
                first(row, Level::High),
            )
        })
        .collect()
    }

    /// The picture.
    pub fn svg(&self) -> String {
        let panels = self.panels();
        let rows: usize = self.rows.iter().map(Vec::len).sum();
        let width = LABELS + panels.len() as f64 * (PANEL + GAP);
        let height = HEAD + FOOT + ROW * (rows + self.rows.len()) as f64;
        let mut svg = format!(
            "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\" \
             font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
        );
        for (index, panel) in panels.iter().enumerate() {
            let left = LABELS + index as f64 * (PANEL + GAP);
            panel.draw_times(&mut svg, left, height);
        }
        let mut y = HEAD;
        for (name, rows) in NAMES.iter().zip(&self.rows) {
            y += ROW;
            let _ = writeln!(
                svg,
                "<text x=\"4\" y=\"{}\" font-weight=\"bold\">{name} board</text>",
                y - 4.0
            );
            for row in rows {
                y += ROW;
                let _ = writeln!(
                    svg,
                    "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
                    LABELS - 6.0,
                    y - 4.0,
                    row.output.name
                );
                for (index, panel) in panels.iter().enumerate() {
                    let left = LABELS + index as f64 * (PANEL + GAP);
                    panel.draw_row(&mut svg, row, left, y - 3.0);
                }
            }
        }
        svg + "</svg>\n"
    }

    fn panels(&self) -> [Panel; 3] {
        let (first, last) = self.enabled;
        let ms = ("ms", Time::ms(1));
        [
            Panel {
                words: "after reset".to_owned(),
                from: Time::default(),
                to: Time::us(4),
                zero: Time::default(),
                step: Time::us(1),
                unit: ("µs", Time::us(1)),
            },
            Panel {
                words: "set up, and the first beats".to_owned(),
                from: Time::ms(8),
                to: Time::ms(16),
                zero: Time::default(),
                step: Time::ms(2),
                unit: ms,
            },
            Panel {
                words: format!("first enable, {:.3} s after reset", first.seconds()),
                from: first - AROUND,
                to: last + AROUND,
                zero: first,
                step: Time::ms(1),
                unit: ms,
            },
        ]
    }
}

fn first(row: &Row, level: Level) -> Option<Time> {
    row.changes
        .iter()
        .find(|change| change.level == level)
        .map(|change| change.at)
}

fn colour(role: Role) -> &'static str {
    match role {
        Role::Enable => "#c62828",
        Role::Gate => "#7b1fa2",
        Role::Trigger => "#00796b",
        Role::Heartbeat => "#2e7d32",
        Role::Process => "#b26a00",
        Role::Converter => "#1565c0",
    }
}

impl Panel {
    fn x(&self, left: f64, at: Time) -> f64 {
        let part = (at.seconds() - self.from.seconds()) / (self.to.seconds() - self.from.seconds());
        left + PANEL * part.clamp(0.0, 1.0)
    }

    fn draw_times(&self, svg: &mut String, left: f64, height: f64) {
        let bottom = height - FOOT + 4.0;
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"15\" text-anchor=\"middle\">{}</text>",
            left + PANEL / 2.0,
            self.words
        );
        let steps = |time: Time| time.seconds() / self.step.seconds();
        let from = (steps(self.from) - steps(self.zero)).ceil() as i64;
        let to = (steps(self.to) - steps(self.zero)).floor() as i64;
        for step in from..=to {
            let seconds = step as f64 * self.step.seconds();
            let part = (self.zero.seconds() + seconds - self.from.seconds())
                / (self.to.seconds() - self.from.seconds());
            let x = left + PANEL * part;
            let (unit, one) = self.unit;
            let figure = (seconds / one.seconds()).round();
            // Those at an edge stay on their own side.
            let anchor = match part {
                ..0.02 => "start",
                0.98.. => "end",
                _ => "middle",
            };
            let _ = writeln!(
                svg,
                "<path d=\"M{x:.1} {HEAD}V{bottom}\" stroke=\"#ddd\"/><text x=\"{x:.1}\" y=\"{}\" text-anchor=\"{anchor}\" fill=\"#444\">{figure} {unit}</text>",
                height - 6.0
            );
        }
    }

    /// A line with its low level at `low`.
    fn draw_row(&self, svg: &mut String, row: &Row, left: f64, low: f64) {
        let before = row.changes.iter().take_while(|change| change.at <= self.from);
        let mut level = before.last().map_or(Level::Floating, |change| change.level);
        let inside = row
            .changes
            .iter()
            .filter(|change| self.from < change.at && change.at < self.to);
        let (mut line, mut floats) = (String::new(), String::new());
        let mut at = left;
        let mut draws = false;
        let ends = inside.map(|change| (self.x(left, change.at), Some(change.level)));
        for (x, next) in ends.chain([(left + PANEL, None)]) {
            match level {
                Level::Low | Level::High => {
                    let y = if level == Level::High { low - SWING } else { low };
                    let word = if draws {
                        format!("V{y}")
                    } else {
                        format!("M{at:.2} {y}")
                    };
                    let _ = write!(line, "{word}H{x:.2}");
                    draws = true;
                }
                Level::Floating | Level::Peripheral => {
                    let _ = write!(floats, "M{at:.2} {low}V{}H{x:.2}V{low}Z", low - SWING);
                    draws = false;
                }
            }
            at = x;
            level = next.unwrap_or(level);
        }
        if !floats.is_empty() {
            let _ = writeln!(svg, "<path d=\"{floats}\" fill=\"#bbb\"/>");
        }
        if !line.is_empty() {
            let colour = colour(row.output.role);
            let _ = writeln!(
                svg,
                "<path d=\"{line}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.4\"/>"
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chip::pins::pin;

    #[test]
    fn a_line_is_grey_while_it_floats_and_then_steps_with_its_level() {
        let pin = pin('F', 3);
        let change = |us, level| Change {
            at: Time::us(us),
            pin,
            level,
        };
        let row = Row {
            output: Output {
                pin,
                name: "enable X1".to_owned(),
                role: Role::Enable,
            },
            changes: vec![change(1, Level::Low), change(3, Level::High)],
        };
        let panel = Panel {
            words: String::new(),
            from: Time::default(),
            to: Time::us(4),
            zero: Time::default(),
            step: Time::us(1),
            unit: ("µs", Time::us(1)),
        };
        let mut svg = String::new();
        panel.draw_row(&mut svg, &row, 0.0, 20.0);
        assert_eq!(
            svg,
            "<path d=\"M0.00 20V10H70.00V20Z\" fill=\"#bbb\"/>\n\
             <path d=\"M70.00 20H210.00V10H280.00\" fill=\"none\" stroke=\"#c62828\" stroke-width=\"1.4\"/>\n"
        );
    }
}
