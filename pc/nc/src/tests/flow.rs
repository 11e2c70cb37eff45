//! Loops, conditions and subroutines.

use super::*;
use std::sync::Arc;

/// X of all motions after the header.
fn xs(body: &str) -> Vec<f64> {
    let program = run(body).unwrap();
    let targets = program.paths[2..].iter().flat_map(|path| &path.targets);
    targets.filter_map(|target| target.words.axes[0]).collect()
}

#[test]
fn loops_and_conditions() {
    let body = "#1=0\no1 while [#1 lt 5]\n#1=[#1+1]\no2 if [#1 eq 2]\no1 continue\no2 elseif [#1 eq 4]\no1 break\n\
                o2 else\nG0 X#1\no2 endif\no1 endwhile\nG0 X9\nM2";
    assert_eq!(xs(body), [1.0, 3.0, 9.0]);
    assert_eq!(
        xs("#1=0\no1 do\n#1=[#1+1]\nG0 X#1\no1 while [#1 lt 3]\nM2"),
        [1.0, 2.0, 3.0]
    );
    assert_eq!(
        xs("#1=1\no<a> repeat [3]\nG0 X#1\n#1=[#1*2]\no<A> endrepeat\nM2"),
        [1.0, 2.0, 4.0]
    );
    assert_eq!(
        xs("o1 repeat [0]\nG0 X[1/0]\no1 endrepeat\no2 if [0]\nthis is nothing\no2 endif\nG0 X1\nM2"),
        [1.0]
    );
}

#[test]
fn subroutines_have_arguments_and_results() {
    let body = "o1 sub\n#3=[#1*#2]\nG0 X#3\no2 if [#1 gt 1]\no1 call [#1-1] [#2]\no2 endif\no1 endsub [#3]\n#1=7\n\
                o1 call [3] (times) [10]\nG0 X[#<_value>+#1]\nM2";
    assert_eq!(xs(body), [30.0, 20.0, 10.0, 37.0]);
    assert!(run(body).unwrap().branches);
    // A numbered one may stand behind the end, and has no parameters of its own.
    assert_eq!(
        xs("#1=1\nM98 P77 L3\nG0 X50\nM2\nO77\nG0 X#1\n#1=[#1+1]\nM99\n"),
        [1.0, 2.0, 3.0, 50.0]
    );
}

#[test]
fn subroutines_may_be_in_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("far.ngc"),
        "o<far> sub\nG0 X#1\no<far> endsub\nM2\n",
    )
    .unwrap();
    std::fs::write(folder.path().join("bad.ngc"), "o<bad> sub\nG0 X\no<bad> endsub\n").unwrap();
    let setup = Setup {
        folders: vec![folder.path().to_owned()],
        ..Setup::default()
    };
    let options = Options {
        setup: Arc::new(setup),
        ..Options::default()
    };
    let program = interpret("o<far> call [4]\nG0 X5\nM2", options.clone()).unwrap();
    assert_eq!(program.paths.len(), 2);
    let error = interpret("\no<bad> call\nM2", options).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 2, column 4: in bad.ngc: X needs a number"
    );
}

#[test]
fn a_long_program_may_have_calls_loops_and_conditions() {
    let straight = "N1\n".repeat(1_000_001);
    let flow = "o1 sub\nG0 X1\no1 endsub\no1 call\no2 repeat [2]\no2 endrepeat\no3 if [1]\n";
    let program = run(&format!("{flow}{straight}o3 endif\nG0 X2\nM2")).unwrap();
    assert_eq!(program.paths.len(), 4);
    // A subroutine may be as long; called again and again its lines are too many.
    let called = |calls: &str| format!("o1 sub\n{straight}o1 endsub\n{calls}M2");
    assert!(run(&called("o1 call\n")).is_ok());
    assert!(matches!(
        problem(&called("o1 call\no1 call\n")).0,
        Problem::Endless(_)
    ));
}

#[test]
fn what_does_not_end_is_told() {
    // Lines that are passed over count, too.
    let passed = "G1 X1\n".repeat(3000);
    let passed = format!("o1 while [1]\n#1=1\no2 if [0]\n{passed}o2 endif\no1 endwhile\nM2");
    assert!(matches!(problem(&passed).0, Problem::Endless(_)));
    // So do motions of cycles, and the length of lines.
    let holes = "F100\no1 while [1]\n#1=1\nG81 X1 Y1 Z-1 R1 L5000\no1 endwhile\nM2";
    assert!(matches!(problem(holes).0, Problem::Endless(_)));
    let long = format!("o1 while [1]\n#1=1 ({})\no1 endwhile\nM2", "-".repeat(9000));
    assert!(matches!(problem(&long).0, Problem::Endless(_)));
    assert!(matches!(
        problem("F100\nG83 X1 Z-5 R2 Q0.001 L100\nM2").0,
        Problem::Impossible { code: "G83", .. }
    ));
    let same = |body: &str| matches!(problem(&format!("{body}\nM2")).0, Problem::SameAgain(_));
    assert!(same("#1=1\no1 while [#1 LT 2]\nG0 X1\no1 endwhile"));
    assert!(same("o1 do\no2 if [0]\no1 break\no2 endif\no1 while [1]"));
    assert!(same("o1 while [1]\no1 continue\no1 endwhile"));
    assert!(run("G91\no1 while [#5420 LT 3]\nG0 X1\no1 endwhile\nM2").is_ok());
    assert!(run("G91\no1 do\nG0 X1\no1 while [#<_x> LT 3]\nM2").is_ok());
    assert!(run("G91\no1 while [1]\nG0 X1\no2 if [#5420 GT 3]\no1 break\no2 endif\no1 endwhile\nM2").is_ok());
    assert!(matches!(
        problem("o1 while [1]\n#1=1\no1 endwhile\nM2").0,
        Problem::Endless(_)
    ));
    assert_eq!(
        problem("o1 sub\no1 call\no1 endsub\no1 call\nM2").0,
        Problem::CallDepth(32)
    );
    assert!(matches!(
        problem("o1 if [1]\nG0 X5").0,
        Problem::FlowEnd { wanted: "endif", .. }
    ));
    assert!(matches!(
        problem("o1 if [0]\nG0 X5\nM2").0,
        Problem::FlowEnd { wanted: "endif", .. }
    ));
    assert!(matches!(
        problem("o1 endwhile\nM2").0,
        Problem::FlowEnd { wanted: "while", .. }
    ));
    assert!(matches!(problem("o1 call\nM2").0, Problem::NoSubroutine { .. }));
    assert_eq!(problem("M98 P7\nO7\nG0 X5\nM99").0, Problem::EndlessProgram);
    assert!(matches!(problem("o1 whatever\nM2").0, Problem::UnknownKeyword(_)));
    assert_eq!(problem("o1 repeat\nM2").0, Problem::FlowValue("repeat"));
}

#[test]
fn modes_are_saved_and_restored() {
    let body = "M70\nG91 G20 F7\nM72\nG0 X1\nX1.5\no1 sub\nM73\nG91\nG0 X1\no1 endsub\no1 call\nX5\nM2";
    assert_eq!(xs(body), [1.0, 1.5, 2.5, 5.0]);
    assert!(matches!(
        problem("M72\nM2").0,
        Problem::Impossible { code: "M72", .. }
    ));
    assert!(matches!(
        problem("M70\nM3 S5\nM72\nM2").0,
        Problem::Impossible { code: "M72", .. }
    ));
}

#[test]
fn speeds_of_the_spindle_come_back_with_the_modes() {
    let speeds = |body: &str| -> Vec<f64> {
        let program = run(body).unwrap();
        let events = program.paths[2..].iter().flat_map(|path| &path.events);
        let speeds = events.filter_map(|event| match event.action {
            ProgramAction::SpindleSpeed(speed) => Some(speed),
            _ => None,
        });
        speeds.collect()
    };
    assert_eq!(speeds("S2500\nM70\nS300\nM72\nM3\nG0 X1\nM2"), [2500.0]);
    assert_eq!(
        speeds("S2500 M3\nG0 X1\nM70\nS300\nG0 X2\nM72\nG0 X3\nM2"),
        [2500.0, 300.0, 2500.0]
    );
    assert_eq!(speeds("S2500 M3\nM70\nG0 X1\nM72\nG0 X3\nM2"), [2500.0]);
}

#[test]
fn a_program_may_end_in_several_ways() {
    let notices = |body: &str| run(body).unwrap().notices.len();
    assert_eq!(notices("G0 X5\nM2\nwhat follows is not read"), 0);
    assert_eq!(notices("G0 X5"), 1);
    assert_eq!(notices("G0 X5\nM30\n%\n"), 0);
    let text = "%\nO0001 (part)\nG21 G0 X5\n%\nnothing\n";
    assert_eq!(interpret(text, Options::default()).unwrap().notices, []);
    let program = run("(MSG, hello)\n#1=3\n(debug, one: #1, two: #<none>)\n(a comment)\nM2").unwrap();
    let texts: Vec<_> = program
        .notices
        .iter()
        .map(|notice| notice.text.as_str())
        .collect();
    assert_eq!(texts, ["hello", "one: 3.000000, two: #<none>"]);
}

#[test]
fn where_another_name_ends_a_subroutine_that_is_told() {
    for end in ["endsub", "return [1]"] {
        let body = format!("o1 call\nG0 X2\nM2\no1 sub\nG0 X1\no2 {end}\no1 endsub\n");
        let open = HEADER.lines().count() as u32 + 4;
        let program = run(&body).unwrap();
        let told: Vec<String> = program
            .notices
            .iter()
            .map(|n| format!("{}: {}", n.place, n.text))
            .collect();
        let wanted = format!(
            "line {}, column 1: o2 ends the subroutine o1 that begins in line {open}",
            open + 2
        );
        assert_eq!(told, [wanted]);
        assert_eq!(xs(&body), [1.0, 2.0]);
    }
    // In a condition too, and of one that was called by its number.
    assert_eq!(
        xs("o1 call\nG0 X2\nM2\no1 sub\nG0 X1\no3 if [1]\no1 return\no3 endif\no1 endsub\n"),
        [1.0, 2.0]
    );
    assert_eq!(xs("M98 P1\nG0 X2\nM2\no1 sub\nG0 X1\no1 endsub\n"), [1.0, 2.0]);
}
