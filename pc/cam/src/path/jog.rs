//! Moves by hand: one axis alone, or the tip, as far as the machine goes.

use super::limits::BEYOND;
use super::targets::ROTARY;
use super::{NOWHERE, PathError, PlannedPath, Planner, Tip, inner};
use config::table::FARTHEST_MM;
use nalgebra::Vector3;
use shared::io::{AXES, AXIS_NAMES, SIDES};
use shared::kinematics::AXIS_UNIT;
use thiserror::Error;

/// The way of the tip is looked along in steps of so much \[mm or °\], and its end is found to `EXACT`; less is no move.
const LOOK: f64 = 1.0;
const EXACT: f64 = 1e-3;

/// A move of the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TipMove {
    /// Straight in this direction, which has unit length; the rotary axes stay.
    Along(Vector3<f64>),
    /// Turned by a rotary axis, A B C (3, 4, 5); the tip stays where it is.
    Turn(usize),
}

/// A move by hand that cannot be made.
#[derive(Debug, Error)]
pub enum JogError {
    /// The machine has no such axis.
    #[error("the machine has no axis {}", AXIS_NAMES[*axis])]
    NotFitted {
        /// The axis.
        axis: usize,
    },
    /// It ends here.
    #[error("axis {} is at the end of its travel", AXIS_NAMES[*axis])]
    AtEnd {
        /// The axis.
        axis: usize,
    },
    /// It cannot stay while the tip moves, nor turn while the tip stays.
    #[error("axis {} follows from where the tip is: jog the axes one by one", AXIS_NAMES[*axis])]
    Follows {
        /// The axis.
        axis: usize,
    },
    /// No axes have the tip farther in that direction.
    #[error("the tip can go no farther there: the machine does not reach it")]
    OutOfReach,
    /// The way there cannot be planned.
    #[error(transparent)]
    Path(#[from] PathError),
}

impl Planner {
    /// From the axes `from` (mm, degrees) one of them `by` farther \[mm or °\], or to the end of its travel if that is nearer; no
    /// faster than `speed` \[mm/s or °/s\], nor than a rapid.
    ///
    /// # Errors
    /// [`JogError`].
    pub fn jog_axis(
        &self,
        from: &[f64; AXES],
        axis: usize,
        by: f64,
        speed: f64,
    ) -> Result<PlannedPath, JogError> {
        if !self.fitted[axis] {
            return Err(JogError::NotFitted { axis });
        }
        let [min, max] = self.drives[axis].travel();
        let mut to = *from;
        to[axis] = (from[axis] + by).clamp(min.min(from[axis]), max.max(from[axis]));
        let way = (to[axis] - from[axis]).abs();
        if way < EXACT {
            return Err(JogError::AtEnd { axis });
        }
        let mut path = self.axes_path(&inner(from), &inner(&to), &[0.0; SIDES], NOWHERE)?;
        path.limits.velocity = path.limits.velocity.min(speed * path.length_mm() / way);
        Ok(path)
    }

    /// Where the tip comes to from the axes `from` (mm, degrees) if it is moved `by` \[mm or °\], or as far as the axes go if that
    /// is nearer.
    ///
    /// # Errors
    /// [`JogError`], of a tip that cannot be moved there at all.
    pub fn reach(&self, from: &[f64; AXES], motion: TipMove, by: f64) -> Result<Tip, JogError> {
        if let TipMove::Turn(axis) = motion
            && !self.fitted[axis]
        {
            return Err(JogError::NotFitted { axis });
        }
        let tip = self.tip(from);
        let direction = by.signum();
        let most = by.abs().min(FARTHEST_MM);
        let at = |way: f64| moved(&tip, motion, direction * way);
        let mut near = inner(from);
        let (mut reached, mut step, mut why) = (0.0, LOOK, None);
        while reached < most && step > EXACT {
            let next = (reached + step).min(most);
            match self.axes_there(&at(next), &near) {
                Ok(axes) => (reached, near) = (next, axes),
                Err(error) => (step, why) = (step / 2.0, Some(error)),
            }
        }
        if let Some(why) = why {
            // Not to the last digit, which a block of NC does not have.
            reached -= EXACT;
            if reached < EXACT {
                return Err(why);
            }
        }
        Ok(at(reached))
    }

    /// The axes at `tip` (mm, rad), within their travel.
    fn axes_there(&self, tip: &Tip, near: &[f64; AXES]) -> Result<[f64; AXES], JogError> {
        let axes = self.kinematics.inverse(&self.pose(tip), near);
        let axes = axes.map_err(|_| JogError::OutOfReach)?;
        let angles = ROTARY.zip(tip.angles_deg);
        let mut follows =
            angles.filter(|(axis, angle)| (axes[*axis] / AXIS_UNIT[*axis] - angle).abs() > BEYOND);
        if let Some((axis, _)) = follows.next() {
            return Err(JogError::Follows { axis });
        }
        let beyond = |axis: &usize| {
            let at = axes[*axis] / AXIS_UNIT[*axis];
            let [min, max] = self.drives[*axis].travel();
            self.fitted[*axis] && !(min..=max).contains(&at)
        };
        match (0..AXES).find(beyond) {
            Some(axis) => Err(JogError::AtEnd { axis }),
            None => Ok(axes),
        }
    }
}

/// `tip` after a move by `way` \[mm or °\].
fn moved(tip: &Tip, motion: TipMove, way: f64) -> Tip {
    let mut there = *tip;
    match motion {
        TipMove::Along(direction) => {
            for (place, along) in there.position_mm.iter_mut().zip(direction.iter()) {
                *place += along * way;
            }
        }
        TipMove::Turn(axis) => there.angles_deg[axis - 3] += way,
    }
    there
}
