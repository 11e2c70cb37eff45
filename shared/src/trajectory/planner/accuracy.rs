//! What keeps the path behind the output filter inside its share of the tolerance.

use super::limits::{ACCURACY_ROW, Bounds};
use super::node::{greater, lesser};
use super::sample::Sample;
use super::track::{Piece, Track};
use crate::trajectory::{Join, Tolerance};
use core::f64::consts::SQRT_2;

/// Where the machine is too quick for the filter at a corner, turning and speeding up have half of the share each.
const HALF: f64 = 0.5;
/// Share of it that speeding up may use unseen: it seldom comes together with all that turning may use.
const UNSEEN: f64 = 0.75;
/// Junctions on each side whose corners are looked at.
const NEAR: u32 = 2;

impl<const E: usize> Track<E> {
    /// A mean over T is off by T²/24 of the acceleration across the path: limits the speed on curves, and the
    /// acceleration along the path next to corners. `serial` is the element there, and `attitude` how much the
    /// attitude bends.
    pub fn keep_accurate(&self, sample: &mut Sample, attitude: f64, serial: u32, bounds: &Bounds) {
        let mut corners = 0.0;
        for serial in serial.saturating_sub(NEAR - 1)..serial + NEAR + 1 {
            if let Some(piece) = self.get(serial)
                && libm::fabs(sample.s - piece.start) < piece.corner.strained
            {
                corners += piece.corner.strain;
            }
        }
        sample.first[ACCURACY_ROW] = (corners / HALF) as f32;
        sample.limit = f64::INFINITY;
        if sample.bend > 0.0 || attitude > 0.0 {
            let tolerance = self.tolerance(serial, bounds);
            let share = if corners > 0.0 { HALF } else { 1.0 };
            let used = greater(sample.bend / tolerance.position, attitude / tolerance.attitude);
            sample.limit = share / (used * bounds.off);
        }
    }

    /// Tolerance of an element; one that ends in a stop has that of the one before it.
    fn tolerance(&self, serial: u32, bounds: &Bounds) -> Tolerance {
        let join = |serial: u32| self.get(serial).map(|piece| piece.element.join);
        match (join(serial), serial.checked_sub(1).and_then(join)) {
            (Some(Join::Blend(tolerance)), _) | (_, Some(Join::Blend(tolerance))) => tolerance,
            _ => bounds.tolerance,
        }
    }
}

impl Piece {
    /// Share of the filter's tolerance for each unit of acceleration along the path, at the corner where the element
    /// begins, of which `half` is half the length, and how far away that matters: half the jump of the direction
    /// lies across. Nothing where the limits are low enough anyway. The element before it has the `join`.
    pub fn strain(&self, join: Join, half: f64, bounds: &Bounds) -> (f64, f64) {
        let Join::Blend(tolerance) = join else {
            return (0.0, 0.0);
        };
        let per_acceleration = [bounds.off / tolerance.position, bounds.off / tolerance.attitude];
        let [position, attitude] = [self.corner.turn, self.corner.others].map(|jump| 0.5 * jump);
        let share = [position * per_acceleration[0], attitude * per_acceleration[1]];
        // Two axes that turn may do so together.
        let turning = lesser(SQRT_2 * bounds.spin, attitude * bounds.corner);
        if greater(share[0] * bounds.corner, per_acceleration[1] * turning) <= UNSEEN {
            return (0.0, 0.0);
        }
        let share = greater(share[0], share[1]);
        let speed = lesser(self.element.feed, libm::sqrt(HALF * half / share));
        // As far as the machine comes in half the filter's length.
        let half_time = 0.5 * bounds.filter;
        let way = half + half_time * (speed + 0.5 * half_time * HALF / share);
        (share, way)
    }
}
