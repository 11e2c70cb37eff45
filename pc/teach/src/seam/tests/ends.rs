//! Seams that begin after their drawing does, and end before it.

use super::*;

/// A world whose seams begin and end there, which is seen.
fn world(shape: Shape, begin: [f64; 2], end: [f64; 2]) -> World {
    let mut world = World::new(shape, SIGMA);
    (world.begin, world.end) = (begin, end);
    world.shows_ends = true;
    world.kinds = [SeamEnd::Plate, SeamEnd::Tack];
    world
}

/// How far along the seam of `side` from where the drawing begins, in these worlds.
fn along(world: &World, side: usize, foot: &MeasuredSeam) -> f64 {
    let mut s = foot.position.x - 500.0;
    for _ in 0..60 {
        let way = world.foot(side, s + 0.5) - world.foot(side, s - 0.5);
        s += (foot.position - world.foot(side, s)).dot(&way);
    }
    s
}

#[test]
fn the_first_and_the_last_point_are_where_the_seams_begin_and_end() {
    for (shape, begin, end) in [
        (straight as Shape, [0.6, 0.6], [299.3, 299.3]),
        (straight, [3.3, 3.3], [130.0, 130.4]),
        (straight_then_bent, [11.4, 11.1], [262.0, 261.6]),
    ] {
        let mut world = world(shape, begin, end);
        let ended = teach(&mut world, &start(shape, [0.0; 3]), &[]);
        let Ended::SeamEnds { s_mm, ends, .. } = ended else {
            panic!("{ended:?}")
        };
        assert_eq!(ends, [Some(SeamEnd::Plate), Some(SeamEnd::Tack)]);
        let (first, last) = (world.taught[0], *world.taught.last().unwrap());
        assert_eq!(last.s_mm, s_mm);
        for side in 0..2 {
            let [begins, ends] = [&first, &last].map(|point| along(&world, side, &point.feet[side]));
            assert!((begins - begin[side]).abs() < 0.03, "side {side}: {begins}");
            assert!((ends - end[side]).abs() < 0.03, "side {side}: {ends}");
            assert_eq!(first.feet[side].end, Some(world.kinds[side]));
        }
        let inner = &world.taught[1..world.taught.len() - 1];
        assert!(
            inner
                .iter()
                .flat_map(|point| point.feet)
                .all(|foot| foot.end.is_none())
        );
        let (chord, off) = distances(&world);
        assert!(chord <= 0.03 + 2.0 * SIGMA && off <= 2.0 * SIGMA, "{chord} {off}");
        assert!(world.moves < 90, "{}", world.moves);
    }
}

/// Where one side ends far before the other one, both are taught up to there, and only the one is marked.
#[test]
fn a_side_that_goes_on_is_not_marked() {
    let mut world = world(straight, [-9.0, 2.0], [150.0, 200.0]);
    teach(&mut world, &start(straight, [0.0; 3]), &[]);
    let (first, last) = (world.taught[0], *world.taught.last().unwrap());
    assert_eq!(first.feet.map(|foot| foot.end), [None, Some(SeamEnd::Tack)]);
    assert_eq!(last.feet.map(|foot| foot.end), [Some(SeamEnd::Plate), None]);
    for (point, at) in [(first, 2.0), (last, 150.0)] {
        for side in 0..2 {
            let s = along(&world, side, &point.feet[side]);
            assert!((s - at).abs() < 0.03, "side {side}: {s}");
        }
    }
}

/// What moves with the camera, such as glare, is no end.
#[test]
fn an_end_that_does_not_stay_where_it_is_is_none() {
    let mut world = world(straight, [-1e9; 2], [130.0; 2]);
    world.wanders = true;
    let ended = teach(&mut world, &start(straight, [0.0; 3]), &[]);
    let Ended::SeamEnds { s_mm, ends, .. } = ended else {
        panic!("{ended:?}")
    };
    assert_eq!(ends, [None; 2]);
    assert!((129.0 - 0.1..=130.1).contains(&s_mm), "{s_mm}");
    assert!(
        world
            .taught
            .iter()
            .all(|point| point.feet.iter().all(|foot| foot.end.is_none()))
    );
}

/// Ends are not looked for where the seams go on to both ends of the drawing.
#[test]
fn ends_beyond_the_drawing_do_not_count() {
    let mut world = world(straight, [-0.5; 2], [LENGTH + 0.5; 2]);
    assert_eq!(teach(&mut world, &start(straight, [0.0; 3]), &[]), Ended::Drawn);
    assert!(
        world
            .taught
            .iter()
            .all(|point| point.feet.iter().all(|foot| foot.end.is_none()))
    );
    let last = world.taught.last().unwrap();
    assert!((last.s_mm - LENGTH).abs() < 0.1, "{}", last.s_mm);
}
