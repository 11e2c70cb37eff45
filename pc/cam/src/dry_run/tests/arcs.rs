//! Long arcs: every program of them runs to its end, in the time that it takes.

use super::*;
use std::f64::consts::PI;

/// A line, two half circles and three full ones, of this radius and first sense.
fn program(control: &str, feed: f64, radius: f64, first: u8, line: f64) -> String {
    let (x, across, second) = (301.0 + line, 301.0 + line + 2.0 * radius, 5 - first);
    format!(
        "{BEGIN}{control}\nG0 X300 Y700 Z300 A0 C0\nF{feed}\nG1 X{x}\nG{first} X{across} I{radius}\nG{first} I-{radius}\n\
         G{second} I-{radius}\nG{second} X{x} I-{radius}\nG{second} I{radius}\nM2\n"
    )
}

#[test]
fn half_and_full_circles_run_to_their_end() {
    let machine = machine("ac-head.toml");
    for control in ["G61", "G61.1", "G64"] {
        for feed in [1500.0, 3000.0, 9000.0] {
            for radius in [50.0, 100.0, 200.0] {
                for (first, line) in [(2, 0.0), (3, 0.0), (2, 900.0), (3, 900.0)] {
                    let ran = ran(&machine, &program(control, feed, radius, first, line), 1.0);
                    let length = 1.0 + line + 8.0 * PI * radius;
                    let feeds = ran.paths.iter().filter(|path| path.motion == Motion::Feed);
                    let [path] = &feeds.collect::<Vec<_>>()[..] else {
                        panic!("one path that feeds")
                    };
                    assert!((path.length_mm - length).abs() < 1e-6, "{} mm", path.length_mm);
                    let at_feed = length / feed * 60.0;
                    let more = path.duration_s / at_feed;
                    assert!(
                        (1.0..1.25).contains(&more),
                        "{control} F{feed} R{radius}: {more} of {at_feed} s"
                    );
                }
            }
        }
    }
}
