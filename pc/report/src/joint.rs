//! What the cameras saw of the joint: `joint.csv` and `joint.svg`.

use crate::draw::{AS_CURVES, Curve, Panel, figure};
use crate::plots::{WIDTH, with_limits};
use crate::table::speed;
use crate::{Report, ReportError};
use evaluate::{JOINT_QUANTITIES, JointPoint, JointQuantity};
use host_link::spool::Spool;
use parts::{ALONG, Line};
use shared::io::SIDES;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Names of the files.
const TABLE: &str = "joint.csv";
const PLOT: &str = "joint.svg";
/// Height of the figure.
const HEIGHT: u32 = 760;
/// A line is open over more than this without a value: what lies between is not known \[mm\].
const OPEN_MM: f64 = 5.0;

/// Writes both into `directory` if anything was seen. Files of an earlier job with pictures are no longer there otherwise.
pub(super) fn write(
    directory: &Path,
    report: &Report,
    points: &Spool<JointPoint>,
) -> Result<(), ReportError> {
    let [table, plot] = [TABLE, PLOT].map(|name| directory.join(name));
    if points.is_empty() {
        for old in [table, plot] {
            match std::fs::remove_file(&old) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    return Err(ReportError::new(&old, error));
                }
                _ => {}
            }
        }
        return Ok(());
    }
    write_table(&table, points).map_err(|e| ReportError::new(&table, e))?;
    let title = format!(
        "Joint, as the cameras saw it, {} at {}",
        report.program,
        speed(report.speed_m_per_min)
    );
    let panels = panels(report, points).map(Some);
    figure(&plot, &title, (WIDTH, HEIGHT), (2, 1), &panels).map_err(|e| ReportError::new(&plot, e))
}

fn write_table(path: &Path, points: &Spool<JointPoint>) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    writeln!(file, "along_mm,side,quantity,value_mm,sigma_mm")?;
    for point in points {
        let quantity = match point.quantity {
            JointQuantity::GapWidth => "gap_width",
            JointQuantity::Step => "step",
        };
        let (side, along, value) = (point.side + 1, point.along_mm, point.value_mm);
        writeln!(
            file,
            "{along:.3},{side},{quantity},{value:.5},{:.5}",
            point.sigma_mm
        )?;
    }
    file.flush()
}

/// Gap and step of both sides, with their limits.
fn panels(report: &Report, points: &Spool<JointPoint>) -> [Panel; JOINT_QUANTITIES] {
    let [gap, step] = lines(points);
    let panel = |title: &str, lines: [Vec<(f64, f64)>; SIDES], least| Panel {
        title: title.to_owned(),
        x: ALONG,
        y: "µm",
        curves: ["side 1", "side 2"]
            .into_iter()
            .zip(lines)
            .map(|(name, points)| Curve::new(name, points))
            .collect(),
        least,
        ..Panel::default()
    };
    let limits = |prefix: &str| -> Vec<f64> {
        let figures = report
            .figures
            .iter()
            .filter(|figure| figure.key.starts_with(prefix));
        let mut limits: Vec<f64> = figures
            .flat_map(|figure| figure.least.into_iter().chain(figure.limit))
            .map(|mm| 1e3 * mm)
            .collect();
        limits.sort_by(f64::total_cmp);
        limits.dedup();
        limits
    };
    let hi_lo = limits("hi_lo_");
    let both: Vec<f64> = hi_lo.iter().flat_map(|limit| [-limit, *limit]).collect();
    [
        with_limits(panel("Width of the gap", gap, (0.0, 1.0)), &limits("gap_width_")),
        with_limits(panel("Step (hi-lo), +u higher", step, AS_CURVES), &both),
    ]
}

/// Of each quantity and side; open where a stretch begins, and where nothing was seen for long \[µm\].
fn lines(points: &Spool<JointPoint>) -> [[Vec<(f64, f64)>; SIDES]; JOINT_QUANTITIES] {
    let mut lines = [const { [const { Line::new() }; SIDES] }; JOINT_QUANTITIES];
    let mut last = [[f64::NEG_INFINITY; SIDES]; JOINT_QUANTITIES];
    for point in points {
        let (quantity, side) = (point.quantity as usize, usize::from(point.side));
        let (line, last) = (&mut lines[quantity][side], &mut last[quantity][side]);
        if point.begins || point.along_mm - *last > OPEN_MM {
            line.gap();
        }
        *last = point.along_mm;
        line.push((point.along_mm, 1e3 * point.value_mm));
    }
    lines.map(|of_sides| of_sides.map(Line::into_points))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::JointOfSide;
    use crate::tests::report;
    use evaluate::JointFigures;
    use parts::Figure;

    /// A side of which everything is known.
    pub(crate) fn seen() -> JointOfSide {
        let figures = |max_mm, min_mm, mean_mm| {
            Some(JointFigures {
                places: 500,
                max_mm,
                max_at_mm: 120.0,
                min_mm,
                min_at_mm: 210.0,
                mean_mm,
                sigma_mm: 0.002,
                longest_unseen_mm: 1.5,
                longest_unseen_at_mm: 30.0,
            })
        };
        JointOfSide {
            gap_width: figures(0.16, 0.08, 0.12),
            step: figures(0.005, -0.006, 0.001),
        }
    }

    fn point(quantity: JointQuantity, along_mm: f64, value_mm: f64) -> JointPoint {
        JointPoint {
            side: 1,
            quantity,
            along_mm,
            value_mm,
            sigma_mm: 0.002,
            begins: false,
        }
    }

    #[test]
    fn table_and_plot_have_values_and_limits_and_are_gone_where_nothing_was_seen() {
        let folder = tempfile::tempdir().unwrap();
        let points: Spool<JointPoint> = (0..40)
            .flat_map(|k| {
                let along = 0.5 * f64::from(k);
                let gap = point(JointQuantity::GapWidth, along, 0.1 + 1e-3 * f64::from(k));
                [gap, point(JointQuantity::Step, along - 1.0, -0.02)]
            })
            .collect();
        let mut report = report();
        let gap = Figure::new("gap_width_max_2_mm", "", 0.14, "mm");
        let narrow = Figure::new("gap_width_min_2_mm", "", 0.1, "mm");
        let hi_lo = Figure::new("hi_lo_2_mm", "", 0.02, "mm");
        report.figures = vec![gap.limited(0.2), narrow.at_least(0.05), hi_lo.limited(0.03)];
        write(folder.path(), &report, &points).unwrap();
        let table = std::fs::read_to_string(folder.path().join(TABLE)).unwrap();
        let mut rows = table.lines();
        assert_eq!(rows.next(), Some("along_mm,side,quantity,value_mm,sigma_mm"));
        assert_eq!(rows.next(), Some("0.000,2,gap_width,0.10000,0.00200"));
        assert_eq!(rows.next(), Some("-1.000,2,step,-0.02000,0.00200"));
        let plot = std::fs::read_to_string(folder.path().join(PLOT)).unwrap();
        for word in [
            "job.ngc at 5.00 m/min",
            "Width of the gap, dashed: limit, 50 and 200 µm",
            "Step (hi-lo), +u higher, dashed: limit, ±30 µm",
            "side 2",
        ] {
            assert!(plot.contains(word), "{word} is missing");
        }
        write(folder.path(), &report, &Spool::default()).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_line_is_open_where_nothing_was_seen_and_where_a_stretch_begins() {
        let mut points = [0.0, 1.0, 2.0, 9.0, 10.0].map(|along| point(JointQuantity::Step, along, 0.01));
        points[1].begins = true;
        let [gap, step] = lines(&points.into_iter().collect());
        assert_eq!(gap, [vec![], vec![]]);
        let open: Vec<bool> = step[1].iter().map(|point| point.0.is_nan()).collect();
        assert_eq!(open, [false, true, false, false, true, false, false]);
    }
}
