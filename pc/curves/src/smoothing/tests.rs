//! Smooth paths against the lines that they are of, by what they are at many places.

use super::search::AHEAD;
use super::{SHARE, SHORTEST, Smoother, smooth};
use nalgebra::Vector3;
use proptest::prelude::*;
use shared::geometry::{Arc, Line, Turn};
use shared::trajectory::{CHANNELS, Cubic, Element, Join, SHAPED, Shape, Tolerance};

const TOLERANCE: Tolerance = Tolerance {
    position: 0.05,
    attitude: 1e-3,
};
const ACCELERATION: f64 = 2000.0;
const FREELY: f64 = f64::INFINITY;

type Point = [f64; CHANNELS];

/// Lines through `points` (mm, rad), the last one to a stop.
fn lines(points: &[Point], feed: f64) -> Vec<Element> {
    let pairs = points.windows(2).zip(1..);
    let line = |(pair, number): (&[Point], u32)| {
        let position = |point: &Point| Vector3::new(point[0], point[1], point[2]);
        let line = Line::new(position(&pair[0]), position(&pair[1])).expect("a line");
        let length = line.length();
        Element {
            line: number,
            shape: Shape::Line(line),
            rest: std::array::from_fn(|i| Cubic::linear(pair[0][SHAPED + i], pair[1][SHAPED + i], length)),
            length,
            feed,
            join: if number as usize + 1 == points.len() {
                Join::Stop
            } else {
                Join::Blend(TOLERANCE)
            },
        }
    };
    pairs.map(line).collect()
}

fn flat(points: impl IntoIterator<Item = [f64; 2]>) -> Vec<Point> {
    let point = |[x, y]: [f64; 2]| {
        let mut point = [0.0; CHANNELS];
        (point[0], point[1]) = (x, y);
        point
    };
    points.into_iter().map(point).collect()
}

fn smoothed(elements: &[Element], most: f64) -> Vec<Element> {
    smooth(
        elements.iter().map(|element| (element.clone(), most)),
        ACCELERATION,
    )
}

/// Path points at evenly spaced places of each element, with their path lengths.
fn places(elements: &[Element], parts: u32) -> Vec<(f64, Point)> {
    let mut start = 0.0;
    let mut places = Vec::new();
    for element in elements {
        for i in 0..=parts {
            let s = element.length * f64::from(i) / f64::from(parts);
            places.push((start + s, element.at(s).value));
        }
        start += element.length;
    }
    places
}

/// The channels of `elements` at path length `s`.
fn at(elements: &[Element], s: f64) -> Point {
    let mut rest = s;
    for element in elements {
        if rest <= element.length {
            return element.at(rest).value;
        }
        rest -= element.length;
    }
    let last = elements.last().expect("some");
    last.at(last.length).value
}

/// Largest differences of two paths at the same path length: of the position, and of a channel of attitude.
fn off(elements: &[Element], from: &[Element]) -> [f64; 2] {
    let mut most = [0.0_f64; 2];
    let mut see = |a: &Point, b: &Point| {
        let norm = |from: usize| {
            (from..from + 3)
                .map(|i| (a[i] - b[i]).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        most = [most[0].max(norm(0)), most[1].max(norm(3)).max(norm(6))];
    };
    for (s, value) in places(elements, 12) {
        see(&value, &at(from, s));
    }
    for (s, value) in places(from, 4) {
        see(&value, &at(elements, s));
    }
    most
}

/// Numbers from −1 to 1 that look random.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A polyline in space with lines of some `length` that turn by some `turn`, and a head that turns with them.
fn wander(seed: u64, count: usize, length: f64, turn: f64, spin: f64) -> Vec<Point> {
    let mut random = random(seed);
    let mut point = [0.0; CHANNELS];
    let mut points = vec![point];
    let (mut heading, mut climb) = (0.0, 0.0);
    for _ in 0..count {
        heading += turn * random();
        climb = 0.9 * climb + 0.2 * turn * random();
        let step = length * (1.05 + random());
        point[0] += step * f64::cos(heading);
        point[1] += step * f64::sin(heading);
        point[2] += step * climb;
        for channel in &mut point[3..9] {
            *channel += spin * step * random();
        }
        points.push(point);
    }
    points
}

fn arc(count: u32, radius: f64, sweep: f64, noise: f64) -> Vec<Point> {
    let mut random = random(7);
    let point = |i: u32| {
        let angle = sweep * f64::from(i) / f64::from(count);
        let r = radius + noise * random();
        [r * f64::sin(angle), radius - r * f64::cos(angle)]
    };
    flat((0..=count).map(point))
}

/// Elements follow one another without a gap, and without a corner but where `lines` have one just there.
fn check_joins(elements: &[Element], lines: &[Element]) {
    let corners: Vec<f64> = lines
        .iter()
        .scan(0.0, |s, line| {
            *s += line.length;
            Some(*s)
        })
        .collect();
    let mut s = 0.0;
    for pair in elements.windows(2) {
        s += pair[0].length;
        let (end, start) = (pair[0].at(pair[0].length), pair[1].at(0.0));
        let corner = corners.iter().any(|corner| (corner - s).abs() < 1e-9);
        for i in 0..CHANNELS {
            assert!((end.value[i] - start.value[i]).abs() < 1e-9, "a gap at {s}");
            assert!(
                corner || (end.first[i] - start.first[i]).abs() < 1e-7,
                "a corner at {s}"
            );
        }
    }
}

fn length(elements: &[Element]) -> f64 {
    elements.iter().map(|element| element.length).sum()
}

proptest! {
    #[test]
    fn the_smooth_path_stays_within_its_share_of_the_tolerance(
        seed in any::<u64>(),
        count in 2_usize..700,
        length_log in -2.5..0.5_f64,
        turn in 0.0..2.5_f64,
        spin in 0.0..0.02_f64,
        feed_log in 0.0..3.0_f64,
    ) {
        let points = wander(seed, count, 10_f64.powf(length_log), turn, spin);
        let lines = lines(&points, 10_f64.powf(feed_log));
        let elements = smoothed(&lines, FREELY);
        let [position, attitude] = off(&elements, &lines);
        prop_assert!(position <= SHARE * TOLERANCE.position + 1e-9, "{position} mm");
        prop_assert!(attitude <= SHARE * TOLERANCE.attitude + 1e-9, "{attitude} rad");
        check_joins(&elements, &lines);
        let (end, value) = (points[count], at(&elements, f64::INFINITY));
        for i in 0..CHANNELS {
            prop_assert!((value[i] - end[i]).abs() < 1e-9);
            prop_assert!((elements[0].at(0.0).value[i] - points[0][i]).abs() < 1e-12);
        }
        prop_assert!((length(&elements) - length(&lines)).abs() < 1e-9);
        prop_assert_eq!(elements.last().map(|element| element.join), Some(Join::Stop));
        for element in &elements {
            prop_assert!(element.length > 1e-9);
            for i in 0..=8 {
                let first = element.at(element.length * f64::from(i) / 8.0).first;
                let speed = Vector3::new(first[0], first[1], first[2]).norm() * element.feed;
                prop_assert!(speed <= lines[0].feed * (1.0 + 1e-9), "{speed} mm/s");
            }
        }
    }

    #[test]
    fn what_comes_much_later_changes_nothing(seed in any::<u64>(), turn in 0.0..1.0_f64, other in any::<u64>()) {
        let points = wander(seed, 900, 0.05, turn, 0.0);
        let whole = lines(&points, 100.0);
        let mut changed = whole.clone();
        let same = 600;
        let later = lines(&wander(other, 300, 0.3, 1.5, 0.0), 20.0);
        changed.truncate(same);
        for mut line in later {
            let Shape::Line(shape) = line.shape else { unreachable!() };
            let by = Vector3::from_row_slice(&points[same][..3]);
            line.shape = Shape::Line(Line::new(shape.start() + by, shape.end() + by).expect("a line"));
            changed.push(line);
        }
        let known: f64 = whole[..same - AHEAD].iter().map(|line| line.length).sum();
        let [a, b] = [whole, changed].map(|lines| {
            let mut s = 0.0;
            let begins = |element: &Element| {
                s += element.length;
                s < known
            };
            smoothed(&lines, FREELY).into_iter().take_while(begins).collect::<Vec<_>>()
        });
        prop_assert!(a.len() > 2);
        prop_assert_eq!(a, b);
    }

    #[test]
    fn elements_come_while_lines_go_in(seed in any::<u64>(), turn in 0.0..1.0_f64) {
        let lines = lines(&wander(seed, 3000, 0.05, turn, 0.0), 100.0);
        let mut smoother = Smoother::new(ACCELERATION);
        let (mut behind, mut given) = (0.0_f64, 0.0);
        let mut gone = std::collections::VecDeque::new();
        for line in &lines {
            gone.push_back(line.length);
            smoother.push(line.clone(), FREELY, false);
            while let Some(element) = smoother.pop() {
                given += element.length;
            }
            while gone.front().is_some_and(|length| *length <= given) {
                given -= gone.pop_front().expect("some");
            }
            behind = behind.max(gone.len() as f64);
            prop_assert!(smoother.run.len() <= AHEAD);
        }
        prop_assert!(behind <= AHEAD as f64);
    }

    #[test]
    fn an_element_begins_at_every_mark_and_at_every_other_feed(seed in any::<u64>(), every in 1_usize..40) {
        let mut lines = lines(&wander(seed, 300, 0.02, 0.4, 0.0), 100.0);
        for (i, line) in lines.iter_mut().enumerate() {
            line.feed = if (i / 50) % 2 == 0 { 100.0 } else { 40.0 };
        }
        let mut smoother = Smoother::new(ACCELERATION);
        for (i, line) in lines.iter().enumerate() {
            smoother.push(line.clone(), FREELY, i % every == 0);
        }
        smoother.finish();
        let elements: Vec<_> = std::iter::from_fn(|| smoother.pop()).collect();
        let starts: Vec<f64> = elements.iter().scan(0.0, |s, element| {
            let start = *s;
            *s += element.length;
            Some(start)
        }).collect();
        let mut s = 0.0;
        for (i, line) in lines.iter().enumerate() {
            if i % every == 0 || i % 50 == 0 {
                let begins = starts.iter().position(|start| (start - s).abs() <= SHORTEST);
                prop_assert!(begins.is_some(), "nothing begins at line {i}, {s} mm");
            }
            let middle = s + 0.5 * line.length;
            let there = starts.partition_point(|start| *start <= middle) - 1;
            let [tip, feed] = [elements[there].feed, line.feed];
            prop_assert!(tip <= feed && tip > 0.3 * feed, "{tip} mm/s where {feed} is programmed");
            prop_assert!(elements[there].line <= line.line);
            s += line.length;
        }
    }
}

#[test]
fn a_circle_of_short_lines_is_gone_round_in_few_elements_and_bends_evenly() {
    let (radius, noise) = (20.0, 0.001);
    let lines = lines(&arc(4000, radius, 6.0, noise), 1000.0);
    let elements = smoothed(&lines, FREELY);
    assert!(elements.len() < 150, "{} elements", elements.len());
    // But near the ends, where nothing may move.
    let inner = &elements[elements.len() / 4..elements.len() * 3 / 4];
    for element in inner {
        for part in [0.0, 0.5, 1.0] {
            let second = element.at(part * element.length).second;
            let bend = Vector3::new(second[0], second[1], second[2]).norm() * radius;
            assert!(
                (0.6..1.5).contains(&bend),
                "bent {bend} times as much as the circle"
            );
        }
    }
}

#[test]
fn a_zigzag_inside_the_tolerance_becomes_straight() {
    let points = (0..2000).map(|i| [0.05 * f64::from(i), if i % 2 == 0 { 0.02 } else { -0.02 }]);
    let lines = lines(&flat(points), 100.0);
    let elements = smoothed(&lines, FREELY);
    assert!(elements.len() < 150, "{} elements", elements.len());
    for (s, value) in places(&elements, 4) {
        let inside = (5.0..length(&lines) - 5.0).contains(&s);
        assert!(!inside || value[1].abs() < 1e-3, "{} mm beside it", value[1]);
    }
    // Which it does not if it may not be off by so much.
    assert!(smoothed(&lines, 0.005).len() > 1000);
}

#[test]
fn corners_between_long_lines_are_left_to_the_planner() {
    let lines = lines(
        &flat([[0.0, 0.0], [30.0, 0.0], [30.0, 20.0], [10.0, 25.0], [10.0, 50.0]]),
        50.0,
    );
    assert_eq!(smoothed(&lines, FREELY), lines);
}

#[test]
fn between_long_lines_and_short_ones_corners_keep_their_room() {
    // A long line, a sharp corner, and on along many short ones, by an arc.
    let mut points = flat([[-10.0, -20.0], [-0.2, -20.0], [-0.2, 0.0]]);
    points.extend(arc(200, 5.0, 3.0, 0.0));
    let lines = lines(&points, 50.0);
    let elements = smoothed(&lines, FREELY);
    assert_eq!(elements[0], lines[0]);
    assert_eq!(elements[1], lines[1]);
    assert!(matches!(elements[2].shape, Shape::Line(_)));
    assert!(
        (elements[2].length - 0.1).abs() < 1e-9,
        "half of it is the corner's"
    );
    assert!(elements.len() < 60);
}

#[test]
fn what_may_not_be_smoothed_stays_as_it_is() {
    let exact = lines(&wander(3, 200, 0.05, 0.5, 0.001), 100.0);
    assert_eq!(smoothed(&exact, 0.0), exact);
    // Arcs in between, and what stops.
    let circle = Arc::about_centre(
        Vector3::zeros(),
        Vector3::new(2.0, 0.0, 0.0),
        Vector3::new(1.0, 0.0, 0.0),
        Vector3::z(),
        Turn::Clockwise,
    )
    .expect("an arc");
    let arc = Element {
        shape: Shape::Arc(circle),
        length: circle.length(),
        ..exact[0].clone()
    };
    let mut elements = vec![arc.clone(), arc.clone()];
    elements[1].join = Join::Stop;
    elements.push(arc);
    assert_eq!(smoothed(&elements, FREELY), elements);
}

#[test]
fn numbers_out_of_all_proportion_are_passed_on_as_they_are() {
    let good = lines(&wander(5, 20, 0.05, 0.5, 0.0), 100.0);
    let with = |change: &dyn Fn(&mut Element)| {
        let mut bad = good.clone();
        bad.iter_mut().for_each(change);
        bad
    };
    for bad in [
        with(&|line| line.length = f64::INFINITY),
        with(&|line| line.feed = f64::INFINITY),
        with(&|line| line.feed = 0.0),
        with(&|line| line.feed = -1.0),
    ] {
        assert_eq!(smoothed(&bad, FREELY), bad);
    }
    assert_eq!(
        smoothed(&with(&|line| line.length = f64::NAN), FREELY).len(),
        good.len()
    );
    // These are sound, and come to an end.
    for feed in [1e-9, 1e300] {
        let slow = with(&|line| line.feed = feed);
        assert!((length(&smoothed(&slow, FREELY)) - length(&slow)).abs() < 1e-9);
    }
}
