//! R parameters, IC( ), AC( ), CR=, MSG, tools by name, and words without effect.

mod calls;
mod corners;
mod drilling;
mod flow;
mod frames;
mod geometry;
mod programs;

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
    assert!(wrong("F=IC(100)").contains("are for X Y Z A B C, I J K, AP and RP"));
}

#[test]
fn rotary_axes_go_the_short_way_or_one_way() {
    let cs = |body: &str| -> Vec<f64> {
        let paths = run(&format!("{body}\nM2")).unwrap().paths;
        let targets = paths[2..].iter().flat_map(|path| &path.targets);
        targets.filter_map(|target| target.words.axes[5]).collect()
    };
    assert_eq!(cs("G0 C=DC(278)\nC=DC(10)\nC=DC(730)"), [-82.0, 10.0]);
    assert_eq!(
        cs("G0 C90\nC=ACP(80)\nC=ACP(80) X1\nC=ACN(90)"),
        [90.0, 440.0, 440.0, 90.0]
    );
    assert_eq!(cs("G0 C-350\nG91 C=DC(0)"), [-350.0, -360.0]);
    assert!(wrong("G0 X=DC(5)").contains("are for A B C"));
    assert!(wrong("G53 G0 C=DC(5)").contains("are for G0, G1, G2 and G3"));
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
    let told = |body: &str| run(&format!("{body}\nM2")).unwrap().notices[0].text.clone();
    assert_eq!(told("R1=2\nMSG(\"hole \"<<R1*2<<\" of \"<<9)"), "hole 4 of 9");
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
    assert!(wrong("T=\"\"").contains("T=\"NAME\" needs the name of a tool"));
    assert!(wrong("G71 Q1 X1").contains("lathe codes are not supported"));
    assert!(wrong("F1 G1 X1 D12").contains("D"));
    // Beside a tool it is the number of its radius.
    assert!(run("T17 D17 M6\nM2").is_ok() && run("T17\nD17 M6\nM2").is_ok());
    assert!(wrong("T17 D17.5 M6").contains("D belongs to no code"));
    assert!(wrong("CYCLE800(1)").contains("a retraction that is not known"));
    assert!(run("CYCLE800(0,\"TC1\",0,57,0,0,0,0,0.0,0,0,0,0,-1)\nFGROUP(X,Y,Z)\nG0 X1\nM2").is_ok());
    assert!(run("CYCLE800()\nG710 FNORM\nD1 G54 G0 X1\nM2").is_ok());
}

#[test]
fn variables_that_begin_with_a_line_are_defined_set_and_read() {
    let body = "DEF REAL _x_home, _y_home=3, _tolerance\n_X_HOME=2 _Y_HOME=_Y_HOME*2\nG0 X=_X_HOME\nX=_Y_HOME+1 Y=-_x_home\n\
                X=_tolerance";
    assert_eq!(xs(body), [2.0, 7.0, 0.0]);
    assert!(wrong("G0 X=_NOWHERE").contains("_NOWHERE has no value"));
    assert!(wrong("DEF REAL X1").contains("their names begin with two letters or _"));
    assert!(wrong("DEF _HOME").contains("DEF REAL NAME"));
    assert!(wrong("_HOME").contains("_HOME"));
    // As ever in RS274/NGC.
    assert_eq!(xs("#<_home>=4\nG0 X=_HOME"), [4.0]);
}

#[test]
fn variables_have_types_and_elements_and_belong_to_their_program() {
    let body = "DEF INT COUNT=2.6\nDEF BOOL ON=7\nDEF REAL LEVELS[3]=(1,2.5), DEPTH\nLEVELS[2]=COUNT DEPTH=LEVELS[1]*2\n\
                G0 X=COUNT\nX=ON\nX=LEVELS[2]+0.5\nX=DEPTH";
    assert_eq!(xs(body), [3.0, 1.0, 3.5, 5.0]);
    assert!(wrong("DEF REAL LEVELS[2]\nLEVELS[2]=1").contains("LEVELS[2] has no value"));
    assert!(wrong("DEPTH=3").contains("DEPTH= is not understood"));
    assert!(wrong("DEF STRING[8] NAME").contains("DEF REAL NAME"));
    assert_eq!(xs("R[3]=4 R1=R[R2+3]\nG0 X=R1"), [4.0]);
    assert!(wrong("G0 X=$P_UIFR[1,X,TR]").contains("begin with $"));
}

#[test]
fn expressions_are_those_of_siemens() {
    let body = "R1=POT(3)+SQRT(16)*2-ATAN2(1,1)/45 R2=9 DIV 2 R3=7 MOD 4 R4=TRUNC(-2.7) R5=MINVAL(3,MAXVAL(1,2))\n\
                G0 X=R1\nX=R2\nX=R3\nX=R4\nX=R5\nX=ROUND(2.5)*COS(0)";
    assert_eq!(xs(body), [16.0, 4.0, 3.0, -2.0, 2.0, 3.0]);
    assert_eq!(
        xs("R1=(1<2) AND NOT (3>=4)\nR2=(1==2) OR (3<>3)\nR3=TRUE XOR TRUE\nG0 X=R1\nX=R2-1\nX=R3"),
        [1.0, -1.0, 0.0]
    );
    // Comparisons bind least there, and not so in other languages.
    assert!(wrong("R1=R2==1 AND R3==2").contains("write brackets around each comparison"));
    assert_eq!(xs("R1=2*$PI\nG0 X=R1")[0], std::f64::consts::TAU);
    assert!(wrong("R1=-3 MOD 2").contains("MOD of negative numbers"));
    for nested in ["R[", "_A[[", "(", "-", "NOT ", "SIN(", "[", "R[_A["] {
        let deep = format!("R1={}", nested.repeat(9_000 / nested.len()));
        assert!(
            wrong(&deep).contains("inside each other"),
            "{nested}: {}",
            wrong(&deep)
        );
    }
    assert!(wrong("R1=FOO(2)").contains("FOO is no function"));
}

#[test]
fn tools_have_names_and_are_asked_for_by_them() {
    let program = run("T=\"MILL_10\" D1\nM6\nT=\"DRILL\"\nM6\nG0 X1\nT=\"MILL_10\"\nM6\nM2").unwrap();
    let waits: Vec<_> = program
        .waits()
        .map(|wait| (wait.until, wait.text.as_deref()))
        .collect();
    let tool = |number, text| (Until::ToolIn(number), Some(text));
    assert_eq!(
        waits,
        [tool(1_000_002, "tool DRILL"), tool(1_000_001, "tool MILL_10")]
    );
    let told = |start: &str| {
        program
            .notices
            .iter()
            .filter(|notice| notice.text.starts_with(start))
            .count()
    };
    assert_eq!(
        (
            told("tool MILL_10 has the number"),
            told("tool DRILL has the number")
        ),
        (1, 1)
    );
}

#[test]
fn words_without_effect_are_passed_over_and_others_refused_with_a_reason() {
    let words = "G0 G40 G60 G601 G17 G90 G94\nSOFT FFWON COMPCAD\nG450 CFC KONT CUT2D WALIMOF DIAMOF\nLIMS=5000 SETMS(1)\n\
                 STOPRE\nWORKPIECE(,\"\",,\"BOX\",112,0,-20,-80,0,0,100,60)\nS1=500 M1=5\nG641 ADIS=0.1\nX1 M8 M41\nM2";
    assert!(run(words).is_ok(), "{:?}", run(words));
    for (body, reason) in [
        ("SPOS=0", "the spindle is not positioned"),
        ("CSPLINE", "splines through points"),
        (
            "BSPLINE",
            "its curve depends on knots that the controller chooses",
        ),
        ("SLOT1(9,0,2,-5)", "this cycle is not supported"),
        ("CYCLE800(1,\"\",0,57,0,0,0,30,0,0,0,0,0,1)", "a retraction"),
        ("FGROUP(X,Y,A)", "F is the speed of the tip"),
        ("ROTS X30", "only TRANS, MIRROR, SCALE"),
        ("G510", "coordinate systems are G54 to G57 and G505 to G509"),
        ("M2=3", "M2= is not understood"),
        ("L6", "there is no such word, and no subprogram L6"),
        ("MCALL CYCLE84(5,0,2,-10)", "threading and tapping"),
        ("MCALL POCKET3(1)", "this cycle is not supported"),
    ] {
        assert!(wrong(body).contains(reason), "{}", wrong(body));
    }
}

#[test]
fn a_dwell_may_have_its_seconds_in_f() {
    let program = run("F600\nG1 X10\nG4 F2.5\nX20\nM2").unwrap();
    let last = program.paths.last().unwrap();
    assert_eq!(
        (last.dwell_before_s, last.targets[0].feed),
        (2.5, Some(FeedRate::PerMinute(600.0)))
    );
    let program = run("F600\nG4 P1 F300\nG1 X10\nM2").unwrap();
    assert_eq!(program.paths[2].targets[0].feed, Some(FeedRate::PerMinute(300.0)));
}

#[test]
fn the_tolerance_of_a_contour_holds_with_g642() {
    let tolerance = |body: &str| match run(body).unwrap().paths[2].targets[0].control {
        PathControl::Blend(blend) => blend.tolerance,
        control => panic!("{control:?}"),
    };
    assert_eq!(tolerance("G642 CTOL=0.01\nF9\nG1 X1\nM2"), Some(0.01));
    assert_eq!(tolerance("CTOL=0.02\nG645\nF9\nG1 X1\nM2"), Some(0.02));
    assert_eq!(tolerance("CTOL=0.02\nCTOL=-1\nG642\nF9\nG1 X1\nM2"), Some(0.05));
    let stop = run("G60\nF9\nG1 X1\nM2").unwrap().paths[2].targets[0].control;
    assert_eq!(stop, PathControl::ExactStop);
}
