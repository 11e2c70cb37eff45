//! Plots of a job over the path, as SVG.

use super::log::is_rotary;
use super::{Report, ReportError};
use crate::evaluate::SeamTick;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use shared::io::{MOTOR_NAMES, SIDES};
use shared::units::{DEG_PER_RAD, MM_S_PER_M_MIN};
use std::path::Path;

/// Deviation that the plots mark as the goal \[µm\].
const GOAL_UM: f64 = 50.0;
/// Points of a curve; more are not seen.
const POINTS: usize = 1600;
const FONT: &str = "sans-serif";
/// Colours that can be told apart by everyone (Okabe and Ito).
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(60, 60, 60),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'b, SVGBackend<'a>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;
type DrawError<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

/// A named curve over the path.
struct Curve {
    name: String,
    points: Vec<(f64, f64)>,
}

/// One set of axes.
struct Panel {
    title: String,
    unit: &'static str,
    curves: Vec<Curve>,
    /// Smallest range of the vertical axis.
    least: (f64, f64),
    /// Values that are marked by a dashed line.
    marks: Vec<f64>,
}

/// Draws `seam-deviation.svg`, `following-error.svg` and `speed.svg` into `directory`.
pub(super) fn draw(directory: &Path, report: &Report, ticks: &[SeamTick]) -> Result<(), ReportError> {
    let deviation: Vec<Panel> = (0..SIDES).map(|side| deviation_panel(side, ticks)).collect();
    let subject = format!("{} at {:.2} m/min", report.program, report.speed_m_per_min);
    let speed = vec![speed_panel(report, ticks)];
    let figures = [
        ("seam-deviation", "Spot beside seam", deviation, (2, 1), 760),
        (
            "following-error",
            "Largest following error in each tick",
            following_panels(ticks),
            (4, 2),
            880,
        ),
        ("speed", "Path speed", speed, (1, 1), 420),
    ];
    for (name, title, panels, grid, height) in figures {
        let path = directory.join(format!("{name}.svg"));
        figure(&path, &format!("{title}, {subject}"), height, grid, &panels)
            .map_err(|e| ReportError::new(&path, e))?;
    }
    Ok(())
}

fn deviation_panel(side: usize, ticks: &[SeamTick]) -> Panel {
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
        unit: "µm",
        curves: vec![
            curve("U, across the beam", 2 * side),
            curve("V, along the beam", 2 * side + 1),
        ],
        least: (-1.2 * GOAL_UM, 1.2 * GOAL_UM),
        marks: vec![-GOAL_UM, GOAL_UM],
    }
}

/// Linear drives in the left column, rotary ones in the right.
fn following_panels(ticks: &[SeamTick]) -> Vec<Panel> {
    let panel = |motor: usize| {
        let (unit, scale) = if is_rotary(motor) {
            ("arc seconds", DEG_PER_RAD * 3600.0)
        } else {
            ("µm", 1e3)
        };
        Panel {
            title: MOTOR_NAMES[motor].to_owned(),
            unit,
            curves: vec![Curve {
                name: MOTOR_NAMES[motor].to_owned(),
                points: ticks
                    .iter()
                    .map(|t| (t.along_mm, f64::from(t.following_error[motor]) * scale))
                    .collect(),
            }],
            least: (0.0, 1.0),
            marks: vec![],
        }
    };
    [0, 4, 1, 5, 2, 6, 3].map(panel).into()
}

fn speed_panel(report: &Report, ticks: &[SeamTick]) -> Panel {
    Panel {
        title: "Speed of the tip (dashed: programmed)".to_owned(),
        unit: "m/min",
        curves: vec![Curve {
            name: "speed".to_owned(),
            points: ticks
                .iter()
                .map(|t| (t.along_mm, t.speed_mm_s / MM_S_PER_M_MIN))
                .collect(),
        }],
        least: (0.0, 1.1 * report.speed_m_per_min),
        marks: vec![report.speed_m_per_min],
    }
}

fn figure<'a>(
    path: &'a Path,
    title: &str,
    height: u32,
    grid: (usize, usize),
    panels: &[Panel],
) -> Result<(), DrawError<'a>> {
    let root = SVGBackend::new(path, (1000, height)).into_drawing_area();
    root.fill(&WHITE)?;
    let root = root.titled(title, (FONT, 20))?;
    for (area, panel) in root.split_evenly(grid).iter().zip(panels) {
        draw_panel(area, panel)?;
    }
    root.present()
}

fn draw_panel<'a>(area: &Area<'a>, panel: &Panel) -> Result<(), DrawError<'a>> {
    let wide = area.dim_in_pixel().0 > 600;
    let across = range(panel, |p| p.0, (f64::INFINITY, f64::NEG_INFINITY), 0.01);
    let up = range(panel, |p| p.1, panel.least, 0.05);
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, (FONT, 15))
        .margin(8)
        .margin_right(20)
        .x_label_area_size(38)
        .y_label_area_size(62)
        .build_cartesian_2d(across.0..across.1, up.0..up.1)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_desc("path from where the first beam goes on [mm]")
        .y_desc(panel.unit)
        .x_labels(if wide { 12 } else { 6 })
        .y_labels(if wide { 7 } else { 4 })
        .x_label_formatter(&|x| format!("{x:.0}"))
        .label_style((FONT, 13))
        .axis_desc_style((FONT, 13))
        .draw()?;
    for mark in &panel.marks {
        let line = [(across.0, *mark), (across.1, *mark)];
        chart.draw_series(DashedLineSeries::new(line, 6, 5, BLACK.mix(0.6).into()))?;
    }
    draw_curves(&mut chart, panel)
}

fn draw_curves<'a: 'b, 'b>(chart: &mut Chart<'a, 'b>, panel: &Panel) -> Result<(), DrawError<'a>> {
    for (curve, colour) in panel.curves.iter().zip(COLOURS) {
        chart
            .draw_series(LineSeries::new(thin(&curve.points), colour.stroke_width(1)))?
            .label(&curve.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(3)));
    }
    if panel.curves.len() > 1 {
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperRight)
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .label_font((FONT, 13))
            .draw()?;
    }
    Ok(())
}

/// Range of one coordinate of all curves, at least `least`, with a part of its width added on both sides
/// unless `least` bounds it.
fn range(panel: &Panel, pick: impl Fn(&(f64, f64)) -> f64, least: (f64, f64), margin: f64) -> (f64, f64) {
    let (mut low, mut high) = least;
    for value in panel.curves.iter().flat_map(|c| &c.points).map(pick) {
        low = low.min(value);
        high = high.max(value);
    }
    if low > high {
        return (0.0, 1.0);
    }
    let room = margin * (high - low).max(1e-6);
    let low = if low < least.0 { low - room } else { low };
    let high = if high > least.1 { high + room } else { high };
    (low, high)
}

/// At most [`POINTS`] points that still show every peak: of each group the lowest and the highest.
fn thin(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let group = (2 * points.len()).div_ceil(POINTS).max(2);
    if points.len() <= POINTS {
        return points.to_vec();
    }
    let mut thinned = Vec::with_capacity(POINTS);
    for group in points.chunks(group) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let low = group.iter().min_by(by_value).copied();
        let high = group.iter().max_by(by_value).copied();
        let mut pair: Vec<_> = low.into_iter().chain(high).collect();
        pair.sort_by(|a, b| a.0.total_cmp(&b.0));
        thinned.extend(pair);
    }
    thinned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_every_peak_in_order() {
        let mut points: Vec<(f64, f64)> = (0..10_000).map(|i| (f64::from(i), 0.0)).collect();
        points[4321].1 = 7.0;
        points[8765].1 = -3.0;
        let thinned = thin(&points);
        assert!(thinned.len() <= POINTS + 2, "{}", thinned.len());
        assert!(thinned.contains(&(4321.0, 7.0)) && thinned.contains(&(8765.0, -3.0)));
        assert!(thinned.is_sorted_by(|a, b| a.0 <= b.0));
    }

    #[test]
    fn a_range_covers_the_curves_and_at_least_what_is_asked() {
        let panel = |points| Panel {
            title: String::new(),
            unit: "",
            curves: vec![Curve {
                name: String::new(),
                points,
            }],
            least: (-1.0, 1.0),
            marks: vec![],
        };
        assert_eq!(
            range(&panel(vec![(0.0, 0.5)]), |p| p.1, (-1.0, 1.0), 0.05),
            (-1.0, 1.0)
        );
        let (low, high) = range(&panel(vec![(0.0, 3.0)]), |p| p.1, (-1.0, 1.0), 0.05);
        assert!(low == -1.0 && (high - 3.2).abs() < 1e-12, "{low} {high}");
    }

    #[test]
    fn plots_are_written_with_title_and_legend() {
        let directory = std::env::temp_dir().join(format!("seamwright-plots-{}", std::process::id()));
        std::fs::create_dir_all(&directory).unwrap();
        let ticks: Vec<SeamTick> = (0..4000).map(super::super::log::tests::tick).collect();
        draw(&directory, &crate::report::tests::report(), &ticks).unwrap();
        for (name, words) in [
            (
                "seam-deviation.svg",
                ["job.ngc at 5.00 m/min", "V, along the beam"],
            ),
            ("following-error.svg", ["arc seconds", "X2"]),
            ("speed.svg", ["m/min", "path from where"]),
        ] {
            let svg = std::fs::read_to_string(directory.join(name)).unwrap();
            for word in words {
                assert!(svg.contains(word), "{word} is missing in {name}");
            }
        }
        std::fs::remove_dir_all(&directory).unwrap();
    }
}
