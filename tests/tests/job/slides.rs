//! Slides that the PC moves.

use job::tests::*;

/// A session on `boards` that is ready for a path.
fn ready(boards: &mut dyn Boards, then: impl FnOnce(&mut Session)) {
    let (machine, never) = (machine(), AtomicBool::new(false));
    let program = interpret(PROGRAM, Options::default()).unwrap();
    let job = job(&machine, &program, None);
    let mut silent = Silent;
    let mut session = Session::begin(boards, &machine, &job.surroundings, &never, &mut silent).unwrap();
    make_ready(&mut session, &job).unwrap();
    then(&mut session);
}

#[test]
fn slides_are_where_they_were_sent_and_what_they_went_through_is_recorded() {
    ready(&mut SimulatedBoards::default(), |session| {
        let before = session.record.tracker().len();
        let target = [3.0, -1.0, 0.5, -11.0];
        session.move_slides(target).unwrap();
        for (there, target) in session.slides_mm().iter().zip(target) {
            assert!((there - target).abs() <= 0.005, "{there} instead of {target} mm");
        }
        let newest = &session.record.tracker()[before..];
        assert!(
            newest
                .iter()
                .any(|sample| (-9.0..-2.0).contains(&sample.slides_mm[3]))
        );
    });
}

#[test]
fn a_place_beyond_the_travel_is_refused_by_name() {
    ready(&mut SimulatedBoards::default(), |session| {
        let refused = session.move_slides([0.0, 0.0, 0.0, 12.5]).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "the tracker board refused: slide V2 cannot go to 12.500 mm: its travel is -12.000 to 12.000 mm"
        );
    });
}

#[test]
fn a_slide_that_stays_away_is_named() {
    let mut boards = Troubled::new(Trouble::SlidesStand, 0.0);
    ready(&mut boards, |session| {
        let [u1, v1, u2, v2] = session.slides_mm();
        let away = session.move_slides([u1, v1 + 2.0, u2, v2]).unwrap_err();
        assert_eq!(
            away.to_string(),
            "slide V1 is still 2.000 mm away from where it was sent; look at its drive and its dead band"
        );
    });
}
