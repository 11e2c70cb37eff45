//! Drilling cycles of Siemens programs.

use super::wrong;
use crate::tests::run;
use crate::{Motion, Program};

/// Z of each motion behind the first two, with the feed where it has one.
fn zs(body: &str) -> Vec<(f64, Option<f64>)> {
    let program: Program =
        run(&format!("G0 Z20\nF100\n{body}\nM2")).unwrap_or_else(|error| panic!("{error}"));
    let mut found = Vec::new();
    for path in &program.paths[3..] {
        for target in &path.targets {
            let feed = target.feed.map(|feed| match feed {
                crate::FeedRate::PerMinute(feed) => feed,
                feed => panic!("{feed:?}"),
            });
            assert_eq!(feed.is_none(), path.motion == Motion::Rapid);
            found.extend(target.words.axes[2].map(|z| (z, feed)));
        }
    }
    found
}

#[test]
fn a_hole_is_where_the_tip_is() {
    let rapid = |z| (z, None);
    let feed = |z| (z, Some(100.0));
    assert_eq!(zs("CYCLE81(15,0,2,-10)"), [rapid(2.0), feed(-10.0), rapid(15.0)]);
    assert_eq!(
        zs("CYCLE82(15,1,2,,5,0.5)"),
        [rapid(3.0), feed(-4.0), rapid(15.0)]
    );
    assert_eq!(
        zs("CYCLE85(15,0,2,-10,,,60,200)"),
        [rapid(2.0), (-10.0, Some(60.0)), (2.0, Some(200.0)), rapid(15.0)]
    );
    assert_eq!(
        zs("CYCLE89(15,0,2,-10,,0)"),
        [rapid(2.0), feed(-10.0), feed(2.0), rapid(15.0)]
    );
    // Of nine arguments of CYCLE81 posts leave one out, and 10 is AMODE.
    assert_eq!(
        zs("CYCLE81(15,0,2,-10,,0,0,10)"),
        [rapid(2.0), feed(-10.0), rapid(15.0)]
    );
    assert!(wrong("F100\nCYCLE81(15,0,2,-10,,0,0,2)").contains("GMODE, DMODE"));
    assert!(wrong("F100\nCYCLE82(15,0,2,-10,,0,0,10)").contains("GMODE, DMODE"));
    // Chips are taken out: first 4 deep, then 3, then 2, and what is left in two.
    let pecks = zs("CYCLE83(15,0,2,-12,,,4,1,0,0,0.5,1)");
    let depths: Vec<f64> = pecks
        .iter()
        .filter(|(_, feed)| feed.is_some())
        .map(|(z, _)| *z)
        .collect();
    assert_eq!(depths, [-4.0, -7.0, -9.0, -10.0, -11.0, -12.0]);
    assert_eq!(pecks[1], (-4.0, Some(50.0)));
    assert_eq!(pecks[2..5], [rapid(2.0), rapid(-3.4), feed(-7.0)]);
    // Chips are broken.
    assert_eq!(
        zs("CYCLE83(15,0,2,-6,,-4)"),
        [rapid(2.0), feed(-4.0), feed(-3.0), feed(-6.0), rapid(15.0)]
    );
}

#[test]
fn mcall_drills_after_every_motion_until_it_ends() {
    let program =
        run("F100\nG0 Z20\nMCALL CYCLE81(15,0,2,-10)\nX10 Y10\nX20\n(no motion)\nF50\nMCALL\nX30\nM2")
            .unwrap();
    let down = program.paths.iter().filter(|path| path.motion == Motion::Feed);
    let down: Vec<_> = down.map(|path| path.targets[0].words.axes[2]).collect();
    assert_eq!(down, [Some(-10.0), Some(-10.0)]);
    let last = program.paths.last().unwrap();
    assert_eq!(
        (last.motion, last.targets[0].words.axes[0]),
        (Motion::Rapid, Some(30.0))
    );
}

#[test]
fn boring_that_stops_at_the_bottom_waits_with_the_spindle_off() {
    let cycle = "CYCLE87(15,0,2,-10,,3)";
    assert_eq!(
        zs(&format!("S9 M3\n{cycle}")),
        [(2.0, None), (-10.0, Some(100.0)), (15.0, None)]
    );
    assert_eq!(
        zs("S9 M3\nCYCLE88(15,1,2,,5,0.5,3)"),
        [(3.0, None), (-4.0, Some(100.0)), (15.0, None)]
    );
    // At each hole the spindle turns, stops at the bottom, and the operator continues.
    let text = format!("G0 Z20\nF100 S900\nMCALL {cycle}\nX10 Y10\nX20\nMCALL\nX30\nM2");
    let program = run(&text).unwrap();
    let mut seen = Vec::new();
    for path in &program.paths[3..] {
        seen.extend(path.waits_before.iter().map(|_| "waits".to_owned()));
        for event in &path.events {
            seen.push(match event.action {
                crate::ProgramAction::SpindleOn(shared::geometry::Turn::Clockwise) => "M3".to_owned(),
                crate::ProgramAction::SpindleOff => "M5".to_owned(),
                crate::ProgramAction::SpindleSpeed(speed) => format!("S{speed}"),
                other => format!("{other:?}"),
            });
        }
        seen.extend(
            path.targets
                .iter()
                .filter_map(|target| target.words.axes[2])
                .map(|z| format!("Z{z}")),
        );
    }
    let hole = ["S900", "M3", "Z2", "Z-10", "M5", "waits", "Z15"];
    assert_eq!(seen, [hole, hole].concat());
    for (cycle, text) in [
        ("CYCLE87(15,0,2,-10)", "SDIR is 3"),
        ("CYCLE87(15,0,2,-10,,4)", "SDIR is 3"),
        ("CYCLE88(15,0,2,-10,,3)", "SDIR is 3"),
        ("CYCLE88(15,0,2,-10,,0,4)", "SDIR is 3"),
        ("CYCLE87(15,0,2,-10,,3)", "CYCLE87 needs S before it"),
        ("CYCLE84(15,0,2,-10,,,3,,1)", "CYCLE84"),
        ("CYCLE840(15,0,2,-10,,,4,3,1)", "CYCLE840"),
    ] {
        let refusal = wrong(&format!("F9\n{cycle}"));
        assert!(refusal.contains(text), "{cycle}: {refusal}");
    }
}

#[test]
fn cycles_that_would_mean_something_else_are_refused() {
    for (body, text) in [
        ("CYCLE81(15,0,2)", "DP or DPR"),
        ("CYCLE81(15,0,2,5)", "from top to bottom"),
        ("CYCLE81(1,0,2,-5)", "from top to bottom"),
        ("CYCLE81(15,0,2,-5,9)", "different things"),
        ("CYCLE82(15,0,2,-5,,-2)", "revolutions are not counted"),
        ("CYCLE81(15,0,2,-5,,0,0,1,20)", "GMODE, DMODE, AMODE"),
        ("CYCLE83(15,0,2,-50,,,20,-0.1)", "do not come to the bottom"),
    ] {
        let text_of = wrong(&format!("F9\n{body}"));
        assert!(text_of.contains(text), "{body}: {text_of}");
    }
    assert!(wrong("CYCLE81(15,0,2,-5)").contains("CYCLE81 needs a feed"));
}
