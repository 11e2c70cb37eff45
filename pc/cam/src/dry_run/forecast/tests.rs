use super::part::part;
use super::*;
use crate::dry_run::{DryRun, run};
use nc::{Options, interpret};
use shared::trajectory::{Join, Shape};
use std::path::Path;

/// A program on the A/C head, dry run and forecast; the latter with the first `whole_s` \[s\] run in any case.
fn both(program: &str, whole_s: f64) -> (DryRun, Forecast) {
    let (machine, planner, paths) = planned(program);
    let ran = run(&machine, &planner, &paths, 1.0).unwrap();
    (ran, forecast_from(&machine, &planner, &paths, whole_s).unwrap())
}

fn planned(program: &str) -> (MachineFile, Planner, Vec<PlannedPath>) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../machines/ac-head.toml");
    let machine = MachineFile::read(&file).unwrap();
    let program = format!("G64 P0.02\nG0 X500 Y500 Z200\n{program}\nM2\n");
    let program = interpret(&program, Options::default()).unwrap();
    let planner = Planner::build(&machine).unwrap();
    let paths = planner.program(&program, &machine.homed_axes(), None).unwrap();
    (machine, planner, paths)
}

/// Corners, lines, arcs, short lines, another feed, a stop on the way and one at rest.
const MIXED: &str = "F1200\nG1 X600\nY560\nG3 X560 Y600 I-40 J0\nG1 X500\nF600\nX480 Y580\nG61.1\nX400\nG64 P0.02\n\
    Y500\nG4 P1\nG1 X480 Y505\nX480.3\nX480.6 Y505.02\nX480.9 Y505.06\nX560 Y525";

#[test]
fn short_programs_are_forecast_as_a_dry_run_does() {
    let (ran, forecast) = both(MIXED, WHOLE_S);
    assert_eq!(forecast.duration_s, ran.duration_s);
    let paths: Vec<f64> = ran.paths.iter().map(|path| path.duration_s).collect();
    assert_eq!(forecast.paths_s, paths);
    assert_eq!(forecast.slowed, ran.slowed);
    assert!(ran.slowed.count > 0);
}

#[test]
fn what_is_left_out_changes_neither_durations_nor_places() {
    let (ran, forecast) = both(MIXED, 0.0);
    for (path, time_s) in ran.paths.iter().zip(&forecast.paths_s) {
        assert!((path.duration_s - time_s).abs() < 0.02, "{time_s} s: {path:?}");
    }
    assert!((forecast.duration_s - ran.duration_s).abs() < 0.05);
    assert_eq!(forecast.slowed.count, ran.slowed.count);
    for (place, wanted) in forecast.slowed.slowest.iter().zip(&ran.slowed.slowest) {
        assert_eq!((place.path, place.lines), (wanted.path, wanted.lines));
        assert!((place.lowest_at_mm - wanted.lowest_at_mm).abs() < 0.2);
        assert!((place.kept() - wanted.kept()).abs() < 0.1, "{place:?} {wanted:?}");
    }
}

/// More than two days: the planner would take minutes for each of these.
#[test]
fn slow_lines_arcs_and_curves_take_their_time() {
    let program = "F0.05\nG1 X520\nG3 X540 Y520 I0 J20\nG1 Y540\nG5.2 P1 L3\nX545 Y550 P1\nX560 Y545 P1\nX570 Y560 P1\nG5.3";
    let (machine, planner, paths) = planned(program);
    let forecast = forecast(&machine, &planner, &paths).unwrap();
    let at_feed = paths[1].length_mm() / (0.05 / 60.0);
    let late = forecast.paths_s[1] - at_feed;
    assert!((0.0..1.0).contains(&late), "{late} s");
    assert_eq!(forecast.slowed, Slowed::default());
}

#[test]
fn parts_are_where_the_whole_is() {
    let program = "F100\nG1 X520\nG3 X540 Y520 Z205 I0 J20\nG1 Y540 A10\nG5.2 P1 L3\nX545 Y550 P1\nX560 Y545 P1\nX570 Y560 P1\nG5.3";
    let (.., paths) = planned(program);
    let mut curves = 0;
    for leg in paths[1].given_legs() {
        let whole = leg.unwrap().element;
        let curve = matches!(whole.shape, Shape::Curve(_));
        curves += u32::from(curve);
        let share = if curve { 0.06 } else { 0.6 };
        for from in [0.0, 0.3, 1.0 - share] {
            let (from, length) = (from * whole.length, share * whole.length);
            let part = part(&whole, from, from + length, Join::Stop);
            let part = part.unwrap_or_else(|| panic!("{whole:?} from {from} by {length}"));
            assert!((part.length - length).abs() < 1e-9);
            for place in [0.0, 0.4, 1.0] {
                let (here, there) = (part.at(place * length), whole.at(from + place * length));
                for (here, there) in here.value.iter().zip(there.value) {
                    // The planner takes 10⁻⁵ where elements meet.
                    assert!((here - there).abs() < 3e-6, "{here} {there}");
                }
            }
        }
        assert!(!curve || part(&whole, 0.0, 0.5 * whole.length, Join::Stop).is_none());
    }
    assert!(curves > 0);
}
