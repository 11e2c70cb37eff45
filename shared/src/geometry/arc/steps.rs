//! Points along an arc in steps (mathematics 1.5).

use super::{Arc, ArcError};
use nalgebra::Vector3;

impl Arc {
    /// Points from start to end, both included, at equal angles and at most `step` \[mm\] apart along the arc.
    /// Every point is turned from the start by itself, so errors do not add up.
    pub fn equal_steps(
        &self,
        step: f64,
    ) -> Result<impl ExactSizeIterator<Item = Vector3<f64>> + Clone, ArcError> {
        let wanted = libm::ceil(self.radius() * self.sweep() / checked(step)? - 1e-9);
        let steps = (wanted as usize).max(1);
        let arc = *self;
        Ok((0..steps + 1).map(move |i| arc.at_angle(arc.sweep() * i as f64 / steps as f64)))
    }

    /// The published walk (mathematics 1.5), for comparison, on the plane part of the arc: a `step`
    /// \[mm\] along the tangent, then back onto the circle, until the end is nearer than a step, then the end.
    ///
    /// It keeps the radius, but turns by atan(step/R) where step/R was meant: the feed is low by
    /// (step/R)²/3, and the last step is a rest of any size. Use [`Arc::equal_steps`].
    pub fn tangent_walk(&self, step: f64) -> Result<impl Iterator<Item = Vector3<f64>> + Clone, ArcError> {
        let arc = *self;
        let per_step = libm::atan(checked(step)? / arc.radius());
        let mut point = arc.start();
        let mut done = 0.0;
        let walk = core::iter::from_fn(move || {
            done += 1.0;
            if done * per_step >= arc.sweep() - 1e-12 {
                return None;
            }
            let tangent = arc.axis().cross(&(point - arc.centre()));
            let ahead = point + tangent * (step / tangent.norm()) - arc.centre();
            point = arc.centre() + ahead * (arc.radius() / ahead.norm());
            Some(point)
        });
        Ok(core::iter::once(arc.start())
            .chain(walk)
            .chain(core::iter::once(arc.end())))
    }
}

/// `step` if it leads somewhere.
fn checked(step: f64) -> Result<f64, ArcError> {
    if step.is_finite() && step > 0.0 {
        Ok(step)
    } else {
        Err(ArcError::Step { step })
    }
}
