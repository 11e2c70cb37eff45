//! Seams at the edges of what is followed by pictures, on simulated boards; `cargo run --release -p system-tests --example
//! seam-range` welds along all of them.

use job::JobError;
use shared::state::TrackerFault;
use system_tests::range::{BESIDE, FOLLOWED, LEFT, weld_by_pictures, with_beam_on};
use system_tests::{SeamShape, assert_on_seam};
use world::simulated::SimulatedBoards;

#[track_caller]
fn follows(seams: &[(&str, SeamShape, f64)], speed: f64) {
    for (name, shape, limit_mm) in seams {
        println!("{name}");
        let ended = weld_by_pictures(&mut SimulatedBoards::default(), *shape, speed);
        assert_on_seam(&ended, *limit_mm);
    }
}

#[test]
fn sines_of_1_mm_with_0_3_mm_of_height_are_followed_at_9_m_per_min() {
    follows(&FOLLOWED[1..2], 9.0);
}

#[test]
fn slopes_of_5_percent_with_2_percent_of_height_are_followed_at_9_m_per_min() {
    follows(&FOLLOWED[4..5], 9.0);
}

#[test]
fn a_seam_3_mm_beside_and_2_mm_high_or_low_is_found_from_every_corner() {
    // Each of these is at two corners; the example has all of them on both sides.
    for ((name, shape), speed) in BESIDE[1..3].iter().zip([9.0, 5.0]) {
        println!("{name}");
        assert_on_seam(
            &weld_by_pictures(&mut SimulatedBoards::default(), *shape, speed),
            0.03,
        );
    }
}

#[test]
fn a_seam_that_is_nowhere_ends_the_job_before_a_beam_goes_on_and_its_side_is_named() {
    let ended = weld_by_pictures(&mut SimulatedBoards::default(), |_| [0.5, 0.0, -6.0, 0.0], 9.0);
    let Some(
        error @ JobError::SeamNotFound {
            sides: [false, true], ..
        },
    ) = &ended.error
    else {
        panic!("{:?}", ended.error);
    };
    assert!(error.to_string().contains("side 2"), "{error}");
    assert!(ended.evaluation.ticks.iter().all(|tick| tick.beams == [false; 2]));
}

#[test]
fn beams_are_off_before_a_spot_is_a_tenth_beside_a_seam_that_jumps() {
    for ((name, shape), speed) in [(LEFT[1], 9.0), (LEFT[5], 5.0)] {
        let ended = weld_by_pictures(&mut SimulatedBoards::default(), shape, speed);
        let worst = with_beam_on(&ended);
        println!("{name}: {worst:.4?} mm, {:?}", ended.error);
        assert!(
            matches!(
                ended.error,
                Some(JobError::Tracker(
                    TrackerFault::BesideSeam { slide: 0 | 1, .. } | TrackerFault::LostSeam { side: 0, .. }
                ))
            ),
            "{name}: {:?}",
            ended.error
        );
        assert!(worst.iter().all(|mm| *mm <= 0.1), "{name}: {worst:.4?} mm");
    }
}
