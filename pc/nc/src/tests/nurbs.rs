//! G5.2 and G6.2, block by block.

use super::*;

fn nurbs(body: &str) -> (NurbsWay, Target, usize) {
    let program = run(body).unwrap();
    let path = &program.paths[2];
    match &path.targets[0].way {
        Way::Nurbs(way) => ((**way).clone(), path.targets[0].clone(), path.targets.len()),
        _ => panic!("a NURBS: {path:?}"),
    }
}

fn weights(way: &NurbsWay) -> Vec<f64> {
    way.points.iter().map(|point| point.weight).collect()
}

/// The example of LinuxCNC's manual, and a line after it.
#[test]
fn g5_2_takes_control_points_up_to_g5_3() {
    let body = "F10\nG5.2 P1 L3\nX0 Y1 P1\nX2 Y2 P1\nX2 Y0 P1\nX0 Y0 P2\nG5.3\nG1 X5\nM2";
    let (way, target, targets) = nurbs(body);
    assert_eq!((way.order, targets), (3, 2));
    assert_eq!(weights(&way), [1.0, 1.0, 1.0, 1.0, 2.0]);
    assert_eq!(way.knots, [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0]);
    assert_eq!(way.points[0].position, [None; 3]);
    assert_eq!(way.points[2].position, [Some(2.0), Some(2.0), None]);
    assert_eq!(target.words.axes[..3], [Some(0.0), Some(0.0), None]);
    assert_eq!(target.place, SourcePosition { line: 6, column: 1 });
    assert_eq!(target.feed, Some(FeedRate::PerMinute(10.0)));
}

#[test]
fn g5_2_may_begin_with_its_second_point_and_weighs_1_if_it_does_not_say() {
    let (way, target, _) = nurbs("F10\nG5.2 X1 Y0 L4\nX2 Y1\nG5.2 X3 Y1 P0.5 C30\nG5.3\nM2");
    assert_eq!(way.order, 4);
    assert_eq!(weights(&way), [1.0, 1.0, 1.0, 0.5]);
    assert_eq!(way.knots, [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
    assert_eq!(target.words.axes[5], Some(30.0));
    // Events wait for the curve, and are not lost in it.
    let program = run("F10\nM62 P0\nG5.2 P2\nX1 Y0\nX2 Y2\nG5.3\nM2").unwrap();
    assert_eq!(program.paths[2].events[0].with_target, 0);
}

#[test]
fn g6_2_takes_knots_and_ends_with_the_last_of_them() {
    let body = "F10\nG6.2 P3 K0 X0 Y0 R1\nK0 X0 Y5 Z1 R2\nK0 X5 Y5\nK1\nK1\nK1\nG1 X9\nM2";
    let (way, target, targets) = nurbs(body);
    assert_eq!((way.order, targets), (3, 2));
    assert_eq!(weights(&way), [1.0, 2.0, 1.0]);
    assert_eq!(way.knots, [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    assert_eq!(way.points[2].position, [Some(5.0), Some(5.0), None]);
    assert_eq!(target.words.axes[..3], [Some(5.0), Some(5.0), Some(1.0)]);
    // The first point may be left out, and G6.3 may say once more that this was all.
    let body = "F10\nG6.2 K0\nK0 X0 Y5\nK0 X5 Y5\nK0 X9 Y9\nK1\nK1\nK1\nK1\nG6.3\nM2";
    let (way, ..) = nurbs(body);
    assert_eq!((way.order, way.points[0].position), (4, [None; 3]));
}

#[test]
fn no_motion_goes_on_after_a_curve() {
    let curve = "F10\nG5.2 P1\nX1 Y0\nX2 Y2\nG5.3\n";
    assert_eq!(problem(&format!("{curve}X5\nM2")), (Problem::NoMotion, 6));
    assert_eq!(
        problem(&format!("{curve}G5.3\nM2")),
        (Problem::NothingToClose("G5.3"), 6)
    );
    assert_eq!(problem("G6.3\nM2"), (Problem::NothingToClose("G6.3"), 1));
}

#[test]
fn what_does_not_belong_to_a_curve_is_named() {
    let (open, close) = ("G5.2", "G5.3");
    let line = 6;
    let unfinished = Problem::NurbsOpen { open, line, close };
    assert_eq!(problem("F10\nG5.2 P1\nX1 Y0\nG1 X5\nM2"), (unfinished.clone(), 4));
    assert_eq!(problem("F10\nG5.2 P1\nM62 P0\nM2"), (unfinished.clone(), 3));
    assert_eq!(problem("F10\nG5.2 P1\nX1 Y0\nM2"), (unfinished.clone(), 4));
    assert_eq!(problem("F10\nG5.2 P1\nX1 Y0"), (unfinished, 3));
    let foreign = |word: &str, code| Problem::NotInNurbs {
        word: word.to_owned(),
        code,
    };
    assert_eq!(problem("F10\nG5.2 P1\nX1 Y0 F20\nM2"), (foreign("F", "G5.2"), 3));
    assert_eq!(
        problem("F10\nG5.2 P1\nX1 Y0\nG5.3 X2\nM2"),
        (foreign("X", "G5.3"), 4)
    );
    assert_eq!(
        problem("F10\nG6.2 P3 K0\nK0 X1\nK0 X2\nK1 R2\nM2"),
        (foreign("R", "a knot on its own"), 5)
    );
    assert_eq!(problem("F10\nG5.2 X1 Y1 Z1\nG5.3\nM2"), (Problem::FlatNurbs, 2));
    assert_eq!(
        problem("F10\nG18\nG5.2 X1 Y1\nG5.3\nM2"),
        (Problem::NurbsPlane, 3)
    );
    let (code, word) = ("a control point of G5.2", "Y");
    assert_eq!(
        problem("F10\nG5.2 P1\nX1\nG5.3\nM2"),
        (Problem::Missing { code, word }, 3)
    );
    let word = "C".to_owned();
    assert_eq!(
        problem("F10\nG5.2 P1\nX1 Y0 C5\nX2 Y2\nG5.3\nM2"),
        (Problem::TurnInside { word }, 3)
    );
    assert_eq!(
        problem("G5.2 P1\nX1 Y0\nX2 Y2\nG5.3\nM2"),
        (Problem::NoFeed("G5.2"), 1)
    );
}

#[test]
fn weights_orders_points_and_knots_are_checked_where_they_stand() {
    let value = |body: &str| match run(body).unwrap_err() {
        NcError {
            place,
            problem: Problem::Value { word, value, .. },
        } => (word, value, place.line - 4, place.column),
        other => panic!("{other}"),
    };
    let word = |w: &str| w.to_owned();
    assert_eq!(value("F10\nG5.2 P0\nM2"), (word("P"), 0.0, 2, 6));
    assert_eq!(value("F10\nG5.2 L1\nM2"), (word("L"), 1.0, 2, 6));
    assert_eq!(value("F10\nG5.2 L7\nM2"), (word("L"), 7.0, 2, 6));
    assert_eq!(value("F10\nG6.2 P2.5 K0\nM2"), (word("P"), 2.5, 2, 6));
    assert_eq!(value("F10\nG6.2 P3 K0\nK-1 X1\nM2"), (word("K"), -1.0, 3, 1));
    let knots = |knots: [f64; 8]| {
        let mut body = "F10\nG6.2 P3 ".to_owned();
        for (i, knot) in knots.into_iter().enumerate() {
            body += &format!("K{knot}");
            body += &if i < 5 {
                format!(" X{i}\n")
            } else {
                "\n".to_owned()
            };
        }
        body + "M2"
    };
    assert!(run(&knots([0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0])).is_ok());
    let [start, end, inside, empty] = [
        [0.0, 0.0, 1.0, 1.0, 2.0, 3.0, 3.0, 3.0],
        [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 4.0],
        [0.0, 0.0, 0.0, 0.0, 2.0, 3.0, 3.0, 3.0],
        [0.0; 8],
    ]
    .map(|list| value(&knots(list)).2);
    assert_eq!((start, end, inside, empty), (4, 7, 3, 3));
    let (points, order) = (2, 3);
    let few = Problem::FewPoints { points, order };
    assert_eq!(problem("F10\nG5.2 P1\nX1 Y0\nG5.3\nM2"), (few.clone(), 4));
    assert_eq!(problem("F10\nG6.2 P3 K0\nK0 X1\nK1\nM2"), (few, 4));
    let (points, knots) = (3, 4);
    let few = Problem::FewKnots { knots, points, order };
    let body = "F10\nG6.2 P3 K0\nK0 X1\nK0 X2\nK1\nG6.3\nM2";
    assert_eq!(problem(body), (few, 6));
    assert_eq!(
        run(body).unwrap_err().to_string(),
        "line 10, column 1: a NURBS of order 3 with 3 control points has 6 knots, not 4: 3 blocks with K alone \
         follow the last point"
    );
    assert_eq!(
        problem("F10\nG6.2 P3 K0\nK0 X1\nK0 X2\nK1\nK1 X3\nM2"),
        (Problem::PointAfterKnots, 6)
    );
    let (code, word) = ("every block of a G6.2", "K");
    assert_eq!(
        problem("F10\nG6.2 P3 K0\nX1\nM2"),
        (Problem::Missing { code, word }, 3)
    );
}
