//! What keeps the path behind the output filter inside its share of the tolerance.

use super::grid::{Ground, Sample};
use super::limits::{ACCURACY_ROW, FILTER_SHARE};
use super::track::{Piece, attitude_norm};
use crate::trajectory::{Join, PathPoint, Tolerance};
use core::f64::consts::SQRT_2;

/// Where the machine is too quick for the filter at a corner, turning and speeding up have half of the share each.
const HALF: f64 = 0.5;
/// Share of it that speeding up may use unseen: it seldom comes together with all that turning may use.
const UNSEEN: f64 = 0.75;
/// Junctions on each side whose corners are looked at.
const NEAR: u32 = 2;

impl<const E: usize> Ground<'_, E> {
    /// A mean over T is off by T²/24 of the acceleration across the path: limits the speed on curves, and the
    /// acceleration along the path next to corners.
    pub fn keep_accurate(&self, sample: &mut Sample, point: &PathPoint, s: f64, serial: u32) {
        let tolerance = self.tolerance(serial);
        let off = self.bounds.filter * self.bounds.filter / (24.0 * FILTER_SHARE);
        let per_acceleration = [off / tolerance.position, off / tolerance.attitude];
        let corners = (serial.saturating_sub(NEAR - 1)..=serial + NEAR)
            .filter_map(|serial| self.track.get(serial))
            .map(|piece| self.at_corner(piece, per_acceleration, s))
            .sum::<f64>();
        let share = if corners > 0.0 { HALF } else { 1.0 };
        sample.first[ACCURACY_ROW] = (corners / HALF) as f32;
        let attitude = attitude_norm(&point.second);
        for (per_acceleration, bend) in per_acceleration.into_iter().zip([sample.bend, attitude]) {
            sample.limit = libm::fmin(sample.limit, share / (per_acceleration * bend));
        }
    }

    /// Tolerance of an element; one that ends in a stop has that of the one before it.
    fn tolerance(&self, serial: u32) -> Tolerance {
        let join = |serial: u32| self.track.get(serial).map(|piece| piece.element.join);
        match (join(serial), serial.checked_sub(1).and_then(join)) {
            (Some(Join::Blend(tolerance)), _) | (_, Some(Join::Blend(tolerance))) => tolerance,
            _ => self.bounds.tolerance,
        }
    }

    /// Share of the filter's tolerance for each unit of acceleration along the path, at the corner where `piece`
    /// begins: half the jump of the direction lies across. Nothing where `s` is too far from it, or where the limits
    /// are low enough anyway.
    fn at_corner(&self, piece: &Piece, per_acceleration: [f64; 2], s: f64) -> f64 {
        let (corner, bounds) = (&piece.corner, self.bounds);
        let [position, attitude] = [corner.turn, corner.others].map(|jump| 0.5 * jump);
        let share = [position * per_acceleration[0], attitude * per_acceleration[1]];
        // Two axes that turn may do so together.
        let turning = libm::fmin(SQRT_2 * bounds.spin, attitude * bounds.corner);
        let most = libm::fmax(share[0] * bounds.corner, per_acceleration[1] * turning);
        if piece.stop || most <= UNSEEN {
            return 0.0;
        }
        let share = libm::fmax(share[0], share[1]);
        let speed = libm::fmin(piece.element.feed, libm::sqrt(HALF * corner.half / share));
        // As far as the machine comes in half the filter's length.
        let half_time = 0.5 * bounds.filter;
        let way = corner.half + half_time * (speed + 0.5 * half_time * HALF / share);
        if libm::fabs(s - piece.start) < way {
            share
        } else {
            0.0
        }
    }
}
