//! From coordinates of the program to the tip: coordinate systems, G52 and G92 (RS274/NGC as LinuxCNC has it).
//!
//! tip = offset of the system + rotation about Z · (local offset + frame(programmed)); rotary axes have offsets alone. The frame is
//! that of Siemens programs.

use super::frame::Frame;
use super::mirror::Foreign;
use shared::io::AXES;

/// Coordinate systems, G54 to G59.3.
pub const SYSTEMS: usize = 9;
/// Index of the one without an offset, G500, which nothing sets.
pub(super) const NO_SYSTEM: usize = SYSTEMS;

/// X Y Z \[mm\], A B C \[deg\].
pub(super) type Coordinates = [f64; AXES];

/// One coordinate system.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CoordinateSystem {
    /// Its origin: X Y Z of the tip \[mm\], A B C \[deg\].
    pub offset: [f64; AXES],
    /// About Z, counter-clockwise \[deg\].
    pub rotation: f64,
}

/// All offsets.
#[derive(Clone, Debug, Default)]
pub(super) struct Offsets {
    pub(super) systems: [CoordinateSystem; SYSTEMS + 1],
    /// Index of the one that holds.
    pub(super) active: usize,
    /// Index of the one that was told last to be where it was set at the machine, or not to be.
    pub(super) told: Option<usize>,
    /// G52 and G92, as they are kept.
    pub(super) local: Coordinates,
    /// Whether that holds.
    pub(super) local_on: bool,
    /// TRANS, ROT, MIRROR and SCALE.
    pub(super) frame: Frame,
    /// What of other controllers the frame is made of, if not of those.
    pub(super) foreign: Foreign,
}

impl Offsets {
    /// Those that a program begins with: in the first system, which is G54.
    pub(super) fn new(systems: &[CoordinateSystem; SYSTEMS]) -> Self {
        let mut offsets = Self::default();
        offsets.systems[..SYSTEMS].copy_from_slice(systems);
        offsets
    }

    pub(super) fn system(&self) -> &CoordinateSystem {
        &self.systems[self.active]
    }

    /// G52 or G92 as it holds now.
    pub(super) fn local_now(&self) -> Coordinates {
        if self.local_on { self.local } else { [0.0; AXES] }
    }

    /// Whether X and Y of the program are not along those of the tip.
    pub(super) fn turned(&self) -> bool {
        self.system().rotation != 0.0 || self.frame.turned()
    }

    /// Whether TRANS, ROT, MIRROR or SCALE hold.
    pub(super) fn has_frame(&self) -> bool {
        !self.frame.is_none()
    }

    /// A direction in the plane X Y, turned with the system and the frame.
    pub(super) fn direction(&self, own: [f64; 2]) -> [f64; 2] {
        turn(self.frame.direction(own), self.system().rotation)
    }

    pub(super) fn to_tip(&self, programmed: &Coordinates) -> Coordinates {
        let local = self.local_now();
        let framed = self.frame.apply(programmed);
        let mut tip: Coordinates = std::array::from_fn(|i| framed[i] + local[i]);
        [tip[0], tip[1]] = turn([tip[0], tip[1]], self.system().rotation);
        std::array::from_fn(|i| tip[i] + self.system().offset[i])
    }

    pub(super) fn to_programmed(&self, tip: &Coordinates) -> Coordinates {
        let local = self.local_now();
        let from_system = self.in_system(tip);
        self.frame
            .undo(&std::array::from_fn(|i| from_system[i] - local[i]))
    }

    /// Coordinates in the system, without the local offset.
    pub(super) fn in_system(&self, tip: &Coordinates) -> Coordinates {
        let mut own: Coordinates = std::array::from_fn(|i| tip[i] - self.system().offset[i]);
        [own[0], own[1]] = turn([own[0], own[1]], -self.system().rotation);
        own
    }
}

fn turn([x, y]: [f64; 2], degrees: f64) -> [f64; 2] {
    if degrees == 0.0 {
        return [x, y];
    }
    let (sin, cos) = degrees.to_radians().sin_cos();
    [x * cos - y * sin, x * sin + y * cos]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_back_is_that_of_the_way_there() {
        let mut offsets = Offsets::default();
        offsets.systems[2] = CoordinateSystem {
            offset: [100.0, -20.0, 3.0, 10.0, 0.0, -90.0],
            rotation: 30.0,
        };
        offsets.active = 2;
        (offsets.local, offsets.local_on) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], true);
        let there = |offsets: &Offsets| {
            let programmed = [7.0, -3.0, 2.0, 1.0, 0.0, 9.0];
            let back = offsets.to_programmed(&offsets.to_tip(&programmed));
            assert!(
                (0..6).all(|i| (back[i] - programmed[i]).abs() < 1e-12),
                "{back:?}"
            );
        };
        offsets.frame.shift(&[4.0, 3.0, 1.0, 0.0, 0.0, 0.0]);
        offsets.frame.turn(20.0);
        offsets.frame.shift(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        there(&offsets);
        offsets.frame = Frame::default();
        let tip = offsets.to_tip(&[10.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let expected = [
            100.0 + 11.0 * cos - 2.0 * sin,
            -20.0 + 11.0 * sin + 2.0 * cos,
            6.0,
        ];
        for i in 0..3 {
            assert!((tip[i] - expected[i]).abs() < 1e-12, "{tip:?}");
        }
        assert_eq!(tip[3..], [14.0, 5.0, -84.0]);
        let back = offsets.to_programmed(&tip);
        assert!((back[0] - 10.0).abs() < 1e-12 && back[1..].iter().all(|x| x.abs() < 1e-12));
    }
}
