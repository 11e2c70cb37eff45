//! Cases whose answer is known.

use super::bench::{self, Bench, Frame};
use super::judge::judge;
use super::run::{Act, Acts, Sample, run, run_with};
use nalgebra::Vector3;
use shared::geometry::{Arc, Line, Turn};
use shared::trajectory::{CHANNELS, Cubic, Element, Join, SHAPED, Shape, Tolerance, Way};
use std::f64::consts::SQRT_2;

const TICK: f64 = 1e-3;
/// Limits of X Y Z (mm, s).
const ACCELERATION: f64 = 2000.0;
const JERK: f64 = 200_000.0;
const TOLERANCE: Tolerance = Tolerance {
    position: 0.05,
    attitude: 1e-3,
};
/// Ticks of the output filter under these limits: 1.3·A/J.
const FILTER: usize = 13;

fn machine() -> Bench {
    bench::axes(&Frame {
        acceleration: ACCELERATION,
        ramp: ACCELERATION / JERK,
        rotary: 30.0,
        velocity: None,
        path: None,
        tolerance: TOLERANCE.position,
    })
}

fn element(shape: Shape, length: f64, feed: f64) -> Element {
    Element {
        line: 1,
        shape,
        rest: [Cubic::default(); CHANNELS - SHAPED],
        length,
        feed,
        join: Join::Blend(TOLERANCE),
    }
}

/// Lines through points, from the origin; the last ends in a stop.
fn lines(points: &[[f64; 3]], feed: f64) -> Vec<Element> {
    let mut from = Vector3::zeros();
    let mut elements = Vec::new();
    for point in points {
        let line = Line::new(from, Vector3::from(*point)).expect("a line");
        elements.push(element(Shape::Line(line), line.length(), feed));
        from = line.end();
    }
    closed(elements)
}

fn closed(mut elements: Vec<Element>) -> Vec<Element> {
    elements.last_mut().expect("an element").join = Join::Stop;
    elements
}

/// About (0, radius, 0), from the origin.
fn circle(radius: f64, feed: f64) -> Element {
    let (zero, centre) = (Vector3::zeros(), Vector3::new(0.0, radius, 0.0));
    let arc = Arc::about_centre(zero, zero, centre, Vector3::z(), Turn::CounterClockwise).expect("a circle");
    element(Shape::Arc(arc), arc.length(), feed)
}

/// A run without a fault.
fn sound(elements: &[Element], acts: &Acts) -> Vec<Sample> {
    let machine = machine();
    let samples = run(&machine, elements, acts).expect("a run to the end");
    let faults = judge(&machine, elements, TOLERANCE, &samples).faults();
    assert!(faults.is_empty(), "{}", faults.join("; "));
    samples
}

fn position(sample: &Sample) -> Vector3<f64> {
    Vector3::from_column_slice(&sample.output.axes.position[..3])
}

/// Seconds in which something moves.
fn moving(samples: &[Sample]) -> f64 {
    let moves = samples
        .windows(2)
        .filter(|pair| position(&pair[0]) != position(&pair[1]));
    moves.count() as f64 * TICK
}

#[test]
fn a_line_takes_the_time_of_a_trapezoid_and_of_the_filter() {
    for (length, feed) in [(50.0, 100.0), (200.0, 400.0), (10.0, 20.0), (300.0, 1e5)] {
        let samples = sound(&lines(&[[length, 0.0, 0.0]], feed), &vec![]);
        let trapezoid = match feed * feed / ACCELERATION < length {
            true => length / feed + feed / ACCELERATION,
            false => 2.0 * (length / ACCELERATION).sqrt(),
        };
        let expected = trapezoid + (FILTER - 1) as f64 * TICK;
        let time = moving(&samples);
        // It keeps one part in a hundred of the acceleration in reserve.
        assert!(
            time >= expected - 2.0 * TICK && time <= 1.01 * expected + 5.0 * TICK,
            "{length} mm at {feed} mm/s: {time} s, not {expected} s"
        );
    }
}

/// Two axes that change over at a corner may overlap by (48ε/(√2·J))^⅓ within the tolerance ε where only the jerk is
/// limited.
#[test]
fn axes_overlap_at_corners() {
    const CORNERS: usize = 10;
    let single = moving(&sound(&lines(&[[10.0, 0.0, 0.0]], 100.0), &vec![]));
    let stair = |k: usize| [10.0 * (k / 2 + k % 2) as f64, 10.0 * (k / 2) as f64, 0.0];
    let points: Vec<_> = (1..=CORNERS + 1).map(stair).collect();
    let time = moving(&sound(&lines(&points, 100.0), &vec![]));
    let overlap = ((CORNERS + 1) as f64 * single - time) / CORNERS as f64;
    let most = (48.0 * TOLERANCE.position / (SQRT_2 * JERK)).cbrt();
    assert!(
        overlap > 0.75 * most && overlap < most + 3.0 * TICK,
        "{overlap} s at a corner, at most {most} s"
    );
}

#[test]
fn a_circle_is_as_fast_as_the_axes_allow() {
    let radius = 10.0;
    let samples = sound(
        &closed(vec![circle(radius, 1000.0), circle(radius, 1000.0)]),
        &vec![],
    );
    // In between, where both axes share it, there may be more than v²/R = A.
    let (low, high) = (
        (ACCELERATION * radius).sqrt(),
        (SQRT_2 * ACCELERATION * radius).sqrt(),
    );
    for sample in &samples[samples.len() * 2 / 5..samples.len() * 3 / 5] {
        let speed = sample.output.along.v;
        assert!(
            speed > 0.98 * low && speed < high,
            "{speed} mm/s, not {low} to {high}"
        );
    }
}

#[test]
fn a_circle_is_smaller_by_what_the_filter_cuts() {
    let (radius, feed) = (10.0, 100.0);
    let samples = sound(&closed(vec![circle(radius, feed)]), &vec![]);
    // v²T²/(24R); of a mean over so few ticks it is a little less.
    let cut = feed * feed / radius * ((FILTER * FILTER - 1) as f64) * TICK * TICK / 24.0;
    for sample in &samples[samples.len() * 2 / 5..samples.len() * 3 / 5] {
        let off = radius - (position(sample) - Vector3::new(0.0, radius, 0.0)).norm();
        assert!((off / cut - 1.0).abs() < 0.01, "{off} mm smaller, not {cut}");
    }
}

/// Dense and not smooth: what is ahead matters.
fn wave() -> Vec<Element> {
    let at = |k: u32| {
        let x = f64::from(k);
        [x, 3.0 * (0.4 * x).sin() + 0.3 * f64::from(k % 3), 0.0]
    };
    lines(&(1..120).map(at).collect::<Vec<_>>(), 80.0)
}

#[test]
fn elements_that_come_one_by_one_take_as_long_as_all_at_once() {
    let [one, all] = [1, usize::MAX].map(|credits| {
        let machine = machine();
        let samples = run_with(&machine, &wave(), &vec![], credits, &[]).expect("a run to the end");
        moving(&samples)
    });
    assert!(
        (one / all - 1.0).abs() < 0.02,
        "{one} s one by one, {all} s at once"
    );
}

#[test]
fn what_is_there_runs_without_a_stop() {
    let samples = sound(&wave(), &vec![]);
    let from = samples.iter().position(|sample| sample.output.along.v > 0.0);
    let to = samples.iter().rposition(|sample| sample.output.along.v > 0.0);
    for sample in &samples[from.expect("it moves")..to.expect("it moves")] {
        assert!(
            sample.output.along.v > 0.0,
            "a stop at s = {}",
            sample.output.along.s
        );
    }
}

#[test]
fn a_queue_that_runs_dry_stops_on_the_path_and_goes_on() {
    for begin in [0, 3, 7] {
        let samples = sound(&wave(), &vec![(begin, Act::Starve(2500))]);
        let rests = samples.iter().filter(|sample| sample.output.at_rest).count();
        assert!(rests > 500, "{rests} ticks at rest after {begin}");
    }
}

#[test]
fn a_hold_in_a_long_line_stops_where_the_limits_say() {
    let feed = 400.0;
    let elements = lines(&[[1000.0, 0.0, 0.0]], feed);
    let brakes = feed * feed / (2.0 * ACCELERATION) + feed * ACCELERATION / (2.0 * JERK);
    for begin in (900..1000).step_by(9) {
        let samples = sound(&elements, &vec![(begin, Act::Go(Way::Hold))]);
        let from = begin as usize;
        let rest = samples[from..]
            .iter()
            .position(|sample| sample.output.at_rest)
            .expect("it stops");
        let way = samples[from + rest].output.along.s - samples[from].output.along.s;
        let latency = (way - brakes) / feed / TICK;
        assert!(latency > 0.0 && latency < 80.0, "{latency} ticks");
    }
}

#[test]
fn an_override_changes_the_speed_of_a_line() {
    let (feed, factor) = (100.0, 2.0);
    let acts = vec![
        (700, Act::Override(0.25)),
        (700, Act::Override(factor)),
        (699, Act::Go(Way::Forward)),
    ];
    let samples = sound(&lines(&[[1000.0, 0.0, 0.0]], feed), &acts);
    for (tick, expected) in [(690, feed), (1390, 0.25 * feed), (2090, factor * feed)] {
        let speed = samples[tick].output.along.v;
        assert!(
            (speed / expected - 1.0).abs() < 1e-6,
            "{speed} mm/s at tick {tick}, not {expected}"
        );
    }
}

#[test]
fn the_way_back_goes_through_the_same_points() {
    let arc = |start: Vector3<f64>, end: Vector3<f64>, centre: Vector3<f64>, turn: Turn| {
        let arc = Arc::about_centre(start, end, centre, Vector3::z(), turn).expect("an arc");
        element(Shape::Arc(arc), arc.length(), 20.0)
    };
    let at = |x: f64, y: f64| Vector3::new(x, y, 0.0);
    let elements = closed(vec![
        arc(
            at(0.0, 0.0),
            at(10.0, 10.0),
            at(0.0, 10.0),
            Turn::CounterClockwise,
        ),
        arc(at(10.0, 10.0), at(20.0, 20.0), at(20.0, 10.0), Turn::Clockwise),
    ]);
    let forward = sound(&elements, &vec![]);
    let samples = sound(
        &elements,
        &vec![(900, Act::Go(Way::Back)), (600, Act::Go(Way::Forward))],
    );
    let back = samples
        .windows(2)
        .filter(|pair| pair[1].output.along.s < pair[0].output.along.s)
        .count();
    assert!(back > 300, "{back} ticks back");
    for sample in &samples {
        let distance = |pair: &[Sample]| {
            let (from, to) = (position(&pair[0]), position(&pair[1]));
            let way = to - from;
            let part = ((position(sample) - from).dot(&way) / way.norm_squared().max(1e-30)).clamp(0.0, 1.0);
            (position(sample) - from - way * part).norm()
        };
        let nearest = forward.windows(2).map(distance).fold(f64::INFINITY, f64::min);
        // Speed is another, and with it what the filter cuts: v²T²/24R.
        assert!(
            nearest < 1e-3,
            "{nearest} mm off at s = {}",
            sample.output.along.s
        );
    }
}
