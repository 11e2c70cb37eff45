//! Several feeds on one path.

use super::*;

/// Changes of the speed of a path: where, and mm/s.
fn steps(path: &PlannedPath) -> Vec<(f64, f64)> {
    path.steps.iter().map(|step| (step.s, step.velocity)).collect()
}

#[test]
fn feeds_change_at_their_blocks() {
    let body = "F3000\nG1 X1100\nM62 P0\nF1200 X1150\nX1200\nM63 P0\nF4800\nX1400";
    let path = &plan(body).unwrap()[1];
    assert_eq!(path.limits.velocity, 50.0);
    let seen = steps(path);
    for ((s, v), (wanted_s, wanted_v)) in seen.iter().zip([(100.0, 20.0), (200.0, 80.0)]) {
        assert!(
            (s - wanted_s).abs() < 1e-9 && (v - wanted_v).abs() < 1e-9,
            "{seen:?}"
        );
    }
    let in_order = path.events.windows(2).all(|pair| pair[0].s_mm <= pair[1].s_mm);
    assert!(in_order && path.events.len() == 2, "{:?}", path.events);
    let mut s = 0.0;
    for element in path.legs().map(|leg| leg.unwrap().element) {
        let feed = [(0.0, 50.0), (99.9, 20.0), (199.9, 80.0)]
            .into_iter()
            .rfind(|step| step.0 <= s);
        assert!(
            (element.feed - feed.unwrap().1).abs() < 1e-9,
            "{} at {s}",
            element.feed
        );
        s += element.length;
    }
}

/// On a path with arcs, too, and from piece to piece.
#[test]
fn pieces_begin_with_the_feed_of_their_first_block() {
    let body = "F600\nG1 X1100\nF1200\nG3 X1200 Y1100 J100\nF1800\nG1 X1100\nF2400 X1000";
    let paths = plan(body).unwrap();
    let [_, first, second] = &paths[..] else {
        panic!("cut at the corner")
    };
    assert_eq!((first.limits.velocity, second.limits.velocity), (10.0, 30.0));
    assert_eq!(steps(first).iter().map(|step| step.1).collect::<Vec<_>>(), [20.0]);
    assert_eq!(steps(second), [(100.0, 40.0)]);
}

#[test]
fn a_feed_that_the_axes_cannot_follow_is_named_by_its_block() {
    let found = too_fast(plan(
        "F600\nG1 X1010 Y1010\nF40000\nX1300 Y1300\nF600\nX1310 Y1310",
    ));
    assert!(
        found.place.line == 6 && (found.feed - 40_000.0).abs() < 1e-6,
        "{found}"
    );
}

#[test]
fn one_speed_does_not_replace_several_feeds() {
    let program = |body: &str| {
        let text = format!("G43.4\nG0 X1000 Y1000 Z100 A0 B0 C0\n{body}\nM2");
        interpret(&text, Options::default()).unwrap()
    };
    let planner = planner();
    let plan =
        |body: &str| planner.program(&program(body), &[100.0, 100.0, 900.0, 0.0, 0.0, 0.0], Some(40.0));
    assert_eq!(
        plan("F600\nG1 X1100\nF900 X1200").unwrap_err().to_string(),
        "line 4, column 4: the path has several feeds, which one speed cannot replace; leave the speed out, or write one F"
    );
    let paths = plan("F600\nG1 X1100\nG0 Z150\nF900 G1 X1200").unwrap();
    assert_eq!((paths[1].limits.velocity, paths[3].limits.velocity), (40.0, 40.0));
}

#[test]
fn more_changes_than_the_board_holds_are_refused() {
    let blocks = |count: usize| -> String {
        (1..=count).fold("G1\n".to_owned(), |text, i| {
            text + &format!("F{} X{}\n", 600 + i, 1000 + i)
        })
    };
    let path = &plan(&blocks(MAX_EVENTS + 1)).unwrap()[1];
    assert_eq!((path.steps.len(), path.events.len()), (MAX_EVENTS, 0));
    let error = plan(&blocks(MAX_EVENTS + 2)).unwrap_err();
    assert!(
        matches!(error, PathError::TooManyEvents { place: SourcePosition { line: 4, .. }, events } if events == MAX_EVENTS + 1)
    );
}

#[test]
fn a_feed_with_which_a_block_takes_more_than_a_day_is_a_slip() {
    for body in [
        "F0.00001\nG1 X1100",
        "G93 G1 X1100 F0.0001",
        "F1000 G64\nG1 X1100\nF0.00001 X1200",
    ] {
        let error = plan(body).unwrap_err();
        assert!(matches!(error, PathError::TooSlow { .. }), "{body}: {error}");
        assert!(error.to_string().starts_with("line "), "{error}");
    }
}

#[test]
fn what_bounds_a_feed_is_told_and_a_feed_up_to_it_is_planned() {
    let paths = plan("F3000\nG1 X1080 Y1060").unwrap();
    assert_eq!(paths[0].bound, None, "a rapid is as fast as it can be");
    let bound = paths[1].bound.unwrap();
    // X takes 0.8 of the speed.
    assert_eq!((bound.axis, bound.quantity), ("X", "speed"));
    assert!((bound.largest_mm_s - 333.333 / 0.8).abs() < 1e-3, "{bound:?}");
    let feed = |part: f64| {
        plan(&format!(
            "F{:.3}\nG1 X1080 Y1060",
            part * 60.0 * bound.largest_mm_s
        ))
    };
    assert_eq!(feed(0.9999).unwrap()[1].too_fast, TooFast::default());
    assert_eq!(too_fast(feed(1.0001)).axis, "X");
}
