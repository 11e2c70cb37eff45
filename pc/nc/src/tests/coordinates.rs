//! Units, distance modes, offsets, parameters and expressions: where programs lead.

use super::*;
use shared::io::AXES;
use std::sync::Arc;

/// Ends of all motions after the header.
fn ends(body: &str) -> Vec<[Option<f64>; 3]> {
    let program = run(body).unwrap();
    let targets = program.paths[2..].iter().flat_map(|path| &path.targets);
    targets
        .map(|target| std::array::from_fn(|axis| target.words.axes[axis]))
        .collect()
}

#[test]
fn inches_and_steps() {
    let expected = [
        [Some(25.4), None, None],
        [Some(50.8), Some(2.54), None],
        [Some(51.8), None, None],
    ];
    assert_eq!(ends("G20 G0 X1\nG91 X1 Y.1\nG21 X1\nM2"), expected);
    // F is in the units from before its block.
    let feed = |body: &str| run(body).unwrap().paths[2].targets[0].feed;
    assert_eq!(feed("G20\nF10 G1 X1\nM2"), Some(FeedRate::PerMinute(254.0)));
    assert_eq!(feed("F10 G20 G1 X1\nM2"), Some(FeedRate::PerMinute(10.0)));
    assert_eq!(feed("G20\nF10 G1 A90\nM2"), Some(FeedRate::PerMinute(10.0)));
}

#[test]
fn systems_and_local_offsets_add_up() {
    let x = |x: f64| [Some(x), None, None];
    assert_eq!(
        ends("G10 L2 P2 X100\nG0 X1\nG55 X1\nG54 X0\nM2"),
        [x(1.0), x(101.0), x(0.0)]
    );
    assert_eq!(
        ends("G0 X10\nG92 X4\nX5\nG92.2\nX5\nG92.3 X6\nG92.1\nX6\nM2")[1..],
        [x(11.0), x(5.0), x(12.0), x(6.0)]
    );
    assert_eq!(
        ends("G0 X10\nG10 L20 P3 X1\nG56 X2\nG52 X5\nX2\nM2"),
        [x(10.0), x(11.0), x(16.0)]
    );
    let turned = ends("G10 L2 P1 R90\nG0 X10 Y1\nX20\nM2");
    let near = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 1e-12);
    assert!(near(turned[0][0], -1.0) && near(turned[0][1], 10.0), "{turned:?}");
    assert!(near(turned[1][0], -1.0) && near(turned[1][1], 20.0), "{turned:?}");
}

#[test]
fn systems_that_were_set_at_the_machine_hold_until_the_program_says_otherwise_and_are_told() {
    let mut setup = Setup::default();
    setup.systems[0].offset[0] = 100.0;
    setup.systems[2].rotation = 90.0;
    let options = Options {
        setup: Arc::new(setup),
        ..Options::default()
    };
    let run = |body: &str| interpret(&format!("G21 G0 Y0 Z0\n{body}\nM2"), options.clone()).unwrap();
    let ends = |body: &str| -> Vec<_> {
        let paths = run(body).paths;
        let words = paths.iter().map(|path| path.targets[0].words.axes);
        words
            .map(|axes| [axes[0].unwrap_or(0.0), axes[1].unwrap_or(0.0)])
            .collect()
    };
    assert_eq!(
        ends("X1\nG55 X1\nG500 X2\nG10 L2 P1 X5\nG54 X1")[1..],
        [[101.0, 0.0], [1.0, 0.0], [2.0, 0.0], [6.0, 0.0]]
    );
    let told = |body: &str| -> Vec<_> {
        let notices = run(body).notices;
        notices
            .into_iter()
            .map(|notice| (notice.place.line, notice.text))
            .collect()
    };
    let first = "G54 as it was set at the machine: origin at X100 Y0 Z0 mm, A0 B0 C0 deg".to_owned();
    let turned =
        "G56 as it was set at the machine: origin at X0 Y0 Z0 mm, A0 B0 C0 deg, turned by 90 deg about Z";
    assert_eq!(
        told("X1\nG56 X1\nG54 X1\nG56 X1"),
        [(1, first), (3, turned.to_owned())]
    );
    let program = interpret(
        "G500 G21 G0 X1 Y0\nG55 X1\nG10 L2 P1 X0\nG54 X1\nM2",
        options.clone(),
    )
    .unwrap();
    assert_eq!(program.notices, []);
}

#[test]
fn polar_coordinates_are_about_the_origin_of_the_program() {
    let ends = ends("G0 @10 ^30\n^120\nG91 @-5 ^60\nM2");
    let angles = [(10.0, 30f64), (10.0, 120.0), (5.0, 180.0)];
    for (end, (distance, angle)) in ends.iter().zip(angles) {
        let wanted = [
            distance * angle.to_radians().cos(),
            distance * angle.to_radians().sin(),
        ];
        assert!(
            (0..2).all(|i| (end[i].unwrap() - wanted[i]).abs() < 1e-9),
            "{end:?}"
        );
    }
    // A cycle is repeated along the circle.
    let program = run("F9\nG0 X10 Y0\nG91 G81 ^90 R1 Z-2 L2\nM2").unwrap();
    let xs: Vec<_> = program.paths[2..]
        .iter()
        .filter_map(|path| path.targets[0].words.axes[0])
        .collect();
    assert!(
        (xs[1] - 0.0).abs() < 1e-9 && (xs[2] + 10.0).abs() < 1e-9,
        "{xs:?}"
    );
    assert!(matches!(problem("G0 @1 X2\nM2"), (Problem::ModalGroup { .. }, 1)));
}

#[test]
fn parameters_get_their_values_after_the_block() {
    let x = |x: f64| [Some(x), None, None];
    assert_eq!(ends("#1=5\n#1=7 G0 X#1\nX#1\nM2"), [x(5.0), x(7.0)]);
    assert_eq!(ends("#<a b>=2\n#3=[#<ab>*3]\nG0 X[#3+#<AB>**2]\nM2"), [x(10.0)]);
    assert_eq!(ends("G0 X8\n#1=#5420\nG91 X#1\nM2"), [x(8.0), x(16.0)]);
    assert_eq!(
        problem("G0 X#<nothing>\nM2"),
        (Problem::Undefined("#<nothing>".into()), 1)
    );
    assert_eq!(problem("#5420=1\nM2"), (Problem::ReadOnly("#5420".into()), 1));
    // Whether a name exists in the block that sets it is read in two ways.
    for body in ["#<a>=[exists[#<a>]]", "#<a>=1 G0 X[exists[#<a>]]"] {
        assert_eq!(problem(body), (Problem::ExistsHere("#<a>".into()), 1));
    }
    assert_eq!(ends("#<a>=1\n#<b>=2 G0 X[exists[#<a>]]\nM2"), [x(1.0)]);
}

#[test]
fn expressions_are_those_of_linuxcnc() {
    let value = |text: &str| ends(&format!("G0 Z[1000+{text}]\nM2"))[0][2].unwrap() - 1000.0;
    for (text, expected) in [
        ("[1+2*3]", 7.0),
        ("[2 ** 3 ** 2]", 64.0),
        ("[10-4-3]", 3.0),
        ("[-7 mod 3]", 2.0),
        ("[1 eq 1.000001]", 1.0),
        ("[1 ge 1.000001]", 0.0),
        ("[1 lt 2 and 3 ge 4]", 0.0),
        ("[1 or 0 xor 1]", 0.0),
        ("sqrt[16]", 4.0),
        ("-[2*-3]", 6.0),
        ("atan[1]/[-1]", 135.0),
        ("fix[-2.5]", -3.0),
        ("fup[-2.5]", -2.0),
        ("round[2.5]", 3.0),
        ("exists[#<_nothing>]", 0.0),
        ("acos[0.5]", 60.0),
    ] {
        assert!((value(text) - expected).abs() < 1e-9, "{text}: {}", value(text));
    }
    assert_eq!(problem("G0 X[1/0]\nM2"), (Problem::DivisionByZero, 1));
    assert_eq!(problem("G0 X[1+\nM2"), (Problem::NoValue, 1));
    assert_eq!(
        problem("G0 X[1 foo 2]\nM2"),
        (Problem::UnknownOperator("FOO".into()), 1)
    );
    assert_eq!(
        problem("G0 XFOO[2]\nM2"),
        (Problem::UnknownFunction("FOO".into()), 1)
    );
    assert!(matches!(
        problem("G0 Xsqrt[-1]\nM2"),
        (Problem::Argument { .. }, 1)
    ));
    let deep = format!("G0 X{}1\nM2", "[".repeat(5000));
    assert!(matches!(problem(&deep), (Problem::TooDeep { .. }, 1)));
    assert_eq!(problem(&"()".repeat(500_000)), (Problem::LongLine(10_000), 1));
}

#[test]
fn one_axis_of_a_rotated_system_is_not_sent_home_alone() {
    let turn = "G10 L2 P1 R30\n";
    for body in ["G28 X1", "G28 Y1 Z2", "G30 Y1"] {
        let found = problem(&format!("{turn}{body}\nM2"));
        assert!(matches!(found, (Problem::Impossible { .. }, 2)), "{found:?}");
    }
    for body in ["G28 X1 Y1", "G28 Z1", "G28"] {
        assert!(run(&format!("{turn}{body}\nM2")).is_ok(), "{body}");
    }
    assert!(run("G28 X1\nM2").is_ok());
}

#[test]
fn a_program_that_relies_on_where_the_tip_is_says_so() {
    let setup = Setup {
        start: [5.0, 6.0, 7.0, 0.0, 0.0, 0.0],
        ..Setup::default()
    };
    let options = Options {
        setup: Arc::new(setup),
        ..Options::default()
    };
    let read = |text: &str| interpret(text, options.clone()).unwrap();
    assert_eq!(read("G0 X1\nZ5\nM2").assumes, None);
    let program = read("G0 X1\nG91 Y1\nM2");
    let place = SourcePosition { line: 2, column: 5 };
    assert_eq!(program.assumes, Some((options.setup.start, place)));
    assert_eq!(program.paths[1].targets[0].words.axes[1], Some(7.0));
}

#[derive(Debug)]
struct Swapped;

impl TipAndAxes for Swapped {
    fn tip(&self, axes: &[f64; AXES]) -> [f64; AXES] {
        let [x, y, z, a, b, c] = *axes;
        [y, x, z, a, b, c]
    }

    fn axes(&self, tip: &[f64; AXES]) -> Option<[f64; AXES]> {
        Some(self.tip(tip))
    }
}

#[test]
fn homes_are_of_axes_and_the_tip_is_known_after_them() {
    let setup = Setup {
        homes: [[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [0.0; AXES]],
        kinematics: Some(Arc::new(Swapped)),
        ..Setup::default()
    };
    let options = Options {
        setup: Arc::new(setup),
        ..Options::default()
    };
    let text = "G0 X10 Y20 Z30 A0 B0 C0\nG91 G28 Z5\nG90 G28\nG91 G0 X1\nM2";
    let program = interpret(text, options).unwrap();
    let axes = |i: usize| {
        (
            program.paths[i].targets[0].way == Way::Axes,
            program.paths[i].targets[0].words.axes,
        )
    };
    let none = [None; AXES];
    let z = |z: f64| [None, None, Some(z), None, None, None];
    assert_eq!(axes(1), (false, z(35.0)));
    assert_eq!(axes(2), (true, z(3.0)));
    assert_eq!(axes(3).1, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0].map(Some));
    // X of the tip is Y of the axes here.
    assert_eq!(
        axes(4),
        (false, [Some(3.0), none[1], none[2], none[3], none[4], none[5]])
    );
}
