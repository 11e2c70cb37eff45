//! Programs of which each makes the planner work in another way.

use core::f64::consts::PI;
use nalgebra::Vector3;
use shared::geometry::{Arc, Line, Pose, Turn};
use shared::io::AXES;
use shared::kinematics::{AxisLimits, Kinematics};
use shared::trajectory::{CHANNELS, Cubic, Element, Join, PathSpace, PlanLimits, SHAPED, Shape, Tolerance};

/// A program on the dual-beam gantry.
pub struct Program {
    /// Its name.
    pub name: &'static str,
    /// What its channels are.
    pub space: PathSpace,
    /// How many elements it has.
    pub elements: usize,
    /// Highest speed along it \[mm/s\].
    feed: f64,
    /// Shape and length of an element; in axis space the shape only, the rest goes by [`turned`].
    shape: fn(usize) -> Option<(Shape, f64)>,
    /// How far A, B and C turn at the place where an element begins \[rad\].
    turned: fn(usize) -> [f64; SHAPED],
}

/// All of them.
pub const PROGRAMS: [Program; 6] = [
    // Three times round a square of 20 mm: long lines, corners.
    Program {
        name: "square",
        space: PathSpace::Axes,
        elements: 12,
        feed: 100.0,
        shape: square,
        turned: straight,
    },
    // Half circles, one to the left, one to the right: curvature steps at their ends.
    Program {
        name: "arcs",
        space: PathSpace::Axes,
        elements: 10,
        feed: 100.0,
        shape: arcs,
        turned: straight,
    },
    // Lines of 0.5 mm along a wave: a chain.
    Program {
        name: "short-lines",
        space: PathSpace::Axes,
        elements: 300,
        feed: 100.0,
        shape: wave,
        turned: straight,
    },
    // Lines of 10 mm on which all six axes move.
    Program {
        name: "six-axes",
        space: PathSpace::Axes,
        elements: 40,
        feed: 100.0,
        shape: zigzag,
        turned: turning_by_sines,
    },
    // A straight seam along which the head turns, in splines, through the kinematics.
    Program {
        name: "seam",
        space: PathSpace::Tool,
        elements: 40,
        feed: 83.0,
        shape: seam,
        turned: wave_every_8_mm,
    },
    // The chain again, through the kinematics, with the head turning.
    Program {
        name: "short-lines-tool",
        space: PathSpace::Tool,
        elements: 300,
        feed: 100.0,
        shape: wave,
        turned: wave_every_half_mm,
    },
];

/// Limits of a machine for cutting rather than welding, in axis space: acceleration and jerk of every axis
/// \[mm/s², mm/s³, rotary °/s², °/s³\], and jerk of the path.
const ACCELERATION: f64 = 2000.0;
const JERK: f64 = 200_000.0;
/// Limits along the path in tool space \[mm/s², mm/s³\].
const PATH_ACCELERATION: f64 = 500.0;
const PATH_JERK: f64 = 10_000.0;
/// What corners may take, and what the output filter is made for.
const TOLERANCE: Tolerance = Tolerance {
    position: 0.05,
    attitude: 0.001,
};
/// Where the path begins, inside the travel \[mm\].
const ORIGIN: Vector3<f64> = Vector3::new(900.0, 900.0, 100.0);

impl Program {
    /// Limits to plan by; `axes` are those of the machine.
    pub fn limits(&self, axes: &[AxisLimits; AXES]) -> PlanLimits {
        let mut limits = PlanLimits::of(axes, PATH_ACCELERATION, PATH_JERK, TOLERANCE.position);
        if self.space == PathSpace::Axes {
            let unit = |axis: usize| if axis < SHAPED { 1.0 } else { PI / 180.0 };
            limits.velocity = [f64::INFINITY; AXES];
            limits.acceleration = core::array::from_fn(|axis| ACCELERATION * unit(axis));
            limits.jerk = core::array::from_fn(|axis| JERK * unit(axis));
            limits.path_acceleration = ACCELERATION;
            limits.path_jerk = JERK;
        }
        limits
    }

    /// Where the axes stand before it; `None` if it is no program of the machine.
    pub fn start(&self, kinematics: &Kinematics) -> Option<[f64; AXES]> {
        let axes = self.axes(0);
        match self.space {
            PathSpace::Axes => Some(axes),
            PathSpace::Tool => {
                let Pose { tangent, normal, .. } = kinematics.forward(&axes);
                let pose = Pose::new(ORIGIN, tangent, normal).ok()?;
                kinematics.inverse(&pose, &axes).ok()
            }
        }
    }

    /// Element number `index`.
    pub fn element(&self, kinematics: &Kinematics, index: usize) -> Option<Element> {
        let (shape, length) = (self.shape)(index)?;
        let rest = match self.space {
            PathSpace::Axes => {
                let [from, to] = [index, index + 1].map(self.turned);
                let mut rest = [Cubic::default(); CHANNELS - SHAPED];
                for (i, channel) in rest.iter_mut().take(SHAPED).enumerate() {
                    *channel = Cubic::linear(from[i], to[i], length);
                }
                rest
            }
            PathSpace::Tool => self.attitude(kinematics, index, length),
        };
        let join = if index + 1 == self.elements {
            Join::Stop
        } else {
            Join::Blend(TOLERANCE)
        };
        Some(Element {
            line: index as u32 + 1,
            shape,
            rest,
            length,
            feed: self.feed,
            join,
        })
    }

    /// Axes that hold the head as it is where element number `index` begins.
    fn axes(&self, index: usize) -> [f64; AXES] {
        let [x, y, z] = ORIGIN.into();
        let [a, b, c] = (self.turned)(index);
        [x, y, z, a, b, c]
    }

    /// T and N along an element: splines through those of the ends of the elements.
    fn attitude(&self, kinematics: &Kinematics, index: usize, length: f64) -> [Cubic; CHANNELS - SHAPED] {
        let at = |index: usize| {
            let pose = kinematics.forward(&self.axes(index));
            let mut channels = [0.0; CHANNELS - SHAPED];
            channels[..SHAPED].copy_from_slice(pose.tangent.as_slice());
            channels[SHAPED..2 * SHAPED].copy_from_slice(pose.normal.as_slice());
            channels
        };
        // Slopes across the neighbours, and none at the ends.
        let slope = |here: usize, channel: usize| {
            if here == 0 || here == self.elements {
                0.0
            } else {
                (at(here + 1)[channel] - at(here - 1)[channel]) / (2.0 * length)
            }
        };
        let [from, to] = [at(index), at(index + 1)];
        core::array::from_fn(|i| {
            Cubic::hermite([from[i], slope(index, i)], [to[i], slope(index + 1, i)], length)
        })
    }
}

fn line(from: Vector3<f64>, to: Vector3<f64>) -> Option<(Shape, f64)> {
    let line = Line::new(ORIGIN + from, ORIGIN + to).ok()?;
    Some((Shape::Line(line), (to - from).norm()))
}

fn square(index: usize) -> Option<(Shape, f64)> {
    let corner = |index: usize| match index % 4 {
        0 => Vector3::zeros(),
        1 => Vector3::new(20.0, 0.0, 0.0),
        2 => Vector3::new(20.0, 20.0, 0.0),
        _ => Vector3::new(0.0, 20.0, 0.0),
    };
    line(corner(index), corner(index + 1))
}

fn arcs(index: usize) -> Option<(Shape, f64)> {
    const RADIUS: f64 = 10.0;
    let end = |index: usize| ORIGIN + Vector3::x() * (2.0 * RADIUS * index as f64);
    let turn = if index.is_multiple_of(2) {
        Turn::Clockwise
    } else {
        Turn::CounterClockwise
    };
    let centre = end(index) + Vector3::x() * RADIUS;
    let arc = Arc::about_centre(end(index), end(index + 1), centre, Vector3::z(), turn).ok()?;
    Some((Shape::Arc(arc), arc.length()))
}

fn wave(index: usize) -> Option<(Shape, f64)> {
    let at = |index: usize| {
        let x = 0.5 * index as f64;
        Vector3::new(x, 5.0 * libm::sin(x / 10.0), 1.0 - libm::cos(x / 15.0))
    };
    line(at(index), at(index + 1))
}

fn zigzag(index: usize) -> Option<(Shape, f64)> {
    let at = |index: usize| {
        let side = (index % 2) as f64;
        Vector3::new(8.0 * index as f64, 5.0 * side, -3.0 * side)
    };
    line(at(index), at(index + 1))
}

fn seam(index: usize) -> Option<(Shape, f64)> {
    let at = |index: usize| Vector3::x() * (8.0 * index as f64);
    line(at(index), at(index + 1))
}

fn straight(_: usize) -> [f64; SHAPED] {
    [0.0; SHAPED]
}

fn turning_by_sines(index: usize) -> [f64; SHAPED] {
    let k = index as f64;
    [0.3, 0.7, 1.1].map(|rate| 0.05 * libm::sin(rate * k))
}

fn wave_every_8_mm(index: usize) -> [f64; SHAPED] {
    attitude_wave(8.0 * index as f64)
}

fn wave_every_half_mm(index: usize) -> [f64; SHAPED] {
    attitude_wave(0.5 * index as f64)
}

/// As over a curved seam: some degrees back and forth, after `x` \[mm\].
fn attitude_wave(x: f64) -> [f64; SHAPED] {
    [
        0.06 * libm::sin(x / 50.0),
        0.08 * libm::cos(x / 80.0),
        0.2 * libm::cos(x / 100.0),
    ]
}
