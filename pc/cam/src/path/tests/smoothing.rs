//! Runs of short lines as the board is given them, and as they are written.

use super::*;
use shared::trajectory::{Join, Shape};

const STIR: &str = "G43.4\nG0 X600 Y500 Z150 B-2.5 C0\nG0 Z50\nF6000\n";
/// Short lines.
const COUNT: usize = 400;

/// A wave of short lines after a `mode`, with `words` before the line of some number, and a corner at its end.
fn wave(mode: &str, words: &[(usize, &str)]) -> PlannedPath {
    let mut body = format!("{mode}\nG1");
    for i in 1..=COUNT {
        for (_, words) in words.iter().filter(|(number, _)| *number == i) {
            body += words;
            body.push('\n');
        }
        let x = 0.1 * i as f64;
        let _ = writeln!(body, "X{:.3} Y{:.3}", 600.0 + x, 500.0 + 3.0 * (x / 5.0).sin());
    }
    body += "X645\nY530\n";
    let paths = plan_on("stir-gantry", &format!("{STIR}{body}M2"));
    paths.unwrap().swap_remove(2)
}

fn given(path: &PlannedPath) -> Vec<Leg> {
    path.given_legs().map(Result::unwrap).collect()
}

fn legs(path: &PlannedPath) -> Vec<Leg> {
    path.legs().map(Result::unwrap).collect()
}

/// The tip at `s` \[mm\].
fn at(legs: &[Leg], s: f64) -> Vector3<f64> {
    let mut rest = s;
    for leg in legs {
        if rest <= leg.element.length {
            let value = leg.element.at(rest).value;
            return Vector3::new(value[0], value[1], value[2]);
        }
        rest -= leg.element.length;
    }
    panic!("{s} mm is beyond the end")
}

/// How far the tip is off at most, of what the board is given, from what is programmed at the same path length.
fn off(path: &PlannedPath) -> f64 {
    let (given, legs) = (given(path), legs(path));
    let length = path.length_mm() - path.start_s;
    let before = legs.iter().map(|leg| leg.element.length).sum::<f64>() - length;
    let off = |i: u32| {
        let s = length * f64::from(i) / 5000.0;
        (at(&given, s) - at(&legs, s + before)).norm()
    };
    (0..5000).map(off).fold(0.0, f64::max)
}

#[test]
fn g64_gives_the_board_smooth_curves_for_short_lines() {
    for (mode, most) in [("G64", 0.03), ("G64 P0.02", 0.012), ("G64 P0.1 Q0.004", 0.004)] {
        let path = wave(mode, &[]);
        let (given, legs) = (given(&path), legs(&path));
        assert_eq!(legs.len(), COUNT + 2, "{mode}");
        assert!(given.len() < COUNT / 4, "{mode}: {} elements", given.len());
        let lengths = [&given, &legs].map(|legs| legs.iter().map(|leg| leg.element.length).sum::<f64>());
        assert!((lengths[0] - lengths[1]).abs() < 1e-9);
        assert!(off(&path) <= most, "{mode}: {} mm off", off(&path));
        // The corner and what follows are as they are written.
        assert_eq!(given.last(), legs.last());
        let corner = &given[given.len() - 2].element;
        assert!(matches!(corner.shape, Shape::Line(_)) && corner.join != Join::Stop);
    }
}

#[test]
fn q0_and_exact_modes_leave_short_lines_as_they_are() {
    for mode in ["G64 Q0", "G64 P0.05 Q0", "G61", "G61.1"] {
        let path = wave(mode, &[]);
        assert_eq!(given(&path), legs(&path), "{mode}");
    }
    // In mid-path too: of the run only what comes before is smooth.
    let path = wave("G64", &[(201, "G61")]);
    let (given, legs) = (given(&path), legs(&path));
    assert!(given.len() < legs.len() - 100);
    assert_eq!(given[given.len() - 200..], legs[legs.len() - 200..]);
}

#[test]
fn outputs_and_feeds_stay_where_they_are_programmed() {
    let path = wave(
        "G64",
        &[(100, "M67 E0 Q500"), (231, "F1200"), (300, "M67 E0 Q700")],
    );
    let (given, legs) = (given(&path), legs(&path));
    assert!(given.len() < COUNT / 3, "{} elements", given.len());
    let events = |legs: &[Leg]| legs.iter().flat_map(|leg| leg.events.clone()).collect::<Vec<_>>();
    assert_eq!(events(&given), events(&legs));
    let mut s = 0.0;
    let change: f64 = legs[..230].iter().map(|leg| leg.element.length).sum();
    for leg in &given {
        for event in &leg.events {
            assert!((event.s_mm - s).abs() < 1e-9, "{event:?} is not where {s} is");
        }
        let feed = if s < change - 1e-9 { 100.0 } else { 20.0 };
        assert!(
            (0.9..1.0 + 1e-12).contains(&(leg.element.feed / feed)),
            "{} mm/s at {s}",
            leg.element.feed
        );
        s += leg.element.length;
    }
}

#[test]
fn a_start_in_the_middle_of_a_run_is_at_its_line() {
    let mut path = wave("G64", &[]);
    let start: f64 = legs(&path)[..150].iter().map(|leg| leg.element.length).sum();
    path.begin_at(start, Vec::new());
    let first = given(&path).swap_remove(0);
    assert_eq!(first.element.line, legs(&path)[150].element.line);
    assert_eq!(
        first.element.at(0.0).value,
        legs(&path)[150].element.at(0.0).value
    );
    assert!(off(&path) <= 0.03);
    let blocks: Vec<_> = path.given_blocks().map(Result::unwrap).collect();
    assert_eq!(blocks, legs(&path)[150..]);
}
