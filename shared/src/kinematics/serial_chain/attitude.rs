//! The attitude in closed form, by the subproblems of Paden and Kahan (mathematics 8.3).

use super::{Joint, SerialChain};
use crate::geometry::{Pose, rotate};
use crate::io::AXES;
use crate::kinematics::tool_axis::POLE;
use crate::units::next_to;
use core::f64::consts::PI;
use nalgebra::Vector3;

/// By how much an angle may be outside its travel by rounding \[rad\].
const ROUNDING: f64 = 1e-9;
/// What an axis outside its travel counts as in a way \[rad\]: more than any way.
const OUTSIDE: f64 = 1e6;
/// 1 − cos² between two axes that are parallel.
const PARALLEL: f64 = 1e-12;

impl SerialChain {
    /// `near`, with rotary axes that give the attitude of `pose` as far as there are such: of two solutions the one within
    /// the travel, and then the one nearest to `near`. An axis that has no effect stays.
    #[inline(never)]
    pub(super) fn turned(&self, pose: &Pose, near: &[f64; AXES]) -> [f64; AXES] {
        let mut here = [0.0; AXES];
        for joint in &self.joints {
            here[joint.axis] = near[joint.axis];
        }
        let mut best = here;
        let mut least = f64::INFINITY;
        for sign in [1.0, -1.0] {
            let mut axes = here;
            self.turn_to(pose, sign, &mut axes);
            let mut cost = 0.0;
            for joint in self.rotary.iter().map(|i| self.joint(i)) {
                cost += libm::fabs(axes[joint.axis] - here[joint.axis]);
                if !joint.has(axes[joint.axis]) {
                    cost += OUTSIDE;
                }
            }
            if cost < least {
                (best, least) = (axes, cost);
            }
        }
        best
    }

    /// One of two solutions, by `sign`, next to `axes`.
    #[inline(never)]
    fn turn_to(&self, pose: &Pose, sign: f64, axes: &mut [f64; AXES]) {
        // Where T counts, the last axis does not move itself: those before it carry it to where it has to be.
        let (first, last) = match self.rotary.split_last() {
            Some((last, first)) if self.follows_tangent => (first, Some(self.joint(last))),
            _ => (&self.rotary[..], None),
        };
        let from = last.map_or(self.tool.normal, |last| last.direction);
        let to = self.carried(pose, &from);
        match first {
            [one] => self.joint(one).turn(&from, &to, axes),
            [one, two] => {
                let (one, two) = (self.joint(one), self.joint(two));
                let z = between(one, two, &from, &to, sign);
                one.turn(&z, &to, axes);
                two.turn(&from, &z, axes);
            }
            _ => {}
        }
        if let Some(last) = last {
            let along = |v: &Vector3<f64>| libm::fabs(v.dot(&last.direction));
            let seen = if along(&self.tool.normal) < along(&self.tool.tangent) {
                self.tool.normal
            } else {
                self.tool.tangent
            };
            let mut wanted = self.carried(pose, &seen);
            for joint in first.iter().map(|i| self.joint(i)) {
                wanted = rotate(&joint.direction, -axes[joint.axis], &wanted);
            }
            last.turn(&seen, &wanted, axes);
        }
    }

    /// Where `pose` has a direction that is fixed to the tool, which is `v` while all axes are at 0.
    #[inline(never)]
    fn carried(&self, pose: &Pose, v: &Vector3<f64>) -> Vector3<f64> {
        let tool = &self.tool;
        pose.tangent * tool.tangent.dot(v)
            + pose.lateral() * tool.lateral().dot(v)
            + pose.normal * tool.normal.dot(v)
    }
}

/// Where `second` carries `from`, so that `first` carries it on to `to`: a direction as far from the second axis as `from`, and
/// from the first as `to`. There are two, on either side of the plane of both axes.
#[inline(never)]
fn between(first: &Joint, second: &Joint, from: &Vector3<f64>, to: &Vector3<f64>, sign: f64) -> Vector3<f64> {
    let (k1, k2) = (&first.direction, &second.direction);
    let cos = k1.dot(k2);
    let sin_2 = 1.0 - cos * cos;
    if sin_2 < PARALLEL {
        return *from;
    }
    let (along_1, along_2) = (k1.dot(to), k2.dot(from));
    let in_plane = k1 * ((along_1 - cos * along_2) / sin_2) + k2 * ((along_2 - cos * along_1) / sin_2);
    // The rest of what `to` has across the first axis, without the loss of digits of 1 − cos².
    let across = k1.cross(to).norm();
    let spent = libm::fabs(along_2 - cos * along_1) / libm::sqrt(sin_2);
    let rest = libm::sqrt(((across - spent) * (across + spent)).max(0.0) / sin_2);
    in_plane + k1.cross(k2) * (sign * rest)
}

impl Joint {
    /// Turns its axis so that it carries `from` as close to `to` as it does, within half a turn of where it is; it stays
    /// where either is along the axis.
    #[inline(never)]
    fn turn(&self, from: &Vector3<f64>, to: &Vector3<f64>, axes: &mut [f64; AXES]) {
        let k = &self.direction;
        let (u, v) = (from - k * k.dot(from), to - k * k.dot(to));
        if u.norm_squared().min(v.norm_squared()) < POLE * POLE {
            return;
        }
        let near = axes[self.axis];
        let nearest = next_to(libm::atan2(k.dot(&u.cross(&v)), u.dot(&v)), near);
        // Where only that is within the travel, a turn beside it.
        let beside = nearest - libm::copysign(2.0 * PI, nearest - self.travel[0]);
        let inside = !self.has(nearest) && self.has(beside);
        axes[self.axis] = if inside { beside } else { nearest };
    }

    /// Whether a position is within the travel.
    fn has(&self, position: f64) -> bool {
        let [min, max] = self.travel;
        (min - ROUNDING..=max + ROUNDING).contains(&position)
    }
}
