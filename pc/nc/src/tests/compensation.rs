//! Cutter compensation: where the tip goes beside a contour, and what is refused.

use super::*;
use std::collections::BTreeMap;

/// Tools 1, 2 and 3 of 10, 4 and -4 mm, in the machine after `T1 M6`.
fn read(body: &str) -> Result<Program, NcError> {
    let tool = |diameter_mm| Tool {
        length_mm: 0.0,
        diameter_mm,
    };
    let setup = Setup {
        tools: BTreeMap::from([(1, tool(10.0)), (2, tool(4.0)), (3, tool(-4.0))]),
        ..Setup::default()
    };
    let options = Options {
        setup: setup.into(),
        ..Options::default()
    };
    interpret(&format!("{HEADER}T1 M6\nF600\n{body}\nM2"), options)
}

/// The motions behind the header: `G0`, `G1`, or the sense of an arc, and X Y Z at their ends, rounded.
fn motions(body: &str) -> Vec<(&'static str, [f64; 3])> {
    let paths = read(body).unwrap().paths;
    let mut at = [0.0; 3];
    let mut motions = Vec::new();
    for target in paths[2..].iter().flat_map(|path| &path.targets) {
        for (own, said) in at.iter_mut().zip(target.words.axes) {
            *own = said.map_or(*own, |said| (said * 1e4).round() / 1e4 + 0.0);
        }
        let name = match (&target.way, target.feed) {
            (Way::Arc(way), _) if way.turn == Turn::Clockwise => "G2",
            (Way::Arc(_), _) => "G3",
            (_, None) => "G0",
            _ => "G1",
        };
        motions.push((name, at));
    }
    motions
}

/// X and Y of them.
fn places(body: &str) -> Vec<[f64; 2]> {
    motions(body).into_iter().map(|(_, [x, y, _])| [x, y]).collect()
}

fn wrong(body: &str) -> String {
    read(body).unwrap_err().to_string()
}

#[test]
fn the_tip_goes_beside_a_square_from_outside_around_its_corners() {
    let body = "G41 D1 G1 X20\nX40\nY-30\nG40 X60";
    let expected = [
        ("G1", [20.0, 5.0, 0.0]),
        ("G1", [40.0, 5.0, 0.0]),
        ("G2", [45.0, 0.0, 0.0]),
        ("G1", [45.0, -30.0, 0.0]),
        ("G1", [60.0, -30.0, 0.0]),
    ];
    assert_eq!(motions(body), expected);
    // A rapid cuts the corner.
    let rapid = motions(&body.replace("\nY-30", "\nG0 Y-30").replace("G40", "G40 G1"));
    assert_eq!(rapid[2], ("G0", [45.0, 0.0, 0.0]));
}

#[test]
fn the_ways_meet_in_inside_corners_which_are_seen_past_other_lines() {
    let inside = [[20.0, 5.0], [35.0, 5.0], [35.0, 30.0], [0.0, 50.0]];
    assert_eq!(places("G41 G1 X20\nX40\nY30\nG40 X0 Y50"), inside);
    let other = "(a remark)\nG4 P1\nS100 M3\n#1=3\nF100";
    assert_eq!(
        places(&format!("G41 G1 X20\nX40\n{other}\nY30\nG40 X0 Y50")),
        inside
    );
    // Up and down over the corner.
    let over = motions("G41 G1 X20\nX40\nG0 Z5\nG1 Z0\nY30\nG40 X0 Y50");
    assert_eq!(
        over[1..4],
        [
            ("G1", [35.0, 5.0, 0.0]),
            ("G0", [35.0, 5.0, 5.0]),
            ("G1", [35.0, 5.0, 0.0])
        ]
    );
    // In a subroutine, and in a loop.
    let called = "o1 sub\nX40\no1 endsub\nG41 G1 X20\no1 call\nY30\nG40 X0 Y50";
    assert_eq!(places(called), inside);
    let stairs = "G41 G1 X20\nG91\no1 repeat [2]\nX20\nY20\no1 endrepeat\nG90\nG40 X0 Y99";
    let expected = [
        [20.0, 5.0],
        [35.0, 5.0],
        [35.0, 20.0],
        [40.0, 25.0],
        [55.0, 25.0],
        [55.0, 40.0],
        [0.0, 99.0],
    ];
    assert_eq!(places(stairs), expected);
}

#[test]
fn arcs_are_offset_and_meet_lines_and_each_other() {
    // Outside of an arc to the right of it, tangent to both lines.
    let body = "G42 G1 X20\nG3 X20 Y40 J20\nG1 X0\nG40 Y80";
    assert_eq!(
        places(body),
        [[20.0, -5.0], [20.0, 45.0], [0.0, 45.0], [0.0, 80.0]]
    );
    let path = &read(body).unwrap().paths[2];
    let Way::Arc(way) = &path.targets[1].way else {
        panic!("{path:?}");
    };
    assert_eq!(way.form, ArcForm::Centre([0.0, 25.0, 0.0]));
    // Into an arc from a line across it, inside: circle of 15 about X40 Y0, and line Y5.
    let into = places("G41 G1 X10\nX60\nG3 X40 Y20 I-20\nG40 G1 X0 Y60");
    let x = 40.0 + (15.0_f64 * 15.0 - 25.0).sqrt();
    assert_eq!(into[1], [(x * 1e4).round() / 1e4, 5.0]);
    assert_eq!(into[2], [40.0, 15.0]);
    // Two arcs bulging towards the tool: circles of 15 about X20 and X40.
    let notch = places("G41 G1 X10 Y0\nG2 X30 Y0 I10\nX50 Y0 I10\nG40 G1 X80 Y0");
    let y = (15.0_f64 * 15.0 - 100.0).sqrt();
    assert_eq!(notch[1], [30.0, (y * 1e4).round() / 1e4], "{notch:?}");
    // A helix keeps its height.
    let helix = motions("G42 G1 X20\nG3 X20 Y40 J20 Z8\nG1 X0\nG40 Y80");
    assert_eq!(helix[1], ("G3", [20.0, 45.0, 8.0]));
}

#[test]
fn an_arc_may_lead_to_a_contour() {
    // It ends 5 mm to the left of X20 Y20, upwards, tangent there.
    let entry = read("G41 G3 X20 Y20 J20\nG1 Y40\nG40 X0 Y60").unwrap();
    let target = &entry.paths[2].targets[0];
    assert_eq!(target.words.axes[..2], [Some(15.0), Some(20.0)]);
    let Way::Arc(way) = &target.way else {
        panic!("{target:?}");
    };
    // As far from the start as from the end: x = 15 - r, y = 20, x² + y² = r².
    let r = (15.0 * 15.0 + 400.0) / 30.0;
    let ArcForm::Centre([x, y, _]) = way.form else {
        panic!("{way:?}");
    };
    assert!(
        (x - (15.0 - r)).abs() < 1e-9 && (y - 20.0).abs() < 1e-9,
        "{x} {y}"
    );
}

#[test]
fn the_radius_is_that_of_a_tool_or_of_the_block() {
    let beside = |switch: &str| places(&format!("{switch} G1 X20\nX40\nG40 X60"))[1][1];
    for (switch, y) in [
        ("G41", 5.0),
        ("G41 D0", 5.0),
        ("G42", -5.0),
        ("G41 D2", 2.0),
        ("G41 D3", -2.0),
        ("G42 D3", 2.0),
        ("G41.1 D6", 3.0),
        ("G42.1 D6", -3.0),
        ("G20 G41.1 D0.1 G21", 0.05),
        ("G10 L1 P2 R7\nG41 D2", 7.0),
        ("T2 M6\nG41", 2.0),
        ("T=\"MILL\" M6\nG41.1 D3", 1.5),
    ] {
        let switch = switch.replace("D0.1 G21", "D0.1\nG21");
        let y = if switch.starts_with("G20") {
            1.27 * y / 0.05
        } else {
            y
        };
        assert_eq!(beside(&switch), y, "{switch}");
    }
    assert!(wrong("G41 D9 G1 X20").contains("there is no tool 9"));
    assert!(wrong("G41 D1.5 G1 X20").contains("tools have whole numbers"));
    assert!(wrong("G41.1 G1 X20").contains("G41.1 needs D, the diameter of the tool"));
    // Without a table, or a diameter, the contour is the way of the tip, which is told.
    let program = run("F600\nG41 D1 G1 X20\nX40\nY30\nG28\nG40 G1 X0\nM2").unwrap();
    let told = "G41 changes nothing: the machine file has no diameter of the tool";
    assert_eq!(
        program
            .notices
            .iter()
            .filter(|notice| notice.text == told)
            .count(),
        1
    );
    assert_eq!(program.paths[2].targets[1].words.axes[..2], [Some(40.0), None]);
}

#[test]
fn places_are_those_of_the_contour() {
    // What one axis says leaves the other one on the contour, and steps lead along it.
    let body = "G41 G1 X20\nX40\nY-30\nX60\nG40 X80";
    let steps = "G41 G1 X20\nG91\nX20\nY-30\nX20\nG40 X20";
    assert_eq!(places(body), places(steps));
    // After G40 the first motion comes back in both axes, if they are named or not, and nothing else does before.
    let back = motions("G41 G1 X20\nX40\nG40\nG0 Z5\nX70");
    assert_eq!(back[2..], [("G0", [40.0, 0.0, 5.0]), ("G0", [70.0, 0.0, 5.0])]);
    assert_eq!(
        motions("G41 G1 X20\nX40\nG40 G1 X40").last(),
        Some(&("G1", [40.0, 0.0, 0.0]))
    );
    for body in ["G53 G0 Z9", "G28", "G81 Z-5 R1"] {
        let error = wrong(&format!("G41 G1 X20\nX40\nG40\n{body}"));
        assert!(
            error.contains("after G40 a straight motion leads away"),
            "{error}"
        );
    }
    assert!(wrong("G41 G1 X20\nX40\nG40\nG2 X50 R9").contains("first motion after it is straight"));
    assert!(wrong("G41 G1 X20\nX40\nG1 X#5420").contains("#5420"));
    // In another plane, where the first axis is Z: Z to X, the tip to the left is at +X.
    let zx = motions("G18\nG41 G1 Z20\nZ40\nG40 Z60");
    assert_eq!(zx[1].1, [5.0, 0.0, 40.0]);
    let yz = motions("G19\nG42 G1 Y20\nY40\nG40 Y60");
    assert_eq!(yz[1].1, [0.0, 40.0, -5.0]);
}

#[test]
fn what_is_turned_or_mirrored_has_the_tool_on_its_own_side() {
    let turned = places("G10 L2 P1 R90\nG41 G1 X20 Y0\nX40 Y0\nX40 Y-30\nG40 X60 Y-30");
    assert_eq!(
        turned,
        [
            [-5.0, 20.0],
            [-5.0, 40.0],
            [0.0, 45.0],
            [30.0, 45.0],
            [30.0, 60.0]
        ]
    );
    let mirrored = places("G51.1 X0\nG41 G1 X20 Y0\nX40 Y0\nX40 Y-30\nG40 X60 Y-30");
    assert_eq!(
        mirrored,
        [
            [-20.0, 5.0],
            [-40.0, 5.0],
            [-45.0, 0.0],
            [-45.0, -30.0],
            [-60.0, -30.0]
        ]
    );
}

#[test]
fn a_tool_that_does_not_fit_is_told_at_its_motion() {
    for (body, line, why) in [
        ("G41 G1 X4", 7, "must be longer than that"),
        ("G41 G1 X20\nG3 X20 Y8 J4", 8, "does not fit into this arc"),
        (
            "G41 G1 X20\nG3 X20 Y20 I1 J8",
            8,
            "radii at start and end of this arc differ",
        ),
        (
            "G41 G1 X20\nX40\nY6\nX0\nG40 X-50",
            9,
            "between the corners at its ends",
        ),
        (
            "G41 G1 X20\nX60\nG2 X70 Y10 J20\nG40 G1 Y90",
            9,
            "radii at start and end",
        ),
    ] {
        let error = wrong(body);
        assert!(error.contains(why), "{body}: {error}");
        assert!(error.contains("with a radius of 5 mm"), "{body}: {error}");
        assert!(error.starts_with(&format!("line {line},")), "{body}: {error}");
    }
}

#[test]
fn what_does_not_go_together_with_it_is_refused() {
    for body in [
        "G41",
        "G42.1 D3",
        "G18",
        "G55",
        "G43 H1",
        "G49",
        "G10 L2 P2 X1",
        "G52 X1",
        "G92 X0",
        "G28",
        "G53 G0 Z9",
        "T2 M6",
        "M0",
        "M60",
        "M66 P0 L3 Q1",
        "G81 Z-5 R1",
        "G5.1 X60 I4 J4",
        "G93 F5\nG1 X50",
        "G51.1 X0",
    ] {
        let error = wrong(&format!("G41 D1 G1 X20\nX40\n{body}"));
        assert!(
            error.contains("not possible while cutter compensation is on, since line 7: write G40 before"),
            "{body}: {error}"
        );
    }
    // These change nothing of the contour.
    for body in ["G17", "G54", "M1", "M8", "G64 P0.1", "M62 P3", "G20", "G94", "T2"] {
        assert!(
            read(&format!("G41 D1 G1 X20\nX40\n{body}\nG1 X60 F600\nG40 X99")).is_ok(),
            "{body}"
        );
    }
}

#[test]
fn forms_of_corners_of_siemens_are_known() {
    let body = |word: &str| format!("{word}\nG41 G1 X20\nX40\nY-30\nG40 X60");
    assert_eq!(places(&body("G450 NORM CUT2D")), places(&body("")));
    assert_eq!(places(&body("G451 KONT\nG450 NORM")), places(&body("")));
    assert!(wrong(&body("G451")).contains("G451: corners are gone around by arcs here: write G450"));
    assert!(wrong(&body("KONT")).contains("KONT: the tool goes straight to the contour here: write NORM"));
    assert!(wrong("G41 G1 X20\nX40 RND=2\nY30").contains("are not put into a compensated contour"));
    // D is the edge of a tool that has a name, which has no diameter here.
    assert!(run("T=\"MILL\" M6\nF100\nG41 D1 G1 X20\nM2").is_ok());
    assert!(wrong("T=\"MILL\" M6\nG41 D1 G1 X20").contains("there is no tool 1000001"));
}

#[test]
fn a_long_path_is_read_again_as_it_was() {
    use super::super::reading::read as keep;
    use super::super::source::Source;
    let body = "o1 repeat [40]\nG91 G1 X20\nY-7\nG3 X5 Y-5 I5\nG1 X9 Y20\no1 endrepeat";
    let text = format!("{HEADER}F600 G64\nG41.1 D3 G1 X20\n{body}\nM2");
    let source = Source::Text(text.as_bytes().into());
    let whole = keep(&source, Options::default(), usize::MAX).unwrap();
    let short = keep(&source, Options::default(), 7).unwrap();
    let path = short.paths.last().unwrap();
    assert!(path.rest.is_some() && path.targets.len() < 20);
    assert_eq!(path.whole().unwrap().targets, whole.paths.last().unwrap().targets);
}
