//! Which move of the six axes takes the most off the slides (mathematics 0.7).

use nalgebra::{Matrix4x3, Vector2, Vector3, Vector4};
use shared::geometry::{Pose, PoseOffset};
use shared::io::SLIDES;
use shared::tracking::frames::Heads;

/// What the slides would have to move for the spots to stay, for each unit along M, along N and about T: the negative
/// of C_1 and C_2 of mathematics 0.7, rows U1 V1 U2 V2, for slides at `slides` \[mm\].
fn response(heads: &Heads, slides: &[f64; SLIDES]) -> Matrix4x3<f64> {
    let pose = tool();
    let mut rows = Matrix4x3::zeros();
    for side in heads.sides() {
        let (u, v) = (2 * side, 2 * side + 1);
        let head = heads.spot(&pose, side);
        let spot = head.point(0.0, slides[u], slides[v]);
        for freedom in 0..3 {
            let mut unit = [0.0; 3];
            unit[freedom] = 1.0;
            let moved = PoseOffset::of(unit).velocity_at(&pose, &spot);
            rows[(u, freedom)] = -moved.dot(&head.u);
            rows[(v, freedom)] = -moved.dot(&head.v);
        }
    }
    rows
}

/// Pose of the tool in its own frame.
fn tool() -> Pose {
    Pose {
        position: Vector3::zeros(),
        tangent: Vector3::x(),
        normal: Vector3::z(),
    }
}

/// Where slides that stand at `slides` (U1, V1, U2, V2) and keep their spots stand after the pose has moved by
/// `offset` \[mm\].
pub(super) fn slides_after(heads: &Heads, slides: &[f64; SLIDES], offset: &PoseOffset) -> [f64; SLIDES] {
    let (before, after) = (tool(), offset.beside(&tool()));
    let mut moved = [0.0; SLIDES];
    for side in heads.sides() {
        let (u, v) = (2 * side, 2 * side + 1);
        let spot = heads.spot(&before, side).point(0.0, slides[u], slides[v]);
        (_, moved[u], moved[v]) = heads.spot(&after, side).coordinates(&spot);
    }
    moved
}

/// The move of the pose after which slides that stand at `slides` (U1, V1, U2, V2) \[mm\] and keep their spots are as
/// near to zero as they can be: δ = argmin Σ(u² + v²), by the 3×3 normal equations. `turn` is how far it may turn
/// about T \[rad\], lowest and highest: spots are near D, so that a turn moves them little, and the slides alone
/// would ask for much of it. Of a single head, whose two slides do not tell a turn from shifts, both have to be equal.
///
/// `None` where the heads leave a freedom without effect, or a number is not finite.
pub(super) fn recentre(heads: &Heads, slides: &[f64; SLIDES], turn: (f64, f64)) -> Option<PoseOffset> {
    let response = response(heads, slides);
    let rest = Vector4::from_column_slice(slides);
    // The best of the two shifts beside a turn.
    let beside = |turn: f64| {
        let shifts = response.fixed_columns::<2>(0);
        let rest = rest + response.column(2) * turn;
        let shift: Vector2<f64> = shifts.tr_mul(&shifts).try_inverse()? * -shifts.tr_mul(&rest);
        Some(Vector3::new(shift.x, shift.y, turn))
    };
    let best = if turn.0 < turn.1 {
        let free = response.tr_mul(&response).try_inverse()? * -response.tr_mul(&rest);
        let allowed = free.z.clamp(turn.0, turn.1);
        if allowed == free.z { free } else { beside(allowed)? }
    } else {
        beside(turn.1)?
    };
    best.iter()
        .all(|x| x.is_finite())
        .then(|| PoseOffset::of([best.x, best.y, best.z]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::config::HeadConfig;

    const ANY: (f64, f64) = (-10.0, 10.0);

    fn heads() -> Heads {
        HeadConfig {
            included_angle_deg: -60.0,
            working_distance_mm: [4.0, 5.0],
            camera_lead_mm: 10.0,
        }
        .build()
        .unwrap()
    }

    fn after(slides: &[f64; SLIDES], offset: &PoseOffset) -> [f64; SLIDES] {
        slides_after(&heads(), slides, offset)
    }

    fn sum(slides: &[f64; SLIDES]) -> f64 {
        slides.iter().map(|slide| slide * slide).sum()
    }

    #[test]
    fn what_a_pose_did_to_the_slides_it_takes_back() {
        for done in [[0.3, 0.0, 0.0], [0.0, -0.2, 0.0], [0.03, 0.05, 0.002]] {
            let slides = after(&[0.0; SLIDES], &PoseOffset::of(done));
            let back = recentre(&heads(), &slides, ANY).unwrap();
            let rest = after(&slides, &back);
            // Turns are small, not infinitesimal.
            assert!(rest.iter().all(|s| s.abs() < 1e-3), "{rest:?}");
        }
    }

    #[test]
    fn after_it_no_other_move_brings_the_slides_nearer_to_zero() {
        for slides in [[0.02, 0.01, 0.03, -0.01], [0.01, -0.02, -0.02, 0.005]] {
            let best = recentre(&heads(), &slides, ANY).unwrap();
            let least = sum(&after(&slides, &best));
            for step in [[1e-3, 0.0, 0.0], [0.0, 1e-3, 0.0], [0.0, 0.0, 3e-4]] {
                for sign in [-1.0, 1.0] {
                    let other = best.then(&PoseOffset::of(step.map(|s| s * sign)));
                    assert!(sum(&after(&slides, &other)) > least, "{slides:?} {step:?}");
                }
            }
        }
    }

    #[test]
    fn a_correction_that_the_pose_cannot_take_stays_in_the_slides() {
        // The seams lie further apart than planned: the heads move away from each other in the plane of the plate.
        let (s, c) = (0.5, 0.75f64.sqrt());
        let apart = [9.0 * c, -9.0 * s, -9.0 * c, -9.0 * s];
        let best = recentre(&heads(), &apart, ANY).unwrap();
        assert!(best.numbers().iter().all(|x| x.abs() < 0.3), "{best:?}");
        let even = HeadConfig {
            included_angle_deg: -60.0,
            working_distance_mm: [4.0; 2],
            camera_lead_mm: 10.0,
        };
        let best = recentre(&even.build().unwrap(), &apart, ANY).unwrap();
        assert!(best.numbers().iter().all(|x| x.abs() < 1e-12), "{best:?}");
    }

    #[test]
    fn the_turn_keeps_to_its_bounds_and_the_shifts_make_the_best_of_it() {
        let slides = [9.0, 0.0, 9.0, 0.0];
        let free = recentre(&heads(), &slides, ANY).unwrap();
        assert!(free.about_tangent_rad > 0.2, "{free:?}");
        for bound in [0.0, 0.05] {
            let best = recentre(&heads(), &slides, (-bound, bound)).unwrap();
            assert!((best.about_tangent_rad.abs() - bound).abs() < 1e-15);
            let rest = after(&slides, &best);
            assert!(rest.iter().all(|s| s.abs() < 4.5), "{rest:?}");
        }
        // Shifts alone are linear: exactly the best.
        let best = recentre(&heads(), &slides, (0.0, 0.0)).unwrap();
        for step in [
            [0.01, 0.0, 0.0],
            [-0.01, 0.0, 0.0],
            [0.0, 0.01, 0.0],
            [0.0, -0.01, 0.0],
        ] {
            let other = best.then(&PoseOffset::of(step));
            assert!(
                sum(&after(&slides, &other)) > sum(&after(&slides, &best)),
                "{step:?}"
            );
        }
        assert_eq!(recentre(&heads(), &[f64::NAN; SLIDES], ANY), None);
    }

    #[test]
    fn a_single_head_is_shifted_to_the_middle_of_its_slides() {
        let mut board = shared::config::TrackerConfig {
            head: HeadConfig {
                included_angle_deg: 20.0,
                working_distance_mm: [4.0; 2],
                camera_lead_mm: 10.0,
            },
            ..shipped()
        };
        board.slides.truncate(2);
        let heads = board.heads().unwrap();
        let slides = [7.0, -2.0, 0.0, 0.0];
        let best = recentre(&heads, &slides, (0.0, 0.0)).unwrap();
        assert_eq!(best.about_tangent_rad, 0.0);
        let rest = slides_after(&heads, &slides, &best);
        assert!(rest.iter().all(|s| s.abs() < 1e-12), "{rest:?}");
    }

    fn shipped() -> shared::config::TrackerConfig {
        let text = include_str!("../../../../machines/dual-beam-gantry.toml");
        let machine = config::machine::MachineFile::parse("m.toml", text).unwrap();
        machine.tracking.unwrap().board
    }
}
