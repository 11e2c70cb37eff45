//! What a motor that tripped is taken for, by how it moved.

use commission::{Course, Stopped};

/// A motor that should stand, and then go with this speed, as `moves` makes of where it should be and of the time.
fn course(speed: f64, mut moves: impl FnMut(f64, f64) -> f64) -> Course {
    let mut course = Course::default();
    for tick in 0..1500 {
        let time = f64::from(tick) * 1e-3;
        let sent = speed * (time - 1.2).max(0.0);
        let position = moves(sent, time);
        course.position.push(position);
        course.error.push((sent - position).abs());
    }
    course
}

#[test]
fn a_motor_that_runs_away_stands_still_swings_or_is_late_is_told_apart() {
    for speed in [10.0, -10.0] {
        let of =
            |moves: &mut dyn FnMut(f64, f64) -> f64| Stopped::of(&course(speed, moves), Some(speed), 1e-4);
        assert_eq!(of(&mut |sent, _| -0.5 * sent), Some(Stopped::Reversed));
        for side in [1.0, -1.0] {
            // From rest, before anything was asked for.
            let away = |_, time: f64| side * 1e-3 * (30.0 * (time - 1.3)).exp().min(100.0);
            let mut course = course(0.0, away);
            course.position.truncate(1450);
            course.error.truncate(1450);
            assert_eq!(Stopped::of(&course, Some(speed), 1e-4), Some(Stopped::Reversed));
        }
        assert_eq!(
            of(&mut |_, time| 1e-4 * (time * 50.0).sin()),
            Some(Stopped::Still)
        );
        assert_eq!(of(&mut |sent, _| 0.6 * sent), Some(Stopped::Late));
        assert_eq!(of(&mut |sent, _| 0.1 * sent), Some(Stopped::Late));
        // It goes on where it should stop.
        let mut weak = course(speed, |sent, _| sent);
        let last = weak.error.len() - 100;
        let over = weak.error.iter_mut().skip(last).enumerate();
        over.for_each(|(tick, error)| *error = 5e-3 * tick as f64);
        assert_eq!(Stopped::of(&weak, Some(speed), 1e-4), Some(Stopped::Weak));
        let swings = of(&mut |sent, time| sent + 0.5 * (std::f64::consts::TAU * 8.0 * time).sin());
        assert!(
            matches!(swings, Some(Stopped::Swings { hz }) if (hz - 8.0).abs() < 0.5),
            "{swings:?}"
        );
    }
    assert_eq!(Stopped::of(&Course::default(), Some(10.0), 1e-4), None);
}

/// The last moments of a motor on its way, whose mark was found.
#[track_caller]
fn on_its_way(course: &Course) -> Option<Stopped> {
    Stopped::of(course, None, 1e-4)
}

#[test]
fn a_motor_that_goes_to_the_other_side_is_reversed_only_while_its_mark_is_searched_for() {
    let lags = course(10.0, |sent, _| 0.6 * sent);
    assert_eq!(Stopped::of(&lags, Some(-10.0), 1e-4), Some(Stopped::Reversed));
    assert_eq!(on_its_way(&lags), Some(Stopped::Late));
}

#[test]
fn a_motor_that_was_late_before_it_stood_still_has_no_dead_grating() {
    // It goes 5 mm and stands, while it is sent on.
    let stands = |late: f64| {
        let mut course = course(10.0, |sent, _| sent);
        for (tick, (position, error)) in course.position.iter_mut().zip(&mut course.error).enumerate() {
            let went = 0.01 * tick.min(500) as f64;
            (*position, *error) = (went, late + 1e-3 * tick.saturating_sub(500) as f64);
        }
        course
    };
    assert_eq!(on_its_way(&stands(0.5)), Some(Stopped::Late));
    assert_eq!(on_its_way(&stands(0.01)), Some(Stopped::Still));
    // After a trip there is no error any more: what counts is how it stood before.
    let mut tripped = stands(0.01);
    tripped.position.extend([5.0; 200]);
    tripped.error.extend([0.0; 200]);
    assert_eq!(on_its_way(&tripped), Some(Stopped::Still));
}

#[test]
fn mechanics_swing_faster_than_a_loop_with_a_slow_drive() {
    let swings = |hz: f64| {
        let mut course = course(10.0, |sent, _| sent);
        // Of a gantry how far it is off is known, and not where it is.
        let errors = course.error.iter_mut().enumerate();
        errors
            .for_each(|(tick, error)| *error = (std::f64::consts::TAU * hz * 1e-3 * tick as f64).sin().abs());
        on_its_way(&course)
    };
    let found = swings(7.0);
    assert!(
        matches!(found, Some(Stopped::Swings { hz }) if (hz - 7.0).abs() < 0.5),
        "{found:?}"
    );
    assert_eq!(swings(2.5), Some(Stopped::Late));
}
