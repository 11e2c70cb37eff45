//! What the planner must never exceed.

use crate::io::AXES;
use crate::kinematics::AxisLimits;
use crate::ticks::PATH_PERIOD_S;
use crate::trajectory::{SHAPED, Tolerance};

/// Limits of the axes and of the path, and the accuracy that the output filter is made for (mm, rad, s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanLimits {
    /// Highest speed of each axis; infinite where there is none.
    pub velocity: [f64; AXES],
    /// Highest acceleration of each axis.
    pub acceleration: [f64; AXES],
    /// Highest jerk of each axis.
    pub jerk: [f64; AXES],
    /// Highest acceleration along the path \[mm/s²\].
    pub path_acceleration: f64,
    /// Highest jerk along the path \[mm/s³\].
    pub path_jerk: f64,
    /// Tolerance that most elements are programmed with \[mm\]: decides how long the output filter is.
    pub tolerance: f64,
}

impl PlanLimits {
    /// Those of a machine's axes, and along a path.
    pub fn of(axes: &[AxisLimits; AXES], path_acceleration: f64, path_jerk: f64, tolerance: f64) -> Self {
        Self {
            velocity: axes.map(|axis| axis.velocity),
            acceleration: axes.map(|axis| axis.acceleration),
            jerk: axes.map(|axis| axis.jerk),
            path_acceleration,
            path_jerk,
            tolerance,
        }
    }

    /// Length of the output filter \[s\].
    pub fn filter_s(&self) -> f64 {
        Bounds::build(self).filter
    }

    /// By how much the output filter is off for each unit of acceleration across the path, as a share of what it may be,
    /// times the tolerance of the path there \[s²\].
    pub fn filter_off(&self) -> f64 {
        Bounds::build(self).off
    }
}

/// Most ticks that the output filter averages over.
pub const MAX_FILTER: usize = 64;
/// Fewest.
const MIN_FILTER: f64 = 4.0;
/// Length of the output filter in ramps, in which the acceleration goes from none to full.
const SHORTEST: f64 = 0.25;
const LONGEST: f64 = 1.3;
/// Share of the tolerance that the output filter may use on curves; rounding has the rest.
pub(super) const FILTER_SHARE: f64 = 0.4;
/// What the plan uses of the accelerations: the rest is for rounding, and for what the grid does not see.
const ACCELERATION_RESERVE: f64 = 0.99;
/// The same of the jerks.
const JERK_RESERVE: f64 = 0.985;

/// Lengths of the output filter after which what was no longer matters: one for the filter, and one for where in their intervals
/// accelerations change. With less the limit of jerk is passed where plans meet; more is only work.
const REMEMBERED: f64 = 2.0;

/// Share of a tick's change of acceleration that nothing feels.
const UNFELT: f64 = 0.01;
/// Tolerance of the attitude that goes with one of the position, where none is programmed \[rad/mm\].
const ATTITUDE_OF_POSITION: f64 = 0.02;
/// Path and axes, each with limits of its own, and what keeps corners accurate.
pub(super) const ROWS: usize = 8;
/// Row of the path; the axes follow it.
pub(super) const PATH_ROW: usize = 0;
/// Row of what the output filter is off by next to corners, as a share of what it may be.
pub(super) const ACCURACY_ROW: usize = 7;

/// Limits as the planner uses them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    /// Highest acceleration of each row.
    pub acceleration: [f32; ROWS],
    /// One divided by it.
    pub per_acceleration: [f32; ROWS],
    /// Most that the acceleration of a row may differ from itself one filter length away: jerk times that
    /// length.
    pub acceleration_change: [f32; ROWS],
    /// One divided by it.
    pub per_acceleration_change: [f32; ROWS],
    /// One divided by the highest speed of a row; 0 where it has none.
    pub per_velocity: [f32; ROWS],
    /// Acceleration that sizes corners: the least of the linear axes and the path.
    pub corner: f64,
    /// The same of attitude: the least of the rotary axes.
    pub spin: f64,
    /// A jump of velocity that nothing feels behind the output filter \[mm/s\].
    pub unfelt: f64,
    /// Being off that nothing feels \[mm\].
    pub unfelt_way: f64,
    /// Tolerance of elements that have none of their own.
    pub tolerance: Tolerance,
    /// Ticks that the output filter averages over.
    pub filter_ticks: usize,
    /// The same \[s\].
    pub filter: f64,
    /// Time after which what was no longer matters \[s\].
    pub remembered: f64,
    /// By how much it is off for each unit of acceleration across the path, as a share of what it may be, times the
    /// tolerance.
    pub off: f64,
}

impl Bounds {
    /// Of no machine.
    pub const NONE: Self = Self {
        acceleration: [1.0; ROWS],
        per_acceleration: [1.0; ROWS],
        acceleration_change: [1.0; ROWS],
        per_acceleration_change: [1.0; ROWS],
        per_velocity: [0.0; ROWS],
        corner: 1.0,
        spin: 1.0,
        unfelt: 0.0,
        unfelt_way: 0.0,
        tolerance: Tolerance {
            position: 1.0,
            attitude: 1.0,
        },
        filter_ticks: 1,
        filter: PATH_PERIOD_S,
        remembered: REMEMBERED * PATH_PERIOD_S,
        off: 0.0,
    };

    pub fn build(limits: &PlanLimits) -> Self {
        // The longest time in which any row goes from none to its full acceleration.
        let mut ramp: f64 = 0.0;
        let mut corner = limits.path_acceleration;
        let mut spin = f64::INFINITY;
        for axis in 0..AXES {
            if limits.acceleration[axis].is_finite() {
                ramp = libm::fmax(ramp, limits.acceleration[axis] / limits.jerk[axis]);
                let least = if axis < SHAPED { &mut corner } else { &mut spin };
                *least = libm::fmin(*least, limits.acceleration[axis]);
            }
        }
        // No path has more acceleration than all linear axes together.
        let path = libm::fmin(limits.path_acceleration, 2.0 * corner);
        ramp = libm::fmax(ramp, path / limits.path_jerk);
        // A mean over T is off by T²/24 of the acceleration across a curve; √2: of two axes together.
        let accurate =
            libm::sqrt(24.0 * FILTER_SHARE * limits.tolerance / (core::f64::consts::SQRT_2 * corner));
        // Where a ramp takes many filter lengths, its steps need as many nodes: rather slow down on curves.
        let ticks = libm::fmin(libm::fmax(accurate, SHORTEST * ramp), LONGEST * ramp) / PATH_PERIOD_S;
        let ticks = libm::fmin(libm::fmax(libm::floor(ticks), MIN_FILTER), MAX_FILTER as f64);
        let filter = ticks * PATH_PERIOD_S;
        let mut bounds = Self {
            corner: corner * ACCELERATION_RESERVE,
            spin: spin * ACCELERATION_RESERVE,
            tolerance: Tolerance {
                position: limits.tolerance,
                attitude: limits.tolerance * ATTITUDE_OF_POSITION,
            },
            filter_ticks: ticks as usize,
            filter,
            remembered: REMEMBERED * filter,
            off: filter * filter / (24.0 * FILTER_SHARE),
            ..Self::NONE
        };
        // Large enough to mean none, small enough for single precision.
        let sane = |x: f64| libm::fmin(x, 1e9) as f32;
        bounds.acceleration = [sane(f64::INFINITY); ROWS];
        bounds.acceleration_change = bounds.acceleration;
        bounds.acceleration[PATH_ROW] = sane(limits.path_acceleration * ACCELERATION_RESERVE);
        bounds.acceleration_change[PATH_ROW] = sane(limits.path_jerk * JERK_RESERVE * filter);
        for axis in 0..AXES {
            bounds.acceleration[PATH_ROW + 1 + axis] = sane(limits.acceleration[axis] * ACCELERATION_RESERVE);
            bounds.acceleration_change[PATH_ROW + 1 + axis] = sane(limits.jerk[axis] * JERK_RESERVE * filter);
            bounds.per_velocity[PATH_ROW + 1 + axis] = (1.0 / limits.velocity[axis]) as f32;
        }
        bounds.acceleration[ACCURACY_ROW] = 1.0;
        let feels = |row: usize| bounds.acceleration[row].min(bounds.acceleration_change[row]);
        let most_sensitive = (PATH_ROW..=PATH_ROW + SHAPED)
            .map(feels)
            .fold(f32::INFINITY, f32::min);
        bounds.unfelt = UNFELT * f64::from(most_sensitive) * PATH_PERIOD_S;
        // There and back from tick to tick, and the other way one filter length later.
        bounds.unfelt_way = bounds.unfelt * PATH_PERIOD_S / 8.0;
        bounds.per_acceleration_change = bounds.acceleration_change.map(|change| 1.0 / change);
        bounds.per_acceleration = bounds.acceleration.map(|acceleration| 1.0 / acceleration);
        bounds
    }
}
