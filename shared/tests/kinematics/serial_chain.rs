//! Serial chains against the machines that have kinematics of their own, and what only chains can be.

use crate::bench::{
    Machine, Random, chain_ac_head, chain_of, chain_pipe_welder, differences, distance, limits, motion_of,
    pairs,
};
use nalgebra::Vector3;
use shared::geometry::{Pose, rotate};
use shared::io::AXES;
use shared::kinematics::{
    Carried, JointAxis, KinematicsConfig, KinematicsError, SerialChainConfig, violations,
};

const POSES: usize = 10_000;
const X_AXIS: [f64; 3] = [1.0, 0.0, 0.0];
const Y_AXIS: [f64; 3] = [0.0, 1.0, 0.0];
const Z_AXIS: [f64; 3] = [0.0, 0.0, 1.0];

/// Between two directions, or two poses' \[mm, rad\].
fn apart(a: &Pose, b: &Pose, with_tangent: bool) -> f64 {
    let tangent = if with_tangent {
        (a.tangent - b.tangent).norm()
    } else {
        0.0
    };
    (a.position - b.position)
        .norm()
        .max((a.normal - b.normal).norm())
        .max(tangent)
}

#[test]
fn forward_is_that_of_the_machine() {
    for (machine, chain) in pairs() {
        let mut random = Random(20);
        // Any T belongs to the pipe welder's pose in its own way.
        let with_tangent = machine.name != "pipe welder";
        for _ in 0..POSES {
            let axes = random.axes(&machine);
            let away = apart(
                &machine.kinematics.forward(&axes),
                &chain.kinematics.forward(&axes),
                with_tangent,
            );
            assert!(away < 1e-9, "{}: {away} at {axes:?}", chain.name);
        }
    }
}

/// From anywhere in the travel, as a program begins.
#[test]
fn random_poses_come_back_from_anywhere() {
    for (machine, chain) in pairs() {
        let mut random = Random(21);
        let mut worst = 0.0f64;
        for _ in 0..POSES {
            let pose = chain.kinematics.forward(&random.axes(&machine));
            let near = random.axes(&machine);
            let axes = match chain.kinematics.inverse(&pose, &near) {
                Ok(axes) => axes,
                Err(error) => panic!("{}: {error} at {pose:?} from {near:?}", chain.name),
            };
            let back = chain.kinematics.forward(&axes);
            worst = worst.max(apart(
                &back,
                &pose,
                machine.unique && machine.name != "pipe welder",
            ));
        }
        println!("{}: {worst:.1e} mm or rad over {POSES} poses", chain.name);
        assert!(worst < 1e-9, "{}: {worst}", chain.name);
    }
}

/// Axes as the machine's own kinematics find them, of poses a tick away.
#[test]
fn axes_are_those_of_the_machine() {
    for (machine, chain) in pairs() {
        let mut random = Random(22);
        for _ in 0..POSES {
            let axes = random.axes(&machine);
            let sin = |angle: f64| if angle == 0.0 { 1.0 } else { angle.sin().abs() };
            if sin(axes[3]).min(sin(axes[4])) < 0.01 {
                continue;
            }
            let near = axes.map(|x| {
                if x == 0.0 {
                    0.0
                } else {
                    x + random.within(-0.01, 0.01)
                }
            });
            let pose = machine.kinematics.forward(&axes);
            let [own, found] = [&machine, &chain]
                .map(|machine| machine.kinematics.inverse(&pose, &near).expect("reachable"));
            assert!(
                distance(&own, &found) < 1e-9,
                "{}: {own:?} and {found:?}",
                chain.name
            );
            assert!(!violations(&found, &machine.limits).any(), "{}", chain.name);
        }
    }
}

/// Away from the poles, where rates are large and differences poor.
fn regular(random: &mut Random, machine: &Machine) -> [f64; AXES] {
    loop {
        let axes = random.axes(machine);
        let tilt = |angle: f64| angle == 0.0 || angle.abs() > 0.05;
        if tilt(axes[3]) && tilt(axes[4]) {
            return axes;
        }
    }
}

#[test]
fn rates_and_accelerations_are_those_that_move_the_tool_so() {
    for (machine, chain) in pairs() {
        let mut random = Random(23);
        let mut worst = 0.0f64;
        for _ in 0..500 {
            let q = regular(&mut random, &machine);
            let [q1, q2]: [[f64; AXES]; 2] = std::array::from_fn(|_| {
                std::array::from_fn(|i| {
                    let limit = &machine.limits[i];
                    let size = if limit.max > limit.min { 1.0 } else { 0.0 };
                    size * random.within(-1.0, 1.0) * if i < 3 { 100.0 } else { 0.5 }
                })
            });
            let at =
                |t: f64| -> [f64; AXES] { std::array::from_fn(|i| q[i] + q1[i] * t + q2[i] * t * t / 2.0) };
            let motion = motion_of(0.01, |t| chain.kinematics.forward(&at(t)));
            let (rates, accelerations) = chain.kinematics.derivatives(&q, &motion).expect("regular");
            worst = worst
                .max(distance(&rates, &q1))
                .max(distance(&accelerations, &q2));
        }
        println!("{}: {worst:.1e} from the differences", chain.name);
        assert!(worst < 2e-6, "{}: {worst}", chain.name);
    }
}

/// A tool that is a body of revolution spins about itself as it likes: what is asked of its axis alone counts.
#[test]
fn axes_in_motion_are_the_derivatives_of_inverse() {
    let machine = chain_ac_head();
    let mut random = Random(24);
    let mut worst = 0.0f64;
    for _ in 0..500 {
        let q = regular(&mut random, &machine);
        let near_end = |i: usize| {
            let limit = &machine.limits[i];
            (q[i] - limit.min).min(limit.max - q[i]) < 0.2
        };
        if near_end(3) || near_end(5) {
            // Beyond it the other solution is taken.
            continue;
        }
        let start = machine.kinematics.forward(&q);
        let (v, a) = (random.vector(20.0), random.vector(20.0));
        let turn = random.vector(1.0).normalize();
        let (rate, acceleration) = (random.within(-0.2, 0.2), random.within(-0.2, 0.2));
        let at = |t: f64| {
            let turned = |v: &Vector3<f64>| rotate(&turn, rate * t + acceleration * t * t / 2.0, v);
            Pose {
                position: start.position + v * t + a * (t * t / 2.0),
                tangent: turned(&start.tangent),
                normal: turned(&start.normal),
            }
        };
        let middle = machine
            .kinematics
            .inverse_motion(&at(0.0), &motion_of(0.01, at), &q);
        let middle = middle.expect("a solution");
        let (rates, accelerations) = differences(0.01, |t| {
            machine.kinematics.inverse(&at(t), &q).expect("a solution")
        });
        worst = worst
            .max(distance(&middle.velocity, &rates))
            .max(distance(&middle.acceleration, &accelerations));
    }
    println!("{worst:.1e} from the differences of inverse");
    assert!(worst < 1e-5, "{worst}");
}

fn built(config: SerialChainConfig, travel: [Option<(f64, f64)>; AXES]) -> Machine {
    let limits = limits(travel);
    Machine {
        name: "chain",
        kinematics: KinematicsConfig::SerialChain(config)
            .build(&limits)
            .expect("a valid geometry"),
        limits,
        unique: true,
    }
}

fn gantry(tangent: Option<[f64; 3]>) -> Machine {
    let joints = [
        (JointAxis::X, Carried::Tool, X_AXIS, [0.0; 3]),
        (JointAxis::Y, Carried::Work, Y_AXIS, [0.0; 3]),
        (JointAxis::Z, Carried::Tool, Z_AXIS, [0.0; 3]),
    ];
    let config = SerialChainConfig {
        tangent,
        work_mm: [100.0, 200.0, 0.0],
        ..chain_of(&joints, [0.0, 0.0, -300.0], Z_AXIS)
    };
    let travel = Some((-1000.0, 1000.0));
    built(config, [travel, travel, travel, None, None, None])
}

/// A table that tilts (B) and turns (C), under a gantry whose torch tilts (A); in the file in another order.
#[test]
fn joints_are_told_from_the_work_to_the_tool() {
    let joints = [
        (JointAxis::X, Carried::Tool, X_AXIS, [0.0; 3]),
        (JointAxis::B, Carried::Work, Y_AXIS, [0.0; 3]),
        (JointAxis::Z, Carried::Tool, Z_AXIS, [0.0; 3]),
        (JointAxis::C, Carried::Work, Z_AXIS, [0.0; 3]),
        (JointAxis::A, Carried::Tool, X_AXIS, [0.0; 3]),
    ];
    let config = KinematicsConfig::SerialChain(chain_of(&joints, [0.0; 3], Z_AXIS));
    let order: Vec<usize> = (0..AXES).filter_map(|number| config.joint(number)).collect();
    assert_eq!(order, [5, 4, 0, 2, 3]);
    assert_eq!(config.fitted(), [true, false, true, true, true, true]);
}

/// Signs, by hand: the table carries the work along +Y, so the tip goes along −Y over it.
#[test]
fn three_linear_axes_lead_the_tip_and_keep_the_attitude() {
    let machine = gantry(None);
    let pose = machine.kinematics.forward(&[110.0, 20.0, 330.0, 0.0, 0.0, 0.0]);
    assert_eq!(pose.position, Vector3::new(10.0, -220.0, 30.0));
    assert_eq!((pose.tangent, pose.normal), (Vector3::x(), Vector3::z()));
    let axes = machine.kinematics.inverse(&pose, &[0.0; AXES]);
    assert_eq!(axes, Ok([110.0, 20.0, 330.0, 0.0, 0.0, 0.0]));
    let motion = motion_of(0.01, |t| Pose {
        position: Vector3::new(30.0 * t, 5.0 * t, t * t),
        ..pose
    });
    let (rates, accelerations) = machine
        .kinematics
        .derivatives(&[0.0; AXES], &motion)
        .expect("rates");
    assert!(distance(&rates, &[30.0, -5.0, 0.0, 0.0, 0.0, 0.0]) < 1e-9);
    assert!(distance(&accelerations, &[0.0, 0.0, 2.0, 0.0, 0.0, 0.0]) < 1e-9);
}

/// Never another attitude than the one that is asked for.
#[test]
fn an_attitude_that_the_machine_cannot_give_is_an_error() {
    let (round, facing) = (gantry(None), gantry(Some(X_AXIS)));
    let pose = |tilt: f64, turn: f64| {
        let tangent = Vector3::new(turn.cos(), turn.sin(), 0.0);
        Pose::new(
            Vector3::zeros(),
            tangent,
            Vector3::new(0.0, tilt.sin(), tilt.cos()),
        )
        .expect("a pose")
    };
    let near = [0.0; AXES];
    for tilt in [2e-4, 0.1, 1.6, 3.0] {
        for machine in [&round, &facing] {
            let refused = machine.kinematics.inverse(&pose(tilt, 0.0), &near);
            assert_eq!(refused, Err(KinematicsError::NoSuchAttitude), "{tilt}");
        }
    }
    // The rounding of an interpolated attitude is left out.
    assert!(facing.kinematics.inverse(&pose(5e-5, 5e-5), &near).is_ok());
    // A tool that is a body of revolution has no T of its own.
    assert!(round.kinematics.inverse(&pose(0.0, 1.0), &near).is_ok());
    let turned = facing.kinematics.inverse(&pose(0.0, 1.0), &near);
    assert_eq!(turned, Err(KinematicsError::NoSuchAttitude));
}

/// Two linear axes and a turntable: the position determines C.
#[test]
fn a_turntable_brings_the_seam_under_the_torch() {
    let joints = [
        (JointAxis::C, Carried::Work, Z_AXIS, [500.0, 0.0, 0.0]),
        (JointAxis::X, Carried::Tool, X_AXIS, [0.0; 3]),
        (JointAxis::Z, Carried::Tool, Z_AXIS, [0.0; 3]),
    ];
    let config = SerialChainConfig {
        work_mm: [500.0, 0.0, 0.0],
        ..chain_of(&joints, [0.0; 3], Z_AXIS)
    };
    let travel = [
        Some((500.0, 1000.0)),
        None,
        Some((0.0, 300.0)),
        None,
        None,
        Some((-720.0, 720.0)),
    ];
    let machine = built(config, travel);
    // Three turns of a circle, a degree at a time.
    let mut axes = [700.0, 0.0, 40.0, 0.0, 0.0, 0.0];
    for degree in 0..1080 {
        let angle = f64::from(degree).to_radians();
        let position = Vector3::new(200.0 * angle.cos(), 200.0 * angle.sin(), 40.0);
        let pose = Pose::pointing(position, Vector3::z()).expect("a pose");
        axes = machine.kinematics.inverse(&pose, &axes).expect("reachable");
        let wanted = [700.0, 0.0, 40.0, 0.0, 0.0, -angle];
        assert!(distance(&axes, &wanted) < 1e-9, "{axes:?} at {degree}");
    }
    // With the torch fixed along X no axis leads there.
    let fixed = built(
        chain_of(
            &[(JointAxis::Z, Carried::Tool, Z_AXIS, [0.0; 3])],
            [0.0; 3],
            Z_AXIS,
        ),
        [None, None, Some((0.0, 300.0)), None, None, None],
    );
    let pose = Pose::pointing(Vector3::new(1.0, 0.0, 10.0), Vector3::z()).expect("a pose");
    assert_eq!(
        fixed.kinematics.inverse(&pose, &[0.0; AXES]),
        Err(KinematicsError::Unreachable)
    );
}

#[test]
fn an_upright_head_keeps_c_and_refuses_a_tilt_across() {
    let machine = chain_ac_head();
    let c = 0.8f64;
    let pose = Pose::pointing(Vector3::new(10.0, 20.0, 30.0), Vector3::z()).expect("a pose");
    let near = [0.0, 0.0, 0.0, 0.5, 0.0, c];
    let axes = machine.kinematics.inverse(&pose, &near).expect("reachable");
    assert_eq!((axes[3], axes[5]), (0.0, c));
    let zero = Vector3::zeros();
    let along = Vector3::new(c.cos(), c.sin(), 0.0);
    let rates = machine
        .kinematics
        .rates(&axes, &zero, &(along * 0.3))
        .expect("no turn needed");
    assert!((rates[3] - 0.3).abs() < 1e-12 && rates[5] == 0.0, "{rates:?}");
    let across = machine
        .kinematics
        .rates(&axes, &zero, &(Vector3::z().cross(&along) * 0.3));
    assert_eq!(across, Err(KinematicsError::Pole { axis: 5 }));
}

/// What the position of a pipe welder's torch and its direction say of C has to agree.
#[test]
fn a_torch_that_points_beside_the_arm_is_an_error() {
    let machine = chain_pipe_welder();
    let start = machine.kinematics.forward(&[200.0, 0.0, 50.0, 0.0, 0.7, 0.3]);
    let leaning = |lean: f64| Pose {
        normal: rotate(&Vector3::z(), lean, &start.normal),
        tangent: rotate(&Vector3::z(), lean, &start.tangent),
        ..start
    };
    let near = [200.0, 0.0, 50.0, 0.0, 0.7, 0.3];
    let off = machine
        .kinematics
        .inverse(&leaning(5e-5), &near)
        .expect("rounding");
    let there = machine.kinematics.forward(&off);
    assert!((there.position - start.position).norm() < 1e-3);
    assert!(machine.kinematics.inverse(&leaning(0.1), &near).is_err());
}

#[test]
fn geometry_that_makes_no_sense_is_refused_by_its_name() {
    let good = chain_of(
        &[
            (JointAxis::X, Carried::Tool, X_AXIS, [0.0; 3]),
            (JointAxis::C, Carried::Tool, Z_AXIS, [0.0; 3]),
        ],
        [0.0; 3],
        Z_AXIS,
    );
    let refused = |change: fn(&mut SerialChainConfig)| {
        let mut config = good.clone();
        change(&mut config);
        let no_limits = limits([None; AXES]);
        match config.build(&no_limits) {
            Ok(_) => "nothing".to_owned(),
            Err(error) => error.to_string(),
        }
    };
    type Change = fn(&mut SerialChainConfig);
    let changes: [(Change, &str); 10] = [
        (|c| c.joints[0].direction = [1.0, 0.1, 0.0], "direction of axis X"),
        (
            |c| c.joints[1].direction = [f64::NAN, 0.0, 1.0],
            "direction of axis C",
        ),
        (|c| c.joints[0].point_mm = [0.0, 1.0, 0.0], "point_mm of axis X"),
        (|c| c.joints[1].point_mm = [0.0, 1e9, 0.0], "point_mm of axis C"),
        (|c| c.joints[0].axis = JointAxis::C, "joints of axis C"),
        (|c| c.joints.clear(), "joints of kinematics"),
        (|c| c.tool_axis = [0.0; 3], "tool_axis of kinematics"),
        (|c| c.tangent = Some(Z_AXIS), "tangent of kinematics"),
        (|c| c.tip_mm = [f64::INFINITY, 0.0, 0.0], "tip_mm of kinematics"),
        (|c| c.work_mm = [0.0, f64::NAN, 0.0], "work_mm of kinematics"),
    ];
    for (change, text) in changes {
        let error = refused(change);
        assert!(error.starts_with(text), "{error}, not {text}");
    }
    assert_eq!(refused(|_| {}), "nothing");
}
