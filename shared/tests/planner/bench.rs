//! Machines, their limits, and where on them programs are run.

use nalgebra::Vector3;
use shared::geometry::{Pose, rotate};
use shared::io::AXES;
use shared::kinematics::{
    AcHeadConfig, AxisConfig, AxisLimits, DualBeamConfig, Kinematics, KinematicsConfig, PipeWelderConfig,
    StirGantryConfig, StirTilt, WireArcConfig,
};
use shared::trajectory::{CHANNELS, PathSpace, PlanLimits};

/// A machine, and the neighbourhood in which programs are run on it.
#[derive(Clone, Debug)]
pub struct Bench {
    pub kinematics: Kinematics,
    pub limits: PlanLimits,
    pub space: PathSpace,
    /// Axes in the middle of the neighbourhood; programs begin there.
    pub home: [f64; AXES],
    /// Programs stay about this near to it \[mm\].
    pub room: f64,
    /// And turn by no more than this about each axis \[rad\].
    pub turn: f64,
    /// T belongs to the pose; else only N does.
    pub whole: bool,
}

/// Travel from and to, velocity, acceleration and jerk of an axis (mm, degrees, s).
type Axis = Option<[f64; 5]>;

fn machine(
    config: &KinematicsConfig,
    axes: [Axis; AXES],
    path: [f64; 2],
    home: [f64; AXES],
    bench: impl FnOnce(&mut Bench),
) -> Bench {
    let axes = axes.map(|axis| {
        axis.map(
            |[travel_min, travel_max, max_velocity, max_acceleration, max_jerk]| AxisConfig {
                travel_min,
                travel_max,
                max_velocity,
                max_acceleration,
                max_jerk,
            },
        )
    });
    let axes = AxisLimits::build_all(&axes).expect("valid limits");
    let mut home = home;
    for angle in &mut home[3..] {
        *angle = angle.to_radians();
    }
    let mut made = Bench {
        kinematics: config.build(&axes).expect("a valid geometry"),
        limits: PlanLimits::of(&axes, path[0], path[1], 0.05),
        space: PathSpace::Tool,
        home,
        room: 60.0,
        turn: 0.15,
        whole: false,
    };
    bench(&mut made);
    made
}

pub fn dual_beam() -> Bench {
    let config = KinematicsConfig::DualBeamGantry(DualBeamConfig {
        o1_mm: [0.0, 0.0, -120.0],
        o2_mm: [0.0, 0.0, -80.0],
        o3_mm: [0.5, -0.3, -450.0],
    });
    let head = |travel: f64| Some([-travel, travel, 120.0, 400.0, 8000.0]);
    let axes = [
        Some([0.0, 5000.0, 333.333, 1500.0, 30_000.0]),
        Some([0.0, 3000.0, 333.333, 1500.0, 30_000.0]),
        Some([0.0, 1000.0, 166.667, 1000.0, 20_000.0]),
        head(100.0),
        head(30.0),
        head(90.0),
    ];
    let home = [2000.0, 1500.0, 700.0, 25.0, -5.0, 10.0];
    machine(&config, axes, [500.0, 10_000.0], home, |bench| bench.whole = true)
}

pub fn pipe_welder() -> Bench {
    let config = KinematicsConfig::PipeWelder(PipeWelderConfig { torch_mm: 60.0 });
    let linear = |from: f64, to: f64| Some([from, to, 50.0, 200.0, 4000.0]);
    let rotary = |from: f64, to: f64| Some([from, to, 30.0, 100.0, 2000.0]);
    let axes = [
        linear(20.0, 200.0),
        None,
        linear(60.0, 360.0),
        None,
        rotary(-10.0, 100.0),
        rotary(-20.0, 380.0),
    ];
    let home = [150.0, 0.0, 200.0, 0.0, 40.0, 90.0];
    machine(&config, axes, [100.0, 2000.0], home, |bench| bench.room = 25.0)
}

pub fn ac_head() -> Bench {
    let config = KinematicsConfig::AcHead(AcHeadConfig {
        o1_mm: [0.0, 0.0, -120.0],
        o2_mm: [0.0, 0.0, -180.0],
    });
    let linear = |to: f64| Some([0.0, to, 666.667, 2000.0, 40_000.0]);
    let rotary = |to: f64| Some([-to, to, 180.0, 800.0, 16_000.0]);
    let axes = [
        linear(3000.0),
        linear(1500.0),
        linear(800.0),
        rotary(90.0),
        None,
        rotary(360.0),
    ];
    let home = [1500.0, 700.0, 500.0, 40.0, 0.0, 30.0];
    machine(&config, axes, [1000.0, 20_000.0], home, |_| ())
}

pub fn wire_arc() -> Bench {
    let config = KinematicsConfig::WireArc(WireArcConfig {
        torch_mm: [0.0, 0.0, -250.0],
        tilt_axis_mm: [600.0, 400.0, -150.0],
        turntable_mm: [0.0, 0.0, 50.0],
    });
    let linear = |to: f64| Some([0.0, to, 166.667, 800.0, 16_000.0]);
    let axes = [
        linear(1200.0),
        linear(800.0),
        linear(600.0),
        Some([-45.0, 45.0, 60.0, 200.0, 4000.0]),
        Some([-80.0, 80.0, 30.0, 100.0, 2000.0]),
        Some([-360.0, 360.0, 60.0, 200.0, 4000.0]),
    ];
    let home = [640.0, 430.0, 250.0, 10.0, 15.0, 40.0];
    machine(&config, axes, [400.0, 8000.0], home, |bench| bench.whole = true)
}

pub fn stir_gantry() -> Bench {
    let config = KinematicsConfig::StirGantry(StirGantryConfig {
        l4_mm: -305.0,
        tilt: StirTilt::Negative,
    });
    let axes = [
        Some([-1500.0, 0.0, 100.0, 200.0, 4000.0]),
        Some([0.0, 1280.0, 100.0, 200.0, 4000.0]),
        Some([0.0, 480.0, 50.0, 200.0, 4000.0]),
        None,
        Some([-10.0, 10.0, 5.0, 20.0, 400.0]),
        Some([-180.0, 180.0, 30.0, 100.0, 2000.0]),
    ];
    let home = [-700.0, 600.0, 200.0, 0.0, -5.0, 20.0];
    // With the pin upright C is free: the tilt stays well away from there.
    machine(&config, axes, [50.0, 1000.0], home, |bench| bench.turn = 0.02)
}

/// Limits of a machine in axis space that programs are run on; `None` of a speed or the path means none.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Acceleration of the linear axes \[mm/s²\].
    pub acceleration: f64,
    /// Time in which it can be reached \[s\].
    pub ramp: f64,
    /// Acceleration of the rotary axes \[rad/s²\].
    pub rotary: f64,
    /// Highest speed of X \[mm/s\].
    pub velocity: Option<f64>,
    /// Acceleration along the path \[mm/s²\].
    pub path: Option<f64>,
    /// \[mm\]
    pub tolerance: f64,
}

/// A machine in axis space.
pub fn axes(frame: &Frame) -> Bench {
    let each = |linear: f64, rotary: f64| std::array::from_fn(|axis| if axis < 3 { linear } else { rotary });
    let mut velocity = [f64::INFINITY; AXES];
    velocity[0] = frame.velocity.unwrap_or(f64::INFINITY);
    Bench {
        limits: PlanLimits {
            velocity,
            acceleration: each(frame.acceleration, frame.rotary),
            jerk: each(frame.acceleration / frame.ramp, frame.rotary / frame.ramp),
            path_acceleration: frame.path.unwrap_or(1e9),
            path_jerk: frame.path.unwrap_or(frame.acceleration) / frame.ramp,
            tolerance: frame.tolerance,
        },
        space: PathSpace::Axes,
        home: [0.0; AXES],
        room: 200.0,
        turn: 3.0,
        ..dual_beam()
    }
}

impl Bench {
    /// Channels with the tool (or axes X Y Z) at `position` relative to home, and turned by `attitude` from there.
    pub fn channels(&self, position: &Vector3<f64>, attitude: &Vector3<f64>) -> [f64; CHANNELS] {
        let mut channels = [0.0; CHANNELS];
        let mut put =
            |at: usize, value: &Vector3<f64>| channels[at..at + 3].copy_from_slice(value.as_slice());
        match self.space {
            PathSpace::Axes => {
                put(0, position);
                put(3, attitude);
            }
            PathSpace::Tool => {
                let home = self.kinematics.forward(&self.home);
                let angle = attitude.norm();
                let turned = |v: &Vector3<f64>| match angle > 0.0 {
                    true => rotate(&(attitude / angle), angle, v),
                    false => *v,
                };
                put(0, &(home.position + position));
                put(3, &turned(&home.tangent));
                put(6, &turned(&home.normal));
            }
        }
        channels
    }

    /// What the machine makes of `channels`: the pose of its tool. Nothing in axis space.
    pub fn realised(&self, channels: &[f64; CHANNELS], near: &[f64; AXES]) -> Option<Pose> {
        let part = |at: usize| Vector3::from_column_slice(&channels[at..at + 3]);
        let pose = Pose::new(part(0), part(3), part(6)).ok()?;
        let axes = self.kinematics.inverse(&pose, near).ok()?;
        Some(self.kinematics.forward(&axes))
    }

    /// Position of the tool, or axes X Y Z.
    pub fn tip(&self, axes: &[f64; AXES]) -> Vector3<f64> {
        match self.space {
            PathSpace::Axes => Vector3::from_column_slice(&axes[..3]),
            PathSpace::Tool => self.kinematics.forward(axes).position,
        }
    }
}
