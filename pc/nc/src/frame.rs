//! A frame inside the coordinate system: TRANS, ROT, MIRROR and SCALE of Siemens programs, each in the coordinates of those before it,
//! and what of other controllers is carried out as these, such as a tilted plane.

use super::offsets::{Coordinates, linear};
use nalgebra::{Matrix3, Rotation3, Vector3};
use shared::io::AXES;

/// Parts of a length that differ by less are the same.
pub(super) const SAME: f64 = 1e-12;

/// From coordinates of the program to those of the coordinate system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) offset: Coordinates,
    /// Its columns are where X, Y and Z of the program lead.
    matrix: Matrix3<f64>,
    /// Sum of the rotations about Z \[deg\], if all of it was turned by is about Z.
    rotation: Option<f64>,
    /// MIRROR or SCALE are in it.
    reshapes: bool,
}

impl Default for Frame {
    fn default() -> Self {
        Self {
            offset: [0.0; AXES],
            matrix: Matrix3::identity(),
            rotation: Some(0.0),
            reshapes: false,
        }
    }
}

impl Frame {
    /// Goes on by an offset.
    pub(super) fn shift(&mut self, by: &Coordinates) {
        self.offset = self.apply(by);
    }

    /// Goes on by a rotation about X, Y or Z \[deg\].
    pub(super) fn turn(&mut self, axis: usize, degrees: f64) {
        if degrees == 0.0 {
            return;
        }
        let about = Vector3::ith_axis(axis);
        self.matrix *= Rotation3::from_axis_angle(&about, degrees.to_radians()).matrix();
        self.rotation = self.rotation.filter(|_| axis == 2).map(|before| before + degrees);
    }

    /// Goes on by axes of length 1, at right angles and right-handed.
    pub(super) fn turn_to(&mut self, axes: [Vector3<f64>; 3]) {
        self.matrix *= Matrix3::from_columns(&axes);
        self.rotation = None;
    }

    /// Goes on by a factor for each of X, Y and Z; a negative one mirrors.
    pub(super) fn stretch(&mut self, factors: [f64; 3]) {
        for (mut column, factor) in self.matrix.column_iter_mut().zip(factors) {
            column *= factor;
        }
        self.reshapes = true;
    }

    /// A place of the program.
    pub(super) fn apply(&self, own: &Coordinates) -> Coordinates {
        let mut at: Coordinates = std::array::from_fn(|axis| self.offset[axis] + own[axis]);
        for (axis, part) in self.direction(linear(own)).into_iter().enumerate() {
            at[axis] = self.offset[axis] + part;
        }
        at
    }

    /// The way back.
    pub(super) fn undo(&self, at: &Coordinates) -> Coordinates {
        let mut own: Coordinates = std::array::from_fn(|axis| at[axis] - self.offset[axis]);
        if !self.is_straight() {
            // Factors of 0 are refused, so that there is always an inverse.
            let back = self.matrix.try_inverse().unwrap_or_default();
            let programmed = back * Vector3::from(linear(&own));
            own[..3].copy_from_slice(programmed.as_slice());
        }
        own
    }

    /// Where a direction leads.
    pub(super) fn direction(&self, own: [f64; 3]) -> [f64; 3] {
        match self.is_straight() {
            true => own,
            false => (self.matrix * Vector3::from(own)).into(),
        }
    }

    /// The axes of the program that are not along those of the coordinate system: none, X and Y, or all three.
    pub(super) fn coupled(&self) -> &'static [usize] {
        let leads = |to: usize, from: usize| self.matrix[(to, from)].abs() > SAME;
        let tilted = leads(2, 0) || leads(2, 1) || leads(0, 2) || leads(1, 2);
        match (self.rotation, self.reshapes) {
            (Some(0.0), false) => &[],
            (Some(_), false) => &[0, 1],
            _ if tilted => &[0, 1, 2],
            _ if leads(0, 1) || leads(1, 0) => &[0, 1],
            _ => &[],
        }
    }

    /// Whether MIRROR or SCALE hold.
    pub(super) fn reshapes(&self) -> bool {
        self.reshapes
    }

    /// Whether lengths along Z are as they are written.
    pub(super) fn keeps_z(&self) -> bool {
        let z = self.matrix.column(2);
        !self.reshapes || [z.x, z.y, z.z] == [0.0, 0.0, 1.0]
    }

    pub(super) fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// Whether X Y Z are along those of the coordinate system, and as long.
    fn is_straight(&self) -> bool {
        self.rotation == Some(0.0) && !self.reshapes
    }

    /// By how much it is turned about Z \[deg\], if it does nothing else to directions.
    pub(super) fn turned_about_z(&self) -> Option<f64> {
        self.rotation.filter(|_| !self.reshapes)
    }

    /// Where X, Y and Z of the program lead.
    pub(super) fn axes(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|axis| self.matrix.column(axis).into_owned().into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_back_is_that_of_the_way_there() {
        let mut frame = Frame::default();
        frame.shift(&[4.0, 3.0, 1.0, 5.0, 0.0, 0.0]);
        frame.turn(2, 20.0);
        frame.stretch([-2.0, 1.5, -1.0]);
        frame.turn(2, -70.0);
        frame.shift(&[1.0, 0.0, 7.0, 0.0, 0.0, 0.0]);
        let own = [7.0, -3.0, 2.0, 1.0, 0.0, 9.0];
        let back = |frame: &Frame| {
            let back = frame.undo(&frame.apply(&own));
            assert!(
                (0..AXES).all(|axis| (back[axis] - own[axis]).abs() < 1e-12),
                "{back:?}"
            );
        };
        back(&frame);
        assert!(frame.coupled() == [0, 1] && !frame.keeps_z());
        frame.turn(0, 35.0);
        frame.turn(1, -110.0);
        back(&frame);
        assert_eq!(frame.coupled(), [0, 1, 2]);
    }

    #[test]
    fn rotations_go_on_about_axes_that_were_turned() {
        let mut frame = Frame::default();
        assert!(frame.coupled().is_empty());
        // Z leads to -Y, and the rotation about Y, which leads to Z now, turns X to Y.
        frame.turn(0, 90.0);
        frame.turn(1, 90.0);
        let near = |own: [f64; 3], expected: [f64; 3]| {
            let to = frame.direction(own);
            assert!(
                (0..3).all(|axis| (to[axis] - expected[axis]).abs() < 1e-12),
                "{to:?}"
            );
        };
        near([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        near([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
        near([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
        assert_eq!(frame.turned_about_z(), None);
    }
}
