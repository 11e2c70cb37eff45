//! Plots of a job over the path, and those of its part, as SVG.

use crate::draw::{AS_CURVES, Curve, Panel, figure};
use crate::log::is_rotary;
use crate::table::speed;
use crate::{Report, ReportError};
use evaluate::WorkTick;
use host_link::spool::Spool;
use parts::{ALONG, GAP, Line, Plot};
use shared::io::SIDES;
use shared::units::{DEG_PER_RAD, MM_S_PER_M_MIN};
use std::path::Path;

/// Deviation that the plots mark where none is judged \[µm\].
const GOAL_UM: f64 = 50.0;
/// A limit is drawn where it is not more than so many times the largest value; one that is further away would flatten the
/// curve, and is told.
const NEAR: f64 = 5.0;
/// Beyond a limit that is drawn is so much of it.
const BEYOND: f64 = 1.1;
/// Width of a figure.
pub(super) const WIDTH: u32 = 1000;
/// Height of a row of plots below each other.
const ROW: u32 = 220;

/// Draws `following-error.svg`, `speed.svg` and either `seam-deviation.svg` or, without a tracker,
/// `contour-error.svg` into `directory`.
pub(super) fn draw(directory: &Path, report: &Report, ticks: &Spool<WorkTick>) -> Result<(), ReportError> {
    let subject = format!("{} at {}", report.program, speed(report.speed_m_per_min));
    let following = following_panels(report, ticks);
    let rows = following.len() / 2;
    let accuracy = match report.seam {
        Some(_) => (
            "seam-deviation",
            "Spot beside seam",
            (0..SIDES)
                .map(|side| Some(deviation_panel(side, report, ticks)))
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
        let curve = |(name, points): &(&'static str, _)| Curve::new(name, Vec::clone(points));
        let panel = Panel {
            title: String::new(),
            x: plot.x,
            y: plot.y,
            curves: plot.lines.iter().map(curve).collect(),
            least: AS_CURVES,
            to_scale: plot.to_scale,
            ..Panel::default()
        };
        let panel = with_limits(panel, &plot.limits);
        let path = directory.join(format!("{}.svg", plot.file));
        let title = format!("{}, {}", plot.title, report.program);
        figure(&path, &title, (WIDTH, 420), (1, 1), &[Some(panel)])
            .map_err(|e| ReportError::new(&path, e))?;
    }
    Ok(())
}

/// A panel with `limits` of what it shows, and what they are in its title.
pub(super) fn with_limits(mut panel: Panel, limits: &[f64]) -> Panel {
    let values = panel.curves.iter().flat_map(|curve| &curve.points);
    let peak = values.map(|point| point.1.abs()).filter(|y| y.is_finite());
    let peak = peak.fold(0.0, f64::max);
    let (near, far): (Vec<f64>, Vec<f64>) = limits.iter().partition(|limit| limit.abs() <= NEAR * peak);
    for limit in &near {
        panel.least.0 = panel.least.0.min(limit * BEYOND);
        panel.least.1 = panel.least.1.max(limit * BEYOND);
    }
    let told = |limits: &[f64]| match limits {
        [low, high] if *low == -high => format!("±{high}"),
        all => all.iter().map(f64::to_string).collect::<Vec<_>>().join(" and "),
    };
    let unit = panel.y.split(['[', ']']).nth(1).unwrap_or(panel.y);
    let mut words = Vec::new();
    if !near.is_empty() {
        words.push(format!("dashed: limit, {} {unit}", told(&near)));
    }
    if !far.is_empty() {
        words.push(format!("limit {} {unit}: far outside the plot", told(&far)));
    }
    if !words.is_empty() {
        let before = if panel.title.is_empty() { "" } else { ", " };
        panel.title = format!("{}{before}{}", panel.title, words.join("; "));
    }
    panel.marks.extend(near);
    panel
}

/// Values of each tick over the path, open where there is none and between paths.
fn over_path<const N: usize>(
    ticks: &Spool<WorkTick>,
    values: impl Fn(&WorkTick) -> [Option<f64>; N],
) -> [Vec<(f64, f64)>; N] {
    let mut lines = [const { Line::new() }; N];
    let mut path_id = None;
    for tick in ticks {
        let begins = path_id.replace(tick.path_id).is_some_and(|id| id != tick.path_id);
        for (line, value) in lines.iter_mut().zip(values(&tick)) {
            if begins {
                line.push(GAP);
            }
            line.push(value.map_or(GAP, |value| (tick.along_mm, value)));
        }
    }
    lines.map(Line::into_points)
}

fn deviation_panel(side: usize, report: &Report, ticks: &Spool<WorkTick>) -> Panel {
    let slides = [2 * side, 2 * side + 1];
    let [u, v] = over_path(ticks, |tick| {
        let on = |slide: usize| tick.deviation_mm[slide].filter(|_| tick.beams[side]);
        slides.map(|slide| on(slide).map(|deviation| deviation * 1e3))
    });
    let judged = report
        .figures
        .iter()
        .find(|figure| figure.key.starts_with("deviation_"));
    let limit = judged
        .and_then(|figure| figure.limit)
        .map_or(GOAL_UM, |mm| 1e3 * mm);
    Panel {
        title: format!("Side {}, beam on (dashed: ±{limit:.0} µm)", side + 1),
        x: ALONG,
        y: "µm",
        curves: vec![
            Curve::new("U, across the beam", u),
            Curve::new("V, along the beam", v),
        ],
        least: (-1.2 * limit, 1.2 * limit),
        marks: vec![-limit, limit],
        ..Panel::default()
    }
}

/// Only with a beam on, if one ever was.
fn contour_panel(ticks: &Spool<WorkTick>) -> Panel {
    let beams = ticks.iter().any(|tick| tick.beams.contains(&true));
    let counts = |tick: &WorkTick| !beams || tick.beams.contains(&true);
    let [distance] = over_path(ticks, |tick| {
        [tick.contour_error_mm.filter(|_| counts(tick)).map(|mm| mm * 1e3)]
    });
    Panel {
        title: format!(
            "True tip from programmed path{}",
            if beams { ", beam on" } else { "" }
        ),
        x: ALONG,
        y: "µm",
        curves: vec![Curve::new("distance", distance)],
        least: (0.0, 1.0),
        ..Panel::default()
    }
}

/// Linear drives in the left column, rotary ones in the right, row by row; with the error at which the board trips at
/// standstill.
fn following_panels(report: &Report, ticks: &Spool<WorkTick>) -> Vec<Option<Panel>> {
    let errors = over_path(ticks, |tick| {
        tick.following_error.map(|error| Some(f64::from(error)))
    });
    let panel = |(motor, name, _): (usize, &'static str, f64)| {
        let (unit, scale, of_trip) = if is_rotary(motor) {
            ("arc seconds", DEG_PER_RAD * 3600.0, 3600.0)
        } else {
            ("µm", 1e3, 1e3)
        };
        let points = errors[motor].iter().map(|(along, error)| (*along, error * scale));
        let panel = Panel {
            title: name.to_owned(),
            x: ALONG,
            y: unit,
            curves: vec![Curve::new(name, points.collect())],
            least: (0.0, 1.0),
            ..Panel::default()
        };
        let trip = report.following_error_trip.0[motor].map(|trip| trip * of_trip);
        with_limits(panel, trip.as_slice())
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

/// True speed beside the feed; dashed is what it may fall to with a beam on.
fn speed_panel(report: &Report, ticks: &Spool<WorkTick>) -> Panel {
    let programmed = report.speed_m_per_min;
    // Slow processes are told in mm/min.
    let (unit, scale) = if programmed < 0.995 {
        ("mm/min", 1e3)
    } else {
        ("m/min", 1.0)
    };
    let told = |mm_s: f64| scale * mm_s / MM_S_PER_M_MIN;
    let judged = report
        .figures
        .iter()
        .find(|figure| figure.key == "speed_dip_percent");
    let limit = judged.and_then(|figure| figure.limit);
    let [speed, feed] = over_path(ticks, |tick| {
        [tick.true_speed_mm_s.map(told), Some(told(tick.feed_mm_s))]
    });
    Panel {
        title: match limit {
            Some(limit) => {
                format!("Speed of the tip (dashed: limit with a beam on, {limit} % below the feed)")
            }
            None => "Speed of the tip".to_owned(),
        },
        x: ALONG,
        y: unit,
        curves: vec![
            Curve::new("true speed", speed),
            Curve::new("programmed feed", feed),
        ],
        least: (0.0, 1.1 * scale * programmed),
        dashed: limit.map_or(Vec::new(), |limit| {
            lowest(ticks, |feed_mm_s| told(feed_mm_s) * (1.0 - limit / 100.0))
        }),
        ..Panel::default()
    }
}

/// What the speed may fall to with a beam on, for as long as path and feed are the same, by the feed.
fn lowest(ticks: &Spool<WorkTick>, of: impl Fn(f64) -> f64) -> Vec<Vec<(f64, f64)>> {
    let level = |tick: &WorkTick| (tick.path_id, tick.feed_mm_s, tick.beams.contains(&true));
    let mut line = Line::new();
    let mut add = |first: &WorkTick, last: &WorkTick| {
        if level(first).2 {
            let lowest = of(first.feed_mm_s);
            line.push((first.along_mm, lowest));
            line.push((last.along_mm, lowest));
            line.push(GAP);
        }
    };
    // Of a stretch at one level.
    let mut ends: Option<(WorkTick, WorkTick)> = None;
    for tick in ticks {
        match &mut ends {
            Some((first, last)) if level(first) == level(&tick) => *last = tick,
            _ => {
                if let Some((first, last)) = ends.replace((tick, tick)) {
                    add(&first, &last);
                }
            }
        }
    }
    if let Some((first, last)) = ends {
        add(&first, &last);
    }
    let points = line.into_points();
    let parts = points.split(|point| !point.0.is_finite());
    parts.filter(|part| !part.is_empty()).map(<[_]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::{report, without_tracker};
    use std::path::PathBuf;

    fn scratch(name: &str) -> PathBuf {
        let directory = std::env::temp_dir().join(format!("seamwright-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&directory).unwrap();
        directory
    }

    fn ticks() -> Spool<WorkTick> {
        (0..4000).map(crate::log::tests::tick).collect()
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
