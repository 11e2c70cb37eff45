//! Where tool and joints stand, and how the tool moves with each axis there (mathematics 8.2).

use super::least_squares::{Columns, ROWS};
use super::{Joint, SerialChain};
use crate::geometry::{Pose, PoseMotion};
use crate::io::AXES;
use crate::kinematics::KinematicsError;
use crate::kinematics::tool_axis::POLE_RATE;
use nalgebra::Vector3;

/// Tool and joints in the frame of the work.
pub(super) struct Stand<'a> {
    chain: &'a SerialChain,
    pub(super) pose: Pose,
    /// Of each joint, from the work to the tool.
    directions: [Vector3<f64>; AXES],
    points: [Vector3<f64>; AXES],
    /// How the tip moves with each linear axis, in the order of the chain.
    linear: Columns,
    /// How frame and tip move with each rotary axis, in the order of the chain, but for what the linear axes do.
    rotary: Columns,
    /// A rotary axis that has no effect here.
    idle: Option<usize>,
}

/// `v` turned about the unit vector `k` (Rodrigues).
#[inline(never)]
fn turned(k: &Vector3<f64>, (sin, cos): (f64, f64), v: &Vector3<f64>) -> Vector3<f64> {
    v * cos + k.cross(v) * sin + k * (k.dot(v) * (1.0 - cos))
}

/// Rows of a tip alone.
fn of_tip(tip: &Vector3<f64>) -> [f64; ROWS] {
    [tip.x, tip.y, tip.z, 0.0, 0.0, 0.0]
}

impl<'a> Stand<'a> {
    /// With the axes at `axes`.
    #[inline(never)]
    pub(super) fn at(chain: &'a SerialChain, axes: &[f64; AXES]) -> Self {
        let (mut directions, mut points) = ([Vector3::zeros(); AXES], [Vector3::zeros(); AXES]);
        // What lies at v while all axes are at 0, is at origin + columns·v behind the joints so far.
        let mut origin = Vector3::zeros();
        let mut columns = [Vector3::x(), Vector3::y(), Vector3::z()];
        for (i, joint) in chain.joints.iter().enumerate() {
            let direction = along(&columns, &joint.direction);
            directions[i] = direction;
            if joint.is_rotary() {
                let point = origin + along(&columns, &joint.point);
                points[i] = point;
                let angle = libm::sincos(axes[joint.axis]);
                for column in &mut columns {
                    *column = turned(&direction, angle, column);
                }
                origin = point + turned(&direction, angle, &(origin - point));
            } else {
                origin += direction * axes[joint.axis];
            }
        }
        let tool = &chain.tool;
        Self {
            chain,
            pose: Pose {
                position: origin + along(&columns, &tool.position),
                tangent: along(&columns, &tool.tangent),
                normal: along(&columns, &tool.normal),
            },
            directions,
            points,
            linear: Columns::none(3),
            rotary: Columns::none(3),
            idle: None,
        }
    }

    /// Finds how the tip moves with the linear axes.
    #[inline(never)]
    pub(super) fn find_ways(&mut self) {
        for (direction, joint) in self.directions.iter().zip(&self.chain.joints) {
            if !joint.is_rotary() {
                self.linear.push(of_tip(direction));
            }
        }
    }

    /// Moves the linear axes, and `axes` with them, so that the tip is as close to `position` as they bring it.
    #[inline(never)]
    pub(super) fn bring_tip(&mut self, position: &Vector3<f64>, axes: &mut [f64; AXES]) {
        let mut ways = self
            .linear
            .solve(&mut of_tip(&(position - self.pose.position)))
            .into_iter();
        let mut shift = Vector3::zeros();
        let stand = self.points.iter_mut().zip(&self.directions);
        for ((point, direction), joint) in stand.zip(&self.chain.joints) {
            if joint.is_rotary() {
                *point += shift;
            } else if let Some(way) = ways.next() {
                shift += direction * way;
                axes[joint.axis] += way;
            }
        }
        self.pose.position += shift;
    }

    /// Finds how the tool moves with the rotary axes, once it is known how with the linear ones.
    #[inline(never)]
    pub(super) fn find_turns(&mut self) {
        self.rotary = Columns::none(if self.linear.are_complete() { 3 } else { ROWS });
        for (i, joint) in self.chain.joints.iter().enumerate() {
            if joint.is_rotary() {
                let column = self.twist(&self.with(i, joint), &self.directions[i]);
                if !self.rotary.push(column) {
                    self.idle = Some(joint.axis);
                }
            }
        }
    }

    /// How the tip moves with joint `i`.
    #[inline(never)]
    fn with(&self, i: usize, joint: &Joint) -> Vector3<f64> {
        if joint.is_rotary() {
            self.directions[i].cross(&(self.pose.position - self.points[i]))
        } else {
            self.directions[i]
        }
    }

    /// What rotary axes have to do with a motion of the tip and a turn of the frame: without what linear axes do, and of a
    /// body of revolution without its turn about itself.
    #[inline(never)]
    fn twist(&self, tip: &Vector3<f64>, frame: &Vector3<f64>) -> [f64; ROWS] {
        let mut turn = *frame;
        if !self.chain.follows_tangent {
            turn -= self.pose.normal * self.pose.normal.dot(frame);
        }
        let mut rest = [0.0; ROWS];
        if !self.linear.are_complete() {
            rest = of_tip(tip);
            self.linear.solve(&mut rest);
        }
        [turn.x, turn.y, turn.z, rest[0], rest[1], rest[2]]
    }

    /// What is missing to `pose`, to first order.
    pub(super) fn missing(&self, pose: &Pose) -> [f64; ROWS] {
        let here = &self.pose;
        let spin = here.normal.dot(&here.tangent.cross(&pose.tangent));
        let turn = here.normal.cross(&pose.normal) + here.normal * spin;
        self.twist(&(pose.position - here.position), &turn)
    }

    /// How far it is off `pose`: the tip \[mm\], and the directions of the tool \[rad\].
    pub(super) fn off(&self, pose: &Pose) -> [f64; 2] {
        let mut squares = (self.pose.normal - pose.normal).norm_squared();
        if self.chain.follows_tangent {
            squares += (self.pose.tangent - pose.tangent).norm_squared();
        }
        let tip = (self.pose.position - pose.position).norm_squared();
        [libm::sqrt(tip), libm::sqrt(squares)]
    }

    /// Turns of the rotary axes that do what is `missing`, in the order of the chain \[rad\].
    pub(super) fn turns(&self, missing: &[f64; ROWS]) -> [f64; 3] {
        self.rotary.solve(&mut missing.clone())
    }

    /// Rates of the axes with which the tip moves by `tip` and its frame turns by `frame`, as far as the machine has them.
    #[inline(never)]
    fn rates(&self, mut tip: Vector3<f64>, frame: &Vector3<f64>) -> Result<[f64; AXES], KinematicsError> {
        let mut goal = self.twist(&tip, frame);
        let mut turns = self.rotary.solve(&mut goal).into_iter();
        if let Some(axis) = self.idle
            && !goal.iter().all(|rest| libm::fabs(*rest) <= POLE_RATE)
        {
            return Err(KinematicsError::Pole { axis });
        }
        let mut rates = [0.0; AXES];
        for (i, joint) in self.chain.joints.iter().enumerate() {
            if joint.is_rotary()
                && let Some(rate) = turns.next()
            {
                rates[joint.axis] = rate;
                tip -= self.with(i, joint) * rate;
            }
        }
        let mut ways = self.linear.solve(&mut of_tip(&tip)).into_iter();
        for joint in self.chain.joints.iter().filter(|joint| !joint.is_rotary()) {
            rates[joint.axis] = ways.next().unwrap_or_default();
        }
        Ok(rates)
    }

    /// Velocities and accelerations of the axes for a tool that moves by `motion`.
    #[inline(never)]
    pub(super) fn motion(&self, motion: &PoseMotion) -> Result<([f64; AXES], [f64; AXES]), KinematicsError> {
        let rates = self.rates(motion.velocity, &motion.angular_velocity)?;
        // Velocity of the tip that the joints from here on make.
        let mut rest = Vector3::zeros();
        for (i, joint) in self.chain.joints.iter().enumerate() {
            rest += self.with(i, joint) * rates[joint.axis];
        }
        // What carries the joint turns by ω; accelerations of tip and frame with these rates alone.
        let mut omega = Vector3::zeros();
        let (mut tip, mut frame) = (Vector3::zeros(), Vector3::zeros());
        for (i, joint) in self.chain.joints.iter().enumerate() {
            let moves = self.with(i, joint) * rates[joint.axis];
            tip += omega.cross(&moves);
            if joint.is_rotary() {
                let turns = self.directions[i] * rates[joint.axis];
                tip += turns.cross(&rest);
                frame += omega.cross(&turns);
                omega += turns;
            }
            rest -= moves;
        }
        let mut wanted = motion.angular_acceleration;
        if !self.chain.follows_tangent {
            // The same N̈ of a tool that spins about N by more than asked for.
            let spin = (omega - motion.angular_velocity).dot(&self.pose.normal);
            wanted += motion.angular_velocity.cross(&self.pose.normal) * spin;
        }
        let accelerations = self.rates(motion.acceleration - tip, &(wanted - frame))?;
        Ok((rates, accelerations))
    }
}

/// Columns times `v`.
#[inline(never)]
fn along(columns: &[Vector3<f64>; 3], v: &Vector3<f64>) -> Vector3<f64> {
    columns[0] * v.x + columns[1] * v.y + columns[2] * v.z
}
