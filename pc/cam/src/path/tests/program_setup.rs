//! What a machine file lets programs begin with, as it comes out of their paths.

use super::*;
use config::machine::PassedOver;

/// `text` on the A/C head with `more` at the end of its file, and where the axes stand at the end of every path (mm, degrees).
fn ends(more: &str, text: &str) -> (Vec<PlannedPath>, Vec<[f64; AXES]>) {
    let head = include_str!("../../../../../machines/ac-head.toml");
    let machine = MachineFile::parse("m.toml", &format!("{head}\n{more}\n")).unwrap();
    let planner = Planner::build(&machine).unwrap();
    let park = planner.planning.park_axes();
    let options = Options {
        setup: std::sync::Arc::new(planner.setup(&park)),
        ..Options::default()
    };
    let program = interpret(text, options).unwrap();
    let paths = planner.program(&program, &park, None).unwrap();
    let seen = followed("ac-head", &paths, 0.1);
    let last = |index: usize| seen.iter().rfind(|(path, ..)| *path == index).unwrap().2;
    let ends = (0..paths.len()).map(last).collect();
    (paths, ends)
}

fn assert_near(seen: f64, wanted: f64) {
    assert!((seen - wanted).abs() < 1e-6, "{seen} is not {wanted}");
}

#[test]
fn a_program_begins_in_the_units_and_with_the_rotary_axes_of_the_machine_file() {
    let text = "G0 X20 Y20 Z4\nG1 Y21 F10\nM2";
    let more = "[program]\nunits = \"inch\"\nrotary_deg = { A = 20.0 }";
    let (paths, axes) = ends(more, text);
    assert_near(axes[0][0], 508.0);
    assert_near(axes[1][1] - axes[0][1], 25.4);
    assert_near(axes[1][3], 20.0);
    assert_near(paths[1].length_mm(), 25.4);
    assert_near(paths[1].speeds().fastest_mm_s, 254.0 / 60.0);
    // What the program says goes before.
    let (_, axes) = ends(more, "G21\nG0 X500 Y500 Z100 A10\nM2");
    assert_near(axes[0][0], 500.0);
    assert_near(axes[0][3], 10.0);
    // Without the table it is all as it was.
    let (_, axes) = ends("", "G0 X500 Y500 Z100\nM2");
    assert_near(axes[0][0], 500.0);
    assert_near(axes[0][3], 0.0);
}

#[test]
fn arcs_begin_in_the_plane_of_the_machine_file() {
    let text = "G0 X500 Y500 Z100\nG3 X540 I20 F1200\nM2";
    let highest = |more: &str| {
        let (paths, _) = ends(more, text);
        let path = paths[1].path();
        let middle = path.at(paths[1].length_mm() / 2.0).unwrap().pose().unwrap();
        middle.position
    };
    let flat = highest("");
    assert!((flat - Vector3::new(520.0, 480.0, 100.0)).norm() < 1e-3, "{flat}");
    // Counter-clockwise seen from +Y, from Z to X.
    let upright = highest("[program]\nplane = \"G18\"");
    assert!(
        (upright - Vector3::new(520.0, 500.0, 120.0)).norm() < 1e-3,
        "{upright}"
    );
}

#[test]
fn corners_are_passed_as_the_machine_file_says() {
    let text = "G0 X500 Y500 Z100 A0 C0\nG1 X520 F1200\nY520\nM2";
    let passed = |more: &str| {
        let (paths, _) = ends(more, text);
        let summary = paths[1].blocks.as_ref().unwrap().summary();
        (summary.stops, summary.corners, summary.tolerance_mm)
    };
    let wide = passed("[program]\npath_mode = \"G64\"\ntolerance_mm = 0.3");
    assert_eq!((wide.0, wide.2), (0, Some(0.3)));
    let stops = passed("[program]\npath_mode = \"G61\"");
    assert_eq!((stops.0, stops.1), (1, 1));
}

#[test]
fn the_tip_waits_for_tip_control_where_the_machine_file_says_so() {
    let head = include_str!("../../../../../machines/ac-head.toml");
    let machine = MachineFile::parse("m.toml", &format!("{head}\n[program]\ntip_control = false")).unwrap();
    let planner = Planner::build(&machine).unwrap();
    let read = |text: &str| {
        let setup = std::sync::Arc::new(planner.setup(&planner.planning.park_axes()));
        let options = Options {
            setup,
            ..Options::default()
        };
        interpret(text, options).map_err(|error| error.to_string())
    };
    let refused = read("G0 X500\nM2").unwrap_err();
    assert!(
        refused.starts_with("line 1, column 4: G43.4 must come before"),
        "{refused}"
    );
    assert!(read("TRAORI\nG0 X500\nM2").is_ok());
    // Its end is the mode of the file again.
    let refused = read("TRAORI\nG0 X500\nTRAFOOF\nG0 X510\nM2").unwrap_err();
    assert!(refused.starts_with("line 4"), "{refused}");
}

#[test]
fn a_longer_tool_ends_where_the_program_says_however_the_head_leans() {
    let more = "[tools.2]\nlength_mm = 12.5";
    let text = "G53 G0 A30 C40\nG43 H2\nG0 X500 Y500 Z100\nG1 X520 Y510 Z105 F1200\nG2 X540 I10\nM2";
    let (paths, axes) = ends(more, text);
    let kinematics = planner_of("ac-head").kinematics().clone();
    for (axes, wanted) in axes[1..]
        .iter()
        .zip([[500.0, 500.0, 100.0], [540.0, 510.0, 105.0]])
    {
        let pose = kinematics.forward(&inner(axes));
        let end = pose.position - pose.normal * 12.5;
        assert!((end - Vector3::from(wanted)).norm() < 1e-4, "{end}");
        assert!(pose.normal.z < 0.9);
    }
    // A block of 22.9 mm and half a turn about 10 mm, as without a length.
    let length = 525.0_f64.sqrt() + 10.0 * std::f64::consts::PI;
    assert!(
        (paths[2].length_mm() - length).abs() < 0.1,
        "{}",
        paths[2].length_mm()
    );
}

#[test]
fn a_machine_file_passes_over_just_the_codes_that_mean_nothing_to_a_program() {
    let all = Options {
        setup: std::sync::Arc::new(nc::Setup {
            passed_over: (0..=9999).collect(),
            ..nc::Setup::default()
        }),
        ..Options::default()
    };
    for number in 0..=9999 {
        let code = format!("M{number}");
        let read = interpret(&format!("{code}\nM2"), all.clone());
        let passed = read.is_ok_and(|program| {
            let mut notices = program.notices.iter();
            notices.any(|notice| notice.text == format!("{code} is passed over, as the machine file says"))
        });
        assert_eq!(PassedOver::try_from(vec![code.clone()]).is_ok(), passed, "{code}");
    }
}

#[test]
fn a_program_runs_without_the_codes_that_the_machine_file_passes_over() {
    let text = "G21\nG0 X500 Y500 Z100\nM31 G1 X520 F1200\nM2";
    let (_, axes) = ends("[program]\npassed_over = [\"M31\"]", text);
    assert_near(axes[1][0], 520.0);
}

#[test]
fn m3_and_m4_open_the_gate_of_the_laser_that_the_machine_file_names() {
    use shared::protocol::PathAction;
    let text = "G0 X500 Y500 Z100\nM4\nG1 X520 S500 F1200\nX540 S0\nX560 S1000\nG0 Y520\nM5\nM2";
    let (paths, _) = ends("[program]\nlaser = { beam = 1, full_s = 1000 }", text);
    let full = planner_of("ac-head").largest_power[0].unwrap();
    let gates_and_powers = |path: &PlannedPath| -> Vec<(f64, Result<bool, f64>)> {
        let events = path.legs().flat_map(|leg| leg.unwrap().events);
        let seen = events.filter_map(|event| {
            let what = match event.action {
                PathAction::Beam { side: 0, on } => Ok(on),
                PathAction::Power { side: 0, watt } => Err(watt),
                _ => return None,
            };
            Some(((event.s_mm * 1e9).round() / 1e9, what))
        });
        seen.collect()
    };
    let expected = [
        (0.0, Err(full / 2.0)),
        (0.0, Ok(true)),
        (20.0, Ok(false)),
        (40.0, Err(full)),
        (40.0, Ok(true)),
    ];
    assert_eq!(gates_and_powers(&paths[1]), expected);
    // No gate is open on a rapid.
    assert!(
        !gates_and_powers(&paths[2])
            .iter()
            .any(|(_, what)| *what == Ok(true))
    );
}
