//! The A/C head with its NC line, and the friction-stir gantry (mathematics 2.5, 2.6, 4.1).

use super::file::{Golden, near, near_all, number, numbers, vector};
use nalgebra::Vector3;
use nc::text::{decimal, machine_block};
use serde_json::Value;
use shared::geometry::Pose;
use shared::io::AXES;
use shared::kinematics::{AcHead, AcHeadConfig, AxisConfig, AxisLimits, Chain, StirGantryConfig, StirTilt};

const A: usize = 3;
const B: usize = 4;
const C: usize = 5;

/// Travel of each axis: from −`travel` to `travel` (mm, degrees).
fn limits(travel: [f64; AXES]) -> [AxisLimits; AXES] {
    let configs = travel.map(|travel| AxisConfig {
        travel_min: -travel,
        travel_max: travel,
        max_velocity: 1.0,
        max_acceleration: 1.0,
        max_jerk: 1.0,
    });
    AxisLimits::build_all(&configs.map(Some)).expect("valid limits")
}

/// Asserts that the case wants the error `seen`, as the class that its text names.
#[track_caller]
fn wants(case: &Value, seen: &str) {
    let wanted = case["err"].as_str();
    assert!(
        wanted.is_some_and(|wanted| seen.contains(wanted)),
        "case {}: {seen}, golden {wanted:?}",
        case["id"]
    );
}

/// Checks the file `ac_head`.
pub fn ac_head(golden: &Golden) {
    let limits = limits([1e5, 1e5, 1e5, 90.0, 0.0001, 360.0]);
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        if input["fmt"].is_number() {
            assert_eq!(
                decimal(number(input, "fmt"), number(input, "nd") as i32),
                out["text"].as_str().expect("text"),
                "case {}",
                case["id"]
            );
            continue;
        }
        let array = |key: &str| -> [f64; 3] { numbers(&input[key]).try_into().expect("three numbers") };
        let config = AcHeadConfig {
            o1_mm: array("o1"),
            o2_mm: array("o2"),
        };
        let head = config.build(&limits).expect("a valid geometry");
        let mut before = [0.0; AXES];
        (before[A], before[C]) = (number(input, "a_prev"), number(input, "c_prev"));
        let solved = Pose::pointing(vector(&input["P"]), vector(&input["n"]))
            .map_err(|e| e.to_string())
            .and_then(|pose| head.inverse(&pose, &before).map_err(|e| e.to_string()));
        match solved {
            Ok(axes) => ac_head_solution(golden, case, &head, &limits, before, axes),
            Err(error) => wants(case, &error),
        }
    }
}

fn ac_head_solution(
    golden: &Golden,
    case: &Value,
    head: &AcHead,
    limits: &[AxisLimits; AXES],
    before: [f64; AXES],
    axes: [f64; AXES],
) {
    assert!(
        case["err"].is_null(),
        "case {}: {} was wanted",
        case["id"],
        case["err"]
    );
    let (mm, rad) = (
        number(&golden.file["tol"], "mm"),
        number(&golden.file["tol"], "rad"),
    );
    let (input, out) = (&case["in"], &case["out"]);
    near(case, "a", axes[A], number(out, "a"), rad);
    near(case, "c", axes[C], number(out, "c"), rad);
    near_all(case, "xyz", &axes[..3], &out["xyz"], mm);
    let compensation = head.compensation([before[A], before[C]], [axes[A], axes[C]]);
    near_all(case, "comp", compensation.as_slice(), &out["comp"], mm);
    let seq = number(input, "seq") as u32;
    let block = machine_block(
        seq,
        &axes,
        &[true, true, true, true, false, true],
        limits,
        number(input, "feed"),
    );
    assert_eq!(
        block.expect("axes within the travel"),
        out["nc"].as_str().expect("nc"),
        "case {}",
        case["id"]
    );
}

/// Checks the file `fsw_kin`.
pub fn fsw_kin(golden: &Golden) {
    let (mm, rad) = (
        number(&golden.file["tol"], "mm"),
        number(&golden.file["tol"], "rad"),
    );
    let limits = limits([1e5, 1e5, 1e5, 0.0001, 10.0, 720.0]);
    for case in &golden.cases {
        let (input, out) = (&case["in"], &case["out"]);
        let branch = number(input, "branch");
        let config = StirGantryConfig {
            l4_mm: number(input, "l4"),
            tilt: if branch > 0.0 {
                StirTilt::Positive
            } else {
                StirTilt::Negative
            },
        };
        let gantry = config.build(&limits).expect("a valid geometry");
        // The files hold (sx, sy, sz, C, B), with the table's x of the tool: s = −X.
        let q = numbers(&input["q_fwd"]);
        let pose = gantry.forward(&[-q[0], q[1], q[2], 0.0, q[4], q[3]]);
        near_all(case, "P", pose.position.as_slice(), &case["fwd"]["P"], mm);
        near_all(case, "O", pose.normal.as_slice(), &case["fwd"]["O"], rad);

        let c_before = number(input, "c_prev");
        let mut before = [0.0; AXES];
        before[C] = c_before;
        let (position, axis) = (vector(&input["P"]), vector(&input["O"]));
        let mut pose = Pose::pointing(position, axis).expect("a pose");
        // The files know no travel: an upright pin keeps the heading that its C had.
        if axis.xy().norm() < 1e-9 && axis.z > 0.0 {
            let heading = Vector3::new(-branch * c_before.cos(), -branch * c_before.sin(), 0.0);
            pose = Pose::new(position, heading, axis).expect("a pose");
        }
        match gantry.inverse(&pose, &before) {
            Ok(axes) => {
                assert!(
                    case["err"].is_null(),
                    "case {}: {} was wanted",
                    case["id"],
                    case["err"]
                );
                let physical = [axes[0], axes[1], axes[2], axes[C], axes[B]];
                let mut q = physical;
                q[0] = -q[0];
                for (name, seen) in [("q", q), ("axes", physical)] {
                    let wanted = numbers(&out[name]);
                    for i in 0..5 {
                        near(case, name, seen[i], wanted[i], if i < 3 { mm } else { rad });
                    }
                }
            }
            Err(error) => {
                wants(case, &error.to_string());
            }
        }
    }
}
