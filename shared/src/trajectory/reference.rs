//! Where the axes are at a place of a path, and how they move along it: path and kinematics put together.

use super::{PathPoint, PathSpace};
use crate::geometry::PoseError;
use crate::io::AXES;
use crate::kinematics::{AxisMotion, Kinematics, KinematicsError};
use thiserror::Error;

/// Why there is no reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ReferenceError {
    /// The path has no knots.
    #[error("the path is empty")]
    EmptyPath,
    /// The path is no pose there.
    #[error("the path does not define a pose there: {0}")]
    Pose(#[from] PoseError),
    /// The machine cannot realise the pose.
    #[error("the machine cannot take the pose: {0}")]
    Kinematics(#[from] KinematicsError),
}

/// A place of a path that the machine cannot be at.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("line {line}: {source} (at s = {s:.3} mm)")]
pub struct Unreachable {
    /// Line of the program.
    pub line: u32,
    /// Path length there \[mm\].
    pub s: f64,
    /// Why.
    pub source: ReferenceError,
}

/// The axes at a point of a path, nearest to `near`, with derivatives over s (mathematics 0.3,
/// 0.4). A path in axis space gives its axes as they are.
///
/// Of the channels of a point it needs the first six in axis space, the first nine of a tool.
pub fn at_unit_speed<const N: usize>(
    kinematics: &Kinematics,
    point: &PathPoint<N>,
    space: PathSpace,
    near: &[f64; AXES],
) -> Result<AxisMotion, ReferenceError> {
    match space {
        PathSpace::Tool => match &point.pose_in_motion() {
            Ok((pose, motion)) => Ok(kinematics.inverse_motion(pose, motion, near)?),
            Err(error) => Err((*error).into()),
        },
        PathSpace::Axes => Ok(point.axes()),
    }
}

/// The axes at a point of a path, nearest to `near`.
pub fn axes_at(
    kinematics: &Kinematics,
    point: &PathPoint,
    space: PathSpace,
    near: &[f64; AXES],
) -> Result<[f64; AXES], ReferenceError> {
    Ok(at_unit_speed(kinematics, point, space, near)?.position)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::{AxisLimits, DualBeamConfig, KinematicsConfig};
    use crate::trajectory::{CHANNELS, Knot, Path, RestToRest, SpeedLimits, SpeedState};

    fn machine() -> Kinematics {
        let config = KinematicsConfig::DualBeamGantry(DualBeamConfig {
            o1_mm: [3.0, -2.0, -120.0],
            o2_mm: [1.0, 4.0, -80.0],
            o3_mm: [0.5, -0.3, -450.0],
        });
        config.build(&[AxisLimits::NOT_FITTED; AXES]).unwrap()
    }

    /// A curved and twisting path whose T and N are neither of unit length nor perpendicular.
    fn path() -> Path<32> {
        let mut path = Path::new();
        for k in 0..32 {
            let s = f64::from(k) * 10.0;
            let (sin, cos) = libm::sincos(s / 80.0);
            let mut knot = Knot {
                s_mm: s,
                value: [0.0; CHANNELS],
                slope: [0.0; CHANNELS],
            };
            let waves = [
                (1000.0 + s, 1.0),
                (800.0 + 30.0 * sin, 30.0 * cos / 80.0),
                (500.0 + 10.0 * cos, -10.0 * sin / 80.0),
                (1.1, 0.0),
                (0.4 * cos, -0.4 * sin / 80.0),
                (-0.15 * sin, -0.15 * cos / 80.0),
                (0.2 * sin, 0.2 * cos / 80.0),
                (0.7 * sin, 0.7 * cos / 80.0),
                (0.9, 0.0),
            ];
            for (i, (value, slope)) in waves.into_iter().enumerate() {
                (knot.value[i], knot.slope[i]) = (value, slope);
            }
            path.push(knot).unwrap();
        }
        path
    }

    /// The axes at `state` of `path`, by the chain rule.
    fn moving(
        machine: &Kinematics,
        path: &Path<32>,
        state: SpeedState,
    ) -> Result<AxisMotion, ReferenceError> {
        let point = path.at(state.s).ok_or(ReferenceError::EmptyPath)?;
        let axes = at_unit_speed(machine, &point, path.space(), &[0.0; AXES])?;
        Ok(axes.at_speed(state.v, state.a))
    }

    /// Velocities and accelerations are the derivatives of the positions over time, as differences see them
    /// (away from knots, where the second derivative of a Hermite path steps), and the pose is realised.
    #[test]
    fn references_fit_their_own_differences_in_time() {
        let (machine, path) = (machine(), path());
        let limits = SpeedLimits {
            velocity: 150.0,
            acceleration: 800.0,
            jerk: 6000.0,
        };
        let way = RestToRest::new(304.0, &limits);
        let state = |t: f64| {
            let state = way.at(t);
            SpeedState {
                s: 3.0 + state.s,
                ..state
            }
        };
        let at = |t: f64| moving(&machine, &path, state(t)).unwrap();
        let h = 1e-4;
        let mut checked = 0;
        for k in 1..400 {
            let t = way.duration() * f64::from(k) / 400.0;
            let span = |t: f64| libm::floor(state(t).s / 10.0);
            if span(t - h) != span(t + h) {
                continue;
            }
            checked += 1;
            let (before, now, after) = (at(t - h), at(t), at(t + h));
            for i in 0..AXES {
                let velocity = (after.position[i] - before.position[i]) / (2.0 * h);
                let acceleration = (after.velocity[i] - before.velocity[i]) / (2.0 * h);
                // Differences err by h²/6 of the third derivative; a jerk step inside adds jerk·h.
                assert!((velocity - now.velocity[i]).abs() < 2e-4, "velocity {i} at {t}");
                assert!(
                    (acceleration - now.acceleration[i]).abs() < 1.0,
                    "acceleration {i} at {t}"
                );
            }
            let realised = machine.forward(&now.position);
            let (pose, _) = path.at(state(t).s).unwrap().pose_in_motion().unwrap();
            assert!((realised.position - pose.position).norm() < 1e-9);
            assert!((realised.normal - pose.normal).norm() < 1e-12);
            assert!((realised.tangent - pose.tangent).norm() < 1e-12);
        }
        assert!(checked > 300, "only {checked} places checked");
    }

    /// The same at one place of the path with unit speed and much finer tolerance: exact derivatives.
    #[test]
    fn second_derivatives_are_exact() {
        let (machine, path) = (machine(), path());
        let at = |s: f64, v: f64, a: f64| moving(&machine, &path, SpeedState { s, v, a }).unwrap();
        for s in [4.0, 55.5, 123.0, 266.6] {
            let h = 1e-3;
            let (before, now, after) = (at(s - h, 1.0, 0.0), at(s, 1.0, 0.0), at(s + h, 1.0, 0.0));
            for i in 0..AXES {
                let first = (after.position[i] - before.position[i]) / (2.0 * h);
                let second = (after.velocity[i] - before.velocity[i]) / (2.0 * h);
                assert!((first - now.velocity[i]).abs() < 1e-8, "first {i} at {s}");
                assert!((second - now.acceleration[i]).abs() < 1e-8, "second {i} at {s}");
            }
            // Chain rule: q̈ = q″v² + q′a.
            let fast = at(s, 20.0, -300.0);
            for i in 0..AXES {
                let wanted = now.acceleration[i] * 400.0 - now.velocity[i] * 300.0;
                assert!(
                    (fast.acceleration[i] - wanted).abs() < 1e-9,
                    "chain rule {i} at {s}"
                );
            }
        }
    }

    #[test]
    fn a_path_without_a_pose_is_refused() {
        let state = SpeedState::default();
        assert_eq!(
            moving(&machine(), &Path::new(), state),
            Err(ReferenceError::EmptyPath)
        );
        let mut path = Path::new();
        let mut knot = Knot {
            s_mm: 0.0,
            value: [0.0; CHANNELS],
            slope: [0.0; CHANNELS],
        };
        path.push(knot).unwrap();
        assert_eq!(
            moving(&machine(), &path, state),
            Err(ReferenceError::Pose(PoseError::ZeroVector))
        );
        path.clear(1, PathSpace::Tool);
        (knot.value[5], knot.value[6]) = (1.0, 1.0);
        path.push(knot).unwrap();
        assert_eq!(
            moving(&machine(), &path, state),
            Err(ReferenceError::Kinematics(KinematicsError::GimbalLock))
        );
    }
}
