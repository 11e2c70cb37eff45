//! The frame of Siemens programs inside the coordinate system: TRANS, ROT, MIRROR and SCALE, each in the coordinates of those
//! before it.

use super::offsets::Coordinates;
use shared::io::AXES;

/// Parts of a length that differ by less are the same.
const SAME: f64 = 1e-12;

/// From coordinates of the program to those of the coordinate system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) offset: Coordinates,
    /// Where X and Y of the program lead, each in X and Y.
    x: [f64; 2],
    y: [f64; 2],
    /// Where Z leads.
    z: f64,
    /// Sum of the rotations about Z \[deg\].
    rotation: f64,
    /// MIRROR or SCALE are in it.
    reshapes: bool,
}

impl Default for Frame {
    fn default() -> Self {
        Self {
            offset: [0.0; AXES],
            x: [1.0, 0.0],
            y: [0.0, 1.0],
            z: 1.0,
            rotation: 0.0,
            reshapes: false,
        }
    }
}

impl Frame {
    /// Goes on by an offset.
    pub(super) fn shift(&mut self, by: &Coordinates) {
        self.offset = self.apply(by);
    }

    /// Goes on by a rotation about Z \[deg\].
    pub(super) fn turn(&mut self, degrees: f64) {
        if degrees == 0.0 {
            return;
        }
        let (sin, cos) = degrees.to_radians().sin_cos();
        (self.x, self.y) = (self.direction([cos, sin]), self.direction([-sin, cos]));
        self.rotation += degrees;
    }

    /// Goes on by a factor for each of X, Y and Z; a negative one mirrors.
    pub(super) fn stretch(&mut self, [x, y, z]: [f64; 3]) {
        self.x = self.x.map(|part| part * x);
        self.y = self.y.map(|part| part * y);
        self.z *= z;
        self.reshapes = true;
    }

    /// A place of the program.
    pub(super) fn apply(&self, own: &Coordinates) -> Coordinates {
        let mut at: Coordinates = std::array::from_fn(|axis| self.offset[axis] + own[axis]);
        let [x, y] = self.direction([own[0], own[1]]);
        (at[0], at[1]) = (self.offset[0] + x, self.offset[1] + y);
        at[2] = self.offset[2] + self.z * own[2];
        at
    }

    /// The way back.
    pub(super) fn undo(&self, at: &Coordinates) -> Coordinates {
        let mut own: Coordinates = std::array::from_fn(|axis| at[axis] - self.offset[axis]);
        let [x, y] = [own[0], own[1]];
        let area = self.area();
        own[0] = (x * self.y[1] - y * self.y[0]) / area;
        own[1] = (y * self.x[0] - x * self.x[1]) / area;
        own[2] /= self.z;
        own
    }

    /// Where a direction in X and Y leads.
    pub(super) fn direction(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x * self.x[0] + y * self.y[0], x * self.x[1] + y * self.y[1]]
    }

    /// Whether X and Y of the program are not along those of the coordinate system.
    pub(super) fn turned(&self) -> bool {
        if self.reshapes {
            self.x[1].abs() > SAME || self.y[0].abs() > SAME
        } else {
            self.rotation != 0.0
        }
    }

    /// Whether MIRROR or SCALE hold.
    pub(super) fn reshapes(&self) -> bool {
        self.reshapes
    }

    /// Whether lengths along Z are as they are written.
    pub(super) fn keeps_z(&self) -> bool {
        self.z == 1.0
    }

    /// What an arc in X Y becomes: how many times as large, and whether its sense is the other one; none if it is no arc any more.
    pub(super) fn of_arcs(&self) -> Option<(f64, bool)> {
        let (x, y) = (self.x[0].hypot(self.x[1]), self.y[0].hypot(self.y[1]));
        let across = self.x[0] * self.y[0] + self.x[1] * self.y[1];
        let round = (x - y).abs() <= SAME * x && across.abs() <= SAME * x * y;
        round.then_some((x, self.area() < 0.0))
    }

    fn area(&self) -> f64 {
        self.x[0] * self.y[1] - self.x[1] * self.y[0]
    }

    pub(super) fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// As it is told.
    pub(super) fn words(&self) -> String {
        match self.reshapes {
            true => {
                let [[xx, xy], [yx, yy]] = [self.x, self.y];
                format!(
                    "X leads to [{xx:.6}, {xy:.6}], Y to [{yx:.6}, {yy:.6}], Z to {:.6}",
                    self.z
                )
            }
            false => format!("turned by {} deg about Z", self.rotation),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_back_is_that_of_the_way_there() {
        let mut frame = Frame::default();
        frame.shift(&[4.0, 3.0, 1.0, 5.0, 0.0, 0.0]);
        frame.turn(20.0);
        frame.stretch([-2.0, 1.5, -1.0]);
        frame.turn(-70.0);
        frame.shift(&[1.0, 0.0, 7.0, 0.0, 0.0, 0.0]);
        let own = [7.0, -3.0, 2.0, 1.0, 0.0, 9.0];
        let back = frame.undo(&frame.apply(&own));
        assert!(
            (0..AXES).all(|axis| (back[axis] - own[axis]).abs() < 1e-12),
            "{back:?}"
        );
        assert_eq!(frame.of_arcs(), None);
        assert!(frame.turned() && !frame.keeps_z());
    }

    #[test]
    fn arcs_stay_arcs_where_x_and_y_have_one_factor() {
        let mut frame = Frame::default();
        assert_eq!(frame.of_arcs(), Some((1.0, false)));
        frame.turn(30.0);
        frame.stretch([-1.0, 1.0, 1.0]);
        frame.turn(30.0);
        let (factor, other) = frame.of_arcs().expect("an arc");
        assert!((factor - 1.0).abs() < 1e-12 && other);
        // A reflection between two like rotations is one by itself.
        assert!(!frame.turned());
        frame.turn(-60.0);
        assert!(frame.turned());
    }
}
