//! Plots of a job over the path, and those of its part, as SVG.

use super::draw::{AS_CURVES, Curve, Panel, figure};
use super::log::is_rotary;
use super::table::speed;
use super::{Report, ReportError};
use crate::evaluate::WorkTick;
use crate::part::Plot;
use shared::io::SIDES;
use shared::units::{DEG_PER_RAD, MM_S_PER_M_MIN};
use std::path::Path;

/// Deviation that the plots mark as the goal \[µm\].
const GOAL_UM: f64 = 50.0;
/// Label of the horizontal axis.
const ALONG: &str = "path from where the first beam goes on [mm]";
/// Width of a figure.
const WIDTH: u32 = 1000;
/// Height of a row of plots below each other.
const ROW: u32 = 220;

/// Draws `following-error.svg`, `speed.svg` and either `seam-deviation.svg` or, without a tracker,
/// `contour-error.svg` into `directory`.
pub(super) fn draw(directory: &Path, report: &Report, ticks: &[WorkTick]) -> Result<(), ReportError> {
    let subject = format!("{} at {}", report.program, speed(report.speed_m_per_min));
    let following = following_panels(report, ticks);
    let rows = following.len() / 2;
    let accuracy = match report.seam {
        Some(_) => (
            "seam-deviation",
            "Spot beside seam",
            (0..SIDES)
                .map(|side| Some(deviation_panel(side, ticks)))
                .collect(),
            (2, 1),
            760,
        ),
        None => (
            "contour-error",
            "Tip beside path",
            vec![Some(contour_panel(ticks))],
            (1, 1),
            420,
        ),
    };
    let figures = [
        accuracy,
        (
            "following-error",
            "Largest following error in each tick",
            following,
            (rows, 2),
            ROW * rows as u32,
        ),
        (
            "speed",
            "Path speed",
            vec![Some(speed_panel(report, ticks))],
            (1, 1),
            420,
        ),
    ];
    for (name, title, panels, grid, height) in figures {
        let path = directory.join(format!("{name}.svg"));
        figure(
            &path,
            &format!("{title}, {subject}"),
            (WIDTH, height),
            grid,
            &panels,
        )
        .map_err(|e| ReportError::new(&path, e))?;
    }
    Ok(())
}

/// Draws the plots of the part.
pub(super) fn draw_more(directory: &Path, report: &Report, plots: &[Plot]) -> Result<(), ReportError> {
    for plot in plots {
        let curve = |(name, points): &(&str, Vec<(f64, f64)>)| Curve {
            name: (*name).to_owned(),
            points: points
                .iter()
                .copied()
                .filter(|(x, y)| x.is_finite() && y.is_finite())
                .collect(),
        };
        let panel = Panel {
            title: String::new(),
            x: plot.x,
            y: plot.y,
            curves: plot.lines.iter().map(curve).collect(),
            least: AS_CURVES,
            ..Panel::default()
        };
        let path = directory.join(format!("{}.svg", plot.file));
        let title = format!("{}, {}", plot.title, report.program);
        figure(&path, &title, (WIDTH, 420), (1, 1), &[Some(panel)])
            .map_err(|e| ReportError::new(&path, e))?;
    }
    Ok(())
}

fn deviation_panel(side: usize, ticks: &[WorkTick]) -> Panel {
    let curve = |name: &str, slide: usize| Curve {
        name: name.to_owned(),
        points: ticks
            .iter()
            .filter(|t| t.beams[side])
            .filter_map(|t| Some((t.along_mm, t.deviation_mm[slide]? * 1e3)))
            .collect(),
    };
    Panel {
        title: format!("Side {}, beam on (dashed: ±{GOAL_UM:.0} µm)", side + 1),
        x: ALONG,
        y: "µm",
        curves: vec![
            curve("U, across the beam", 2 * side),
            curve("V, along the beam", 2 * side + 1),
        ],
        least: (-1.2 * GOAL_UM, 1.2 * GOAL_UM),
        marks: vec![-GOAL_UM, GOAL_UM],
        ..Panel::default()
    }
}

fn contour_panel(ticks: &[WorkTick]) -> Panel {
    let points = ticks
        .iter()
        .filter_map(|t| Some((t.along_mm, t.contour_error_mm? * 1e3)));
    Panel {
        title: "True tip from programmed path".to_owned(),
        x: ALONG,
        y: "µm",
        curves: vec![Curve {
            name: "distance".to_owned(),
            points: points.collect(),
        }],
        least: (0.0, 1.0),
        ..Panel::default()
    }
}

/// Linear drives in the left column, rotary ones in the right, row by row.
fn following_panels(report: &Report, ticks: &[WorkTick]) -> Vec<Option<Panel>> {
    let panel = |(motor, name, _): (usize, &'static str, f64)| {
        let (unit, scale) = if is_rotary(motor) {
            ("arc seconds", DEG_PER_RAD * 3600.0)
        } else {
            ("µm", 1e3)
        };
        Panel {
            title: name.to_owned(),
            x: ALONG,
            y: unit,
            curves: vec![Curve {
                name: name.to_owned(),
                points: ticks
                    .iter()
                    .map(|t| (t.along_mm, f64::from(t.following_error[motor]) * scale))
                    .collect(),
            }],
            least: (0.0, 1.0),
            ..Panel::default()
        }
    };
    let column = |rotary: bool| {
        let motors = report.max_following_error.fitted();
        motors.filter(move |(motor, _, _)| is_rotary(*motor) == rotary)
    };
    let (mut left, mut right) = (column(false), column(true));
    let rows = column(false).count().max(column(true).count());
    (0..rows)
        .flat_map(|_| [left.next().map(panel), right.next().map(panel)])
        .collect()
}

fn speed_panel(report: &Report, ticks: &[WorkTick]) -> Panel {
    let programmed = report.speed_m_per_min;
    // Slow processes are told in mm/min.
    let (unit, scale) = if programmed < 0.995 {
        ("mm/min", 1e3)
    } else {
        ("m/min", 1.0)
    };
    Panel {
        title: "Speed of the tip (dashed: programmed for the longest path)".to_owned(),
        x: ALONG,
        y: unit,
        curves: vec![Curve {
            name: "speed".to_owned(),
            points: ticks
                .iter()
                .map(|t| (t.along_mm, scale * t.speed_mm_s / MM_S_PER_M_MIN))
                .collect(),
        }],
        least: (0.0, 1.1 * scale * programmed),
        marks: vec![scale * programmed],
        ..Panel::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::tests::{report, without_tracker};
    use std::path::PathBuf;

    fn scratch(name: &str) -> PathBuf {
        let directory = std::env::temp_dir().join(format!("seamwright-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&directory).unwrap();
        directory
    }

    fn ticks() -> Vec<WorkTick> {
        (0..4000).map(super::super::log::tests::tick).collect()
    }

    #[track_caller]
    fn assert_has(directory: &Path, name: &str, words: &[&str]) {
        let svg = std::fs::read_to_string(directory.join(name)).unwrap();
        for word in words {
            assert!(svg.contains(word), "{word} is missing in {name}");
        }
    }

    #[test]
    fn plots_are_written_with_title_and_legend() {
        let directory = scratch("plots");
        draw(&directory, &report(), &ticks()).unwrap();
        let deviation = ["job.ngc at 5.00 m/min", "V, along the beam"];
        assert_has(&directory, "seam-deviation.svg", &deviation);
        assert_has(&directory, "following-error.svg", &["arc seconds", "X2"]);
        assert_has(&directory, "speed.svg", &["m/min", "path from where"]);
        std::fs::remove_dir_all(&directory).unwrap();
    }

    #[test]
    fn without_a_tracker_the_tip_beside_its_path_and_the_plots_of_the_part_are_drawn() {
        let directory = scratch("part-plots");
        draw(&directory, &without_tracker(), &ticks()).unwrap();
        assert_has(&directory, "contour-error.svg", &["Tip beside path", "µm"]);
        assert!(!directory.join("seam-deviation.svg").exists());
        let following = std::fs::read_to_string(directory.join("following-error.svg")).unwrap();
        assert!(following.contains("X1") && !following.contains("X2"));
        let plot = Plot {
            file: "height",
            title: "Height of the bead",
            x: "length [mm]",
            y: "height [mm]",
            lines: vec![("bead", vec![(0.0, 1.0), (1.0, f64::NAN), (2.0, 1.2)])],
            limits: vec![1.5],
            to_scale: false,
        };
        draw_more(&directory, &without_tracker(), &[plot]).unwrap();
        let words = ["Height of the bead, job.ngc", "length [mm]", "height [mm]"];
        assert_has(&directory, "height.svg", &words);
        std::fs::remove_dir_all(&directory).unwrap();
    }
}
