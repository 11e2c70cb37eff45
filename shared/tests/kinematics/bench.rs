//! The machines, each with a geometry without symmetry, and what all tests ask of them.

use nalgebra::Vector3;
use shared::geometry::{Pose, PoseMotion};
use shared::io::AXES;
use shared::kinematics::{
    AcHeadConfig, AxisConfig, AxisLimits, Carried, DualBeamConfig, JointAxis, JointConfig, Kinematics,
    KinematicsConfig, PipeWelderConfig, SerialChainConfig, StirGantryConfig, StirTilt, WireArcConfig,
};

/// A machine with the limits it was built with.
pub struct Machine {
    pub name: &'static str,
    pub kinematics: Kinematics,
    pub limits: [AxisLimits; AXES],
    /// Whether a pose has one solution only, but for turns, and its T belongs to it.
    pub unique: bool,
}

/// Limits of axes with these travels (mm, degrees); `None` where there is no axis.
pub fn limits(travel: [Option<(f64, f64)>; AXES]) -> [AxisLimits; AXES] {
    let configs = travel.map(|travel| {
        travel.map(|(travel_min, travel_max)| AxisConfig {
            travel_min,
            travel_max,
            max_velocity: 100.0,
            max_acceleration: 1000.0,
            max_jerk: 10_000.0,
        })
    });
    AxisLimits::build_all(&configs).expect("valid limits")
}

fn machine(
    name: &'static str,
    config: KinematicsConfig,
    travel: [Option<(f64, f64)>; AXES],
    unique: bool,
) -> Machine {
    let limits = limits(travel);
    let fitted = travel.map(|travel| travel.is_some());
    assert_eq!(config.fitted(), fitted, "{name}");
    Machine {
        name,
        kinematics: config.build(&limits).expect("a valid geometry"),
        limits,
        unique,
    }
}

pub fn dual_beam() -> Machine {
    let config = DualBeamConfig {
        o1_mm: [-22.7, 62.5, -22.2],
        o2_mm: [-37.8, 11.3, -58.8],
        o3_mm: [-0.18, -0.51, -615.6],
    };
    let travel = [
        Some((0.0, 5000.0)),
        Some((0.0, 3000.0)),
        Some((0.0, 1000.0)),
        Some((-100.0, 100.0)),
        Some((-30.0, 30.0)),
        Some((-90.0, 90.0)),
    ];
    machine(
        "dual-beam gantry",
        KinematicsConfig::DualBeamGantry(config),
        travel,
        true,
    )
}

pub fn pipe_welder() -> Machine {
    let config = PipeWelderConfig { torch_mm: 85.0 };
    let travel = [
        Some((100.0, 400.0)),
        None,
        Some((-50.0, 350.0)),
        None,
        Some((-20.0, 110.0)),
        Some((-400.0, 400.0)),
    ];
    machine("pipe welder", KinematicsConfig::PipeWelder(config), travel, true)
}

/// An A/C head with this travel of A and C \[deg\].
pub fn ac_head_within(a: (f64, f64), c: (f64, f64)) -> Machine {
    let config = AcHeadConfig {
        o1_mm: [18.2, -40.1, 40.8],
        o2_mm: [-19.0, -18.5, -236.4],
    };
    let travel = [
        Some((0.0, 2000.0)),
        Some((0.0, 1500.0)),
        Some((0.0, 800.0)),
        Some(a),
        None,
        Some(c),
    ];
    machine("A/C head", KinematicsConfig::AcHead(config), travel, false)
}

pub fn ac_head() -> Machine {
    ac_head_within((-90.0, 90.0), (-360.0, 360.0))
}

pub fn wire_arc() -> Machine {
    let config = WireArcConfig {
        torch_mm: [3.1, -7.4, -310.5],
        tilt_axis_mm: [612.3, 407.9, -151.2],
        turntable_mm: [-4.6, 12.8, 96.7],
    };
    let travel = [
        Some((0.0, 1200.0)),
        Some((0.0, 800.0)),
        Some((0.0, 600.0)),
        Some((-60.0, 60.0)),
        Some((-85.0, 85.0)),
        Some((-1080.0, 1080.0)),
    ];
    machine("wire-arc robot", KinematicsConfig::WireArc(config), travel, true)
}

/// A friction-stir gantry with B of one sign; otherwise its poses have two solutions.
pub fn stir_gantry(tilt: StirTilt) -> Machine {
    let (name, b) = match tilt {
        StirTilt::Positive => ("friction-stir gantry, B > 0", (0.0, 10.0)),
        StirTilt::Negative => ("friction-stir gantry, B < 0", (-10.0, 0.0)),
    };
    let config = StirGantryConfig { l4_mm: -305.0, tilt };
    let travel = [
        Some((-1500.0, 0.0)),
        Some((0.0, 1280.0)),
        Some((0.0, 480.0)),
        None,
        Some(b),
        Some((-180.0, 180.0)),
    ];
    machine(name, KinematicsConfig::StirGantry(config), travel, true)
}

/// Joints of a serial chain: axis, what it carries, direction, point.
pub type Joints<'a> = &'a [(JointAxis, Carried, [f64; 3], [f64; 3])];

pub fn chain_of(joints: Joints, tip_mm: [f64; 3], tool_axis: [f64; 3]) -> SerialChainConfig {
    let joint =
        |(axis, carries, direction, point_mm): &(JointAxis, Carried, [f64; 3], [f64; 3])| JointConfig {
            axis: *axis,
            carries: *carries,
            direction: *direction,
            point_mm: *point_mm,
        };
    SerialChainConfig {
        joints: joints.iter().map(joint).collect(),
        tip_mm,
        tool_axis,
        tangent: None,
        work_mm: [0.0; 3],
    }
}

const X_AXIS: [f64; 3] = [1.0, 0.0, 0.0];
const Y_AXIS: [f64; 3] = [0.0, 1.0, 0.0];
const Z_AXIS: [f64; 3] = [0.0, 0.0, 1.0];
const ORIGIN: [f64; 3] = [0.0; 3];

fn sum<const N: usize>(vectors: [[f64; 3]; N]) -> [f64; 3] {
    std::array::from_fn(|i| vectors.iter().map(|v| v[i]).sum())
}

/// [`dual_beam`] as a list of joints.
pub fn chain_dual_beam() -> Machine {
    let o1 = [-22.7, 62.5, -22.2];
    let o2 = sum([o1, [-37.8, 11.3, -58.8]]);
    let config = chain_of(
        &[
            (JointAxis::X, Carried::Tool, X_AXIS, ORIGIN),
            (JointAxis::Y, Carried::Tool, Y_AXIS, ORIGIN),
            (JointAxis::Z, Carried::Tool, Z_AXIS, ORIGIN),
            (JointAxis::C, Carried::Tool, Z_AXIS, ORIGIN),
            (JointAxis::B, Carried::Tool, Y_AXIS, o1),
            (JointAxis::A, Carried::Tool, X_AXIS, o2),
        ],
        sum([o2, [-0.18, -0.51, -615.6]]),
        Z_AXIS,
    );
    same_as(dual_beam(), "chain: dual-beam gantry", config)
}

/// [`ac_head`] as a list of joints.
pub fn chain_ac_head() -> Machine {
    let o1 = [18.2, -40.1, 40.8];
    let config = chain_of(
        &[
            (JointAxis::X, Carried::Tool, X_AXIS, ORIGIN),
            (JointAxis::Y, Carried::Tool, Y_AXIS, ORIGIN),
            (JointAxis::Z, Carried::Tool, Z_AXIS, ORIGIN),
            (JointAxis::C, Carried::Tool, Z_AXIS, ORIGIN),
            (JointAxis::A, Carried::Tool, X_AXIS, o1),
        ],
        sum([o1, [-19.0, -18.5, -236.4]]),
        Z_AXIS,
    );
    same_as(ac_head(), "chain: A/C head", config)
}

/// [`wire_arc`] as a list of joints.
pub fn chain_wire_arc() -> Machine {
    let tilt = [612.3, 407.9, -151.2];
    let table = sum([tilt, [-4.6, 12.8, 96.7]]);
    let config = SerialChainConfig {
        work_mm: table,
        ..chain_of(
            &[
                (JointAxis::B, Carried::Work, Y_AXIS, tilt),
                (JointAxis::C, Carried::Work, Z_AXIS, table),
                (JointAxis::X, Carried::Tool, X_AXIS, ORIGIN),
                (JointAxis::Y, Carried::Tool, Y_AXIS, ORIGIN),
                (JointAxis::Z, Carried::Tool, Z_AXIS, ORIGIN),
                (JointAxis::A, Carried::Tool, X_AXIS, ORIGIN),
            ],
            [3.1, -7.4, -310.5],
            Z_AXIS,
        )
    };
    same_as(wire_arc(), "chain: wire-arc robot", config)
}

/// [`stir_gantry`] as a list of joints; T follows the heading as there.
pub fn chain_stir_gantry(tilt: StirTilt) -> Machine {
    let (name, back) = match tilt {
        StirTilt::Positive => ("chain: friction-stir gantry, B > 0", -1.0),
        StirTilt::Negative => ("chain: friction-stir gantry, B < 0", 1.0),
    };
    let config = SerialChainConfig {
        tangent: Some([back, 0.0, 0.0]),
        work_mm: [0.0, 0.0, -305.0],
        ..chain_of(
            &[
                (JointAxis::X, Carried::Work, X_AXIS, ORIGIN),
                (JointAxis::Y, Carried::Tool, Y_AXIS, ORIGIN),
                (JointAxis::Z, Carried::Tool, Z_AXIS, ORIGIN),
                (JointAxis::C, Carried::Tool, Z_AXIS, ORIGIN),
                (JointAxis::B, Carried::Tool, Y_AXIS, ORIGIN),
            ],
            [0.0, 0.0, -305.0],
            Z_AXIS,
        )
    };
    same_as(stir_gantry(tilt), name, config)
}

/// [`pipe_welder`] as a list of joints, two of them linear: the position has a say in C.
pub fn chain_pipe_welder() -> Machine {
    let config = chain_of(
        &[
            (JointAxis::C, Carried::Tool, Z_AXIS, ORIGIN),
            (JointAxis::X, Carried::Tool, X_AXIS, ORIGIN),
            (JointAxis::Z, Carried::Tool, Z_AXIS, ORIGIN),
            (JointAxis::B, Carried::Tool, [0.0, -1.0, 0.0], ORIGIN),
        ],
        [-85.0, 0.0, 0.0],
        X_AXIS,
    );
    same_as(pipe_welder(), "chain: pipe welder", config)
}

/// `machine` with other kinematics, which should be the same.
fn same_as(machine: Machine, name: &'static str, config: SerialChainConfig) -> Machine {
    Machine {
        name,
        kinematics: KinematicsConfig::SerialChain(config)
            .build(&machine.limits)
            .expect("a valid geometry"),
        ..machine
    }
}

/// Each machine that is a chain of joints, and that chain.
pub fn pairs() -> Vec<(Machine, Machine)> {
    vec![
        (dual_beam(), chain_dual_beam()),
        (ac_head(), chain_ac_head()),
        (wire_arc(), chain_wire_arc()),
        (
            stir_gantry(StirTilt::Positive),
            chain_stir_gantry(StirTilt::Positive),
        ),
        (
            stir_gantry(StirTilt::Negative),
            chain_stir_gantry(StirTilt::Negative),
        ),
        (pipe_welder(), chain_pipe_welder()),
    ]
}

pub fn machines() -> Vec<Machine> {
    vec![
        dual_beam(),
        pipe_welder(),
        ac_head(),
        wire_arc(),
        stir_gantry(StirTilt::Positive),
        stir_gantry(StirTilt::Negative),
    ]
}

/// Random numbers that are the same in every run (SplitMix64).
pub struct Random(pub u64);

impl Random {
    /// Uniform in low…high.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^= x >> 31;
        low + (high - low) * (x >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Axes anywhere in the travel.
    pub fn axes(&mut self, machine: &Machine) -> [f64; AXES] {
        machine.limits.map(|limit| self.within(limit.min, limit.max))
    }

    /// A vector with components in ±`size`.
    pub fn vector(&mut self, size: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.within(-size, size))
    }
}

/// T, M, N.
pub fn frame(pose: &Pose) -> [Vector3<f64>; 3] {
    [pose.tangent, pose.lateral(), pose.normal]
}

/// First and second derivative of `f` at 0 by central differences over seven points, step `h`: exact for
/// polynomials of degree 6.
pub fn differences<const N: usize>(h: f64, f: impl Fn(f64) -> [f64; N]) -> ([f64; N], [f64; N]) {
    let (mut first, mut second) = ([0.0; N], [0.0; N]);
    let middle = f(0.0);
    for (k, w1, w2) in [
        (1.0, 3.0 / 4.0, 3.0 / 2.0),
        (2.0, -3.0 / 20.0, -3.0 / 20.0),
        (3.0, 1.0 / 60.0, 1.0 / 90.0),
    ] {
        let (after, before) = (f(k * h), f(-k * h));
        for i in 0..N {
            first[i] += w1 * (after[i] - before[i]) / h;
            second[i] += w2 * (after[i] - 2.0 * middle[i] + before[i]) / (h * h);
        }
    }
    (first, second)
}

/// Motion at 0 of the pose `f`, by differences: ω = ½ Σ e × ė, α = ½ Σ e × ë over the columns e of its frame.
pub fn motion_of(h: f64, f: impl Fn(f64) -> Pose) -> PoseMotion {
    let flat = |pose: &Pose| -> [f64; 12] {
        let [t, m, n] = frame(pose);
        let all = [pose.position, t, m, n];
        std::array::from_fn(|i| all[i / 3][i % 3])
    };
    let middle = frame(&f(0.0));
    let (first, second) = differences(h, |x| flat(&f(x)));
    let part = |all: &[f64; 12], i: usize| Vector3::from_column_slice(&all[3 * i..3 * i + 3]);
    let spin = |all: &[f64; 12]| {
        let crosses = (0..3).map(|i| middle[i].cross(&part(all, i + 1)));
        crosses.sum::<Vector3<f64>>() / 2.0
    };
    PoseMotion {
        velocity: part(&first, 0),
        angular_velocity: spin(&first),
        acceleration: part(&second, 0),
        angular_acceleration: spin(&second),
    }
}

/// The largest |a − b|.
pub fn distance<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
