//! What programs of other controllers have, and what is told or refused of it.

use super::*;

pub(super) fn told(body: &str) -> Vec<String> {
    let program = run(body).unwrap_or_else(|error| panic!("{error}"));
    program.notices.into_iter().map(|notice| notice.text).collect()
}

pub(super) fn wrong(body: &str) -> String {
    run(body).unwrap_err().to_string()
}

/// Where each motion behind the header leads, X Y Z.
pub(super) fn ends(body: &str) -> Vec<[f64; 3]> {
    let program = run(body).unwrap_or_else(|error| panic!("{error}"));
    let mut at = [0.0; 3];
    let mut ends = Vec::new();
    for target in program.paths[2..].iter().flat_map(|path| &path.targets) {
        for (at, said) in at.iter_mut().zip(target.words.axes) {
            *at = said.unwrap_or(*at);
        }
        ends.push(at);
    }
    ends
}

#[test]
fn g53_alone_moves_nothing_which_is_told() {
    for word in ["G53", "G53 M8", "SUPA D0", "G53 G0"] {
        assert_eq!(
            ends(&format!("F100\nG1 X1\n{word}\nX2\nM2")),
            [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]
        );
        let told = told(&format!("{word}\nG53\nM2"));
        let about = told.iter().filter(|text| text.contains("without axis words"));
        assert_eq!(about.count(), 1, "{word}: {told:?}");
    }
}

#[test]
fn g0_may_stand_beside_g28_and_holds_after_it() {
    let program = run("F100\nG1 X5\nG0 G91 G28 Z0\nG90 X7\nM2").unwrap();
    let motions: Vec<_> = program.paths[2..].iter().map(|path| path.motion).collect();
    assert_eq!(motions, [Motion::Feed, Motion::Rapid, Motion::Rapid]);
    let first = run("F100\nG1 X5\nG91 G28 Z0\nG90 G0 X7\nM2").unwrap();
    let ways = |program: &Program| -> Vec<_> {
        let targets = program.paths.iter().flat_map(|path| &path.targets);
        targets.map(|target| (target.way.clone(), target.words)).collect()
    };
    assert_eq!(ways(&program), ways(&first));
    assert!(wrong("F100\nG1 G28 Z0\nM2").contains("G28 takes the axis words"));
    assert!(wrong("G0 G92 X0\nM2").contains("G92 takes the axis words"));
}

#[test]
fn what_ends_modes_of_other_controllers_changes_nothing() {
    let told = told("G15 G17 G23 G40 G49 G50 G69 G80\nG5 P10000\nG0 X1\nG5 P0\nM2");
    for code in ["G23", "G50", "G69", "G5 P"] {
        let about = told
            .iter()
            .filter(|text| text.starts_with(&format!("{code} changes nothing")));
        assert_eq!(about.count(), 1, "{code}: {told:?}");
    }
    assert!(wrong("G50 S2000\nM2").contains("lathe"));
    assert!(wrong("G50 X100 Z50\nM2").contains("lathe"));
    assert!(wrong("G5 P2\nM2").contains("P10000 begins"));
    for (code, why) in [
        ("G51 X0 Y0 P2", "coordinates are not scaled"),
        ("G54.1 P3", "G54 to G59.3"),
        ("G66 P9000 A1", "not called after motions"),
        ("M200", "M62 to M65"),
    ] {
        assert!(wrong(&format!("{code}\nM2")).contains(why), "{code}");
    }
}

#[test]
fn g16_makes_x_and_y_distance_and_angle() {
    let holes = |body: &str| -> Vec<[f64; 2]> {
        let bottoms = ends(body).into_iter().filter(|end| end[2] == -5.0);
        bottoms
            .map(|[x, y, _]| [x, y].map(|value| (value * 1e6).round() / 1e6))
            .collect()
    };
    assert_eq!(
        holes("G16 G99 G81 X10 Y90 Z-5 R2 F100\nY180\nG91 Y90 R2 Z-7\nG90 G15 X3 Y4 R2 Z-5\nM2"),
        [[0.0, 10.0], [-10.0, 0.0], [0.0, -10.0], [3.0, 4.0]]
    );
    // Axes of the machine and offsets are as ever.
    assert_eq!(ends("G16\nG53 G0 X5 Y7\nM2"), [[5.0, 7.0, 0.0]]);
    assert!(wrong("G16 G91 X10\nM2").contains("write it with G90"));
    assert!(wrong("G18 G16 G0 X10\nM2").contains("G17"));
}

#[test]
fn a_number_with_an_implied_point_is_refused() {
    for word in ["X0019685", "Y-0008937", "Z00100", "I+00012"] {
        let problem = wrong(&format!("F100\nG1 {word}\nM2"));
        assert!(problem.contains("write the point"), "{problem}");
    }
    assert_eq!(
        ends("G0 X0010 Y00010.5 Z0\nX00000\nM2")[..1],
        [[10.0, 10.5, 0.0]],
        "LinuxCNC's are as they were"
    );
}

#[test]
fn programs_of_heidenhain_get_one_sentence() {
    for text in [
        "0 BEGIN PGM PART MM\nM2",
        "; a comment\n0010 BEGIN PGM 100 IN\n",
        "% 123 G71\nG90\n",
        "%PART G70 *\nM2",
    ] {
        let problem = interpret(text, Options::default()).unwrap_err().problem;
        assert_eq!(problem, Problem::Heidenhain, "{text}");
    }
    assert!(interpret("%PART\nG71\nM2", Options::default()).is_ok());
}

#[test]
fn where_controllers_differ_in_cycles_and_dwells_that_is_told() {
    let about = |body: &str, words: &str| told(body).iter().filter(|text| text.contains(words)).count();
    let retract = "without G98 or G99";
    assert_eq!(about("G0 Z9\nG81 X1 Z-5 R2 F100\nX2\nM2", retract), 1);
    for said in [
        "G0 Z9\nG98 G81 X1 Z-5 R2 F100\nM2",
        "G0 Z2\nG81 X1 Z-5 R2 F100\nM2",
    ] {
        assert_eq!(about(said, retract), 0, "{said}");
    }
    assert_eq!(about("G4 P4000\nG0 X1\nM2", "dwell 4 s"), 1);
    assert_eq!(about("G4 P99\nG4 P100.5\nG4 F500\nG0 X1\nM2", "milliseconds"), 0);
    assert_eq!(
        about("G0 Z9\nG99 G82 X1 Z-5 R2 P200 F100\nM2", "P of G82 is in seconds"),
        1
    );
    // Without P there is no dwell.
    assert_eq!(
        about(
            "G0 Z9\nG99 G82 X1 Z-5 R2 F100\nX2\nM2",
            "G82 without P does not dwell"
        ),
        1
    );
    let drilled = ends("G0 X1 Z2\nG99 G82 Z-5 R2 P0.2 F100 L0\nX3\nM2");
    assert_eq!(drilled[1..], [[3.0, 0.0, 2.0], [3.0, 0.0, -5.0], [3.0, 0.0, 2.0]]);
    assert!(wrong("G99 G82 X1 Z-5 R2 P0.2 F100 L0\nM2").contains("without the place of a hole"));
}

#[test]
fn numbers_of_a_cycle_hold_after_g90_and_g91_as_on_linuxcnc_which_is_told() {
    let levels = "G0 Z9\nG98 G81 X1 Z-5 R2 F100\n";
    for (step, retract, bottom) in [
        ("G91 X1", 11.0, 6.0),
        ("G91 X1 R-3", 6.0, 1.0),
        ("G91 X1 Z-1", 11.0, 10.0),
    ] {
        let body = format!("{levels}{step}\nX1\nM2");
        let heights: Vec<f64> = ends(&body)[5..].iter().map(|end| end[2]).collect();
        assert!(
            heights.contains(&retract) && heights.contains(&bottom),
            "{step}: {heights:?}"
        );
        let told = told(&body);
        let about = told
            .iter()
            .filter(|text| text.contains("are taken as steps, as on LinuxCNC"));
        assert_eq!(about.count(), 1, "{step}: {told:?}");
    }
    let said = told(&format!("{levels}G91 X1 R-7 Z-5\nG90 X5 R2 Z-5\nM2"));
    assert_eq!(said, <[String; 0]>::default());
}

/// Problem or notices of `text`, on a machine whose file lists M31, M50 and M9026.
fn with_functions(text: &str) -> Result<Vec<(u32, String)>, String> {
    let setup = Setup {
        passed_over: [31, 50, 9026].into(),
        ..Setup::default()
    };
    let options = Options {
        setup: setup.into(),
        ..Options::default()
    };
    let program = interpret(text, options).map_err(|error| error.to_string())?;
    let notices = program.notices.into_iter();
    Ok(notices.map(|notice| (notice.place.line, notice.text)).collect())
}

#[test]
fn functions_of_other_machines_are_passed_over_where_the_machine_file_lists_them() {
    let text = "G21 G0 X5\nM31\nM31 G1 X6 F100 M9026 (both)\nN5 M50\nM31\nM2";
    let passed = |number: u16| format!("M{number} is passed over, as the machine file says");
    let told = with_functions(text).unwrap();
    assert_eq!(told, [(2, passed(31)), (3, passed(9026)), (4, passed(50))]);
    // The rest of their blocks means what it meant, or is refused as before.
    assert_eq!(ends("G0 X5 M40\nM2"), [[5.0, 0.0, 0.0]]);
    let of = |text: &str| with_functions(text).unwrap_err();
    assert_eq!(
        of("M31 P5\nM2"),
        "line 1, column 5: P belongs to no code of this block: leave it out, or write it beside the code that it is for"
    );
    assert!(of("X5 M31\nM2").contains("axis words without a motion"));
    // What is not listed is an error, with the way out.
    for code in ["M32", "M131"] {
        let problem = of(&format!("{code}\nM2"));
        assert!(
            problem.contains(&format!("{code} is not understood")),
            "{problem}"
        );
        assert!(problem.contains("list it under passed_over in [program] of the machine file"));
    }
    for code in ["M10000", "M31.5", "G5.5"] {
        let problem = of(&format!("{code}\nM2"));
        assert!(
            problem.ends_with(&format!("{code} is not understood")),
            "{problem}"
        );
    }
    assert!(wrong("M31\nM2").contains("passed_over"));
    assert!(wrong("M50\nM2").contains("passed_over"));
    assert!(of("M19\nM2").contains("the spindle is not positioned"));
}

#[test]
fn commands_to_grbl_are_passed_over_where_the_machine_file_lists_them() {
    let with_commands = |text: &str| {
        let setup = Setup {
            grbl_commands: true,
            ..Setup::default()
        };
        let options = Options {
            setup: setup.into(),
            ..Options::default()
        };
        let program = interpret(text, options).map_err(|error| error.to_string())?;
        let notices = program.notices.into_iter();
        Ok(notices
            .map(|notice| (notice.place.line, notice.text))
            .collect::<Vec<_>>())
    };
    let passed = |name: &str| format!("{name} is passed over, as the machine file says");
    let text = "$I ; build\n?\n $ h\n$32 = 1 (laser)\nG21 G0 X5\n$$\n$I\nM2";
    let told = with_commands(text).unwrap();
    let names = [(1, "$I"), (2, "?"), (3, "$H"), (4, "$32=1"), (6, "$$")];
    assert_eq!(told, names.map(|(line, name)| (line, passed(name))));
    let of = |text: &str| -> String { with_commands(text).unwrap_err() };
    // They would move something, or change what the program does.
    for (text, problem) in [
        (
            "$J=G91 X5 F100\nM2",
            "line 1, column 1: $J=G91X5F100 is no command",
        ),
        ("$C\nM2", "$C is no command to Grbl that may be left out"),
        ("$N0=G20\nM2", "$N0=G20 is no command"),
        (
            "$P_UIFR[1,X,TR]=5\nM2",
            "is no command to Grbl that may be left out",
        ),
        ("G0 X5\n$H\nM2", "line 2, column 1: $H after a motion"),
        ("G53 G0 X5\n$H\nM2", "line 2, column 1: $H after a motion"),
        ("G0 X5 $H\nM2", "'$' begins"),
    ] {
        assert!(of(text).contains(problem), "{text}: {}", of(text));
    }
    assert!(wrong("$I\nM2").contains("list \"$\" under passed_over"));
}

#[test]
fn what_has_a_meaning_is_never_passed_over() {
    let setup = Setup {
        passed_over: (0..=9999).collect(),
        ..Setup::default()
    };
    let options = Options {
        setup: setup.into(),
        ..Options::default()
    };
    let told = |text: &str| interpret(text, options.clone()).map(|program| program.notices);
    assert_eq!(told("M30\nM77").unwrap(), []);
    assert!(told("M19\nM2").is_err());
    let told = told("M77\nM2").unwrap();
    assert_eq!(told[0].text, "M77 is passed over, as the machine file says");
}

#[test]
fn a_unit_that_is_not_said_before_lengths_is_told_once() {
    let told = |text: &str, inches: bool| -> Vec<(u32, String)> {
        let setup = Setup {
            inches,
            ..Setup::default()
        };
        let options = Options {
            setup: setup.into(),
            ..Options::default()
        };
        let notices = interpret(text, options).unwrap().notices.into_iter();
        let lines = notices.map(|notice| (notice.place.line, notice.text));
        lines
            .filter(|(_, text)| text.starts_with("neither G20"))
            .collect()
    };
    let text = |unit: &str| format!("neither G20 nor G21 before the first motion: lengths are {unit}");
    let body = "G10 L2 P1 X5\nG0 X0 Y0 A5\nG1 X5 F100\nX6\nG21\nX7\nM2";
    assert_eq!(told(body, false), [(3, text("mm"))]);
    assert_eq!(told(body, true), [(3, text("inches, as the machine file says"))]);
    assert_eq!(told("G28 Z5\nG21\nM2", false), [(1, text("mm"))]);
    assert_eq!(told("G53 G0 Z5\nG21\nM2", false), [(1, text("mm"))]);
    for unit in ["G20", "G21", "G70", "G71", "G700", "G710"] {
        assert_eq!(told(&format!("{unit}\nG0 X5\nM2"), false), []);
        assert_eq!(told(&format!("G0 X0\n{unit} X5\nX6\nM2"), false), []);
    }
    assert_eq!(told("G91 G28 Z0\nG90 G0 A90 C5\nG4 P1\nM2", false), []);
}

#[test]
fn a_comment_may_have_others_inside() {
    let program =
        run("G0 X5 (T1 (end mill) D=6)\nY2 (a (b) (c (d))) Z7\n(MSG, hook (left) first)\nM2").unwrap();
    assert_eq!(program.paths[2].targets[0].words.axes[0], Some(5.0));
    let second = program.paths[3].targets[0].words.axes;
    assert_eq!(second[1..3], [Some(2.0), Some(7.0)]);
    let told: Vec<_> = program
        .notices
        .iter()
        .map(|notice| notice.text.as_str())
        .collect();
    let text = "a comment inside a comment: all up to the last ) is no part of the program";
    assert_eq!(told, [text, "hook (left) first"]);
    assert!(wrong("G0 X5 (a (b)\nM2").contains("the comment is not closed"));
    assert!(wrong("G0 X5 (a) b)\nM2").contains("B needs a number"));
}

#[test]
fn codes_of_other_controllers_that_concern_no_motion_are_told() {
    let body = "G187 P2 E0.025\nG103 P1\nG103\nG8 P1\nG5.1 Q1 R5\nG62 G11\nG50.1 X0 Y0\nG255\nG1 X5 F100\nM2";
    assert_eq!(ends(body), [[5.0, 0.0, 0.0]]);
    let told = told(body);
    for code in ["G187", "G103", "G8 P", "G5.1 Q", "G62", "G11", "G50.1", "G255"] {
        let start = format!("{code} changes nothing");
        assert_eq!(
            told.iter().filter(|text| text.starts_with(&start)).count(),
            1,
            "{code}: {told:?}"
        );
    }
    assert_eq!(
        ends("G0 X5\nG90 G50.1 X0 Y0\nY2\nM2"),
        [[5.0, 0.0, 0.0], [5.0, 2.0, 0.0]]
    );
    assert!(wrong("G0 G50.1 X0\nM2").contains("G50.1 takes the axis words"));
    for body in [
        "G103 Q1",
        "G8 P2",
        "G8 P1 X5",
        "G5.1 Q1 R5 X1",
        "G187 G1 X5 F100 P2",
    ] {
        let axes = body.contains('X');
        let error = wrong(&format!("{body}\nM2"));
        assert!(
            axes || error.contains("belongs to no code") || error.contains("begins"),
            "{body}: {error}"
        );
    }
    for (code, why) in [
        ("G254", "do not turn"),
        ("G12 I5 F100", "pockets"),
        ("G31 Z-5 F9", "no probe"),
        ("G44 H1", "write G43"),
        ("M97 P5", "write M98"),
        ("M198 P5", "write M98"),
        ("$H", "command to Grbl"),
    ] {
        let error = wrong(&format!("{code}\nM2"));
        assert!(error.contains(why), "{code}: {error}");
    }
}

#[test]
fn g9_stops_after_its_motion_alone() {
    let paths = |body: &str| {
        let program = run(&format!("F600\n{body}\nM2")).unwrap();
        let feeds = program.paths.iter().filter(|path| path.motion == Motion::Feed);
        feeds.map(|path| path.targets.len()).collect::<Vec<_>>()
    };
    assert_eq!(paths("G1 X5\nX10\nX15"), [3]);
    assert_eq!(paths("G1 X5\nG9 X10\nX15\nX20"), [2, 2]);
    assert_eq!(paths("G9 G1 X5\nX10 G9\nX15"), [1, 1, 1]);
}

#[test]
fn h0_is_no_length_of_a_tool() {
    let program = run("G43.1 Z20\nG0 Z100\nG0 Z100 H0\nX5\nM2").unwrap();
    let same = run("G43.1 Z20\nG0 Z100\nG49 G0 Z100\nX5\nM2").unwrap();
    let ways = |program: &Program| -> Vec<_> {
        let targets = program.paths.iter().flat_map(|path| &path.targets);
        targets.map(|target| target.words).collect()
    };
    assert_eq!(ways(&program), ways(&same));
    assert_eq!(
        told("G28 Z0 H0\nM2")[0],
        "H0 without G43 is taken as G49: no length of a tool"
    );
    assert!(run("G49 H0\nG43 H0\nM2").is_ok());
    assert!(wrong("G0 Z5 H1\nM2").contains("H belongs to no code"));
    assert!(wrong("G49 H1\nM2").contains("H belongs to no code"));
}

#[test]
fn g4_has_its_time_as_x_too() {
    let dwells = |body: &str| {
        let program = run(&format!("{body}\nG0 X7\nM2")).unwrap();
        program.paths[2].dwell_before_s
    };
    assert_eq!(dwells("G4 X1.5"), 1.5);
    assert_eq!(dwells("F100\nG1\nG4 X2"), 2.0);
    assert!(wrong("G4 X1 Y2\nM2").contains("G4 needs P"));
    assert!(wrong("G4 G0 X1\nM2").contains("G4 needs P"));
}

#[test]
fn k_repeats_cycles_as_l_does() {
    for (k, l) in [
        ("G91 G81 X5 Z-5 R2 K3", "G91 G81 X5 Z-5 R2 L3"),
        ("G81 Z-5 R2 K0\nX5\nX6", "G81 Z-5 R2 L0\nX5\nX6"),
        ("G81 X1 Z-5 R2\nX5 K2", "G81 X1 Z-5 R2\nX5 L2"),
    ] {
        assert_eq!(
            ends(&format!("F100\n{k}\nM2")),
            ends(&format!("F100\n{l}\nM2")),
            "{k}"
        );
    }
    for wrongly in ["G81 X5 Z-5 R2 K2 L2", "G81 X5 Z-5 R2\nK2", "G81 X5 Z-5 R2 K1.5"] {
        assert!(run(&format!("F100\n{wrongly}\nM2")).is_err(), "{wrongly}");
    }
}

#[test]
fn block_delete_may_have_the_number_of_its_switch() {
    assert_eq!(
        ends("/1 G0 X5\n/2X6\n/N7 X7\nM2"),
        [[5.0, 0.0, 0.0], [6.0, 0.0, 0.0], [7.0, 0.0, 0.0]]
    );
    let options = Options {
        block_delete: true,
        ..Options::default()
    };
    let program = interpret(&format!("{HEADER}/1 G0 X5\n/9X6\nM2"), options).unwrap();
    assert_eq!(program.paths.len(), 2);
}

#[test]
fn two_slashes_begin_a_comment_whatever_block_delete_says() {
    let body = "//O1 (a hole) G0 X1\n  // X2\nG0 X5 // the end; or (not\n/X6\nM2";
    assert_eq!(ends(body), [[5.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
    let options = Options {
        block_delete: true,
        ..Options::default()
    };
    let program = interpret(&format!("{HEADER}{body}"), options).unwrap();
    assert_eq!(program.paths.len(), 3);
    assert_eq!(
        ends("#1=0\nWHILE [#1 LT 2] DO1 // twice DO2\n#1=[#1+1]\nG0 X#1\nEND1\nM2"),
        [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]
    );
    assert_eq!(problem("G0 X5 /X6\nM2"), (Problem::DeleteInside, 1));
}

#[test]
fn m99_ends_a_main_program_that_is_not_in_a_subroutine() {
    let told = told("G0 X5\nM99\n%");
    assert_eq!(told, ["M99 in the main program ends it: it is not repeated here"]);
    let program = interpret("O5\nG0 X5 Y5 Z5\nM99\nG0 X9", Options::default()).unwrap();
    assert_eq!(program.paths.len(), 1);
    assert!(wrong("M98 P7\nO7\nG0 X5\nM99").contains("goes on into this subroutine"));
}
