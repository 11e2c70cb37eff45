//! How fast the bead can be laid: curve, machine and process window (mathematics 3.3, 3.4).

use super::error::BeadError;
use super::window::{CurveLimits, ProcessWindow, WindowError};
use cam::path::MAX_EVENTS;
use cam::path::{NOWHERE, PathError, PlannedPath};
use config::machine::MachineFile;
use curves::nurbs::curvature;
use nalgebra::Vector3;
use shared::geometry::Moving;
use shared::io::{AXES, AXIS_NAMES};
use shared::kinematics::{AxisLimits, AxisMotion, Kinematics};
use shared::ticks::PATH_PERIOD_S;

/// Largest distance of the curve from the chord of one path period \[mm\]. The boards interpolate within it, so
/// this does not make an error; it keeps a period short against the radius.
const CHORD_ERROR: f64 = 1e-3;
/// Places in each span where the limits are asked.
const LOOKS: usize = 8;
/// Feeds are written to a tenth of a mm/min, downwards.
const FEEDS_PER_MM_MIN: f64 = 10.0;
/// Of an axis' acceleration, the part that the bends may always have.
const BEND_SHARE: f64 = 0.5;

/// A feed from the motion to a target on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FeedStep {
    /// Index of the target.
    pub(super) target: usize,
    /// Speed of the tip \[mm/min\].
    pub(super) mm_min: f64,
}

/// The largest speed at a place, and what limits it.
#[derive(Clone, Debug)]
pub(super) struct Limit {
    /// Place on the path \[mm\].
    pub(super) s: f64,
    pub(super) place: Vector3<f64>,
    /// \[mm/s\]
    pub(super) speed: f64,
    /// What limits it, to be read after "limited by".
    pub(super) cause: String,
}

/// The speed of a layer.
#[derive(Clone, Debug)]
pub(super) struct SpeedPlan {
    pub(super) feeds: Vec<FeedStep>,
    /// The one speed that is kept wherever the machine can \[mm/s\].
    pub(super) constant: f64,
    /// The slowest place.
    pub(super) slowest: Limit,
    /// The slowest place of each stretch on which the machine cannot do the lowest speed of the window.
    pub(super) below: Vec<Limit>,
}

/// What the drives and the curve allow at many places of a path.
pub(super) fn limits(
    planned: &PlannedPath,
    machine: &MachineFile,
    kinematics: &Kinematics,
    high: f64,
) -> anyhow::Result<Vec<Limit>> {
    let axes = AxisLimits::build_all(&machine.motion.axes)?;
    let planning = &machine.planning;
    let curve = CurveLimits {
        velocity: high,
        period: PATH_PERIOD_S,
        chord_error: CHORD_ERROR,
        normal_acceleration: planning.path_acceleration_mm_s2,
        normal_jerk: planning.path_jerk_mm_s3,
    };
    let path = planned.path();
    let mut limits: Vec<Limit> = Vec::new();
    let mut near = [0.0; AXES];
    for span in planned.knots.windows(2) {
        let mut before: Option<(f64, AxisMotion)> = None;
        for i in 0..=LOOKS {
            // Just within the span: at its ends the bends change how they change.
            let part = (i as f64 + 1e-6) / (LOOKS as f64 + 2e-6);
            let s = span[0].s_mm + (span[1].s_mm - span[0].s_mm) * part;
            let Some(point) = path.at(s) else { continue };
            let (pose, motion) = point.pose_in_motion().map_err(|source| PathError::Pose {
                place: NOWHERE,
                source,
            })?;
            let moved = kinematics.inverse_motion(&pose, &motion, &near)?;
            near = moved.position;
            let at = Moving {
                value: pose.position,
                first: motion.velocity,
                second: motion.acceleration,
            };
            let radius = 1.0 / curvature(&at)?;
            let mut limit = Limit {
                s,
                place: pose.position,
                speed: curve.speed(radius).map_err(BeadError::Window)?,
                cause: format!("the radius of {radius:.2} mm"),
            };
            if limit.speed >= high {
                limit.cause = "the process window".to_owned();
            }
            for (axis, name) in AXIS_NAMES.into_iter().enumerate() {
                let jerk = before.as_ref().map_or(0.0, |(s0, before)| {
                    (moved.acceleration[axis] - before.acceleration[axis]) / (s - s0)
                });
                let (first, second) = (moved.velocity[axis].abs(), moved.acceleration[axis].abs());
                let allowed = &axes[axis];
                let along = first * planning.path_acceleration_mm_s2;
                let bend = (allowed.acceleration - along).max(BEND_SHARE * allowed.acceleration);
                let speeds = [
                    (allowed.velocity / first, "speed"),
                    (libm::sqrt(bend / second), "acceleration"),
                    (libm::cbrt(allowed.jerk / jerk.abs()), "jerk"),
                ];
                for (speed, quantity) in speeds {
                    if speed < limit.speed {
                        limit.speed = speed;
                        limit.cause = format!("the {quantity} of {name}");
                    }
                }
            }
            before = Some((s, moved));
            limits.push(limit);
        }
    }
    Ok(limits)
}

/// The feeds of a layer whose motions end at `targets` \[mm\]: one speed if the machine can keep it inside the
/// window, otherwise the lowest of the window, and less where the machine cannot do that.
pub(super) fn plan(
    limits: &[Limit],
    targets: &[f64],
    window: &ProcessWindow,
) -> Result<SpeedPlan, BeadError> {
    let mut speeds: Vec<f64> = limits.iter().map(|limit| limit.speed).collect();
    let constant = window.apply(&mut speeds).map_err(BeadError::Window)?.constant;
    // The slowest place of each motion.
    let mut of_target = vec![constant; targets.len()];
    for (limit, speed) in limits.iter().zip(&speeds) {
        let target = targets
            .partition_point(|end| *end < limit.s)
            .min(targets.len() - 1);
        of_target[target] = of_target[target].min(*speed);
    }
    let mut feeds: Vec<FeedStep> = Vec::new();
    for (target, mm_s) in stretches(&of_target, constant).into_iter().enumerate() {
        let mm_min = (mm_s * 60.0 * FEEDS_PER_MM_MIN + 1e-6).floor() / FEEDS_PER_MM_MIN;
        if feeds.last().is_none_or(|last| last.mm_min != mm_min) {
            feeds.push(FeedStep { target, mm_min });
        }
    }
    // Besides the steps, the arc is switched twice and its power set.
    let most = MAX_EVENTS - 3;
    if feeds.len() > most + 1 {
        let corners = feeds.len() / 2;
        return Err(BeadError::TooManySlow {
            corners,
            most: most / 2,
        });
    }
    let slowest = |limits: &[Limit]| {
        let slowest = limits.iter().min_by(|a, b| a.speed.total_cmp(&b.speed));
        slowest.cloned()
    };
    let below = limits
        .chunk_by(|a, b| (a.speed < window.low) == (b.speed < window.low))
        .filter(|stretch| stretch[0].speed < window.low)
        .filter_map(slowest)
        .collect();
    let nothing = BeadError::Window(WindowError::NoSpeeds);
    Ok(SpeedPlan {
        feeds,
        constant,
        slowest: slowest(limits).ok_or(nothing)?,
        below,
    })
}

/// One speed for each run of motions that are slower than `constant`: few steps, each a stretch.
fn stretches(speeds: &[f64], constant: f64) -> Vec<f64> {
    let slow = |v: &f64| *v < constant;
    speeds
        .chunk_by(|a, b| slow(a) == slow(b))
        .flat_map(|run| {
            let least = run.iter().copied().fold(constant, f64::min);
            run.iter().map(move |_| least)
        })
        .collect()
}
