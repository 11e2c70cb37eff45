//! Short programs, run to their end and judged by the positions that come out.

extern crate std;
use super::limits::Bounds;
use super::*;
use crate::geometry::{Arc, Line, Turn};
use crate::kinematics::{AxisLimits, DualBeamConfig, KinematicsConfig};
use crate::trajectory::{CHANNELS, Cubic, Join, SHAPED, Shape, Tolerance};
use nalgebra::Vector3;
use std::boxed::Box;
use std::vec::Vec;

const T: f64 = 0.001;
const ACCELERATION: f64 = 2000.0;
const JERK: f64 = 200_000.0;
const TOLERANCE: f64 = 0.05;

type Positions = Vec<[f64; AXES]>;

fn limits() -> PlanLimits {
    PlanLimits {
        velocity: [1000.0; AXES],
        acceleration: [ACCELERATION; AXES],
        jerk: [JERK; AXES],
        path_acceleration: 1e5,
        path_jerk: JERK,
        tolerance: TOLERANCE,
    }
}

fn any_machine() -> Kinematics {
    let config = KinematicsConfig::DualBeamGantry(DualBeamConfig {
        o1_mm: [0.0; 3],
        o2_mm: [0.0; 3],
        o3_mm: [0.0, 0.0, -100.0],
    });
    config.build(&[AxisLimits::NOT_FITTED; AXES]).unwrap()
}

fn element(shape: Shape, length: f64, feed: f64) -> Element {
    Element {
        line: 1,
        shape,
        rest: [Cubic::constant(0.0); CHANNELS - SHAPED],
        length,
        feed,
        join: Join::Blend(Tolerance {
            position: TOLERANCE,
            attitude: 1e-3,
        }),
    }
}

fn polyline(corners: &[[f64; 3]], feed: f64) -> Vec<Element> {
    let points = corners.iter().map(|corner| Vector3::from(*corner));
    let mut elements: Vec<Element> = points
        .clone()
        .zip(points.skip(1))
        .map(|(from, to)| {
            element(
                Shape::Line(Line::new(from, to).unwrap()),
                (to - from).norm(),
                feed,
            )
        })
        .collect();
    elements.last_mut().unwrap().join = Join::Stop;
    elements
}

/// Runs `elements` in axis space from rest; `hand` may do something before every tick.
fn run(elements: &[Element], mut hand: impl FnMut(&mut Planner<64, 256>, usize)) -> (Positions, Vec<Output>) {
    let machine = any_machine();
    let mut planner = Box::new(Planner::<64, 256>::new());
    let first = elements[0].at(0.0).value;
    let start: [f64; AXES] = core::array::from_fn(|axis| first[axis]);
    planner.start(&limits(), PathSpace::Axes, 0.0, &start);
    let length: f64 = elements.iter().map(|element| element.length).sum();
    let (mut coming, mut outputs) = (elements.iter(), Vec::new());
    for tick in 0..20_000 {
        while planner.room() > 0
            && let Some(element) = coming.next()
        {
            planner.push(element.clone()).unwrap();
        }
        hand(&mut planner, tick);
        let output = planner.tick(&machine).unwrap();
        outputs.push(output);
        if output.at_rest && (output.along.s - length).abs() < 1e-9 {
            let rest = |position| core::iter::repeat_n(position, 3);
            let moved = outputs.iter().map(|output| output.axes.position);
            let positions = rest(start).chain(moved).chain(rest(output.axes.position));
            return (positions.collect(), outputs);
        }
    }
    panic!("not at the end after 20 s, but at {:?}", outputs.last());
}

/// Largest acceleration and jerk of an axis, as shares of their limits.
fn peaks(positions: &Positions) -> [f64; 2] {
    let (mut a, mut j) = (0.0, 0.0);
    for window in positions.windows(4) {
        for axis in 0..AXES {
            let p = [0, 1, 2, 3].map(|i: usize| window[i][axis]);
            a = libm::fmax(a, libm::fabs(p[2] - 2.0 * p[1] + p[0]) / (T * T) / ACCELERATION);
            j = libm::fmax(
                j,
                libm::fabs(p[3] - 3.0 * p[2] + 3.0 * p[1] - p[0]) / (T * T * T) / JERK,
            );
        }
    }
    [a, j]
}

fn assert_kept(positions: &Positions) {
    let [a, j] = peaks(positions);
    assert!(a <= 1.01 && j <= 1.05, "acceleration {a}, jerk {j}");
}

const SQUARE: [[f64; 3]; 5] = [
    [0.0, 0.0, 0.0],
    [10.0, 0.0, 0.0],
    [10.0, 10.0, 0.0],
    [0.0, 10.0, 0.0],
    [0.0, 0.0, 0.0],
];

#[test]
fn corners_are_rounded_inside_the_tolerance_and_no_limit_is_passed() {
    let (positions, _) = run(&polyline(&SQUARE, 400.0), |_, _| {});
    assert_kept(&positions);
    let cut = |corner: [f64; 3]| {
        let distances = positions
            .iter()
            .map(|p| libm::hypot(p[0] - corner[0], p[1] - corner[1]));
        distances.fold(f64::INFINITY, f64::min)
    };
    for corner in &SQUARE[1..4] {
        let cut = cut(*corner);
        // Not a stop: it is cut, but not by more than allowed.
        assert!(cut > 0.005 && cut <= TOLERANCE, "cut by {cut}");
    }
    let end = positions.last().unwrap();
    assert!(end.iter().all(|axis| axis.abs() < 1e-12), "{end:?}");
}

#[test]
fn a_line_takes_the_time_of_its_trapezoid_and_one_filter() {
    // 100 mm/s after 50 ms; 20 mm.
    let (positions, _) = run(&polyline(&[[0.0; 3], [20.0, 0.0, 0.0]], 100.0), |_, _| {});
    let moving = positions.windows(2).filter(|pair| pair[0] != pair[1]).count() as f64 * T;
    let filter = Bounds::build(&limits()).filter;
    let trapezoid = 20.0 / 100.0 + 100.0 / ACCELERATION;
    let late = moving - trapezoid - filter;
    assert!((-0.002..0.006).contains(&late), "{late} s late");
    assert_kept(&positions);
}

#[test]
fn a_circle_is_as_fast_as_the_acceleration_across_allows() {
    let (centre, start) = (Vector3::new(10.0, 0.0, 0.0), Vector3::zeros());
    let arc = Arc::about_centre(start, start, centre, Vector3::z(), Turn::CounterClockwise).unwrap();
    let mut circle = element(Shape::Arc(arc), arc.length(), 1000.0);
    circle.join = Join::Stop;
    let (positions, outputs) = run(&[circle], |_, _| {});
    assert_kept(&positions);
    // Each axis has its limit to itself: v²/R is it, where one axis has all of the acceleration.
    let fastest = outputs.iter().map(|output| output.along.v).fold(0.0, f64::max);
    let share = fastest * fastest / 10.0 / ACCELERATION;
    assert!((0.9..1.45).contains(&share), "{share}");
    for position in &positions {
        let off = libm::hypot(position[0] - 10.0, position[1]) - 10.0;
        assert!(off.abs() <= TOLERANCE, "{off} mm off the circle");
    }
}

/// The rounding of thousands of nodes, every time to the same side, does not make a stop two places.
#[test]
fn the_machine_stops_once_where_a_path_of_thousands_of_nodes_stops() {
    let (start, at) = (Vector3::zeros(), 2500.0);
    for turn in [Turn::CounterClockwise, Turn::Clockwise] {
        let arc = Arc::about_centre(start, start, Vector3::x() * 200.0, Vector3::z(), turn).unwrap();
        let mut circle = element(Shape::Arc(arc), arc.length(), 50.0);
        circle.join = Join::Stop;
        let machine = any_machine();
        let mut planner = Box::new(Planner::<64, 256>::new());
        planner.start(&limits(), PathSpace::Axes, at, &[0.0; AXES]);
        for circle in [circle.clone(), circle.clone()] {
            planner.push(circle).unwrap();
        }
        let end = at + arc.length() + arc.length();
        let ticks = (0..60_000).map(|_| planner.tick(&machine).unwrap());
        let last = ticks.take_while(|output| output.along.s.is_finite() && !output.at_rest);
        let last = last.last().unwrap();
        assert!((last.along.s - end).abs() < 1e-6, "{last:?}");
    }
}

#[test]
fn a_hold_stops_on_the_path_and_back_leads_over_the_same_points() {
    let line = polyline(&[[0.0; 3], [60.0, 30.0, 0.0]], 100.0);
    let mut ways = Vec::new();
    let (positions, outputs) = run(&line, |planner, tick| {
        let way = match tick {
            300..700 => Way::Hold,
            700..900 => Way::Back,
            _ => Way::Forward,
        };
        planner.go(way);
        ways.push(way);
    });
    assert_kept(&positions);
    assert!(
        positions.iter().all(|p| (p[1] - 0.5 * p[0]).abs() < 1e-9),
        "off the line"
    );
    let held = &outputs[699];
    assert!(
        held.at_rest && held.along.v == 0.0 && held.along.s < 60.0,
        "{held:?}"
    );
    // Within the way that the limits need, and what was under way when the hold came.
    let braked = held.along.s - outputs[300].along.s;
    assert!(braked < 100.0 * (0.5 * 0.06 + 0.1), "{braked} mm to stop");
    assert!(outputs[899].along.s < held.along.s - 2.0, "did not go back");
    assert!(outputs.iter().all(|output| output.along.s > -1e-9));
}

#[test]
fn a_hold_at_any_time_around_a_stop_ends_when_told() {
    let mut lines = polyline(&[[0.0; 3], [5.0, 0.0, 0.0], [5.0, 5.0, 0.0]], 50.0);
    lines[0].join = Join::Stop;
    for hold in 40..260 {
        let (positions, _) = run(&lines, |planner, tick| {
            planner.go(if (hold..hold + 300).contains(&tick) {
                Way::Hold
            } else {
                Way::Forward
            });
        });
        assert_kept(&positions);
    }
}

#[test]
fn an_override_changes_the_speed_without_passing_a_limit() {
    let line = polyline(&[[0.0; 3], [100.0, 0.0, 0.0]], 50.0);
    for (factor, wanted) in [(0.4, 20.0), (1.6, 80.0)] {
        let (positions, outputs) = run(&line, |planner, tick| {
            planner.set_override(if tick < 300 { 1.0 } else { factor })
        });
        assert_kept(&positions);
        let later = &outputs[900];
        assert!((later.along.v - wanted).abs() < 0.02 * wanted, "{later:?}");
    }
}

#[test]
fn a_queue_that_runs_dry_stops_on_the_path_and_goes_on_later() {
    let corners: Vec<[f64; 3]> = (0..=40)
        .map(|k| [f64::from(k), libm::sin(0.3 * f64::from(k)), 0.0])
        .collect();
    let elements = polyline(&corners, 100.0);
    let machine = any_machine();
    let mut planner = Box::new(Planner::<64, 256>::new());
    planner.start(&limits(), PathSpace::Axes, 0.0, &[0.0; AXES]);
    let mut positions = std::vec![[0.0; AXES]; 3];
    let (mut coming, mut stood) = (elements.iter(), 0);
    let length: f64 = elements.iter().map(|element| element.length).sum();
    for tick in 0..10_000 {
        // Twenty elements, nothing for a second, then the rest.
        let open = if tick == 0 {
            20
        } else if tick > 1000 {
            64
        } else {
            0
        };
        for element in coming.by_ref().take(open.min(planner.room())) {
            planner.push(element.clone()).unwrap();
        }
        let output = planner.tick(&machine).unwrap();
        stood += usize::from(tick < 1000 && output.at_rest);
        positions.push(output.axes.position);
        if tick > 1000 && output.at_rest && (output.along.s - length).abs() < 1e-9 {
            positions.extend([output.axes.position; 3]);
            assert!(stood > 100, "never stood: {stood}");
            return assert_kept(&positions);
        }
    }
    panic!("not at the end");
}

#[test]
fn what_does_not_fit_is_refused_and_nothing_changes() {
    let mut planner = Box::new(Planner::<2, 64>::new());
    planner.start(&limits(), PathSpace::Axes, 0.0, &[0.0; AXES]);
    let parts = polyline(&SQUARE, 10.0);
    let mut unsound = parts[0].clone();
    unsound.feed = 0.0;
    assert_eq!(planner.push(unsound), Err(PushError::Unsound { line: 1 }));
    planner.push(parts[0].clone()).unwrap();
    let gap = PushError::Gap {
        line: 1,
        distance: 10.0,
    };
    assert_eq!(planner.push(parts[2].clone()), Err(gap));
    planner.push(parts[1].clone()).unwrap();
    assert_eq!(planner.push(parts[2].clone()), Err(PushError::Full));
}

/// At a hundredth of the feed the nodes are seconds apart; what is asked for does not wait for the next of them.
#[test]
fn what_is_asked_for_at_a_crawl_is_done_at_once() {
    let line = polyline(&[[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]], 12.0);
    let at = |output: &[Output], tick: usize| output[tick].along.v;
    let (positions, outputs) = run(&line, |planner, tick| match tick {
        0 => planner.set_override(0.0065),
        700 => planner.set_override(1.0),
        _ => {}
    });
    assert_kept(&positions);
    assert!(at(&outputs, 1000) > 11.9, "raised: {} mm/s", at(&outputs, 1000));
    let (positions, outputs) = run(&line, |planner, tick| match tick {
        0 => planner.set_override(0.0065),
        700 => planner.go(Way::Hold),
        1000 => planner.go(Way::Forward),
        1200 => planner.set_override(1.0),
        _ => {}
    });
    assert_kept(&positions);
    assert_eq!(at(&outputs, 900), 0.0, "held");
}
