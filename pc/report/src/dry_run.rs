//! Files of a dry run: its figures, and speed, acceleration and jerk over time as SVG.

use crate::ReportError;
use crate::draw::{AS_CURVES, Curve, Panel, figure};
use cam::dry_run::{DryRun, Envelope, PATH, QUANTITIES, ROWS, row_name, unit};
use std::path::Path;

/// Width and height of a panel of the path, and of an axis.
const PATH_PANEL: (u32, u32) = (1200, 260);
const AXIS_PANEL: (u32, u32) = (520, 190);
/// A limit is drawn where it is not more than so many times the largest value: further away it would flatten the
/// curve.
const NEAR: f64 = 3.0;
/// Beyond a limit that is drawn is so much of it.
const MARGIN: f64 = 1.1;
/// Shorter paths, in which next to nothing moves, have limits of their own that say nothing of the others \[mm\].
const SHORT: f64 = 0.1;

/// Writes `dry-run.json`, `dry-run-path.svg` and `dry-run-axes.svg` into `directory`, which is made if it is missing;
/// `title` says what was run where.
///
/// # Errors
/// The file that cannot be written, and why.
pub fn write_dry_run(directory: &Path, title: &str, run: &DryRun) -> Result<(), ReportError> {
    crate::prepare(directory)?;
    let path = directory.join("dry-run.json");
    let json = serde_json::to_string_pretty(run).map_err(|e| ReportError::new(&path, e))?;
    std::fs::write(&path, json + "\n").map_err(|e| ReportError::new(&path, e))?;

    let panels: Vec<_> = (0..3).map(|quantity| Some(path_panel(run, quantity))).collect();
    let path = directory.join("dry-run-path.svg");
    let size = (PATH_PANEL.0, 3 * PATH_PANEL.1);
    let along = format!("Along the path: {title}");
    figure(&path, &along, size, (3, 1), &panels).map_err(|e| ReportError::new(&path, e))?;

    let rows = (0..ROWS).filter(|row| *row != PATH && run.fitted[*row - 1]);
    let panels: Vec<_> = rows
        .flat_map(|row| (0..3).map(move |quantity| Some(axis_panel(run, row, quantity))))
        .collect();
    let path = directory.join("dry-run-axes.svg");
    let count = panels.len() / 3;
    let size = (3 * AXIS_PANEL.0, count as u32 * AXIS_PANEL.1);
    let axes = format!("Axes: {title}");
    figure(&path, &axes, size, (count, 3), &panels).map_err(|e| ReportError::new(&path, e))
}

/// One quantity along the path; dashed is what the path may have, thin lines are where paths begin.
fn path_panel(run: &DryRun, quantity: usize) -> Panel {
    let long = run.paths.iter().filter(|path| path.length_mm >= SHORT);
    let highest = long.map(|path| path.highest.path[quantity].highest);
    let highest = highest.fold(0.0, f64::max);
    let (unit, scale) = unit(PATH, quantity, highest);
    let limit = if quantity == 0 { "programmed" } else { "limit" };
    let dashed = limit_curves(&run.trace.path_limits[quantity], NEAR * highest, scale);
    let mirrored = dashed.iter().filter(|_| quantity > 0);
    let mirrored = mirrored.map(|curve| curve.iter().map(|(t, x)| (*t, -x)).collect());
    let mut curve = curve(&run.trace.rows[PATH][quantity], scale);
    let most = NEAR * highest / scale;
    for (_, value) in &mut curve.points {
        *value = value.clamp(-most, most);
    }
    Panel {
        title: format!(
            "{} (dashed: {limit}; numbers: paths)",
            capital(QUANTITIES[quantity])
        ),
        x: "time [s]",
        y: unit,
        curves: vec![curve],
        least: AS_CURVES,
        dashed: dashed.iter().cloned().chain(mirrored).collect(),
        places: path_starts(run).collect(),
        ..Panel::default()
    }
}

/// One quantity of an axis, with its limits if it comes near.
fn axis_panel(run: &DryRun, row: usize, quantity: usize) -> Panel {
    let peak = run.highest.rows()[row][quantity];
    let limit = run.axis_limits[row - 1][quantity];
    let (unit, scale) = unit(row, quantity, limit);
    let limit = limit / scale;
    let near = limit <= NEAR * peak.highest / scale;
    let reach = if near { MARGIN * limit } else { 0.0 };
    Panel {
        title: format!(
            "{} {}: {:.0} % of {} {unit}",
            row_name(row),
            QUANTITIES[quantity],
            100.0 * peak.share(),
            (1e3 * limit).round() / 1e3
        ),
        x: "time [s]",
        y: unit,
        curves: vec![curve(&run.trace.rows[row][quantity], scale)],
        least: (-reach, reach),
        marks: if near { vec![-limit, limit] } else { vec![] },
        places: path_starts(run).map(|(time, _)| (time, String::new())).collect(),
        ..Panel::default()
    }
}

fn path_starts(run: &DryRun) -> impl Iterator<Item = (f64, String)> {
    let starts = run.paths.iter().map(|path| path.start_s);
    starts
        .zip(1..)
        .map(|(start, number): (f64, usize)| (start, number.to_string()))
}

/// Both edges of an envelope.
fn curve(envelope: &Envelope, scale: f64) -> Curve {
    let edges = envelope
        .bins()
        .flat_map(|(time, bin)| [(time, bin.low), (time, bin.high)]);
    Curve {
        name: String::new(),
        points: edges.map(|(time, value)| (time, value / scale)).collect(),
    }
}

/// The parts of a limit that are up to `most`; there is none between paths.
fn limit_curves(envelope: &Envelope, most: f64, scale: f64) -> Vec<Vec<(f64, f64)>> {
    let bins: Vec<_> = envelope.bins().collect();
    let parts = bins.chunk_by(|a, b| a.1.high == b.1.high);
    let seen = parts.filter(|part| part[0].1.high > 0.0 && part[0].1.high <= most);
    let half = 0.5 * envelope.step_s();
    let line = |part: &[(f64, cam::dry_run::Bin)]| {
        let value = part[0].1.high / scale;
        vec![(part[0].0 - half, value), (part[part.len() - 1].0 + half, value)]
    };
    seen.map(line).collect()
}

fn capital(word: &str) -> String {
    let (first, rest) = word.split_at(1);
    first.to_uppercase() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use cam::dry_run;
    use cam::path::Planner;
    use config::machine::MachineFile;
    use nc::{Options, interpret};

    #[test]
    fn plots_name_axes_units_limits_and_paths_and_the_figures_can_be_read_back() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machines/stir-gantry.toml");
        let machine = MachineFile::read(&file).unwrap();
        let program = "G21 G90 G94\nG43.4\nG0 X100 Y100 Z200 B0 C0\nF3000\nG1 Y160\nM2\n";
        let program = interpret(program, Options::default()).unwrap();
        let planner = Planner::build(&machine).unwrap();
        let paths = planner.program(&program, &machine.homed_axes(), None).unwrap();
        let run = dry_run::run(&machine, &planner, &paths, 1.0).unwrap();
        let directory = std::env::temp_dir().join(format!("seamwright-dry-run-{}", std::process::id()));
        write_dry_run(&directory, "job.ngc on a machine", &run).unwrap();

        let read = |name: &str| std::fs::read_to_string(directory.join(name)).unwrap();
        let path = read("dry-run-path.svg");
        for words in [
            "job.ngc on a machine",
            "Jerk (dashed: limit",
            "mm/s³",
            "m/min",
            "time [s]",
        ] {
            assert!(path.contains(words), "{words}");
        }
        // One number for each path, the second one too.
        assert!(path.matches("\n 2\n").count() >= 3, "{path}");
        let axes = read("dry-run-axes.svg");
        for words in ["X speed: ", "% of 100 mm/s", "C jerk: ", "°/s³"] {
            assert!(axes.contains(words), "{words}");
        }
        assert!(!axes.contains("A speed"));
        let json: serde_json::Value = serde_json::from_str(&read("dry-run.json")).unwrap();
        assert_eq!(json["duration_s"], run.duration_s);
        assert_eq!(json["paths"][1]["motion"], "feed");
        assert_eq!(json["paths"][1]["lines"], serde_json::json!([5, 5]));
        std::fs::remove_dir_all(&directory).unwrap();
    }
}
