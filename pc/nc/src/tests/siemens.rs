//! R parameters, IC( ), AC( ), CR=, MSG and labels.

use super::*;

/// X of each motion behind the header.
fn xs(body: &str) -> Vec<f64> {
    let paths = run(&format!("{body}\nM2")).unwrap().paths;
    let targets = paths[2..].iter().flat_map(|path| &path.targets);
    targets.filter_map(|target| target.words.axes[0]).collect()
}

fn wrong(body: &str) -> String {
    run(&format!("{body}\nM2")).unwrap_err().to_string()
}

#[test]
fn r_parameters_are_numbers_of_their_own_and_need_no_brackets() {
    assert_eq!(xs("R1=10 R2 = R1*2+1\nR2=-R2\nG0 X=R1\nX=R2+30/3"), [10.0, -11.0]);
    assert_eq!(xs("R1=5\n#1=7\nG0 X[R1+#1]\n#2=R1\nX#2"), [12.0, 5.0]);
    assert_eq!(
        xs("R3=(1+2)*4 ; a comment\nG0 X=R3(one more)\nX=R299+1"),
        [12.0, 1.0]
    );
    assert_eq!(xs("R1=1\no1 sub\nR1=R1+1\no1 endsub\no1 call\nG0 X=R1"), [2.0]);
    assert!(wrong("R300=1").ends_with("R300 is no parameter: they are R0 to R299"));
    assert!(wrong("R1=1 G0 X5").contains("blocks of their own"));
    assert!(wrong("R1=").contains("a value is missing"));
    assert!(wrong("R1=(2+3").contains("bracket is not closed"));
    // Without = it is a word without a number, as ever.
    assert!(wrong("G0 X R1").contains("X needs a number"));
    assert!(wrong("G0 X-R1").contains("X needs a number"));
}

#[test]
fn steps_and_coordinates_hold_for_one_word() {
    assert_eq!(xs("G0 X10\nX=IC(5)\nG91 X=AC(3)\nX1"), [10.0, 15.0, 3.0, 4.0]);
    assert_eq!(xs("R1=2\nG0 X10\nG1 F100 X=IC(R1*2) Y=AC(1)"), [10.0, 14.0]);
    for body in [
        "G53 G0 X=IC(1)",
        "G92 X=IC(1)",
        "G28 X=AC(1)",
        "F1 G81 X=IC(1) Z1 R2",
    ] {
        assert!(wrong(body).contains("are for G0, G1, G2 and G3"), "{body}");
    }
    assert!(wrong("F=IC(100)").contains("are for X Y Z A B C"));
}

#[test]
fn the_radius_of_an_arc_may_be_named() {
    let program = run("F600 G2 X10 CR=5\nX0 CR=-5\nM2").unwrap();
    let ways: Vec<_> = program.paths[2]
        .targets
        .iter()
        .map(|target| &target.way)
        .collect();
    let radius = |way: &Way| match way {
        Way::Arc(ArcWay {
            form: ArcForm::Radius(radius),
            ..
        }) => *radius,
        _ => panic!("no arc by its radius"),
    };
    assert_eq!(ways.into_iter().map(radius).collect::<Vec<_>>(), [5.0, -5.0]);
    assert!(wrong("F600 G2 X10 R5 CR=5").contains("occurs twice"));
    assert!(wrong("G0 X10 CR=5").contains("CR= belongs to no code"));
}

#[test]
fn messages_are_told_and_labels_passed_over() {
    let program = run("MSG(\"one; two (three)\")\nMSG()\nN10 START_1: G0 X5\nM2").unwrap();
    let told: Vec<_> = program
        .notices
        .iter()
        .map(|notice| notice.text.as_str())
        .collect();
    assert_eq!(told, ["one; two (three)"]);
    assert_eq!(program.paths.len(), 3);
    assert!(wrong("MSG(hello)").contains("MSG(\"text\")"));
    assert!(wrong("GOTOF START_1").contains("GOTOF is not understood"));
}

#[test]
fn words_of_a_post_processor_for_siemens_are_understood() {
    let program = run(
        "G71 G90 G94\nSUPA G0 Z200 D0\nT=\"2\" D1\nM6\nCYCLE832(0.01,1,1)\nD1\nF100 G1 X1\nG153 G0 Z100\nM2",
    )
    .unwrap();
    let told: Vec<&str> = program
        .notices
        .iter()
        .map(|notice| notice.text.as_str())
        .collect();
    for (start, times) in [("G71 is taken as G21", 1), ("D changes nothing", 1)] {
        assert_eq!(
            told.iter().filter(|text| text.starts_with(start)).count(),
            times,
            "{told:?}"
        );
    }
    let named = wrong("T=\"MILL 10\"");
    assert!(
        named.contains("tools have numbers here: T=\"1\" or T1"),
        "{named}"
    );
    assert!(wrong("G71 Q1 X1").contains("lathe codes are not supported"));
    assert!(wrong("F1 G1 X1 D12").contains("D"));
    assert!(wrong("CYCLE800(1)").contains("CYCLE"));
    assert!(run("CYCLE800()\nG710 FNORM\nD1 G54 G0 X1\nM2").is_ok());
}

#[test]
fn variables_that_begin_with_a_line_are_defined_set_and_read() {
    let body = "DEF REAL _x_home, _y_home=3, _tolerance\n_X_HOME=2 _Y_HOME=_Y_HOME*2\nG0 X=_X_HOME\nX=_Y_HOME+1 Y=-_x_home\n\
                X=_tolerance";
    assert_eq!(xs(body), [2.0, 7.0, 0.0]);
    assert!(wrong("G0 X=_NOWHERE").contains("_nowhere"));
    assert!(wrong("DEF REAL HOME").contains("their names begin with _"));
    assert!(wrong("DEF _HOME").contains("DEF REAL _NAME"));
    assert!(wrong("_HOME").contains("_home"));
    // As ever in RS274/NGC.
    assert_eq!(xs("#<_home>=4\nG0 X=_HOME"), [4.0]);
}
