//! A path that leads where the machine cannot be: it stops before that, inside all limits.

use super::bench::{self, Bench};
use nalgebra::Vector3;
use shared::geometry::{Line, Pose};
use shared::io::AXES;
use shared::kinematics::KinematicsError;
use shared::trajectory::{
    BoardPlanner, CHANNELS, Cubic, Element, Join, ReferenceError, SHAPED, Shape, Tolerance, Unreachable, Way,
};

const TICK: f64 = 1e-3;
const FEED: f64 = 20.0;
/// The pin leans more from there on \[mm\], and is as far over as it may be after that.
const LEANS_FROM: f64 = 40.0;

/// A line along X, the tool as at home; then on, leaning over to three times the travel of B.
fn leaning(bench: &Bench) -> Vec<Element> {
    let start = bench.kinematics.forward(&bench.home);
    let mut over = bench.home;
    over[4] = -30_f64.to_radians();
    let over = bench.kinematics.forward(&over);
    let element = |line: u32, from: f64, to: f64, end: &Pose, join: Join| {
        let at = |way: f64| start.position + Vector3::new(way, 0.0, 0.0);
        let mut rest = [Cubic::default(); CHANNELS - SHAPED];
        for i in 0..3 {
            rest[i] = Cubic::linear(start.tangent[i], end.tangent[i], to - from);
            rest[3 + i] = Cubic::linear(start.normal[i], end.normal[i], to - from);
        }
        Element {
            line,
            shape: Shape::Line(Line::new(at(from), at(to)).unwrap()),
            rest,
            length: to - from,
            feed: FEED,
            join,
        }
    };
    let blend = Join::Blend(Tolerance {
        position: 0.05,
        attitude: 1e-3,
    });
    vec![
        element(7, 0.0, LEANS_FROM, &start, blend),
        element(8, LEANS_FROM, 100.0, &over, Join::Stop),
    ]
}

/// Runs until the planner says that it cannot continue; the positions until then, and where that was.
fn run(mut hand: impl FnMut(&mut BoardPlanner, usize)) -> (Vec<[f64; AXES]>, f64, Unreachable) {
    let bench = bench::stir_gantry();
    let mut planner = Box::new(BoardPlanner::new());
    planner.start(&bench.limits, bench.space, 0.0, &bench.home);
    for element in leaning(&bench) {
        planner.push(element).unwrap();
    }
    let mut positions = vec![bench.home; 3];
    let mut s = 0.0;
    for tick in 0..30_000 {
        hand(&mut planner, tick);
        match planner.tick(&bench.kinematics) {
            Ok(output) => {
                s = output.along.s;
                positions.push(output.axes.position);
            }
            Err(place) => return (positions, s, place),
        }
    }
    panic!("neither stopped nor told after 30 s: at {s} mm");
}

fn assert_stopped((positions, s, place): &(Vec<[f64; AXES]>, f64, Unreachable)) {
    let bench = bench::stir_gantry();
    let out_of_range = ReferenceError::Kinematics(KinematicsError::OutOfRange { axis: 4 });
    assert_eq!((place.line, place.source), (8, out_of_range));
    assert!(place.s > LEANS_FROM && *s < place.s, "{s} mm, {place}");
    for window in positions.windows(4) {
        for axis in 0..AXES {
            let p = [0, 1, 2, 3].map(|i: usize| window[i][axis]);
            let a = (p[2] - 2.0 * p[1] + p[0]).abs() / (TICK * TICK);
            let j = (p[3] - 3.0 * p[2] + 3.0 * p[1] - p[0]).abs() / (TICK * TICK * TICK);
            let limits = (bench.limits.acceleration[axis], bench.limits.jerk[axis]);
            assert!(
                a <= 1.01 * limits.0 && j <= 1.05 * limits.1,
                "axis {axis}: {a}, {j}"
            );
        }
    }
    let last = positions.len() - 1;
    let moved = (0..AXES).map(|axis| (positions[last][axis] - positions[last - 2][axis]).abs());
    assert!(moved.fold(0.0, f64::max) < 1e-6, "told in motion");
    // As near as the distance of nodes.
    let leaning = positions[last][4].to_degrees();
    assert!((-10.0..=-9.0).contains(&leaning), "{leaning}°");
}

#[test]
fn the_machine_rests_before_it_and_then_tells_the_line() {
    assert_stopped(&run(|_, _| {}));
}

#[test]
fn it_stops_there_with_any_override_and_after_holds_and_ways_back() {
    for factor in [0.1, 0.5, 2.0] {
        assert_stopped(&run(|planner, _| planner.set_override(factor)));
    }
    for hold in [300, 2000, 2300, 2500, 2700] {
        assert_stopped(&run(|planner, tick| {
            planner.go(match tick.checked_sub(hold) {
                Some(0..800) => Way::Hold,
                Some(800..1600) => Way::Back,
                _ => Way::Forward,
            });
        }));
    }
}

#[test]
fn nothing_is_told_while_the_machine_is_held_there() {
    let mut held = 0;
    let told = run(|planner, tick| {
        planner.go(if tick < 6000 { Way::Hold } else { Way::Forward });
        if (1..2000).contains(&tick) {
            planner.go(Way::Forward);
        }
        held = tick;
    });
    assert!(held >= 6000, "told at {held}");
    assert_stopped(&told);
}
