//! Corners of a program on simulated boards.

use super::*;
use shared::protocol::MotionSample;

/// Samples of the motion board on a rectangle of 20 mm by 10 mm at 20 mm/s, and the evaluation.
fn rectangle(mode: &str) -> (Vec<MotionSample>, Ended) {
    let body =
        format!("G43.4\nG0 X600 Y500 Z150 B-2.5 C0\nG0 Z50\n{mode}\nF1200\nG1 X620\nY510\nX600\nY500\nM2\n");
    let mut samples = Vec::new();
    let mut simulated = SimulatedBoards::new("stir-gantry").unwrap();
    let mut boards = TappedBoards {
        boards: &mut simulated,
        on_sample: |_: &mut dyn Boards, sample: &MotionSample| {
            if sample.path_id == 3 {
                samples.push(*sample);
            }
        },
    };
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../machines/stir-gantry.toml");
    let machine = MachineFile::read(std::path::Path::new(file)).unwrap();
    let ended = run_on(&mut boards, &machine, &body, None, &mut NoOperator).unwrap();
    assert!(ended.error.is_none(), "{mode}: {:?}", ended.error);
    (samples, ended)
}

/// Rounded within the tolerance the path continues at its corners, and takes less time than with a stop at
/// each.
#[test]
fn a_rectangle_with_a_tolerance_passes_its_corners_without_a_stop() {
    let (rounded, ended) = rectangle("G64 P0.05");
    let (stopped, exact) = rectangle("G61.1");
    let slowest = |samples: &[MotionSample]| {
        let inside = samples.iter().filter(|sample| (1.0..59.0).contains(&sample.s_mm));
        inside
            .map(|sample| sample.speed_mm_s)
            .fold(f64::INFINITY, f64::min)
    };
    assert!(slowest(&rounded) > 1.0, "{} mm/s", slowest(&rounded));
    assert!(slowest(&stopped) < 1e-3, "{} mm/s", slowest(&stopped));
    let ticks = |samples: &[MotionSample]| samples.len() as f64;
    assert!(
        ticks(&rounded) < 0.95 * ticks(&stopped),
        "{} {}",
        rounded.len(),
        stopped.len()
    );
    // The true tip, with what the drives lag.
    for (ended, limit) in [(&ended, 0.05), (&exact, 0.02)] {
        let seen = ended.evaluation.max_contour_error_mm.unwrap();
        assert!(seen < limit, "{seen} mm");
        assert_eq!(ended.evaluation.unknown_ticks, 0);
        let late = ended.report.motion_s - ended.report.planned_motion_s;
        assert!((-0.01..0.01).contains(&late), "{late} s");
    }
}
