//! The paths that are run, from where the axes stand.

use nalgebra::Vector3;
use shared::geometry::Pose;
use shared::kinematics::AXIS_UNIT;
use shared::protocol::{
    Channel, MotionStatus, PathAction, PathChannel, PathElement, PathEvent, PathJoin, PathLimits, PathShape,
    Request,
};
use shared::trajectory::{CHANNELS, Knot, PathSpace};
use virtual_nucleo::session::parameters;

/// Where the tool is.
fn pose(status: &MotionStatus) -> Pose {
    let configured = parameters().expect("a machine");
    let Some(Request::ConfigureMotion(config)) = configured.first() else {
        panic!("the motion board's come first")
    };
    let kinematics = config.kinematics().expect("a machine");
    let axes = std::array::from_fn(|axis| status.reference[axis] * AXIS_UNIT[axis]);
    kinematics.forward(&axes)
}

fn numbers(v: Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z]
}

const LIMITS: PathLimits = PathLimits {
    acceleration_mm_s2: 1000.0,
    jerk_mm_s3: 20_000.0,
    tolerance_mm: 0.05,
};

/// Number and length \[mm\] of the path along the seam, and where on it the tracker follows and both beams burn \[mm\].
pub const TRACKED: u32 = 8;
const TRACKED_MM: f64 = 300.0;
const FOLLOWS: [f64; 2] = [2.0, 285.0];
pub const BURNS: [f64; 2] = [120.0, 265.0];

/// Straight ahead along a seam, with both beams: requests to both boards.
pub fn tracked(status: &MotionStatus) -> [Vec<Request>; 2] {
    let begin = pose(status);
    let end = begin.position + begin.tangent * TRACKED_MM;
    let attitude = [numbers(begin.tangent), numbers(begin.normal)];
    let element = PathElement {
        line: 1,
        shape: PathShape::Line {
            start: numbers(begin.position),
            end: numbers(end),
        },
        rest: std::array::from_fn(|channel| {
            let value = attitude.as_flattened().get(channel).copied();
            PathChannel::Constant(value.unwrap_or(0.0))
        }),
        length_mm: TRACKED_MM,
        feed_mm_s: 100.0,
        join: PathJoin::Stop,
    };
    let at = |s_mm, action| PathEvent { s_mm, action };
    let power = |side| at(0.5, PathAction::Power { side, watt: 2000.0 });
    let beam = |side, on: bool| at(BURNS[usize::from(!on)], PathAction::Beam { side, on });
    let follow = |on: bool| at(FOLLOWS[usize::from(!on)], PathAction::Tracking { on });
    let events = [
        power(0),
        power(1),
        follow(true),
        beam(0, true),
        beam(1, true),
        beam(0, false),
        beam(1, false),
        follow(false),
    ];
    let knot = |s_mm, position: Vector3<f64>| Knot {
        s_mm,
        value: channels([numbers(position), attitude[0], attitude[1]]),
        slope: channels([numbers(begin.tangent), [0.0; 3], [0.0; 3]]),
    };
    let (id, space) = (TRACKED, PathSpace::Tool);
    let motion = vec![
        Request::BeginPath {
            id,
            space,
            start_s_mm: 0.0,
            limits: LIMITS,
        },
        Request::LoadElements {
            elements: [element].into_iter().collect(),
            last: true,
        },
        Request::LoadEvents(events.into_iter().collect()),
    ];
    let knots = [knot(0.0, begin.position), knot(TRACKED_MM, end)];
    let tracker = vec![
        Request::ClearPath { id, space },
        Request::LoadKnots(knots.into_iter().collect()),
    ];
    [motion, tracker]
}

/// Channels of a path whose V slides stay at zero.
fn channels(of_pose: [[f64; 3]; 3]) -> [f64; CHANNELS] {
    std::array::from_fn(|channel| of_pose.as_flattened().get(channel).copied().unwrap_or(0.0))
}

/// A line away from the marks, another one on which the tip turns about two axes, round a corner, and half a
/// circle, with both beams.
pub fn untracked(status: &MotionStatus) -> Vec<Request> {
    let begin = pose(status);
    let across = begin.normal.cross(&begin.tangent);
    let turned = [
        across * 0.1 + begin.normal * 0.05,
        begin.tangent * -0.05 + across * 0.08,
    ];
    let level = PathJoin::Blend {
        position_mm: 0.05,
        attitude_rad: 1e-3,
    };
    let corner = begin.position + Vector3::new(120.0, 80.0, -30.0);
    let edge = corner + Vector3::new(10.0, 60.0, 0.0);
    let centre = edge + Vector3::new(15.0, 0.0, 0.0);
    let end = edge + Vector3::new(30.0, 0.0, 0.0);
    // T and N are `part` of the turn on where an element begins, and turn by `rate` of it for each mm.
    let rest = |part: f64, rate: f64| {
        let mut rest = [PathChannel::Constant(0.0); 8];
        for (place, (from, turn)) in [(begin.tangent, turned[0]), (begin.normal, turned[1])]
            .into_iter()
            .enumerate()
        {
            for axis in 0..3 {
                rest[3 * place + axis] =
                    PathChannel::Linear([from[axis] + part * turn[axis], rate * turn[axis]]);
            }
        }
        rest
    };
    let line = |number, from: Vector3<f64>, to: Vector3<f64>, turns: bool| {
        let length = (to - from).norm();
        PathElement {
            line: number,
            shape: PathShape::Line {
                start: numbers(from),
                end: numbers(to),
            },
            rest: rest(0.0, if turns { 1.0 / length } else { 0.0 }),
            length_mm: length,
            feed_mm_s: 150.0,
            join: level,
        }
    };
    let arc = PathElement {
        line: 3,
        shape: PathShape::Arc {
            start: numbers(edge),
            end: numbers(end),
            centre: numbers(centre),
            axis: [0.0, 0.0, 1.0],
            turns: 0,
        },
        rest: rest(1.0, 0.0),
        length_mm: std::f64::consts::PI * 15.0,
        feed_mm_s: 90.0,
        join: PathJoin::Stop,
    };
    let elements = [
        line(1, begin.position, corner, false),
        line(2, corner, edge, true),
        arc,
    ];
    vec![
        Request::BeginPath {
            id: 7,
            space: PathSpace::Tool,
            start_s_mm: 0.0,
            limits: LIMITS,
        },
        Request::LoadElements {
            elements: elements.into_iter().collect(),
            last: true,
        },
        Request::LoadEvents(events().into_iter().collect()),
    ]
}

fn events() -> Vec<PathEvent> {
    let at = |s_mm, action| PathEvent { s_mm, action };
    let power = |side, watt| PathAction::Power { side, watt };
    vec![
        at(5.0, power(0, 1500.0)),
        at(5.0, power(1, 900.0)),
        at(30.0, PathAction::Beam { side: 0, on: true }),
        at(31.7, PathAction::Beam { side: 1, on: true }),
        at(
            50.0,
            PathAction::Level {
                channel: Channel::Power(0),
                value: 3100.0,
                over_mm: 80.0,
            },
        ),
        at(
            60.0,
            PathAction::BySpeed {
                channel: Channel::Power(1),
                full_mm_s: 150.0,
                least: 0.1,
            },
        ),
        at(210.3, PathAction::Beam { side: 1, on: false }),
        at(225.0, PathAction::Beam { side: 0, on: false }),
    ]
}
