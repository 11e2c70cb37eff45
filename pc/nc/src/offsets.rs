//! From coordinates of the program to the tip: coordinate systems, G52 and G92 (RS274/NGC as LinuxCNC has it).
//!
//! tip = offset of the system + rotation about Z · (local offset + frame(programmed)); rotary axes have offsets alone. The frame is
//! that of Siemens programs, and a tilted plane.

use super::frame::{Frame, SAME};
use super::mirror::Foreign;
use super::program::Plane;
use super::tilt::Tilt;
use nalgebra::Vector3;
use shared::geometry::Turn;
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
    /// The tilted plane, if there is one, with TRANS, ROT, MIRROR and SCALE in it.
    pub(super) frame: Frame,
    pub(super) tilt: Option<Tilt>,
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

    /// The axes of the program that are not along those of the tip, each of which leads more than one axis of the tip: none, X and Y,
    /// or all three.
    pub(super) fn coupled(&self) -> &'static [usize] {
        match self.frame.coupled() {
            [] if self.system().rotation != 0.0 => &[0, 1],
            coupled => coupled,
        }
    }

    /// `axes`, and those that are coupled to one of them.
    pub(super) fn with_coupled(&self, axes: &[usize]) -> Vec<usize> {
        let coupled = self.coupled();
        let reaches = axes.iter().any(|axis| coupled.contains(axis));
        let more = coupled.iter().filter(|axis| reaches && !axes.contains(axis));
        axes.iter().chain(more).copied().collect()
    }

    /// Whether some of the coupled axes are `said`, but not all.
    pub(super) fn says_in_part(&self, said: &[Option<f64>]) -> bool {
        let coupled = self.coupled();
        let count = coupled.iter().filter(|axis| said[**axis].is_some()).count();
        count > 0 && count < coupled.len()
    }

    /// Whether Z of the program is not along that of the tip.
    pub(super) fn tilted(&self) -> bool {
        self.coupled().len() > 2
    }

    /// Whether TRANS, ROT, MIRROR or SCALE hold, or a tilted plane.
    pub(super) fn has_frame(&self) -> bool {
        !self.frame.is_none()
    }

    /// What frames begin from: the tilted plane, if there is one.
    pub(super) fn base(&self) -> Frame {
        self.tilt.map_or_else(Frame::default, |tilt| tilt.frame)
    }

    /// Where a direction leads, with the system and the frame.
    pub(super) fn direction(&self, own: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.frame.direction(own);
        let [x, y] = turn([x, y], self.system().rotation);
        [x, y, z]
    }

    /// What becomes of arcs in a plane of the program; none if they are arcs no more.
    pub(super) fn arcs(&self, plane: Plane) -> Option<Arcs> {
        let [a, b] = plane.axes().map(|axis| {
            let mut own = [0.0; 3];
            own[axis] = 1.0;
            Vector3::from(self.direction(own))
        });
        let (length, other) = (a.norm(), b.norm());
        let round = (length - other).abs() <= SAME * length && a.dot(&b).abs() <= SAME * length * other;
        let (about, mirrored) = about(a.cross(&b));
        round.then_some(Arcs {
            factor: length,
            about,
            mirrored,
        })
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

/// Arcs of the program in coordinates of the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arcs {
    /// How many times as large they are.
    pub(super) factor: f64,
    /// Axis that they go about, of length 1.
    pub(super) about: [f64; 3],
    mirrored: bool,
}

impl Arcs {
    /// The sense of one, seen from the end of the axis.
    pub(super) fn turn(&self, programmed: Turn) -> Turn {
        match (programmed, self.mirrored) {
            (Turn::Clockwise, true) => Turn::CounterClockwise,
            (Turn::CounterClockwise, true) => Turn::Clockwise,
            (turn, false) => turn,
        }
    }
}

/// The axis that an arc with this normal goes about, of length 1; along X, Y or Z it is that axis, and whether it was the other end of it.
pub(super) fn about(normal: Vector3<f64>) -> ([f64; 3], bool) {
    let about = normal.normalize();
    let along = about.iamax();
    match (about.amax() - 1.0).abs() <= SAME {
        true => (Vector3::ith(along, 1.0).into(), about[along] < 0.0),
        false => (about.into(), false),
    }
}

/// X Y Z.
pub(super) fn linear(at: &Coordinates) -> [f64; 3] {
    [at[0], at[1], at[2]]
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
        offsets.frame.turn(2, 20.0);
        offsets.frame.shift(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        there(&offsets);
        assert_eq!(offsets.with_coupled(&[1, 3]), [1, 3, 0]);
        offsets.frame.turn(0, -40.0);
        there(&offsets);
        assert_eq!(offsets.with_coupled(&[3]), [3]);
        assert!(offsets.with_coupled(&[2]).len() == 3 && offsets.tilted());
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

    #[test]
    fn arcs_stay_arcs_where_the_axes_of_their_plane_have_one_factor() {
        let mut offsets = Offsets::default();
        let arcs = |offsets: &Offsets, plane| {
            offsets
                .arcs(plane)
                .map(|arcs| (arcs.factor, arcs.about, arcs.mirrored))
        };
        assert_eq!(arcs(&offsets, Plane::Zx), Some((1.0, [0.0, 1.0, 0.0], false)));
        offsets.frame.turn(2, 30.0);
        offsets.frame.stretch([-1.0, 1.0, 1.0]);
        offsets.frame.turn(2, 30.0);
        let (factor, about, mirrored) = arcs(&offsets, Plane::Xy).expect("an arc");
        assert!((factor - 1.0).abs() < 1e-12 && about == [0.0, 0.0, 1.0] && mirrored);
        // A reflection between two like rotations is one by itself.
        assert!(offsets.coupled().is_empty());
        offsets.frame.stretch([2.0, 1.0, 1.0]);
        assert_eq!(arcs(&offsets, Plane::Xy), None);
        assert!(arcs(&offsets, Plane::Yz).is_some());
    }

    #[test]
    fn arcs_of_a_tilted_plane_go_about_its_own_axis() {
        let mut offsets = Offsets::default();
        offsets.frame.turn(0, 90.0);
        let arcs = offsets.arcs(Plane::Xy).expect("an arc");
        // X to Y of the program is X to Z of the tip, which is clockwise about Y.
        assert_eq!(
            (arcs.about, arcs.turn(Turn::CounterClockwise)),
            ([0.0, 1.0, 0.0], Turn::Clockwise)
        );
        offsets.frame.turn(0, -60.0);
        let arcs = offsets.arcs(Plane::Xy).expect("an arc");
        let (sin, cos) = 30f64.to_radians().sin_cos();
        assert!((Vector3::from(arcs.about) - Vector3::new(0.0, -sin, cos)).norm() < 1e-12);
        assert_eq!(arcs.turn(Turn::Clockwise), Turn::Clockwise);
    }
}
