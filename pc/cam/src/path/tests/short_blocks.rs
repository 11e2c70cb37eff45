//! Blocks of less than a micrometre: they are joined to others, or stand by themselves, and what begins with them is
//! switched in its place.

use super::*;
use shared::protocol::PathAction;

const STIR: &str = "G43.4\nG0 X600 Y500 Z150 B0 C0\nG0 Z50\nF300\n";
const GANTRY: &str = "G43.4\nG0 X600 Y500 Z50 A0 B0 C0\nF300\n";
const MODES: [&str; 5] = ["G64", "G64 P0.02", "G64 P0.02 Q0", "G61", "G61.1"];

/// Paths that feed, on a machine that streams its blocks and on one that has them as knots.
fn planned(body: &str) -> Vec<(&'static str, Vec<PlannedPath>)> {
    let machines = [("stir-gantry", STIR), ("dual-beam-gantry", GANTRY)];
    machines
        .map(|(machine, begin)| {
            let paths = plan_on(machine, &format!("{begin}{body}\nM2"))
                .unwrap_or_else(|error| panic!("{machine}: {body}: {error}"));
            (
                machine,
                paths
                    .into_iter()
                    .filter(|path| path.motion == nc::Motion::Feed)
                    .collect(),
            )
        })
        .into()
}

/// X Y of the tip where events of power happen, with their values, over all `paths`; and where they end.
fn events(paths: &[PlannedPath]) -> (Vec<(f64, [f64; 2])>, [f64; 2]) {
    let mut seen = Vec::new();
    let mut end = [f64::NAN; 2];
    for path in paths {
        let course = path.path();
        let at = |s: f64| {
            let value = course.at(s).unwrap().value;
            [value[0], value[1]]
        };
        let mut end_s = 0.0;
        for leg in path.legs().map(Result::unwrap) {
            for event in &leg.events {
                assert!(
                    event.s_mm >= end_s - 1e-6 && event.s_mm <= end_s + leg.element.length,
                    "{event:?}"
                );
                if let PathAction::Power { side: 0, watt } = event.action {
                    // What is on already is switched again where a path begins.
                    if seen.last().is_none_or(|(last, _)| *last != watt) {
                        seen.push((watt, at(event.s_mm)));
                    }
                }
            }
            end_s += leg.element.length;
        }
        let start = at(0.0);
        assert!(
            end[0].is_nan() || (start[0] - end[0]).hypot(start[1] - end[1]) < 1e-9,
            "a jump"
        );
        end = at(path.length_mm());
    }
    (seen, end)
}

/// A body, where its powers 1, 2, 3 and so on are, and where it ends.
type Case = (&'static str, &'static [[f64; 2]], [f64; 2]);

#[test]
fn short_blocks_lead_where_they_say_and_switch_in_their_place() {
    let cases: [Case; 7] = [
        (
            "M67 E0 Q1\nG1 X650\nM67 E0 Q2\nX650.0004\nM67 E0 Q3\nX700",
            &[[600.0, 500.0], [650.0, 500.0], [650.0, 500.0]],
            [700.0, 500.0],
        ),
        (
            "M67 E0 Q1\nG1 X600.0006 Y500.0003\nM67 E0 Q2\nX650",
            &[[600.0, 500.0], [600.0, 500.0]],
            [650.0, 500.0003],
        ),
        ("G1 X650\nX650.0003 Y500.0004", &[], [650.0003, 500.0004]),
        (
            "G1 X650\nM67 E0 Q1\nX650.0003\nM67 E0 Q2\nY500.0004",
            &[[650.0, 500.0], [650.0, 500.0]],
            [650.0003, 500.0004],
        ),
        (
            "G1 X650\nM67 E0 Q1\nX650.0003\nM67 E0 Q2\nG3 X750.0003 I50\nM67 E0 Q3\nG1 Y500.0004",
            &[[650.0, 500.0], [650.0, 500.0], [750.0, 500.0]],
            [750.0003, 500.0004],
        ),
        (
            "G3 I50\nM67 E0 Q1\nG1 X600.0005\nM67 E0 Q2\nG2 I50",
            &[[600.0, 500.0], [600.0, 500.0]],
            [600.0005, 500.0],
        ),
        (
            "M67 E0 Q1\nG1 X600.0002\nM67 E0 Q2\nX600.0004",
            &[[600.0, 500.0], [600.0, 500.0]],
            [600.0004, 500.0],
        ),
    ];
    for (body, powers, end) in cases {
        for mode in MODES {
            for (machine, paths) in planned(&format!("{mode}\n{body}")) {
                let case = format!("{machine} {mode} {body}");
                let (seen, last) = events(&paths);
                let values: Vec<f64> = seen.iter().map(|(value, _)| *value).collect();
                let wanted: Vec<f64> = (1..=powers.len()).map(|i| i as f64).collect();
                assert_eq!(values, wanted, "{case}");
                for ((_, at), wanted) in seen.iter().zip(powers) {
                    let off = (at[0] - wanted[0]).hypot(at[1] - wanted[1]);
                    assert!(off < 2e-3, "{case}: {at:?}");
                }
                assert!(
                    (last[0] - end[0]).hypot(last[1] - end[1]) < 1e-9,
                    "{case}: {last:?}"
                );
            }
        }
    }
}

/// A thousand blocks of 0.4 µm are a line, and one of them in a corner is no stop more.
#[test]
fn short_blocks_in_a_row_are_a_line() {
    let mut body = "G61\n".to_owned();
    for i in 1..=1000 {
        writeln!(body, "G1 X{:.4}", 600.0 + f64::from(i) * 4e-4).unwrap();
    }
    for (machine, paths) in planned(&body) {
        let (_, end) = events(&paths);
        assert!((end[0] - 600.4).abs() < 1e-9, "{machine}: {end:?}");
        let length: f64 = paths.iter().map(PlannedPath::length_mm).sum();
        assert!((length - 0.4).abs() < 1e-9, "{machine}: {length}");
    }
    let stops = |body: &str| planned(body)[0].1[0].blocks.as_ref().unwrap().summary().stops;
    assert_eq!(
        stops("G61\nG1 X650\nX650.0003 Y500.0002\nX700\nX700.0001\nY550"),
        1
    );
}

/// A run that begins at the line of a short block, or behind it, begins where that is, with what is on there.
#[test]
fn a_program_begins_at_a_short_block() {
    let text = format!("{STIR}M67 E0 Q1\nG1 X650\nM67 E0 Q2\nG1 X650.0004\nG1 Y550\nM2");
    let program = interpret(&text, Options::default()).unwrap();
    let planner = planner_of("stir-gantry");
    let from = planner.planning.park_axes();
    for line in [8, 9] {
        let paths = planner.program(&program, &from, None).unwrap();
        let paths = planner.from_line(&program, paths, line, &from).unwrap();
        let leg = paths.last().unwrap().given_legs().next().unwrap().unwrap();
        let start = leg.element.at(0.0).value;
        assert!(
            (start[0] - 650.0).abs() < 1e-3 && (start[1] - 500.0).abs() < 1e-9,
            "{start:?}"
        );
        let powers: Vec<_> = leg.events.iter().map(|event| event.action).collect();
        let power = |watt| PathAction::Power { side: 0, watt };
        assert_eq!(powers.last(), Some(&power(2.0)), "{powers:?}");
    }
}
